//! The method of Knoll, Hijazi, Hansen, Wald and Hagen (UUSCI-2007-002): packets of 2×2 rays march through slabs of their
//! dominant axis, halving those in which the function may vanish, down to a fixed depth.
//!
//! It proves misses only. Where a slab of the last depth may hold a root it is drawn as one; nothing says that it does,
//! so such pixels are undecided.

use crate::gbuffer::{Found, Reason, Status};
use crate::method::{Method, MethodOption, Options, Precision, Proves, Segment, Start, Tracer};
use crate::packet::{Packet, RAYS};
use crate::region::Region;
use crate::scalar::Scalar;
use crate::work::Work;
use zeroset_eval::{Boxes, FindZeros, Kernel, KernelError, Surface, Zeros};

pub(crate) const METHOD: Method = Method {
    name: "knoll",
    help: "packets of rays in slabs of the dominant axis (Knoll et al. 2007); proves misses only",
    proves: Proves::Misses,
    reads: &[MethodOption::Precision, MethodOption::Depth],
    prepare,
};

/// Calls of the kernel for one packet, at most: as many as all slabs of depth 14 need, so that only deeper pictures can
/// reach it. A packet that hits a surface well needs 2 per level; one whose slabs stay undecided would need 2 to the depth.
pub const STEPS: u64 = 1 << 14;

fn prepare<'a>(
    surface: &'a dyn Surface,
    region: &'a Region,
    options: Options,
) -> Result<Box<dyn Tracer + 'a>, KernelError> {
    Ok(match options.precision {
        Precision::Auto | Precision::F32 => Box::new(Knoll::<f32>::new(surface, region, options)?),
        Precision::F64 => Box::new(Knoll::<f64>::new(surface, region, options)?),
    })
}

struct Knoll<'a, T: Scalar> {
    kernel: &'a dyn Kernel<FindZeros, T>,
    region: &'a Region,
    /// The level of the thinnest slabs, which are 2^−(`last` + 1) of the region's extent. Rays that are not through after
    /// [`STEPS`] end in the slab that was looked at last, as if it were of this level; what is behind it stays unknown.
    last: u32,
    suppress_asymptotes: bool,
}

/// What became of one ray, as shares of its packet's extent.
#[derive(Clone, Copy, Debug)]
struct Outcome<T> {
    /// τ at the start of the slab that is drawn.
    drawn: Option<T>,
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

impl<'a, T: Scalar> Knoll<'a, T> {
    fn new(
        surface: &'a dyn Surface,
        region: &'a Region,
        options: Options,
    ) -> Result<Self, KernelError> {
        Ok(Self {
            kernel: T::kernels(surface).zeros()?,
            region,
            last: options.depth.clamp(1, T::MAX_DEPTH) - 1,
            suppress_asymptotes: options.suppress_asymptotes,
        })
    }
}

impl<T: Scalar> Tracer for Knoll<'_, T> {
    fn follow(&self, rays: &[Segment], start: Start, found: &mut [Found], work: &mut Work) {
        let (mut boxes, mut packet) = (Boxes::default(), Packet::new(self.region));
        for (rays, found) in rays.chunks(RAYS).zip(found.chunks_mut(RAYS)) {
            // The last packet repeats its last ray.
            let last = rays.len() - 1;
            let four = [&rays[0], &rays[last.min(1)], &rays[last.min(2)], &rays[last]];
            if packet.take(&four, self.region) {
                let outcomes = self.packet(&packet, &mut boxes, start, work);
                for (lane, (found, ray)) in found.iter_mut().zip(rays).enumerate() {
                    *found = outcomes[lane].found(&packet, lane, ray);
                }
                continue;
            }
            // One by one: a packet of one ray, four times, always advances together. Were it not so (a direction that is
            // not a number), nothing would be known of the ray.
            for (found, ray) in found.iter_mut().zip(rays) {
                *found = if packet.take(&[ray; RAYS], self.region) {
                    self.packet(&packet, &mut boxes, start, work)[0].found(&packet, 0, ray)
                } else {
                    Found { status: Status::Undecided, distance: 0.0, ..Found::MISS }
                };
            }
        }
    }
}

impl<T: Scalar> Knoll<'_, T> {
    fn packet(
        &self,
        packet: &Packet<T>,
        boxes: &mut Boxes<T>,
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
                let Some([first, other]) = self.halves(packet, boxes, alive, from, size, &mut done)
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
            let is_last = done.interval.calls >= STEPS;
            if slab.vanishing != 0 {
                if level < self.last && !is_last {
                    level += 1;
                    index *= 2;
                    continue;
                }
                slab.vanishing &= !leaving;
                alive &= !self.record(slab, from, &mut outcomes);
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

    /// Asks about the slabs of this size from τ = `from` on and after it; `None` if no ray has anything left to ask from
    /// there on.
    #[inline]
    fn halves(
        &self,
        packet: &Packet<T>,
        boxes: &mut Boxes<T>,
        alive: u8,
        from: T,
        size: T,
        work: &mut Work,
    ) -> Option<[Slab; 2]> {
        let planes = [from, from + size, from + T::integer(2) * size]; // exact
        let active = [
            alive & packet.meets(planes[0], planes[1]),
            alive & packet.meets(planes[1], planes[2]),
        ];
        if active == [0, 0] {
            let all_left = alive & packet.meets(from, T::integer(2)) == 0;
            return (!all_left).then(Default::default);
        }
        // Where only the second asks, its rays have the first lanes.
        let mut skipped = 0;
        if active[1] == 0 {
            packet.boxes([planes[0], planes[1]], boxes);
        } else if active[0] == 0 {
            packet.boxes([planes[1], planes[2]], boxes);
            skipped = RAYS;
        } else {
            packet.boxes(planes, boxes);
        }
        let mut zeros = Zeros::default();
        self.kernel.ask(boxes, &mut zeros);
        work.interval.called(active[0].count_ones() + active[1].count_ones());
        let (possible, unbounded) = (zeros.possible << skipped, zeros.unbounded << skipped);
        let slab = |active, half: usize| Slab {
            active,
            vanishing: (possible >> (RAYS * half)) as u8 & active,
            unbounded: (unbounded >> (RAYS * half)) as u8 & active,
        };
        Some([slab(active[0], 0), slab(active[1], 1)])
    }

    /// Notes a slab of the last depth in which rays may meet a zero; returns those that are drawn there.
    fn record(&self, slab: Slab, from: T, outcomes: &mut [Outcome<T>; RAYS]) -> u8 {
        let mut drawn = slab.vanishing;
        if self.suppress_asymptotes {
            drawn &= !slab.unbounded;
        }
        for (lane, outcome) in outcomes.iter_mut().enumerate() {
            if drawn >> lane & 1 == 1 {
                outcome.drawn = Some(from);
            } else if slab.vanishing >> lane & 1 == 1 {
                outcome.suppressed.get_or_insert(from);
            }
        }
        drawn
    }
}

impl<T: Scalar> Outcome<T> {
    fn found(&self, packet: &Packet<T>, lane: usize, ray: &Segment) -> Found {
        if self.drawn.is_none() && self.suppressed.is_none() {
            return Found::MISS;
        }
        let at = |share: Option<T>| {
            share.map_or(f64::INFINITY, |share| packet.distance(share, lane, ray))
        };
        let drawn = at(self.drawn);
        let distance = at(self.suppressed).min(drawn);
        let (status, reason) = (Status::Undecided, Reason::Unproven);
        Found { status, distance, drawn, reason, ..Found::MISS }
    }
}
