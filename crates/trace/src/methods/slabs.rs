//! Packets of up to sixteen rays march through slabs of their dominant axis, for the methods
//! `knoll` and `raa`. A slab in which the function may vanish is halved, down to a fixed depth. If
//! a slab is proven empty for a ray, its parts are not tested for that ray. So the packet's other
//! rays affect a ray's result in two ways only: by the choice of axis, and by the number of steps
//! left.
//!
//! These methods prove misses only. If a slab of the last level may hold a root, a root is drawn in
//! it. Such pixels are undecided. This module does not depend on how a slab is tested.

use super::refine::{RayParts, Refiner};
use crate::kernel_stats::KernelStats;
use crate::method::{Segment, Start, Task, Tracer};
use crate::packet::{PACKET_RAYS, Packet, RayLanes};
use crate::painted::ones;
use crate::ray_result::{RayResult, Status, UndecidedReason};
use crate::scalar::Scalar;
use fearless_simd::{Level as Vectors, Simd};
use std::ops::Range;
use zeroset_eval::Zeros;
use zeroset_eval::dispatch;
use zeroset_space::Region;

/// Maximum number of kernel calls for one packet. A search of all slabs down to depth 14 takes
/// about as many, so only deeper searches reach this limit. A packet that clearly hits a surface
/// needs a few calls per level. A packet whose slabs all stay undecided would need 2^depth.
pub const MOST_STEPS: u64 = 1 << 15;

/// A test of rays of a packet: may they meet a zero between two planes?
pub(super) trait SlabTest<T: Scalar>: Sync {
    /// Buffers that are reused from packet to packet.
    type Buffers: Default;

    /// Writes to the buffers everything that all slabs of a packet share.
    #[inline(always)]
    fn begin<V: Simd>(&self, _: V, _: &Packet<T>, _: &mut Self::Buffers) {}

    /// Tests which of the slab's rays may meet a zero in it. If the slab is of the last level, also
    /// tests on which of them the function is unbounded. The bits of other rays are meaningless.
    /// Adds the kernel calls to `work`.
    fn eval<V: Simd>(
        &self,
        simd: V,
        packet: &Packet<T>,
        slab: &Slab<T>,
        batch: &mut Self::Buffers,
        work: &mut KernelStats,
    ) -> Zeros;
}

/// A slab, and the rays that are tested in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab<T> {
    /// Values of τ at its two planes, in order.
    pub planes: [T; 2],
    /// Rays to be tested, as bits.
    pub rays: u16,
    /// Whether the slab is of the last level, which is not halved. Only on that level it matters
    /// whether the function is bounded.
    pub is_last: bool,
}

/// Marches packets through slabs.
pub(super) struct Slabs<'a, T: Scalar, S> {
    test: S,
    /// Finds places at which samples change sign. `None` if no kernel samples the function. Then
    /// roots are drawn at the near planes of slabs.
    refiner: Option<Refiner<'a, T>>,
    region: &'a Region,
    vectors: Vectors,
    /// Level of the thinnest slabs. Their thickness is 2^−(`last` + 1) of the region's extent along
    /// the axis. If a packet uses up [`MOST_STEPS`], the slab tested last is treated as one of this
    /// level. Behind it, nothing is known.
    last: u32,
    is_solid: bool,
}

/// The outcomes of a packet's rays. Places are values of τ. Sets of rays are bits.
#[derive(Clone, Copy, Debug, Default)]
struct PacketOutcomes<T> {
    /// Rays that are proven to meet no zero, from end to end.
    missed: u16,
    /// Rays with a drawn root.
    drawn: u16,
    /// Per ray, the range of τ in which its root is drawn: a slab and the next one. Bounds are
    /// wider than the function, so they may reach 0 in the slab before the root.
    ends: [[T; 2]; PACKET_RAYS],
    /// Rays with a part that was skipped without a proof.
    suppressed: u16,
    /// Per ray, the τ at which its first skipped part starts.
    first: [T; PACKET_RAYS],
}

