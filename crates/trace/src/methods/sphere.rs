//! Sphere tracing (Hart 1996) by bounds of the slope along parts of a ray: segment tracing (Galin,
//! Guérin, Paris and Peytavie 2020, "Segment Tracing Using Local Lipschitz Bounds").
//!
//! From a place where |f| ≥ m there is no zero for m/λ ahead, where λ bounds how fast f nears 0
//! there. Both bounds are enclosures, so that what is passed is proven empty: it proves misses. A
//! root is drawn where such steps get shorter than the tolerance, and nothing says that there is
//! one. Without a bound of the slope it cannot go on, and says so.

use super::local_ray::{LocalRay, bounds};
use super::slope::Slopes;
use crate::kernel_stats::KernelStats;
use crate::method::{Method, MethodOption, Proves, Segment, Start, Task, TraceOptions, Tracer};
use crate::ray_result::{RayResult, Status, UndecidedReason};
use crate::scalar::Scalar;
use zeroset_eval::{KernelError, LANES};
use zeroset_interval::Interval;
use zeroset_space::Region;

pub(crate) const METHOD: Method = Method {
    name: "sphere",
    help: "steps as long as bounds of the slope allow (Hart 1996, Galin et al. 2020); proves misses only",
    proves: Proves::Misses,
    reads: &[MethodOption::Precision, MethodOption::Steps, MethodOption::Tolerance],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    let slopes = Slopes::<T>::new(&task)?;
    let TraceOptions { tolerance, steps, .. } = task.options;
    Ok(Box::new(Sphere { slopes, region: task.region, tolerance, steps }))
}

struct Sphere<'a, T: Scalar> {
    slopes: Slopes<'a, T>,
    region: &'a Region,
    tolerance: f64,
    /// Steps along a ray, at most.
    steps: u32,
}

/// The first part in which a bound is looked for, as a share of the ray's way through the region.
const FIRST: f64 = 0.125;
/// A part is so many times as long as the step before.
const GROWTH: f64 = 2.0;
/// Shadow rays are followed this exactly, as a share of their way: nobody sees where they end.
const ROUGHLY: f64 = 1.0 / 4096.0;

/// A ray on its way.
struct Walk {
    lane: usize,
    way: LocalRay,
    /// How far it has come.
    at: f64,
    /// How long the next part is, and how short it may be.
    part: f64,
    least: f64,
    /// A step shorter than this ends at a root.
    enough: f64,
    steps: u32,
    /// Whether it is still on the surface that it started from.
    leaving: bool,
    /// Where the part ends that is certainly in the region.
    end: f64,
    /// Whether nothing is known of what lies before and behind that part: where the ray crosses the
    /// region's faces, its place is known to within rounding only.
    open: [bool; 2],
}

/// What became of a ray. Places are values of s.
enum End {
    /// There is no zero.
    Empty,
    /// Nothing is known from the first place on, for a reason; a root may be drawn at the second.
    Open(f64, UndecidedReason, Option<f64>),
}

impl<T: Scalar> Sphere<'_, T> {
    /// A ray at the start of its way.
    fn walk(&self, lane: usize, segment: &Segment, way: LocalRay, start: Start) -> Walk {
        let length = way.span[1];
        let size = way.origin.abs() + length * way.direction.abs();
        // Parts shorter than that are boxes of rounding only.
        let grain = 4.0 * T::UNIT * size.max_element() / way.direction.abs().max_element();
        let tolerance = self.tolerance * segment.footprint(-way.start);
        let enough = if tolerance.is_finite() { tolerance } else { ROUGHLY * length };
        let [at, end] = [way.inside[0].max(0.0), way.inside[1].min(length)];
        Walk {
            lane,
            way,
            at,
            part: FIRST * length,
            least: grain,
            enough: enough.max(grain),
            steps: 0,
            leaving: start == Start::OnSurface,
            end,
            open: [false; 2],
        }
    }

    /// Finds out what is known of the ends of rays, at the region's faces.
    fn look_at_faces(&self, walks: &mut [Walk], work: &mut KernelStats) {
        for end in [0, 1] {
            let mut boxes = [[Interval::ENTIRE; 3]; LANES];
            for (place, walk) in boxes.iter_mut().zip(&*walks) {
                let [first, last] = walk.way.span;
                let part = if end == 0 { [first, walk.at] } else { [walk.end, last] };
                let part = if walk.at <= walk.end { part } else { [first, last] };
                *place = bounds(&walk.way, part, self.region);
            }
            let values = self.slopes.values(&boxes[..walks.len()], work);
            for (walk, value) in walks.iter_mut().zip(values) {
                // An eye within the region is not on its face.
                let is_none = end == 0 && walk.at == 0.0;
                walk.open[end] = !is_none && value.lo <= 0.0 && value.hi >= 0.0;
            }
        }
    }

    /// One step of each ray; those that came to an end are taken out.
    fn step(&self, walks: &mut Vec<Walk>, found: &mut [RayResult], work: &mut KernelStats) {
        let mut places = [[Interval::ENTIRE; 3]; LANES];
        let mut parts = places;
        for (slot, walk) in walks.iter().enumerate() {
            places[slot] = bounds(&walk.way, [walk.at; 2], self.region);
            parts[slot] = bounds(&walk.way, [walk.at, walk.to()], self.region);
        }
        let used = walks.len();
        let values = self.slopes.values(&places[..used], work);
        let slopes = self.slopes.along(&parts[..used], |slot| walks[slot].way.direction, work);
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
    /// Where the part ends that is looked at next.
    fn to(&self) -> f64 {
        (self.at + self.part).min(self.end).max(self.at)
    }

    /// Goes on from a place whose values are bounded so, through a part in which slopes are; says
    /// where the ray ends, if it does.
    fn advance(&mut self, value: Interval, slope: Option<Interval>, most: u32) -> Option<End> {
        let (at, to) = (self.at, self.to());
        let open = |reason, drawn| Some(End::Open(at, reason, drawn));
        if at >= self.end {
            return Some(End::Empty);
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
        // How far from 0 the value is, and how fast it nears 0 at most.
        let (gap, speed) =
            if value.lo > 0.0 { (value.lo, -slope.lo) } else { (-value.hi, slope.hi) };
        // Shortened by more than its roundings.
        let step = (1.0 - 8.0 * f64::EPSILON) * (gap / speed.max(0.0));
        if gap > 0.0 && step >= to - at {
            // All of the part is empty.
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
            // Off the surface, by steps that are no proof.
            (self.at, self.part) = (at + self.enough, GROWTH * self.enough);
            return None;
        }
        open(UndecidedReason::Unproven, Some(at + step))
    }

    /// What is to be said of the ray, given how the part ended that is certainly in the region.
    fn found(&self, end: &End) -> RayResult {
        let place = |s: f64| s - self.way.start;
        let [before, behind] = self.open;
        let (at, reason, drawn) = match *end {
            End::Open(at, reason, drawn) => (if before { 0.0 } else { at }, reason, drawn),
            End::Empty if before => (0.0, UndecidedReason::Touching, None),
            End::Empty if behind => (self.end.max(0.0), UndecidedReason::Touching, None),
            End::Empty => return RayResult::MISS,
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
                if let Some(way) = LocalRay::new(segment, self.region) {
                    walks.push(self.walk(lane, segment, way, start));
                }
            }
            if walks.is_empty() {
                continue;
            }
            self.look_at_faces(&mut walks, work);
            while !walks.is_empty() {
                self.step(&mut walks, found, work);
            }
        }
    }
}
