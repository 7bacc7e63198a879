//! What is known of each pixel before it has a colour.

use crate::spare::Spares;
use rayon::prelude::*;
use std::ops::Range;

/// What is proven of the ray through a pixel's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// It meets no zero inside the region.
    #[default]
    Miss = 0,
    /// It meets one.
    Hit = 1,
    /// Neither is proven.
    Undecided = 2,
}

/// Why nothing is proven of an undecided ray, by the first part of it that is so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Reason {
    /// It is decided, or the method does not tell.
    #[default]
    None = 0,
    /// The function comes as near to 0 as arithmetic can tell, and shows no change of sign: it touches 0, or the surface
    /// meets itself.
    Touching = 1,
    /// It is not known to be defined there.
    Undefined = 2,
    /// It is not known to be continuous there.
    Discontinuous = 3,
    /// What was to be spent on the ray, or on the picture, was not enough.
    Budget = 4,
    /// The method proves nothing of such a ray, whether it draws something or not.
    Unproven = 5,
    /// No bound of its slope is known there, without which the method cannot go on.
    Steep = 6,
}

impl Reason {
    /// Every reason, in the order of its number.
    pub const ALL: [Self; 7] = [
        Self::None,
        Self::Touching,
        Self::Undefined,
        Self::Discontinuous,
        Self::Budget,
        Self::Unproven,
        Self::Steep,
    ];

    /// What it is called, in one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "other",
            Self::Touching => "touching",
            Self::Undefined => "undefined",
            Self::Discontinuous => "discontinuous",
            Self::Budget => "budget",
            Self::Unproven => "unproven",
            Self::Steep => "steep",
        }
    }

    /// What it says of a ray, after "undecided".
    pub fn describe(self) -> &'static str {
        match self {
            Self::None => "without a reason that is known",
            Self::Touching => "where f comes near 0 and no change of sign is proven",
            Self::Undefined => "where f may be undefined",
            Self::Discontinuous => "where f may be discontinuous",
            Self::Budget => "for which effort or time ran out",
            Self::Unproven => "of which this method proves nothing",
            Self::Steep => "where no bound of f's slope is known, which this method needs",
        }
    }
}

/// A relative error above that of a direction's length, and of what is multiplied by it.
pub(crate) const LENGTH_ERROR: f64 = 8.0 * f64::EPSILON;

/// What became of one ray. Distances are values of its parameter t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// What is proven, whatever the distances are.
    pub status: Status,
    /// Of the hit, or of the start of the first undecided part; infinite for a miss.
    pub distance: f64,
    /// Of what is to be painted; infinite for nothing.
    pub drawn: f64,
    /// Why it is undecided.
    pub reason: Reason,
    /// Of a hit: the part of the ray that is proven to hold its first zero, and nothing before it. Else NaN.
    pub bracket: [f64; 2],
}

impl Found {
    /// No zero.
    pub const MISS: Self = Self {
        status: Status::Miss,
        distance: f64::INFINITY,
        drawn: f64::INFINITY,
        reason: Reason::None,
        bracket: [f64::NAN; 2],
    };

    /// Whether this says anything but that there is no zero.
    pub(crate) fn is_miss(&self) -> bool {
        self.status == Status::Miss
    }

    /// Nothing is known of the ray, for lack of time.
    pub(crate) const GIVEN_UP: Self =
        Self { status: Status::Undecided, distance: 0.0, reason: Reason::Budget, ..Self::MISS };

    /// The same with distances in world units, for a ray whose direction has this length.
    pub(crate) fn scaled(self, length: f64) -> Self {
        let [near, far] = self.bracket.map(|t| t * length);
        Self {
            distance: self.distance * length,
            drawn: self.drawn * length,
            bracket: [near - LENGTH_ERROR * near.abs(), far + LENGTH_ERROR * far.abs()],
            ..self
        }
    }
}

/// How many pixels have each status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelCounts {
    /// Proven misses.
    pub miss: usize,
    /// Proven hits.
    pub hit: usize,
    /// Pixels of which neither is proven.
    pub undecided: usize,
}

