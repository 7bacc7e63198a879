//! Segments of up to sixteen rays, narrowed and cut until each ray has met something or nothing.

use super::screens::Stack;
use crate::kernel_stats::KernelStats;
use crate::method::Task;
use crate::methods::local_ray::{CUT, LocalRay, bounds};
use crate::scalar::Scalar;
use fearless_simd::prelude::*;
use glam::DVec3;
use zeroset_eval::{
    Boxes, ContractSegments, Contractions, Enclose, FindZeros, Kernel, KernelError, LANES,
    Segments, Zeros,
};
use zeroset_interval::Facts;
use zeroset_space::Region;

/// Why a segment was followed no farther.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// It is as short as arithmetic allows.
    Arithmetic,
    /// What may be spent on a ray was spent.
    Effort,
    /// It is short enough for a picture that another one follows.
    Preview,
}

/// How far a ray was followed.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// To the end: there is no zero.
    Empty,
    /// To a bracket that holds the first zero.
    Hit([f64; 2]),
    /// To a segment of which nothing is proven, nor of what lies behind it.
    Open([f64; 2], Stop),
    /// Up to here there is no zero.
    Resumed(f64),
}

/// Narrows segments in `T`.
pub(super) struct Narrower<'a, T: Scalar> {
    pub segments: &'a dyn Kernel<ContractSegments, T>,
    /// Of the function and of its cleared form's denominator, where the segments' forms are those
    /// of the numerator.
    cleared: Option<[&'a dyn Kernel<Enclose, T>; 2]>,
    zeros: Option<&'a dyn Kernel<FindZeros, T>>,
    region: &'a Region,
    contracts: bool,
    /// [`crate::TraceOptions::least`].
    least: f64,
    /// Whether what stays open is looked at in `f64`.
    hands_on: bool,
}

/// What is still to be looked at of a ray, the nearest part last. Memory that is used again and
/// again.
#[derive(Default)]
pub(super) struct Scratch<T: Scalar> {
    stacks: [Stack; LANES],
    batch: Segments<T>,
    out: Contractions<T>,
}

/// A segment that stays longer than this share of what it was is cut.
pub(super) const STALLED: f64 = 0.6;
/// A segment that got shorter than this share of what it was did so by a form that is as good as
/// linear.
pub(super) const STEADY: f64 = 0.35;
/// What share of the longest bracket is allowed where that was not so.
pub(super) const UNSTEADY: f64 = 1.0 / 32.0;
/// Where arithmetic stalls at segments of so many times the shortest, it is rounding that stalls
/// it: better arithmetic goes on.
pub(super) const COARSE: f64 = 32.0;
/// A segment that stays open at no more than so many times the shortest does so for lack of digits,
/// not of effort.
const SPENT: f64 = 1024.0;
/// Of segments shorter than this share of what their coordinates are rounded by no more can be
/// told.
pub(super) const BLURRED: f64 = 0.125;
/// Segments looked at on one ray before the shortest get longer.
const PATIENCE: u32 = 96;

impl<'a, T: Scalar> Narrower<'a, T> {
    pub fn new(task: Task<'a>, hands_on: bool) -> Result<Self, KernelError> {
        let Task { surface, region, options } = task;
        let kernels = T::kernels(surface);
        let cleared = match kernels.cleared()? {
            Some([_, denominator]) => Some([kernels.bounds()?, denominator]),
            None => None,
        };
        Ok(Self {
            segments: kernels.segments()?,
            cleared,
            // What is looked at in `f64` in any case need not be asked of intervals first, one
            // short segment after another.
            zeros: if options.intervals && !hands_on { kernels.zeros().ok() } else { None },
            region,
            contracts: options.contract,
            least: options.least,
            hands_on,
        })
    }

