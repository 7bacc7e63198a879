//! Rules of squares, roots and powers.

use super::Rule;
use super::elementary::approximator::by_halves;
use super::elementary::logarithm::Base;
use crate::bounds::Interval;
use crate::branch::Branch;
use crate::enclosure::{Claims, Enclosure, Exponent, Operand, Sign};
use crate::machine::{Format, Machine};

impl<M: Machine> Rule<'_, M> {
    pub(super) fn sqr(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let neg_mig = self.neg_mignitude(a);
        let mag = self.magnitude(a);
        a.value.facts.with(self.square_nonneg([neg_mig, mag]))
    }

    /// Bounds of the square of a number ≥ 0. Operand and result are [−lo, hi].
    fn square_nonneg(&mut self, [neg_lo, hi]: [M::V; 2]) -> [M::V; 2] {
        let lo = self.m.neg(neg_lo);
        [self.m.mul(neg_lo, lo), self.m.mul(hi, hi)]
    }

    pub(super) fn sqrt(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let zero = self.zero();
        let (mut lo, mut hi) = (self.lo(&a.value), a.value.hi);
        if a.range.lo < 0.0 {
            lo = self.m.max(lo, zero);
            hi = self.m.max(hi, zero);
        }
        let hi = self.m.sqrt(hi);
        // The root `up` is rounded up. If its square exceeds the operand, `up` is one float too
        // high for a lower bound. Else `up` is exact.
        let up = self.m.sqrt(lo);
        let square = self.m.mul(up, up);
        let inexact = self.m.lt(lo, square);
        let down = self.m.int_add(up, inexact); // a set mask is −1
        let neg_lo = self.m.neg(down);
        let own = self.nonneg(a);
        a.value.facts.and(self.m, &own).with([neg_lo, hi])
    }

    pub(super) fn pow(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
        branch: Branch,
    ) -> Enclosure<M::V> {
        let value = match b.exponent {
            Exponent::Real => return self.real_power(a, b),
            Exponent::Integer(n) if n < 0 => {
                let base = self.divisor(a, branch);
                self.reciprocal_power(&base, n.unsigned_abs())
            }
            Exponent::Integer(n) => self.integer_power(a, n.unsigned_abs()),
            Exponent::LargeInteger { odd } => self.large_power(a, b, odd),
        };
        // A constant exponent may come from an expression that is undefined in part of the box.
        self.with_facts_of(&Operand::new(value, Interval::ENTIRE), b)
    }

    fn integer_power(&mut self, a: &Operand<M::V>, n: u32) -> Enclosure<M::V> {
        match n {
            0 => {
                let (one, minus_one) = (self.number(1.0), self.number(-1.0));
                let facts = a.value.facts;
                Claims { continuous: facts.defined, ..facts }.with([minus_one, one])
            }
            1 => a.value,
            n if n % 2 == 0 => {
                let neg_mig = self.neg_mignitude(a);
                let mag = self.magnitude(a);
                a.value.facts.with(self.power_nonneg([neg_mig, mag], n))
            }
            n => {
                let ends = [a.value.neg_lo, a.value.hi];
                a.value.facts.with(match a.sign() {
                    Sign::Nonneg => self.power_nonneg(ends, n),
                    Sign::Nonpos => {
                        let [lo, neg_hi] = self.power_nonneg([ends[1], ends[0]], n);
                        [neg_hi, lo]
                    }
                    Sign::Unknown => ends.map(|end| self.odd_power_up(end, n)),
                })
            }
        }
    }

    /// Encloses aⁿ for |n| ≥ 2³¹: |a|ⁿ for even n, and a·|a|ⁿ⁻¹ for odd n.
    fn large_power(&mut self, a: &Operand<M::V>, n: &Operand<M::V>, odd: bool) -> Enclosure<M::V> {
        let range = Interval { lo: 0.0, hi: a.range.magnitude() };
        let magnitude = Operand::new(self.abs(a), range);
        let mut exponent = Operand::new(n.value, Interval::ENTIRE);
        if odd {
            let (one, minus_one) = (self.number(1.0), self.number(-1.0));
            exponent.value.neg_lo = self.m.add(n.value.neg_lo, one);
            exponent.value.hi = self.m.add(n.value.hi, minus_one);
        }
        let (neg_lo, hi) = self.real_power_ends(&magnitude, &exponent);
        let mut value = Enclosure { neg_lo, hi, ..a.value };
        if odd {
            let range = Interval { lo: 0.0, hi: f64::INFINITY };
            value = self.mul(a, &Operand::new(value, range));
        }
        if n.range.lo > 0.0 {
            return value;
        }
        let own = self.nonzero(a);
        value.restricted(self.m, &own)
    }

    /// Encloses 1/aⁿ.
    fn reciprocal_power(&mut self, a: &Operand<M::V>, n: u32) -> Enclosure<M::V> {
        let value = self.integer_power(a, n);
        // The base decides where 1/aⁿ is defined, because the range of aⁿ is not known here.
        let own = self.nonzero(a);
        let power = Operand::new(value, Interval::ENTIRE);
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        let one = Operand::new(Enclosure::total(minus_one, one), Interval::ONE);
        let quotient = self.div(&one, &power);
        value.facts.and(self.m, &own).with([quotient.neg_lo, quotient.hi])
    }

    /// Bounds of the n-th power of a number ≥ 0, for n ≥ 1. Operand and result are [−lo, hi]. No
    /// product is 0·∞: lower ends are finite, and the powers of an upper end are all 0 or all
    /// positive.
    fn power_nonneg(&mut self, ends: [M::V; 2], n: u32) -> [M::V; 2] {
        let times = |rule: &mut Self, [neg_lo, hi]: [M::V; 2], other: [M::V; 2]| {
            let low = rule.m.neg(other[0]);
            [rule.m.mul(neg_lo, low), rule.m.mul(hi, other[1])]
        };
        self.by_squaring(ends, n, times, Self::square_nonneg)
    }

    /// The n-th power for n ≥ 1, by repeated squaring. `times` multiplies, `squared` squares.
    pub(crate) fn by_squaring<T: Copy>(
        &mut self,
        base: T,
        n: u32,
        times: impl Fn(&mut Self, T, T) -> T,
        squared: impl Fn(&mut Self, T) -> T,
    ) -> T {
        let (mut result, mut square, mut rest) = (None, base, n);
        loop {
            if rest & 1 == 1 {
                result = Some(match result {
                    None => square,
                    Some(result) => times(self, result, square),
                });
            }
            rest >>= 1;
            match result {
                Some(result) if rest == 0 => return result,
                _ => square = squared(self, square),
            }
        }
    }

    /// Computes aⁿ rounded up, for odd n ≥ 3 and a of any sign.
    fn odd_power_up(&mut self, a: M::V, n: u32) -> M::V {
        let magnitude = self.m.abs(a);
        let negated = self.m.neg(magnitude);
        let [neg_lo, hi] = self.power_nonneg([negated, magnitude], n - 1);
        let lo = self.m.neg(neg_lo);
        // The result is the larger of a·lo and a·hi, where lo and hi bound |a|ⁿ⁻¹. No product is
        // 0·∞, because lo is finite and hi is ∞ only for a ≠ 0.
        let far = self.m.mul(a, hi);
        let near = self.m.mul(a, lo);
        self.m.max(far, near)
    }

    /// Encloses exp(b·ln a), and 0^b = 0 for b > 0.
    fn real_power(&mut self, a: &Operand<M::V>, b: &Operand<M::V>) -> Enclosure<M::V> {
        let (neg_lo, hi) = if a.range.hi > 0.0 {
            self.real_power_ends(a, b)
        } else {
            // No base is positive, so 0 is the only possible value.
            (self.zero(), self.zero())
        };
        let value = self.combine(neg_lo, hi, a, b);
        // The power is defined for a > 0, and for a = 0 if b > 0.
        let (positive, nonneg, up) = (self.positive(a), self.nonneg(a), self.positive(b));
        let nowhere = positive.nowhere.and(self.m, up.nowhere);
        let nowhere = nowhere.or(self.m, nonneg.nowhere);
        let throughout = nonneg.defined.and(self.m, up.defined);
        let throughout = throughout.or(self.m, positive.defined);
        value.restricted(self.m, &Claims::of_domain(nowhere, throughout))
    }

    /// Bounds of a power as −lo and hi, for a base that may be positive.
    /// Both formats compute in `f64`.
    fn real_power_ends(&mut self, a: &Operand<M::V>, b: &Operand<M::V>) -> (M::V, M::V) {
        // For a base that reaches 0, the logarithm starts at the least positive number. The result
        // is corrected below.
        let [base_lo, base_hi] = self.positive_ends(a);
        let bounded = a.range.hi < f64::INFINITY;
        // The range contains the logarithm of every positive `f32`.
        let ln_range = Interval { lo: -104.0, hi: if bounded { 89.0 } else { f64::INFINITY } };
        let base_hi = if self.format == Format::F64 && !bounded {
            let finite = self.number(f64::MAX); // corrected below
            self.m.min(base_hi, finite)
        } else {
            base_hi
        };
        let ends = [base_lo, base_hi, b.value.neg_lo, b.value.hi];
        let [mut neg_lo, mut hi] = by_halves(self.m, self.format, ends, |approx, ends| {
            if approx.target == Format::F64 {
                return approx.power([ends[0], ends[1]], [ends[2], ends[3]]);
            }
            let (at_lo, at_hi) = (approx.ln(ends[0], Base::E), approx.ln(ends[1], Base::E));
            let (neg_lo, mut hi) = (approx.negated_lower(&at_lo), approx.upper(&at_hi));
            if !bounded {
                let infinity = approx.m.number(Format::F64, f64::INFINITY);
                let unbounded = approx.m.eq(ends[1], infinity);
                hi = approx.m.select(unbounded, infinity, hi);
            }
            let ln = Operand::new(Enclosure::total(neg_lo, hi), ln_range);
            let b = Operand::new(Enclosure::total(ends[2], ends[3]), b.range);
            let exponent = Rule { m: approx.m, format: Format::F64 }.mul(&b, &ln);
            approx.exp([exponent.neg_lo, exponent.hi])
        });
        let zero = self.zero();
        if self.format == Format::F64 && !bounded {
            // As the base grows, powers grow without bound if b > 0, and tend to 0 if b < 0.
            let infinity = self.infinity();
            let unbounded = self.m.eq(a.value.hi, infinity);
            let (some_positive, some_negative) =
                (self.gt(b.value.hi, zero), self.gt(b.value.neg_lo, zero));
            let grows = self.m.and(unbounded, some_positive);
            hi = self.m.select(grows, infinity, hi);
            let vanishes = self.m.and(unbounded, some_negative);
            let neg_lo_zero = self.m.max(neg_lo, zero);
            neg_lo = self.m.select(vanishes, neg_lo_zero, neg_lo);
        }
        if a.range.lo <= 0.0 {
            // 0^b is 0 for b > 0. As the base tends to 0, powers grow without bound if b < 0. If b
            // ≥ 0, they are between 0 and the power of the least positive base.
            let from_zero = self.m.le(zero, a.value.neg_lo);
            let some_positive = self.gt(b.value.hi, zero);
            let starts = self.m.and(from_zero, some_positive);
            let neg_lo_zero = self.m.max(neg_lo, zero);
            neg_lo = self.m.select(starts, neg_lo_zero, neg_lo);
            let some_negative = self.gt(b.value.neg_lo, zero);
            let grows = self.m.and(from_zero, some_negative);
            let infinity = self.infinity();
            hi = self.m.select(grows, infinity, hi);
            // In the lanes of `only_zero`, the base is 0. If 0^b is undefined, its bounds stay
            // within those over larger boxes, which have positive bases.
            let no_positive = self.m.le(a.value.hi, zero);
            let only_zero = self.m.and(no_positive, some_positive);
            hi = self.m.select(only_zero, zero, hi);
        }
        (neg_lo, hi)
    }
}

