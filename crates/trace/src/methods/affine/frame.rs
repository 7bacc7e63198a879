//! The rays of a picture as points o + a·o₁ + b·o₂ + s·(d + a·d₁ + b·d₂) near the region. The
//! floats have the precision of the kernels.
//!
//! (a, b) are screen coordinates of the [`RayGrid`]. s is the ray's t minus the t of a plane
//! through the region's center. So `f32` resolves the region, however far away the eye is.

use super::screens::{Ends, ScreenRays};
use crate::grid::RayGrid;
use crate::scalar::{HALF, Scalar};
use crate::simd_chunks::parts;
use fearless_simd::{f64x8, prelude::*};
use glam::DVec3;
use zeroset_eval::{LANES, Lanes, Segments, Tiles};
use zeroset_space::{Basis, Region};

/// Error of forms as a multiple of the rounding error of coordinates in them.
pub(super) const FORM_BLUR: f64 = 4.0;

/// The vectors and bounds that all rays of a picture share.
#[derive(Clone, Copy)]
pub(super) struct RayFrame {
    /// The rays' t at s = 0.
    pub start: f64,
    /// First and last s at which a ray may be in the region.
    pub span: [f64; 2],
    /// The vectors o, o₁ and o₂.
    pub origin: [DVec3; 3],
    /// The vectors d, d₁ and d₂.
    pub direction: [DVec3; 3],
    /// On each screen axis, the largest coordinate of the picture's rays.
    pub reach: [f64; 2],
    /// Per axis, a bound of the error of coordinates computed in `f64`. It holds for points
    /// computed from this frame, and from the rays themselves.
    pub error: DVec3,
}

impl RayFrame {
    pub fn new(rays: &RayGrid, region: &Region) -> Self {
        let (eye, stretch) = (rays.eye(), rays.stretch());
        // t is the depth in the displayed space.
        let middle = ((region.centre() - eye) * stretch).dot(rays.forward());
        let start = middle.max(0.0);
        let half = (region.high() - region.low()) / 2.0 * stretch;
        let reach_of_box = half.dot(rays.forward().abs());
        // The ends are moved outward by more than their rounding errors.
        let slack = 1e-12 * (middle.abs() + reach_of_box + (eye * stretch).length());
        let near = (middle - reach_of_box - slack).max(0.0);
        let far = (middle + reach_of_box + slack).max(0.0);
        let Basis { forward, right, up } = rays.axes;
        let at = eye + start * forward;
        let (origin, direction) = if rays.parallel {
            ([at, right, up], [forward, DVec3::ZERO, DVec3::ZERO])
        } else {
            ([at, start * right, start * up], [forward, right, up])
        };
        let reach = rays.reach;
        // The error of coordinates computed in `f64` from the eye. It covers a dozen roundings, in
        // the frame and in the ray itself.
        let farthest = far.max(start);
        let error = 16.0
            * f64::EPSILON
            * (eye.abs()
                + largest(&origin, reach)
                + farthest * (forward.abs() + largest(&direction, reach)));
        Self { start, span: [near - start, far - start], origin, direction, reach, error }
    }

    /// Returns the largest |s| of a segment's ends.
    pub fn size(&self) -> f64 {
        self.span[0].abs().max(self.span[1].abs())
    }

    /// Returns the shortest length along a ray that `T` resolves: the length of the shortest
    /// segments, or a few times the rounding error of coordinates, whichever is larger.
    pub fn resolution<T: Scalar>(&self) -> f64 {
        (T::GRAIN * self.size()).max(FORM_BLUR * self.error_in::<T>(self.size()).max_element())
    }

    /// Returns a bound for each axis of the error of coordinates that kernels compute in `T` from
    /// this frame. It holds at places on rays with |s| of at most `most`.
    ///
    /// It covers underflow, and the rounding of vectors and screen coordinates to `T`.
    pub fn error_in<T: Scalar>(&self, most: f64) -> DVec3 {
        let least: f64 = T::LEAST_NORMAL.into();
        let scale = (1.0 + most) * (1.0 + self.reach[0] + self.reach[1]);
        let sizes = largest(&self.origin, self.reach) + most * largest(&self.direction, self.reach);
        let rounding = (T::PATH_ERROR + T::UNIT) * sizes;
        self.error + rounding + DVec3::splat(4.0 * least * scale)
    }

