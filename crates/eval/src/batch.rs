//! The data that kernels read and write: batches of 16 lanes, whatever the width of a register.
//!
//! Each quantity of a batch is contiguous and aligned to 64 bytes. A kernel processes one register
//! after another, up to the number of lanes in use. Results in other lanes are meaningless.

use crate::dispatch;
use crate::lanes::{LANES, Lanes};
use crate::real::Real;
use crate::shorten::LaneSet;
use fearless_simd::Level;
use zeroset_interval::{Facts, Interval, PATH_UNITS};

/// Memory that a kernel reads or writes. It begins with quantities, which have a value per lane.
///
/// Only the types of this module implement this trait. They are `repr(C)`: quantity k is at offset
/// `k` times the size of [`Lanes`].
pub trait Batch<T: Real>: sealed::Sealed + Clone + Default + Send + Sync + 'static {
    /// Number of quantities of the batch.
    const QUANTITIES: usize;

    /// Returns the quantity with this number.
    ///
    /// # Panics
    /// If there is no such quantity.
    fn quantity(&self, number: usize) -> &Lanes<T>;
    /// Mutable version of [`Batch::quantity`].
    fn quantity_mut(&mut self, number: usize) -> &mut Lanes<T>;
}

/// A batch that a kernel reads.
pub trait Input<T: Real>: Batch<T> {
    /// Number of lanes in use, from 1 to [`LANES`]. They are the first lanes of the batch.
    fn count(&self) -> usize;
    /// Returns whether the lanes in use are within `domain`, whose ends are numbers of `T`. Always
    /// true if the query does not need it.
    fn is_within(&self, domain: &[Interval; 3]) -> bool;
}

/// A batch that a kernel writes. Up to four masks of [`LANES`] bits follow the quantities. The
/// lowest bit of a mask is for the first lane. Kernels write all masks as one word of 64 bits, so
/// reading a mask need not wait for several writes.
pub trait Output<T: Real>: Batch<T> {
    /// Number of masks of the batch.
    const MASKS: usize;

    /// Returns the mask with this number.
    ///
    /// # Panics
    /// If there is no such mask.
    fn mask(&self, number: usize) -> u16;
    /// Mutable version of [`Output::mask`].
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
                let all: [&mut [Lanes<T>]; 0 $(+ { let _ = stringify!($quantity); 1 })*] =
                    [$(self.$quantity.as_mut()),*];
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
                let all: [&mut u16; 0 $(+ { let _ = stringify!($mask); 1 })*] =
                    [$(&mut self.$mask),*];
                all.into_iter().nth(number).expect("a mask of this batch")
            }
        }
    };
}

output!(Enclosures<T>: nowhere, defined, continuous);
output!(Zeros: possible, unbounded, jumping);
output!(GradientEnclosures<T>: lipschitz, differentiable);
output!(Contractions<T>: possible, crossing);
output!(Planes<T>: possible, crossing, jumping);
output!(Patches<T>: nowhere, continuous);
output!(BranchSigns<T>: possible, below, above);
output!(Values<T>:);
output!(Gradients<T>:);

batch! {
    /// Boxes. Each coordinate is stored as −lo and hi, so that rounding both up rounds outward.
    Boxes {
        /// Per axis, the negated lower ends of the boxes.
        neg_lo: [Lanes<T>; 3] = 3,
        /// Per axis, the upper ends of the boxes.
        hi: [Lanes<T>; 3] = 3,
        ;
        /// Number of lanes in use.
        count: u32,
    }
}

batch! {
    /// Points.
    Points {
        /// Per axis, the coordinates of the points.
        at: [Lanes<T>; 3] = 3,
        ;
        /// Number of lanes in use.
        count: u32,
    }
}

