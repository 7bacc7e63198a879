//! Packets: rays that cross the region together, slab by slab along one axis.
//!
//! K is the axis on which the rays advance fastest. The region's extent along K is divided into
//! slabs. τ is a ray's position along K as a share of that extent: 0 at the face where rays enter,
//! 1 at the face where they leave. So a value of τ is the same plane for all rays of the packet.
//! All numbers are floats of the kernel's type. With explicit slack, they enclose the exact rays.

use crate::method::Segment;
use crate::scalar::Scalar;
use crate::simd_chunks::{Chunk, parts};
use fearless_simd::prelude::*;
use glam::DVec3;
use zeroset_eval::{Boxes, LANES, Lanes, Segments};
use zeroset_space::Region;

/// Maximum number of rays in a packet.
pub(crate) const PACKET_RAYS: usize = LANES;

/// Up to sixteen rays, and the slabs that they cross together. Unused lanes repeat the last ray.
#[derive(Clone, Debug)]
pub(crate) struct Packet<T: Scalar> {
    planes: SlabAxis,
    /// Number of rays.
    count: usize,
    /// The region's bounds on each axis as (−lo, hi), rounded outward.
    bounds: [[T; 2]; 3],
    /// The rays' coordinates on each axis.
    coordinates: [Coordinate<T>; 3],
    /// Per ray, the smallest and the largest τ at which it may be in the region.
    enter: Lanes<T>,
    leave: Lanes<T>,
}

/// Origins and directions of up to [`PACKET_RAYS`] rays. Unused lanes repeat the last ray.
pub(crate) struct RayLanes {
    pub origin: [Lanes<f64>; 3],
    pub direction: [Lanes<f64>; 3],
    /// Per ray, the largest t to examine.
    to: Lanes<f64>,
    /// Per ray, the width of a pixel and its growth with t: [`Segment::pixel`].
    pub pixel: [Lanes<f64>; 2],
}

impl RayLanes {
    /// Copies the segments' rays to lanes. There must be at least one segment.
    #[inline]
    pub fn new(segments: &[Segment]) -> Self {
        let zero = Lanes::splat(0.0);
        let mut lines =
            Self { origin: [zero; 3], direction: [zero; 3], to: zero, pixel: [zero; 2] };
        for lane in 0..PACKET_RAYS {
            let Segment { ray, to, pixel } = &segments[lane.min(segments.len() - 1)];
            for axis in 0..3 {
                lines.origin[axis][lane] = ray.origin[axis];
                lines.direction[axis][lane] = ray.direction[axis];
            }
            lines.to[lane] = *to;
            (lines.pixel[0][lane], lines.pixel[1][lane]) = (pixel[0], pixel[1]);
        }
        lines
    }
}

/// The axis K, and the region's extent along it. The extent's first end is at τ = 0.
#[derive(Clone, Copy, Debug)]
struct SlabAxis {
    k: usize,
    start: f64,
    extent: f64,
    /// 1 / `extent`.
    inverse: f64,
}

impl SlabAxis {
    /// Returns the τ at `t` of a ray with this origin and direction along K. The result is moved by
    /// more than its error: up if `outward` is 1, down if `outward` is −1.
    #[inline]
    fn share<T: Scalar>(&self, [origin, direction]: [f64; 2], t: f64, outward: f64) -> T {
        let Self { start, inverse, .. } = *self;
        let advance = t * direction;
        let sizes = (origin * inverse).abs() + (advance * inverse).abs();
        let error = T::SHARE_ERROR.into() + DOUBLE_ERROR * sizes;
        T::nearest((advance - (start - origin)) * inverse + outward * error)
    }
}

/// One coordinate of each ray. At τ, it is within `slack` of `start + τ · extent`.
#[derive(Clone, Copy, Debug, Default)]
struct Coordinate<T> {
    start: Lanes<T>,
    extent: Lanes<T>,
    slack: Lanes<T>,
}

/// Relative error of eight operations in `f64`, which round by half a unit in the last place each.
/// It is relative to the origin of a ray, which may be far away.
const DOUBLE_ERROR: f64 = 4.0 * f64::EPSILON;
/// Minimum speed of a packet's rays along K, as a share of their speed along their fastest axis.
const MIN_ADVANCE: f64 = 0.25;

