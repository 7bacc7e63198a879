//! The region in which a surface is looked for: a box, optionally cut by a half-space and a ball.
//!
//! Bounds are rounded outward, so that no part of a ray inside the region is lost. Nothing here
//! knows functions or pixels.

mod ball;

use crate::ray::Ray;
pub use ball::{Ball, Chord};
use glam::DVec3;
use thiserror::Error;

/// Largest magnitude of a coordinate of a region. Squares of larger coordinates could overflow in
/// `f32` kernels. The limit also holds for `f64`, so that a domain does not depend on the
/// precision.
pub const LARGEST_COORDINATE: f64 = 1e18;

/// The points `p` with `normal · p ≤ offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// Normal of the boundary plane, pointing out of the half-space, of any length but 0.
    pub normal: DVec3,
    /// Largest value of `normal · p` in the half-space.
    pub offset: f64,
}

/// A closed box, cut by at most one half-space and by at most one ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    low: DVec3,
    high: DVec3,
    clip: Option<HalfSpace>,
    ball: Option<Ball>,
    stretch: DVec3,
}

/// Why a region is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum RegionError {
    /// A bound is NaN, infinite or too large for the kernels.
    #[error(
        "the {axis} range of the domain, {low:?} to {high:?}, has a bound that is not a number within ±1e18"
    )]
    Bound {
        /// The coordinate's name.
        axis: char,
        /// Lower bound of the coordinate.
        low: f64,
        /// Upper bound of the coordinate.
        high: f64,
    },
    /// The lower bound of a coordinate's range is not below the upper bound.
    #[error(
        "the {axis} range of the domain, {low} to {high}, is empty: the first bound must be the smaller"
    )]
    Empty {
        /// The coordinate's name.
        axis: char,
        /// Lower bound of the coordinate.
        low: f64,
        /// Upper bound of the coordinate.
        high: f64,
    },
    /// The half-space's normal is zero, or one of its numbers is out of range.
    #[error(
        "the clipping plane a,b,c,d needs finite numbers, and a, b, c not all zero nor all below 1e-150 or one above 1e150"
    )]
    Plane,
}

/// The place where a ray enters a region from outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Bounds of the t at which the ray crosses the face.
    pub t: (f64, f64),
    /// The face's unit normal, pointing out of the region.
    pub normal: DVec3,
    /// Whether the ray is proven to meet the region, despite rounding.
    pub certain: bool,
}

