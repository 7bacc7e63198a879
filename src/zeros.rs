//! Where a function may vanish: its own enclosures, and those of its cleared form.

use crate::uniforms::Bound;
use zeroset_eval::{BoxPacket, EnclosurePacket, IntervalKernel, LANES, Real};
use zeroset_interval::{Facts, Interval};
use zeroset_jit::NativeInterval;

/// Encloses, in each lane, either a function or what has its zeros, as precisely as it takes to see that there is none.
///
/// The function is asked first. Where its enclosure holds 0, the numerator of its cleared form is, which vanishes at the
/// same points of the function's domain: so poles are proven empty, and where the function is unbounded, a root near its
/// pole has bounds. Where that holds 0 too and the function may jump, its branches are asked one by one; a lane in which none
/// vanishes is called undefined, as is the function restricted to where it is 0.
#[derive(Clone)]
pub struct ZeroKernel<T: Real = f32> {
    function: Bound<NativeInterval<T>>,
    numerator: Option<Bound<NativeInterval<T>>>,
    branches: Option<Bound<NativeInterval<T>>>,
}

impl<T: Real> ZeroKernel<T> {
    /// The function's own code, and if there are such, that of its numerator, and that which is empty where no branch
    /// vanishes ([`Tape::branches`](zeroset_eval::Tape::branches)).
    pub(crate) fn new(
        function: Bound<NativeInterval<T>>,
        numerator: Option<Bound<NativeInterval<T>>>,
        branches: Option<Bound<NativeInterval<T>>>,
    ) -> Self {
        Self { function, numerator, branches }
    }

    /// The same code for other parameter values, or `None` if it does not hold for them.
    pub(crate) fn with(&self, parameters: &[Interval]) -> Option<Self> {
        let other = |kernel: &Option<Bound<NativeInterval<T>>>| match kernel {
            Some(kernel) => kernel.with(parameters).map(Some),
            None => Some(None),
        };
        Some(Self {
            function: self.function.with(parameters)?,
            numerator: other(&self.numerator)?,
            branches: other(&self.branches)?,
        })
    }

    /// Whether both run the same code, compiled once.
    pub(crate) fn shares_code(&self, other: &Self) -> bool {
        let share = |one: &Option<Bound<NativeInterval<T>>>, other: &Option<_>| match (one, other) {
            (Some(one), Some(other)) => one.shares_code(other),
            (None, None) => true,
            (Some(_), None) | (None, Some(_)) => false,
        };
        self.function.shares_code(&other.function)
            && share(&self.numerator, &other.numerator)
            && share(&self.branches, &other.branches)
    }

    /// The function alone: its enclosures tell on which side of the surface a box lies, which those of a numerator do not.
    pub fn function(&self) -> &NativeInterval<T> {
        &self.function.kernel
    }

    /// Whether the numerator of a cleared form is asked too.
    pub fn has_numerator(&self) -> bool {
        self.numerator.is_some()
    }

    /// Whether branches are asked one by one too.
    pub fn has_branches(&self) -> bool {
        self.branches.is_some()
    }

    /// Size of the machine code in bytes.
    pub fn code_bytes(&self) -> usize {
        let others = [&self.numerator, &self.branches];
        let others = others.into_iter().flatten().map(|bound| bound.kernel.code_bytes());
        self.function.kernel.code_bytes() + others.sum::<usize>()
    }
}

impl<T: Real> IntervalKernel<T> for ZeroKernel<T> {
    fn enclose(&self, boxes: &[BoxPacket<T>], out: &mut [EnclosurePacket<T>]) {
        self.function.kernel.enclose(boxes, out);
        if self.numerator.is_none() && self.branches.is_none() {
            return;
        }
        for (packet, out) in boxes.iter().zip(out) {
            if let Some(numerator) = &self.numerator
                && (0..LANES).any(|lane| may_vanish(out, lane))
            {
                clear(&numerator.kernel, packet, out);
            }
            if let Some(branches) = &self.branches
                && (0..LANES).any(|lane| may_vanish(out, lane) && may_jump(out, lane))
            {
                part(&branches.kernel, packet, out);
            }
        }
    }
}

/// Replaces the enclosures in which the function may vanish, but its numerator does not, or has bounds where the function
/// has none.
fn clear<T: Real>(
    numerator: &NativeInterval<T>,
    packet: &BoxPacket<T>,
    out: &mut EnclosurePacket<T>,
) {
    let mut cleared = [EnclosurePacket::default()];
    numerator.enclose(std::slice::from_ref(packet), &mut cleared);
    for lane in 0..LANES {
        if may_vanish(out, lane) && (!may_vanish(&cleared[0], lane) || is_unbounded(out, lane)) {
            out.neg_lo[lane] = cleared[0].neg_lo[lane];
            out.hi[lane] = cleared[0].hi[lane];
            // What is proven of the numerator is not proven of the function, except that neither has a value.
            let nowhere = cleared[0].facts(lane) & Facts::NOWHERE;
            out.facts[lane] |= nowhere.bits().into();
        }
    }
}

