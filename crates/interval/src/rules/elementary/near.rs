//! Sine and cosine of operands near 0, both from one reduction. In `f32` this routine computes four
//! lanes at a time, whereas [`approximator`](super::approximator) needs two vectors of `f64`.
//!
//! An angle is k·π/2 + s − n with a small correction n. The first two parts of π/2 have so few bits
//! that their products with k are exact. So every step to s and n is exact except the last product.
//! No `f32` up to the limit is closer than 2⁻²⁶·⁴ to a multiple of π/2, where n is 1.6 % of s. No
//! `f64` is closer than 2⁻⁶⁰·⁵, where n is below 2⁻¹⁴ of s.
//!
//! A result is an exact head and a small tail, so only their sum rounds at full size. The bounds on
//! the tails' errors assume rounding up. The example `exhaustive` has tested them for every `f32`
//! up to the limit.

use super::Rule;
use crate::bounds::Interval;
use crate::enclosure::{Enclosure, Operand};
use crate::machine::Machine;

/// The constants of one format.
struct NearConstants {
    /// Largest magnitude of an operand for which this file's routines work.
    limit: f64,
    /// Least width of a range for these routines. Operands with a narrower range are almost
    /// constant and rarely evaluated. They use the slower routines, which are tighter.
    narrow: f64,
    /// π/2 in three parts, of which the last is rounded. The tests compare the parts with π.
    half_pi: [f64; 3],
    /// The number 1.5·2²³ or 1.5·2⁵². Adding it to an integer puts the integer into the low bits.
    integer: f64,
    /// Polynomial in z = s² ≤ 0.618 for (cos s − 1 + z/2)/z²; `sin` is one for (sin s − s)/s³. They
    /// minimize the largest errors of cosine and sine.
    cos: &'static [f64],
    sin: &'static [f64],
    /// Half a unit in the last place of 1.
    half_ulp: f64,
}

/// k has 7 bits; the first two parts of π/2 have 17 and 14. The polynomials err by 2⁻³¹ and 2⁻²⁸·⁵.
static NEAR_F32: NearConstants = NearConstants {
    limit: 192.0,
    narrow: 0.0,
    half_pi: [
        f64::from_bits(0x3ff9_21f0_0000_0000),
        f64::from_bits(0x3ee6_a880_0000_0000),
        f64::from_bits(0x3dd0_b461_2000_0000),
    ],
    integer: 12_582_912.0,
    cos: &[0.041_666_646_f32 as f64, -0.001_388_736_2_f32 as f64, 2.443_777_5e-5_f32 as f64],
    sin: &[-0.166_666_51_f32 as f64, 0.008_331_974_f32 as f64, -0.000_194_949_93_f32 as f64],
    half_ulp: f64::from_bits((1023 - 24) << 52),
};

/// k has 11 bits; the first two parts of π/2 have 41 and 42. The polynomials err by 2⁻⁶³ and
/// 2⁻⁵⁷·⁸.
static NEAR_F64: NearConstants = NearConstants {
    limit: 2048.0,
    narrow: 1.0 / (1 << 20) as f64,
    half_pi: [
        f64::from_bits(0x3ff9_21fb_5444_2000),
        f64::from_bits(0x3d6a_308d_3131_9800),
        f64::from_bits(0x3a94_5c06_e0e6_8948),
    ],
    integer: 6_755_399_441_055_744.0,
    cos: &[
        0.041_666_666_666_666_64,
        -0.001_388_888_888_887_958_3,
        2.480_158_729_247_250_2e-5,
        -2.755_731_512_705_429e-7,
        2.087_581_923_238_326_3e-9,
        -1.136_422_996_464_401e-11,
    ],
    sin: &[
        -0.166_666_666_666_666_4,
        0.008_333_333_333_323_997,
        -0.000_198_412_698_308_208_2,
        2.755_731_398_790_771_2e-6,
        -2.505_079_847_883_147_3e-8,
        1.589_888_117_039_719_9e-10,
    ],
    half_ulp: f64::from_bits((1023 - 53) << 52),
};

