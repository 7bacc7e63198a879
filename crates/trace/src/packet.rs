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

/// A packet's axes and the rays in groups of four lanes.
#[derive(Clone, Debug)]
pub(crate) struct Packet<const GROUPS: usize> {
    /// The axis of slabs and the two others.
    axes: [usize; 3],
    /// The coordinate on K at τ = 0, and its change up to τ = 1.
    start: f32,
    extent: f32,
    /// What K coordinates may be off by.
    slack: f32,
    /// Per axis, the region's bounds as (−lo, hi), rounded outward.
    bounds: [(f32, f32); 3],
    planes: Planes,
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
    sides: [Side; 2],
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
const SHARE_ERROR: f32 = 1.0 / 1_048_576.0;
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
    pub fn new(segments: &[[Segment; 4]; GROUPS], region: &Region) -> Option<Self> {
        let first = segments[0][0].direction;
        let k = fastest_axis(first);
        let axes = [k, (k + 1) % 3, (k + 2) % 3];
        let forward = first[k] > 0.0;
        let coherent = |s: &Segment| {
            let d = s.direction;
            (d[k] > 0.0) == forward && d[k].abs() >= LEAST_SHARE * d.abs().max_element()
        };
        if !segments.iter().flatten().all(coherent) {
            return None;
        }
        let (low, high) = (region.low()[k], region.high()[k]);
        let (start, end) = if forward { (low, high) } else { (high, low) };
        let (near, extent) = (start as f32, (end - start) as f32);
        let planes = Planes { k, start, extent: end - start, inverse: 1.0 / (end - start) };
        let bounds = [0, 1, 2].map(|axis| (above(-region.low()[axis]), above(region.high()[axis])));
        let mut packet = Self {
            axes,
            start: near,
            extent,
            slack: COORDINATE_ERROR * (near.abs() + extent.abs()),
            bounds,
            planes,
            groups: [Group::default(); GROUPS],
        };
        for (group, segments) in packet.groups.iter_mut().zip(segments) {
            *group = Group::new(segments, &planes, axes, &bounds, region);
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

    /// Boxes around the rays between the planes `from` and `to`, clipped to the region.
    #[inline]
    pub fn boxes(&self, from: f32, to: f32, out: &mut [BoxPacket; GROUPS]) {
        let (a, b) = (self.start + from * self.extent, self.start + to * self.extent);
        let [k, u, v] = self.axes;
        let neg_lo = ((-a).max(-b) + self.slack).min(self.bounds[k].0);
        let hi = (a.max(b) + self.slack).min(self.bounds[k].1);
        for (group, out) in self.groups.iter().zip(out) {
            out.neg_lo[k] = [neg_lo; 4];
            out.hi[k] = [hi; 4];
            for (side, axis) in group.sides.iter().zip([u, v]) {
                let (a, b) = (side.at(from), side.at(to));
                let bounds = self.bounds[axis];
                let neg_lo = side.slack - a.min(b);
                let hi = side.slack + a.max(b);
                out.neg_lo[axis] = neg_lo.min(Vec4::splat(bounds.0)).to_array();
                out.hi[axis] = hi.min(Vec4::splat(bounds.1)).to_array();
            }
        }
    }
}

impl Group {
    fn new(
        segments: &[Segment; 4],
        planes: &Planes,
        axes: [usize; 3],
        bounds: &[(f32, f32); 3],
        region: &Region,
    ) -> Self {
        let mut group = Self { enter: Vec4::ZERO, leave: Vec4::ONE, ..Self::default() };
        // τ = (origin_k + t · d_k − start) / extent grows with t.
        let mut from = [0.0_f32; 4];
        let mut to = [1.0_f32; 4];
        let mut clip = [[0.0_f32; 4]; 2];
        let mut sides = [[[0.0_f32; 4]; 2]; 2];
        for (lane, segment) in segments.iter().enumerate() {
            let Segment { origin, direction, to: last } = *segment;
            // Whatever is computed here in f64 is off by far less than the slack.
            let first = planes.start - origin[planes.k];
            let per_k = 1.0 / direction[planes.k];
            from[lane] = (-first * planes.inverse) as f32;
            if last.is_finite() {
                to[lane] = ((last * direction[planes.k] - first) * planes.inverse) as f32;
            }
            let (t0, dt) = (first * per_k, planes.extent * per_k);
            for (side, axis) in sides.iter_mut().zip([axes[1], axes[2]]) {
                side[0][lane] = (origin[axis] + t0 * direction[axis]) as f32;
                side[1][lane] = (dt * direction[axis]) as f32;
            }
            if let Some(half) = region.clip() {
                // offset − normal · p at τ = 0, and its change: kept where it is ≥ 0.
                let scale = 1.0 / half.normal.abs().max_element();
                let at = origin + t0 * direction;
                clip[0][lane] = ((half.offset - half.normal.dot(at)) * scale) as f32;
                clip[1][lane] = (-half.normal.dot(direction) * dt * scale) as f32;
            }
        }
        group.enter = group.enter.max(Vec4::from_array(from) - SHARE_ERROR);
        group.leave = group.leave.min(Vec4::from_array(to) + SHARE_ERROR);
        for (index, ([start, extent], axis)) in
            sides.into_iter().zip([axes[1], axes[2]]).enumerate()
        {
            let side = Side::new(Vec4::from_array(start), Vec4::from_array(extent));
            group.sides[index] = side;
            let (neg_lo, hi) = bounds[axis];
            group.cut(side.start + (side.slack + neg_lo), side.extent);
            group.cut((side.slack + hi) - side.start, -side.extent);
        }
        if let Some(half) = region.clip() {
            let [room, change] = clip.map(Vec4::from_array);
            // Room is a difference of terms as large as the region's coordinates.
            let reach = region.low().abs().max(region.high().abs()).max_element();
            let scale = 1.0 / half.normal.abs().max_element();
            let terms = (3.0 * reach + half.offset.abs() * scale) as f32;
            let slack = COORDINATE_ERROR * (room.abs() + change.abs() + Vec4::splat(terms));
            group.cut(room + slack, change);
        }
        group
    }

    /// Keeps only τ with `room + τ · change ≥ 0`.
    fn cut(&mut self, room: Vec4, change: Vec4) {
        let crossing = -room / change;
        // NaN only for 0/0: such a ray stays. Comparisons with NaN are false.
        let rising = change.cmpgt(Vec4::ZERO);
        let falling = change.cmplt(Vec4::ZERO);
        let never = change.cmpeq(Vec4::ZERO) & room.cmplt(Vec4::ZERO);
        let enter = Vec4::select(rising, crossing - SHARE_ERROR, self.enter);
        let leave = Vec4::select(falling, crossing + SHARE_ERROR, self.leave);
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
    fn new(start: Vec4, extent: Vec4) -> Self {
        let slack =
            COORDINATE_ERROR * (start.abs() + extent.abs()) + Vec4::splat(f32::MIN_POSITIVE);
        Self { start, extent, slack }
    }

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
