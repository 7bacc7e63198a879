//! A packet of rays that cross the region together, slab by slab along one axis.
//!
//! Along the axis K on which the rays advance fastest, the region's extent is divided into slabs. A place along a ray is
//! given by its share τ of that extent, from 0 where rays enter to 1 where they leave, so one τ is one plane for all
//! rays of the packet. Everything here is in the kernel's floats with explicit slack, and encloses the exact rays.

use crate::camera::Ray;
use crate::method::Segment;
use crate::region::Region;
use crate::scalar::{Four, Scalar};
use glam::DVec3;
use zeroset_eval::{Boxes, Segments};

/// Rays in a packet.
pub(crate) const RAYS: usize = 4;

/// Four rays, and what they share.
#[derive(Clone, Debug)]
pub(crate) struct Packet<T: Scalar> {
    planes: Planes,
    /// Per axis, the region's bounds as (−lo, hi), rounded outward, in all lanes.
    bounds: [[T::Four; 2]; 3],
    /// By axis.
    sides: [Side<T::Four>; 3],
    /// A ray is within the region only between these τ.
    enter: T::Four,
    leave: T::Four,
}

/// The planes τ = 0 and τ = 1.
#[derive(Clone, Copy, Debug)]
struct Planes {
    k: usize,
    start: f64,
    extent: f64,
    /// 1 / `extent`.
    inverse: f64,
}

/// One coordinate of four rays: within `slack` of `start + τ · extent`.
#[derive(Clone, Copy, Debug, Default)]
struct Side<F> {
    start: F,
    extent: F,
    slack: F,
}

/// Relative error of what is computed in `f64` from coordinates of a ray's origin, which may be far away: eight
/// operations of half a unit in the last place each.
const DOUBLE_ERROR: f64 = 4.0 * f64::EPSILON;
/// A ray belongs into a packet if K is no slower on it than this part of its fastest axis.
const LEAST_SHARE: f64 = 0.25;

/// The axis on which a direction is fastest.
fn fastest_axis(direction: DVec3) -> usize {
    let size = direction.abs();
    if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    }
}

impl<T: Scalar> Packet<T> {
    /// A packet through `region`, without rays.
    pub fn new(region: &Region) -> Self {
        let zero = T::Four::default();
        let bound = |end: f64| T::Four::splat(T::above(end));
        Self {
            planes: Planes { k: 0, start: 0.0, extent: 0.0, inverse: 0.0 },
            bounds: [0, 1, 2].map(|k| [bound(-region.low()[k]), bound(region.high()[k])]),
            sides: [Side { start: zero, extent: zero, slack: zero }; 3],
            enter: zero,
            leave: zero,
        }
    }

    /// Takes these rays, advancing on the first one's fastest axis. Returns whether they all advance together: otherwise
    /// they need packets of their own.
    #[inline]
    pub fn take(&mut self, segments: &[&Segment; RAYS], region: &Region) -> bool {
        let first = segments[0].ray.direction;
        let k = fastest_axis(first);
        let forward = first[k] > 0.0;
        for segment in segments {
            let d = segment.ray.direction;
            // Written so that NaN directions are rejected too.
            let fast = d[k].abs() >= LEAST_SHARE * d.abs().max_element();
            if !fast || (d[k] > 0.0) != forward {
                return false;
            }
        }
        let (low, high) = (region.low()[k], region.high()[k]);
        let (start, end) = if forward { (low, high) } else { (high, low) };
        self.planes = Planes { k, start, extent: end - start, inverse: 1.0 / (end - start) };
        self.place(segments, region);
        true
    }

    /// The distance from a ray's origin to the plane τ = `share`, or to where the ray enters the region if that is
    /// farther; as a value of t.
    pub fn distance(&self, share: T, lane: usize, segment: &Segment) -> f64 {
        let Planes { k, start, extent, .. } = self.planes;
        let share = share.into().max(self.enter.to_array()[lane].into());
        let plane = start + share * extent;
        ((plane - segment.ray.origin[k]) / segment.ray.direction[k]).max(0.0)
    }

