//! The rays of a picture as points o + a·o₁ + b·o₂ + s·(d + a·d₁ + b·d₂) near the region, in the floats of the
//! kernels.
//!
//! Screen coordinates (a, b) are those of the [`RayGrid`]; s is the ray's t less that of a plane through the region's centre,
//! so that `f32` is spent on the region and not on the way to it.

use crate::grid::RayGrid;
use crate::region::Region;
use crate::scalar::Scalar;
use glam::DVec3;
use zeroset_eval::{Lanes, Segments, Tiles};

/// Forms lose a few times what their coordinates are rounded by.
pub(super) const BLURS: f64 = 4.0;

/// What the rays of a picture have in common.
pub(super) struct Frame {
    /// t where s is 0.
    pub start: f64,
    /// s between which the region lies, as far as rays reach it.
    pub span: [f64; 2],
    /// o, o₁ and o₂.
    pub origin: [DVec3; 3],
    /// d, d₁ and d₂.
    pub direction: [DVec3; 3],
    /// The largest screen coordinates of a picture's rays.
    pub reach: [f64; 2],
    /// Bounds on the error of coordinates that are computed in `f64`, from this frame or for the rays themselves.
    pub error: DVec3,
}

impl Frame {
    pub fn new(rays: &RayGrid, region: &Region) -> Self {
        let (eye, forward) = (rays.eye(), rays.forward());
        let depth = |point: DVec3| (point - eye).dot(forward);
        let start = depth(region.centre()).max(0.0);
        let half = (region.high() - region.low()) / 2.0;
        let reach_of_box = half.dot(forward.abs());
        let middle = depth(region.centre());
        // Moved out by more than what these few operations round.
        let slack = 1e-12 * (middle.abs() + reach_of_box + eye.length());
        let near = (middle - reach_of_box - slack).max(0.0);
        let far = (middle + reach_of_box + slack).max(0.0);
        let at = eye + start * forward;
        let (right, up) = (rays.right(), rays.up());
        let (origin, direction) = if rays.is_parallel() {
            ([at, right, up], [forward, DVec3::ZERO, DVec3::ZERO])
        } else {
            ([at, start * right, start * up], [forward, right, up])
        };
        let reach = rays.reach();
        // The way from the eye in f64: a dozen roundings of what is added up, here and in the ray itself.
        let sum = |parts: &[DVec3; 3]| {
            parts[0].abs() + reach[0] * parts[1].abs() + reach[1] * parts[2].abs()
        };
        let farthest = far.max(start);
        let error = 16.0
            * f64::EPSILON
            * (eye.abs() + sum(&origin) + farthest * (forward.abs() + sum(&direction)));
        Self { start, span: [near - start, far - start], origin, direction, reach, error }
    }

    /// The farthest end of a segment from s = 0.
    pub fn size(&self) -> f64 {
        self.span[0].abs().max(self.span[1].abs())
    }

    /// What `T` tells apart along a ray: the length of the shortest segments, or some times what coordinates are rounded by.
    pub fn resolution<T: Scalar>(&self) -> f64 {
        (T::GRAIN * self.size()).max(BLURS * self.error_in::<T>(self.size()).max_element())
    }

    /// Bounds on the error of coordinates that kernels compute from this frame in `T`, for s within `most` of 0.
    ///
    /// Room is left for underflow, and a part is rounded to `T` first.
    fn error_in<T: Scalar>(&self, most: f64) -> DVec3 {
        let sum = |parts: &[DVec3; 3]| {
            parts[0].abs() + self.reach[0] * parts[1].abs() + self.reach[1] * parts[2].abs()
        };
        let least: f64 = T::LEAST_NORMAL.into();
        let scale = (1.0 + most) * (1.0 + self.reach[0] + self.reach[1]);
        let rounding =
            (T::PATH_ERROR + T::UNIT) * (sum(&self.origin) + most * sum(&self.direction));
        self.error + rounding + DVec3::splat(4.0 * least * scale)
    }

    /// A batch in which the frame is set.
    pub fn tiles<T: Scalar>(&self) -> Tiles<T> {
        let mut tiles = Tiles::default();
        let error = self.error_in::<T>(self.size());
        for axis in 0..3 {
            for part in 0..3 {
                let splat = |vector: DVec3| Lanes::splat(T::nearest(vector[axis]));
                tiles.origin[3 * part + axis] = splat(self.origin[part]);
                tiles.direction[3 * part + axis] = splat(self.direction[part]);
            }
            tiles.error[axis] = Lanes::splat(T::above(error[axis]));
        }
        tiles
    }

