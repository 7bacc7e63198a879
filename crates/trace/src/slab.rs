//! Slabs on their way through an interval kernel, two neighbours at a time.
//!
//! Nothing here knows in which order slabs are visited.

use crate::packet::Packet;
use crate::scalar::{Four, Scalar};
use crate::work::Work;
use zeroset_eval::{BoxPacket, EnclosurePacket, IntervalKernel};
use zeroset_interval::Facts;

/// What is known of one slab: lanes by group.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slab<const GROUPS: usize> {
    /// The lanes that asked.
    pub active: [u32; GROUPS],
    /// The function may vanish there.
    pub vanishing: [u32; GROUPS],
    /// Its enclosure there is unbounded.
    pub unbounded: [u32; GROUPS],
}

impl<const GROUPS: usize> Default for Slab<GROUPS> {
    fn default() -> Self {
        Self { active: [0; GROUPS], vanishing: [0; GROUPS], unbounded: [0; GROUPS] }
    }
}

/// Two neighbouring slabs on their way through the kernel.
pub(crate) struct Pair<T: Scalar, const GROUPS: usize> {
    /// Lanes that ask for each.
    active: [[u32; GROUPS]; 2],
    boxes: [[BoxPacket<T>; GROUPS]; 2],
    values: [[EnclosurePacket<T>; GROUPS]; 2],
}

impl<T: Scalar, const GROUPS: usize> Default for Pair<T, GROUPS> {
    fn default() -> Self {
        Self {
            active: [[0; GROUPS]; 2],
            boxes: [[BoxPacket::default(); GROUPS]; 2],
            values: [[EnclosurePacket::default(); GROUPS]; 2],
        }
    }
}

impl<T: Scalar, const GROUPS: usize> Pair<T, GROUPS> {
    /// Takes the slabs of this size from τ = `from` on; returns whether any lane asks for one.
    #[inline]
    pub fn prepare(
        &mut self,
        packet: &Packet<T, GROUPS>,
        alive: &[u32; GROUPS],
        from: T,
        size: T,
    ) -> bool {
        let planes = [from, from + size, from + T::integer(2) * size]; // exact
        let mut any = 0;
        for half in 0..2 {
            let lanes = self.active[half].iter_mut().zip(alive).zip(&packet.groups);
            for ((active, alive), group) in lanes {
                *active = alive & group.meets(planes[half], planes[half + 1]);
                any |= *active;
            }
        }
        packet.boxes(planes, &mut self.boxes);
        any != 0
    }

    /// Asks the kernel for the slabs that any lane wants.
    #[inline]
    pub fn enclose<K: IntervalKernel<T> + ?Sized>(
        &mut self,
        kernel: &K,
        work: &mut Work,
    ) -> [Slab<GROUPS>; 2] {
        let lanes = |half: usize| self.active[half].iter().map(|l| l.count_ones()).sum::<u32>();
        let (first, second) = (lanes(0), lanes(1));
        let mut slabs = [Slab::default(); 2];
        let halves = match (first, second) {
            (0, 0) => return slabs,
            (_, 0) => 0..1,
            (0, _) => 1..2,
            _ => 0..2,
        };
        kernel.enclose(
            self.boxes[halves.clone()].as_flattened(),
            self.values[halves].as_flattened_mut(),
        );
        work.interval_calls += 1;
        work.interval_lanes += u64::from(first + second);
        for (half, slab) in slabs.iter_mut().enumerate() {
            slab.active = self.active[half];
            for group in 0..GROUPS {
                let (vanishing, unbounded) = judge(&self.values[half][group]);
                slab.vanishing[group] = vanishing & self.active[half][group];
                slab.unbounded[group] = unbounded;
            }
        }
        slabs
    }
}

/// The lanes whose enclosure contains 0 and that are not proven undefined, and those whose enclosure is unbounded.
#[inline]
fn judge<T: Scalar>(value: &EnclosurePacket<T>) -> (u32, u32) {
    let (neg_lo, hi) = (T::Four::from_array(value.neg_lo), T::Four::from_array(value.hi));
    let mut vanishing = T::Four::bits(T::Four::default().at_most(neg_lo.min(hi)));
    // Few functions are undefined anywhere: one test for all lanes.
    let [mut any, b, c, d] = value.facts;
    any |= b;
    any |= c;
    any |= d;
    if T::facts(any).has(Facts::NOWHERE) {
        for lane in 0..4 {
            vanishing &= !(u32::from(value.facts(lane).has(Facts::NOWHERE)) << lane);
        }
    }
    let unbounded = T::Four::splat(T::LARGEST).less(neg_lo.max(hi));
    (vanishing, T::Four::bits(unbounded))
}
