//! The part of space in which a surface is looked for: a box, and optionally a half-space that cuts
//! it.
//!
//! Every bound here is rounded away from the region, so that no part of a ray inside it is ever
//! lost. Nothing is known of functions or pixels.

use crate::camera::Ray;
use glam::DVec3;
use thiserror::Error;

/// Coordinates beyond this magnitude leave no room for squares in `f32` kernels. It holds for `f64`
/// too, so that a domain does not depend on the precision.
const LARGEST_COORDINATE: f64 = 1e18;

/// The points `p` with `normal · p ≤ offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Points out of the half-space; any length but 0.
    pub normal: DVec3,
    /// Largest kept value of `normal · p`.
    pub offset: f64,
}

/// A closed box, cut by at most one half-space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    low: DVec3,
    high: DVec3,
    clip: Option<HalfSpace>,
}

/// Why a region cannot exist.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RegionError {
    /// A bound is NaN, infinite or too large for the kernels.
    #[error(
        "the {axis} range of the domain, {low:?} to {high:?}, has a bound that is not a number within ±1e18"
    )]
    Bound {
        /// The coordinate's name.
        axis: char,
        /// Its lower bound.
        low: f64,
        /// Its upper bound.
        high: f64,
    },
    /// A range holds no interval.
    #[error(
        "the {axis} range of the domain, {low} to {high}, is empty: the first bound must be the smaller"
    )]
    Empty {
        /// The coordinate's name.
        axis: char,
        /// Its lower bound.
        low: f64,
        /// Its upper bound.
        high: f64,
    },
    /// The half-space has no boundary plane.
    #[error(
        "the clipping plane a,b,c,d needs finite numbers, and a, b, c not all zero nor all below 1e-150 or one above 1e150"
    )]
    Plane,
}

/// Where a ray comes into a region from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    /// Bounds on the t at which the ray crosses the face.
    pub t: (f64, f64),
    /// The face's unit normal, out of the region.
    pub normal: DVec3,
    /// Whether the ray certainly meets the region, rounding aside.
    pub certain: bool,
}

impl Region {
    /// The box between two corners.
    ///
    /// # Errors
    /// If a coordinate of `low` is not below that of `high`, or exceeds 1e18 in magnitude, or is
    /// NaN.
    pub fn new(low: DVec3, high: DVec3) -> Result<Self, RegionError> {
        for (axis, (low, high)) in
            ['x', 'y', 'z'].into_iter().zip(low.to_array().into_iter().zip(high.to_array()))
        {
            // Negated, so that NaN is refused too.
            if !(low.abs() <= LARGEST_COORDINATE && high.abs() <= LARGEST_COORDINATE) {
                return Err(RegionError::Bound { axis, low, high });
            }
            if low >= high {
                return Err(RegionError::Empty { axis, low, high });
            }
        }
        Ok(Self { low, high, clip: None })
    }

    /// The same box, cut by a half-space.
    ///
    /// # Errors
    /// If the plane's numbers are not finite or its normal is zero.
    pub fn with_clip(self, clip: HalfSpace) -> Result<Self, RegionError> {
        let valid = clip.normal.try_normalize().is_some() && clip.offset.is_finite();
        if valid { Ok(Self { clip: Some(clip), ..self }) } else { Err(RegionError::Plane) }
    }

    /// The corner with the smallest coordinates.
    pub fn low(&self) -> DVec3 {
        self.low
    }

    /// The corner with the largest coordinates.
    pub fn high(&self) -> DVec3 {
        self.high
    }

    /// The half-space that cuts the box.
    pub fn clip(&self) -> Option<HalfSpace> {
        self.clip
    }

    /// The middle of the box, whatever is cut away.
    pub fn centre(&self) -> DVec3 {
        (self.low + self.high) / 2.0
    }

    /// Half of the box's largest extent.
    pub fn half_extent(&self) -> f64 {
        (self.high - self.low).max_element() / 2.0
    }