impl<T: Scalar> Packet<T> {
    /// Creates a packet through `region`, without rays.
    pub fn new(region: &Region) -> Self {
        Self {
            planes: SlabAxis { k: 0, start: 0.0, extent: 0.0, inverse: 0.0 },
            count: 0,
            bounds: [0, 1, 2].map(|k| [T::above(-region.low()[k]), T::above(region.high()[k])]),
            coordinates: [Coordinate::default(); 3],
            enter: Lanes::default(),
            leave: Lanes::default(),
        }
    }

    /// Takes the rays of `segments`, at most [`PACKET_RAYS`]. `lines` holds the same rays. K
    /// becomes the fastest axis of the first ray. Returns whether all rays advance along K in the
    /// same direction, and fast enough. Otherwise they need separate packets.
    #[inline(always)]
    #[allow(clippy::needless_bitwise_bool, reason = "all lanes at once")]
    pub fn take<S: Simd>(
        &mut self,
        simd: S,
        segments: &[Segment],
        lines: &RayLanes,
        region: &Region,
    ) -> bool {
        let k = segments[0].ray.direction.abs().max_position();
        let forward = lines.direction[k][0] > 0.0;
        let mut together = true;
        for lane in 0..PACKET_RAYS {
            let [x, y, z] = [0, 1, 2].map(|axis| lines.direction[axis][lane].abs());
            let along = lines.direction[k][lane];
            // The comparison is false for NaN, so NaN directions are rejected.
            let fast = |other: f64| along.abs() >= MIN_ADVANCE * other;
            together &= fast(x) & fast(y) & fast(z) & ((along > 0.0) == forward);
        }
        if !together {
            return false;
        }
        let (low, high) = (region.low()[k], region.high()[k]);
        let (start, end) = if forward { (low, high) } else { (high, low) };
        self.planes = SlabAxis { k, start, extent: end - start, inverse: 1.0 / (end - start) };
        self.count = segments.len();
        self.place(simd, lines, region);
        self.restrict_to_ball(simd, segments, region);
        true
    }

    /// Returns the t of a ray at τ = `share`, or at its entry into the region if that is larger.
    pub fn distance(&self, share: T, lane: usize, segment: &Segment) -> f64 {
        let SlabAxis { k, start, extent, .. } = self.planes;
        let share = share.into().max(self.enter[lane].into());
        let plane = start + share * extent;
        ((plane - segment.ray.origin[k]) / segment.ray.direction[k]).max(0.0)
    }

    /// Writes boxes around the rays' parts between the planes `from` ≤ `to`, clipped to the region.
    /// `rays` has a bit for each wanted ray. Lanes after the last wanted ray are not written.
    #[inline(always)]
    pub fn boxes<S: Simd>(&self, simd: S, [from, to]: [T; 2], rays: u16, out: &mut Boxes<T>) {
        out.count = LANES as u32 - rays.leading_zeros();
        for (axis, Coordinate { start, extent, slack }) in self.coordinates.iter().enumerate() {
            let [neg_lo, hi] = self.bounds[axis];
            for part in parts::<S, T::Vector<S>>(simd, out.count as usize) {
                let start = part.load(start);
                let extent = part.load(extent);
                let slack = part.load(slack);
                let (a, b) = (start + extent * from, start + extent * to);
                // If anything overflows, the slack does too, and the box gets the region's bounds.
                let lower = (slack - a.min(b)).min_precise(part.splat(neg_lo));
                let upper = (slack + a.max(b)).min_precise(part.splat(hi));
                part.store(lower, &mut out.neg_lo[axis]);
                part.store(upper, &mut out.hi[axis]);
            }
        }
    }

    /// Writes the rays as segments, whose t is τ. `near` and `far` are not written.
    #[inline(always)]
    pub fn lines<S: Simd>(&self, simd: S, out: &mut Segments<T>) {
        // The slack holds for τ within [0, 1]. A generous bound of rounding in kernels is added.
        let rounding = T::nearest(2.0 * T::PATH_ERROR);
        let least = T::LEAST_NORMAL + T::LEAST_NORMAL;
        for (axis, Coordinate { start, extent, slack }) in self.coordinates.iter().enumerate() {
            (out.origin[axis], out.direction[axis]) = (*start, *extent);
            for part in parts::<S, T::Vector<S>>(simd, LANES) {
                let size = part.load(start).abs() + part.load(extent).abs();
                let error = part.load(slack) + size * rounding + (least + least);
                part.store(error, &mut out.error[axis]);
            }
        }
    }

