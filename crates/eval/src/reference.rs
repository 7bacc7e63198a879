//! The reference evaluator: a loop over steps on the software machine.

use crate::binding::Binding;
use crate::kernel::{GradientKernel, IntervalKernel, PointKernel};
use crate::packet::{BoxPacket, EnclosurePacket, GradientPacket, PointPacket, ValuePacket};
use crate::tape::{Tape, facts_of};
use zeroset_interval::{Lanes, Software};

/// A tape with its parameters bound, evaluated in software, without native code.
///
/// It gives the bits that native kernels give; it is some hundred times slower.
#[derive(Clone, Debug)]
pub struct Reference {
    tape: Tape,
    binding: Binding,
}

impl Reference {
    /// A reference for `tape` under `binding`.
    ///
    /// # Panics
    /// If the binding has another number of parameters than the tape.
    pub fn new(tape: Tape, binding: Binding) -> Self {
        assert_eq!(tape.parameters(), binding.values().len(), "parameters");
        Self { tape, binding }
    }

    fn values_at(&self, packet: &PointPacket) -> Vec<[f32; 4]> {
        self.tape
            .evaluate(
                &mut Software,
                |_, axis| Lanes::from_f32(packet.at[axis as usize]),
                |_, number| Lanes::from_f32(self.binding.values()[number as usize]),
            )
            .into_iter()
            .map(Lanes::f32)
            .collect()
    }
}

impl IntervalKernel for Reference {
    fn enclose(&self, boxes: &[BoxPacket], out: &mut [EnclosurePacket]) {
        assert!(out.len() >= boxes.len(), "output shorter than input");
        for (packet, out) in boxes.iter().zip(out) {
            let values = self.tape.enclose(
                &mut Software,
                |_, axis| {
                    let axis = axis as usize;
                    (Lanes::from_f32(packet.neg_lo[axis]), Lanes::from_f32(packet.hi[axis]))
                },
                |_, number| {
                    let [neg_lo, hi] = self.binding.enclosures()[number as usize];
                    (Lanes::from_f32(neg_lo), Lanes::from_f32(hi))
                },
            );
            let value = &values[0];
            let reads = self.tape.reads_parameters();
            *out = EnclosurePacket {
                neg_lo: value.neg_lo.f32(),
                hi: value.hi.f32(),
                facts: facts_of(value).map(|facts| {
                    if reads { self.binding.limit(facts).bits() } else { facts.bits() }
                }),
            };
        }
    }
}

impl PointKernel for Reference {
    fn sample(&self, points: &[PointPacket], out: &mut [ValuePacket]) {
        assert!(out.len() >= points.len(), "output shorter than input");
        for (packet, out) in points.iter().zip(out) {
            out.value = self.values_at(packet)[0];
        }
    }
}

impl GradientKernel for Reference {
    /// # Panics
    /// Also if the tape does not have four outputs: value and partial derivatives.
    fn gradient(&self, points: &[PointPacket], out: &mut [GradientPacket]) {
        assert!(out.len() >= points.len(), "output shorter than input");
        for (packet, out) in points.iter().zip(out) {
            let [value, x, y, z] =
                self.values_at(packet).try_into().expect("value and three derivatives");
            *out = GradientPacket { value, gradient: [x, y, z] };
        }
    }
}