    /// Returns a batch of tiles, filled with this frame's vectors and errors.
    pub fn tiles<T: Scalar>(&self) -> Tiles<T> {
        let mut tiles = Tiles { error: self.segments_error(), ..Tiles::default() };
        for axis in 0..3 {
            for part in 0..3 {
                let splat = |vector: DVec3| Lanes::splat(T::nearest(vector[axis]));
                tiles.origin[3 * part + axis] = splat(self.origin[part]);
                tiles.direction[3 * part + axis] = splat(self.direction[part]);
            }
        }
        tiles
    }

    /// Returns a bound of the error of coordinates of this picture's rays: for each axis, the same
    /// number in all lanes.
    pub fn segments_error<T: Scalar>(&self) -> [Lanes<T>; 3] {
        let error = self.error_in::<T>(self.size());
        [error.x, error.y, error.z].map(|error| Lanes::splat(T::above(error)))
    }

    /// Writes the origins (s = 0) and directions of rays. `at` has the rays' screen coordinates,
    /// rounded to `T`. Results are rounded as in kernels for tiles, which [`Self::error_in`]
    /// covers.
    #[inline(always)]
    pub fn place<S: Simd, T: Scalar>(&self, simd: S, at: &[Lanes<T>; 2], rays: &mut Segments<T>) {
        let ways = [&mut rays.origin, &mut rays.direction];
        for (by_axis, way) in self.by_axis().into_iter().zip(ways) {
            for ([start, a, b], lanes) in by_axis.map(|parts| parts.map(T::nearest)).iter().zip(way)
            {
                for part in parts::<S, T::Vector<S>>(simd, LANES) {
                    let [across, up] = at.each_ref().map(|at| part.load(at));
                    let along = across.mul_add(part.splat(*a), part.splat(*start));
                    part.store(up.mul_add(part.splat(*b), along), lanes);
                }
            }
        }
    }

    /// Writes one screen coordinate of tiles: their centers and half extents. The half extents are
    /// enlarged by the rounding of both.
    #[inline(always)]
    pub fn place_tiles<S: Simd, T: Scalar>(
        &self,
        axis: usize,
        [centre, half]: [[f64x8<S>; 2]; 2],
        tiles: &mut Tiles<T>,
    ) {
        T::narrow(centre, &mut tiles.centre[axis]);
        let reach = T::PATH_ERROR * self.reach[axis];
        T::narrow([half[0] + reach, half[1] + reach], &mut tiles.half[axis]);
    }

    /// Like [`Self::place_tiles`], for one tile.
    pub fn place_tile<T: Scalar>(
        &self,
        axis: usize,
        [centre, half]: [f64; 2],
        lane: usize,
        tiles: &mut Tiles<T>,
    ) {
        tiles.centre[axis][lane] = T::nearest(centre);
        tiles.half[axis][lane] = T::nearest(half + T::PATH_ERROR * self.reach[axis]);
    }

    /// Returns the origin (s = 0) and direction of the ray with screen coordinates a and b.
    pub fn ray(&self, [a, b]: [f64; 2]) -> [DVec3; 2] {
        [&self.origin, &self.direction].map(|parts| parts[0] + a * parts[1] + b * parts[2])
    }

    /// Returns the components of o, o₁ and o₂ for each axis, then the components of d, d₁ and d₂.
    #[inline(always)]
    pub fn by_axis(&self) -> [[[f64; 3]; 3]; 2] {
        [self.origin, self.direction]
            .map(|[start, a, b]| [[start.x, a.x, b.x], [start.y, a.y, b.y], [start.z, a.z, b.z]])
    }

    /// For each axis: returns the lower faces, the upper faces and the errors of coordinates.
    #[inline(always)]
    fn faces(&self, region: &Region) -> [[f64; 3]; 3] {
        [region.low(), region.high(), self.error].map(|ends| ends.to_array())
    }