    /// Computes the rays' coordinates, and the range of τ in which each ray may be in the region.
    #[inline(always)]
    fn place<S: Simd>(&mut self, simd: S, lines: &RayLanes, region: &Region) {
        let SlabAxis { k, start, extent, inverse } = self.planes;
        // τ = (origin_k + t · d_k − start) / extent grows with t. `t0` is the t at τ = 0. `dt` is
        // the t at τ = 1 minus `t0`.
        let most = T::integer(1) + T::SHARE_ERROR;
        let (mut from, mut to) = (Lanes::splat(T::integer(0)), Lanes::splat(most));
        let (mut t0, mut dt) = ([0.0_f64; PACKET_RAYS], [0.0_f64; PACKET_RAYS]);
        for lane in 0..PACKET_RAYS {
            let (origin, direction) = (lines.origin[k][lane], lines.direction[k][lane]);
            let first = start - origin;
            let per_k = 1.0 / direction;
            (t0[lane], dt[lane]) = (first * per_k, extent * per_k);
            let error = T::SHARE_ERROR.into() + DOUBLE_ERROR * (origin * inverse).abs();
            from[lane] = T::nearest(-first * inverse - error);
        }
        for lane in (0..PACKET_RAYS).filter(|&lane| lines.to[lane].is_finite()) {
            let ray = [lines.origin[k][lane], lines.direction[k][lane]];
            to[lane] = self.planes.share(ray, lines.to[lane], 1.0);
        }
        (self.enter, self.leave) = (Lanes::splat(-T::SHARE_ERROR), Lanes::splat(most));
        self.restrict_to(simd, &from, &to);
        for axis in 0..3 {
            let mut side = Coordinate::default();
            for lane in 0..PACKET_RAYS {
                let (origin, direction) = (lines.origin[axis][lane], lines.direction[axis][lane]);
                let step = t0[lane] * direction;
                side.start[lane] = T::nearest(origin + step);
                side.extent[lane] = T::nearest(dt[lane] * direction);
                side.slack[lane] = T::nearest(2.0 * DOUBLE_ERROR * (origin.abs() + step.abs()));
            }
            let [neg_lo, hi] = self.bounds[axis];
            for part in parts::<S, T::Vector<S>>(simd, LANES) {
                let start = part.load(&side.start);
                let extent = part.load(&side.extent);
                let reach = part.load(&side.slack);
                let size = (start.abs() + extent.abs()) * T::COORDINATE_ERROR;
                let slack = size + (reach + T::LEAST_NORMAL);
                part.store(slack, &mut side.slack);
                if axis != k {
                    self.cut(part, start + (slack + neg_lo), extent);
                    self.cut(part, (slack + hi) - start, -extent);
                }
            }
            self.coordinates[axis] = side;
        }
        self.restrict_to_half_space(simd, lines, &t0, &dt, region);
    }

    /// Restricts each ray to the τ between its lanes of `from` and `to`. NaN restricts nothing.
    #[inline(always)]
    fn restrict_to<S: Simd>(&mut self, simd: S, from: &Lanes<T>, to: &Lanes<T>) {
        for part in parts::<S, T::Vector<S>>(simd, LANES) {
            let enter = part.load(&self.enter);
            let leave = part.load(&self.leave);
            let enter = enter.max_precise(part.load(from));
            let leave = leave.min_precise(part.load(to));
            part.store(enter, &mut self.enter);
            part.store(leave, &mut self.leave);
        }
    }

    /// Restricts the rays to the region's ball.
    #[inline(always)]
    fn restrict_to_ball<S: Simd>(&mut self, simd: S, segments: &[Segment], region: &Region) {
        if region.ball().is_none() {
            return;
        }
        let k = self.planes.k;
        let (mut from, mut to) = (Lanes::splat(T::integer(1)), Lanes::splat(-T::integer(1)));
        for (lane, segment) in segments.iter().enumerate() {
            // The rays are already restricted to the box. `share` moves the ends of the span
            // outward, so only the ball restricts the rays further.
            let Some((near, far)) = region.span(&segment.ray) else { continue };
            let ray = [segment.ray.origin, segment.ray.direction].map(|vector| vector[k]);
            let share = |t: f64, outward: f64| self.planes.share(ray, t, outward);
            (from[lane], to[lane]) = (share(near, -1.0), share(far, 1.0));
        }
        self.restrict_to(simd, &from, &to);
    }