impl<'a, T: Scalar, S: SlabTest<T>> Slabs<'a, T, S> {
    pub fn new(test: S, Task { surface, region, options }: Task<'a>) -> Self {
        let values = T::kernels(surface).values().ok();
        Self {
            test,
            refiner: values.map(|values| Refiner::new(values, &options)),
            region,
            vectors: Vectors::new(),
            last: options.depth.clamp(1, T::MAX_DEPTH) - 1,
            is_solid: options.is_solid,
        }
    }
}

impl<T: Scalar, S: SlabTest<T>> Tracer for Slabs<'_, T, S> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        let (mut batch, mut packet) = (S::Buffers::default(), Packet::new(self.region));
        for (rays, found) in rays.chunks(PACKET_RAYS).zip(found.chunks_mut(PACKET_RAYS)) {
            let (mut slabs, lines) = (RayParts::default(), RayLanes::new(rays));
            let buffers = (&mut packet, &mut batch);
            self.some(rays, (0..rays.len(), &lines), buffers, start, found, &mut slabs, work);
            let Some(refiner) = &self.refiner else { continue };
            let places = refiner.places(&lines, &slabs, work);
            for lane in ones(slabs.rays).filter(|lane| places[*lane].is_finite()) {
                // The ray is proven empty before the slab, so nothing is painted before the slab.
                found[lane].drawn = found[lane].drawn.max(places[lane]);
            }
        }
    }
}