    /// Boxes around the rays between each two of some planes in order, clipped to the region: those of the first two planes
    /// in the first lanes, and so on.
    #[inline]
    pub fn boxes<const PLANES: usize>(&self, planes: [T; PLANES], out: &mut Boxes<T>) {
        out.count = (RAYS * (PLANES - 1)) as u32;
        for axis in 0..3 {
            let side = &self.sides[axis];
            let [neg_lo, hi] = self.bounds[axis];
            let mut a = side.at(planes[0]);
            for (slab, &plane) in planes[1..].iter().enumerate() {
                let b = side.at(plane);
                let lower = (side.slack - a.min(b)).min(neg_lo).to_array();
                let upper = (side.slack + a.max(b)).min(hi).to_array();
                let lanes = RAYS * slab..RAYS * (slab + 1);
                out.neg_lo[axis][lanes.clone()].copy_from_slice(&lower);
                out.hi[axis][lanes].copy_from_slice(&upper);
                a = b;
            }
        }
    }

    /// The rays between each two of some planes in order, as segments in which t is τ: in lanes as [`Packet::boxes`].
    #[inline]
    pub fn segments<const PLANES: usize>(&self, planes: [T; PLANES], out: &mut Segments<T>) {
        let used = RAYS * (PLANES - 1);
        out.count = used as u32;
        for lane in 0..used {
            (out.near[lane], out.far[lane]) = (planes[lane / RAYS], planes[lane / RAYS + 1]);
        }
        // The slack is for τ within [0, 1], all of a packet's; what kernels round is added to it, generously.
        let rounding = T::Four::splat(T::nearest(2.0 * T::PATH_ERROR));
        let least = T::LEAST_NORMAL + T::LEAST_NORMAL;
        let least = T::Four::splat(least + least);
        for (axis, Side { start, extent, slack }) in self.sides.iter().enumerate() {
            let error = *slack + rounding * (start.abs() + extent.abs()) + least;
            let [origin, direction, error] = [*start, *extent, error].map(Four::to_array);
            for first in (0..used).step_by(RAYS) {
                let lanes = first..first + RAYS;
                out.origin[axis][lanes.clone()].copy_from_slice(&origin);
                out.direction[axis][lanes.clone()].copy_from_slice(&direction);
                out.error[axis][lanes].copy_from_slice(&error);
            }
        }
    }

    /// Finds where the rays are.
    #[inline]
    fn place(&mut self, segments: &[&Segment; RAYS], region: &Region) {
        let Planes { k, start, extent, inverse } = self.planes;
        // τ = (origin_k + t · d_k − start) / extent grows with t; t0 is where τ = 0, dt the way from there to τ = 1.
        let (mut from, mut to) = ([T::integer(0); 4], [T::integer(1); 4]);
        let (mut t0, mut dt) = ([0.0_f64; 4], [0.0_f64; 4]);
        for (lane, segment) in segments.iter().enumerate() {
            let (origin, direction) = (segment.ray.origin[k], segment.ray.direction[k]);
            let first = start - origin;
            let per_k = 1.0 / direction;
            (t0[lane], dt[lane]) = (first * per_k, extent * per_k);
            let error = T::SHARE_ERROR.into() + DOUBLE_ERROR * (origin * inverse).abs();
            from[lane] = T::nearest(-first * inverse - error);
            if segment.to.is_finite() {
                let advance = segment.to * direction;
                let error = error + DOUBLE_ERROR * (advance * inverse).abs();
                to[lane] = T::nearest((advance - first) * inverse + error);
            }
        }
        self.enter = T::Four::from_array(from).max(T::Four::splat(-T::SHARE_ERROR));
        self.leave = T::Four::from_array(to).min(T::Four::splat(T::integer(1) + T::SHARE_ERROR));
        for axis in 0..3 {
            let [mut starts, mut extents, mut reach] = [[T::integer(0); 4]; 3];
            for lane in 0..4 {
                let Ray { origin, direction } = segments[lane].ray;
                let step = t0[lane] * direction[axis];
                starts[lane] = T::nearest(origin[axis] + step);
                extents[lane] = T::nearest(dt[lane] * direction[axis]);
                reach[lane] = T::nearest(2.0 * DOUBLE_ERROR * (origin[axis].abs() + step.abs()));
            }
            let (start, extent) = (T::Four::from_array(starts), T::Four::from_array(extents));
            let size = T::Four::splat(T::COORDINATE_ERROR) * (start.abs() + extent.abs());
            let slack = size + (T::Four::from_array(reach) + T::Four::splat(T::LEAST_NORMAL));
            self.sides[axis] = Side { start, extent, slack };
            if axis != k {
                let [neg_lo, hi] = self.bounds[axis];
                self.cut(start + (slack + neg_lo), extent);
                self.cut((slack + hi) - start, -extent);
            }
        }
        self.clip(segments, &t0, &dt, region);
        self.round(segments, region);
    }

