//! Rays within the region, and boxes that contain parts of them.
//!
//! Boxes contain the real ray despite rounding. This module does not know what boxes are used for.

use crate::method::Segment;
use glam::DVec3;
use zeroset_interval::Interval;
use zeroset_space::{Ray, Region};

/// The place at which a part of a ray is cut, as a share of its length. It is not the middle, where
/// symmetric surfaces have zeros whose sign is uncertain.
pub(super) const CUT: f64 = 0.460_937_5;
/// Maximum number of undecided parts of a ray. After that many, the rest of the ray is given up.
pub(super) const MAX_OPEN_PARTS: u32 = 16;

/// A ray to be followed, as the points `origin` + s·`direction`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LocalRay {
    pub origin: DVec3,
    pub direction: DVec3,
    /// Per axis, the maximum distance of the real ray from these points.
    pub error: DVec3,
    /// Value of s where the ray starts.
    pub start: f64,
    /// Values of s between which zeros are searched for.
    pub span: [f64; 2],
    /// Values of s between which the ray is certainly in the region.
    pub inside: [f64; 2],
    /// Maximum length of a hit's bracket.
    pub longest: f64,
}

impl LocalRay {
    /// Creates a ray whose s is 0 where it enters the region; t is s − `start`. `None` if it does
    /// not meet the region.
    pub fn new(segment: &Segment, region: &Region) -> Option<Self> {
        let ray = &segment.ray;
        let [near, far] = segment.within(region)?;
        // The point at s = 0 takes a few roundings.
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

/// Returns values of s between which a ray is certainly in the region, for t = s + `start`.
pub(super) fn inside(region: &Region, ray: &Ray, start: f64) -> [f64; 2] {
    let [near, far] = region.inner(ray);
    // The differences are rounded, so they are moved inward. For an eye inside the region, the near
    // end is exact.
    [if near == 0.0 { -start } else { (near - start).next_up() }, (far - start).next_down()]
}

/// Returns values of s between which a ray is certainly between the region's faces. The clipping
/// plane is ignored. The ray is within `error` of its points `origin` + s·`direction`.
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

/// Returns a box around a segment's points in the region.
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
            // In this order, NaN becomes a bound of the region.
            lo: (ends[0].min(ends[1]) - slack).max(low).min(high),
            hi: (ends[0].max(ends[1]) + slack).min(high).max(low),
        }
    })
}
