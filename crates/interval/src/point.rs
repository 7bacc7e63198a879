//! Values of operations at points, written once over [`Machine`].
//!
//! The values have no error bounds: they shade pictures and start searches. A value is NaN if the
//! operation is undefined, or infinite at a pole.

use crate::bounds::Interval;
use crate::enclosure::Exponent;
use crate::machine::{Format, Machine};
use crate::rules::{Approximation, Approximator, Base, HalfPi, Reach, Rule, by_halves};
use zeroset_ops::Op;

/// Evaluates `op` at points, given as lanes of operands in `format`. `exponent` is the last
/// operand's kind as an exponent.
///
/// # Panics
/// If the number of operands is not the arity of `op`.
pub fn evaluate<M: Machine>(
    m: &mut M,
    format: Format,
    op: Op,
    operands: &[M::V],
    exponent: Exponent,
) -> M::V {
    assert_eq!(operands.len(), op.arity(), "{op:?}");
    let mut rule = Rule { m, format };
    let a = operands[0];
    match op {
        Op::Neg => rule.m.neg(a),
        Op::Abs => rule.m.abs(a),
        Op::Sign => rule.sign_of(a),
        Op::Floor => rule.m.floor(a),
        Op::Ceil => rule.m.ceil(a),
        Op::Round => rule.m.nearest(a),
        Op::Trunc => rule.m.trunc(a),
        Op::Fract => {
            let floor = rule.m.floor(a);
            rule.m.sub(a, floor)
        }
        Op::Sqr => rule.m.mul(a, a),
        Op::Sqrt => {
            // If a is −0, its root is −0, whose reciprocal would have the wrong sign.
            let root = rule.m.sqrt(a);
            rule.m.abs(root)
        }
        Op::Cbrt => rule.near_at(a, |approx, a| approx.cbrt(a)),
        Op::Exp => rule.at_halves(a, |approx, a| approx.exp_near(a)),
        Op::Ln => rule.logarithm_at(a, Base::E),
        Op::Log2 => rule.logarithm_at(a, Base::Two),
        Op::Log10 => rule.logarithm_at(a, Base::Ten),
        Op::Sin => rule.angle_at(a, |approx, a, half_pi| approx.sin(a, half_pi).0),
        Op::Cos => rule.angle_at(a, |approx, a, half_pi| approx.cos(a, half_pi).0),
        Op::Tan => rule.angle_at(a, |approx, a, half_pi| approx.tan(a, half_pi).0),
        Op::Asin => rule.within_one_at(a, true, |approx, a| approx.asin(a)),
        Op::Acos => rule.within_one_at(a, true, |approx, a| approx.acos(a)),
        Op::Atan => rule.near_at(a, |approx, a| approx.atan(a)),
        Op::Sinh => rule.near_at(a, |approx, a| approx.sinh(a)),
        Op::Cosh => rule.near_at(a, |approx, a| approx.cosh(a)),
        Op::Tanh => rule.near_at(a, |approx, a| approx.tanh(a)),
        Op::Asinh => rule.unbounded_at(a, |approx, a| approx.asinh(a)),
        Op::Acosh => {
            let value = rule.unbounded_at(a, |approx, a| approx.acosh(a));
            let one = rule.number(1.0);
            let inside = rule.m.le(one, a);
            rule.nan_unless(inside, value)
        }
        Op::Atanh => rule.within_one_at(a, false, |approx, a| approx.atanh(a)),
        Op::Erf => rule.near_at(a, |approx, a| approx.erf(a)),
        Op::BesselJ0 | Op::BesselJ1 | Op::BesselJ2 | Op::BesselJ3 => {
            rule.bessel_at(a, op.bessel_order())
        }
        Op::Add => rule.m.add(a, operands[1]),
        Op::Sub => rule.m.sub(a, operands[1]),
        Op::Mul => rule.m.mul(a, operands[1]),
        Op::Div => rule.m.div(a, operands[1]),
        Op::Pow => rule.power_at(a, operands[1], exponent),
        Op::Mod => {
            let quotient = rule.m.div(a, operands[1]);
            let cells = rule.m.floor(quotient);
            let multiple = rule.m.mul(operands[1], cells);
            rule.m.sub(a, multiple)
        }
        Op::Atan2 => rule.angle_of(a, operands[1]),
        // The result is NaN if either operand is NaN. `min` and `max` alone would drop the NaN.
        Op::Min => {
            let least = rule.m.min(a, operands[1]);
            rule.nan_where_unordered(least, a, operands[1])
        }
        Op::Max => {
            let most = rule.m.max(a, operands[1]);
            rule.nan_where_unordered(most, a, operands[1])
        }
        Op::SelectNegative => {
            let zero = rule.zero();
            let negative = rule.m.lt(a, zero);
            let nonneg = rule.m.le(zero, a);
            let rest = rule.nan_unless(nonneg, operands[2]);
            rule.m.select(negative, operands[1], rest)
        }
        Op::Otherwise => {
            let is_number = rule.m.eq(a, a);
            rule.m.select(is_number, a, operands[1])
        }
        Op::WhereNonneg => {
            let zero = rule.zero();
            let inside = rule.m.le(zero, operands[1]);
            rule.nan_unless(inside, a)
        }
        Op::WherePositive => {
            let zero = rule.zero();
            let inside = rule.m.lt(zero, operands[1]);
            rule.nan_unless(inside, a)
        }
        Op::WhereNonzero => {
            let zero = rule.zero();
            let magnitude = rule.m.abs(operands[1]);
            let inside = rule.m.lt(zero, magnitude);
            rule.nan_unless(inside, a)
        }
        Op::WhereDefined => {
            let inside = rule.m.eq(operands[1], operands[1]);
            rule.nan_unless(inside, a)
        }
    }
}

