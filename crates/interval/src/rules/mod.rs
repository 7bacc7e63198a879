//! The interval rule of every operation, written once over [`Machine`].
//!
//! A rule assumes only that operands lie within [`Operand::range`], and is then sound for every
//! box. If an operand may be infinite, the rule replaces NaN bounds by +∞, so that no bound is NaN.

#[cfg(test)]
#[macro_use]
mod not_recorded;
pub mod affine;
mod arithmetic;
mod choice;
mod elementary;
mod power;
#[cfg(test)]
mod script;
#[cfg(test)]
mod statements;
mod step;

pub(crate) use elementary::approximator::{Approximator, by_halves};
pub(crate) use elementary::bessel::Reach;
pub(crate) use elementary::double_double::Approximation;
pub(crate) use elementary::logarithm::Base;
pub(crate) use elementary::near::NEAR_UNITS;
pub(crate) use elementary::trigonometric::HalfPi;

use crate::branch::Branch;
use crate::enclosure::{Enclosure, Operand};
use crate::machine::{Format, Machine};
use zeroset_ops::Op;

/// Encloses `op` over lanes of operands, all in `format`.
///
/// # Panics
/// If the number of operands is not the arity of `op`.
pub fn enclose<M: Machine>(
    m: &mut M,
    format: Format,
    op: Op,
    operands: &[Operand<M::V>],
) -> Enclosure<M::V> {
    enclose_branch(m, format, op, operands, Branch::Whole)
}

/// Encloses `op` over a branch of the box of its operands. The result contains the values of `op`
/// at all points of the branch where `op` is defined. It claims nothing about other points.
///
/// Every branch is the whole box in lanes where the operation is continuous in the whole box. The
/// same holds if the operation does not split boxes into such branches.
///
/// # Panics
/// If the number of operands is not the arity of `op`.
pub fn enclose_branch<M: Machine>(
    m: &mut M,
    format: Format,
    op: Op,
    operands: &[Operand<M::V>],
    branch: Branch,
) -> Enclosure<M::V> {
    assert_eq!(operands.len(), op.arity(), "{op:?}");
    let mut rule = Rule { m, format };
    rule.enclose(op, operands, branch)
}

impl<M: Machine> Rule<'_, M> {
    fn enclose(&mut self, op: Op, operands: &[Operand<M::V>], branch: Branch) -> Enclosure<M::V> {
        let rule = self;
        let a = &operands[0];
        match op {
            Op::Neg => a.negated().value,
            Op::Abs => rule.abs(a),
            Op::Sign => rule.steps(a, branch, Self::sign_of, Self::sign_of),
            Op::Floor => rule.floor(a, branch),
            Op::Ceil => rule.steps(a, branch, |r, x| r.m.floor(x), |r, x| r.m.ceil(x)),
            Op::Round => rule.steps(a, branch, |r, x| r.m.nearest(x), |r, x| r.m.nearest(x)),
            Op::Trunc => rule.steps(a, branch, |r, x| r.m.trunc(x), |r, x| r.m.trunc(x)),
            Op::Fract => rule.fract(a, branch),
            Op::Sqr => rule.sqr(a),
            Op::Sqrt => rule.sqrt(a),
            Op::Cbrt => rule.increasing_unbounded(a, |approx, x| approx.cbrt(x)),
            Op::Exp => rule.exp(a),
            Op::Ln => rule.logarithm(a, Base::E),
            Op::Log2 => rule.logarithm(a, Base::Two),
            Op::Log10 => rule.logarithm(a, Base::Ten),
            Op::Sin => rule.sin(a),
            Op::Cos => rule.cos(a),
            Op::Tan => rule.tan(a),
            Op::Asin => rule.asin(a),
            Op::Acos => rule.acos(a),
            Op::Atan => rule.increasing(a, |approx, x| approx.atan(x)),
            Op::Sinh => rule.increasing(a, |approx, x| approx.sinh(x)),
            Op::Cosh => rule.cosh(a),
            Op::Tanh => rule.tanh(a),
            Op::Asinh => rule.increasing_unbounded(a, |approx, x| approx.asinh(x)),
            Op::Acosh => rule.acosh(a),
            Op::Atanh => rule.atanh(a),
            Op::Erf => {
                let ends = rule.erf_at_ends(a);
                rule.erf(a, ends)
            }
            Op::BesselJ0 | Op::BesselJ1 | Op::BesselJ2 | Op::BesselJ3 => {
                let order = op.bessel_order();
                let ends = rule.bessel_at_ends(order, a);
                rule.bessel(order, a, ends)
            }
            Op::Add => rule.add(a, &operands[1]),
            Op::Sub => rule.add(a, &operands[1].negated()),
            Op::Mul => rule.mul(a, &operands[1]),
            Op::Div => {
                let divisor = rule.divisor(&operands[1], branch);
                rule.div(a, &divisor)
            }
            Op::Pow => rule.pow(a, &operands[1], branch),
            Op::Mod => rule.modulo(a, &operands[1], branch),
            Op::Atan2 => rule.atan2(a, &operands[1], branch),
            Op::Min => rule.min(a, &operands[1]),
            Op::Max => rule.max(a, &operands[1]),
            Op::SelectNegative => rule.select_negative(a, &operands[1], &operands[2], branch),
            Op::Otherwise => rule.otherwise(a, &operands[1], branch),
            Op::WhereNonneg => rule.where_in(a, &operands[1], Self::nonneg),
            Op::WherePositive => rule.where_in(a, &operands[1], Self::positive),
            Op::WhereNonzero => rule.where_in(a, &operands[1], Self::nonzero),
            Op::WhereDefined => rule.with_facts_of(a, &operands[1]),
        }
    }
}

