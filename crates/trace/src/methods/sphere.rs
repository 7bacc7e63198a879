//! Sphere tracing (Hart 1996) by bounds of the slope along parts of a ray: segment tracing (Galin,
//! Guérin, Paris and Peytavie 2020, "Segment Tracing Using Local Lipschitz Bounds").
//!
//! From a place where |f| ≥ m there is no zero for m/λ ahead, where λ bounds how fast f approaches
//! 0 there. Both bounds are enclosures, so steps pass only over parts that are proven empty, and
//! the method proves misses. A root is drawn where steps get shorter than the tolerance, but it is
//! not proven. Without a bound of the slope the method stops, and the ray is undecided.

use super::local_ray::{LocalRay, bounds};
use super::slope::SlopeKernels;
use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Segment, Start, Task, Tracer};
use crate::options;
use crate::options::TraceOptions;
use crate::ray_result::{RayResult, Status, UndecidedReason};
use crate::scalar::Scalar;
use zeroset_eval::{KernelError, LANES};
use zeroset_interval::Interval;
use zeroset_space::Region;

pub(crate) const METHOD: Method = Method {
    name: "sphere",
    help: "steps as long as bounds of the slope allow (Hart 1996, Galin et al. 2020); proves misses only",
    proves: Proves::Misses,
    reads: &[options::PRECISION, options::STEPS, options::TOLERANCE],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    let slopes = SlopeKernels::<T>::new(&task)?;
    let TraceOptions { tolerance, steps, .. } = task.options;
    Ok(Box::new(Sphere { slopes, region: task.region, tolerance, steps }))
}

struct Sphere<'a, T: Scalar> {
    slopes: SlopeKernels<'a, T>,
    region: &'a Region,
    tolerance: f64,
    /// Maximum number of steps along a ray.
    steps: u32,
}

/// Length of the first part in which the slope is bounded, as a share of the ray's length in the
/// region.
const FIRST_PART: f64 = 0.125;
/// Length of a part, in multiples of the step before it.
const GROWTH: f64 = 2.0;
/// Tolerance for shadow rays, as a share of their length. The place where they end is not visible.
const SHADOW_TOLERANCE: f64 = 1.0 / 4096.0;

/// State of a ray that is followed.
struct Walk {
    lane: usize,
    local_ray: LocalRay,
    /// Value of s that the search has reached.
    at: f64,
    /// Length of the next part, and its minimum.
    part: f64,
    least: f64,
    /// The search ends at a root if a step is shorter than this.
    enough: f64,
    steps: u32,
    /// True while the ray is on the surface that it started from.
    leaving: bool,
    /// The end of the stretch in which the ray is certainly in the region.
    end: f64,
    /// Whether there may be a zero before that stretch, and behind it. Where the ray crosses the
    /// region's faces is known only up to rounding.
    open: [bool; 2],
}

/// The end of the search along a ray. Places are values of s.
enum SearchEnd {
    /// The ray meets no zero.
    Empty,
    /// Nothing is known from the first place on, for this reason. A root may be drawn at the second
    /// place, if there is one.
    Open(f64, UndecidedReason, Option<f64>),
}

impl<T: Scalar> Sphere<'_, T> {
    /// Creates the state of a ray at its start.
    fn walk(&self, lane: usize, segment: &Segment, local_ray: LocalRay, start: Start) -> Walk {
        let length = local_ray.span[1];
        let size = local_ray.origin.abs() + length * local_ray.direction.abs();
        // In a shorter part, rounding errors dominate.
        let grain = 4.0 * T::UNIT * size.max_element() / local_ray.direction.abs().max_element();
        let tolerance = self.tolerance * segment.footprint(-local_ray.start);
        let enough = if tolerance.is_finite() { tolerance } else { SHADOW_TOLERANCE * length };
        let [at, end] = [local_ray.inside[0].max(0.0), local_ray.inside[1].min(length)];
        Walk {
            lane,
            local_ray,
            at,
            part: FIRST_PART * length,
            least: grain,
            enough: enough.max(grain),
            steps: 0,
            leaving: start == Start::OnSurface,
            end,
            open: [false; 2],
        }
    }

    /// Tests whether rays may meet a zero at the region's faces.
    fn test_faces(&self, walks: &mut [Walk], work: &mut KernelStats) {
        for end in [0, 1] {
            let mut boxes = [[Interval::ENTIRE; 3]; LANES];
            for (place, walk) in boxes.iter_mut().zip(&*walks) {
                let [first, last] = walk.local_ray.span;
                let part = if end == 0 { [first, walk.at] } else { [walk.end, last] };
                let part = if walk.at <= walk.end { part } else { [first, last] };
                *place = bounds(&walk.local_ray, part, self.region);
            }
            let values = self.slopes.values(&boxes[..walks.len()], work);
            for (walk, value) in walks.iter_mut().zip(values) {
                // An eye within the region is not on its face.
                let is_none = end == 0 && walk.at == 0.0;
                walk.open[end] = !is_none && value.lo <= 0.0 && value.hi >= 0.0;
            }
        }
    }

    /// Takes one step on each ray, and removes the finished ones.
    fn step(&self, walks: &mut Vec<Walk>, found: &mut [RayResult], work: &mut KernelStats) {
        let mut places = [[Interval::ENTIRE; 3]; LANES];
        let mut parts = places;
        for (slot, walk) in walks.iter().enumerate() {
            places[slot] = bounds(&walk.local_ray, [walk.at; 2], self.region);
            parts[slot] = bounds(&walk.local_ray, [walk.at, walk.to()], self.region);
        }
        let used = walks.len();
        let values = self.slopes.values(&places[..used], work);
        let slopes =
            self.slopes.along(&parts[..used], |slot| walks[slot].local_ray.direction, work);
        let mut slot = 0;
        walks.retain_mut(|walk| {
            let end = walk.advance(values[slot], slopes[slot], self.steps);
            slot += 1;
            if let Some(end) = &end {
                found[walk.lane] = walk.found(end);
            }
            end.is_none()
        });
    }
}

