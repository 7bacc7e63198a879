//! Brackets whose zero arithmetic cannot locate. The function has proven, opposite signs at the two
//! ends of a bracket.

use super::local_ray::{LocalRay, between_faces, bounds};
use zeroset_eval::{Boxes, Enclose, Enclosures, Kernel, LANES, Real};
use zeroset_interval::{Facts, Interval};
use zeroset_space::Region;

/// Number of places at which the sign is evaluated, on each side of an undecided segment. Each is
/// 1.5 times as far away as the one before. Also the number of times that a bracket is halved.
const SIGN_STEPS: i32 = 48;
/// How far behind an undecided segment a zero is sought, as a share of the ray's length in the
/// region.
const MAX_REACH: f64 = 1.0 / 64.0;

/// How far around a gap the denominator is tested for zeros. The unit is the gap's length.
const POLE_REACH: f64 = 8.0;

/// The function along one ray, with the kernel that bounds it.
pub(super) struct RayFunction<'a, T: Real> {
    pub kernel: &'a dyn Kernel<Enclose, T>,
    pub local_ray: &'a LocalRay,
    pub region: &'a Region,
    /// Whether the surface is the boundary of a solid. It lies wherever the sign changes.
    pub is_solid: bool,
}

impl<T: Real> RayFunction<'_, T> {
    /// Returns a bracket of the ray's first zero; `None` if no zero is proven. No zero may lie
    /// before the segment from `near` to `far`.
    ///
    /// A zero is proven if the function has opposite signs at a place before the segment and one
    /// behind it, and is continuous between them. A solid's boundary is proven by the signs alone:
    /// one of the two places is inside of it, the other outside.
    pub fn bracket(&self, [near, far]: [f64; 2]) -> Option<[f64; 2]> {
        let [first, last] = self.inside();
        if !(first <= near && far <= last) {
            return None;
        }
        let least = (far - near).max(f64::EPSILON * (near.abs() + far.abs()));
        let (before, below) = self.sign_from(near, -least, first, None)?;
        let end = last.min(far + MAX_REACH * (last - first));
        let (mut behind, _) = self.sign_from(far, least, end, Some(!below))?;
        let may_jump = || !self.enclose([before, behind]).facts(0).has(Facts::CONTINUOUS);
        if !self.is_solid && may_jump() {
            return None;
        }
        // Halving moves `behind` toward the segment while its sign is proven to be `!below`.
        let mut close = near;
        for _ in 0..SIGN_STEPS {
            let middle = 0.5 * (close + behind);
            if self.sign(middle) == Some(!below) {
                behind = middle;
            } else {
                close = middle;
            }
        }
        Some([near, behind])
    }

    /// Returns whether the function has proven, opposite signs at the ends of a segment, and is
    /// continuous between them unless it bounds a solid.
    pub fn is_bracket(&self, segment: [f64; 2]) -> bool {
        let [first, last] = self.inside();
        if !(first <= segment[0] && segment[1] <= last) {
            return false;
        }
        let [Some(before), Some(behind)] = self.signs(&segment)[..] else { return false };
        before != behind && (self.is_solid || self.enclose(segment).facts(0).has(Facts::CONTINUOUS))
    }

    /// Returns whether a segment is a gap, like that of sin(x)/x at 0, rather than a surface. The
    /// function has the same sign on both sides of a gap. Its `denominator` may vanish in or near
    /// the gap.
    pub fn is_gap(&self, [near, far]: [f64; 2], denominator: &dyn Kernel<Enclose, T>) -> bool {
        let [first, last] = self.inside();
        let least = (far - near).max(f64::EPSILON * (near.abs() + far.abs()));
        let before = self.sign_from(near, -least, first, None);
        let behind = self.sign_from(far, least, last.min(far + MAX_REACH * (last - first)), None);
        let (Some((start, before)), Some((end, behind))) = (before, behind) else { return false };
        // The surroundings are tested, too: an undecided part close behind a gap belongs to it.
        let close = POLE_REACH * (end - start);
        let boxes =
            Boxes::around(&[bounds(self.local_ray, [start - close, end + close], self.region)]);
        let (bounds, zero) = (denominator.eval_all(&boxes).remove(0), T::default());
        before == behind && bounds.neg_lo[0] >= zero && bounds.hi[0] >= zero
    }

    /// Returns the range of s, not before the ray's start, in which the ray is proven to lie in the
    /// region. In this range, the boxes of [`bounds`] contain the ray's points although they are
    /// clipped to the region.
    fn inside(&self) -> [f64; 2] {
        let local_ray = self.local_ray;
        let [near, far] = local_ray.inside;
        let [enter, leave] =
            between_faces([local_ray.origin, local_ray.direction, local_ray.error], self.region);
        [near.max(local_ray.start).max(enter), far.min(leave)]
    }

    /// Searches from `start` to `end` in growing steps for the first place with a proven sign.
    /// Returns the place, and whether the sign is positive. If a sign is `wanted`, only that sign
    /// counts.
    fn sign_from(
        &self,
        start: f64,
        step: f64,
        end: f64,
        wanted: Option<bool>,
    ) -> Option<(f64, bool)> {
        let is_beyond = |s: f64| if step > 0.0 { s >= end } else { s <= end };
        let mut places: Vec<f64> =
            (0..SIGN_STEPS).map(|k| start + step * 1.5_f64.powi(k)).collect();
        if let Some(last) = places.iter().position(|s| is_beyond(*s)) {
            places.truncate(last + 1);
            places[last] = end;
        }
        // A kernel takes little longer for sixteen places than for one.
        places.chunks(LANES).find_map(|places| {
            let signs = places.iter().zip(self.signs(places));
            signs
                .filter_map(|(s, sign)| Some((*s, sign?)))
                .find(|(_, sign)| wanted.is_none_or(|wanted| wanted == *sign))
        })
    }

    /// Returns the signs at up to sixteen places: `Some(true)` if the function is proven to be
    /// above 0, `Some(false)` if it is proven to be below 0.
    fn signs(&self, places: &[f64]) -> Vec<Option<bool>> {
        let boxes: Vec<[Interval; 3]> =
            places.iter().map(|s| bounds(self.local_ray, [*s, *s], self.region)).collect();
        let values = self.kernel.eval_all(&Boxes::around(&boxes)).remove(0);
        let sign = |lane: usize| {
            if !values.facts(lane).has(Facts::DEFINED) {
                return None;
            }
            let zero = T::default();
            let is_above = values.neg_lo[lane] < zero;
            (is_above || values.hi[lane] < zero).then_some(is_above)
        };
        (0..places.len()).map(sign).collect()
    }

    fn sign(&self, s: f64) -> Option<bool> {
        self.signs(&[s])[0]
    }

    fn enclose(&self, segment: [f64; 2]) -> Enclosures<T> {
        self.kernel
            .eval_all(&Boxes::around(&[bounds(self.local_ray, segment, self.region)]))
            .remove(0)
    }
}
