//! The reference evaluator: a loop over steps on the software machine.

use crate::binding::Binding;
use crate::kernel::{GradientKernel, IntervalKernel, PointKernel};
use crate::packet::{BoxPacket, EnclosurePacket, GradientPacket, LANES, PointPacket, ValuePacket};
use crate::real::Real;
use crate::tape::{Tape, facts_of};
use zeroset_interval::{Software, Vector128};

/// A tape with its parameters bound, evaluated in software, without native code.
///
/// It gives the bits that native kernels give; it is some hundred times slower.
#[derive(Clone, Debug)]
pub struct Reference<T: Real = f32> {
    tape: Tape<T>,
    binding: Binding<T>,
}

impl<T: Real> Reference<T> {
    /// A reference for `tape` under `binding`.
    ///
    /// # Panics
    /// If the binding has another number of parameters than the tape.
    pub fn new(tape: Tape<T>, binding: Binding<T>) -> Self {
        assert_eq!(tape.parameters(), binding.values().len(), "parameters");
        Self { tape, binding }
    }

    /// The values of all outputs in the vector of lanes with this index.
    fn values_at(&self, packet: &PointPacket<T>, vector: usize) -> Vec<Vector128> {
        self.tape.evaluate(
            &mut Software,
            |_, axis| T::load(&packet.at[axis as usize], vector),
            |_, number| T::load(&[self.binding.values()[number as usize]; 4], 0),
        )
    }

    /// Encloses the boxes in the vector of lanes with this index.
    fn enclose_at(&self, packet: &BoxPacket<T>, vector: usize, out: &mut EnclosurePacket<T>) {
        let values = self.tape.enclose(
            &mut Software,
            |_, axis| {
                let axis = axis as usize;
                (T::load(&packet.neg_lo[axis], vector), T::load(&packet.hi[axis], vector))
            },
            |_, number| {
                let [neg_lo, hi] = self.binding.enclosures()[number as usize];
                (T::load(&[neg_lo; 4], 0), T::load(&[hi; 4], 0))
            },
        );
        T::store(values[0].neg_lo, vector, &mut out.neg_lo);
        T::store(values[0].hi, vector, &mut out.hi);
        let reads = self.tape.reads_parameters();
        let lanes = LANES / T::VECTORS;
        let words = &mut out.facts[lanes * vector..lanes * (vector + 1)];
        for (out, facts) in words.iter_mut().zip(facts_of::<T>(&values[0])) {
            let facts = if reads { self.binding.limit(facts) } else { facts };
            *out = facts.bits().into();
        }
    }
}

impl<T: Real> IntervalKernel<T> for Reference<T> {
    fn enclose(&self, boxes: &[BoxPacket<T>], out: &mut [EnclosurePacket<T>]) {
        assert!(out.len() >= boxes.len(), "output shorter than input");
        for (packet, out) in boxes.iter().zip(out) {
            for vector in 0..T::VECTORS {
                self.enclose_at(packet, vector, out);
            }
        }
    }
}

impl<T: Real> PointKernel<T> for Reference<T> {
    fn sample(&self, points: &[PointPacket<T>], out: &mut [ValuePacket<T>]) {
        assert!(out.len() >= points.len(), "output shorter than input");
        for (packet, out) in points.iter().zip(out) {
            for vector in 0..T::VECTORS {
                T::store(self.values_at(packet, vector)[0], vector, &mut out.value);
            }
        }
    }
}

impl<T: Real> GradientKernel<T> for Reference<T> {
    /// # Panics
    /// Also if the tape does not have four outputs: value and partial derivatives.
    fn gradient(&self, points: &[PointPacket<T>], out: &mut [GradientPacket<T>]) {
        assert!(out.len() >= points.len(), "output shorter than input");
        for (packet, out) in points.iter().zip(out) {
            for vector in 0..T::VECTORS {
                let values = self.values_at(packet, vector);
                let [value, derivatives @ ..]: [Vector128; 4] =
                    values.try_into().expect("value and three derivatives");
                T::store(value, vector, &mut out.value);
                for (derivative, out) in derivatives.into_iter().zip(&mut out.gradient) {
                    T::store(derivative, vector, out);
                }
            }
        }
    }
}