impl Walk {
    /// Returns the end of the part that is examined next.
    fn to(&self) -> f64 {
        (self.at + self.part).min(self.end).max(self.at)
    }

    /// Takes a step, given bounds of the value at its start and of the slope in the next part.
    /// Returns how the search ended, if it did. `most`: the maximum number of steps.
    fn advance(
        &mut self,
        value: Interval,
        slope: Option<Interval>,
        most: u32,
    ) -> Option<SearchEnd> {
        let (at, to) = (self.at, self.to());
        let open = |reason, drawn| Some(SearchEnd::Open(at, reason, drawn));
        if at >= self.end {
            return Some(SearchEnd::Empty);
        }
        self.steps += 1;
        if self.steps > most.max(2) {
            return open(UndecidedReason::Budget, None);
        }
        let is_known = slope.is_some_and(|slope| slope.lo.is_finite() && slope.hi.is_finite());
        let Some(slope) = slope.filter(|_| is_known) else {
            if self.part <= self.least {
                return open(UndecidedReason::Steep, None);
            }
            self.part = (0.5 * self.part).max(self.least);
            return None;
        };
        if !(value.lo.is_finite() && value.hi.is_finite()) {
            return open(UndecidedReason::Undefined, None);
        }
        // Distance of the value from 0, and the greatest speed at which it approaches 0.
        let (gap, speed) =
            if value.lo > 0.0 { (value.lo, -slope.lo) } else { (-value.hi, slope.hi) };
        // The step is shortened by more than the rounding errors.
        let step = (1.0 - 8.0 * f64::EPSILON) * (gap / speed.max(0.0));
        if gap > 0.0 && step >= to - at {
            // The whole part is empty.
            self.leaving = false;
            (self.at, self.part) = (to, GROWTH * self.part);
            return None;
        }
        let step = if gap > 0.0 { step } else { 0.0 };
        if step >= self.enough {
            self.leaving = false;
            (self.at, self.part) = ((at + step).next_down(), GROWTH * step);
            return None;
        }
        if self.leaving {
            // These steps lead away from the surface that the ray starts on, and prove nothing.
            (self.at, self.part) = (at + self.enough, GROWTH * self.enough);
            return None;
        }
        open(UndecidedReason::Unproven, Some(at + step))
    }

    /// Returns the ray's result, given how the search in the region ended.
    fn found(&self, end: &SearchEnd) -> RayResult {
        let place = |s: f64| s - self.local_ray.start;
        let [before, behind] = self.open;
        let (at, reason, drawn) = match *end {
            SearchEnd::Open(at, reason, drawn) => (if before { 0.0 } else { at }, reason, drawn),
            SearchEnd::Empty if before => (0.0, UndecidedReason::Touching, None),
            SearchEnd::Empty if behind => (self.end.max(0.0), UndecidedReason::Touching, None),
            SearchEnd::Empty => return RayResult::MISS,
        };
        RayResult {
            status: Status::Undecided,
            reason,
            distance: place(at),
            drawn: drawn.map_or(f64::INFINITY, place),
            ..RayResult::MISS
        }
    }
}

impl<T: Scalar> Tracer for Sphere<'_, T> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        for (rays, found) in rays.chunks(LANES).zip(found.chunks_mut(LANES)) {
            let mut walks = Vec::with_capacity(LANES);
            for (lane, segment) in rays.iter().enumerate() {
                found[lane] = RayResult::MISS;
                if let Some(local_ray) = LocalRay::new(segment, self.region) {
                    walks.push(self.walk(lane, segment, local_ray, start));
                }
            }
            if walks.is_empty() {
                continue;
            }
            self.test_faces(&mut walks, work);
            while !walks.is_empty() {
                self.step(&mut walks, found, work);
            }
        }
    }
}