batch! {
    /// Segments of rays. A segment holds the points origin + t·direction, for t from `near` to
    /// `far`. In each coordinate the real point is within `error` of this sum. The error includes
    /// rounding in kernels ([`Segments::allow_rounding`]).
    Segments {
        /// Per axis, the coordinate of the ray's point at t = 0.
        origin: [Lanes<T>; 3] = 3,
        /// Per axis, the change of the coordinate if t grows by 1.
        direction: [Lanes<T>; 3] = 3,
        /// Per axis, the largest error of the coordinate.
        error: [Lanes<T>; 3] = 3,
        /// Lower end of the segment's range of t.
        near: Lanes<T> = 1,
        /// Upper end of the segment's range of t.
        far: Lanes<T> = 1,
        ;
        /// Number of lanes in use.
        count: u32,
    }
}

batch! {
    /// Tiles of rays, cut to a range of t. A tile holds the points
    /// `o + a·oₐ + b·o_b + t·(d + a·dₐ + b·d_b)`, for screen coordinates (a, b) within `half` of
    /// `centre` and t from `near` to `far`. Real points are within `error` of these points, as in
    /// [`Segments`].
    ///
    /// Origins and directions are the same in all lanes, since all tiles belong to one picture.
    Tiles {
        /// Screen coordinates of the tile's center.
        centre: [Lanes<T>; 2] = 2,
        /// Half the extent of the tile, per screen axis.
        half: [Lanes<T>; 2] = 2,
        /// Lower end of the tile's range of t.
        near: Lanes<T> = 1,
        /// Upper end of the tile's range of t.
        far: Lanes<T> = 1,
        /// The components of `o`, then those of `oₐ`, then those of `o_b`.
        origin: [Lanes<T>; 9] = 9,
        /// The components of `d`, then those of `dₐ`, then those of `d_b`.
        direction: [Lanes<T>; 9] = 9,
        /// Per axis, the largest error of a point's coordinate.
        error: [Lanes<T>; 3] = 3,
        ;
        /// Number of lanes in use.
        count: u32,
    }
}

batch! {
    /// The parts of segments that may hold zeros. Bit k of a mask is for lane k.
    Contractions {
        /// Lower end of t in the part that may hold zeros.
        near: Lanes<T> = 1,
        /// Upper end of t in the part that may hold zeros.
        far: Lanes<T> = 1,
        ;
        /// Lanes whose segment may have a zero. In other lanes the segment has no zero in the
        /// domain.
        possible: u16,
        /// Lanes whose segment is proven to have a zero, provided that the whole segment lies in
        /// the domain. The function is then continuous on it, and has values of opposite signs at
        /// its ends.
        crossing: u16,
    }
}

batch! {
    /// The parts of tiles that may hold zeros, and a linear approximation of the function. Its
    /// symbols `εₐ`, `ε_b` and `ε` run from −1 to 1: two along the screen axes, the last along t =
    /// `middle` + `half`·ε. The function is within `error` of `value` + Σ `slope`·symbol.
    Planes {
        /// Lower end of t in the part that may hold zeros, on any ray of the tile.
        near: Lanes<T> = 1,
        /// Upper end of t in that part, on any ray of the tile.
        far: Lanes<T> = 1,
        /// Value of the approximation if all symbols are 0.
        value: Lanes<T> = 1,
        /// Coefficient of each symbol, in the order `εₐ`, `ε_b`, `ε`.
        slope: [Lanes<T>; 3] = 3,
        /// Largest error of the linear approximation.
        error: Lanes<T> = 1,
        /// Middle of the tile's range of t.
        middle: Lanes<T> = 1,
        /// At least half the length of the tile's range of t.
        half: Lanes<T> = 1,
        ;
        /// Lanes whose tile may have a zero on some ray, as in [`Contractions`].
        possible: u16,
        /// Lanes whose tile is proven to have a zero on every ray, as in [`Contractions`].
        crossing: u16,
        /// Lanes in which the function is not known to be continuous.
        jumping: u16,
    }
}

