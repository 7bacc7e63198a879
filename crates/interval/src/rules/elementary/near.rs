//! Sine and cosine in `f32`, of operands that stay near 0 throughout: four lanes at a time where
//! [`approximator`](super::approximator) needs two halves of `f64`, and both functions from one
//! reduction.
//!
//! An angle is k·π/2 + s − n with a small correction n: the first part of π/2 has 17 bits and the
//! second 14, so that their products with k (7 bits) are exact, and so is all that leads to s and n
//! but the last product. No float up to [`NEAR_LIMIT`] is closer than 2⁻²⁶·⁴ to a multiple of π/2,
//! where n is 1.6 % of s.
//!
//! Results are a head, exact, and a tail, small: only their sum rounds at full size. The bounds on
//! the tails' errors are those of rounding up; every float up to the limit was tried with them (the
//! example `exhaustive`).

use super::Rule;
use crate::bounds::Interval;
use crate::enclosure::{Enclosure, Operand};
use crate::machine::{Format, Machine};

/// Operands up to this magnitude can be reduced: their k has 7 bits.
pub(crate) const NEAR_LIMIT: f64 = 192.0;

const F32: Format = Format::F32;

/// π/2 in three parts, the last rounded; they are compared with π in the tests.
const HALF_PI: [f64; 3] = [
    f64::from_bits(0x3ff9_21f0_0000_0000),
    f64::from_bits(0x3ee6_a880_0000_0000),
    f64::from_bits(0x3dd0_b461_2000_0000),
];

/// Adding 1.5·2²³ leaves integers in the low bits.
const INTEGER: f64 = 12_582_912.0;

/// A reduced angle.
struct Turned<V> {
    /// k in the low bits.
    bits: V,
    /// Whole quarter turns below the angle, in the low bits.
    quarters: V,
    /// s: what is left beside k quarter turns, less `correction`.
    rest: V,
    correction: V,
}

/// A value as head + tail, above the truth and below it by no more than the two slacks.
struct Estimate<V> {
    head: V,
    tail: V,
    slack: [V; 2],
}

/// Bounds of both functions at one end, and its quarter turns.
struct End<V> {
    sin: [V; 2],
    cos: [V; 2],
    quarters: V,
}