/// An angle of k quarter turns plus `rest` minus `correction`.
struct ReducedAngle<V> {
    /// The low bits are those of the integer k.
    bits: V,
    /// The number s in the equation at the top of this file; `correction` is n there.
    rest: V,
    correction: V,
}

/// A value as the sum of head and tail.
struct HeadAndTail<V> {
    head: V,
    tail: V,
}

/// Bounds of sine and cosine at one end of the operand, each as −lo and hi.
struct EndBounds<V> {
    sin: [V; 2],
    cos: [V; 2],
    /// Number of whole quarter turns below the angle, in the low bits.
    quarters: V,
}

impl<M: Machine> Rule<'_, M> {
    /// Returns whether these routines can compute sine and cosine of an operand within `range`.
    pub(crate) fn is_near(&self, range: Interval) -> bool {
        let NearConstants { limit, narrow, .. } = *self.constants();
        (Interval { lo: -limit, hi: limit }).encloses(range) && range.hi - range.lo >= narrow
    }

    fn constants(&self) -> &'static NearConstants {
        self.format.pick(&NEAR_F32, &NEAR_F64)
    }

    /// Encloses sine and cosine of an operand for which [`Self::is_near`] holds.
    pub(crate) fn near_waves(&mut self, a: &Operand<M::V>) -> [Enclosure<M::V>; 2] {
        let lo = self.m.neg(a.value.neg_lo);
        let (lo, hi) = (self.near_end(lo), self.near_end(a.value.hi));
        // Sine or cosine has an extremum at each whole number of quarter turns between the ends.
        // Modulo 4, the maxima of sine are at 1, the minima of cosine at 2, the minima of sine at
        // 3, and the maxima of cosine at 4. All comparisons are of integers, read as subnormal
        // floats with the same bits.
        let passed = self.m.int_sub(hi.quarters, lo.quarters);
        let [zero, one, two, three] = [0, 1, 2, 3].map(|bits| self.m.bits(self.format, bits));
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

    /// Bounds over the operand as [−lo, hi], from the bounds at its ends. The masks tell where a
    /// minimum and a maximum lie between the ends.
    fn near_wave(&mut self, [at_lo, at_hi]: [[M::V; 2]; 2], extrema: [M::V; 2]) -> [M::V; 2] {
        let one = self.number(1.0);
        std::array::from_fn(|i| {
            let bound = self.m.max(at_lo[i], at_hi[i]);
            let bound = self.m.min(bound, one);
            self.m.select(extrema[i], one, bound)
        })
    }

    /// Sine and cosine at points up to the limit. The relative error is at most [`NEAR_UNITS`]
    /// units of 2⁻²³ in `f32` or 2⁻⁵² in `f64`. Values exceed ±1 by at most one unit.
    pub(crate) fn near_waves_at(&mut self, a: M::V) -> [M::V; 2] {
        let turned = self.near_reduce(a);
        let values = self.near_sums(&turned).map(|sum| [self.m.add(sum.head, sum.tail)]);
        let mask = self.sign_bit();
        let [sin, cos] = self.turn_back(&turned, values);
        [sin, cos].map(|([value], sign)| {
            let sign = self.m.and(sign, mask);
            self.m.xor(value, sign)
        })
    }

    /// Bounds of the sine and the cosine at one end of the operand.
    fn near_end(&mut self, x: M::V) -> EndBounds<M::V> {
        let turned = self.near_reduce(x);
        let [sin, cos] = self.near_sums(&turned);
        let half_ulp = self.constants().half_ulp;
        let (share, magnitude) = (self.number(SIN_SLACK * half_ulp), self.m.abs(sin.head));
        let sin_slack = self.m.mul(magnitude, share);
        let cos_slack = COS_SLACK.map(|slack| self.number(slack * half_ulp));
        let bounds = [(sin, [sin_slack; 2]), (cos, cos_slack)];
        let bounds = bounds.map(|(HeadAndTail { head, tail }, slack)| {
            let above = self.m.add(tail, slack[1]);
            let below = self.m.sub(slack[0], tail);
            [self.m.sub(below, head), self.m.add(head, above)]
        });
        let [sin, cos] = self.turn_back(&turned, bounds).map(|([neg_lo, hi], sign)| {
            [self.m.select_signed(sign, hi, neg_lo), self.m.select_signed(sign, neg_lo, hi)]
        });
        // Subtracts 1 in lanes where the angle is below k quarter turns. As an integer, a set mask
        // is −1.
        let zero = self.zero();
        let before = self.m.lt(turned.rest, zero);
        EndBounds { sin, cos, quarters: self.m.int_add(turned.bits, before) }
    }

    /// Subtracts the nearest multiple of π/2 from an angle.
    fn near_reduce(&mut self, x: M::V) -> ReducedAngle<M::V> {
        let two_over_pi = self.nearest(std::f64::consts::FRAC_2_PI);
        let quarters = self.m.mul(x, two_over_pi);
        let k = self.m.nearest(quarters);
        let constants = self.constants();
        let [first, second, third] = constants.half_pi;
        let (first, second, third) = (self.number(-first), self.number(second), self.number(third));
        let near = self.m.mul_add(k, first, x);
        let second = self.m.mul(k, second);
        let rest = self.m.sub(near, second);
        // The difference rest − near is exact, and so is the error of `rest`.
        let moved = self.m.sub(rest, near);
        let added = self.m.add(second, moved);
        let correction = self.m.mul_add(k, third, added);
        let magic = self.number(constants.integer);
        ReducedAngle { bits: self.m.add(k, magic), rest, correction }
    }

    /// Sine and cosine of s − n, for |s| ≤ 0.786.
    fn near_sums(&mut self, turned: &ReducedAngle<M::V>) -> [HeadAndTail<M::V>; 2] {
        let ReducedAngle { rest: s, correction: n, .. } = *turned;
        let z = self.m.mul(s, s);
        // cos s = 1 − z/2 + z²(1/24 − …). The term n·sin s is approximated by n·s.
        let (one, minus_half) = (self.number(1.0), self.number(-0.5));
        let one_minus_half_z = self.m.mul_add(z, minus_half, one);
        let constants = self.constants();
        let series = self.series(z, constants.cos);
        let fourth = self.m.mul(z, z);
        let moved = self.m.mul(n, s);
        let cos =
            HeadAndTail { head: one_minus_half_z, tail: self.m.mul_add(fourth, series, moved) };
        // sin s = s − s·z(1/6 − …). The term n·cos s is approximated by n·(1 − z/2).
        let cube = self.m.mul(s, z);
        let series = self.series(z, constants.sin);
        let moved = self.m.mul(n, one_minus_half_z);
        [HeadAndTail { head: s, tail: self.m.mul_sub(cube, series, moved) }, cos]
    }

    /// Converts values or bounds for the rest of an angle to those for the angle. Each is returned
    /// with a vector: in lanes with that vector's sign bit set, the caller must negate it.
    fn turn_back<const N: usize>(
        &mut self,
        turned: &ReducedAngle<M::V>,
        [sin, cos]: [[M::V; N]; 2],
    ) -> [([M::V; N], M::V); 2] {
        // Bit 0 of k swaps sine and cosine. Bit 1 of k is the sign of the sine, bit 1 of k + 1 that
        // of the cosine. Each bit is shifted to the sign bit, by which lanes are selected.
        let last = self.format.pick(31, 63);
        let odd = self.m.shift_left(turned.bits, last);
        let sin_sign = self.m.shift_left(turned.bits, last - 1);
        let cos_sign = self.m.xor(sin_sign, odd);
        [(cos, sin, sin_sign), (sin, cos, cos_sign)].map(|(if_odd, if_even, sign)| {
            let value = std::array::from_fn(|i| self.m.select_signed(odd, if_odd[i], if_even[i]));
            (value, sign)
        })
    }

    /// Computes c₀ + z(c₁ + z(c₂ + …)).
    pub(super) fn series(&mut self, z: M::V, coefficients: &[f64]) -> M::V {
        let (last, rest) = coefficients.split_last().expect("a series has a term");
        let last = self.number(*last);
        rest.iter().rev().fold(last, |sum, c| {
            let c = self.number(*c);
            self.m.mul_add(sum, z, c)
        })
    }
}