    /// Bounds on the t ≥ 0 whose points of `ray` lie inside the region, rounded outward: no point
    /// of the ray inside is left out. `None` if there is none.
    pub fn span(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (from, to) = self.slab(ray, axis)?;
            near = near.max(from.0);
            far = far.min(to.1);
        }
        if let Some(clip) = &self.clip {
            let (room, slope) = clip.relation(ray);
            // Kept are the t with t·slope ≤ room, for some slope and room within their bounds; as t
            // ≥ 0, the smallest slope and the largest room keep the most.
            let (slope, room) = (slope.0, room.1);
            if slope > 0.0 {
                far = far.min(up(room / slope));
            } else if slope < 0.0 {
                near = near.max(down(room / slope));
            } else if room < 0.0 {
                return None;
            }
        }
        (near <= far).then_some((near, far))
    }

    /// Bounds on the t ≥ 0 between which all points of `ray` certainly lie inside the region; not in order if none do.
    pub(crate) fn inner(&self, ray: &Ray) -> [f64; 2] {
        const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let Some((from, to)) = self.slab(ray, axis) else { return NOWHERE };
            near = near.max(from.1);
            far = far.min(to.0);
        }
        if let Some(clip) = &self.clip {
            // As in `span`, but for the largest slope and the smallest room, which keep the least.
            let (room, slope) = clip.relation(ray);
            let (slope, room) = (slope.1, room.0);
            if slope > 0.0 {
                far = far.min(down(room / slope));
            } else if slope < 0.0 {
                near = near.max(up(room / slope));
            } else if room < 0.0 {
                return NOWHERE;
            }
        }
        [near, far]
    }

    /// Where the ray enters, or `None` if it starts inside or never does.
    pub(crate) fn entry(&self, ray: &Ray) -> Option<Entry> {
        let (mut near, mut far) = ((0.0_f64, 0.0_f64), f64::INFINITY);
        let mut normal = None;
        for axis in 0..3 {
            let (from, to) = self.slab(ray, axis)?;
            if from.0 > near.0 {
                let sign = -ray.direction[axis].signum();
                normal = Some(DVec3::AXES[axis] * sign);
            }
            near = (near.0.max(from.0), near.1.max(from.1));
            far = far.min(to.0);
        }
        if let Some(clip) = &self.clip {
            let (room, slope) = clip.relation(ray);
            if slope.1 < 0.0 && room.1 < 0.0 {
                let crossing = (down(room.1 / slope.0), up(room.0 / slope.1));
                if crossing.0 > near.0 {
                    normal = Some(clip.normal.normalize());
                }
                near = (near.0.max(crossing.0), near.1.max(crossing.1));
            } else if slope.1 > 0.0 {
                far = far.min(down(room.0 / slope.1));
            } else if room.0 < 0.0 {
                far = 0.0;
            }
        }
        self.span(ray)?;
        let normal = normal?;
        Some(Entry { t: near, normal, certain: near.1 <= far })
    }

    /// Bounds on the t at which the ray enters and leaves the slab of one axis, or `None` if it
    /// runs outside.
    fn slab(&self, ray: &Ray, axis: usize) -> Option<((f64, f64), (f64, f64))> {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        let (low, high) = (self.low[axis], self.high[axis]);
        if direction == 0.0 {
            let always = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            return (low <= origin && origin <= high)
                .then_some((always, (f64::INFINITY, f64::INFINITY)));
        }
        let (first, last) = if direction > 0.0 { (low, high) } else { (high, low) };
        let at = |bound: f64| {
            let t = (bound - origin) / direction;
            (down(t), up(t))
        };
        Some((at(first), at(last)))
    }
}

impl HalfSpace {
    /// Bounds on `offset − normal · origin` and on `normal · direction`.
    fn relation(&self, ray: &Ray) -> ((f64, f64), (f64, f64)) {
        let bounds = |value: f64, magnitude: f64| {
            // Six operations of at most half an ulp each on terms below `magnitude`; 16 leaves room
            // for the rounding of `magnitude` itself, and the last term is for underflow.
            let error = 16.0 * (f64::EPSILON / 2.0) * magnitude + f64::MIN_POSITIVE;
            ((value - error).next_down(), (value + error).next_up())
        };
        let size = |v: DVec3| self.normal.abs().dot(v.abs());
        (
            bounds(self.offset - self.normal.dot(ray.origin), self.offset.abs() + size(ray.origin)),
            bounds(self.normal.dot(ray.direction), size(ray.direction)),
        )
    }
}

/// A lower bound of a quotient of a difference, given its value rounded to nearest twice: at most
/// two ulps away.
fn down(value: f64) -> f64 {
    value.next_down().next_down().next_down()
}