/// One value per pixel and quantity, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GBuffer {
    /// Pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// What is proven.
    pub status: Vec<Status>,
    /// Why a pixel is undecided.
    pub reason: Vec<Reason>,
    /// Of hits, the distances between which the zero is proven to lie; NaN elsewhere. Empty if that is not wanted.
    pub bracket: Vec<[f64; 2]>,
    /// Distance from the ray's origin, in world units: of the hit, or of the start of the first
    /// undecided segment; infinite for a miss, but the status alone says what is one. Over kernels
    /// of `f32` it is known to some 24 bits.
    pub distance: Vec<f64>,
    /// Distance of the point that is painted; infinite where the background shows.
    pub drawn: Vec<f64>,
    /// Number of the surface that is painted; meaningless where the background shows.
    pub surface: Vec<u16>,
    /// Unit normal of what is painted, towards f > 0; zero where unknown or where the background
    /// shows.
    pub normal: Vec<[f32; 3]>,
    /// Whether the painted point lies on a face of the region that cuts a solid open.
    pub cap: Vec<bool>,
    /// How much of the light is hidden from the painted point, 255 being all.
    pub shadow: Vec<u8>,
    /// How much of what surrounds the painted point is hidden from it by what is near, 255 being all.
    pub occlusion: Vec<u8>,
}

static SPARES: Spares<GBuffer> = Spares::new();

/// Rows that one thread makes misses at a time.
const ROWS: usize = 64;

impl GBuffer {
    /// A picture of the given size in which every pixel is a miss, for the surface with this
    /// number. Its memory is that of a picture that was [handed back](Self::hand_back), if there is one as large.
    pub fn new(width: usize, height: usize, surface: u16) -> Self {
        let mut new = Self::unset(width, height, false);
        new.rows(ROWS).for_each(|mut rows| rows.clear(surface));
        new
    }

    /// Makes this a picture as [`GBuffer::new`] does, in the memory that it has as far as that goes.
    pub fn reset(&mut self, width: usize, height: usize, surface: u16) {
        self.resize(width, height, false);
        self.rows(ROWS).for_each(|mut rows| rows.clear(surface));
    }

    /// A picture of the given size, with brackets if they are wanted, of which all rows are still to be cleared: what it holds
    /// is of no picture.
    pub(crate) fn unset(width: usize, height: usize, brackets: bool) -> Self {
        let spare = SPARES.take(width * height, |spare| spare.status.capacity());
        let mut unset = spare.unwrap_or_default();
        unset.resize(width, height, brackets);
        unset
    }

    fn resize(&mut self, width: usize, height: usize, brackets: bool) {
        fn resize<T: Copy>(all: &mut Vec<T>, pixels: usize, value: T) {
            if all.capacity() < pixels {
                // Zeros come with the pages, and those when they are first written to: by many threads.
                *all = vec![value; pixels];
            } else {
                all.resize(pixels, value);
            }
        }
        let pixels = width * height;
        (self.width, self.height) = (width, height);
        resize(&mut self.bracket, if brackets { pixels } else { 0 }, [0.0; 2]);
        resize(&mut self.status, pixels, Status::Miss);
        resize(&mut self.reason, pixels, Reason::None);
        resize(&mut self.distance, pixels, 0.0);
        resize(&mut self.drawn, pixels, 0.0);
        resize(&mut self.surface, pixels, 0);
        resize(&mut self.normal, pixels, [0.0; 3]);
        resize(&mut self.cap, pixels, false);
        resize(&mut self.shadow, pixels, 0);
        resize(&mut self.occlusion, pixels, 0);
    }

    /// Leaves the memory to the next pictures. Up to two buffers are kept, until the end of the process.
    pub fn hand_back(self) {
        SPARES.hand_back(self);
    }

    /// Writes what became of a pixel's ray, distances in world units.
    pub(crate) fn set(&mut self, pixel: usize, found: &Found) {
        self.status[pixel] = found.status;
        self.distance[pixel] = found.distance;
        self.drawn[pixel] = found.drawn;
        self.reason[pixel] = found.reason;
        if let Some(bracket) = self.bracket.get_mut(pixel) {
            *bracket = found.bracket;
        }
    }

    /// Keeps brackets of hits from now on.
    #[must_use]
    pub fn with_brackets(mut self) -> Self {
        self.bracket.clear();
        self.bracket.resize(self.status.len(), [f64::NAN; 2]);
        self
    }