    /// Shortens segments to the parts that may be in the region on any ray of their tile. An empty
    /// part has its ends in the wrong order.
    #[inline(always)]
    pub fn clip<S: Simd, T: Scalar>(
        &self,
        simd: S,
        rays: ScreenRays<'_, T>,
        region: &Region,
        ends: &mut Ends,
    ) {
        let rays = TileVectors::new(simd, rays);
        let ([origin, direction], [low, high, error]) = (self.by_axis(), self.faces(region));
        let [mut nears, mut fars] = [f64::wide(simd, &ends[0]), f64::wide(simd, &ends[1])];
        for (k, (near, far)) in nears.iter_mut().zip(&mut fars).enumerate() {
            for axis in 0..3 {
                let [o, d] = [rays.range(origin[axis], k), rays.range(direction[axis], k)];
                let (low, high) = (low[axis] - error[axis], high[axis] + error[axis]);
                // If all rays of a tile advance in the same direction, they enter after the
                // earliest possible entry, and leave before the latest possible exit.
                let (up, down) = (d[0].simd_gt(0.0), d[1].simd_lt(0.0));
                let enter = up.select(low - o[1], o[0] - high);
                let leave = up.select(high - o[0], o[1] - low);
                let (least, most) = (up.select(d[0], -d[1]), up.select(d[1], -d[0]));
                // The earliest entry divides a negative distance by the least speed, or a positive
                // distance by the greatest. The latest exit divides a negative distance by the
                // greatest speed, or a positive distance by the least.
                let first = enter / enter.simd_lt(0.0).select(least, most);
                let last = leave / leave.simd_lt(0.0).select(most, least);
                let one_way = up | down;
                // NaN bounds nothing.
                let first = near.max_precise(first - 1e-12 * first.abs());
                let last = far.min_precise(last + 1e-12 * last.abs());
                *near = one_way.select(first, *near);
                *far = one_way.select(last, *far);
            }
        }
        f64::narrow(nears, &mut ends[0]);
        f64::narrow(fars, &mut ends[1]);
    }

    /// Shortens segments of single rays as [`clip`](Self::clip) does. Returns, for each ray, the
    /// range of s in which it is proven to lie in the region's box and not behind the eye. The
    /// range is rounded inward. A clipping plane is ignored, as in
    /// [`between_faces`](crate::methods::local_ray::between_faces). All segments end within `size`
    /// of 0.
    #[inline(always)]
    pub fn clip_rays<S: Simd, T: Scalar>(
        &self,
        simd: S,
        screens: &[Lanes<f64>; 2],
        region: &Region,
        size: f64,
        ends: &mut Ends,
    ) -> [Lanes<T>; 2] {
        /// Minimum speed along an axis. A slower ray is not clipped, since its reciprocal speed may
        /// overflow. It is proven to be between the faces only if its speed is 0.
        const MIN_SPEED: f64 = 1e-200;
        /// Bound of the relative rounding error of the place at which a ray meets a face.
        const ROUNDING: f64 = 1e-12;
        let rays = TileVectors::new(simd, (screens, None));
        let ([origin, direction], [lows, highs, error]) = (self.by_axis(), self.faces(region));
        let zero = f64x8::splat(simd, 0.0);
        let [mut nears, mut fars] = [f64::wide(simd, &ends[0]), f64::wide(simd, &ends[1])];
        let (mut firsts, mut lasts) = ([zero - 4.0 * size; 2], [zero + 4.0 * size; 2]);
        for k in 0..2 {
            let (near, far) = (&mut nears[k], &mut fars[k]);
            let (first, last) = (&mut firsts[k], &mut lasts[k]);
            for axis in 0..3 {
                let (o, d) = (rays.middle(origin[axis], k), rays.middle(direction[axis], k));
                let (low, high, slack) = (lows[axis], highs[axis], error[axis]);
                let inverse = 1.0 / d;
                let (a, b) = ((low - o) * inverse, (high - o) * inverse);
                let (enter, leave) = (a.min(b), a.max(b));
                // Apart from rounding, the exact ray meets the face within `off` of the computed s.
                let off = slack * inverse.abs();
                let before = off + ROUNDING * (enter.abs() + off);
                let after = off + ROUNDING * (leave.abs() + off);
                let is_level = !d.abs().simd_gt(MIN_SPEED);
                let (low, high) = (low + slack, high - slack);
                let is_between = d.simd_eq(0.0) & o.simd_ge(low) & o.simd_le(high);
                *near = is_level.select(*near, near.max_precise(enter - before));
                *far = is_level.select(*far, far.min_precise(leave + after));
                *first = is_level.select(*first, first.max(enter + before));
                let level = is_between.select(*last, zero + f64::NEG_INFINITY);
                *last = is_level.select(level, last.min(leave - after));
            }
            *first += T::PATH_ERROR * (first.abs() + size);
            // Signs of the function behind the eye do not count.
            *first = first.max(T::above(-self.start).into());
            *last -= T::PATH_ERROR * (last.abs() + size);
        }
        f64::narrow(nears, &mut ends[0]);
        f64::narrow(fars, &mut ends[1]);
        let mut inside = [Lanes::splat(T::default()), Lanes::splat(T::default())];
        T::narrow(firsts, &mut inside[0]);
        T::narrow(lasts, &mut inside[1]);
        inside
    }