    /// Follows each ray with a segment along it.
    pub fn narrow(
        &self,
        ways: &[LocalRay],
        segments: &[Option<[f64; 2]>; LANES],
        scratch: &mut Scratch<T>,
        steps: &mut [Step; LANES],
        work: &mut KernelStats,
    ) {
        let Scratch { stacks, batch, out } = scratch;
        let (mut grain, mut least) = ([0.0; LANES], [0.0; LANES]);
        let mut looked = [0_u32; LANES];
        for stack in stacks.iter_mut() {
            stack.clear();
        }
        for (lane, segment) in segments.iter().enumerate() {
            steps[lane] = Step::Empty;
            if let Some(segment) = *segment {
                least[lane] = begin::<T>(&ways[lane], segment, &mut stacks[lane]);
                grain[lane] = least[lane];
            }
        }
        // The rays of which something is left, by their places in the batch.
        let mut lanes: Vec<usize> = (0..LANES).filter(|&lane| !stacks[lane].is_empty()).collect();
        let mut moved = true;
        while !lanes.is_empty() {
            if moved {
                for (slot, &lane) in lanes.iter().enumerate() {
                    place(batch, slot, &ways[lane]);
                }
                batch.count = lanes.len() as u32;
            }
            for (slot, &lane) in lanes.iter().enumerate() {
                if let Some(&[near, far]) = stacks[lane].last() {
                    batch.near[slot] = T::nearest(near);
                    batch.far[slot] = T::nearest(far);
                }
            }
            self.segments.eval(batch, out);
            for (slot, &lane) in lanes.iter().enumerate() {
                let stack = &mut stacks[lane];
                let Some([near, far]) = stack.pop() else { continue };
                work.segments.lanes += 1;
                if out.possible >> slot & 1 == 1 {
                    looked[lane] += 1;
                    if looked[lane] > PATIENCE {
                        grain[lane] *= 1.5;
                    }
                    let new = if self.contracts {
                        [out.near[slot].into(), out.far[slot].into()]
                    } else {
                        [near, far]
                    };
                    let way = &ways[lane];
                    let within = way.inside[0] <= near && far <= way.inside[1];
                    let crossing = out.crossing >> slot & 1 == 1 && within;
                    let (length, shorter) = (far - near, new[1] - new[0]);
                    let enough = enough(way.longest, !self.contracts || shorter <= STEADY * length)
                        .max(grain[lane]);
                    if shorter < 0.0 {
                        // No part is left.
                    } else if crossing && shorter <= enough && self.is_zero(way, new) {
                        steps[lane] = Step::Hit(new);
                        stack.clear();
                    } else if shorter <= grain[lane] {
                        if self.may_vanish(way, new) {
                            let spent = shorter > SPENT * least[lane];
                            let stop = if spent { Stop::Effort } else { Stop::Arithmetic };
                            steps[lane] = Step::Open(new, stop);
                            stack.clear();
                        }
                    } else if self.hands_on
                        && shorter > STALLED * length
                        && shorter <= COARSE * grain[lane]
                    {
                        steps[lane] = Step::Open(new, Stop::Arithmetic);
                        stack.clear();
                    } else if !shorter.is_finite() || shorter > STALLED * length {
                        let cut: f64 = T::nearest(new[0] + CUT * shorter).into();
                        if shorter <= self.least * way.longest {
                            if self.may_vanish(way, new) {
                                steps[lane] = Step::Open(new, Stop::Preview);
                                stack.clear();
                            }
                        } else if is_progress(new, cut, length) {
                            stack.push([cut, new[1]]);
                            stack.push([new[0], cut]);
                        } else {
                            steps[lane] = Step::Open(new, Stop::Arithmetic);
                            stack.clear();
                        }
                    } else {
                        stack.push(new);
                    }
                }
            }
            work.segments.calls += 1;
            // Those of which nothing is left are taken out where that saves a vector.
            let live = lanes.iter().filter(|&&lane| !stacks[lane].is_empty()).count();
            moved = live.div_ceil(4) < lanes.len().div_ceil(4);
            if moved {
                lanes.retain(|&lane| !stacks[lane].is_empty());
            }
        }
    }

    /// Whether a bracket of the form's zero holds one of the function.
    fn is_zero(&self, way: &LocalRay, segment: [f64; 2]) -> bool {
        let Some([function, denominator]) = self.cleared else { return true };
        let boxes = Boxes::around(&[bounds(way, segment, self.region)]);
        let [function, denominator] =
            [function, denominator].map(|kernel| kernel.eval_all(&boxes).remove(0));
        let away = denominator.neg_lo[0] < T::default() || denominator.hi[0] < T::default();
        away && function.facts(0).has(Facts::CONTINUOUS)
            && denominator.facts(0).has(Facts::CONTINUOUS)
    }