batch! {
    /// Linear approximations of the points of a surface over cells of its parameters. With symbols
    /// U and V from −1 to 1, u = `middle[0]` + `half[0]`·U and v = `middle[1]` + `half[1]`·V
    /// exactly. Coordinate k of the point is within `error[k]` of `centre[k]` + `along_u[k]`·U +
    /// `along_v[k]`·V, wherever it is defined and (u, v) is in the domain of the code. If a number
    /// of a coordinate is not finite, nothing is claimed of that coordinate. The range of u or v
    /// may exceed the cell by rounding.
    Patches {
        /// The middles of the ranges of u and v.
        middle: [Lanes<T>; 2] = 2,
        /// Half the lengths of the ranges of u and v.
        half: [Lanes<T>; 2] = 2,
        /// Per axis, the approximation's value at the middle.
        centre: [Lanes<T>; 3] = 3,
        /// Per axis, the change from the middle to the end of the range of u.
        along_u: [Lanes<T>; 3] = 3,
        /// Per axis, the change from the middle to the end of the range of v.
        along_v: [Lanes<T>; 3] = 3,
        /// Per axis, the largest error of the approximation.
        error: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in which some coordinate is defined nowhere in the cell: it has no point.
        nowhere: u16,
        /// Lanes in which all coordinates are defined and continuous in the whole cell.
        continuous: u16,
    }
}

batch! {
    /// Bounds of a function over boxes, and facts. Bit k of a mask is for lane k.
    Enclosures {
        /// Negated lower bounds, never NaN and never −∞. If the function is defined nowhere in the
        /// box, they are meaningless.
        neg_lo: Lanes<T> = 1,
        /// Upper bounds, never NaN and never −∞.
        hi: Lanes<T> = 1,
        ;
        /// Lanes in which the function is defined nowhere in the box.
        nowhere: u16,
        /// Lanes in which the function is defined in the whole box.
        defined: u16,
        /// Lanes in which the function is defined and continuous in the whole box.
        continuous: u16,
    }
}

/// Results of tests for zeros in boxes. Bit k of a mask is for lane k.
#[derive(Clone, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Zeros {
    /// Lanes whose box may hold a zero. In other lanes the box holds no zero.
    pub possible: u16,
    /// Lanes without finite bounds of the function: the box may hold a pole instead of a zero.
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
    /// Results for one combination of branches. Bit k of a mask is for lane k.
    BranchSigns {
        /// The choices between branches that steps make in the box, as a sum: 2ᵏ for choice k.
        choices: Lanes<T> = 1,
        ;
        /// Lanes whose box may hold a zero in this combination.
        possible: u16,
        /// Lanes in which the function is defined and below 0 in this combination.
        below: u16,
        /// Lanes in which the function is above 0 or undefined in this combination.
        above: u16,
    }
}

batch! {
    /// Bounds of a function and its gradient over boxes. Bit k of a mask is for lane k.
    GradientEnclosures {
        /// Negated lower bounds of the function.
        neg_lo: Lanes<T> = 1,
        /// Upper bounds of the function.
        hi: Lanes<T> = 1,
        /// Per axis, the negated lower bounds of the partial derivative.
        gradient_neg_lo: [Lanes<T>; 3] = 3,
        /// Per axis, the upper bounds of the partial derivative.
        gradient_hi: [Lanes<T>; 3] = 3,
        ;
        /// Lanes in which the function is Lipschitz continuous in the box. Only in these lanes do
        /// the gradient's bounds hold, at each point where the gradient exists.
        lipschitz: u16,
        /// Lanes in which the function is differentiable at each point of the box. On the boundary,
        /// derivatives may be one-sided.
        differentiable: u16,
    }
}

batch! {
    /// Values of a function at points: NaN where it is undefined, but infinite at a pole.
    Values {
        /// The function's values.
        value: Lanes<T> = 1,
        ;
    }
}