    /// Keeps only some of the rows.
    ///
    /// # Panics
    /// If there are no such rows.
    pub fn crop(&mut self, rows: Range<usize>) {
        fn keep<T>(all: &mut Vec<T>, pixels: &Range<usize>) {
            all.truncate(pixels.end);
            all.drain(..pixels.start.min(all.len()));
        }
        assert!(rows.start <= rows.end && rows.end <= self.height, "rows of the picture");
        let pixels = &(rows.start * self.width..rows.end * self.width);
        self.height = rows.len();
        keep(&mut self.status, pixels);
        keep(&mut self.reason, pixels);
        keep(&mut self.bracket, pixels);
        keep(&mut self.distance, pixels);
        keep(&mut self.drawn, pixels);
        keep(&mut self.surface, pixels);
        keep(&mut self.normal, pixels);
        keep(&mut self.cap, pixels);
        keep(&mut self.shadow, pixels);
        keep(&mut self.occlusion, pixels);
    }

    /// Calls every pixel undecided from the eye on, for lack of time: one more surface was not looked for. What is painted
    /// stays.
    pub fn give_up(&mut self) {
        self.status.fill(Status::Undecided);
        self.reason.fill(Reason::Budget);
        self.distance.fill(0.0);
        self.bracket.fill([f64::NAN; 2]);
    }

