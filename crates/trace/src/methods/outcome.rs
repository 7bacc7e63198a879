//! Outcomes of rays in methods that prove hits, and the conversion of outcomes to results.

use super::local_ray::LocalRay;
use crate::method::{Segment, Task};
use crate::ray_result::{RayResult, Status, UndecidedReason};
use zeroset_eval::LANES;
use zeroset_interval::Facts;

/// The outcome of following a ray. Places are values of s.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RayOutcome {
    /// Bracket of the first proven hit.
    pub hit: Option<[f64; 2]>,
    /// The first part before the hit that is not proven empty: its start, and why it is undecided.
    pub open: Option<(f64, UndecidedReason)>,
    /// Start of the first undecided part that is likely to hold a zero.
    pub likely: Option<f64>,
    /// Whether the ray was followed to its end.
    pub is_followed: bool,
}

impl RayOutcome {
    /// Converts the outcome to a result. At s = 0, the ray's t is `start`. A ray without a hit is a
    /// miss only if it was followed to its end.
    pub fn found(&self, start: f64) -> RayResult {
        let place = |s: f64| start + s;
        let middle = self.hit.map(|[near, far]| place(0.5 * (near + far)));
        if let Some((from, reason)) = self.open {
            let (status, distance) = (Status::Undecided, place(from));
            // Before it, the ray is proven empty. A part that is examined later may begin there by
            // a rounding.
            let drawn = self.likely.map(place).or(middle).unwrap_or(f64::INFINITY).max(distance);
            return RayResult { status, distance, drawn, reason, ..RayResult::MISS };
        }
        let (Some([near, far]), Some(distance)) = (self.hit, middle) else {
            return if self.is_followed { RayResult::MISS } else { RayResult::UNSEEN };
        };
        // The ends of the bracket are rounded outward.
        let bracket = [place(near).next_down(), place(far).next_up()];
        let (status, drawn) = (Status::Hit, distance);
        RayResult { status, distance, drawn, bracket, ..RayResult::MISS }
    }
}

/// Writes the results of `rays` to `found`. `follow` gets up to [`LANES`] rays that meet the
/// region, and returns their outcomes.
pub(super) fn follow_in_region<O: IntoIterator<Item = RayOutcome>>(
    rays: &[Segment],
    task: &Task<'_>,
    found: &mut [RayResult],
    mut follow: impl FnMut(&[LocalRay]) -> O,
) {
    let longest = task.options.longest();
    for (rays, found) in rays.chunks(LANES).zip(found.chunks_mut(LANES)) {
        let (mut local_rays, mut lanes) = (Vec::with_capacity(LANES), Vec::with_capacity(LANES));
        for (lane, segment) in rays.iter().enumerate() {
            if let Some(mut local_ray) = LocalRay::new(segment, task.region) {
                local_ray.longest = longest * segment.footprint(-local_ray.start);
                local_rays.push(local_ray);
                lanes.push(lane);
            } else {
                found[lane] = RayResult::MISS;
            }
        }
        if local_rays.is_empty() {
            continue;
        }
        for ((outcome, local_ray), lane) in
            follow(&local_rays).into_iter().zip(&local_rays).zip(lanes)
        {
            found[lane] = outcome.found(-local_ray.start);
        }
    }
}

/// Returns why a part is undecided. `facts` holds on the whole part. `spent` states that the effort
/// allowed for the ray is used up.
pub(super) fn reason(facts: Facts, spent: bool) -> UndecidedReason {
    if !facts.has(Facts::DEFINED) {
        UndecidedReason::Undefined
    } else if !facts.has(Facts::CONTINUOUS) {
        UndecidedReason::Discontinuous
    } else if spent {
        UndecidedReason::Budget
    } else {
        UndecidedReason::Touching
    }
}