/// Encloses `op` and its [twin](zeroset_ops::OpRow::twin) over the same operand. Returns `None` if
/// the two share no work over the operand's range.
pub fn enclose_sincos<M: Machine>(
    m: &mut M,
    format: Format,
    op: Op,
    a: &Operand<M::V>,
) -> Option<[Enclosure<M::V>; 2]> {
    let mut rule = Rule { m, format };
    if op.row().twin.is_none() || !rule.is_near(a.range) {
        return None;
    }
    let [sin, cos] = rule.near_waves(a);
    Some(if op == Op::Sin { [sin, cos] } else { [cos, sin] })
}

/// The machine and the format with which a rule is evaluated.
pub(crate) struct Rule<'a, M> {
    pub(crate) m: &'a mut M,
    pub(crate) format: Format,
}

impl<M: Machine> Rule<'_, M> {
    pub(crate) fn number(&mut self, value: f64) -> M::V {
        self.m.number(self.format, value)
    }

    pub(crate) fn zero(&mut self) -> M::V {
        self.number(0.0)
    }

    pub(crate) fn infinity(&mut self) -> M::V {
        self.number(f64::INFINITY)
    }

    pub(crate) fn gt(&mut self, a: M::V, b: M::V) -> M::V {
        self.m.lt(b, a)
    }

    /// The float nearest to `number` in the format.
    fn nearest(&mut self, number: f64) -> M::V {
        self.number(self.format.pick(f64::from(number as f32), number))
    }

    /// A vector with only the sign bits set.
    fn sign_bit(&mut self) -> M::V {
        self.number(-0.0)
    }

    fn least_positive(&mut self) -> M::V {
        self.m.bits(self.format, 1)
    }

    fn not(&mut self, mask: M::V) -> M::V {
        let ones = self.m.bits(self.format, u64::MAX);
        self.m.xor(mask, ones)
    }

    /// Computes a + b, where `None` stands for 0.
    fn sum_of(&mut self, a: Option<M::V>, b: Option<M::V>) -> Option<M::V> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.m.add(a, b)),
            (a, b) => a.or(b),
        }
    }

    /// Replaces NaN in `a` by +∞.
    fn close(&mut self, a: M::V) -> M::V {
        let infinity = self.infinity();
        self.m.min(a, infinity)
    }

    /// The lower ends of `a`; a zero becomes +0.
    fn lo(&mut self, a: &Enclosure<M::V>) -> M::V {
        self.opposite_exactly(a.neg_lo)
    }

    /// Computes −a exactly; a zero becomes +0.
    fn opposite_exactly(&mut self, a: M::V) -> M::V {
        let zero = self.zero();
        self.m.sub(zero, a)
    }
}

#[cfg(test)]
mod tests {
    use zeroset_ops::{Op, TABLE};

    #[test]
    fn sine_and_cosine_are_the_only_twins() {
        let twins = TABLE.iter().filter_map(|row| Some((row.op, row.twin?)));
        assert_eq!(twins.collect::<Vec<_>>(), [(Op::Sin, Op::Cos), (Op::Cos, Op::Sin)]);
    }
}