impl<M: Machine> Rule<'_, M> {
    /// Whether sine and cosine of `a` have this routine.
    pub(crate) fn is_near(&self, range: Interval) -> bool {
        let limit = Interval { lo: -NEAR_LIMIT, hi: NEAR_LIMIT };
        self.format == F32 && limit.encloses(range)
    }

    /// Sine and cosine of an operand for which [`Self::is_near`] holds.
    pub(crate) fn near_waves(&mut self, a: &Operand<M::V>) -> [Enclosure<M::V>; 2] {
        let lo = self.m.neg(a.value.neg_lo);
        let (lo, hi) = (self.near_end(lo), self.near_end(a.value.hi));
        // The ends of quarter turns between the two ends: those congruent to 1 modulo 4 are maxima
        // of the sine, then come, in turn, minima of the cosine, of the sine, maxima of the cosine.
        // All numbers compared are integers, read as the subnormal floats with these bits.
        let passed = self.m.int_sub(hi.quarters, lo.quarters);
        let [zero, one, two, three] = [0, 1, 2, 3].map(|bits| self.m.bits(F32, bits));
        let [to_first, to_second] = [zero, one].map(|from| {
            let distance = self.m.int_sub(from, lo.quarters);
            self.m.and(distance, three)
        });
        let [to_third, to_fourth] = [to_first, to_second].map(|to| self.m.xor(to, two));
        let [max_sin, min_cos, min_sin, max_cos] =
            [to_first, to_second, to_third, to_fourth].map(|distance| self.m.lt(distance, passed));
        let sin = self.near_wave([lo.sin, hi.sin], [min_sin, max_sin]);
        let cos = self.near_wave([lo.cos, hi.cos], [min_cos, max_cos]);
        [sin, cos].map(|[neg_lo, hi]| Enclosure { neg_lo, hi, ..a.value })
    }

    /// Sine and cosine of one number up to the limit.
    pub(crate) fn near_waves_of_point(&mut self, x: M::V) -> [Enclosure<M::V>; 2] {
        let End { sin, cos, .. } = self.near_end(x);
        let one = self.number(1.0);
        [sin, cos].map(|bounds| {
            let [neg_lo, hi] = bounds.map(|bound| self.m.min(bound, one));
            Enclosure::total(neg_lo, hi)
        })
    }

    /// (−lo, hi) over the interval from those at its ends, and from where it has a minimum and a
    /// maximum.
    fn near_wave(&mut self, [at_lo, at_hi]: [[M::V; 2]; 2], extrema: [M::V; 2]) -> [M::V; 2] {
        let one = self.number(1.0);
        std::array::from_fn(|i| {
            let bound = self.m.max(at_lo[i], at_hi[i]);
            let bound = self.m.min(bound, one);
            self.m.select(extrema[i], one, bound)
        })
    }

    /// Sine and cosine at points up to the limit.
    pub(crate) fn near_waves_at(&mut self, a: M::V) -> [M::V; 2] {
        let turned = self.near_reduce(a);
        let values = self.near_sums(&turned).map(|sum| [self.m.add(sum.head, sum.tail)]);
        let [sin, cos] = self.turn_back(&turned, values);
        [sin, cos].map(|([value], sign)| {
            let mask = self.m.bits(F32, 1 << 31);
            let sign = self.m.and(sign, mask);
            self.m.xor(value, sign)
        })
    }

    fn near_end(&mut self, x: M::V) -> End<M::V> {
        let turned = self.near_reduce(x);
        let bounds = self.near_sums(&turned).map(|Estimate { head, tail, slack }| {
            let above = self.m.add(tail, slack[1]);
            let below = self.m.sub(slack[0], tail);
            [self.m.sub(below, head), self.m.add(head, above)]
        });
        let [sin, cos] = self.turn_back(&turned, bounds).map(|([neg_lo, hi], sign)| {
            [self.m.select_signed(sign, hi, neg_lo), self.m.select_signed(sign, neg_lo, hi)]
        });
        End { sin, cos, quarters: turned.quarters }
    }

    fn near_reduce(&mut self, x: M::V) -> Turned<M::V> {
        let two_over_pi = self.number(f64::from(std::f32::consts::FRAC_2_PI));
        let quarters = self.m.mul(x, two_over_pi);
        let k = self.m.nearest(quarters);
        let [first, second, third] = HALF_PI.map(|part| {
            let part = self.number(part);
            self.m.mul(k, part)
        });
        let near = self.m.sub(x, first);
        let rest = self.m.sub(near, second);
        // rest − near is exact, and so is what rounding added to `rest`.
        let moved = self.m.sub(rest, near);
        let added = self.m.add(second, moved);
        let correction = self.m.add(added, third);
        let magic = self.number(INTEGER);
        let bits = self.m.add(k, magic);
        let zero = self.zero();
        let before = self.m.lt(rest, zero); // a set mask is −1
        let quarters = self.m.int_add(bits, before);
        Turned { bits, quarters, rest, correction }
    }

    /// Sine and cosine of s − n, |s| ≤ 0.786.
    fn near_sums(&mut self, turned: &Turned<M::V>) -> [Estimate<M::V>; 2] {
        let Turned { rest: s, correction: n, .. } = *turned;
        let z = self.m.mul(s, s);
        // cos s = 1 − z/2 + z²(1/24 − …); n·s stands for n·sin s.
        let half = self.number(0.5);
        let (one, half) = (self.number(1.0), self.m.mul(z, half));
        let nearly = self.m.sub(one, half);
        let series = self.near_series(z, COS_SERIES);
        let fourth = self.m.mul(z, z);
        let fourth = self.m.mul(fourth, series);
        let moved = self.m.mul(n, s);
        let tail = self.m.add(fourth, moved);
        let slack = COS_SLACK.map(|slack| self.number(slack));
        let cos = Estimate { head: nearly, tail, slack };
        // sin s = s − s·z(1/6 − …); n·(1 − z/2) stands for n·cos s.
        let cube = self.m.mul(s, z);
        let series = self.near_series(z, SIN_SERIES);
        let product = self.m.mul(cube, series);
        let moved = self.m.mul(n, nearly);
        let tail = self.m.sub(product, moved);
        let (share, magnitude) = (self.number(SIN_SLACK), self.m.abs(s));
        let slack = self.m.mul(magnitude, share);
        [Estimate { head: s, tail, slack: [slack; 2] }, cos]
    }

    /// Sine and cosine from those of the rest, values or bounds, each to be negated where the sign
    /// bit beside it is set.
    fn turn_back<const N: usize>(
        &mut self,
        turned: &Turned<M::V>,
        [sin, cos]: [[M::V; N]; 2],
    ) -> [([M::V; N], M::V); 2] {
        // By bits 0 and 1 of k, and of k + 1 for the cosine: moved to the sign bit, they choose.
        let odd = self.m.shift_left(turned.bits, 31);
        let one = self.m.bits(F32, 1);
        let next = self.m.int_add(turned.bits, one);
        [(cos, sin, turned.bits), (sin, cos, next)].map(|(if_odd, if_even, bits)| {
            let sign = self.m.shift_left(bits, 30);
            let value = std::array::from_fn(|i| self.m.select_signed(odd, if_odd[i], if_even[i]));
            (value, sign)
        })
    }

    /// c₀ + z(c₁ + z·c₂).
    fn near_series(&mut self, z: M::V, coefficients: [f32; 3]) -> M::V {
        let [c0, c1, c2] = coefficients.map(|c| self.number(f64::from(c)));
        let product = self.m.mul(z, c2);
        let sum = self.m.add(product, c1);
        let product = self.m.mul(sum, z);
        self.m.add(product, c0)
    }
}