batch! {
    /// Values and gradients of a function at points: NaN or infinite where they do not exist.
    Gradients {
        /// The function's values.
        value: Lanes<T> = 1,
        /// Per axis, the partial derivatives of the function.
        gradient: [Lanes<T>; 3] = 3,
        ;
    }
}

/// Adds to `error` a bound on a coordinate's rounding error in a kernel. `magnitude` is the sum of
/// the magnitudes of the coordinate's terms. `met` is the largest magnitude of an intermediate
/// result. Errors by underflow are at most `scale` times the least normal number.
#[inline(always)]
fn with_rounding<T: Real>(error: T, magnitude: f64, met: f64, scale: f64) -> T {
    let (least, largest): (f64, f64) = (T::LEAST_NORMAL.into(), T::LARGEST.into());
    let bound = error.into() + PATH_UNITS * T::UNIT * magnitude + least * scale;
    let overflows = met.max(magnitude) >= largest / 2.0;
    T::above(if overflows { f64::INFINITY } else { bound })
}

impl<T: Real> Segments<T> {
    /// Adds bounds on the rounding errors of kernels to `error`.
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

impl Patches<f64> {
    /// The largest error of a coordinate over the cell of a lane: infinite if one is no number.
    pub fn largest_error(&self, lane: usize) -> f64 {
        let [x, y, z] = [self.error[0].0[lane], self.error[1].0[lane], self.error[2].0[lane]];
        if (x + y + z).is_finite() { x.max(y).max(z) } else { f64::INFINITY }
    }

    /// The largest change of a coordinate over half the cell of a lane: along u, and along v.
    pub fn sides(&self, lane: usize) -> [f64; 2] {
        let side = |along: &[Lanes<f64>; 3]| {
            along[0].0[lane].abs().max(along[1].0[lane].abs()).max(along[2].0[lane].abs())
        };
        [side(&self.along_u), side(&self.along_v)]
    }

    /// Sets a lane to that of another batch.
    pub fn copy_lane(&mut self, lane: usize, other: &Self, from: usize) {
        for axis in 0..3 {
            self.centre[axis].0[lane] = other.centre[axis].0[from];
            self.along_u[axis].0[lane] = other.along_u[axis].0[from];
            self.along_v[axis].0[lane] = other.along_v[axis].0[from];
            self.error[axis].0[lane] = other.error[axis].0[from];
        }
        for axis in 0..2 {
            self.middle[axis].0[lane] = other.middle[axis].0[from];
            self.half[axis].0[lane] = other.half[axis].0[from];
        }
        let bit = |set: u16, from: usize| (set >> from & 1) << lane;
        let others = !(1 << lane);
        self.nowhere = self.nowhere & others | bit(other.nowhere, from);
        self.continuous = self.continuous & others | bit(other.continuous, from);
    }

    /// Bounds of a coordinate over the cell of a lane, infinite if nothing is claimed.
    pub fn coordinate(&self, axis: usize, lane: usize) -> [f64; 2] {
        let centre = self.centre[axis][lane];
        let reach = self.along_u[axis][lane].abs()
            + self.along_v[axis][lane].abs()
            + self.error[axis][lane];
        // Four roundings to nearest.
        let slack = 4.0 * f64::EPSILON * (centre.abs() + reach);
        let [low, high] = [centre - reach - slack, centre + reach + slack];
        if low.is_finite() && high.is_finite() {
            [low, high]
        } else {
            [-f64::INFINITY, f64::INFINITY]
        }
    }
}

impl<T: Real> Tiles<T> {
    /// Returns boxes around the points of the tiles that are in `domain`, and the lanes of the
    /// tiles that have such points. In other lanes, the box is the domain.
    ///
    /// # Panics
    /// If no lanes are in use.
    pub fn boxes(&self, domain: &[Interval; 3]) -> (Boxes<T>, LaneSet) {
        assert!(self.count > 0, "a tile");
        let mut boxes = Boxes { count: self.count, ..Boxes::default() };
        let mut is_outside = [false; LANES];
        let level = Level::new();
        for (axis, bounds) in domain.iter().enumerate() {
            let ends = dispatch!(level, _simd => self.bounds_within(axis, *bounds));
            for (lane, [lo, hi]) in ends.into_iter().enumerate() {
                is_outside[lane] |= lo > hi;
                boxes.neg_lo[axis][lane] = T::above(-lo);
                boxes.hi[axis][lane] = T::above(hi);
            }
        }
        let mut inside = 0;
        for (lane, is_outside) in is_outside.into_iter().enumerate().take(self.count as usize) {
            if !is_outside {
                inside |= 1 << lane;
                continue;
            }
            for (axis, Interval { lo, hi }) in domain.iter().enumerate() {
                boxes.neg_lo[axis][lane] = T::above(-lo);
                boxes.hi[axis][lane] = T::above(*hi);
            }
        }
        (boxes, inside)
    }

