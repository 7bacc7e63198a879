//! The data that kernels read and write: batches of sixteen lanes, whatever the width of a
//! register.
//!
//! In a batch each quantity is contiguous and aligned to 64 bytes. A kernel takes it a register at
//! a time, up to the lanes in use; what it leaves in other lanes has no meaning.

use crate::lanes::{LANES, Lanes};
use crate::real::Real;
use zeroset_interval::{Facts, Interval};

/// Memory that a kernel reads or writes: quantities first.
///
/// Only the types of this module are such; they are `repr(C)`, so that quantity k starts `k` times
/// the size of [`Lanes`] after the beginning.
pub trait Batch<T: Real>: sealed::Sealed + Clone + Default + Send + Sync + 'static {
    /// How many quantities there are.
    const QUANTITIES: usize;

    /// The quantity with this number.
    ///
    /// # Panics
    /// If there is none.
    fn quantity(&self, number: usize) -> &Lanes<T>;
    /// As [`Batch::quantity`].
    fn quantity_mut(&mut self, number: usize) -> &mut Lanes<T>;
}

/// A batch that a kernel reads.
pub trait Input<T: Real>: Batch<T> {
    /// Lanes in use, from the first on: 1 to [`LANES`].
    fn count(&self) -> usize;
    /// Whether the lanes in use are within `domain`, as far as this question asks for it.
    fn is_within(&self, domain: &[Interval; 3]) -> bool;
}

/// A batch that a kernel writes. Up to four masks of [`LANES`] bits follow the quantities, the
/// lowest bit of each for the first lane; where there are any, 64 bits are written at once, so that
/// none of them is waited for when it is read.
pub trait Output<T: Real>: Batch<T> {
    /// How many masks there are.
    const MASKS: usize;

    /// The mask with this number.
    ///
    /// # Panics
    /// If there is none.
    fn mask(&self, number: usize) -> u16;
    /// As [`Output::mask`].
    fn mask_mut(&mut self, number: usize) -> &mut u16;
}