impl Region {
    /// The box with the corners `low` and `high`.
    ///
    /// # Errors
    /// If a coordinate is NaN or exceeds 1e18 in magnitude, or a coordinate of `low` is not below
    /// the same coordinate of `high`.
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
        Ok(Self { low, high, clip: None, ball: None, stretch: DVec3::ONE })
    }

    /// This region, cut by the half-space `clip`.
    ///
    /// # Errors
    /// If a number of `clip` is not finite, or the square of its normal's length is 0 or infinite.
    pub fn with_clip(self, clip: HalfSpace) -> Result<Self, RegionError> {
        let valid = clip.normal.try_normalize().is_some() && clip.offset.is_finite();
        if valid { Ok(Self { clip: Some(clip), ..self }) } else { Err(RegionError::Plane) }
    }

    /// This region, cut by a ball around the box's center. The ball's radius is
    /// [`Region::half_extent`].
    #[must_use]
    pub fn with_ball(self) -> Self {
        let ball = Ball { centre: self.centre(), radius: self.half_extent() };
        Self { ball: Some(ball), ..self }
    }

    /// This region, whose lengths along the axes cameras multiply by these factors.
    #[must_use]
    pub fn with_stretch(self, stretch: DVec3) -> Self {
        Self { stretch, ..self }
    }

    /// For each axis, the factor by which lengths are multiplied for display. Only cameras use it:
    /// rays and everything found on them have the lengths of space. Powers of two, mostly 1.
    pub fn stretch(&self) -> DVec3 {
        self.stretch
    }

    /// The box as displayed: lengths are multiplied by [`Region::stretch`]. Nothing cuts it.
    #[must_use]
    pub fn displayed(&self) -> Self {
        let (low, high) = (self.low * self.stretch, self.high * self.stretch);
        Self { low, high, clip: None, ball: None, stretch: DVec3::ONE }
    }

    /// The corner with the smallest coordinates.
    pub fn low(&self) -> DVec3 {
        self.low
    }

    /// The corner with the largest coordinates.
    pub fn high(&self) -> DVec3 {
        self.high
    }

    /// The half-space that cuts the box, if any.
    pub fn clip(&self) -> Option<HalfSpace> {
        self.clip
    }

    /// The ball that cuts the box, if any.
    pub fn ball(&self) -> Option<Ball> {
        self.ball
    }

    /// Returns whether a half-space or a ball cuts the box.
    pub fn is_cut(&self) -> bool {
        self.clip.is_some() || self.ball.is_some()
    }

    /// The center of the box, cut or not.
    pub fn centre(&self) -> DVec3 {
        (self.low + self.high) / 2.0
    }

    /// Half of the box's largest extent.
    pub fn half_extent(&self) -> f64 {
        (self.high - self.low).max_element() / 2.0
    }

    /// Returns whether a point is in the region, or at most `slack` away from it, up to rounding.
    pub fn is_near(&self, point: DVec3, slack: f64) -> bool {
        let beyond = (self.low - point).max(point - self.high).max_element();
        let is_cut = self.clip.is_some_and(|HalfSpace { normal, offset }| {
            normal.dot(point) > offset + slack * normal.length()
        });
        let is_out = |ball: Ball| point.distance(ball.centre) > ball.radius + slack;
        beyond <= slack && !is_cut && !self.ball.is_some_and(is_out)
    }

    /// Bounds of the t ≥ 0 at which points of `ray` lie inside the region, rounded outward. `None`
    /// if no point does.
    pub fn span(&self, ray: &Ray) -> Option<(f64, f64)> {
        let [near, far] = self.ends::<true>(ray)?;
        (near <= far).then_some((near, far))
    }

    /// The first and last t ≥ 0 between which all points of `ray` are proven to lie inside the
    /// region. If there are no such t, the first exceeds the last.
    pub fn inner(&self, ray: &Ray) -> [f64; 2] {
        self.ends::<false>(ray).unwrap_or([f64::INFINITY, f64::NEG_INFINITY])
    }

    /// The first and last t ≥ 0 at which points of `ray` lie inside the region, rounded outward if
    /// `OUTWARD`, else inward. If no point lies inside, the result is `None`, or the first exceeds
    /// the last.
    #[inline]
    fn ends<const OUTWARD: bool>(&self, ray: &Ray) -> Option<[f64; 2]> {
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (from, to) = self.slab(ray, axis)?;
            near = near.max(if OUTWARD { from.0 } else { from.1 });
            far = far.min(if OUTWARD { to.1 } else { to.0 });
        }
        if let Some(clip) = &self.clip {
            let (room, slope) = clip.relation(ray);
            // The half-space holds the t with t·slope ≤ room. Both numbers have bounds. As t ≥ 0,
            // the smallest slope and the largest room give the widest range of t. The largest slope
            // and the smallest room give the narrowest.
            let (slope, room) = if OUTWARD { (slope.0, room.1) } else { (slope.1, room.0) };
            let end = room / slope;
            if slope > 0.0 {
                far = far.min(if OUTWARD { up(end) } else { down(end) });
            } else if slope < 0.0 {
                near = near.max(if OUTWARD { down(end) } else { up(end) });
            } else if room < 0.0 {
                return None;
            }
        }
        if let Some(ball) = &self.ball {
            let chord = ball.chord(ray)?;
            let [first, last] = if OUTWARD { chord.outer } else { chord.inner };
            near = near.max(first);
            far = far.min(last);
        }
        Some([near, far])
    }

    /// The place where the ray enters the region. `None` if the ray starts inside or never enters.
    pub fn entry(&self, ray: &Ray) -> Option<Entry> {
        let (mut near, mut far) = ((0.0_f64, 0.0_f64), f64::INFINITY);
        let mut normal = None;
        // Records that the ray crosses a face from outside. The last face crossed gives the normal.
        let mut cross = |crossing: (f64, f64), face: DVec3| {
            if crossing.0 > near.0 {
                normal = Some(face);
            }
            near = (near.0.max(crossing.0), near.1.max(crossing.1));
        };
        for axis in 0..3 {
            let (from, to) = self.slab(ray, axis)?;
            cross(from, DVec3::AXES[axis] * -ray.direction[axis].signum());
            far = far.min(to.0);
        }
        if let Some(clip) = &self.clip {
            let (room, slope) = clip.relation(ray);
            if slope.1 < 0.0 && room.1 < 0.0 {
                let crossing = (down(room.1 / slope.0), up(room.0 / slope.1));
                cross(crossing, clip.normal.normalize());
            } else if slope.1 > 0.0 {
                far = far.min(down(room.0 / slope.1));
            } else if room.0 < 0.0 {
                far = 0.0;
            }
        }
        if let Some(ball) = &self.ball {
            let chord = ball.chord(ray)?;
            let [first, last] = chord.inner;
            let crossing = (chord.outer[0], if first <= last { first } else { chord.outer[1] });
            cross(crossing, ball.normal(ray.at(crossing.0)));
            far = far.min(last);
        }
        self.span(ray)?;
        let normal = normal?;
        Some(Entry { t: near, normal, certain: near.1 <= far })
    }

    /// Bounds of the t at which the ray enters the slab of one axis, and of the t at which it
    /// leaves. `None` if the ray runs parallel to the slab, outside of it.
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
    /// Bounds of `offset − normal · origin`, then of `normal · direction`.
    fn relation(&self, ray: &Ray) -> ((f64, f64), (f64, f64)) {
        let bounds = |value: f64, magnitude: f64| {
            // Each of six operations has an error of at most half an ulp, on terms below
            // `magnitude`. The factor 16 also covers the rounding of `magnitude`. The last term
            // covers underflow.
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

/// A lower bound of (a − b) / c, given the float result, which is at most two ulps away.
fn down(value: f64) -> f64 {
    value.next_down().next_down().next_down()
}

/// An upper bound of (a − b) / c, given the float result, which is at most two ulps away.
fn up(value: f64) -> f64 {
    value.next_up().next_up().next_up()
}

#[cfg(test)]
mod tests;