impl<T: Scalar, S: SlabTest<T>> Slabs<'_, T, S> {
    /// Follows the rays `some` of a packet of up to [`PACKET_RAYS`]. `lines` holds the same rays.
    /// Writes their results to `found`. Writes to `slabs` the part of each ray in which a root is
    /// drawn.
    #[allow(clippy::too_many_arguments, reason = "memory that is used again and again")]
    fn some(
        &self,
        rays: &[Segment],
        (some, lines): (Range<usize>, &RayLanes),
        (packet, batch): (&mut Packet<T>, &mut S::Buffers),
        start: Start,
        found: &mut [RayResult],
        slabs: &mut RayParts,
        work: &mut KernelStats,
    ) {
        let taken = dispatch!(self.vectors, simd => {
            packet.take(simd, &rays[some.clone()], lines, self.region)
        });
        if taken {
            let outcomes = dispatch!(self.vectors, simd => {
                self.packet(simd, packet, batch, start, work)
            });
            for lane in ones(outcomes.missed) {
                found[some.start + lane] = RayResult::MISS;
            }
            for lane in ones(outcomes.drawn | outcomes.suppressed) {
                let ray = some.start + lane;
                found[ray] = outcomes.found(packet, lane, &rays[ray], |slab| slabs.set(ray, slab));
            }
            return;
        }
        if some.len() == 1 {
            // A single ray is refused only if its direction is NaN. Then nothing is known about it.
            let (status, distance) = (Status::Undecided, 0.0);
            found[some.start] = RayResult { status, distance, ..RayResult::MISS };
            return;
        }
        // The packet is divided into groups of four rays, and a refused group into single rays.
        let size = if some.len() > 4 { 4 } else { 1 };
        for first in some.clone().step_by(size) {
            let fewer = first..some.end.min(first + size);
            let lines = RayLanes::new(&rays[fewer.clone()]);
            self.some(rays, (fewer, &lines), (packet, batch), start, found, slabs, work);
        }
    }

    #[inline(always)]
    fn packet<V: Simd>(
        &self,
        simd: V,
        packet: &Packet<T>,
        batch: &mut S::Buffers,
        start: Start,
        work: &mut KernelStats,
    ) -> PacketOutcomes<T> {
        self.test.begin(simd, packet, batch);
        let mut outcomes = PacketOutcomes::default();
        let mut alive = packet.inside(simd);
        // Other rays miss the region.
        outcomes.missed = packet.rays() & !alive;
        let mut leaving = match start {
            Start::Anywhere => 0,
            Start::OnSurface => alive,
        };
        let mut done = KernelStats::default();
        // For each level, the rays that may meet a zero in the current slab of the level above.
        // Other rays need no test in the parts of that slab.
        let mut possible = [u16::MAX; <f64 as Scalar>::MAX_DEPTH as usize];
        // Slab `index` of level `level` starts at τ = index · 2^−(level + 1), which is exact.
        let (mut level, mut index) = (0_u32, 0_u64);
        loop {
            let size = T::halved(level + 1);
            let from = T::integer(index) * size;
            let planes = [from, from + size];
            let active = alive & possible[level as usize] & packet.meets(simd, from, planes[1]);
            let mut result = Zeros::default();
            if active != 0 {
                let slab = Slab { planes, rays: active, is_last: level == self.last };
                result = self.test.eval(simd, packet, &slab, batch, &mut done);
            } else if alive & packet.meets(simd, from, T::integer(2)) == 0 {
                outcomes.missed |= alive;
                break;
            }
            let mut vanishing = result.possible & active;
            if start == Start::OnSurface {
                // A ray that starts on a surface leaves it when it has passed an empty slab.
                leaving &= !(active & !vanishing);
            }
            // Each slab takes at most one call of each kind of kernel.
            let is_last = done.interval.calls.max(done.segments.calls) >= MOST_STEPS;
            if vanishing != 0 {
                if level < self.last && !is_last {
                    level += 1;
                    index *= 2;
                    possible[level as usize] = vanishing;
                    continue;
                }
                vanishing &= !leaving;
                // Bounds are wider than the function, so the root may be in the next slab.
                let ends = [from, planes[1] + size];
                alive &= !self.record(vanishing, result.unbounded, ends, &mut outcomes);
                if alive == 0 && !is_last {
                    break;
                }
            }
            if is_last {
                // Nothing is known about the rays behind this slab. Results before it stay valid.
                let behind = planes[1];
                let left = alive & packet.meets(simd, behind, T::integer(2));
                done.given_up += u64::from((left | vanishing).count_ones());
                outcomes.pass_over(left, behind);
                outcomes.missed |= alive & !left;
                break;
            }
            // The next slab is the largest one that starts at the end of this slab.
            index += 1;
            let up = index.trailing_zeros();
            if up > level {
                // This is the end of the region.
                outcomes.missed |= alive;
                break;
            }
            index >>= up;
            level -= up;
        }
        *work += done;
        outcomes
    }

    /// Records rays that may meet a zero in a slab of the last level. On `unbounded` rays, the
    /// function has no known bounds in the slab. Returns the rays whose root is drawn in the slab.
    #[inline(always)]
    fn record(
        &self,
        vanishing: u16,
        unbounded: u16,
        ends: [T; 2],
        outcomes: &mut PacketOutcomes<T>,
    ) -> u16 {
        let drawn = if self.is_solid { vanishing } else { vanishing & !unbounded };
        outcomes.drawn |= drawn;
        for lane in ones(drawn) {
            outcomes.ends[lane] = ends;
        }
        outcomes.pass_over(vanishing & !drawn, ends[0]);
        drawn
    }
}

impl<T: Scalar> PacketOutcomes<T> {
    /// Records that the parts of `rays` from τ = `from` on are skipped without a proof.
    #[inline(always)]
    fn pass_over(&mut self, rays: u16, from: T) {
        for lane in ones(rays & !self.suppressed) {
            self.first[lane] = from;
        }
        self.suppressed |= rays;
    }

    /// Returns the result of a ray. If its root is drawn, passes the part with the root to `tell`.
    fn found(
        &self,
        packet: &Packet<T>,
        lane: usize,
        ray: &Segment,
        tell: impl FnOnce([f64; 2]),
    ) -> RayResult {
        let at = |share: T| packet.distance(share, lane, ray);
        let mut drawn = f64::INFINITY;
        if self.drawn >> lane & 1 == 1 {
            let slab = self.ends[lane].map(at);
            drawn = slab[0];
            tell(slab);
        }
        let is_suppressed = self.suppressed >> lane & 1 == 1;
        let distance = if is_suppressed { at(self.first[lane]).min(drawn) } else { drawn };
        let (status, reason) = (Status::Undecided, UndecidedReason::Unproven);
        RayResult { status, distance, drawn, reason, ..RayResult::MISS }
    }
}