/// Evaluates `op` and its [twin](zeroset_ops::OpRow::twin) at points. Their operand lies in
/// `range`. Returns `None` if the two share no work in that range.
pub fn evaluate_sincos<M: Machine>(
    m: &mut M,
    format: Format,
    op: Op,
    a: M::V,
    range: Interval,
) -> Option<[M::V; 2]> {
    let mut rule = Rule { m, format };
    if op.row().twin.is_none() || !rule.is_near(range) {
        return None;
    }
    let [sin, cos] = rule.near_waves_at(a);
    Some(if op == Op::Sin { [sin, cos] } else { [cos, sin] })
}

impl<M: Machine> Rule<'_, M> {
    fn nan_unless(&mut self, mask: M::V, value: M::V) -> M::V {
        let nan = self.nan();
        self.m.select(mask, value, nan)
    }

    fn nan(&mut self) -> M::V {
        // A quiet NaN with fixed bits. So arithmetic with it gives the same bits on every machine.
        let bits = self.format.pick(u64::from(f32::NAN.to_bits()), f64::NAN.to_bits());
        self.m.bits(self.format, bits)
    }

    fn nan_where_unordered(&mut self, value: M::V, a: M::V, b: M::V) -> M::V {
        let (a_is, b_is) = (self.m.eq(a, a), self.m.eq(b, b));
        let ordered = self.m.and(a_is, b_is);
        self.nan_unless(ordered, value)
    }

    /// Applies an elementary routine at points. The result at NaN is NaN.
    fn at_halves(
        &mut self,
        a: M::V,
        mut f: impl FnMut(&mut Approximator<'_, M>, M::V) -> M::V,
    ) -> M::V {
        let [value] = by_halves(self.m, self.format, [a], |approx, [a]| [f(approx, a)]);
        let is_number = self.m.eq(a, a);
        self.nan_unless(is_number, value)
    }

    /// Applies a routine to the numbers of all lanes, and returns the approximate values.
    fn near_at(
        &mut self,
        a: M::V,
        mut f: impl FnMut(&mut Approximator<'_, M>, M::V) -> Approximation<M::V>,
    ) -> M::V {
        self.at_halves(a, |approx, a| {
            let near = f(approx, a);
            approx.value(&near)
        })
    }

    /// Applies a routine for finite operands. At an infinite operand, the result is that operand.
    fn unbounded_at(
        &mut self,
        a: M::V,
        f: impl FnMut(&mut Approximator<'_, M>, M::V) -> Approximation<M::V>,
    ) -> M::V {
        let value = self.near_at(a, f);
        let (magnitude, infinity) = (self.m.abs(a), self.infinity());
        let unbounded = self.m.eq(magnitude, infinity);
        self.m.select(unbounded, a, value)
    }

    /// Applies a routine for operands from −1 to 1. The ends belong to its domain if `closed`.
    fn within_one_at(
        &mut self,
        a: M::V,
        closed: bool,
        f: impl FnMut(&mut Approximator<'_, M>, M::V) -> Approximation<M::V>,
    ) -> M::V {
        let value = self.near_at(a, f);
        let (magnitude, one) = (self.m.abs(a), self.number(1.0));
        let inside = if closed { self.m.le(magnitude, one) } else { self.m.lt(magnitude, one) };
        self.nan_unless(inside, value)
    }

    /// The angle of the point (b, a). It is NaN at the origin, and where a or b is NaN.
    fn angle_of(&mut self, a: M::V, b: M::V) -> M::V {
        let zero = self.zero();
        // Adding 0 turns −0 into +0, which counts as above the x-axis and right of the y-axis.
        let (a, b) = (self.m.add(a, zero), self.m.add(b, zero));
        let [value] = by_halves(self.m, self.format, [a, b], |approx, [a, b]| {
            let near = approx.angle(a, b);
            [approx.value(&near)]
        });
        let value = self.nan_where_unordered(value, a, b);
        let (a, b) = (self.m.abs(a), self.m.abs(b));
        let far = self.m.max(a, b);
        let off_origin = self.gt(far, zero);
        self.nan_unless(off_origin, value)
    }

    fn logarithm_at(&mut self, a: M::V, base: Base) -> M::V {
        let value = self.near_at(a, |approx, a| approx.ln(a, base));
        let (zero, infinity) = (self.zero(), self.infinity());
        let unbounded = self.m.eq(a, infinity);
        let value = self.m.select(unbounded, infinity, value);
        let positive = self.gt(a, zero);
        self.nan_unless(positive, value)
    }

    /// Applies a routine to angles. NaN where an angle is too large to be reduced.
    fn angle_at(
        &mut self,
        a: M::V,
        f: impl Fn(&mut Approximator<'_, M>, M::V, &HalfPi) -> Approximation<M::V>,
    ) -> M::V {
        let half_pi = HalfPi::for_angles(Interval::ENTIRE);
        let value = self.near_at(a, |approx, a| f(approx, a, half_pi));
        self.nan_beyond(a, half_pi, value)
    }

    fn bessel_at(&mut self, a: M::V, order: usize) -> M::V {
        let half_pi = HalfPi::for_angles(Interval::ENTIRE);
        let value = self.near_at(a, |approx, a| approx.bessel(order, a, &Reach::Anywhere(half_pi)));
        self.nan_beyond(a, half_pi, value)
    }

    /// NaN where the angle `a` is too large to be reduced, else `value`.
    fn nan_beyond(&mut self, a: M::V, half_pi: &HalfPi, value: M::V) -> M::V {
        let magnitude = self.m.abs(a);
        let limit = self.number(half_pi.limit(self.format));
        let near = self.m.le(magnitude, limit);
        self.nan_unless(near, value)
    }

    /// The power aᵇ at points.
    fn power_at(&mut self, a: M::V, b: M::V, exponent: Exponent) -> M::V {
        match exponent {
            Exponent::Integer(n) if n < 0 => {
                let power = self.integer_power_at(a, n.unsigned_abs());
                let one = self.number(1.0);
                self.m.div(one, power)
            }
            Exponent::Integer(n) => self.integer_power_at(a, n.unsigned_abs()),
            Exponent::LargeInteger { odd } => {
                let magnitude = self.m.abs(a);
                let power = self.real_power_at(magnitude, b);
                let sign = self.sign_of(a);
                if odd { self.m.mul(sign, power) } else { power }
            }
            Exponent::Real => self.real_power_at(a, b),
        }
    }

    /// The power aⁿ at points.
    fn integer_power_at(&mut self, a: M::V, n: u32) -> M::V {
        if n > 0 {
            return self.by_squaring(
                a,
                n,
                |rule, a, b| rule.m.mul(a, b),
                |rule, a| rule.m.mul(a, a),
            );
        }
        let one = self.number(1.0);
        let is_number = self.m.eq(a, a);
        self.nan_unless(is_number, one)
    }

    /// The power aᵇ at points. NaN for a < 0, and for a = 0 unless b > 0.
    fn real_power_at(&mut self, a: M::V, b: M::V) -> M::V {
        let zero = self.zero();
        let [value] = by_halves(self.m, self.format, [a, b], |approx, [a, b]| {
            let ln = approx.ln(a, Base::E).sum;
            let exponent = approx.times_limited(ln, b);
            [approx.exp_near(exponent)]
        });
        let positive = self.gt(a, zero);
        let exponent_is_number = self.m.eq(b, b);
        let defined = self.m.and(positive, exponent_is_number);
        let value = self.nan_unless(defined, value);
        // 0^b is 0 for b > 0.
        let is_zero = self.m.eq(a, zero);
        let up = self.gt(b, zero);
        let at_zero = self.m.and(is_zero, up);
        self.m.select(at_zero, zero, value)
    }
}
