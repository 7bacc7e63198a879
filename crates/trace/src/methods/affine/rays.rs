//! Single rays, sixteen at a time, followed to a proven hit, to the end, or to an open segment.

use super::FINE;
use super::frame::BLURS;
use super::narrow::{Narrower, Scratch, Step, Stop, rounding};
use crate::kernel_stats::KernelStats;
use crate::method::{Start, Task};
use crate::options::Precision;
use crate::methods::bracket_gap::Bridge;
use crate::methods::local_ray::{LocalRay, OPEN_PARTS, bounds};
use crate::methods::outcome::{Outcome, reason};
use crate::ray_result::UndecidedReason;
use crate::scalar::Scalar;
use std::sync::OnceLock;
use zeroset_eval::{Boxes, Contractions, Enclose, Kernel, KernelError, LANES, Segments, Zeros};
use zeroset_interval::Facts;

/// Returns whether a ray's bracket must be so short that `T` would narrow its segments in vain.
fn is_blurred<T: Scalar>(way: &LocalRay) -> bool {
    way.longest * way.direction.length() < FINE * BLURS * rounding::<T>(way).max_element()
}

/// Follows single rays.
pub(super) struct Follower<'a, T: Scalar> {
    narrower: Narrower<'a, T>,
    /// True if open segments are examined again in `f64`.
    refines: bool,
    /// Narrower in `f64`, created when the first ray needs it.
    double: OnceLock<Option<Narrower<'a, f64>>>,
    task: Task<'a>,
}

/// Length of a stretch that is examined in `f64`, in multiples of the part that stayed open in
/// `f32`.
const STRETCH: f64 = 256.0;

