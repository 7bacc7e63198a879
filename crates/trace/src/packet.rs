//! A packet of rays that cross the region together, slab by slab along one axis.
//!
//! Along the axis K on which the rays advance fastest, the region's extent is divided into slabs. A place along a ray is
//! given by its share τ of that extent, from 0 where rays enter to 1 where they leave, so one τ is one plane for all
//! rays of the packet. Everything here is `f32` with explicit slack; all of it encloses the exact rays.

use crate::region::Region;
use glam::{BVec4A, DVec3, Vec4};
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
pub(crate) struct Packet<const GROUPS: usize> {
    planes: Planes,
    /// Per axis, the region's bounds as (−lo, hi), rounded outward, in all lanes.
    bounds: [[Vec4; 2]; 3],
    pub groups: [Group; GROUPS],
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
pub(crate) struct Group {
    /// By axis.
    sides: [Side; 3],
    /// The ray is within the region only between these τ.
    pub enter: Vec4,
    pub leave: Vec4,
}

/// One coordinate of four rays: within `slack` of `start + τ · extent`.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    start: Vec4,
    extent: Vec4,
    slack: Vec4,
}

/// Relative error of a coordinate at any τ: `start` and `extent` are rounded from `f64` (2⁻²⁴ each), as are their
/// product with τ and the sum; 2⁻²¹ of |start| + |extent| is twice what these add up to.
const COORDINATE_ERROR: f32 = 1.0 / 2_097_152.0;
/// What the ends of the range of τ are moved out by: above the error of a quotient that lies within [−1, 2].
const SHARE_ERROR: f64 = 1.0 / 1_048_576.0;
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

