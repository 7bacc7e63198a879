//! Single rays, sixteen at a time, followed to a proven hit, to an undecided segment or to the end.

use super::MIN_BRACKET;
use super::frame::FORM_BLUR;
use super::narrow::{FollowResult, Narrower, Scratch, StopReason, rounding};
use crate::kernel_stats::KernelStats;
use crate::method::{Start, Task};
use crate::methods::bracket_gap::RayFunction;
use crate::methods::local_ray::{LocalRay, MAX_OPEN_PARTS, bounds};
use crate::methods::outcome::{RayOutcome, reason};
use crate::options::Precision;
use crate::ray_result::UndecidedReason;
use crate::scalar::Scalar;
use std::sync::OnceLock;
use zeroset_eval::{
    Boxes, Contractions, Enclose, Kernel, KernelError, KernelFloat, LANES, Segments, Zeros,
};
use zeroset_interval::Facts;

/// Returns whether a ray's bracket must be shorter than segments in `T` can be.
fn is_blurred<T: Scalar>(local_ray: &LocalRay) -> bool {
    local_ray.longest * local_ray.direction.length()
        < MIN_BRACKET * FORM_BLUR * rounding::<T>(local_ray).max_element()
}

/// Returns the part of a segment in which zeros are searched for. Rounded ends may lie outside,
/// where the kernels of a part of space are not valid.
fn within(local_ray: &LocalRay, [near, far]: [f64; 2]) -> [f64; 2] {
    let [first, last] = local_ray.span;
    [near.max(first), far.min(last)]
}

/// Follows single rays, with refinement in `f64` if needed.
pub(super) struct Follower<'a, T: Scalar> {
    narrower: Narrower<'a, T>,
    /// Whether undecided segments are examined again in `f64`.
    refines: bool,
    /// Narrower in `f64`, created when the first ray needs it.
    double: OnceLock<Option<Narrower<'a, f64>>>,
    task: Task<'a>,
}

/// Length of the stretch that is examined in `f64`, as a multiple of the segment that is undecided
/// in `f32`.
const STRETCH: f64 = 256.0;

/// Near a gap, like that of sin(x)/x at 0, more segments are undecided than may be examined. So a
/// length is skipped behind each undecided segment. The length grows by this factor, up to the
/// length of a hit's bracket. The ray stays undecided, but a root behind the gap is painted.
const GROWTH: f64 = 4.0;

impl<'a, T: Scalar> Follower<'a, T> {
    pub fn new(task: Task<'a>) -> Result<Self, KernelError> {
        let refines = task.options.precision == Precision::Auto;
        Ok(Self { narrower: Narrower::new(task, refines)?, refines, double: OnceLock::new(), task })
    }

    /// Evaluates the kernel that narrows segments.
    #[inline]
    pub fn eval(&self, segments: &Segments<T>, out: &mut Contractions<T>) {
        self.narrower.segments.eval(segments, out);
    }