    /// Whether there may be a zero in a segment, by intervals, and branch by branch where the
    /// function jumps.
    fn may_vanish(&self, way: &LocalRay, segment: [f64; 2]) -> bool {
        let Some(kernel) = self.zeros else { return true };
        let boxes = Boxes::around(&[bounds(way, segment, self.region)]);
        let mut zeros = Zeros::default();
        kernel.eval(&boxes[0], &mut zeros);
        zeros.possible & 1 == 1
    }
}

/// Puts a ray's segment on its stack, its ends rounded outward; returns the length of the shortest
/// segments.
fn begin<T: Scalar>(way: &LocalRay, [near, far]: [f64; 2], stack: &mut Stack) -> f64 {
    let slack = T::PATH_ERROR * (near.abs() + far.abs());
    let outward = |end: f64, slack: f64| {
        let float: f64 = T::nearest(end).into();
        // Most ends are floats already.
        if float == end { end } else { T::nearest(end + slack).into() }
    };
    let (near, far) = (outward(near, -slack), outward(far, slack));
    // Where the ray leaves the region no sign is known: the ends that round beyond are looked at
    // apart.
    let mut inside = way.inside;
    let within = inside[0] <= near && far <= inside[1];
    if !within {
        inside = [T::above(inside[0]).into(), -T::above(-inside[1]).into()];
    }
    let [first, last] = inside;
    if !within && first < last && near < last && first < far {
        if last < far {
            stack.push([last, far]);
        }
        stack.push([near.max(first), far.min(last)]);
        if near < first {
            stack.push([near, first]);
        }
    } else {
        stack.push([near, far]);
    }
    let blur = (rounding::<T>(way) + way.error).max_element() / way.direction.length();
    (T::GRAIN * near.abs().max(far.abs()).max(way.span[1] - way.span[0])).max(BLURRED * blur)
}

/// How short the bracket of a hit is to be. Where segments got much shorter at once, the function
/// is as good as linear, and its gradient near the root is that at the root. Elsewhere roots are
/// close together or multiple: normals there hang on where exactly they are taken.
#[inline]
fn enough(longest: f64, steady: bool) -> f64 {
    if steady { longest } else { UNSTEADY * longest }
}

/// Whether the parts of a segment that is cut are shorter than what it was narrowed from: where
/// floats are as coarse as the segment is short, it may come out longer, and would come back for
/// ever. Not so of one that is not finite.
fn is_progress([near, far]: [f64; 2], cut: f64, length: f64) -> bool {
    near < cut && cut < far && cut - near < length && far - cut < length
}

/// The same of as many segments as a vector holds.
#[inline(always)]
pub(super) fn are_progress<S: Simd, V: SimdFloat<S>>(
    [near, far]: [V; 2],
    cut: V,
    length: V,
) -> V::Mask {
    let shorter = (cut - near).simd_lt(length) & (far - cut).simd_lt(length);
    near.simd_lt(cut) & cut.simd_lt(far) & shorter
}

/// Writes a ray into a lane.
fn place<T: Scalar>(batch: &mut Segments<T>, lane: usize, way: &LocalRay) {
    let rounding = rounding::<T>(way);
    for axis in 0..3 {
        batch.origin[axis][lane] = T::nearest(way.origin[axis]);
        batch.direction[axis][lane] = T::nearest(way.direction[axis]);
        batch.error[axis][lane] = T::nearest(1.0001 * (way.error[axis] + rounding[axis]));
    }
}

/// What `T` rounds the coordinates of a ray by.
pub(super) fn rounding<T: Scalar>(way: &LocalRay) -> DVec3 {
    let most = way.span[0].abs().max(way.span[1].abs());
    let least: f64 = T::LEAST_NORMAL.into();
    (T::PATH_ERROR + T::UNIT) * (way.origin.abs() + most * way.direction.abs())
        + 4.0 * least * (1.0 + most)
}
