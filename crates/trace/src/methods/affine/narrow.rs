//! Narrows and cuts the segments of up to sixteen rays, until each ray meets a zero or is empty.

use super::screens::PendingSegments;
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

/// The reason why a segment was not narrowed further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StopReason {
    /// The segment is as short as precision allows.
    Arithmetic,
    /// The effort allowed for the ray is used up.
    Effort,
    /// The segment is short enough for a preview.
    Preview,
}

/// The result of following a ray.
#[derive(Clone, Copy, Debug)]
pub(super) enum FollowResult {
    /// The ray was not examined.
    Unseen,
    /// The ray meets no zero.
    Empty,
    /// The ray's first zero lies in this bracket.
    Hit([f64; 2]),
    /// Nothing is proven on this segment. The ray behind it was not examined.
    Open([f64; 2], StopReason),
    /// The ray meets no zero up to this s. It was not examined beyond.
    Resumed(f64),
}

/// Narrows segments in floats of type `T`.
pub(super) struct Narrower<'a, T: Scalar> {
    pub segments: &'a dyn Kernel<ContractSegments, T>,
    /// Kernels that bound the function, and the denominator of its rational form. `None` if
    /// segments are narrowed by the function itself, not by a numerator.
    cleared: Option<[&'a dyn Kernel<Enclose, T>; 2]>,
    zeros: Option<&'a dyn Kernel<FindZeros, T>>,
    region: &'a Region,
    contracts: bool,
    /// Length below which a segment may stay undecided, in maximum lengths of a hit's bracket.
    least: f64,
    /// Whether undecided segments are examined again in `f64`.
    refined_later: bool,
}

/// Buffers that are reused. `stacks` has the segments to examine on each ray; the nearest is last.
#[derive(Default)]
pub(super) struct Scratch<T: Scalar> {
    stacks: [PendingSegments; LANES],
    batch: Segments<T>,
    out: Contractions<T>,
}

/// A segment is cut if narrowing leaves more than this share of its length.
pub(super) const STALL_RATIO: f64 = 0.6;
/// A form counts as nearly linear if narrowing leaves at most this share of a segment's length.
pub(super) const LINEAR_RATIO: f64 = 0.35;
/// In a bracket, the gradient keeps its direction if narrowing left at most this share of a
/// segment.
pub(super) const EVEN_RATIO: f64 = 0.1;
/// Maximum length of a bracket whose form was not nearly linear, as a share of the usual maximum.
pub(super) const NONLINEAR_SHARE: f64 = 1.0 / 32.0;
/// If a segment cannot be narrowed and its length is at most this many times the minimum length,
/// rounding is the cause. Then higher precision narrows it further.
pub(super) const STALL_LENGTH: f64 = 32.0;
/// An undecided segment longer than this many times the minimum length has used up the effort. A
/// shorter one needs more precision.
const EFFORT_LENGTH: f64 = 1024.0;
/// Minimum length of segments, as a share of the rounding error of coordinates on the ray.
pub(super) const MIN_BLUR_SHARE: f64 = 0.125;
/// Number of segments examined on one ray before the ray's minimum length grows.
const SEGMENTS_BEFORE_GROWTH: u32 = 96;

impl<'a, T: Scalar> Narrower<'a, T> {
    pub fn new(task: Task<'a>, refined_later: bool) -> Result<Self, KernelError> {
        let Task { surface, region, options } = task;
        let kernels = T::kernels(surface);
        let cleared = match kernels.cleared()? {
            Some([_, denominator]) => Some([kernels.bounds()?, denominator]),
            None => None,
        };
        Ok(Self {
            segments: kernels.segments()?,
            cleared,
            // No interval test is needed for segments that are examined again in `f64`.
            zeros: if options.intervals && !refined_later { kernels.zeros().ok() } else { None },
            region,
            contracts: options.contract,
            least: options.least,
            refined_later,
        })
    }

