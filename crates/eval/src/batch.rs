//! The data that kernels read and write: batches of 16 lanes, whatever the width of a register.
//!
//! In a batch each quantity is contiguous and aligned to 64 bytes. A kernel processes a register at
//! a time, up to the number of lanes in use. Results in other lanes are meaningless.

use crate::lanes::{LANES, Lanes};
use crate::real::Real;
use zeroset_interval::{Facts, Interval};

/// Memory that a kernel reads or writes. It begins with a number of quantities, each a value per
/// lane.
///
/// Only the types of this module implement this trait. They are `repr(C)`: quantity k starts `k`
/// times the size of [`Lanes`] after the beginning.
pub trait Batch<T: Real>: sealed::Sealed + Clone + Default + Send + Sync + 'static {
    /// Number of quantities.
    const QUANTITIES: usize;

    /// Returns the quantity with this number.
    ///
    /// # Panics
    /// If there is no such quantity.
    fn quantity(&self, number: usize) -> &Lanes<T>;
    /// Like [`Batch::quantity`], but mutable.
    fn quantity_mut(&mut self, number: usize) -> &mut Lanes<T>;
}

/// A batch that a kernel reads.
pub trait Input<T: Real>: Batch<T> {
    /// Number of lanes in use, from the first on: 1 to [`LANES`].
    fn count(&self) -> usize;
    /// Returns whether the lanes in use are within `domain`. Always true for queries that do not
    /// need this.
    fn is_within(&self, domain: &[Interval; 3]) -> bool;
}

/// A batch that a kernel writes. Up to four masks of [`LANES`] bits follow the quantities; the
/// lowest bit is for the first lane. Kernels write all masks as one word of 64 bits, so that
/// reading a mask need not wait for several writes.
pub trait Output<T: Real>: Batch<T> {
    /// Number of masks.
    const MASKS: usize;

    /// Returns the mask with this number.
    ///
    /// # Panics
    /// If there is no such mask.
    fn mask(&self, number: usize) -> u16;
    /// Like [`Output::mask`], but mutable.
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
    /// Segments of rays: the points origin + t·direction, for t from `near` to `far`. `error`
    /// bounds, per coordinate, how far the real point may be from that sum, computed exactly from
    /// these floats. It includes the rounding in kernels ([`Segments::allow_rounding`]).
    Segments {
        /// Per axis, the point at t = 0.
        origin: [Lanes<T>; 3] = 3,
        /// Per axis, the change of the point while t grows by 1.
        direction: [Lanes<T>; 3] = 3,
        /// Per axis, the largest error of the point.
        error: [Lanes<T>; 3] = 3,
        /// Lower end of t.
        near: Lanes<T> = 1,
        /// Upper end of t.
        far: Lanes<T> = 1,
        ;
        /// Lanes in use.
        count: u32,
    }
}

batch! {
    /// Tiles of rays, each a segment deep: the points `o + a·oₐ + b·o_b + t·(d + a·dₐ + b·d_b)`,
    /// for screen coordinates (a, b) within `half` of `centre`, and t from `near` to `far`. Points
    /// are within `error` of these, as in [`Segments`].
    ///
    /// The origins and directions are the same in all lanes, since they belong to one picture.
    Tiles {
        /// Screen coordinates of the tile's center.
        centre: [Lanes<T>; 2] = 2,
        /// Half the extent of the tile, per screen axis.
        half: [Lanes<T>; 2] = 2,
        /// Lower end of t.
        near: Lanes<T> = 1,
        /// Upper end of t.
        far: Lanes<T> = 1,
        /// `o`, `oₐ` and `o_b`, each per axis.
        origin: [Lanes<T>; 9] = 9,
        /// `d`, `dₐ` and `d_b`, each per axis.
        direction: [Lanes<T>; 9] = 9,
        /// Per axis, the largest error of the point.
        error: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in use.
        count: u32,
    }
}

batch! {
    /// The parts of segments that may hold zeros. Masks have a bit per lane, the lowest for the
    /// first.
    Contractions {
        /// Lower end of the part that may hold zeros.
        near: Lanes<T> = 1,
        /// Upper end of the part that may hold zeros.
        far: Lanes<T> = 1,
        ;
        /// Lanes that may have a zero. If the bit is clear, the segment has no zero in the domain.
        possible: u16,
        /// Lanes proven to have a zero if the whole segment lies in the domain: the function is
        /// continuous on it, and its values at the two ends have opposite signs, neither of them 0.
        crossing: u16,
    }
}

