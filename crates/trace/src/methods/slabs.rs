//! Packets of up to sixteen rays march through slabs of their dominant axis, halving those in which
//! the function may vanish, down to a fixed depth: what `knoll` and `raa` share. A ray of which a
//! slab is proven empty is not asked about in its parts, though others of its packet are: what is
//! found of a ray hangs on its neighbours only by the axis, and by the steps that are left.
//!
//! It proves misses only. Where a slab of the last depth may hold a root one is drawn; nothing says
//! that there is one, so such pixels are undecided. How a slab is tested is not known here.

use super::refine::{Parts, Refiner};
use crate::kernel_stats::KernelStats;
use crate::method::{Segment, Start, Task, Tracer};
use crate::packet::{Lines, Packet, RAYS};
use crate::painted::ones;
use crate::ray_result::{RayResult, Status, UndecidedReason};
use crate::scalar::Scalar;
use fearless_simd::{Level as Vectors, Simd, dispatch};
use std::ops::Range;
use zeroset_eval::Zeros;
use zeroset_space::Region;

/// Calls of the kernel for one packet, at most: as many as all slabs of depth 14 need, so that only
/// deeper pictures can reach it. A packet that hits a surface well needs a few per level; one whose
/// slabs stay undecided would need 2 to the depth.
pub const STEPS: u64 = 1 << 15;

/// Which rays of a packet may meet a zero between planes.
pub(super) trait SlabTest<T: Scalar>: Sync {
    /// Memory that is used again and again.
    type Batch: Default;

    /// Notes what is the same in all slabs of a packet.
    #[inline(always)]
    fn begin<V: Simd>(&self, _: V, _: &Packet<T>, _: &mut Self::Batch) {}

    /// Asks whether rays may meet a zero in a slab, and if it is the last whether it is bounded.
    /// What is told of other rays says nothing. What kernels are asked is added to `work`.
    fn eval<V: Simd>(
        &self,
        simd: V,
        packet: &Packet<T>,
        slab: &Slab<T>,
        batch: &mut Self::Batch,
        work: &mut KernelStats,
    ) -> Zeros;
}

/// What is asked about.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab<T> {
    /// The τ between which it is, in order.
    pub planes: [T; 2],
    /// The rays, as bits.
    pub rays: u16,
    /// Whether slabs in which a zero is possible are not halved: then it matters whether they are
    /// bounded.
    pub is_last: bool,
}

/// Marches packets through slabs.
pub(super) struct Slabs<'a, T: Scalar, S> {
    test: S,
    /// `None` if nothing samples the function: then slabs are drawn where they begin.
    refiner: Option<Refiner<'a, T>>,
    region: &'a Region,
    vectors: Vectors,
    /// The level of the thinnest slabs, which are 2^−(`last` + 1) of the region's extent. Rays that
    /// are not through after [`STEPS`] end in the slab that was looked at last, as if it were of
    /// this level; what is behind it stays unknown.
    last: u32,
    suppress_asymptotes: bool,
}

/// What became of a packet's rays, as shares of its extent. Rays are bits.
#[derive(Clone, Copy, Debug, Default)]
struct Outcomes<T> {
    /// On which a root is drawn.
    drawn: u16,
    /// By ray, τ between which it is: the slab, and the next one, since bounds are wider than the
    /// function and reach 0 before it does.
    ends: [[T; 2]; RAYS],
    /// On which slabs were passed over.
    suppressed: u16,
    /// By ray, τ at the start of the first of these.
    first: [T; RAYS],
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
            suppress_asymptotes: options.suppress_asymptotes,
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
        let (mut batch, mut packet) = (S::Batch::default(), Packet::new(self.region));
        for (rays, found) in rays.chunks(RAYS).zip(found.chunks_mut(RAYS)) {
            let (mut slabs, lines) = (Parts::default(), Lines::new(rays));
            let room = (&mut packet, &mut batch);
            self.some(rays, (0..rays.len(), &lines), room, start, found, &mut slabs, work);
            let Some(refiner) = &self.refiner else { continue };
            let places = refiner.places(&lines, &slabs, work);
            for lane in ones(slabs.rays).filter(|lane| places[*lane].is_finite()) {
                // What is claimed of the slab stays.
                found[lane].drawn = found[lane].drawn.max(places[lane]);
            }
        }
    }
}