    /// Adds another surface to the picture: in each pixel, the nearer hit or undecided segment and the nearer painted
    /// point are kept. Of an undecided segment and a hit at the same distance, the former is kept.
    ///
    /// # Panics
    /// If the sizes differ.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!((self.width, self.height), (other.width, other.height), "sizes differ");
        for pixel in 0..self.status.len() {
            let (mine, theirs) = (self.distance[pixel], other.distance[pixel]);
            let is_nearer =
                theirs < mine || (theirs == mine && other.status[pixel] == Status::Undecided);
            if is_nearer {
                self.distance[pixel] = theirs;
                self.status[pixel] = other.status[pixel];
                self.reason[pixel] = other.reason[pixel];
            }
            if let Some(bracket) = self.bracket.get_mut(pixel) {
                let unknown = [f64::NAN; 2];
                let [mine, theirs] =
                    [*bracket, other.bracket.get(pixel).copied().unwrap_or(unknown)];
                *bracket = if self.status[pixel] == Status::Hit {
                    // Where both are hit, either may hold the first zero. What is not a number gives way.
                    [mine[0].min(theirs[0]), mine[1].min(theirs[1])]
                } else {
                    unknown
                };
            }
            if other.drawn[pixel] < self.drawn[pixel] {
                self.drawn[pixel] = other.drawn[pixel];
                self.surface[pixel] = other.surface[pixel];
                self.normal[pixel] = other.normal[pixel];
                self.cap[pixel] = other.cap[pixel];
                self.shadow[pixel] = other.shadow[pixel];
                self.occlusion[pixel] = other.occlusion[pixel];
            }
        }
    }

    /// Takes the pixels for which `only` says so from another picture of the same rays.
    ///
    /// # Panics
    /// If the sizes differ, or `only` is not as long as there are pixels.
    pub fn replace(&mut self, other: &Self, only: &[bool]) {
        fn take<T: Copy>(all: &mut [T], others: &[T], only: &[bool]) {
            let taken = all.iter_mut().zip(others).zip(only).filter(|(_, only)| **only);
            taken.for_each(|((mine, theirs), _)| *mine = *theirs);
        }
        assert_eq!((self.width, self.height), (other.width, other.height), "sizes differ");
        assert_eq!(only.len(), self.status.len(), "one for each pixel");
        take(&mut self.status, &other.status, only);
        take(&mut self.reason, &other.reason, only);
        take(&mut self.bracket, &other.bracket, only);
        take(&mut self.distance, &other.distance, only);
        take(&mut self.drawn, &other.drawn, only);
        take(&mut self.surface, &other.surface, only);
        take(&mut self.normal, &other.normal, only);
        take(&mut self.cap, &other.cap, only);
        take(&mut self.shadow, &other.shadow, only);
        take(&mut self.occlusion, &other.occlusion, only);
    }

    /// How many pixels have each status.
    pub fn counts(&self) -> PixelCounts {
        // Bytes are added up in bytes, so that vectors of them are.
        let number = |wanted: Status| -> usize {
            let part = |part: &[Status]| -> u8 {
                part.iter().map(|&status| u8::from(status == wanted)).sum()
            };
            self.status.chunks(usize::from(u8::MAX)).map(|chunk| usize::from(part(chunk))).sum()
        };
        let (hit, undecided) = (number(Status::Hit), number(Status::Undecided));
        PixelCounts { miss: self.status.len() - hit - undecided, hit, undecided }
    }

    /// How many undecided pixels there are for each of [`Reason::ALL`].
    pub fn reasons(&self) -> [usize; Reason::ALL.len()] {
        let mut counts = [0; Reason::ALL.len()];
        for (status, reason) in self.status.iter().zip(&self.reason) {
            counts[*reason as usize] += usize::from(*status == Status::Undecided);
        }
        counts
    }

    /// Whether anything is painted in the pixel with this index.
    pub fn is_drawn(&self, pixel: usize) -> bool {
        self.drawn[pixel].is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(status: Status, distance: f64, drawn: f64, surface: u16) -> GBuffer {
        let mut buffer = GBuffer::new(1, 1, surface);
        buffer.status[0] = status;
        buffer.distance[0] = distance;
        buffer.drawn[0] = drawn;
        buffer
    }

    #[test]
    fn memory_that_is_handed_back_holds_nothing_of_its_picture() {
        let mut old = pixel(Status::Hit, 5.0, 5.0, 7);
        (old.normal[0], old.cap[0], old.shadow[0]) = ([1.0, 0.0, 0.0], true, 255);
        old.occlusion[0] = 9;
        old.reason[0] = Reason::Touching;
        old = old.with_brackets();
        let mut reset = old.clone();
        reset.reset(1, 1, 3);
        old.hand_back();
        let new = GBuffer::new(1, 1, 3);
        assert_eq!(new, reset);
        let expected = (Status::Miss, f64::INFINITY, f64::INFINITY, 3);
        assert_eq!((new.status[0], new.distance[0], new.drawn[0], new.surface[0]), expected);
        assert_eq!((new.normal[0], new.cap[0]), ([0.0; 3], false));
        assert_eq!((new.shadow[0], new.occlusion[0]), (0, 0));
        assert!(new.reason[0] == Reason::None && new.bracket.is_empty());
        reset.reset(3, 2, 0);
        assert_eq!(reset, GBuffer::new(3, 2, 0));
    }

    #[test]
    fn the_nearer_claim_and_the_nearer_paint_win_apart() {
        // An undecided segment that paints nothing, before a hit: the claim is undecided, the paint
        // is the hit's.
        let mut buffer = pixel(Status::Hit, 5.0, 5.0, 0);
        buffer.merge(&pixel(Status::Undecided, 3.0, f64::INFINITY, 1));
        assert_eq!((buffer.status[0], buffer.distance[0]), (Status::Undecided, 3.0));
        assert_eq!((buffer.drawn[0], buffer.surface[0]), (5.0, 0));
        // A hit in front decides.
        buffer.merge(&pixel(Status::Hit, 2.0, 2.0, 2));
        assert_eq!((buffer.status[0], buffer.surface[0]), (Status::Hit, 2));
        // A bracket holds the first zero of either.
        let bracketed = |near: f64, far: f64| {
            let mut buffer = pixel(Status::Hit, 0.5 * (near + far), 0.5 * (near + far), 0);
            buffer.bracket = vec![[near, far]];
            buffer
        };
        let mut two = bracketed(1.0, 2.0);
        two.merge(&bracketed(0.5, 4.0));
        assert_eq!((two.distance[0], two.bracket[0]), (1.5, [0.5, 2.0]));
        two.merge(&GBuffer::new(1, 1, 3).with_brackets());
        assert_eq!(two.bracket[0], [0.5, 2.0]);
        two.merge(&pixel(Status::Undecided, 0.25, 0.25, 1).with_brackets());
        assert!(two.status[0] == Status::Undecided && two.bracket[0][0].is_nan());
        // A miss changes nothing.
        let before = buffer.clone();
        buffer.merge(&GBuffer::new(1, 1, 3));
        assert_eq!(buffer, before);
        // Nor does what is not wanted.
        buffer.replace(&pixel(Status::Miss, 9.0, 9.0, 9), &[false]);
        assert_eq!(buffer, before);
        let another = pixel(Status::Undecided, 9.0, 9.0, 9);
        let mut replaced = before.clone();
        replaced.replace(&another, &[true]);
        assert_eq!(replaced, another);
        assert_eq!(buffer.counts(), PixelCounts { miss: 0, hit: 1, undecided: 0 });
    }
}
