//! A ball, and the part of a ray in it.

use crate::ray::Ray;
use glam::DVec3;

/// The points no farther than `radius` from `centre`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Center, in world units.
    pub centre: DVec3,
    /// Radius in world units, above 0.
    pub radius: f64,
}

/// The part of a ray in a ball, as ranges of t, which may be negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// First and last t of a range that holds all points of the ray in the ball.
    pub outer: [f64; 2],
    /// First and last t of a range in which all points of the ray are in the ball. If no such range
    /// is known, the first exceeds the last.
    pub inner: [f64; 2],
}

impl Ball {
    /// The unit vector from the ball's center to `point`; zero if the two coincide.
    pub fn normal(&self, point: DVec3) -> DVec3 {
        (point - self.centre).normalize_or_zero()
    }

    /// Returns whether the box from `low` to `high` is proven to lie in the ball.
    pub fn holds(&self, low: DVec3, high: DVec3) -> bool {
        let farthest = (low - self.centre).abs().max((high - self.centre).abs());
        // The first slack is a share of the corners' coordinates, from which the center is
        // subtracted. The second slack covers a dozen roundings.
        let size = farthest + low.abs().max(high.abs()) * f64::EPSILON;
        size.length() * (1.0 + 16.0 * f64::EPSILON) <= self.radius
    }

    /// The part of `ray` in the ball; `None` if the ray misses the ball. If squares overflow,
    /// nothing is known: the result then allows every t to be in the ball.
    pub fn chord(&self, ray: &Ray) -> Option<Chord> {
        const UNKNOWN: Chord = Chord {
            outer: [f64::NEG_INFINITY, f64::INFINITY],
            inner: [f64::INFINITY, f64::NEG_INFINITY],
        };
        let direction = ray.direction;
        let square = direction.length_squared();
        // Distances along the ray are measured from `nearest`, the approximate t of the point
        // nearest to the center. So little cancels, even if the eye is far away.
        let way = self.centre - ray.origin;
        let nearest = way.dot(direction) / square;
        let offset = way - nearest * direction;
        let speed = square.sqrt();
        let size = offset.length();
        // Bounds the error of the offset. Each coordinate is rounded three times: in the first
        // difference, the product and the second difference.
        let error =
            4.0 * f64::EPSILON * (way.length() + nearest.abs() * speed) + f64::MIN_POSITIVE.sqrt();
        // The middle of the chord, measured from `nearest`. It is 0 up to rounding, since the
        // offset is perpendicular to the ray.
        let middle = offset.dot(direction) / square;
        let half = |radius: f64, outward: f64| {
            // The slack covers the roundings of two squares and of the term with `middle`.
            let slack = outward * 16.0 * f64::EPSILON * (radius * radius + size * size);
            let room = radius * radius - size * size + middle * middle * square + slack;
            (room >= 0.0).then(|| room.sqrt() / speed)
        };
        let ends = |half: f64, outward: f64| {
            let size = nearest.abs() + size / speed + half;
            let slack = outward * 16.0 * f64::EPSILON * size;
            [nearest + (middle - half) - slack, nearest + (middle + half) + slack]
        };
        let farthest = self.radius + error;
        let sizes = farthest * farthest + size * size + error + nearest.abs() + 1.0 / speed;
        if !sizes.is_finite() {
            return Some(UNKNOWN);
        }
        let outer = ends(half(farthest, 1.0)?, 1.0);
        let least = self.radius - error;
        let inner = half(least, -1.0).filter(|_| least > 0.0);
        Some(Chord { outer, inner: inner.map_or(UNKNOWN.inner, |half| ends(half, -1.0)) })
    }
}