/// (cos s − 1 + z/2)/z² and (sin s − s)/s³ as parabolas in z = s² ≤ 0.618: those for which the
/// largest error that they make in the cosine and sine is least, found by reweighted least squares:
/// 2⁻³¹ and 2⁻²⁸·⁵.
const COS_SERIES: [f32; 3] = [0.041_666_646, -0.001_388_736_2, 2.443_777_5e-5];
const SIN_SERIES: [f32; 3] = [-0.166_666_51, 0.008_331_974, -0.000_194_949_93];

/// How far the cosine's sum may be above the truth and below it, in units of 2⁻²⁴ = ulp(cos s). For
/// z ≥ ½, −z/2 is a multiple of ½ and too low by less than that, so that 1 − z/2 is too high by ½
/// at most, and the tail adds less than ¼; for smaller z, 1 − z/2 is too high by less than 1 − z/4,
/// −z/2 too low by less than ¼, the tail wrong by less than z/4.
const COS_SLACK: [f64; 2] = [1.0 / (1 << 24) as f64, 0.75 / (1 << 24) as f64];
/// A bound on the error of the sine's tail, in parts of |s|.
const SIN_SLACK: f64 = 0.75 / (1 << 24) as f64;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_half_pi_make_up_half_pi() {
        // Its first 121 bits: OEIS A062964, halved.
        let half_pi = 0x192_1fb5_4442_d184_6989_8cc5_1701_b839_u128;
        let scaled = |part: f64| (part * 2_f64.powi(120)) as u128;
        let sum: u128 = HALF_PI.iter().map(|part| scaled(*part)).sum();
        assert!(sum.abs_diff(half_pi) < 1 << (120 - 59));
        for part in HALF_PI {
            assert_eq!(f64::from(part as f32), part);
        }
        let bits = |part: f64| 53 - part.to_bits().trailing_zeros();
        assert!(HALF_PI[..2].iter().all(|part| bits(*part) <= 17));
    }
}
