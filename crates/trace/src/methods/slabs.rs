//! Packets of 2×2 rays march through slabs of their dominant axis, halving those in which the function may vanish, down to a
//! fixed depth: what `knoll` and `raa` share.
//!
//! It proves misses only. Where a slab of the last depth may hold a root one is drawn; nothing says that there is one, so such
//! pixels are undecided. How a slab is tested is not known here.

use super::refine::Refiner;
use crate::found::{Found, Reason, Status};
use crate::method::{Options, Segment, Start, Tracer};
use crate::packet::{Packet, RAYS};
use crate::region::Region;
use crate::scalar::Scalar;
use crate::work::Work;
use zeroset_eval::{LANES, Surface};

/// Calls of the kernel for one packet, at most: as many as all slabs of depth 14 need, so that only deeper pictures can
/// reach it. A packet that hits a surface well needs 2 per level; one whose slabs stay undecided would need 2 to the depth.
pub const STEPS: u64 = 1 << 14;

/// Which rays of a packet may meet a zero between planes.
pub(super) trait SlabTest<T: Scalar>: Sync {
    /// Memory that is used again and again.
    type Batch: Default;

    /// Asks about all rays between each two planes in order: those of the first two are the first bits of what is told, and
    /// so on. `is_last` if slabs in which a zero is possible are not halved, and so whether they are bounded matters. What
    /// kernels are asked is added to `work`, as calls that `wanted` lanes were wanted of.
    fn ask<const PLANES: usize>(
        &self,
        packet: &Packet<T>,
        planes: [T; PLANES],
        is_last: bool,
        batch: &mut Self::Batch,
        work: &mut Work,
        wanted: u32,
    ) -> Told;
}

/// What is known of rays between planes, a bit for each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told {
    /// There may be a zero: where the bit is clear, there is none.
    pub possible: u16,
    /// No finite bounds of the function are known.
    pub unbounded: u16,
}

/// Marches packets through slabs.
pub(super) struct Slabs<'a, T: Scalar, S> {
    test: S,
    /// `None` if nothing samples the function: then slabs are drawn where they begin.
    refiner: Option<Refiner<'a, T>>,
    region: &'a Region,
    /// The level of the thinnest slabs, which are 2^−(`last` + 1) of the region's extent. Rays that are not through after
    /// [`STEPS`] end in the slab that was looked at last, as if it were of this level; what is behind it stays unknown.
    last: u32,
    suppress_asymptotes: bool,
}

/// What became of one ray, as shares of its packet's extent.
#[derive(Clone, Copy, Debug)]
struct Outcome<T> {
    /// τ between which a root is drawn: the slab, and the next one, since bounds are wider than the function and reach 0
    /// before it does.
    drawn: Option<[T; 2]>,
    /// τ at the start of the first slab that was passed over.
    suppressed: Option<T>,
}

/// What is known of one slab. Rays are bits: those that asked, those on which the function may vanish there, and those on
/// which no finite bounds of it are known. Bytes, so that all levels' are quickly cleared.
#[derive(Clone, Copy, Debug, Default)]
struct Slab {
    active: u8,
    vanishing: u8,
    unbounded: u8,
}

/// All rays of a packet.
const ALL: u8 = (1 << RAYS) - 1;

impl<'a, T: Scalar, S: SlabTest<T>> Slabs<'a, T, S> {
    pub fn new(test: S, surface: &'a dyn Surface, region: &'a Region, options: &Options) -> Self {
        let values = T::kernels(surface).values().ok();
        Self {
            test,
            refiner: values.map(|values| Refiner::new(values, options)),
            region,
            last: options.depth.clamp(1, T::MAX_DEPTH) - 1,
            suppress_asymptotes: options.suppress_asymptotes,
        }
    }
}

