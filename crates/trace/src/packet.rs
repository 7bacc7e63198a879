//! A packet of rays that cross the region together, slab by slab along one axis.
//!
//! Along the axis K on which the rays advance fastest, the region's extent is divided into slabs. A place along a ray is
//! given by its share τ of that extent, from 0 where rays enter to 1 where they leave, so one τ is one plane for all
//! rays of the packet. Everything here is in the kernel's floats with explicit slack, and encloses the exact rays.

use crate::region::Region;
use crate::scalar::{Four, Scalar};
use glam::DVec3;
use zeroset_eval::BoxPacket;

/// A part of a line: the points `origin + t · direction` for t from 0 to `to`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    pub origin: DVec3,
    /// Any length but 0.
    pub direction: DVec3,
    /// May be infinite.
    pub to: f64,
}

/// Rays in groups of four lanes, and what they share.
#[derive(Clone, Debug)]
pub(crate) struct Packet<T: Scalar, const GROUPS: usize> {
    planes: Planes,
    /// Per axis, the region's bounds as (−lo, hi), rounded outward, in all lanes.
    bounds: [[T::Four; 2]; 3],
    pub groups: [Group<T>; GROUPS],
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

/// Four rays.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Group<T: Scalar> {
    /// By axis.
    sides: [Side<T::Four>; 3],
    /// The ray is within the region only between these τ.
    pub enter: T::Four,
    pub leave: T::Four,
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

impl<T: Scalar, const GROUPS: usize> Packet<T, GROUPS> {
    /// The packet of these rays, four to a group, advancing on the first one's fastest axis. `None` if the rays do not
    /// all advance together: they then need packets of their own.
    #[inline]
    pub fn new(segments: &[[Segment; 4]; GROUPS], region: &Region) -> Option<Self> {
        let first = segments[0][0].direction;
        let k = fastest_axis(first);
        let forward = first[k] > 0.0;
        for segment in segments.iter().flatten() {
            let d = segment.direction;
            // So put that a direction which is not a number is refused as well.
            let fast = d[k].abs() >= LEAST_SHARE * d.abs().max_element();
            if !fast || (d[k] > 0.0) != forward {
                return None;
            }
        }
        let (low, high) = (region.low()[k], region.high()[k]);
        let (start, end) = if forward { (low, high) } else { (high, low) };
        let planes = Planes { k, start, extent: end - start, inverse: 1.0 / (end - start) };
        let mut bounds = [[T::Four::default(); 2]; 3];
        for (axis, bounds) in bounds.iter_mut().enumerate() {
            bounds[0] = T::Four::splat(T::above(-region.low()[axis]));
            bounds[1] = T::Four::splat(T::above(region.high()[axis]));
        }
        let mut packet = Self { planes, bounds, groups: [Group::default(); GROUPS] };
        for (group, segments) in packet.groups.iter_mut().zip(segments) {
            group.follow(segments, &planes, &bounds, region);
        }
        Some(packet)
    }

    /// The distance from a ray's origin to the plane τ = `share`, or to where the ray enters the region if that is
    /// farther, in world units: in `f64` whatever the kernel's floats are.
    pub fn distance(&self, share: T, group: usize, lane: usize, segment: &Segment) -> f64 {
        let Planes { k, start, extent, .. } = self.planes;
        let share = share.into().max(self.groups[group].enter.to_array()[lane].into());
        let plane = start + share * extent;
        let steps = (plane - segment.origin[k]) / segment.direction[k];
        (steps * segment.direction.length()).max(0.0)
    }

    /// Whether none of the `alive` rays has a part of the region from τ = `from` on.
    pub fn all_left(&self, alive: &[u32; GROUPS], from: T) -> bool {
        let mut lanes = self.groups.iter().zip(alive);
        lanes.all(|(group, alive)| alive & group.meets(from, T::integer(2)) == 0)
    }

    /// Boxes around the rays between each two of three planes in order, clipped to the region.
    #[inline]
    pub fn boxes(&self, planes: [T; 3], out: &mut [[BoxPacket<T>; GROUPS]; 2]) {
        for (g, group) in self.groups.iter().enumerate() {
            for axis in 0..3 {
                let side = &group.sides[axis];
                let [neg_lo, hi] = self.bounds[axis];
                let at = planes.map(|plane| side.at(plane));
                for half in 0..2 {
                    let (a, b) = (at[half], at[half + 1]);
                    let out = &mut out[half][g];
                    out.neg_lo[axis] = (side.slack - a.min(b)).min(neg_lo).to_array();
                    out.hi[axis] = (side.slack + a.max(b)).min(hi).to_array();
                }
            }
        }
    }
}

impl<T: Scalar> Group<T> {
    #[inline]
    fn follow(
        &mut self,
        segments: &[Segment; 4],
        planes: &Planes,
        bounds: &[[T::Four; 2]; 3],
        region: &Region,
    ) {
        let Planes { k, start, extent, inverse } = *planes;
        // τ = (origin_k + t · d_k − start) / extent grows with t; t0 is where τ = 0, dt the way from there to τ = 1.
        let (mut from, mut to) = ([T::integer(0); 4], [T::integer(1); 4]);
        let (mut t0, mut dt) = ([0.0_f64; 4], [0.0_f64; 4]);
        for (lane, segment) in segments.iter().enumerate() {
            let (origin, direction) = (segment.origin[k], segment.direction[k]);
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
                let Segment { origin, direction, .. } = &segments[lane];
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
                let [neg_lo, hi] = bounds[axis];
                self.cut(start + (slack + neg_lo), extent);
                self.cut((slack + hi) - start, -extent);
            }
        }
        self.clip(segments, &t0, &dt, region);
    }

    /// Keeps only τ in the region's half-space.
    #[inline]
    fn clip(&mut self, segments: &[Segment; 4], t0: &[f64; 4], dt: &[f64; 4], region: &Region) {
        let Some(half) = region.clip() else { return };
        // offset − normal · p at τ = 0, and its change: kept where it is ≥ 0. Both are sums of terms that may cancel; each
        // takes at most eight operations of half a unit in the last place of `f64`.
        let scale = 1.0 / half.normal.abs().max_element();
        let size = half.normal.abs();
        let [mut room, mut change, mut terms] = [[T::integer(0); 4]; 3];
        for (lane, Segment { origin, direction, .. }) in segments.iter().enumerate() {
            let at = *origin + t0[lane] * *direction;
            room[lane] = T::nearest((half.offset - half.normal.dot(at)) * scale);
            change[lane] = T::nearest(-half.normal.dot(*direction) * dt[lane] * scale);
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
    pub fn meets(&self, from: T, to: T) -> u32 {
        let begun = self.enter.at_most(T::Four::splat(to));
        T::Four::bits(begun & T::Four::splat(from).at_most(self.leave))
    }

    /// The lanes that have no part inside the region, as bits.
    pub fn outside(&self) -> u32 {
        T::Four::bits(self.leave.less(self.enter))
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