    /// A batch of rays of this picture, in which their error is set.
    pub fn segments<T: Scalar>(&self) -> Segments<T> {
        let error = self.error_in::<T>(self.size());
        let error = [error.x, error.y, error.z].map(|error| Lanes::splat(T::above(error)));
        Segments { error, ..Segments::default() }
    }

    /// Origin (s = 0) and direction of the ray at screen coordinates.
    pub fn ray(&self, [a, b]: [f64; 2]) -> [DVec3; 2] {
        [&self.origin, &self.direction].map(|parts| parts[0] + a * parts[1] + b * parts[2])
    }

    /// Bounds of s between which a tile's rays may be in the region, and whether they are in it from the one to the other.
    /// `None` if none reaches it.
    pub fn clip(
        &self,
        tile: &Tile,
        region: &Region,
        [mut near, mut far]: [f64; 2],
    ) -> Option<[f64; 2]> {
        let [low, high] = [region.low(), region.high()];
        for axis in 0..3 {
            let [o, d] =
                [Self::range(&self.origin, tile, axis), Self::range(&self.direction, tile, axis)];
            let slack = self.error[axis];
            let (low, high) = (low[axis] - slack, high[axis] + slack);
            // Where all rays go the same way, they come in after the first that can and leave before the last that can.
            let (enter, leave) = if d[0] > 0.0 {
                ([low - o[1], d[0], d[1]], [high - o[0], d[0], d[1]])
            } else if d[1] < 0.0 {
                ([o[0] - high, -d[1], -d[0]], [o[1] - low, -d[1], -d[0]])
            } else {
                continue;
            };
            // A negative way is longest over the least speed, a positive one over the greatest.
            let first = if enter[0] < 0.0 { enter[0] / enter[1] } else { enter[0] / enter[2] };
            let last = if leave[0] < 0.0 { leave[0] / leave[2] } else { leave[0] / leave[1] };
            near = near.max(first - 1e-12 * first.abs());
            far = far.min(last + 1e-12 * last.abs());
        }
        (near <= far).then_some([near, far])
    }

    /// Whether all of a tile's rays are in the region from s = `near` to `far`, its clipping plane apart.
    pub fn is_inside(&self, tile: &Tile, region: &Region, [near, far]: [f64; 2]) -> bool {
        let [low, high] = [region.low(), region.high()];
        let bounds = |axis: usize| {
            let [o, d] =
                [Self::range(&self.origin, tile, axis), Self::range(&self.direction, tile, axis)];
            let least = o[0] + (near * d[0]).min(near * d[1]).min(far * d[0]).min(far * d[1]);
            let most = o[1] + (near * d[0]).max(near * d[1]).max(far * d[0]).max(far * d[1]);
            [least, most]
        };
        let is_between = |axis: usize| {
            let ([least, most], slack) = (bounds(axis), self.error[axis]);
            low[axis] + slack <= least && most <= high[axis] - slack
        };
        (0..3).all(is_between)
            && region.ball().is_none_or(|ball| {
                let [x, y, z] = [0, 1, 2].map(bounds);
                let (least, most) = (DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1]));
                ball.holds(least - self.error, most + self.error)
            })
    }

    /// Bounds of one coordinate of a sum of three over a tile.
    fn range(parts: &[DVec3; 3], tile: &Tile, axis: usize) -> [f64; 2] {
        let [at, a, b] = [parts[0][axis], parts[1][axis], parts[2][axis]];
        let middle = at + tile.centre[0] * a + tile.centre[1] * b;
        let reach = tile.half[0] * a.abs() + tile.half[1] * b.abs();
        [middle - reach, middle + reach]
    }
}

/// The screen coordinates of the rays of some pixels: within `half` of `centre`.
pub(super) struct Tile {
    pub centre: [f64; 2],
    pub half: [f64; 2],
}

impl Tile {
    /// The pixels of these columns and rows of a picture, the last included.
    pub fn new(rays: &RayGrid, columns: [usize; 2], rows: [usize; 2]) -> Self {
        let centre = rays.screen(columns[0] + columns[1], rows[0] + rows[1]);
        let half = [columns, rows].map(|[first, last]| (last - first) as f64 * rays.unit());
        Self { centre, half }
    }
}
