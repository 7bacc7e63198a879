//! The G-buffer: the quantities of each pixel before it has a color.

use crate::buffer_pool::{BufferPool, PICTURES, serves};
use crate::ray_result::{RayResult, Status, UndecidedReason};
use crate::surface_ids::SurfaceIds;
use fearless_simd::{Level, Simd};
use rayon::prelude::*;
use std::ops::{AddAssign, Range};
use zeroset_eval::dispatch;

/// Number of pixels with each status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PixelCounts {
    /// Proven misses.
    pub miss: usize,
    /// Proven hits.
    pub hit: usize,
    /// Undecided pixels.
    pub undecided: usize,
}

impl PixelCounts {
    pub(crate) fn of(status: &[Status]) -> Self {
        dispatch!(Level::new(), simd => Self::of_with(simd, status))
    }

    /// As [`PixelCounts::of`], compiled for vectors of type `S`.
    #[inline(always)]
    fn of_with<S: Simd>(_: S, status: &[Status]) -> Self {
        /// Number of counters for each status, of one byte each, so that the compiler adds whole
        /// vectors. Pixel n is counted by counter n modulo `SIDE`.
        const SIDE: usize = 64;
        let (sides, rest) = status.as_chunks::<SIDE>();
        let count = |status: Status| rest.iter().filter(|other| **other == status).count();
        let [mut hit, mut undecided] = [Status::Hit, Status::Undecided].map(count);
        for sides in sides.chunks(u8::MAX.into()) {
            let [mut hits, mut open] = [[0_u8; SIDE]; 2];
            for side in sides {
                for (status, (hits, open)) in side.iter().zip(hits.iter_mut().zip(&mut open)) {
                    *hits += u8::from(*status == Status::Hit);
                    *open += u8::from(*status == Status::Undecided);
                }
            }
            hit += hits.iter().copied().map(usize::from).sum::<usize>();
            undecided += open.iter().copied().map(usize::from).sum::<usize>();
        }
        Self { miss: status.len() - hit - undecided, hit, undecided }
    }
}

impl AddAssign for PixelCounts {
    fn add_assign(&mut self, other: Self) {
        self.miss += other.miss;
        self.hit += other.hit;
        self.undecided += other.undecided;
    }
}

/// The quantities of a picture's pixels. Each is an array, row by row from the top.
#[derive(Clone, Debug, Default)]
pub struct GBuffer {
    /// Pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// The proven status of each pixel.
    pub status: Vec<Status>,
    /// Reason for an undecided pixel. Unspecified for other pixels, which saves writing it.
    pub(crate) reason: Vec<UndecidedReason>,
    /// Distance from an undecided pixel's ray origin to the start of its first undecided segment.
    /// Unspecified for other pixels, and for unseen ones, whose distance is 0.
    pub(crate) open_from: Vec<f64>,
    /// Bracket of a hit: the two distances between which its zero is proven to lie. NaN for other
    /// pixels. Empty if brackets are not kept.
    pub bracket: Vec<[f64; 2]>,
    /// Distance of the painted point from the ray's origin, in world units. Infinite if nothing is
    /// painted, as in every miss. Finite in every hit. With `f32` kernels, about 24 bits are right.
    pub drawn: Vec<f64>,
    /// Approximate values of u and v at a painted point of a parametric surface. Meaningless for
    /// other pixels. Empty if no surface is parametric.
    pub parameters: Vec<[f32; 2]>,
    /// Whether the direction of the gradient may change between the painted point of a hit and its
    /// zero, as near a multiple zero. Then the gradient at the painted point is no good normal.
    pub uneven: Vec<bool>,
    /// Id of the painted surface. Meaningless if nothing is painted.
    pub surface: SurfaceIds,
    /// Unit normal at the painted point, toward f > 0. Meaningless if nothing is painted or normals
    /// were not computed. Empty if normals are not kept.
    pub normal: Vec<[f32; 3]>,
    /// Whether the painted point lies on a cap. May be empty if no painted point does.
    pub cap: Vec<bool>,
    /// Share of the light that is hidden from the painted point. 255 means all. Empty if no light
    /// is hidden.
    pub shadow: Vec<u8>,
    /// Share of the painted point's surroundings that nearby points hide. 255 means all. Empty if
    /// nothing is hidden.
    pub occlusion: Vec<u8>,
}

