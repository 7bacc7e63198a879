//! Single rays, sixteen at a time: from a segment to a proven hit, to nothing, or to what stays
//! open.

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

/// Whether hits are wanted so close on a ray that `T` would narrow segments of it in vain.
fn is_blurred<T: Scalar>(way: &LocalRay) -> bool {
    way.longest * way.direction.length() < FINE * BLURS * rounding::<T>(way).max_element()
}

/// Follows single rays.
pub(super) struct Follower<'a, T: Scalar> {
    narrower: Narrower<'a, T>,
    /// Whether what stays open is looked at in `f64`.
    refines: bool,
    /// Made when the first ray needs it.
    double: OnceLock<Option<Narrower<'a, f64>>>,
    task: Task<'a>,
}

/// A stretch that is looked at in `f64` is so many times as long as the part that stayed open in
/// `f32`.
const STRETCH: f64 = 256.0;

/// Beside a gap more parts stay open than are looked at. What is passed over behind each is so many
/// times as long as behind the one before, but no longer than a hit's bracket: the ray is undecided
/// either way, and a root behind the gap is to be painted.
const GROWTH: f64 = 4.0;

impl<'a, T: Scalar> Follower<'a, T> {
    pub fn new(task: Task<'a>) -> Result<Self, KernelError> {
        let refines = task.options.precision == Precision::Auto;
        Ok(Self { narrower: Narrower::new(task, refines)?, refines, double: OnceLock::new(), task })
    }

    /// Narrows segments once.
    #[inline]
    pub fn eval(&self, segments: &Segments<T>, out: &mut Contractions<T>) {
        self.narrower.segments.eval(segments, out);
    }

    /// Follows up to [`LANES`] rays.
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
            // What becomes of a ray hangs on no other.
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
                    // What a ray starts on does not count. What is left of it in `f64` may be too
                    // short for `T` to get past.
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

    /// Looks in `f64` at what stayed open in `f32`, and at what lies behind it: where one segment
    /// is below the rounding of `f32`, so are many, and each time the stretch is longer.
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
            // What is only painted, too: it may be a jump, or out of the range of `T`.
            Step::Open([near, far], _) => {
                let [first, longest] = ways[lane].span;
                // In `T` it may begin before its ray.
                let near = near.max(first);
                // Long enough that what lies behind it is another segment in `T`.
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

    /// The same in `f64`, where it may take the place of `T`.
    fn double(&self) -> Option<&Narrower<'a, f64>> {
        let make = || Narrower::new(self.task, false).ok();
        self.refines.then(|| self.double.get_or_init(make).as_ref()).flatten()
    }

    /// Why a part stays open, and whether it is likely a zero.
    fn judge(&self, way: &LocalRay, segment: [f64; 2], stop: Stop) -> (UndecidedReason, bool) {
        if self.refines {
            self.judge_in::<f64>(way, segment, stop)
        } else {
            self.judge_in::<T>(way, segment, stop)
        }
    }

    /// A bracket of the first zero, if it lies in a segment that stayed open or close behind it.
    fn bridge(&self, way: &LocalRay, segment: [f64; 2]) -> Option<[f64; 2]> {
        if self.refines {
            self.bridge_in::<f64>(way, segment)
        } else {
            self.bridge_in::<T>(way, segment)
        }
    }

    fn bridge_in<U: Scalar>(&self, way: &LocalRay, segment: [f64; 2]) -> Option<[f64; 2]> {
        // A picture that another one follows paints the place either way.
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
