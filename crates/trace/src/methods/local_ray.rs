//! A ray's way through the region, and boxes that hold parts of it.
//!
//! Boxes hold the real ray, whatever floats round. What is asked about them is not known here.

use crate::method::Segment;
use glam::DVec3;
use zeroset_interval::Interval;
use zeroset_space::Ray;
use zeroset_space::Region;

/// Where a part of a ray is cut, as a share of it: not in the middle, where symmetric surfaces have
/// zeros whose sign could not be told.
pub(super) const CUT: f64 = 0.460_937_5;
/// Parts of a ray that stay open, at most: after so many the rest of it is given up.
pub(super) const OPEN_PARTS: u32 = 16;

/// A ray to be followed: the points `origin` + s·`direction`.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LocalRay {
    pub origin: DVec3,
    pub direction: DVec3,
    /// How far the real ray may be from that, per axis.
    pub error: DVec3,
    /// s where the ray starts.
    pub start: f64,
    /// s between which zeros are looked for.
    pub span: [f64; 2],
    /// s between which the ray is certainly in the region.
    pub inside: [f64; 2],
    /// How long the bracket of a hit may be.
    pub longest: f64,
}

impl LocalRay {
    /// A ray's way through the region, from where it enters: s is 0 there, and t is s − `start`.
    /// `None` if it does not meet the region.
    pub fn new(segment: &Segment, region: &Region) -> Option<Self> {
        let ray = &segment.ray;
        let [near, far] = segment.within(region)?;
        // The way to where s is 0: a few roundings.
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

/// Bounds of s between which a ray is certainly in the region, given that t is s + `start`.
pub(super) fn inside(region: &Region, ray: &Ray, start: f64) -> [f64; 2] {
    let [near, far] = region.inner(ray);
    // The differences are rounded, but for an eye in the region.
    [if near == 0.0 { -start } else { (near - start).next_up() }, (far - start).next_down()]
}

/// Bounds of s between which a ray is certainly between the region's faces, its clipping plane
/// apart, given how far the ray may be from its points `origin` + s·`direction`.
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

/// Bounds of a segment's points in the region.
pub(super) fn bounds(way: &LocalRay, [near, far]: [f64; 2], region: &Region) -> [Interval; 3] {
    std::array::from_fn(|axis| {
        let ends = [near, far].map(|s| way.origin[axis] + s * way.direction[axis]);
        let size = way.origin[axis].abs() + near.abs().max(far.abs()) * way.direction[axis].abs();
        let slack = way.error[axis] + 4.0 * f64::EPSILON * size;
        let (low, high) = (region.low()[axis], region.high()[axis]);
        Interval {
            // In this order, what is not a number bounds nothing.
            lo: (ends[0].min(ends[1]) - slack).max(low).min(high),
            hi: (ends[0].max(ends[1]) + slack).min(high).max(low),
        }
    })
}
