//! Where a function may vanish: its own enclosures, and those of its cleared form.

use zeroset_eval::{BoxPacket, EnclosurePacket, IntervalKernel, LANES};
use zeroset_interval::Facts;
use zeroset_jit::NativeInterval;

/// Encloses, in each lane, either a function or the numerator of its cleared form, which vanish at the same points of
/// the function's domain. The numerator is asked only where the function's enclosure holds 0, and its answer taken only
/// where that does not: so poles are proven empty, and a slab is known to be unbounded if the function is.
#[derive(Clone)]
pub struct ZeroKernel {
    function: NativeInterval,
    numerator: Option<NativeInterval>,
}

impl ZeroKernel {
    pub(crate) fn new(function: NativeInterval, numerator: Option<NativeInterval>) -> Self {
        Self { function, numerator }
    }

    /// The function alone: its enclosures tell on which side of the surface a box lies, which those of a numerator do not.
    pub fn function(&self) -> &NativeInterval {
        &self.function
    }

    /// Size of the machine code in bytes.
    pub fn code_bytes(&self) -> usize {
        let numerator = self.numerator.as_ref().map_or(0, NativeInterval::code_bytes);
        self.function.code_bytes() + numerator
    }
}

impl IntervalKernel for ZeroKernel {
    fn enclose(&self, boxes: &[BoxPacket], out: &mut [EnclosurePacket]) {
        self.function.enclose(boxes, out);
        let Some(numerator) = &self.numerator else { return };
        for (packet, out) in boxes.iter().zip(out) {
            if !(0..LANES).any(|lane| may_vanish(out, lane)) {
                continue;
            }
            let mut cleared = [EnclosurePacket::default()];
            numerator.enclose(std::slice::from_ref(packet), &mut cleared);
            for lane in 0..LANES {
                if may_vanish(out, lane) && !may_vanish(&cleared[0], lane) {
                    out.neg_lo[lane] = cleared[0].neg_lo[lane];
                    out.hi[lane] = cleared[0].hi[lane];
                    // What is proven of the numerator is not proven of the function, except that neither has a value.
                    let nowhere = Facts::from_bits(cleared[0].facts[lane]) & Facts::NOWHERE;
                    out.facts[lane] |= nowhere.bits();
                }
            }
        }
    }
}

fn may_vanish(packet: &EnclosurePacket, lane: usize) -> bool {
    let nowhere = Facts::from_bits(packet.facts[lane]).has(Facts::NOWHERE);
    !nowhere && packet.neg_lo[lane] >= 0.0 && packet.hi[lane] >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;
    use zeroset_interval::Interval;
    use zeroset_syntax::{Options, read};

    /// Whether `formula` may vanish for x in a range around 0, y and z in [1, 2].
    fn vanishes(formula: &str, x: [f32; 2]) -> bool {
        let document = read(formula, &Options::default()).expect("reads");
        let program = Program::new(&document, [Interval { lo: -2.0, hi: 2.0 }; 3]).expect("fits");
        let kernel = program.zero_kernel(0).expect("compiles");
        let packet = BoxPacket {
            neg_lo: [[-x[0]; LANES], [-1.0; LANES], [-1.0; LANES]],
            hi: [[x[1]; LANES], [2.0; LANES], [2.0; LANES]],
        };
        let mut out = [EnclosurePacket::default()];
        kernel.enclose(&[packet], &mut out);
        may_vanish(&out[0], 0)
    }

    #[test]
    fn a_pole_is_empty_and_a_zero_is_not() {
        assert!(!vanishes("1/x - y", [-0.125, 0.125]));
        assert!(vanishes("1/x - y", [0.375, 1.0]));
        assert!(!vanishes("tan(pi/2 + x) - y", [-0.125, 0.125]));
        // A division that cancels leaves a hole, and beside it the function.
        assert!(vanishes("x*(x-y)/x", [0.5, 2.0]));
    }
}