impl<T: Scalar, S: SlabTest<T>> Tracer for Slabs<'_, T, S> {
    fn follow(&self, rays: &[Segment], start: Start, found: &mut [Found], work: &mut Work) {
        let (mut batch, mut packet) = (S::Batch::default(), Packet::new(self.region));
        for (rays, found) in rays.chunks(LANES).zip(found.chunks_mut(LANES)) {
            let mut slabs = [None; LANES];
            for (first, rays) in rays.chunks(RAYS).enumerate() {
                let lanes = RAYS * first..RAYS * first + rays.len();
                let (found, slabs) = (&mut found[lanes.clone()], &mut slabs[lanes]);
                self.four(rays, &mut packet, &mut batch, start, found, slabs, work);
            }
            let Some(refiner) = &self.refiner else { continue };
            let places = refiner.places(rays, &slabs[..rays.len()], work);
            for (found, place) in found.iter_mut().zip(places) {
                // What is claimed of the slab stays.
                found.drawn = place.map_or(found.drawn, |place| place.max(found.drawn));
            }
        }
    }
}

impl<T: Scalar, S: SlabTest<T>> Slabs<'_, T, S> {
    /// Follows up to four rays: says what became of them, and in which part of each a root is drawn.
    #[allow(clippy::too_many_arguments, reason = "memory that is used again and again")]
    fn four(
        &self,
        rays: &[Segment],
        packet: &mut Packet<T>,
        batch: &mut S::Batch,
        start: Start,
        found: &mut [Found],
        slabs: &mut [Option<[f64; 2]>],
        work: &mut Work,
    ) {
        // The last packet repeats its last ray.
        let last = rays.len() - 1;
        let four = [&rays[0], &rays[last.min(1)], &rays[last.min(2)], &rays[last]];
        if packet.take(&four, self.region) {
            let outcomes = self.packet(packet, batch, start, work);
            for (lane, ray) in rays.iter().enumerate() {
                (found[lane], slabs[lane]) = outcomes[lane].found(packet, lane, ray);
            }
            return;
        }
        // One by one: a packet of one ray, four times, always advances together. Were it not so (a direction that is not a
        // number), nothing would be known of the ray.
        for (lane, ray) in rays.iter().enumerate() {
            if packet.take(&[ray; RAYS], self.region) {
                let outcome = self.packet(packet, batch, start, work)[0];
                (found[lane], slabs[lane]) = outcome.found(packet, 0, ray);
            } else {
                found[lane] = Found { status: Status::Undecided, distance: 0.0, ..Found::MISS };
            }
        }
    }

    fn packet(
        &self,
        packet: &Packet<T>,
        batch: &mut S::Batch,
        start: Start,
        work: &mut Work,
    ) -> [Outcome<T>; RAYS] {
        let mut outcomes = [Outcome { drawn: None, suppressed: None }; RAYS];
        let mut alive = !packet.outside() & ALL;
        let mut leaving = match start {
            Start::Anywhere => 0,
            Start::OnSurface => alive,
        };
        // What was found in the second half of the slab being searched, per level.
        let mut second = [Slab::default(); <f64 as Scalar>::MAX_DEPTH as usize];
        let mut done = Work::default();
        // Slab `index` of 2^(level + 1) spans τ from index · 2^−(level + 1) to the next: exact.
        let (mut level, mut index) = (0_u32, 0_u64);
        loop {
            let size = T::halved(level + 1);
            let from = T::integer(index) * size;
            let mut slab = if index.is_multiple_of(2) {
                // Both halves of a slab in one call: the second is nearly always needed, and the two overlap in the
                // processor (two calls would take 1.6 times as long on the sphere).
                let Some([first, other]) =
                    self.halves(packet, batch, alive, from, level, &mut done)
                else {
                    break;
                };
                second[level as usize] = other;
                first
            } else {
                second[level as usize]
            };
            if start == Start::OnSurface {
                // Until a ray has come through an empty slab, it is still at the surface that it started from.
                leaving &= !(slab.active & !slab.vanishing);
            }
            slab.vanishing &= alive;
            // Intervals or forms, whichever the test asks of each slab.
            let is_last = done.interval.calls.max(done.segments.calls) >= STEPS;
            if slab.vanishing != 0 {
                if level < self.last && !is_last {
                    level += 1;
                    index *= 2;
                    continue;
                }
                slab.vanishing &= !leaving;
                alive &= !self.record(slab, [from, from + size + size], &mut outcomes);
                if alive == 0 && !is_last {
                    break;
                }
            }
            if is_last {
                // What is behind this slab stays unknown; what was found in front of it does not change by that.
                let behind = from + size;
                let left = alive & packet.meets(behind, T::integer(2));
                done.given_up += u64::from((left | slab.vanishing).count_ones());
                for (lane, outcome) in outcomes.iter_mut().enumerate() {
                    if left >> lane & 1 == 1 {
                        outcome.suppressed.get_or_insert(behind);
                    }
                }
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

    /// Asks about the slabs of this level from τ = `from` on and after it; `None` if no ray has anything left to ask from
    /// there on.
    #[inline]
    fn halves(
        &self,
        packet: &Packet<T>,
        batch: &mut S::Batch,
        alive: u8,
        from: T,
        level: u32,
        work: &mut Work,
    ) -> Option<[Slab; 2]> {
        let size = T::halved(level + 1);
        let planes = [from, from + size, from + T::integer(2) * size]; // exact
        let active = [
            alive & packet.meets(planes[0], planes[1]),
            alive & packet.meets(planes[1], planes[2]),
        ];
        if active == [0, 0] {
            let all_left = alive & packet.meets(from, T::integer(2)) == 0;
            return (!all_left).then(Default::default);
        }
        let is_last = level == self.last;
        // Where only the second asks, its rays have the first lanes.
        let (mut skipped, wanted) = (0, active[0].count_ones() + active[1].count_ones());
        let told = if active[1] == 0 {
            self.test.ask(packet, [planes[0], planes[1]], is_last, batch, work, wanted)
        } else if active[0] == 0 {
            skipped = RAYS;
            self.test.ask(packet, [planes[1], planes[2]], is_last, batch, work, wanted)
        } else {
            self.test.ask(packet, planes, is_last, batch, work, wanted)
        };
        let (possible, unbounded) = (told.possible << skipped, told.unbounded << skipped);
        let slab = |active, half: usize| Slab {
            active,
            vanishing: (possible >> (RAYS * half)) as u8 & active,
            unbounded: (unbounded >> (RAYS * half)) as u8 & active,
        };
        Some([slab(active[0], 0), slab(active[1], 1)])
    }

    /// Notes a slab of the last depth in which rays may meet a zero; returns those that are drawn there.
    fn record(&self, slab: Slab, ends: [T; 2], outcomes: &mut [Outcome<T>; RAYS]) -> u8 {
        let mut drawn = slab.vanishing;
        if self.suppress_asymptotes {
            drawn &= !slab.unbounded;
        }
        for (lane, outcome) in outcomes.iter_mut().enumerate() {
            if drawn >> lane & 1 == 1 {
                outcome.drawn = Some(ends);
            } else if slab.vanishing >> lane & 1 == 1 {
                outcome.suppressed.get_or_insert(ends[0]);
            }
        }
        drawn
    }
}

impl<T: Scalar> Outcome<T> {
    /// The same as a finding, and the part of the ray in which a root is drawn.
    fn found(&self, packet: &Packet<T>, lane: usize, ray: &Segment) -> (Found, Option<[f64; 2]>) {
        let at = |share: T| packet.distance(share, lane, ray);
        let slab = self.drawn.map(|ends| ends.map(at));
        let drawn = slab.map_or(f64::INFINITY, |[near, _]| near);
        let distance = self.suppressed.map_or(f64::INFINITY, at).min(drawn);
        if distance == f64::INFINITY && self.drawn.is_none() && self.suppressed.is_none() {
            return (Found::MISS, None);
        }
        let (status, reason) = (Status::Undecided, Reason::Unproven);
        (Found { status, distance, drawn, reason, ..Found::MISS }, slab)
    }
}