    /// Restricts the rays to the region's half-space.
    #[inline(always)]
    fn restrict_to_half_space<S: Simd>(
        &mut self,
        simd: S,
        lines: &RayLanes,
        t0: &[f64; PACKET_RAYS],
        dt: &[f64; PACKET_RAYS],
        region: &Region,
    ) {
        let Some(half) = region.clip() else { return };
        // A ray is in the half-space if `room` + τ · `change` ≥ 0. `room` is offset − normal · p,
        // and p is the ray's point at τ = 0. Both numbers are sums whose terms may cancel. Each
        // takes at most eight operations in `f64`, with an error of half a unit in the last place.
        let scale = 1.0 / half.normal.abs().max_element();
        let size = half.normal.abs();
        let [mut room, mut change, mut terms] = [Lanes::splat(T::integer(0)); 3];
        for lane in 0..PACKET_RAYS {
            let [x, y, z] = &lines.origin;
            let origin = DVec3::new(x[lane], y[lane], z[lane]);
            let [x, y, z] = &lines.direction;
            let direction = DVec3::new(x[lane], y[lane], z[lane]);
            let at = origin + t0[lane] * direction;
            room[lane] = T::nearest((half.offset - half.normal.dot(at)) * scale);
            change[lane] = T::nearest(-half.normal.dot(direction) * dt[lane] * scale);
            let moved = size.dot(direction.abs()) * dt[lane].abs();
            terms[lane] = T::nearest((size.dot(at.abs()) + half.offset.abs() + moved) * scale);
        }
        for part in parts::<S, T::Vector<S>>(simd, LANES) {
            let room = part.load(&room);
            let change = part.load(&change);
            let terms = part.load(&terms);
            let mut slack = (room.abs() + change.abs() + terms) * T::COORDINATE_ERROR;
            for side in &self.coordinates {
                slack += part.load(&side.slack);
            }
            self.cut(part, room + slack, change);
        }
    }

    /// Restricts the rays of one vector to the τ with `room + τ · change ≥ 0`.
    #[inline(always)]
    fn cut<S: Simd>(
        &mut self,
        part: Chunk<S, T::Vector<S>>,
        room: T::Vector<S>,
        change: T::Vector<S>,
    ) {
        let enter = part.load(&self.enter);
        let leave = part.load(&self.leave);
        let zero = part.splat(T::integer(0));
        let crossing = -room / change;
        // For 0/0, `crossing` is NaN. Then `change` is 0, and neither bound below uses it.
        let (rising, falling) = (change.simd_gt(zero), change.simd_lt(zero));
        let never = change.simd_eq(zero) & room.simd_lt(zero);
        let first = rising.select(crossing - T::SHARE_ERROR, enter);
        let last = falling.select(crossing + T::SHARE_ERROR, leave);
        // A ray that leaves at −1 has left before the first plane.
        let nowhere = part.splat(-T::integer(1));
        // Any other NaN comes from an overflow, and is ignored here.
        let leave = never.select(nowhere, leave.min_precise(last));
        part.store(enter.max_precise(first), &mut self.enter);
        part.store(leave, &mut self.leave);
    }

    /// Returns the rays that may be in the region between the planes `from` and `to`, as bits.
    #[inline(always)]
    pub fn meets<S: Simd>(&self, simd: S, from: T, to: T) -> u16 {
        let mut meets = 0;
        for part in parts::<S, T::Vector<S>>(simd, LANES) {
            let enter = part.load(&self.enter);
            let leave = part.load(&self.leave);
            let inside = enter.simd_le(to) & leave.simd_ge(from);
            meets |= part.bits(inside);
        }
        meets & self.rays()
    }

    /// Returns the rays that may meet the region, as bits.
    #[inline(always)]
    pub fn inside<S: Simd>(&self, simd: S) -> u16 {
        let mut outside = 0;
        for part in parts::<S, T::Vector<S>>(simd, LANES) {
            let enter = part.load(&self.enter);
            let leave = part.load(&self.leave);
            outside |= part.bits(leave.simd_lt(enter));
        }
        self.rays() & !outside
    }

    /// Returns a bit for each ray of the packet.
    #[inline]
    pub fn rays(&self) -> u16 {
        u16::MAX >> (PACKET_RAYS - self.count)
    }
}

#[cfg(test)]
pub(crate) mod tests;