/// Optional quantities that a picture keeps.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "each is an array of its own")]
pub struct Kept {
    /// Whether normals are kept: [`GBuffer::normal`].
    pub normals: bool,
    /// Whether brackets are kept: [`GBuffer::bracket`].
    pub brackets: bool,
    /// Whether caps are kept: [`GBuffer::cap`].
    pub caps: bool,
    /// Whether u and v are kept: [`GBuffer::parameters`].
    pub parameters: bool,
}

impl Default for Kept {
    /// Keeps normals only.
    fn default() -> Self {
        Self { normals: true, brackets: false, caps: false, parameters: false }
    }
}

/// Distance of a hit, or of the start of the first undecided segment. Infinite for a miss.
pub(crate) fn distance(
    status: Status,
    reason: UndecidedReason,
    [open_from, drawn]: [f64; 2],
) -> f64 {
    match status {
        Status::Miss => f64::INFINITY,
        Status::Hit => drawn,
        Status::Undecided if reason == UndecidedReason::Unseen => 0.0,
        Status::Undecided => open_from,
    }
}

/// Returns whether no method has examined a pixel with this status and reason.
#[inline]
pub(crate) fn is_unseen(status: Status, reason: UndecidedReason) -> bool {
    status == Status::Undecided && reason == UndecidedReason::Unseen
}

static SPARES: BufferPool<GBuffer> = BufferPool::new(PICTURES);

/// Number of rows that a thread clears at a time.
const ROWS: usize = 64;

/// Compares quantities only in pixels for which they have a meaning.
impl PartialEq for GBuffer {
    fn eq(&self, other: &Self) -> bool {
        let is_same = |pixel: usize| {
            let is_open = self.status[pixel] == Status::Undecided;
            (!is_open
                || self.reason[pixel] == other.reason[pixel]
                    && self.distance(pixel) == other.distance(pixel))
                && (!self.is_drawn(pixel)
                    || self.surface[pixel] == other.surface[pixel]
                        && self.normal.get(pixel) == other.normal.get(pixel))
        };
        (self.width, self.height) == (other.width, other.height)
            && (&self.status, &self.drawn) == (&other.status, &other.drawn)
            && (&self.bracket, &self.cap) == (&other.bracket, &other.cap)
            && (&self.shadow, &self.occlusion) == (&other.shadow, &other.occlusion)
            && (0..self.status.len()).all(is_same)
    }
}

impl GBuffer {
    /// A picture for one surface, in which every pixel is [unseen](UndecidedReason::Unseen). Reuses
    /// the memory of a picture that was [handed back](Self::hand_back), if its size is suitable.
    pub fn new(width: usize, height: usize, surface: u16) -> Self {
        let mut new = Self::unset(width, height, surface, Kept::default());
        new.rows(ROWS).into_par_iter().for_each(|mut rows| rows.clear());
        new
    }

    /// A picture of no surface: every ray is a miss, since there is nothing to meet. Surfaces are
    /// [merged](Self::merge) into it.
    pub fn of_nothing(width: usize, height: usize) -> Self {
        let mut new = Self::new(width, height, 0);
        new.miss(0..width * height);
        new
    }

    /// Makes this picture equal to [`GBuffer::new`] with the same arguments. Reuses its memory if
    /// that is large enough.
    ///
    /// # Panics
    /// In debug builds, if a miss is painted or a hit is not.
    pub fn reset(&mut self, width: usize, height: usize, surface: u16) {
        self.check();
        self.resize(width, height, Kept::default());
        self.surface.fill(surface);
        self.rows(ROWS).into_par_iter().for_each(|mut rows| rows.clear());
    }