    /// Follows up to [`LANES`] rays. Returns their outcomes.
    pub fn follow(
        &self,
        local_rays: &[LocalRay],
        start: Start,
        scratch: &mut Scratch<T>,
        work: &mut KernelStats,
    ) -> [RayOutcome; LANES] {
        let mut outcomes = [RayOutcome::default(); LANES];
        let mut parts = [0; LANES];
        let mut stretch = [0.0; LANES];
        let mut pending: [Option<[f64; 2]>; LANES] =
            std::array::from_fn(|lane| local_rays.get(lane).map(|local_ray| local_ray.span));
        let mut blurred = [false; LANES];
        if self.refines {
            for (blurred, local_ray) in blurred.iter_mut().zip(local_rays) {
                *blurred = is_blurred::<T>(local_ray);
            }
        }
        let finer = blurred.contains(&true).then(|| self.double()).flatten();
        while pending.iter().any(Option::is_some) {
            // Only the ray itself decides whether `f64` is used. So its outcome depends on no other
            // ray.
            let is_finer = |lane: usize| finer.is_some() && blurred[lane];
            let part = |fine: bool| -> [Option<[f64; 2]>; LANES] {
                std::array::from_fn(|lane| pending[lane].filter(|_| is_finer(lane) == fine))
            };
            let mut steps = [FollowResult::Unseen; LANES];
            let rest = part(false);
            if rest.iter().any(Option::is_some) {
                self.narrower.narrow(local_rays, &rest, scratch, &mut steps, work);
                self.find_brackets(local_rays, &mut steps);
                self.refine(local_rays, &mut steps, &mut stretch, work);
            }
            if let Some(double) = finer {
                let mut fine = [FollowResult::Unseen; LANES];
                double.narrow(local_rays, &part(true), &mut Scratch::default(), &mut fine, work);
                for lane in (0..LANES).filter(|lane| is_finer(*lane)) {
                    steps[lane] = fine[lane];
                }
            }
            for (lane, local_ray) in local_rays.iter().enumerate() {
                if pending[lane].is_none() {
                    continue;
                }
                let outcome = &mut outcomes[lane];
                // The s from which the ray is followed further.
                let rest: Option<f64> = match steps[lane] {
                    FollowResult::Unseen => None,
                    FollowResult::Empty => Some(local_ray.span[1]),
                    // The zero on which a ray starts does not count. At least `grain` is skipped,
                    // since the end of a segment found in `f64` may be too near for `T` to resolve.
                    FollowResult::Hit([near, far]) | FollowResult::Open([near, far], _)
                        if start == Start::OnSurface && near <= local_ray.span[0] =>
                    {
                        let grain = 2.0 * T::GRAIN * (local_ray.span[1] - local_ray.span[0]);
                        Some(far.max(local_ray.span[0] + grain))
                    }
                    FollowResult::Hit(bracket) => {
                        outcome.hit = Some(bracket);
                        None
                    }
                    FollowResult::Resumed(from) => Some(from),
                    FollowResult::Open(segment, _)
                        if outcome.open.is_none()
                            && let Some(bracket) = self.bracket_across_gap(local_ray, segment) =>
                    {
                        outcome.hit = Some(bracket);
                        None
                    }
                    FollowResult::Open([near, far], stop) => {
                        let (reason, likely) = self.classify_open(local_ray, [near, far], stop);
                        outcome.open.get_or_insert((near, reason));
                        parts[lane] += 1;
                        if likely {
                            outcome.likely = Some(near);
                            None
                        } else if parts[lane] == MAX_OPEN_PARTS {
                            work.given_up += 1;
                            None
                        } else {
                            let passed = (far - near) * GROWTH.powi(parts[lane] as i32 - 1);
                            Some(far + passed.min(local_ray.longest))
                        }
                    }
                };
                outcome.is_followed = rest.is_some_and(|from| from >= local_ray.span[1]);
                pending[lane] = rest
                    .filter(|from| *from < local_ray.span[1])
                    .map(|from| [from, local_ray.span[1]]);
            }
        }
        outcomes
    }

    /// In a part of a surface of many parts, turns undecided segments into hits if the function has
    /// opposite signs at their ends.
    ///
    /// Such surfaces have corners. Where a function has a corner at its zero, like
    /// max(a, 0) + min(a, 0) at a = 0, no form gets nearly linear, however short the segment. Then
    /// [`Self::refine`] finds nothing, and [`Self::bracket_across_gap`] evaluates all steps of the
    /// function fifty times.
    fn find_brackets(&self, local_rays: &[LocalRay], steps: &mut [FollowResult; LANES]) {
        let Task { surface, options, .. } = self.task;
        if !self.refines || !options.intervals || options.least > 0.0 {
            return;
        }
        for (local_ray, step) in local_rays.iter().zip(steps) {
            let FollowResult::Open([near, far], _) = *step else { continue };
            let segment = within(local_ray, [near, far]);
            let length = segment[1] - segment[0];
            // A bracket around the ray's start is not wanted either.
            let is_short = length > 0.0 && length <= local_ray.longest;
            if is_short
                && local_ray.start < segment[0]
                && let Some(Ok(kernel)) = f64::kernels(surface).bounds_in_part()
                && self.along(kernel, local_ray).is_bracket(segment)
            {
                *step = FollowResult::Hit(segment);
            }
        }
    }

    /// Examines segments that are undecided in `f32` again in `f64`, each with a stretch behind it,
    /// since nearby segments are mostly undecided, too. On each ray, every stretch is at least four
    /// times as long as the one before.
    fn refine(
        &self,
        local_rays: &[LocalRay],
        steps: &mut [FollowResult; LANES],
        stretch: &mut [f64; LANES],
        work: &mut KernelStats,
    ) {
        if !self.refines {
            return;
        }
        let open: [Option<[f64; 2]>; LANES] = std::array::from_fn(|lane| match steps[lane] {
            // Previews examine segments in `f64`, too: a segment may be at a jump, or out of the
            // range of `T`.
            FollowResult::Open([near, far], _) => {
                let [first, longest] = local_rays[lane].span;
                // Rounded to `T`, the segment may begin before its ray does.
                let near = near.max(first);
                // The stretch is so long that, rounded to `T`, the next segment begins behind
                // `near`.
                let least = T::GRAIN * first.abs().max(longest.abs());
                let open = STRETCH * (far - near);
                stretch[lane] = (4.0 * stretch[lane]).max(open).max(least);
                Some([near, far.max(longest.min(near + stretch[lane]))])
            }
            _ => None,
        });
        if open.iter().all(Option::is_none) {
            return;
        }
        let Some(double) = self.double() else { return };
        let mut refined = [FollowResult::Unseen; LANES];
        double.narrow(local_rays, &open, &mut Scratch::default(), &mut refined, work);
        for ((step, open), refined) in steps.iter_mut().zip(&open).zip(refined) {
            if let Some([_, far]) = *open {
                *step = if let FollowResult::Empty = refined {
                    FollowResult::Resumed(far)
                } else {
                    refined
                };
            }
        }
    }