    /// Bounds of a coordinate in each tile, cut to the domain. If a tile has no point in the
    /// domain, its lower bound is above its upper one.
    #[inline(always)]
    fn bounds_within(&self, axis: usize, domain: Interval) -> [[f64; 2]; LANES] {
        std::array::from_fn(|lane| {
            let [lo, hi] = self.bounds(axis, lane);
            // In this order of operations, NaN becomes a bound of the domain.
            [lo.max(domain.lo), hi.min(domain.hi)]
        })
    }

    /// Bounds of a coordinate of the points of a tile. They are NaN where numbers overflow.
    #[inline(always)]
    fn bounds(&self, axis: usize, lane: usize) -> [f64; 2] {
        let origin: [f64; 3] = [0, 3, 6].map(|part| self.origin[part + axis][lane].into());
        let direction: [f64; 3] = [0, 3, 6].map(|part| self.direction[part + axis][lane].into());
        let centre: [f64; 2] = [0, 1].map(|k| self.centre[k][lane].into());
        let half: [f64; 2] = [0, 1].map(|k| self.half[k][lane].into());
        let ends: [f64; 2] = [self.near[lane].into(), self.far[lane].into()];
        // For a fixed ray, coordinates grow or fall along t. So the ends of t suffice.
        let [near, far] = ends.map(|t| {
            let [base, across, upward]: [f64; 3] =
                std::array::from_fn(|k| origin[k] + t * direction[k]);
            let middle = base + centre[0] * across + centre[1] * upward;
            let reach = half[0] * across.abs() + half[1] * upward.abs();
            [middle - reach, middle + reach]
        });
        // The sum of the magnitudes of all terms. No term passes through more than eight roundings,
        // of at most EPSILON / 2 each, and this sum through as many.
        let t = ends[0].abs().max(ends[1].abs());
        let [base, across, upward]: [f64; 3] =
            std::array::from_fn(|k| origin[k].abs() + t * direction[k].abs());
        let (a, b) = (centre[0].abs() + half[0], centre[1].abs() + half[1]);
        let size = base + a * across + b * upward;
        let error: f64 = self.error[axis][lane].into();
        let slack = error * (1.0 + 4.0 * f64::EPSILON)
            + 8.0 * f64::EPSILON * size
            + f64::MIN_POSITIVE * (1.0 + a + b);
        [near[0].min(far[0]) - slack, near[1].max(far[1]) + slack]
    }