/// Largest amounts by which the cosine's sum is above and below the exact value. The unit is 2⁻²⁴
/// in `f32` or 2⁻⁵³ in `f64`, an ulp of cos s. For z ≥ ½, −z/2 is a multiple of ½ and too low by
/// less than ½. So 1 − z/2 is too high by at most ½, and the tail adds less than ⅓. For smaller z,
/// 1 − z/2 is too high by less than 1 − z/2, −z/2 is too low by less than ¼, and the tail errs by
/// less than z/2. This covers the polynomial, six roundings of z²/24 by two units each, and n·s³/6
/// for an n of one unit.
const COS_SLACK: [f64; 2] = [1.0, 0.75];
/// Bound on the error of the sine's tail, in units of 2⁻²⁴·|s| in `f32` or 2⁻⁵³·|s| in `f64`. At
/// most three roundings of 0.1·|s| go in one direction, by two units each: 0.61. The polynomial
/// adds 0.07, and n·(cos s − 1 + z/2) adds 0.03.
const SIN_SLACK: f64 = 0.75;

/// Bound on the relative error of [`Rule::near_waves_at`], in units of 2⁻²³ in `f32` or 2⁻⁵² in
/// `f64`. Rounding the value up adds less than one unit. Half of [`COS_SLACK`] is at most 0.708 of
/// a cosine of π/4; half of [`SIN_SLACK`] is at most 0.42 of a sine.
pub(crate) const NEAR_UNITS: f64 = 1.75;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Format;
    use crate::rules::elementary::recorded::Program;

    #[test]
    fn proofs_of_near_waves() {
        let mut m = Program::default();
        let x = m.input("x");
        let mut rule = Rule { m: &mut m, format: Format::F64 };
        let turned = rule.near_reduce(x);
        let EndBounds { sin, cos, .. } = rule.near_end(x);
        let values = rule.near_waves_at(x);
        m.name("rest", turned.rest);
        m.name("correction", turned.correction);
        m.name("turns", turned.bits);
        for (name, [low, high], value) in [("sin", sin, values[0]), ("cos", cos, values[1])] {
            m.bound(name, [low, high]);
            m.name(&format!("value {name}"), value);
        }
        m.constant("units", NEAR_UNITS);
        m.constant("coefficient", NEAR_F64.sin[0]);
        m.constant("slack", SIN_SLACK * NEAR_F64.half_ulp);
        m.write("waves-near", [-NEAR_F64.limit, NEAR_F64.limit]);
    }

    #[test]
    fn parts_of_half_pi_make_up_half_pi() {
        // The first 121 bits of π/2 and the next 24 bits (OEIS A062964, halved).
        let half_pi = 0x192_1fb5_4442_d184_6989_8cc5_1701_b839_u128;
        let next = 0xa2_5204_u128;
        let bits = |part: f64| 53 - part.to_bits().trailing_zeros();

        let parts = NEAR_F32.half_pi;
        let scaled = |part: f64| (part * 2_f64.powi(120)) as u128;
        let sum: u128 = parts.iter().map(|part| scaled(*part)).sum();
        assert!(sum.abs_diff(half_pi) < 1 << (120 - 59));
        for part in parts {
            assert_eq!(f64::from(part as f32), part);
        }
        assert!(parts[..2].iter().all(|part| bits(*part) <= 17));

        // The first two parts have the first 83 bits of π/2, the third part what follows.
        let [first, second, third] = NEAR_F64.half_pi;
        let scaled = |part: f64| (part * 2_f64.powi(82)) as u128;
        assert_eq!(scaled(first) + scaled(second), half_pi >> 38);
        let rest = (half_pi % (1 << 38)) << 24 | next;
        assert!(((third * 2_f64.powi(144)) as u128).abs_diff(rest) < 8);
        assert!(bits(first) <= 41 && bits(second) <= 42);
    }
}