    /// A picture of one surface, whose pixels are not initialized. The caller must clear all rows.
    pub(crate) fn unset(width: usize, height: usize, surface: u16, kept: Kept) -> Self {
        let spare = SPARES.take().filter(|spare| serves(spare.status.capacity(), width * height));
        let mut unset = spare.unwrap_or_default();
        unset.resize(width, height, kept);
        unset.surface.fill(surface);
        unset
    }

    /// Asserts in debug builds that every hit is painted and no miss is.
    fn check(&self) {
        let is_right = |(status, drawn): (&Status, &f64)| match status {
            Status::Miss => !drawn.is_finite(),
            Status::Hit => drawn.is_finite(),
            Status::Undecided => true,
        };
        debug_assert!(self.status.iter().zip(&self.drawn).all(is_right));
    }

    fn resize(&mut self, width: usize, height: usize, kept: Kept) {
        fn resize<T: Copy>(all: &mut Vec<T>, pixels: usize, value: T) {
            if all.capacity() < pixels {
                // The system maps new, zeroed pages at their first write. Many threads share that
                // work later.
                *all = vec![value; pixels];
            } else {
                all.resize(pixels, value);
            }
        }
        let pixels = width * height;
        (self.width, self.height) = (width, height);
        resize(&mut self.bracket, if kept.brackets { pixels } else { 0 }, [0.0; 2]);
        // In new memory `drawn` is 0. Clearing skips misses, so no pixel may keep an old status of
        // a miss.
        if self.drawn.capacity() < pixels {
            self.status.clear();
        }
        resize(&mut self.status, pixels, Status::Undecided);
        resize(&mut self.reason, pixels, UndecidedReason::None);
        resize(&mut self.open_from, pixels, 0.0);
        resize(&mut self.drawn, pixels, 0.0);
        resize(&mut self.uneven, pixels, false);
        resize(&mut self.normal, if kept.normals { pixels } else { 0 }, [0.0; 3]);
        resize(&mut self.cap, if kept.caps { pixels } else { 0 }, false);
        resize(&mut self.parameters, if kept.parameters { pixels } else { 0 }, [0.0; 2]);
        self.shadow.clear();
        self.occlusion.clear();
    }

    /// Leaves the picture's memory to later pictures. Up to two buffers are kept until the process
    /// ends.
    ///
    /// # Panics
    /// In debug builds, if a miss is painted or a hit is not.
    pub fn hand_back(self) {
        self.check();
        SPARES.hand_back(self);
    }

    /// Writes the result for a pixel's ray. Its distances must be in world units. A hit must be
    /// painted at its own distance.
    ///
    /// # Panics
    /// If `pixel` is not in the picture.
    pub fn set(&mut self, pixel: usize, found: &RayResult) {
        debug_assert!(found.status != Status::Hit || found.distance == found.drawn);
        debug_assert!(found.status != Status::Miss || !found.drawn.is_finite());
        self.status[pixel] = found.status;
        self.drawn[pixel] = found.drawn;
        if found.status == Status::Undecided {
            (self.reason[pixel], self.open_from[pixel]) = (found.reason, found.distance);
        }
        if let Some(bracket) = self.bracket.get_mut(pixel) {
            *bracket = found.bracket;
        }
        if let Some(parameters) = self.parameters.get_mut(pixel) {
            *parameters = found.parameters;
        }
    }

    /// Distance from the ray's origin to the pixel's hit, or to the start of its first undecided
    /// segment, in world units. Infinite for a miss. With `f32` kernels, about 24 bits are right.
    ///
    /// # Panics
    /// If `pixel` is not in the picture.
    pub fn distance(&self, pixel: usize) -> f64 {
        let distances = [self.open_from[pixel], self.drawn[pixel]];
        distance(self.status[pixel], self.reason[pixel], distances)
    }

    /// The reason why a pixel is undecided; [`UndecidedReason::None`] for decided pixels.
    ///
    /// # Panics
    /// If `pixel` is not in the picture.
    pub fn reason(&self, pixel: usize) -> UndecidedReason {
        if self.status[pixel] == Status::Undecided {
            self.reason[pixel]
        } else {
            UndecidedReason::None
        }
    }