macro_rules! batch {
    ($(#[$doc:meta])* $name:ident {
        $($(#[$quantity_doc:meta])* $quantity:ident: $type:ty = $quantities:literal,)*
        ; $($(#[$word_doc:meta])* $word:ident: $word_type:ty,)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        #[repr(C, align(64))]
        pub struct $name<T: Real = f32> {
            $($(#[$quantity_doc])* pub $quantity: $type,)*
            $($(#[$word_doc])* pub $word: $word_type,)*
        }

        impl<T: Real> sealed::Sealed for $name<T> {}

        impl<T: Real> Batch<T> for $name<T> {
            const QUANTITIES: usize = 0 $(+ $quantities)*;

            fn quantity(&self, number: usize) -> &Lanes<T> {
                let all: &[&[Lanes<T>]] = &[$(self.$quantity.as_ref()),*];
                all.iter().copied().flatten().nth(number).expect("a quantity of this batch")
            }

            fn quantity_mut(&mut self, number: usize) -> &mut Lanes<T> {
                let all: Vec<&mut [Lanes<T>]> = vec![$(self.$quantity.as_mut()),*];
                all.into_iter().flatten().nth(number).expect("a quantity of this batch")
            }
        }
    };
}

macro_rules! output {
    ($name:ty: $($mask:ident),*) => {
        impl<T: Real> Output<T> for $name {
            const MASKS: usize = 0 $(+ { let _ = stringify!($mask); 1 })*;

            fn mask(&self, number: usize) -> u16 {
                let all: &[u16] = &[$(self.$mask),*];
                all[number]
            }

            fn mask_mut(&mut self, number: usize) -> &mut u16 {
                let all: Vec<&mut u16> = vec![$(&mut self.$mask),*];
                all.into_iter().nth(number).expect("a mask of this batch")
            }
        }
    };
}

output!(Enclosures<T>: nowhere, defined, continuous);
output!(Zeros: possible, unbounded, jumping);
output!(GradientEnclosures<T>: lipschitz, differentiable);
output!(Contractions<T>: possible, crossing);
output!(Planes<T>: possible, crossing);
output!(Values<T>:);
output!(Gradients<T>:);

batch! {
    /// Boxes. Each coordinate is the pair (−lo, hi), so that rounding both up rounds outward.
    Boxes {
        /// Per axis, the negated lower ends.
        neg_lo: [Lanes<T>; 3] = 3,
        /// Per axis, the upper ends.
        hi: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in use.
        count: u32,
    }
}

batch! {
    /// Points.
    Points {
        /// Per axis, the coordinates.
        at: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in use.
        count: u32,
    }
}

batch! {
    /// Segments of rays: the points origin + t·direction, for t from `near` to `far`. Each
    /// coordinate of the real point is within `error` of that for the real numbers that these
    /// floats are; and `error` has room for what a kernel rounds on its way to the point
    /// ([`Segments::allow_rounding`]).
    Segments {
        /// Per axis, where t is 0.
        origin: [Lanes<T>; 3] = 3,
        /// Per axis, the way from t to t + 1.
        direction: [Lanes<T>; 3] = 3,
        /// Per axis, how far the point may be off.
        error: [Lanes<T>; 3] = 3,
        /// The lower end.
        near: Lanes<T> = 1,
        /// The upper end.
        far: Lanes<T> = 1,
        ;
        /// Lanes in use.
        count: u32,
    }
}

batch! {
    /// Tiles of rays, each a segment deep: the points `o + a·o₁ + b·o₂ + t·(d + a·d₁ + b·d₂)`, for
    /// screen coordinates (a, b) within `half` of `centre`, and t from `near` to `far`. As in
    /// [`Segments`], within `error`.
    ///
    /// The frame of the picture is the same in all lanes.
    Tiles {
        /// The screen coordinates of the tile's centre.
        centre: [Lanes<T>; 2] = 2,
        /// How far the tile reaches on either side of it.
        half: [Lanes<T>; 2] = 2,
        /// The lower end of t.
        near: Lanes<T> = 1,
        /// The upper end.
        far: Lanes<T> = 1,
        /// `o`, `oₐ` and `o_b`; per axis.
        origin: [Lanes<T>; 9] = 9,
        /// `d`, `dₐ` and `d_b`; per axis.
        direction: [Lanes<T>; 9] = 9,
        /// Per axis, how far the point may be off.
        error: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in use.
        count: u32,
    }
}

batch! {
    /// Where zeros may lie on segments. Masks have a bit per lane, the lowest for the first.
    Contractions {
        /// The lower end of the part that may hold zeros.
        near: Lanes<T> = 1,
        /// Its upper end.
        far: Lanes<T> = 1,
        ;
        /// Lanes that may have a zero: where the bit is clear, there is none in the part of the
        /// segment that lies in the domain.
        possible: u16,
        /// Lanes in which, if all of the segment lies in the domain, the function is continuous on
        /// it, and its values at the two ends have opposite signs, neither of them 0.
        crossing: u16,
    }
}

batch! {
    /// Where zeros may lie in tiles, and by what linear function: with symbols `εₐ`, `ε_b` and `ε`
    /// from −1 to 1 for the two screen axes and for t = `middle` + `half`·ε, the function's value
    /// is within `error` of `value` + Σ `slope`·ε.
    Planes {
        /// The lower end of the part of t that may hold zeros, on any ray of the tile.
        near: Lanes<T> = 1,
        /// Its upper end.
        far: Lanes<T> = 1,
        /// In the centre of the tile.
        value: Lanes<T> = 1,
        /// What a symbol adds: the two screen axes, then t.
        slope: [Lanes<T>; 3] = 3,
        /// How far the function may be off.
        error: Lanes<T> = 1,
        /// The middle of the segment.
        middle: Lanes<T> = 1,
        /// At least half its length.
        half: Lanes<T> = 1,
        ;
        /// As in [`Contractions`], for all rays of the tile.
        possible: u16,
        /// As in [`Contractions`], on every ray of the tile.
        crossing: u16,
    }
}

batch! {
    /// What is known of a function over boxes. Masks have a bit per lane, the lowest for the first.
    Enclosures {
        /// The negated lower ends; never NaN, never −∞ (where the function is defined nowhere, they
        /// say nothing).
        neg_lo: Lanes<T> = 1,
        /// The upper ends; never NaN, never −∞.
        hi: Lanes<T> = 1,
        ;
        /// Lanes in which the function is defined nowhere in the box.
        nowhere: u16,
        /// Lanes in which it is defined throughout the box.
        defined: u16,
        /// Lanes in which it is defined throughout the box, and continuous.
        continuous: u16,
    }
}

/// Where a function may vanish. Masks have a bit per lane, the lowest for the first.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Zeros {
    /// Lanes in which it may have a zero: where the bit is clear, it is proven to have none in the
    /// box.
    pub possible: u16,
    /// Lanes in which no finite bounds of it are known: perhaps an asymptote, and no zero.
    pub unbounded: u16,
    /// Lanes in which it is not known to be continuous.
    pub jumping: u16,
}

impl sealed::Sealed for Zeros {}

impl<T: Real> Batch<T> for Zeros {
    const QUANTITIES: usize = 0;

    fn quantity(&self, _: usize) -> &Lanes<T> {
        unreachable!("zeros have no quantities")
    }

    fn quantity_mut(&mut self, _: usize) -> &mut Lanes<T> {
        unreachable!("zeros have no quantities")
    }
}

batch! {
    /// A function and its gradient over boxes. Masks have a bit per lane, the lowest for the first.
    GradientEnclosures {
        /// The negated lower ends of the function.
        neg_lo: Lanes<T> = 1,
        /// Its upper ends.
        hi: Lanes<T> = 1,
        /// Per axis, the negated lower ends of the partial derivatives.
        gradient_neg_lo: [Lanes<T>; 3] = 3,
        /// Per axis, their upper ends.
        gradient_hi: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in which the function is Lipschitz continuous in the box. Only there do the bounds
        /// of the gradient mean anything: it is within them wherever it exists.
        lipschitz: u16,
        /// Lanes in which it is differentiable at each point of the box, towards points of the box
        /// at least.
        differentiable: u16,
    }
}

batch! {
    /// Values of a function at points. NaN where it is undefined, or infinite at a pole.
    Values {
        /// The values.
        value: Lanes<T> = 1,
        ;
    }
}

batch! {
    /// Values and gradients at points. NaN or infinite where they do not exist.
    Gradients {
        /// The values.
        value: Lanes<T> = 1,
        /// Per axis, the partial derivatives.
        gradient: [Lanes<T>; 3] = 3,
        ;
    }
}

/// Units of the sum of the magnitudes of all terms of a coordinate that a kernel may round it by:
/// each term is rounded up to six times, by up to a unit of itself.
pub const PATH_UNITS: f64 = 8.0;

/// `error` and what a kernel rounds a coordinate by: its terms have magnitudes of this sum, what is
/// met on the way to it is at most `met`, and what underflows is multiplied by up to `scale`.
#[inline]
fn with_rounding<T: Real>(error: T, magnitude: f64, met: f64, scale: f64) -> T {
    let [least, largest]: [f64; 2] = [T::LEAST_NORMAL, T::LARGEST].map(Into::into);
    if met.max(magnitude) >= largest / 2.0 {
        return T::above(f64::INFINITY);
    }
    T::above(error.into() + PATH_UNITS * T::UNIT * magnitude + least * scale)
}

impl<T: Real> Segments<T> {
    /// Adds to the errors what kernels round.
    pub fn allow_rounding(&mut self) {
        for lane in 0..LANES {
            let t = size(self.near[lane]).max(size(self.far[lane]));
            for axis in 0..3 {
                let [origin, direction] =
                    [&self.origin, &self.direction].map(|part| size(part[axis][lane]));
                let error = &mut self.error[axis][lane];
                *error = with_rounding(*error, origin + t * direction, 0.0, 1.0 + t);
            }
        }
    }
}

impl<T: Real> Tiles<T> {
    /// Adds to the errors what kernels round.
    pub fn allow_rounding(&mut self) {
        for lane in 0..(self.count as usize).min(LANES) {
            let t = size(self.near[lane]).max(size(self.far[lane]));
            let reach = |axis: usize| size(self.centre[axis][lane]) + size(self.half[axis][lane]);
            let (a, b) = (reach(0), reach(1));
            for axis in 0..3 {
                let sum = |parts: &[Lanes<T>; 9]| {
                    let base = size(parts[axis][lane]);
                    let across = size(parts[3 + axis][lane]);
                    let upward = size(parts[6 + axis][lane]);
                    (base + a * across + b * upward, base.max(across).max(upward))
                };
                let (origin, most) = sum(&self.origin);
                let (direction, more) = sum(&self.direction);
                let met = most.max(more);
                let scale = (1.0 + t) * (1.0 + a + b);
                let error = &mut self.error[axis][lane];
                *error = with_rounding(*error, origin + t * direction, scale * met, scale);
            }
        }
    }
}

#[inline]
fn size<T: Real>(number: T) -> f64 {
    let number: f64 = number.into();
    number.abs()
}

impl<T: Real> Enclosures<T> {
    /// What is proven of the function over one box.
    pub fn facts(&self, lane: usize) -> Facts {
        [
            (self.nowhere, Facts::NOWHERE),
            (self.defined, Facts::DEFINED),
            (self.continuous, Facts::CONTINUOUS),
        ]
        .into_iter()
        .filter(|(mask, _)| mask >> lane & 1 == 1)
        .fold(Facts::NONE, |facts, (_, fact)| facts | fact)
    }
}

impl<T: Real> Boxes<T> {
    /// Batches of these boxes, in order; their ends rounded outward.
    pub fn around(boxes: &[[Interval; 3]]) -> Vec<Self> {
        let batches = boxes.chunks(LANES).map(|chunk| {
            let mut batch = Self { count: chunk.len() as u32, ..Self::default() };
            for (lane, bounds) in chunk.iter().enumerate() {
                for (axis, bounds) in bounds.iter().enumerate() {
                    batch.neg_lo[axis][lane] = T::above(-bounds.lo);
                    batch.hi[axis][lane] = T::above(bounds.hi);
                }
            }
            batch
        });
        batches.collect()
    }

    /// The boxes of these lanes, in order; at least one.
    pub(crate) fn gathered(&self, lanes: u16) -> Self {
        let mut out = Self { count: lanes.count_ones(), ..Self::default() };
        for (to, lane) in (0..LANES).filter(|lane| lanes >> lane & 1 == 1).enumerate() {
            for axis in 0..3 {
                out.neg_lo[axis][to] = self.neg_lo[axis][lane];
                out.hi[axis][to] = self.hi[axis][lane];
            }
        }
        out
    }
}

impl<T: Real> Points<T> {
    /// Batches of these points, in order; coordinates rounded to nearest.
    pub fn near<P: Copy + Into<[f64; 3]>>(points: &[P]) -> Vec<Self> {
        let batches = points.chunks(LANES).map(|chunk| {
            let mut batch = Self { count: chunk.len() as u32, ..Self::default() };
            for (lane, point) in chunk.iter().enumerate() {
                let point: [f64; 3] = (*point).into();
                for (axis, coordinate) in point.into_iter().enumerate() {
                    batch.at[axis][lane] = T::nearest(coordinate);
                }
            }
            batch
        });
        batches.collect()
    }
}

impl<T: Real> Input<T> for Boxes<T> {
    #[inline]
    fn count(&self) -> usize {
        self.count as usize
    }

    fn is_within(&self, domain: &[Interval; 3]) -> bool {
        let inside = |lane: usize, axis: usize| {
            let (neg_lo, hi) = (self.neg_lo[axis][lane].into(), self.hi[axis][lane].into());
            neg_lo <= -domain[axis].lo && hi <= domain[axis].hi
        };
        (0..self.count()).all(|lane| (0..3).all(|axis| inside(lane, axis)))
    }
}

macro_rules! input_anywhere {
    ($name:ident) => {
        impl<T: Real> Input<T> for $name<T> {
            #[inline]
            fn count(&self) -> usize {
                self.count as usize
            }

            /// Samples bound nothing, and what is answered of rays holds for those points that lie
            /// in the domain.
            fn is_within(&self, _: &[Interval; 3]) -> bool {
                true
            }
        }
    };
}

input_anywhere!(Points);
input_anywhere!(Segments);
input_anywhere!(Tiles);

mod sealed {
    pub trait Sealed {}
}