/// Beside a gap more parts stay open than are examined. The length that is skipped behind each
/// grows by this factor, up to that of a hit's bracket. The ray is undecided anyway, and a root
/// behind the gap should be painted.
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

    /// Follows up to [`LANES`] rays, and returns their outcomes.
    pub fn follow(
        &self,
        ways: &[LocalRay],
        start: Start,
        scratch: &mut Scratch<T>,
        work: &mut KernelStats,
    ) -> [Outcome; LANES] {
        let mut outcomes = [Outcome::default(); LANES];
        let mut parts = [0; LANES];
        let mut stretch = [0.0; LANES];
        let mut pending: [Option<[f64; 2]>; LANES] =
            std::array::from_fn(|lane| ways.get(lane).map(|way| way.span));
        let mut blurred = [false; LANES];
        if self.refines {
            for (blurred, way) in blurred.iter_mut().zip(ways) {
                *blurred = is_blurred::<T>(way);
            }
        }
        let finer = blurred.contains(&true).then(|| self.double()).flatten();
        while pending.iter().any(Option::is_some) {
            // A ray's outcome depends on no other ray.
            let is_finer = |lane: usize| finer.is_some() && blurred[lane];
            let part = |fine: bool| -> [Option<[f64; 2]>; LANES] {
                std::array::from_fn(|lane| pending[lane].filter(|_| is_finer(lane) == fine))
            };
            let mut steps = [Step::Empty; LANES];
            let rest = part(false);
            if rest.iter().any(Option::is_some) {
                self.narrower.narrow(ways, &rest, scratch, &mut steps, work);
                self.refine(ways, &mut steps, &mut stretch, work);
            }
            if let Some(double) = finer {
                let mut fine = [Step::Empty; LANES];
                double.narrow(ways, &part(true), &mut Scratch::default(), &mut fine, work);
                for lane in (0..LANES).filter(|lane| is_finer(*lane)) {
                    steps[lane] = fine[lane];
                }
            }
            for (lane, way) in ways.iter().enumerate() {
                if pending[lane].is_none() {
                    continue;
                }
                let outcome = &mut outcomes[lane];
                let rest = |from: f64| (from < way.span[1]).then_some([from, way.span[1]]);
                pending[lane] = match steps[lane] {
                    Step::Empty => None,
                    // The zero on which a ray starts does not count. Its segment in `f64` may be
                    // too short for `T` to get past it.
                    Step::Hit([near, far]) | Step::Open([near, far], _)
                        if start == Start::OnSurface && near <= way.span[0] =>
                    {
                        let grain = 2.0 * T::GRAIN * (way.span[1] - way.span[0]);
                        rest(far.max(way.span[0] + grain))
                    }
                    Step::Hit(bracket) => {
                        outcome.hit = Some(bracket);
                        None
                    }
                    Step::Resumed(from) => rest(from),
                    Step::Open(segment, _)
                        if outcome.open.is_none()
                            && let Some(bracket) = self.bridge(way, segment) =>
                    {
                        outcome.hit = Some(bracket);
                        None
                    }
                    Step::Open([near, far], stop) => {
                        let (reason, likely) = self.judge(way, [near, far], stop);
                        outcome.open.get_or_insert((near, reason));
                        parts[lane] += 1;
                        if likely {
                            outcome.likely = Some(near);
                            None
                        } else if parts[lane] == OPEN_PARTS {
                            work.given_up += 1;
                            None
                        } else {
                            let passed = (far - near) * GROWTH.powi(parts[lane] as i32 - 1);
                            rest(far + passed.min(way.longest))
                        }
                    }
                };
            }
        }
        outcomes
    }

    /// Examines in `f64` what stayed open in `f32`, and a stretch behind it. Where one segment is
    /// below the rounding of `f32`, so are many. Each stretch is longer than the one before.
    fn refine(
        &self,
        ways: &[LocalRay],
        steps: &mut [Step; LANES],
        stretch: &mut [f64; LANES],
        work: &mut KernelStats,
    ) {
        if !self.refines {
            return;
        }
        let open: [Option<[f64; 2]>; LANES] = std::array::from_fn(|lane| match steps[lane] {
            // Also in a preview: the segment may be a jump, or out of the range of `T`.
            Step::Open([near, far], _) => {
                let [first, longest] = ways[lane].span;
                // In `T` the segment may begin before its ray.
                let near = near.max(first);
                // Long enough that another segment in `T` begins behind it.
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
        let mut refined = [Step::Empty; LANES];
        double.narrow(ways, &open, &mut Scratch::default(), &mut refined, work);
        for ((step, open), refined) in steps.iter_mut().zip(&open).zip(refined) {
            if let Some([_, far]) = *open {
                *step = if let Step::Empty = refined { Step::Resumed(far) } else { refined };
            }
        }
    }

    /// Returns the narrower in `f64`, if open segments are examined in `f64`.
    fn double(&self) -> Option<&Narrower<'a, f64>> {
        let make = || Narrower::new(self.task, false).ok();
        self.refines.then(|| self.double.get_or_init(make).as_ref()).flatten()
    }

    /// Returns why a part stays open, and whether it is likely a zero.
    fn judge(&self, way: &LocalRay, segment: [f64; 2], stop: Stop) -> (UndecidedReason, bool) {
        if self.refines {
            self.judge_in::<f64>(way, segment, stop)
        } else {
            self.judge_in::<T>(way, segment, stop)
        }
    }

    /// Returns a bracket of the first zero, if it lies in an open segment or close behind it.
    fn bridge(&self, way: &LocalRay, segment: [f64; 2]) -> Option<[f64; 2]> {
        if self.refines {
            self.bridge_in::<f64>(way, segment)
        } else {
            self.bridge_in::<T>(way, segment)
        }
    }

    fn bridge_in<U: Scalar>(&self, way: &LocalRay, segment: [f64; 2]) -> Option<[f64; 2]> {
        // A preview paints the place anyway.
        if !self.task.options.intervals || self.task.options.least > 0.0 {
            return None;
        }
        let kernel = U::kernels(self.task.surface).bounds().ok()?;
        Bridge { kernel, way, region: self.task.region }.bracket(segment)
    }

    fn judge_in<U: Scalar>(
        &self,
        way: &LocalRay,
        segment: [f64; 2],
        stop: Stop,
    ) -> (UndecidedReason, bool) {
        let boxes = Boxes::around(&[bounds(way, segment, self.task.region)]);
        let kernels = U::kernels(self.task.surface);
        let mut zeros = Zeros::default();
        if let Ok(kernel) = kernels.zeros() {
            kernel.eval(&boxes[0], &mut zeros);
        }
        let asymptote = self.task.options.suppress_asymptotes && zeros.unbounded & 1 == 1;
        if self.task.options.least > 0.0 {
            return (UndecidedReason::Budget, !asymptote);
        }
        let mut facts = Facts::NONE;
        let mut is_gap = false;
        if let Ok(kernel) = kernels.bounds() {
            facts = Kernel::<Enclose, U>::eval_all(kernel, &boxes)[0].facts(0);
            if let Ok(Some([_, denominator])) = kernels.cleared() {
                is_gap =
                    Bridge { kernel, way, region: self.task.region }.is_gap(segment, denominator);
            }
        }
        (reason(facts, stop == Stop::Effort), !(asymptote || is_gap))
    }
}