    /// Returns whether a pixel's painted point lies on a cap.
    pub fn is_cap(&self, pixel: usize) -> bool {
        self.cap.get(pixel).copied().unwrap_or_default()
    }

    /// This picture, with an array for brackets. Hits already in the picture get no brackets.
    #[must_use]
    pub fn with_brackets(mut self) -> Self {
        self.bracket.clear();
        self.bracket.resize(self.status.len(), [f64::NAN; 2]);
        self
    }

    /// Adds an array for caps, unless there is one.
    pub fn keep_caps(&mut self) {
        self.cap.resize(self.status.len(), false);
    }

    /// Adds an array for u and v, unless there is one.
    pub fn keep_parameters(&mut self) {
        self.parameters.resize(self.status.len(), [0.0; 2]);
    }

    /// Removes all rows but `rows`.
    ///
    /// # Panics
    /// If `rows` are not rows of the picture.
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
        keep(&mut self.open_from, pixels);
        keep(&mut self.drawn, pixels);
        keep(&mut self.parameters, pixels);
        keep(&mut self.uneven, pixels);
        self.surface.crop(pixels);
        keep(&mut self.normal, pixels);
        keep(&mut self.cap, pixels);
        keep(&mut self.shadow, pixels);
        keep(&mut self.occlusion, pixels);
    }

    /// Status and distance of the painted point of each pixel in a part of the picture.
    ///
    /// # Panics
    /// If the part exceeds the picture.
    pub fn seen_in(&self, columns: &Range<usize>, rows: &Range<usize>) -> (Vec<Status>, Vec<f64>) {
        let pixels = columns.len() * rows.len();
        let (mut status, mut drawn) = (Vec::with_capacity(pixels), Vec::with_capacity(pixels));
        for row in rows.clone() {
            let some = row * self.width + columns.start..row * self.width + columns.end;
            status.extend_from_slice(&self.status[some.clone()]);
            drawn.extend_from_slice(&self.drawn[some]);
        }
        (status, drawn)
    }

    /// Makes pixels without a result misses. The caller must have proven that the rays of these
    /// pixels miss the surface.
    ///
    /// # Panics
    /// If the range exceeds the picture.
    pub fn miss(&mut self, pixels: Range<usize>) {
        for (status, reason) in self.status[pixels.clone()].iter_mut().zip(&self.reason[pixels]) {
            if is_unseen(*status, *reason) {
                *status = Status::Miss;
            }
        }
    }

    /// Makes pixels unseen again. Nothing is painted there.
    ///
    /// # Panics
    /// If the range exceeds the picture.
    pub fn forget(&mut self, pixels: Range<usize>) {
        self.status[pixels.clone()].fill(Status::Undecided);
        self.reason[pixels.clone()].fill(UndecidedReason::Unseen);
        self.drawn[pixels].fill(f64::INFINITY);
    }

    /// Sets every pixel to undecided from the eye on, for lack of time: a surface was not traced.
    /// Painted points stay.
    pub fn give_up(&mut self) {
        self.status.fill(Status::Undecided);
        self.reason.fill(UndecidedReason::Budget);
        self.open_from.fill(0.0);
        self.bracket.fill([f64::NAN; 2]);
    }

    /// Adds another surface to the picture. Each pixel keeps the nearer hit or undecided segment,
    /// and the nearer painted point. If an undecided segment and a hit are equally near, the
    /// segment is kept. If a hit's bracket begins before the undecided segment, the pixel is
    /// undecided from the bracket's start on. Without brackets, a hit's zero is assumed to be at
    /// the painted point.
    ///
    /// # Panics
    /// If the pictures differ in size.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!((self.width, self.height), (other.width, other.height), "sizes differ");
        self.merge_at(other, [0, 0]);
    }

    /// As [`GBuffer::merge`], for a surface that was traced in a part of the picture. The part
    /// begins in column `left` and row `top`. The caller must have proven that the rays of all
    /// other pixels miss the surface.
    ///
    /// # Panics
    /// If the part exceeds the picture.
    pub fn merge_at(&mut self, other: &Self, [left, top]: [usize; 2]) {
        let (right, bottom) = (left + other.width, top + other.height);
        assert!(right <= self.width && bottom <= self.height, "a part of the picture");
        self.keep_as(other);
        for row in 0..other.height {
            let first = (top + row) * self.width + left;
            for column in 0..other.width {
                self.merge_pixel(first + column, other, row * other.width + column);
            }
        }
    }

    /// Adds the pixel `own` of `other` to a pixel.
    fn merge_pixel(&mut self, pixel: usize, other: &Self, own: usize) {
        let (mine, theirs) = (self.distance(pixel), other.distance(own));
        // A hit's zero may be anywhere in its bracket.
        let begins = |buffer: &Self, pixel: usize| match buffer.status[pixel] {
            Status::Hit => buffer.bracket_of(pixel)[0],
            _ => f64::NAN,
        };
        let begins = begins(self, pixel).min(begins(other, own));
        let is_nearer = theirs < mine || (theirs == mine && other.status[own] == Status::Undecided);
        if is_nearer {
            self.take_proven(pixel, other, own);
        }
        if self.status[pixel] == Status::Undecided {
            self.open_from[pixel] = self.distance(pixel).min(begins);
        }
        if let Some(bracket) = self.bracket.get_mut(pixel) {
            let [mine, theirs] = [*bracket, other.bracket_of(own)];
            *bracket = if self.status[pixel] == Status::Hit {
                // If both are hits, either bracket may hold the first zero. `min` ignores NaN.
                [mine[0].min(theirs[0]), mine[1].min(theirs[1])]
            } else {
                [f64::NAN; 2]
            };
        }
        if other.drawn[own] < self.drawn[pixel] {
            self.take_painted(pixel, other, own);
        }
    }

    /// The bracket of a pixel's hit. NaN if brackets are not kept.
    fn bracket_of(&self, pixel: usize) -> [f64; 2] {
        self.bracket.get(pixel).copied().unwrap_or([f64::NAN; 2])
    }

    /// Copies status, reason and undecided start from pixel `own` of `other`, but not the bracket.
    fn take_proven(&mut self, pixel: usize, other: &Self, own: usize) {
        self.status[pixel] = other.status[own];
        self.reason[pixel] = other.reason[own];
        self.open_from[pixel] = other.open_from[own];
    }

    /// Copies the painted point, with its surface and light, from pixel `own` of `other`.
    fn take_painted(&mut self, pixel: usize, other: &Self, own: usize) {
        fn take<T: Copy + Default>(mine: Option<&mut T>, theirs: Option<&T>) {
            if let Some(mine) = mine {
                *mine = theirs.copied().unwrap_or_default();
            }
        }
        self.drawn[pixel] = other.drawn[own];
        self.uneven[pixel] = other.uneven[own];
        self.surface.set(pixel, other.surface[own], self.status.len());
        take(self.normal.get_mut(pixel), other.normal.get(own));
        take(self.parameters.get_mut(pixel), other.parameters.get(own));
        take(self.cap.get_mut(pixel), other.cap.get(own));
        take(self.shadow.get_mut(pixel), other.shadow.get(own));
        take(self.occlusion.get_mut(pixel), other.occlusion.get(own));
    }

    /// Adds arrays for u and v, caps, shadow and occlusion if `other` has them.
    pub fn keep_as(&mut self, other: &Self) {
        fn room<T: Copy + Default>(all: &mut Vec<T>, others: &[T], pixels: usize) {
            if !others.is_empty() {
                all.resize(pixels, T::default());
            }
        }
        let pixels = self.status.len();
        room(&mut self.parameters, &other.parameters, pixels);
        room(&mut self.cap, &other.cap, pixels);
        room(&mut self.shadow, &other.shadow, pixels);
        room(&mut self.occlusion, &other.occlusion, pixels);
    }

    /// Copies the pixels that `only` selects from `other`, a picture of the same rays.
    ///
    /// # Panics
    /// If the pictures differ in size, or the length of `only` differs from the number of pixels.
    pub fn replace(&mut self, other: &Self, only: &[bool]) {
        assert_eq!((self.width, self.height), (other.width, other.height), "sizes differ");
        assert_eq!(only.len(), self.status.len(), "one for each pixel");
        self.keep_as(other);
        for pixel in (0..only.len()).filter(|pixel| only[*pixel]) {
            self.take_proven(pixel, other, pixel);
            self.take_painted(pixel, other, pixel);
            if let Some(bracket) = self.bracket.get_mut(pixel) {
                *bracket = other.bracket_of(pixel);
            }
        }
    }

    /// Number of pixels with each status.
    pub fn counts(&self) -> PixelCounts {
        PixelCounts::of(&self.status)
    }

    /// Number of undecided pixels for each of [`UndecidedReason::ALL`].
    pub fn reasons(&self) -> [usize; UndecidedReason::ALL.len()] {
        let mut counts = [0; UndecidedReason::ALL.len()];
        for (status, reason) in self.status.iter().zip(&self.reason) {
            counts[*reason as usize] += usize::from(*status == Status::Undecided);
        }
        counts
    }

    /// Returns whether a point is painted in this pixel.
    pub fn is_drawn(&self, pixel: usize) -> bool {
        self.drawn[pixel].is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixel(status: Status, distance: f64, drawn: f64, surface: u16) -> GBuffer {
        let mut buffer = GBuffer::new(1, 1, surface);
        buffer.set(0, &RayResult { status, distance, drawn, ..RayResult::MISS });
        buffer
    }

    #[test]
    fn memory_that_is_handed_back_holds_nothing_of_its_picture() {
        let touching = RayResult { status: Status::Undecided, distance: 4.0, ..RayResult::MISS };
        let mut old = GBuffer::new(1, 1, 7);
        old.set(0, &RayResult { drawn: 5.0, reason: UndecidedReason::Touching, ..touching });
        (old.normal[0], old.cap, old.shadow) = ([1.0, 0.0, 0.0], vec![true], vec![255]);
        old.occlusion = vec![9];
        old = old.with_brackets();
        assert_eq!((old.distance(0), old.reason(0)), (4.0, UndecidedReason::Touching));
        let mut reset = old.clone();
        reset.reset(1, 1, 3);
        old.hand_back();
        let mut new = GBuffer::new(1, 1, 3);
        assert_eq!(new, reset);
        let expected = (Status::Undecided, 0.0, f64::INFINITY, 3);
        assert_eq!((new.status[0], new.distance(0), new.drawn[0], new.surface[0]), expected);
        assert!(new.cap.is_empty() && new.shadow.is_empty() && new.occlusion.is_empty());
        assert!(new.reason(0) == UndecidedReason::Unseen && new.bracket.is_empty());
        // A hit replaces an undecided result. The old reason must not show.
        new.set(
            0,
            &RayResult { status: Status::Hit, distance: 2.0, drawn: 2.0, ..RayResult::MISS },
        );
        assert_eq!((new.distance(0), new.reason(0)), (2.0, UndecidedReason::None));
        assert_ne!(new, reset);
        reset.reset(3, 2, 0);
        assert_eq!(reset, GBuffer::new(3, 2, 0));
    }

    #[test]
    fn nothing_is_painted_in_the_memory_of_an_earlier_picture() {
        let mut buffer = GBuffer::default();
        for (width, height) in [(100, 3), (33, 2), (40, 30), (100, 12), (7, 1), (40, 30)] {
            buffer.reset(width, height, 0);
            let pixels = 0..width * height;
            let is_clear = |pixel: usize| {
                buffer.reason(pixel) == UndecidedReason::Unseen && !buffer.is_drawn(pixel)
            };
            assert!(pixels.clone().all(is_clear), "{width}×{height}");
            for pixel in pixels.filter(|pixel| pixel % 45 < 2 || pixel % 256 < 50) {
                let (status, drawn) = match pixel % 3 {
                    0 => (Status::Hit, 2.0),
                    1 => (Status::Undecided, 3.0),
                    _ => (Status::Undecided, f64::INFINITY),
                };
                buffer.set(pixel, &RayResult { status, distance: 2.0, drawn, ..RayResult::MISS });
            }
            buffer.miss(0..width * height);
        }
    }

    #[test]
    fn the_nearer_claim_and_the_nearer_paint_win_apart() {
        // An undecided segment without a painted point lies before a hit. The pixel becomes
        // undecided, but the hit's painted point stays.
        let mut buffer = pixel(Status::Hit, 5.0, 5.0, 0);
        buffer.merge(&pixel(Status::Undecided, 3.0, f64::INFINITY, 1));
        assert_eq!((buffer.status[0], buffer.distance(0)), (Status::Undecided, 3.0));
        assert_eq!((buffer.drawn[0], buffer.surface[0]), (5.0, 0));
        // A hit in front of the undecided segment decides the pixel.
        buffer.merge(&pixel(Status::Hit, 2.0, 2.0, 2));
        assert_eq!((buffer.status[0], buffer.surface[0]), (Status::Hit, 2));
        // The bracket merged from two hits holds the nearer of their zeros.
        let bracketed = |near: f64, far: f64| {
            let mut buffer = pixel(Status::Hit, 0.5 * (near + far), 0.5 * (near + far), 0);
            buffer.bracket = vec![[near, far]];
            buffer
        };
        let mut two = bracketed(1.0, 2.0);
        two.merge(&bracketed(0.5, 4.0));
        assert_eq!((two.distance(0), two.bracket[0]), (1.5, [0.5, 2.0]));
        two.merge(&GBuffer::of_nothing(1, 1).with_brackets());
        assert_eq!(two.bracket[0], [0.5, 2.0]);
        two.merge(&pixel(Status::Undecided, 0.25, 0.25, 1).with_brackets());
        assert!(two.status[0] == Status::Undecided && two.bracket[0][0].is_nan());
        // If a bracket begins before the undecided segment, the pixel is undecided from there on.
        for (hit_first, from, expected) in [(true, 1.25, 1.0), (false, 1.25, 1.0), (true, 0.5, 0.5)]
        {
            let open = pixel(Status::Undecided, from, from, 1).with_brackets();
            let (mut one, mut other) = (bracketed(1.0, 2.0), open);
            if !hit_first {
                std::mem::swap(&mut one, &mut other);
            }
            one.merge(&other);
            assert_eq!((one.status[0], one.distance(0)), (Status::Undecided, expected));
        }
        // Merging a miss changes nothing.
        let before = buffer.clone();
        buffer.merge(&GBuffer::of_nothing(1, 1));
        assert_eq!(buffer, before);
        // Where a surface was not examined, nothing is proven, though the hit stays painted.
        let mut unseen = before.clone();
        unseen.merge(&GBuffer::new(1, 1, 3));
        assert_eq!((unseen.reason(0), unseen.distance(0)), (UndecidedReason::Unseen, 0.0));
        assert_eq!((unseen.drawn[0], unseen.surface[0]), (before.drawn[0], before.surface[0]));
        let mut unseen = GBuffer::new(1, 1, 3);
        unseen.merge(&before);
        assert_eq!((unseen.reason(0), unseen.distance(0)), (UndecidedReason::Unseen, 0.0));
        // A pixel that is not selected stays as it is.
        buffer.replace(&pixel(Status::Undecided, 9.0, 9.0, 9), &[false]);
        assert_eq!(buffer, before);
        let another = pixel(Status::Undecided, 9.0, 9.0, 9);
        let mut replaced = before.clone();
        replaced.replace(&another, &[true]);
        assert_eq!(replaced, another);
        assert_eq!(buffer.counts(), PixelCounts { miss: 0, hit: 1, undecided: 0 });
    }
}