    /// Returns the narrower that computes in `f64`. `None` if undecided segments are not examined
    /// again, or if its kernels cannot be compiled.
    fn double(&self) -> Option<&Narrower<'a, f64>> {
        let make = || Narrower::new(self.task, false).ok();
        self.refines.then(|| self.double.get_or_init(make).as_ref()).flatten()
    }

    /// Returns why a segment is undecided, and whether it is likely to hold a zero.
    fn classify_open(
        &self,
        local_ray: &LocalRay,
        segment: [f64; 2],
        stop: StopReason,
    ) -> (UndecidedReason, bool) {
        if self.refines {
            self.classify_open_in::<f64>(local_ray, segment, stop)
        } else {
            self.classify_open_in::<T>(local_ray, segment, stop)
        }
    }

    /// Returns a bracket of the first zero, if it lies in an undecided segment or close behind.
    fn bracket_across_gap(&self, local_ray: &LocalRay, segment: [f64; 2]) -> Option<[f64; 2]> {
        if self.refines {
            self.bracket_across_gap_in::<f64>(local_ray, segment)
        } else {
            self.bracket_across_gap_in::<T>(local_ray, segment)
        }
    }

    /// The function along a ray.
    fn along<'k, U: Scalar>(
        &'k self,
        kernel: &'k dyn Kernel<Enclose, U>,
        local_ray: &'k LocalRay,
    ) -> RayFunction<'k, U> {
        let Task { region, options, .. } = self.task;
        RayFunction { kernel, local_ray, region, is_solid: options.is_solid }
    }

    /// Does the work of [`Self::bracket_across_gap`] with the kernels of a scalar type.
    fn bracket_across_gap_in<U: Scalar>(
        &self,
        local_ray: &LocalRay,
        segment: [f64; 2],
    ) -> Option<[f64; 2]> {
        // A preview paints an undecided segment anyway.
        if !self.task.options.intervals || self.task.options.least > 0.0 {
            return None;
        }
        let kernels = U::kernels(self.task.surface);
        if let Some(Ok(kernel)) = kernels.bounds_in_part() {
            // Within the part of space, the part's own kernel is tried first: it takes far less
            // time.
            let part = LocalRay { inside: within(local_ray, local_ray.inside), ..*local_ray };
            let bracket = self.along(kernel, &part).bracket(within(local_ray, segment));
            if bracket.is_some() {
                return bracket;
            }
        }
        self.along(kernels.bounds().ok()?, local_ray).bracket(segment)
    }

    /// Does the work of [`Self::classify_open`] with the kernels of a scalar type.
    fn classify_open_in<U: Scalar>(
        &self,
        local_ray: &LocalRay,
        segment: [f64; 2],
        stop: StopReason,
    ) -> (UndecidedReason, bool) {
        let boxes = Boxes::around(&[bounds(local_ray, segment, self.task.region)]);
        let kernels = U::kernels(self.task.surface);
        let mut zeros = Zeros::default();
        if let Ok(kernel) = kernels.zeros() {
            kernel.eval(&boxes[0], &mut zeros);
        }
        let asymptote = !self.task.options.is_solid && zeros.unbounded & 1 == 1;
        if self.task.options.least > 0.0 {
            return (UndecidedReason::Budget, !asymptote);
        }
        let mut facts = Facts::NONE;
        let mut is_gap = false;
        if let Ok(kernel) = kernels.bounds() {
            facts = Kernel::<Enclose, U>::eval_all(kernel, &boxes)[0].facts(0);
            if let Ok(Some([_, denominator])) = kernels.cleared() {
                is_gap = self.along(kernel, local_ray).is_gap(segment, denominator);
            }
        }
        (reason(facts, stop == StopReason::Effort), !(asymptote || is_gap))
    }
}
