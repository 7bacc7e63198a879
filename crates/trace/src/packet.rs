//! A packet of rays that cross the region together, slab by slab along one axis.
//!
//! Along the axis K on which the rays advance fastest, the region's extent is divided into slabs. A place along a ray is
//! given by its share τ of that extent, from 0 where rays enter to 1 where they leave, so one τ is one plane for all
//! rays of the packet. Everything here is in the kernel's floats with explicit slack, and encloses the exact rays.

use crate::method::Segment;
use crate::region::Region;
use crate::scalar::{Four, Scalar};
use glam::DVec3;
use std::array::from_fn;
use zeroset_eval::{Boxes, LANES, Segments};

/// The most rays in a packet, four at a time.
pub(crate) const RAYS: usize = LANES;
const FOURS: usize = RAYS / 4;

/// A number of each ray.
type Each<F> = [F; FOURS];

/// Up to sixteen rays, and what they share. Lanes that no ray has repeat the last one's.
#[derive(Clone, Debug)]
pub(crate) struct Packet<T: Scalar> {
    planes: Planes,
    /// How many rays there are.
    count: usize,
    /// Per axis, the region's bounds as (−lo, hi), rounded outward, in all lanes.
    bounds: [[T::Four; 2]; 3],
    /// By axis, then by fours.
    sides: [Each<Side<T::Four>>; 3],
    /// A ray is within the region only between these τ.
    enter: Each<T::Four>,
    leave: Each<T::Four>,
}

/// Origins and directions of a packet's rays, and up to which t they are looked at.
struct Lines {
    origin: [[f64; RAYS]; 3],
    direction: [[f64; RAYS]; 3],
    to: [f64; RAYS],
}

