//! Rays. Nothing here knows cameras or pixels.

use glam::DVec3;

/// A half line: the points `origin + t · direction` for t ≥ 0, in world coordinates.
///
/// The `f64` numbers stored here define it exactly. Every proof about a pixel, and every cap,
/// normal, shadow and coordinate, refers to this real line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at t = 0: the eye, or a point of the eye's plane in an orthographic picture.
    pub origin: DVec3,
    /// The step from the point at t to the point at t + 1, of any length but 0.
    pub direction: DVec3,
}

impl Ray {
    /// The point at `t`, rounded to nearest.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// The distance in world units from the origin to the point at `t`: t times the direction's
    /// length.
    pub fn distance(&self, t: f64) -> f64 {
        t * self.direction.length()
    }

    /// The t of the point at `distance` from the origin, in world units: the inverse of
    /// [`Ray::distance`].
    pub fn parameter(&self, distance: f64) -> f64 {
        distance / self.direction.length()
    }
}