    /// Adds bounds on the rounding errors of kernels to `error`.
    pub fn allow_rounding(&mut self) {
        let lanes = (self.count as usize).min(LANES);
        for axis in 0..3 {
            let [origin, direction] = [&self.origin, &self.direction]
                .map(|parts| [&parts[axis], &parts[3 + axis], &parts[6 + axis]]);
            // Lanes are innermost, so this loop has neither calls nor branches.
            for lane in 0..lanes {
                let t = size(self.near[lane]).max(size(self.far[lane]));
                let a = size(self.centre[0][lane]) + size(self.half[0][lane]);
                let b = size(self.centre[1][lane]) + size(self.half[1][lane]);
                let (at, most) = sum(origin, lane, a, b);
                let (slope, more) = sum(direction, lane, a, b);
                let met = most.max(more);
                let scale = (1.0 + t) * (1.0 + a + b);
                let error = &mut self.error[axis][lane];
                *error = with_rounding(*error, at + t * slope, scale * met, scale);
            }
        }
    }
}

/// The sum of the magnitudes of a coordinate's terms in a lane, and the largest magnitude of its
/// parts. `a` and `b` are the largest magnitudes of screen coordinates.
#[inline(always)]
fn sum<T: Real>(parts: [&Lanes<T>; 3], lane: usize, a: f64, b: f64) -> (f64, f64) {
    let base = size(parts[0][lane]);
    let across = size(parts[1][lane]);
    let upward = size(parts[2][lane]);
    (base + a * across + b * upward, base.max(across).max(upward))
}

#[inline(always)]
fn size<T: Real>(number: T) -> f64 {
    let number: f64 = number.into();
    number.abs()
}

impl<T: Real> Enclosures<T> {
    /// The lanes in which the function may be 0.
    pub fn possible(&self) -> LaneSet {
        let is_apart = |lane: usize| {
            let [neg_lo, hi]: [f64; 2] = [self.neg_lo[lane].into(), self.hi[lane].into()];
            neg_lo < 0.0 || hi < 0.0
        };
        let apart =
            (0..LANES).filter(|&lane| is_apart(lane)).map(|lane| 1 << lane).sum::<LaneSet>();
        !apart & !self.nowhere
    }

    /// The facts that are proven about the function over the box of `lane`.
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
    /// Returns batches of all `boxes` in order, with ends rounded outward.
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

    /// Returns a batch of the boxes in `lanes`, in order. `lanes` must not be empty.
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
    /// Returns batches of all `points` in order, with coordinates rounded to nearest.
    pub fn near<P: Copy + Into<[f64; 3]>>(points: &[P]) -> Vec<Self> {
        let batches = points.chunks(LANES).map(|chunk| {
            let mut batch = Self::default();
            batch.set_near(chunk.iter().copied());
            batch
        });
        batches.collect()
    }

    /// Makes this a batch of `points`, with coordinates rounded to nearest.
    ///
    /// # Panics
    /// If there are more than [`LANES`] points.
    pub fn set_near<P: Into<[f64; 3]>>(&mut self, points: impl Iterator<Item = P>) {
        self.count = 0;
        for (lane, point) in points.enumerate() {
            let point: [f64; 3] = point.into();
            for (axis, coordinate) in point.into_iter().enumerate() {
                self.at[axis][lane] = T::nearest(coordinate);
            }
            self.count += 1;
        }
    }
}

impl<T: Real> Input<T> for Boxes<T> {
    #[inline]
    fn count(&self) -> usize {
        self.count as usize
    }

    #[inline]
    fn is_within(&self, domain: &[Interval; 3]) -> bool {
        // All lanes are compared, several at once, in their own format. Only lanes in use count.
        let mut inside = [true; LANES];
        for (axis, &Interval { lo, hi }) in domain.iter().enumerate() {
            let ends = [T::nearest(-lo), T::nearest(hi)];
            let (neg_lo, hi) = (&self.neg_lo[axis], &self.hi[axis]);
            for lane in 0..LANES {
                inside[lane] &= neg_lo[lane] <= ends[0];
                inside[lane] &= hi[lane] <= ends[1];
            }
        }
        inside[..self.count()].iter().fold(true, |all, inside| all & inside)
    }
}

macro_rules! input_anywhere {
    ($name:ident) => {
        impl<T: Real> Input<T> for $name<T> {
            #[inline]
            fn count(&self) -> usize {
                self.count as usize
            }

            /// Always true: samples carry no bounds, and results for rays hold only in the domain.
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