    /// Keeps only τ in the region's ball.
    fn round(&mut self, segments: &[&Segment; RAYS], region: &Region) {
        if region.ball().is_none() {
            return;
        }
        let Planes { k, start, inverse, .. } = self.planes;
        let (mut from, mut to) = ([T::integer(1); 4], [-T::integer(1); 4]);
        for (lane, segment) in segments.iter().enumerate() {
            // What the box keeps of the ray is cut by the ball alone: no end moves that the ball does not move.
            let Some((near, far)) = region.span(&segment.ray) else { continue };
            let (origin, direction) = (segment.ray.origin[k], segment.ray.direction[k]);
            let share = |t: f64, outward: f64| {
                let advance = t * direction;
                let sizes = (origin * inverse).abs() + (advance * inverse).abs();
                let error = T::SHARE_ERROR.into() + DOUBLE_ERROR * sizes;
                T::nearest((advance - (start - origin)) * inverse + outward * error)
            };
            (from[lane], to[lane]) = (share(near, -1.0), share(far, 1.0));
        }
        // In this order, what is not a number gives way.
        self.enter = T::Four::from_array(from).max(self.enter);
        self.leave = T::Four::from_array(to).min(self.leave);
    }

    /// Keeps only τ in the region's half-space.
    #[inline]
    fn clip(&mut self, segments: &[&Segment; RAYS], t0: &[f64; 4], dt: &[f64; 4], region: &Region) {
        let Some(half) = region.clip() else { return };
        // offset − normal · p at τ = 0, and its change: kept where it is ≥ 0. Both are sums of terms that may cancel; each
        // takes at most eight operations of half a unit in the last place of `f64`.
        let scale = 1.0 / half.normal.abs().max_element();
        let size = half.normal.abs();
        let [mut room, mut change, mut terms] = [[T::integer(0); 4]; 3];
        for (lane, segment) in segments.iter().enumerate() {
            let Ray { origin, direction } = segment.ray;
            let at = origin + t0[lane] * direction;
            room[lane] = T::nearest((half.offset - half.normal.dot(at)) * scale);
            change[lane] = T::nearest(-half.normal.dot(direction) * dt[lane] * scale);
            let moved = size.dot(direction.abs()) * dt[lane].abs();
            terms[lane] = T::nearest((size.dot(at.abs()) + half.offset.abs() + moved) * scale);
        }
        let (room, change) = (T::Four::from_array(room), T::Four::from_array(change));
        let terms = room.abs() + change.abs() + T::Four::from_array(terms);
        let slack = T::Four::splat(T::COORDINATE_ERROR) * terms;
        let sides = self.sides[0].slack + self.sides[1].slack + self.sides[2].slack;
        self.cut(room + (slack + sides), change);
    }

    /// Keeps only τ with `room + τ · change ≥ 0`.
    #[inline]
    fn cut(&mut self, room: T::Four, change: T::Four) {
        let zero = T::Four::default();
        let crossing = -room / change;
        let slack = T::Four::splat(T::SHARE_ERROR);
        // NaN only for 0/0: such a ray stays. Comparisons with NaN are false.
        let rising = zero.less(change);
        let falling = change.less(zero);
        let never = change.equal(zero) & room.less(zero);
        let enter = T::Four::select(rising, crossing - slack, self.enter);
        let leave = T::Four::select(falling, crossing + slack, self.leave);
        // What is not a number comes first, so that it gives way: of an overflow nothing is concluded.
        self.enter = enter.max(self.enter);
        let nowhere = T::Four::splat(-T::integer(1));
        self.leave = T::Four::select(never, nowhere, leave.min(self.leave));
    }

    /// The lanes whose part inside the region meets the planes from `from` to `to`, as bits.
    #[inline]
    pub fn meets(&self, from: T, to: T) -> u8 {
        let begun = self.enter.at_most(T::Four::splat(to));
        T::Four::bits(begun & T::Four::splat(from).at_most(self.leave)) as u8
    }

    /// The lanes that have no part inside the region, as bits.
    pub fn outside(&self) -> u8 {
        T::Four::bits(self.leave.less(self.enter)) as u8
    }
}

impl<F: Four> Side<F> {
    #[inline]
    fn at(&self, share: F::Lane) -> F {
        self.start + F::splat(share) * self.extent
    }
}

#[cfg(test)]
mod tests;