    /// Returns the lanes in which all rays of the tile are proven to be in the region, and not
    /// behind the eye, along the whole segment. The lanes are bits. A clipping plane is ignored.
    #[inline(always)]
    pub fn inside<S: Simd, T: Scalar>(
        &self,
        simd: S,
        rays: ScreenRays<'_, T>,
        region: &Region,
        [nears, fars]: [[f64x8<S>; 2]; 2],
    ) -> u16 {
        let mut all = u16::MAX;
        let rays = TileVectors::new(simd, rays);
        let ([origin, direction], [low, high, error]) = (self.by_axis(), self.faces(region));
        let zero = f64x8::splat(simd, 0.0);
        let mut corners = [[[zero; 2]; 2]; 3];
        for (k, (near, far)) in nears.into_iter().zip(fars).enumerate() {
            let behind = near.simd_lt(-self.start).to_bitmask() as u16;
            all &= !(behind << (HALF * k));
            for (axis, [leasts, mosts]) in corners.iter_mut().enumerate() {
                let [o, d] = [rays.range(origin[axis], k), rays.range(direction[axis], k)];
                let (a, b) = (near * d[0], near * d[1]);
                let (x, y) = (far * d[0], far * d[1]);
                let least = o[0] + a.min_precise(b).min_precise(x).min_precise(y);
                let most = o[1] + a.max_precise(b).max_precise(x).max_precise(y);
                let (low, high) = (low[axis] + error[axis], high[axis] - error[axis]);
                let within = least.simd_ge(low) & most.simd_le(high);
                all &= !(((!within).to_bitmask() as u16) << (HALF * k));
                (leasts[k], mosts[k]) = (least, most);
            }
        }
        if let Some(ball) = region.ball() {
            let mut ends = [[Lanes::splat(0.0); 2]; 3];
            for (wide, lanes) in corners.iter().flatten().zip(ends.as_flattened_mut()) {
                f64::narrow(*wide, lanes);
            }
            let [x, y, z] = &ends;
            let corner = |k: usize, lane: usize| DVec3::new(x[k][lane], y[k][lane], z[k][lane]);
            let holds = |lane: &usize| {
                ball.holds(corner(0, *lane) - self.error, corner(1, *lane) + self.error)
            };
            let held: u16 = (0..LANES).filter(holds).map(|lane| 1 << lane).sum();
            all &= held;
        }
        all
    }
}

/// Bounds the magnitude of parts₀ + a·parts₁ + b·parts₂ in each coordinate. The screen coordinates
/// a and b are within `reach`.
fn largest(parts: &[DVec3; 3], reach: [f64; 2]) -> DVec3 {
    parts[0].abs() + reach[0] * parts[1].abs() + reach[1] * parts[2].abs()
}

/// Centers and half extents of tiles in screen coordinates, as vectors of `f64`.
struct TileVectors<S: Simd> {
    centre: [[f64x8<S>; 2]; 2],
    half: [[f64x8<S>; 2]; 2],
}