fn is_unbounded<T: Real>(packet: &EnclosurePacket<T>, lane: usize) -> bool {
    packet.neg_lo[lane].into() == f64::INFINITY || packet.hi[lane].into() == f64::INFINITY
}

/// Empties the enclosures in which the function may vanish, but none of its branches does.
fn part<T: Real>(
    branches: &NativeInterval<T>,
    packet: &BoxPacket<T>,
    out: &mut EnclosurePacket<T>,
) {
    let mut zeros = [EnclosurePacket::default()];
    branches.enclose(std::slice::from_ref(packet), &mut zeros);
    for lane in 0..LANES {
        let nowhere = zeros[0].facts(lane).has(Facts::NOWHERE);
        if nowhere && may_vanish(out, lane) && may_jump(out, lane) {
            out.facts[lane] = Facts::NOWHERE.bits().into();
        }
    }
}

fn may_jump<T: Real>(packet: &EnclosurePacket<T>, lane: usize) -> bool {
    !packet.facts(lane).has(Facts::CONTINUOUS)
}

fn may_vanish<T: Real>(packet: &EnclosurePacket<T>, lane: usize) -> bool {
    let zero = T::default();
    let nowhere = packet.facts(lane).has(Facts::NOWHERE);
    !nowhere && packet.neg_lo[lane] >= zero && packet.hi[lane] >= zero
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Program;
    use zeroset_syntax::{Options, read};

    /// Whether `formula` may vanish for x in a range around 0, y and z in [1, 2].
    fn vanishes(formula: &str, x: [f32; 2]) -> bool {
        let document = read(formula, &Options::default()).expect("reads");
        let program = Program::new(&document, [Interval { lo: -2.0, hi: 2.0 }; 3]).expect("fits");
        let kernel = program.zero_kernel(0).expect("compiles");
        let packet = BoxPacket::<f32> {
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
        assert!(!vanishes("atan(1/x) - y/4", [-0.125, 0.125]));
        // A division that cancels leaves a hole, and beside it the function.
        assert!(vanishes("x*(x-y)/x", [0.5, 2.0]));
    }

    #[test]
    fn a_pole_inside_another_function_is_empty_and_a_zero_is_not() {
        // The pole of a tangent is proven empty where clearing reaches it, that of a quotient also inside a function: in
        // `exp(tan(x)) - y` a box that holds the pole stays undecided.
        for pole in ["1/tan(x) - y", "tan(pi/2 + x)^2 - y", "exp(1/x) - y", "sqrt(abs(1/x)) - y"] {
            assert!(!vanishes(pole, [-0.125, 0.125]), "{pole}");
        }
        for root in [
            "exp(tan(x)) - y",
            "abs(tan(x)) - y",
            "1/tan(x) - y",
            "tan(x)^2 - y",
            "exp(1/x) - 3*y",
            "sqrt(abs(1/x)) - y",
        ] {
            assert!(vanishes(root, [0.375, 1.0]), "{root}");
        }
    }

    #[test]
    fn a_jump_is_empty_and_a_zero_at_one_is_not() {
        let near = [0.875, 1.125];
        // f jumps over 0 at x = 1: y and z are in [1, 2].
        for jump in [
            "floor(x) - y/4",
            "ceil(x) - 1.1 - y/3",
            "round(x + 1/2) - y/2 + 1/3",
            "trunc(x) - y/4",
            "fract(x) - y/4",
            "mod(x, 1) - y/4",
            "mod(x, y/y) - y/4",
            "sign(x - 1) - y/4",
            "sign(x - 1) + z/4",
            "step(1, x) - y/4",
            "atan2(x - 1, -y) - z",
            "(floor(x) - y/4)/(z - 1.5)",
            "floor(x)/(x - 1) + 2*y",
            "floor(x) + floor(y/8 + x) + round(z/8 + x - 1/2) + ceil(x) - 1 - y/4",
        ] {
            assert!(!vanishes(jump, near), "{jump}");
        }
        for root in [
            "floor(x) - 2 + y",
            "fract(x)*y",
            "mod(x, 1)*y",
            "sign(x - 1)",
            "(step(1, x) - 1)*y",
            "atan2(x - 1, -y) - z*pi/1.5",
            "floor(x) - x*y",
        ] {
            assert!(vanishes(root, near), "{root}");
        }
    }
}
