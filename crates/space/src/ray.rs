//! Rays. Nothing is known of cameras or pixels.

use glam::DVec3;

/// A half line: the points `origin + t · direction` for t ≥ 0, in world coordinates.
///
/// It is *defined* by the `f64` numbers stored here, exactly. Every proof about a pixel, every cap,
/// normal, shadow and coordinate is about this one real line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where t is 0: the eye, or a point of the eye's plane in an orthographic picture.
    pub origin: DVec3,
    /// The way from t to t + 1, of any length but 0.
    pub direction: DVec3,
}

impl Ray {
    /// The point at `t`, rounded to nearest.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// The distance of the point at `t` from the origin in world units: t times the direction's
    /// length.
    pub fn distance(&self, t: f64) -> f64 {
        t * self.direction.length()
    }

    /// The t of the point at a distance in world units: the inverse of [`Ray::distance`].
    pub fn parameter(&self, distance: f64) -> f64 {
        distance / self.direction.length()
    }
}
