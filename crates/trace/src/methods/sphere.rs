//! Sphere tracing (Hart 1996) with bounds of the slope on parts of a ray: segment tracing (Galin,
//! Guérin, Paris and Peytavie 2020, "Segment Tracing Using Local Lipschitz Bounds").
//!
//! If |f| ≥ m at a place, and f approaches 0 at most at the speed λ, there is no zero for m/λ
//! ahead. Both m and λ come from enclosures, so every stretch that a step passes is proven empty.
//! So the method proves misses. A root is drawn where steps get shorter than the tolerance, but it
//! is not proven. If the slope has no known bound, the method stops, and the ray is undecided.

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

/// Length of the first part on which the slope is bounded, as a share of the ray's length in the
/// region.
const FIRST_PART: f64 = 0.125;
/// Length of the next part as a multiple of the previous step.
const GROWTH: f64 = 2.0;
/// Tolerance for shadow rays, as a share of their length. The place of a shadow ray's end is
/// invisible.
const SHADOW_TOLERANCE: f64 = 1.0 / 4096.0;

/// State of the search along one ray.
struct Walk {
    lane: usize,
    local_ray: LocalRay,
    /// Value of s up to which the ray has been searched.
    at: f64,
    /// Length of the next part, then the minimum of that length.
    part: f64,
    least: f64,
    /// If a step is shorter than this, the search ends at a root.
    enough: f64,
    steps: u32,
    /// Whether the ray has not yet left the surface that it started on.
    leaving: bool,
    /// Largest s at which the ray is proven to be in the region.
    end: f64,
    /// Whether the ray may meet a zero at the face where it enters the region, and at the face
    /// where it leaves. Rounding makes both crossings uncertain.
    open: [bool; 2],
}

/// How the search along a ray ended. Places are values of s.
enum SearchEnd {
    /// The ray is proven to meet no zero.
    Empty,
    /// Nothing is known from the first number on, for the given reason. The second number, if any,
    /// is the place of a root to draw.
    Open(f64, UndecidedReason, Option<f64>),
}

impl<T: Scalar> Sphere<'_, T> {
    /// Creates the state at a ray's start.
    fn walk(&self, lane: usize, segment: &Segment, local_ray: LocalRay, start: Start) -> Walk {
        let length = local_ray.span[1];
        let size = local_ray.origin.abs() + length * local_ray.direction.abs();
        // On a part shorter than this, rounding errors dominate.
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

    /// Tests whether rays may meet a zero where they cross the region's faces.
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
                // If the eye is inside the region, the ray enters the region through no face.
                let is_none = end == 0 && walk.at == 0.0;
                walk.open[end] = !is_none && value.lo <= 0.0 && value.hi >= 0.0;
            }
        }
    }

    /// Takes one step on each ray. Removes rays whose search has ended.
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
    /// Returns the end of the part to examine next.
    fn to(&self) -> f64 {
        (self.at + self.part).min(self.end).max(self.at)
    }

    /// Takes a step. `value` bounds the function at the step's start, `slope` bounds its slope on
    /// the next part. `most` is the maximum number of steps. Returns how the search ended, if it
    /// did.
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
        // The value's distance from 0, and the greatest speed at which the function approaches 0.
        let (gap, speed) =
            if value.lo > 0.0 { (value.lo, -slope.lo) } else { (-value.hi, slope.hi) };
        // The step is shortened by more than its rounding error.
        let step = (1.0 - 8.0 * f64::EPSILON) * (gap / speed.max(0.0));
        if gap > 0.0 && step >= to - at {
            // The whole part is proven empty.
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
            // A step this short leads away from the surface that the ray starts on, and proves
            // nothing.
            (self.at, self.part) = (at + self.enough, GROWTH * self.enough);
            return None;
        }
        open(UndecidedReason::Unproven, Some(at + step))
    }

    /// Converts the end of the search to the ray's result.
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
                match LocalRay::new(segment, self.region) {
                    Some(local_ray) => walks.push(self.walk(lane, segment, local_ray, start)),
                    None => found[lane] = RayResult::MISS,
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