    /// Follows each ray along its segment, if it has one. Writes the results to `steps`.
    pub fn narrow(
        &self,
        local_rays: &[LocalRay],
        segments: &[Option<[f64; 2]>; LANES],
        scratch: &mut Scratch<T>,
        steps: &mut [FollowResult; LANES],
        work: &mut KernelStats,
    ) {
        let Scratch { stacks, batch, out } = scratch;
        let (mut grain, mut least) = ([0.0; LANES], [0.0; LANES]);
        let mut examined = [0_u32; LANES];
        for stack in stacks.iter_mut() {
            stack.clear();
        }
        for (lane, segment) in segments.iter().enumerate() {
            steps[lane] = FollowResult::Unseen;
            if let Some(segment) = *segment {
                least[lane] = push_outward::<T>(&local_rays[lane], segment, &mut stacks[lane]);
                grain[lane] = least[lane];
            }
        }
        // Lanes of the rays with segments left, in the order of the batch.
        let mut lanes: Vec<usize> = (0..LANES).filter(|&lane| !stacks[lane].is_empty()).collect();
        let mut moved = true;
        while !lanes.is_empty() {
            if moved {
                for (slot, &lane) in lanes.iter().enumerate() {
                    place(batch, slot, &local_rays[lane]);
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
                    examined[lane] += 1;
                    if examined[lane] > SEGMENTS_BEFORE_GROWTH {
                        grain[lane] *= 1.5;
                    }
                    let new = if self.contracts {
                        [out.near[slot].into(), out.far[slot].into()]
                    } else {
                        [near, far]
                    };
                    let local_ray = &local_rays[lane];
                    let within = local_ray.inside[0] <= near && far <= local_ray.inside[1];
                    let crossing = out.crossing >> slot & 1 == 1 && within;
                    let (length, shorter) = (far - near, new[1] - new[0]);
                    let enough = enough(
                        local_ray.longest,
                        !self.contracts || shorter <= LINEAR_RATIO * length,
                    )
                    .max(grain[lane]);
                    if shorter < 0.0 {
                        // Nothing of the segment is left.
                    } else if crossing && shorter <= enough && self.is_zero(local_ray, new) {
                        steps[lane] = FollowResult::Hit(new);
                        stack.clear();
                    } else if shorter <= grain[lane] {
                        if self.may_vanish(local_ray, new) {
                            let spent = shorter > EFFORT_LENGTH * least[lane];
                            let stop =
                                if spent { StopReason::Effort } else { StopReason::Arithmetic };
                            steps[lane] = FollowResult::Open(new, stop);
                            stack.clear();
                        }
                    } else if self.refined_later
                        && shorter > STALL_RATIO * length
                        && shorter <= STALL_LENGTH * grain[lane]
                    {
                        steps[lane] = FollowResult::Open(new, StopReason::Arithmetic);
                        stack.clear();
                    } else if !shorter.is_finite() || shorter > STALL_RATIO * length {
                        let cut: f64 = T::nearest(new[0] + CUT * shorter).into();
                        if shorter <= self.least * local_ray.longest {
                            if self.may_vanish(local_ray, new) {
                                steps[lane] = FollowResult::Open(new, StopReason::Preview);
                                stack.clear();
                            }
                        } else if is_progress(new, cut, length) {
                            stack.push([cut, new[1]]);
                            stack.push([new[0], cut]);
                        } else {
                            steps[lane] = FollowResult::Open(new, StopReason::Arithmetic);
                            stack.clear();
                        }
                    } else {
                        stack.push(new);
                    }
                }
                // All parts of the segment are proven empty.
                if stack.is_empty() && matches!(steps[lane], FollowResult::Unseen) {
                    steps[lane] = FollowResult::Empty;
                }
            }
            work.segments.calls += 1;
            // Rays without segments are removed from the batch if that saves a vector.
            let live = lanes.iter().filter(|&&lane| !stacks[lane].is_empty()).count();
            moved = live.div_ceil(4) < lanes.len().div_ceil(4);
            if moved {
                lanes.retain(|&lane| !stacks[lane].is_empty());
            }
        }
    }