#[cfg(test)]
mod tests {
    use crate::{Decorated, Exponent, Facts, Interval, fold};
    use zeroset_ops::Op;

    /// Encloses a power of [lo, hi] whose exponent does not fit `i32`.
    fn power(lo: f64, hi: f64, n: i64) -> ([f64; 2], Facts) {
        let bounds = Interval::point(n as f64).expect("finite");
        let exponent = Exponent::LargeInteger { odd: n % 2 != 0 };
        let base = Decorated::from((Interval::new(lo, hi).expect("in order"), Facts::TOTAL));
        let n = Decorated { bounds, facts: Facts::TOTAL, exponent };
        let (bounds, facts) = fold(Op::Pow, &[base, n]);
        ([bounds.lo, bounds.hi], facts)
    }

    #[test]
    fn large_integer_powers_are_bounded() {
        let even = 1 << 31;
        let ([lo, hi], facts) = power(-1.0, 1.0, even);
        assert!(lo == 0.0 && (1.0..1.0 + 1e-15).contains(&hi) && facts == Facts::TOTAL);
        let ([lo, hi], facts) = power(-1.0, 1.0, even + 1);
        assert!((lo + 1.0).abs() < 1e-15 && (hi - 1.0).abs() < 1e-15 && facts == Facts::TOTAL);
        let ([lo, hi], _) = power(1.0, 1.0, -even);
        assert!(lo <= 1.0 && 1.0 <= hi && hi - lo < 1e-15, "{lo} {hi}");
        assert_eq!(power(-2.0, -2.0, even + 1).0, [f64::NEG_INFINITY, -f64::MAX]);
        assert_eq!(power(-0.5, 0.5, even).0, [0.0, f64::from_bits(1)]);
        // (1 + 2⁻⁵²)^2³¹ is about 1 + 2⁻²¹ + 2⁻⁴³.
        let near = 1.0 + f64::EPSILON;
        let [lo, hi] = power(near, near, even).0;
        let value = 1.0 + 2_f64.powi(-21) + 2_f64.powi(-43);
        assert!(lo <= value && value <= hi && hi - lo < 1e-15, "{lo} {hi}");
    }

    #[test]
    fn large_negative_powers_have_a_pole() {
        let n = -(1_i64 << 40);
        assert_eq!(power(0.0, 0.0, n).1, Facts::NOWHERE);
        assert_eq!(power(-1.0, 1.0, n).1, Facts::NONE);
        assert_eq!(power(0.5, 0.5, n), ([f64::MAX, f64::INFINITY], Facts::TOTAL));
        assert_eq!(power(-0.5, -0.5, n + 1).0, [f64::NEG_INFINITY, -0.5 * f64::MAX]);
        let ([lo, hi], _) = power(-1.0, 1.0, n + 1);
        assert_eq!([lo, hi], [f64::NEG_INFINITY, f64::INFINITY]);
    }
}