batch! {
    /// Where zeros may lie in tiles, and a linear approximation of the function. It has symbols
    /// `εₐ`, `ε_b` and `ε` from −1 to 1, for the two screen axes and for t = `middle` + `half`·ε.
    /// The function's value is within `error` of `value` + Σ `slope`·ε.
    Planes {
        /// Lower end of the part of t that may hold zeros, on any ray of the tile.
        near: Lanes<T> = 1,
        /// Upper end of that part.
        far: Lanes<T> = 1,
        /// Value of the approximation where all symbols are 0.
        value: Lanes<T> = 1,
        /// Coefficient of each symbol: the two screen axes, then t.
        slope: [Lanes<T>; 3] = 3,
        /// Largest error of the linear approximation.
        error: Lanes<T> = 1,
        /// Middle of the segment of t.
        middle: Lanes<T> = 1,
        /// At least half the length of the segment.
        half: Lanes<T> = 1,
        ;
        /// Lanes that may have a zero on some ray of the tile, as in [`Contractions`].
        possible: u16,
        /// Lanes proven to have a zero on every ray of the tile, as in [`Contractions`].
        crossing: u16,
    }
}

batch! {
    /// Bounds of a function over boxes, and facts. Masks have a bit per lane, the lowest for the
    /// first.
    Enclosures {
        /// Negated lower ends: never NaN, never −∞. Meaningless if the function is defined nowhere.
        neg_lo: Lanes<T> = 1,
        /// Upper ends: never NaN, never −∞.
        hi: Lanes<T> = 1,
        ;
        /// Lanes in which the function is defined nowhere in the box.
        nowhere: u16,
        /// Lanes in which the function is defined throughout the box.
        defined: u16,
        /// Lanes in which the function is defined and continuous throughout the box.
        continuous: u16,
    }
}

/// Results of tests for zeros in boxes. Masks have a bit per lane, the lowest for the first.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Zeros {
    /// Lanes that may have a zero. If the bit is clear, the box holds no zero.
    pub possible: u16,
    /// Lanes without known finite bounds: perhaps there is an asymptote and no zero.
    pub unbounded: u16,
    /// Lanes in which the function is not known to be continuous.
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
    /// Bounds of a function and its gradient over boxes. Masks have a bit per lane, the lowest for
    /// the first.
    GradientEnclosures {
        /// Negated lower ends of the function.
        neg_lo: Lanes<T> = 1,
        /// Upper ends of the function.
        hi: Lanes<T> = 1,
        /// Per axis, the negated lower ends of the partial derivative.
        gradient_neg_lo: [Lanes<T>; 3] = 3,
        /// Per axis, the upper ends of the partial derivative.
        gradient_hi: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in which the function is Lipschitz continuous in the box. Only there do the bounds
        /// of the gradient hold, at all points where it exists.
        lipschitz: u16,
        /// Lanes in which the function is differentiable at each point of the box, at least toward
        /// other points of the box.
        differentiable: u16,
    }
}

batch! {
    /// Values of a function at points: NaN where it is undefined, or infinite at a pole.
    Values {
        /// The values.
        value: Lanes<T> = 1,
        ;
    }
}

batch! {
    /// Values and gradients at points: NaN or infinite where they do not exist.
    Gradients {
        /// The values.
        value: Lanes<T> = 1,
        /// Per axis, the partial derivatives.
        gradient: [Lanes<T>; 3] = 3,
        ;
    }
}

/// Largest rounding error of a coordinate in a kernel, in units ([`Real::UNIT`]) of the summed
/// magnitudes of its terms. Each term is rounded up to six times. Each rounding errs by at most one
/// unit of the term.
pub const PATH_UNITS: f64 = 8.0;

/// Adds the rounding error of a coordinate in a kernel to `error`. `magnitude` is the sum of its
/// terms' magnitudes, and `met` the largest magnitude of an intermediate result. Errors by
/// underflow are at most `scale` times the least normal number.
#[inline]
fn with_rounding<T: Real>(error: T, magnitude: f64, met: f64, scale: f64) -> T {
    let [least, largest]: [f64; 2] = [T::LEAST_NORMAL, T::LARGEST].map(Into::into);
    if met.max(magnitude) >= largest / 2.0 {
        return T::above(f64::INFINITY);
    }
    T::above(error.into() + PATH_UNITS * T::UNIT * magnitude + least * scale)
}

impl<T: Real> Segments<T> {
    /// Adds the rounding errors of kernels to `error`.
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
    /// Adds the rounding errors of kernels to `error`.
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
    /// The facts that are proven about the function over one box.
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
    /// Returns batches of `boxes`, in order, with ends rounded outward.
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

    /// Returns a batch of the boxes in `lanes`, in order. There must be at least one.
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
    /// Returns batches of `points`, in order, with coordinates rounded to nearest.
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

            /// Samples carry no bounds, and results for rays only hold inside the domain.
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