    /// Returns whether a bracket is proven to hold a zero of the function, not only of a numerator.
    fn is_zero(&self, local_ray: &LocalRay, segment: [f64; 2]) -> bool {
        let Some([function, denominator]) = self.cleared else { return true };
        let boxes = Boxes::around(&[bounds(local_ray, segment, self.region)]);
        let [function, denominator] =
            [function, denominator].map(|kernel| kernel.eval_all(&boxes).remove(0));
        let away = denominator.neg_lo[0] < T::default() || denominator.hi[0] < T::default();
        away && function.facts(0).has(Facts::CONTINUOUS)
            && denominator.facts(0).has(Facts::CONTINUOUS)
    }

    /// Returns whether a segment may hold a zero, tested by intervals. A function with jumps is
    /// tested branch by branch.
    fn may_vanish(&self, local_ray: &LocalRay, segment: [f64; 2]) -> bool {
        let Some(kernel) = self.zeros else { return true };
        let boxes = Boxes::around(&[bounds(local_ray, segment, self.region)]);
        let mut zeros = Zeros::default();
        kernel.eval(&boxes[0], &mut zeros);
        zeros.possible & 1 == 1
    }
}

/// Puts a ray's segment on its stack, with its ends rounded outward. Returns the minimum length of
/// the ray's segments.
fn push_outward<T: Scalar>(
    local_ray: &LocalRay,
    [near, far]: [f64; 2],
    stack: &mut PendingSegments,
) -> f64 {
    let slack = T::PATH_ERROR * (near.abs() + far.abs());
    let outward = |end: f64, slack: f64| {
        let float: f64 = T::nearest(end).into();
        // Most ends are floats of `T` already.
        if float == end { end } else { T::nearest(end + slack).into() }
    };
    let (near, far) = (outward(near, -slack), outward(far, slack));
    // Outside the region, the function's sign is unknown. Rounding may move a segment's ends out of
    // the region, so the parts outside are examined separately.
    let mut inside = local_ray.inside;
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
    let blur =
        (rounding::<T>(local_ray) + local_ray.error).max_element() / local_ray.direction.length();
    (T::GRAIN * near.abs().max(far.abs()).max(local_ray.span[1] - local_ray.span[0]))
        .max(MIN_BLUR_SHARE * blur)
}

/// Returns the maximum length of a hit's bracket. A nearly linear form is `steady`: the gradient
/// anywhere in the bracket is about that at the root. Otherwise roots may be close together or
/// multiple, and the normal depends on the exact place.
#[inline]
fn enough(longest: f64, steady: bool) -> f64 {
    if steady { longest } else { NONLINEAR_SHARE * longest }
}

/// Returns whether both parts of a cut segment are shorter than `length`, the segment's length
/// before narrowing. Near the resolution of floats, narrowing may lengthen a segment, which would
/// then be cut forever. Returns false if an end is not finite.
fn is_progress([near, far]: [f64; 2], cut: f64, length: f64) -> bool {
    near < cut && cut < far && cut - near < length && far - cut < length
}

/// As [`is_progress`], for as many segments as a vector holds.
#[inline(always)]
pub(super) fn are_progress<S: Simd, V: SimdFloat<S>>(
    [near, far]: [V; 2],
    cut: V,
    length: V,
) -> V::Mask {
    let shorter = (cut - near).simd_lt(length) & (far - cut).simd_lt(length);
    near.simd_lt(cut) & cut.simd_lt(far) & shorter
}

/// Writes a ray to a lane of the batch.
fn place<T: Scalar>(batch: &mut Segments<T>, lane: usize, local_ray: &LocalRay) {
    let rounding = rounding::<T>(local_ray);
    for axis in 0..3 {
        batch.origin[axis][lane] = T::nearest(local_ray.origin[axis]);
        batch.direction[axis][lane] = T::nearest(local_ray.direction[axis]);
        batch.error[axis][lane] = T::nearest(1.0001 * (local_ray.error[axis] + rounding[axis]));
    }
}

/// Returns the rounding error of a ray's coordinates in floats of type `T`.
pub(super) fn rounding<T: Scalar>(local_ray: &LocalRay) -> DVec3 {
    let most = local_ray.span[0].abs().max(local_ray.span[1].abs());
    let least: f64 = T::LEAST_NORMAL.into();
    (T::PATH_ERROR + T::UNIT) * (local_ray.origin.abs() + most * local_ray.direction.abs())
        + 4.0 * least * (1.0 + most)
}