impl Lines {
    #[inline]
    fn new(segments: &[Segment]) -> Self {
        let mut lines = Self {
            origin: [[0.0; RAYS]; 3],
            direction: [[0.0; RAYS]; 3],
            to: [f64::INFINITY; RAYS],
        };
        for lane in 0..RAYS {
            let Segment { ray, to, .. } = &segments[lane.min(segments.len() - 1)];
            for axis in 0..3 {
                lines.origin[axis][lane] = ray.origin[axis];
                lines.direction[axis][lane] = ray.direction[axis];
            }
            lines.to[lane] = *to;
        }
        lines
    }
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
        let side = Side { start: zero, extent: zero, slack: zero };
        Self {
            planes: Planes { k: 0, start: 0.0, extent: 0.0, inverse: 0.0 },
            count: 0,
            bounds: [0, 1, 2].map(|k| [bound(-region.low()[k]), bound(region.high()[k])]),
            sides: [[side; FOURS]; 3],
            enter: [zero; FOURS],
            leave: [zero; FOURS],
        }
    }

    /// Takes these rays, one to [`RAYS`], advancing on the first one's fastest axis. Returns whether they all advance
    /// together: otherwise they need packets of their own.
    pub fn take(&mut self, segments: &[Segment], region: &Region) -> bool {
        let lines = Lines::new(segments);
        let k = fastest_axis(segments[0].ray.direction);
        let forward = lines.direction[k][0] > 0.0;
        let mut together = true;
        for lane in 0..RAYS {
            let [x, y, z] = [0, 1, 2].map(|axis| lines.direction[axis][lane].abs());
            let along = lines.direction[k][lane];
            // Written so that NaN directions are rejected too.
            let fast = |other: f64| along.abs() >= LEAST_SHARE * other;
            together &= fast(x) & fast(y) & fast(z) & ((along > 0.0) == forward);
        }
        if !together {
            return false;
        }
        let (low, high) = (region.low()[k], region.high()[k]);
        let (start, end) = if forward { (low, high) } else { (high, low) };
        self.planes = Planes { k, start, extent: end - start, inverse: 1.0 / (end - start) };
        self.count = segments.len();
        self.place(&lines, region);
        self.round(segments, region);
        true
    }

    /// The distance from a ray's origin to the plane τ = `share`, or to where the ray enters the region if that is
    /// farther; as a value of t.
    pub fn distance(&self, share: T, lane: usize, segment: &Segment) -> f64 {
        let Planes { k, start, extent, .. } = self.planes;
        let share = share.into().max(self.enter[lane / 4].to_array()[lane % 4].into());
        let plane = start + share * extent;
        ((plane - segment.ray.origin[k]) / segment.ray.direction[k]).max(0.0)
    }

    /// Boxes around the rays between two planes in order, clipped to the region: those of rays up to the last of some, which
    /// are bits.
    #[inline]
    pub fn boxes(&self, [from, to]: [T; 2], rays: u16, out: &mut Boxes<T>) {
        out.count = LANES as u32 - rays.leading_zeros();
        let (from, to) = (T::Four::splat(from), T::Four::splat(to));
        let fours = (out.count as usize).div_ceil(4);
        for (axis, sides) in self.sides.iter().enumerate() {
            let [neg_lo, hi] = self.bounds[axis];
            let lowers = out.neg_lo[axis].as_chunks_mut::<4>().0;
            let uppers = out.hi[axis].as_chunks_mut::<4>().0;
            for ((side, lower), upper) in sides[..fours].iter().zip(lowers).zip(uppers) {
                let (a, b) = (side.start + from * side.extent, side.start + to * side.extent);
                *lower = (side.slack - a.min(b)).min(neg_lo).to_array();
                *upper = (side.slack + a.max(b)).min(hi).to_array();
            }
        }
    }

    /// The rays between two planes in order, as segments in which t is τ: in lanes as [`Packet::boxes`].
    #[inline]
    pub fn segments(&self, [from, to]: [T; 2], rays: u16, out: &mut Segments<T>) {
        out.count = LANES as u32 - rays.leading_zeros();
        (out.near.0, out.far.0) = ([from; LANES], [to; LANES]);
        // The slack is for τ within [0, 1], all of a packet's; what kernels round is added to it, generously.
        let rounding = T::Four::splat(T::nearest(2.0 * T::PATH_ERROR));
        let least = T::LEAST_NORMAL + T::LEAST_NORMAL;
        let least = T::Four::splat(least + least);
        for (axis, sides) in self.sides.iter().enumerate() {
            for (four, Side { start, extent, slack }) in sides.iter().enumerate() {
                let error = *slack + rounding * (start.abs() + extent.abs()) + least;
                let [origin, direction, error] = [*start, *extent, error].map(Four::to_array);
                let lanes = 4 * four..4 * four + 4;
                out.origin[axis][lanes.clone()].copy_from_slice(&origin);
                out.direction[axis][lanes.clone()].copy_from_slice(&direction);
                out.error[axis][lanes].copy_from_slice(&error);
            }
        }
    }

    /// Finds where the rays are.
    #[inline]
    fn place(&mut self, lines: &Lines, region: &Region) {
        let Planes { k, start, extent, inverse } = self.planes;
        // τ = (origin_k + t · d_k − start) / extent grows with t; t0 is where τ = 0, dt the way from there to τ = 1.
        let (mut from, mut to) = ([T::integer(0); RAYS], [T::integer(1); RAYS]);
        let (mut t0, mut dt) = ([0.0_f64; RAYS], [0.0_f64; RAYS]);
        for lane in 0..RAYS {
            let (origin, direction) = (lines.origin[k][lane], lines.direction[k][lane]);
            let first = start - origin;
            let per_k = 1.0 / direction;
            (t0[lane], dt[lane]) = (first * per_k, extent * per_k);
            let error = T::SHARE_ERROR.into() + DOUBLE_ERROR * (origin * inverse).abs();
            from[lane] = T::nearest(-first * inverse - error);
        }
        if lines.to.iter().any(|to| to.is_finite()) {
            for lane in (0..RAYS).filter(|&lane| lines.to[lane].is_finite()) {
                let (origin, direction) = (lines.origin[k][lane], lines.direction[k][lane]);
                let advance = lines.to[lane] * direction;
                let sizes = (origin * inverse).abs() + (advance * inverse).abs();
                let error = T::SHARE_ERROR.into() + DOUBLE_ERROR * sizes;
                to[lane] = T::nearest((advance - (start - origin)) * inverse + error);
            }
        }
        let (from, to) = (fours::<T>(&from), fours::<T>(&to));
        let most = T::Four::splat(T::integer(1) + T::SHARE_ERROR);
        for four in 0..FOURS {
            self.enter[four] = from[four].max(T::Four::splat(-T::SHARE_ERROR));
            self.leave[four] = to[four].min(most);
        }
        for axis in 0..3 {
            let [mut starts, mut extents, mut reach] = [[T::integer(0); RAYS]; 3];
            for lane in 0..RAYS {
                let (origin, direction) = (lines.origin[axis][lane], lines.direction[axis][lane]);
                let step = t0[lane] * direction;
                starts[lane] = T::nearest(origin + step);
                extents[lane] = T::nearest(dt[lane] * direction);
                reach[lane] = T::nearest(2.0 * DOUBLE_ERROR * (origin.abs() + step.abs()));
            }
            let [starts, extents, reach] = [starts, extents, reach].map(|lanes| fours::<T>(&lanes));
            let [neg_lo, hi] = self.bounds[axis];
            for four in 0..FOURS {
                let (start, extent) = (starts[four], extents[four]);
                let size = T::Four::splat(T::COORDINATE_ERROR) * (start.abs() + extent.abs());
                let slack = size + (reach[four] + T::Four::splat(T::LEAST_NORMAL));
                self.sides[axis][four] = Side { start, extent, slack };
                if axis != k {
                    self.cut(four, start + (slack + neg_lo), extent);
                    self.cut(four, (slack + hi) - start, -extent);
                }
            }
        }
        self.clip(lines, &t0, &dt, region);
    }

    /// Keeps only τ in the region's ball.
    fn round(&mut self, segments: &[Segment], region: &Region) {
        if region.ball().is_none() {
            return;
        }
        let Planes { k, start, inverse, .. } = self.planes;
        let (mut from, mut to) = ([T::integer(1); RAYS], [-T::integer(1); RAYS]);
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
        let (from, to) = (fours::<T>(&from), fours::<T>(&to));
        for four in 0..FOURS {
            // In this order, what is not a number gives way.
            self.enter[four] = from[four].max(self.enter[four]);
            self.leave[four] = to[four].min(self.leave[four]);
        }
    }

    /// Keeps only τ in the region's half-space.
    #[inline]
    fn clip(&mut self, lines: &Lines, t0: &[f64; RAYS], dt: &[f64; RAYS], region: &Region) {
        let Some(half) = region.clip() else { return };
        // offset − normal · p at τ = 0, and its change: kept where it is ≥ 0. Both are sums of terms that may cancel; each
        // takes at most eight operations of half a unit in the last place of `f64`.
        let scale = 1.0 / half.normal.abs().max_element();
        let size = half.normal.abs();
        let [mut room, mut change, mut terms] = [[T::integer(0); RAYS]; 3];
        for lane in 0..RAYS {
            let [origin, direction] = [&lines.origin, &lines.direction]
                .map(|all| DVec3::new(all[0][lane], all[1][lane], all[2][lane]));
            let at = origin + t0[lane] * direction;
            room[lane] = T::nearest((half.offset - half.normal.dot(at)) * scale);
            change[lane] = T::nearest(-half.normal.dot(direction) * dt[lane] * scale);
            let moved = size.dot(direction.abs()) * dt[lane].abs();
            terms[lane] = T::nearest((size.dot(at.abs()) + half.offset.abs() + moved) * scale);
        }
        let [room, change, terms] = [room, change, terms].map(|lanes| fours::<T>(&lanes));
        for four in 0..FOURS {
            let terms = room[four].abs() + change[four].abs() + terms[four];
            let slack = T::Four::splat(T::COORDINATE_ERROR) * terms;
            let [x, y, z] = self.sides.each_ref().map(|sides| sides[four].slack);
            self.cut(four, room[four] + (slack + (x + y + z)), change[four]);
        }
    }

    /// Keeps only τ with `room + τ · change ≥ 0`, on four of the rays.
    #[inline]
    fn cut(&mut self, four: usize, room: T::Four, change: T::Four) {
        let (enter, leave) = (&mut self.enter[four], &mut self.leave[four]);
        let zero = T::Four::default();
        let crossing = -room / change;
        let slack = T::Four::splat(T::SHARE_ERROR);
        // NaN only for 0/0: such a ray stays. Comparisons with NaN are false.
        let rising = zero.less(change);
        let falling = change.less(zero);
        let never = change.equal(zero) & room.less(zero);
        let first = T::Four::select(rising, crossing - slack, *enter);
        let last = T::Four::select(falling, crossing + slack, *leave);
        // What is not a number comes first, so that it gives way: of an overflow nothing is concluded.
        *enter = first.max(*enter);
        let nowhere = T::Four::splat(-T::integer(1));
        *leave = T::Four::select(never, nowhere, last.min(*leave));
    }

    /// The rays whose part inside the region meets the planes from `from` to `to`, as bits.
    #[inline]
    pub fn meets(&self, from: T, to: T) -> u16 {
        let (from, to) = (T::Four::splat(from), T::Four::splat(to));
        let meets = |four: usize| {
            T::Four::bits(self.enter[four].at_most(to) & from.at_most(self.leave[four])) as u16
        };
        self.rays() & (0..FOURS).map(|four| meets(four) << (4 * four)).sum::<u16>()
    }

    /// The rays that have no part inside the region, as bits.
    pub fn outside(&self) -> u16 {
        let outside = |four: usize| T::Four::bits(self.leave[four].less(self.enter[four])) as u16;
        self.rays() & (0..FOURS).map(|four| outside(four) << (4 * four)).sum::<u16>()
    }

    /// All rays, as bits.
    #[inline]
    pub fn rays(&self) -> u16 {
        u16::MAX >> (RAYS - self.count)
    }
}

/// The numbers of all rays, by fours.
#[inline]
fn fours<T: Scalar>(lanes: &[T; RAYS]) -> Each<T::Four> {
    from_fn(|four| T::Four::from_array(from_fn(|lane| lanes[4 * four + lane])))
}

#[cfg(test)]
mod tests;
