//! Bounds of a function's values and slopes along rays.
//!
//! This module does not draw conclusions from the bounds.

use crate::kernel_stats::KernelStats;
use crate::method::Task;
use crate::scalar::Scalar;
use glam::DVec3;
use zeroset_eval::{
    Boxes, Enclose, EncloseGradient, Enclosures, GradientEnclosures, Kernel, KernelError, LANES,
};
use zeroset_interval::{Facts, Interval};

/// Kernels that bound one function and its gradient.
pub(super) struct SlopeKernels<'a, T: Scalar> {
    values: &'a dyn Kernel<Enclose, T>,
    gradients: &'a dyn Kernel<EncloseGradient, T>,
    /// The region's bounds on each axis as (−lo, hi), rounded outward.
    bounds: [[T; 2]; 3],
}

/// A box, as bounds of three coordinates.
pub(super) type Cuboid = [Interval; 3];

impl<'a, T: Scalar> SlopeKernels<'a, T> {
    pub fn new(task: &Task<'a>) -> Result<Self, KernelError> {
        let kernels = T::kernels(task.surface);
        let (low, high) = (task.region.low(), task.region.high());
        let bounds = [0, 1, 2].map(|axis| [-low[axis], high[axis]].map(T::above));
        Ok(Self { values: kernels.bounds()?, gradients: kernels.gradient_bounds()?, bounds })
    }

    /// Converts boxes to a batch. They are rounded outward and clipped to the region.
    pub fn batch(&self, boxes: &[Cuboid]) -> Boxes<T> {
        // Adding twice the error of rounding to nearest is several times as fast as rounding up.
        let above = |end: f64, bound: T| {
            let end = T::nearest(end + 2.0 * T::UNIT * end.abs() + T::LEAST_NORMAL.into());
            if end < bound { end } else { bound }
        };
        let mut batch = Boxes { count: boxes.len() as u32, ..Boxes::default() };
        for (lane, cuboid) in boxes.iter().enumerate() {
            for (axis, side) in cuboid.iter().enumerate() {
                let [neg_lo, hi] = self.bounds[axis];
                batch.neg_lo[axis][lane] = above(-side.lo, neg_lo);
                batch.hi[axis][lane] = above(side.hi, hi);
            }
        }
        batch
    }

    /// Returns the kernel that bounds values.
    pub fn kernel(&self) -> &'a dyn Kernel<Enclose, T> {
        self.values
    }

    /// Returns facts that hold for the function in a box.
    pub fn facts(&self, cuboid: &Cuboid, work: &mut KernelStats) -> Facts {
        let mut out = Enclosures::default();
        self.values.eval(&self.batch(&[*cuboid]), &mut out);
        work.interval.called(1);
        out.facts(0)
    }

    /// Returns bounds of the values in up to [`LANES`] boxes. Infinite if a value may be undefined.
    pub fn values(&self, boxes: &[Cuboid], work: &mut KernelStats) -> [Interval; LANES] {
        let mut values = [Interval::ENTIRE; LANES];
        if boxes.is_empty() {
            return values;
        }
        let mut out = Enclosures::default();
        self.values.eval(&self.batch(boxes), &mut out);
        work.interval.called(boxes.len() as u32);
        for (lane, value) in values.iter_mut().enumerate().take(boxes.len()) {
            if out.defined >> lane & 1 == 1 {
                let [neg_lo, hi]: [f64; 2] = [out.neg_lo[lane], out.hi[lane]].map(Into::into);
                *value = Interval { lo: -neg_lo, hi };
            }
        }
        values
    }

    /// Returns bounds of the slope in up to [`LANES`] boxes, each along its own direction. `None`
    /// for a box in which the function is not proven to be Lipschitz continuous.
    pub fn along(
        &self,
        boxes: &[Cuboid],
        direction: impl Fn(usize) -> DVec3,
        work: &mut KernelStats,
    ) -> [Option<Interval>; LANES] {
        let mut slopes = [None; LANES];
        if boxes.is_empty() {
            return slopes;
        }
        let mut out = GradientEnclosures::default();
        self.gradients.eval(&self.batch(boxes), &mut out);
        work.interval.called(boxes.len() as u32);
        for (lane, found) in slopes.iter_mut().enumerate().take(boxes.len()) {
            if out.lipschitz >> lane & 1 == 1 {
                *found = Some(slope(&out, lane, direction(lane)));
            }
        }
        slopes
    }
}

/// Returns bounds of the dot product of a gradient and a direction.
fn slope<T: Scalar>(out: &GradientEnclosures<T>, lane: usize, direction: DVec3) -> Interval {
    let (mut lo, mut hi, mut size) = (0.0, 0.0, 0.0);
    for axis in 0..3 {
        let d = direction[axis];
        // A gradient is finite if it exists, even if its bounds are infinite. So this product is 0.
        if d == 0.0 {
            continue;
        }
        let [neg_lo, most]: [f64; 2] =
            [out.gradient_neg_lo[axis][lane], out.gradient_hi[axis][lane]].map(Into::into);
        let [a, b] = [-neg_lo * d, most * d];
        lo += a.min(b);
        hi += a.max(b);
        size += a.abs().max(b.abs());
    }
    // The error of three products and two sums, and of underflow. Each operation rounds by at most
    // half a unit times `size`.
    let error = 4.0 * f64::EPSILON * size + 4.0 * f64::MIN_POSITIVE;
    let (lo, hi) = (lo - error, hi + error);
    // NaN bounds nothing.
    Interval {
        lo: if lo.is_nan() { f64::NEG_INFINITY } else { lo },
        hi: if hi.is_nan() { f64::INFINITY } else { hi },
    }
}