/// The upper bound that corresponds to [`down`].
fn up(value: f64) -> f64 {
    value.next_up().next_up().next_up()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Region {
        Region::new(DVec3::splat(-1.0), DVec3::splat(1.0)).expect("valid")
    }

    fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray { origin: origin.into(), direction: DVec3::from(direction).normalize() }
    }

    #[test]
    fn a_ray_through_the_box_enters_and_leaves() {
        let along = ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let (near, far) = cube().span(&along).expect("meets");
        assert!(near < 2.0 && 2.0 - near < 1e-14 && far > 4.0 && far - 4.0 < 1e-14);
        let entry = cube().entry(&along).expect("from outside");
        assert!(entry.certain && entry.normal == DVec3::NEG_X);
        assert!(entry.t.0 < 2.0 && entry.t.1 > 2.0);
        assert_eq!(cube().span(&ray([-3.0, 0.0, 0.0], [-1.0, 0.0, 0.0])), None);
        assert_eq!(cube().span(&ray([-3.0, 1.5, 0.0], [1.0, 0.0, 0.0])), None);
    }

    #[test]
    fn an_eye_inside_starts_at_0_and_enters_nowhere() {
        let inside = ray([0.5, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let (near, far) = cube().span(&inside).expect("meets");
        assert!(near == 0.0 && far >= 0.5);
        assert_eq!(cube().entry(&inside), None);
    }

    #[test]
    fn a_ray_inside_a_face_is_kept() {
        assert!(cube().span(&ray([-3.0, 1.0, 0.0], [1.0, 0.0, 0.0])).is_some());
        assert!(cube().span(&ray([-3.0, 1.0_f64.next_up(), 0.0], [1.0, 0.0, 0.0])).is_none());
    }

    #[test]
    fn a_half_space_cuts_either_end() {
        let keep_left = HalfSpace { normal: DVec3::X * 2.0, offset: 0.5 };
        let region = cube().with_clip(keep_left).expect("valid");
        let (near, far) = region.span(&ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0])).expect("meets");
        assert!((near - 2.0).abs() < 1e-12 && far > 3.25 && far - 3.25 < 1e-12);
        let back = ray([3.0, 0.0, 0.0], [-1.0, 0.0, 0.0]);
        let (near, _) = region.span(&back).expect("meets");
        assert!(near <= 2.75 && near > 2.75 - 1e-12);
        assert_eq!(region.entry(&back).expect("from outside").normal, DVec3::X);
        // Parallel to the plane, on either side of it.
        assert!(region.span(&ray([0.0, -3.0, 0.0], [0.0, 1.0, 0.0])).is_some());
        assert!(region.span(&ray([0.5, -3.0, 0.0], [0.0, 1.0, 0.0])).is_none());
    }

    #[test]
    fn no_point_inside_is_lost() {
        // Points of the region on exactly representable rays: small integers over powers of two
        // make o + t·d exact.
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        println!("seed {state:#x}");
        let mut random = |range: i64| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state % (2 * range + 1) as u64) as i64 - range
        };
        for _ in 0..20_000 {
            let direction = DVec3::new(random(9) as f64, random(9) as f64, random(9) as f64);
            if direction == DVec3::ZERO {
                continue;
            }
            let point = DVec3::new(random(16) as f64, random(16) as f64, random(16) as f64) / 16.0;
            let t = random(64).unsigned_abs() as f64 / 8.0;
            let ray = Ray { origin: point - direction * t, direction };
            let normal = DVec3::new(random(3) as f64, random(3) as f64, 1.0);
            let clip = HalfSpace { normal, offset: normal.dot(point) };
            let region = cube().with_clip(clip).expect("valid");
            let (near, far) = region.span(&ray).unwrap_or_else(|| panic!("lost: {ray:?} at {t}"));
            assert!(near <= t && t <= far, "{ray:?} at {t}: {near} to {far}");
        }
    }

    #[test]
    fn impossible_regions_are_refused() {
        let low = DVec3::splat(-1.0);
        let bound = |x: f64| Region::new(low, DVec3::new(1.0, x, 1.0));
        assert!(matches!(bound(-1.0), Err(RegionError::Empty { axis: 'y', .. })));
        assert!(matches!(bound(f64::NAN), Err(RegionError::Bound { axis: 'y', .. })));
        assert!(matches!(bound(f64::INFINITY), Err(RegionError::Bound { axis: 'y', .. })));
        let plane = |normal: DVec3, offset| cube().with_clip(HalfSpace { normal, offset });
        assert_eq!(plane(DVec3::ZERO, 0.0), Err(RegionError::Plane));
        assert_eq!(plane(DVec3::X, f64::NAN), Err(RegionError::Plane));
    }
}