impl<T: Scalar, S: SlabTest<T>> Slabs<'_, T, S> {
    /// Follows some of up to [`RAYS`] rays, of which `lines` are the coordinates: says what became
    /// of them, and in which part of each a root is drawn.
    #[allow(clippy::too_many_arguments, reason = "memory that is used again and again")]
    fn some(
        &self,
        rays: &[Segment],
        (some, lines): (Range<usize>, &Lines),
        (packet, batch): (&mut Packet<T>, &mut S::Batch),
        start: Start,
        found: &mut [RayResult],
        slabs: &mut Parts,
        work: &mut KernelStats,
    ) {
        let taken = dispatch!(self.vectors, simd => {
            packet.take(simd, &rays[some.clone()], lines, self.region)
        });
        if taken {
            let outcomes = dispatch!(self.vectors, simd => {
                self.packet(simd, packet, batch, start, work)
            });
            found[some.clone()].fill(RayResult::MISS);
            for lane in ones(outcomes.drawn | outcomes.suppressed) {
                let ray = some.start + lane;
                found[ray] = outcomes.found(packet, lane, &rays[ray], |slab| slabs.set(ray, slab));
            }
            return;
        }
        if some.len() == 1 {
            // One ray always advances with itself. Were it not so (a direction that is not a
            // number), nothing would be known.
            found[some.start] =
                RayResult { status: Status::Undecided, distance: 0.0, ..RayResult::MISS };
            return;
        }
        // Neighbours by fours, then each alone.
        let size = if some.len() > 4 { 4 } else { 1 };
        for first in some.clone().step_by(size) {
            let fewer = first..some.end.min(first + size);
            let lines = Lines::new(&rays[fewer.clone()]);
            self.some(rays, (fewer, &lines), (packet, batch), start, found, slabs, work);
        }
    }

    #[inline(always)]
    fn packet<V: Simd>(
        &self,
        simd: V,
        packet: &Packet<T>,
        batch: &mut S::Batch,
        start: Start,
        work: &mut KernelStats,
    ) -> Outcomes<T> {
        self.test.begin(simd, packet, batch);
        let mut outcomes = Outcomes::default();
        let mut alive = packet.inside(simd);
        let mut leaving = match start {
            Start::Anywhere => 0,
            Start::OnSurface => alive,
        };
        let mut done = KernelStats::default();
        // By level, the rays that may meet a zero in the slab of the level above: of others the
        // parts need no look.
        let mut possible = [u16::MAX; <f64 as Scalar>::MAX_DEPTH as usize];
        // Slab `index` of 2^(level + 1) spans τ from index · 2^−(level + 1) to the next: exact.
        let (mut level, mut index) = (0_u32, 0_u64);
        loop {
            let size = T::halved(level + 1);
            let from = T::integer(index) * size;
            let planes = [from, from + size];
            let active = alive & possible[level as usize] & packet.meets(simd, from, planes[1]);
            let mut told = Zeros::default();
            if active != 0 {
                let slab = Slab { planes, rays: active, is_last: level == self.last };
                told = self.test.eval(simd, packet, &slab, batch, &mut done);
            } else if alive & packet.meets(simd, from, T::integer(2)) == 0 {
                break;
            }
            let mut vanishing = told.possible & active;
            if start == Start::OnSurface {
                // Until a ray has come through an empty slab, it is still at the surface that it
                // started from.
                leaving &= !(active & !vanishing);
            }
            // Intervals or forms, whichever the test asks of each slab.
            let is_last = done.interval.calls.max(done.segments.calls) >= STEPS;
            if vanishing != 0 {
                if level < self.last && !is_last {
                    level += 1;
                    index *= 2;
                    possible[level as usize] = vanishing;
                    continue;
                }
                vanishing &= !leaving;
                // Bounds are wider than the function: a root may be in the next slab, too.
                let ends = [from, planes[1] + size];
                alive &= !self.record(vanishing, told.unbounded, ends, &mut outcomes);
                if alive == 0 && !is_last {
                    break;
                }
            }
            if is_last {
                // What is behind this slab stays unknown; what was found in front of it does not
                // change by that.
                let behind = planes[1];
                let left = alive & packet.meets(simd, behind, T::integer(2));
                done.given_up += u64::from((left | vanishing).count_ones());
                outcomes.pass_over(left, behind);
                break;
            }
            // On to the next slab, and up to the largest that starts there.
            index += 1;
            let up = index.trailing_zeros();
            if up > level {
                break; // the end of the region
            }
            index >>= up;
            level -= up;
        }
        *work += done;
        outcomes
    }

    /// Notes a slab of the last depth in which rays may meet a zero, and those on which nothing
    /// bounds the function there; returns those that are drawn there.
    #[inline(always)]
    fn record(
        &self,
        vanishing: u16,
        unbounded: u16,
        ends: [T; 2],
        outcomes: &mut Outcomes<T>,
    ) -> u16 {
        let drawn = if self.suppress_asymptotes { vanishing & !unbounded } else { vanishing };
        outcomes.drawn |= drawn;
        for lane in ones(drawn) {
            outcomes.ends[lane] = ends;
        }
        outcomes.pass_over(vanishing & !drawn, ends[0]);
        drawn
    }
}

impl<T: Scalar> Outcomes<T> {
    /// Notes rays of which nothing is known from some τ on.
    #[inline(always)]
    fn pass_over(&mut self, rays: u16, from: T) {
        for lane in ones(rays & !self.suppressed) {
            self.first[lane] = from;
        }
        self.suppressed |= rays;
    }

    /// What was found of a ray; tells in which part of it a root is drawn, if one is.
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