impl<S: Simd> TileVectors<S> {
    #[inline(always)]
    fn new<T: Scalar>(simd: S, (centre, half): ScreenRays<'_, T>) -> Self {
        let zero = [f64x8::splat(simd, 0.0); 2];
        Self {
            centre: [T::wide(simd, &centre[0]), T::wide(simd, &centre[1])],
            half: match half {
                Some([wide, high]) => [T::wide(simd, wide), T::wide(simd, high)],
                None => [zero; 2],
            },
        }
    }

    /// Returns bounds of one coordinate of parts₀ + a·parts₁ + b·parts₂ on each tile, for the eight
    /// tiles of half `k`.
    #[inline(always)]
    fn range(&self, parts: [f64; 3], k: usize) -> [f64x8<S>; 2] {
        let (middle, [_, a, b]) = (self.middle(parts, k), parts);
        let reach = self.half[1][k].mul_add(b.abs(), self.half[0][k] * a.abs());
        [middle - reach, middle + reach]
    }

    /// Returns the coordinate that [`Self::range`] bounds, at the center of each tile.
    #[inline(always)]
    fn middle(&self, [start, a, b]: [f64; 3], k: usize) -> f64x8<S> {
        self.centre[1][k].mul_add(b, self.centre[0][k].mul_add(a, start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::local_ray;
    use zeroset_eval::dispatch;
    use zeroset_space::{Camera, Projection};
    use zeroset_testkit::simd::levels;

    #[test]
    fn sixteen_rays_meet_the_faces_where_each_does() {
        let region = Region::new(DVec3::new(-1.0, -0.5, -2.0), DVec3::new(1.5, 1.0, 2.0));
        let region = region.expect("valid");
        let perspective = Projection::Perspective { fov: 70.0 };
        let parallel = Projection::Orthographic { height: 6.0 };
        let (mut crossed, mut beside) = (0, 0);
        // The eye is outside the region, inside it, or outside on an axis. On the axis, rays are
        // parallel to four faces.
        for (eye, projection) in [
            (DVec3::new(3.0, -4.0, 2.0), perspective),
            (DVec3::new(0.1, 0.2, 0.3), perspective),
            (DVec3::new(0.0, -5.0, 0.0), parallel),
        ] {
            let rays = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("valid");
            let rays = RayGrid::new(&rays, 24, 24);
            let frame = RayFrame::new(&rays, &region);
            for (column, row) in (0..24).step_by(4).flat_map(|i| (0..24).map(move |j| (i, j))) {
                let [mut across, mut down] = [Lanes::splat(0.0); 2];
                for lane in 0..LANES {
                    let at = [2 * (column + lane % 4), 2 * row + lane / 4];
                    [across[lane], down[lane]] = rays.screen(at[0], at[1]);
                }
                let screens = [across, down];
                let wide = frame.span.map(Lanes::splat);
                for level in levels() {
                    let [near, far]: [Lanes<f64>; 2] = dispatch!(level, simd => {
                        let mut ends = wide;
                        let inside = frame.clip_rays(simd, &screens, &region, frame.size(), &mut ends);
                        let mut expected = wide;
                        frame.clip(simd, (&screens, None), &region, &mut expected);
                        let off = |end: usize, lane: usize| {
                            (ends[end][lane] - expected[end][lane]).abs()
                        };
                        assert!((0..LANES).all(|lane| off(0, lane) < 1e-10 && off(1, lane) < 1e-10));
                        inside
                    });
                    for lane in 0..LANES {
                        let [origin, direction] = frame.ray([screens[0][lane], screens[1][lane]]);
                        let [first, last] =
                            local_ray::between_faces([origin, direction, frame.error], &region);
                        let first = first.max(-frame.start);
                        let is_beside = first > last;
                        assert_eq!(near[lane] > far[lane], is_beside, "{first} {last}");
                        if is_beside {
                            beside += 1;
                            continue;
                        }
                        crossed += 1;
                        // The range must be rounded inward, but only by a small amount.
                        assert!(first <= near[lane] && near[lane] < first + 1e-10, "{first}");
                        assert!(far[lane] <= last && last - 1e-10 < far[lane], "{last}");
                    }
                }
            }
        }
        assert!(crossed > 1000 && beside > 1000, "{crossed} {beside}");
    }
}
