//! Rays within the region, and boxes that contain parts of them.
//!
//! Boxes contain the exact ray despite rounding. This module does not know what boxes are used for.

use crate::method::Segment;
use glam::DVec3;
use zeroset_interval::Interval;
use zeroset_space::{Ray, Region};

/// The place at which a part of a ray is cut, as a share of the part's length. It is not the
/// middle, where symmetric surfaces have zeros: there a sign would be uncertain.
pub(super) const CUT: f64 = 0.460_937_5;
/// Maximum number of undecided parts of a ray. Behind the last of them, the ray is given up.
pub(super) const MAX_OPEN_PARTS: u32 = 16;

/// A ray near the region: the points `origin` + s·`direction`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LocalRay {
    pub origin: DVec3,
    pub direction: DVec3,
    /// Per axis, the maximum distance of the exact ray's points from `origin` + s·`direction`.
    pub error: DVec3,
    /// Value of s at the ray's start.
    pub start: f64,
    /// First and last s at which zeros are searched for.
    pub span: [f64; 2],
    /// First and last s between which the ray is proven to lie in the region.
    pub inside: [f64; 2],
    /// Maximum length of a hit's bracket.
    pub longest: f64,
}

impl LocalRay {
    /// Creates a ray with s = 0 at the place where it enters the region. `None` if it misses the
    /// region. The ray's t is s − `start`.
    pub fn new(segment: &Segment, region: &Region) -> Option<Self> {
        let ray = &segment.ray;
        let [near, far] = segment.within(region)?;
        // Computing the point at s = 0 takes a few roundings.
        let error = 4.0 * f64::EPSILON * (ray.origin.abs() + far.abs() * ray.direction.abs());
        let span = [0.0, far - near];
        Some(Self {
            origin: ray.at(near),
            direction: ray.direction,
            error,
            start: -near,
            span,
            inside: inside(region, ray, near),
            longest: f64::INFINITY,
        })
    }
}

/// Returns the range of s = t − `start` in which a ray is proven to lie in the region.
pub(super) fn inside(region: &Region, ray: &Ray, start: f64) -> [f64; 2] {
    let [near, far] = region.inner(ray);
    // A rounded end may lie outside the exact range. So each end is moved inward by one float. If
    // the eye is inside the region, `near` is 0, and −`start` is exact.
    [if near == 0.0 { -start } else { (near - start).next_up() }, (far - start).next_down()]
}

/// Returns the range of s in which a ray is proven to lie in the region's box. A clipping plane is
/// ignored. The exact ray is within `error` of the points `origin` + s·`direction`.
pub(super) fn between_faces([origin, direction, error]: [DVec3; 3], region: &Region) -> [f64; 2] {
    let (mut near, mut far) = (f64::NEG_INFINITY, f64::INFINITY);
    let (low, high) = (region.low() + error, region.high() - error);
    for axis in 0..3 {
        let (o, d) = (origin[axis], direction[axis]);
        if d == 0.0 {
            if !(low[axis] <= o && o <= high[axis]) {
                far = f64::NEG_INFINITY;
            }
            continue;
        }
        let (enter, leave) = ((low[axis] - o) / d, (high[axis] - o) / d);
        let (enter, leave) = (enter.min(leave), enter.max(leave));
        near = near.max(enter + 1e-12 * enter.abs());
        far = far.min(leave - 1e-12 * leave.abs());
    }
    [near, far]
}

/// Returns a box around the points of a segment, clipped to the region.
pub(super) fn bounds(
    local_ray: &LocalRay,
    [near, far]: [f64; 2],
    region: &Region,
) -> [Interval; 3] {
    std::array::from_fn(|axis| {
        let ends = [near, far].map(|s| local_ray.origin[axis] + s * local_ray.direction[axis]);
        let size = local_ray.origin[axis].abs()
            + near.abs().max(far.abs()) * local_ray.direction[axis].abs();
        let slack = local_ray.error[axis] + 4.0 * f64::EPSILON * size;
        let (low, high) = (region.low()[axis], region.high()[axis]);
        Interval {
            // In this order of operations, NaN becomes a bound of the region.
            lo: (ends[0].min(ends[1]) - slack).max(low).min(high),
            hi: (ends[0].max(ends[1]) + slack).min(high).max(low),
        }
    })
}