impl<const GROUPS: usize> Packet<GROUPS> {
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
        let mut bounds = [[Vec4::ZERO; 2]; 3];
        for (axis, bounds) in bounds.iter_mut().enumerate() {
            bounds[0] = Vec4::splat(above(-region.low()[axis]));
            bounds[1] = Vec4::splat(above(region.high()[axis]));
        }
        let mut packet = Self { planes, bounds, groups: [Group::default(); GROUPS] };
        for (group, segments) in packet.groups.iter_mut().zip(segments) {
            group.follow(segments, &planes, &bounds, region);
        }
        Some(packet)
    }

    /// The distance from a ray's origin to the plane τ = `share`, or to where the ray enters the region if that is
    /// farther; rounded to nearest.
    pub fn distance(&self, share: f32, group: usize, lane: usize, segment: &Segment) -> f32 {
        let Planes { k, start, extent, .. } = self.planes;
        let share = share.max(self.groups[group].enter[lane]);
        let plane = start + f64::from(share) * extent;
        let steps = (plane - segment.origin[k]) / segment.direction[k];
        (steps * segment.direction.length()).max(0.0) as f32
    }

    /// Whether none of the `alive` rays has a part of the region from τ = `from` on.
    pub fn all_left(&self, alive: &[u32; GROUPS], from: f32) -> bool {
        let mut lanes = self.groups.iter().zip(alive);
        lanes.all(|(group, alive)| alive & group.meets(from, 2.0).bitmask() == 0)
    }

    /// Boxes around the rays between each two of three planes in order, clipped to the region.
    #[inline]
    pub fn boxes(&self, planes: [f32; 3], out: &mut [[BoxPacket; GROUPS]; 2]) {
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

impl Group {
    #[inline]
    fn follow(
        &mut self,
        segments: &[Segment; 4],
        planes: &Planes,
        bounds: &[[Vec4; 2]; 3],
        region: &Region,
    ) {
        let Planes { k, start, extent, inverse } = *planes;
        // τ = (origin_k + t · d_k − start) / extent grows with t; t0 is where τ = 0, dt the way from there to τ = 1.
        let (mut from, mut to) = ([0.0_f32; 4], [1.0_f32; 4]);
        let (mut t0, mut dt) = ([0.0_f64; 4], [0.0_f64; 4]);
        for (lane, segment) in segments.iter().enumerate() {
            let (origin, direction) = (segment.origin[k], segment.direction[k]);
            let first = start - origin;
            let per_k = 1.0 / direction;
            (t0[lane], dt[lane]) = (first * per_k, extent * per_k);
            let error = SHARE_ERROR + DOUBLE_ERROR * (origin * inverse).abs();
            from[lane] = (-first * inverse - error) as f32;
            if segment.to.is_finite() {
                to[lane] = ((segment.to * direction - first) * inverse + error) as f32;
            }
        }
        self.enter = Vec4::from_array(from).max(Vec4::splat(-SHARE_ERROR as f32));
        self.leave = Vec4::from_array(to).min(Vec4::splat(1.0 + SHARE_ERROR as f32));
        for axis in 0..3 {
            let (mut starts, mut extents, mut reach) = ([0.0_f32; 4], [0.0_f32; 4], [0.0_f32; 4]);
            for lane in 0..4 {
                let Segment { origin, direction, .. } = &segments[lane];
                let step = t0[lane] * direction[axis];
                starts[lane] = (origin[axis] + step) as f32;
                extents[lane] = (dt[lane] * direction[axis]) as f32;
                reach[lane] = (DOUBLE_ERROR * (origin[axis].abs() + step.abs())) as f32;
            }
            let (start, extent) = (Vec4::from_array(starts), Vec4::from_array(extents));
            let size = COORDINATE_ERROR * (start.abs() + extent.abs());
            let slack = size + (2.0 * Vec4::from_array(reach) + Vec4::splat(f32::MIN_POSITIVE));
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
        // offset − normal · p at τ = 0, and its change: kept where it is ≥ 0.
        let scale = 1.0 / half.normal.abs().max_element();
        let (mut room, mut change) = ([0.0_f32; 4], [0.0_f32; 4]);
        for (lane, Segment { origin, direction, .. }) in segments.iter().enumerate() {
            let at = *origin + t0[lane] * *direction;
            room[lane] = ((half.offset - half.normal.dot(at)) * scale) as f32;
            change[lane] = (-half.normal.dot(*direction) * dt[lane] * scale) as f32;
        }
        let (room, change) = (Vec4::from_array(room), Vec4::from_array(change));
        // Room is a difference of terms as large as the coordinates.
        let reach = region.low().abs().max(region.high().abs()).max_element();
        let terms = (3.0 * reach + half.offset.abs() * scale) as f32;
        let slack = COORDINATE_ERROR * (room.abs() + change.abs() + Vec4::splat(terms));
        let sides = self.sides[0].slack + self.sides[1].slack + self.sides[2].slack;
        self.cut(room + (slack + sides), change);
    }

    /// Keeps only τ with `room + τ · change ≥ 0`.
    #[inline]
    fn cut(&mut self, room: Vec4, change: Vec4) {
        let crossing = -room / change;
        let slack = SHARE_ERROR as f32;
        // NaN only for 0/0: such a ray stays. Comparisons with NaN are false.
        let rising = change.cmpgt(Vec4::ZERO);
        let falling = change.cmplt(Vec4::ZERO);
        let never = change.cmpeq(Vec4::ZERO) & room.cmplt(Vec4::ZERO);
        let enter = Vec4::select(rising, crossing - slack, self.enter);
        let leave = Vec4::select(falling, crossing + slack, self.leave);
        self.enter = self.enter.max(enter);
        self.leave = Vec4::select(never, Vec4::NEG_ONE, self.leave.min(leave));
    }

    /// The lanes whose part inside the region meets the planes from `from` to `to`.
    #[inline]
    pub fn meets(&self, from: f32, to: f32) -> BVec4A {
        self.enter.cmple(Vec4::splat(to)) & self.leave.cmpge(Vec4::splat(from))
    }

    /// The lanes that have no part inside the region.
    pub fn outside(&self) -> BVec4A {
        self.enter.cmpgt(self.leave)
    }
}

impl Side {
    #[inline]
    fn at(&self, share: f32) -> Vec4 {
        self.start + share * self.extent
    }
}

/// The least `f32` that is no smaller.
pub(crate) fn above(value: f64) -> f32 {
    let nearest = value as f32;
    if f64::from(nearest) < value { nearest.next_up() } else { nearest }
}

#[cfg(test)]
mod tests;
