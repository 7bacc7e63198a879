//! Elementary functions of `f64` lanes: one text each, for both formats.
//!
//! Every text is a short sequence of lane operations that approximates a function with a relative error below
//! [`Text::error`], rounding up included; bounds are then the approximation moved by that error. Coefficients are
//! those of Taylor series on the reduced range, cut where the tail is below the error claimed; the tails are
//! stated beside them. Split constants follow Cody and Waite (Software Manual for the Elementary Functions, 1980).

use crate::machine::{Format, Machine};

/// Writes texts for results that end in `target`: `F32` results need shorter series.
pub(crate) struct Text<'a, M> {
    pub(crate) m: &'a mut M,
    pub(crate) target: Format,
}

/// Applies `text` to the `f64` halves of each vector of `format` and joins the two results, rounded up.
pub(crate) fn by_halves<M: Machine, const IN: usize, const OUT: usize>(
    m: &mut M,
    format: Format,
    inputs: [M::V; IN],
    mut text: impl FnMut(&mut Text<'_, M>, [M::V; IN]) -> [M::V; OUT],
) -> [M::V; OUT] {
    match format {
        Format::F64 => text(&mut Text { m, target: format }, inputs),
        Format::F32 => {
            let halves = inputs.map(|input| m.widen(input));
            let rows = [halves.map(|half| half[0]), halves.map(|half| half[1])];
            let [low, high] = m.repeat(rows, |m, row| text(&mut Text { m, target: format }, row));
            std::array::from_fn(|i| m.narrow([low[i], high[i]]))
        }
    }
}

/// Applies `f` to the halves of lo and hi one after the other, then `combine` to what comes of both ends of a half.
pub(crate) fn at_ends<M: Machine, const MID: usize, const OUT: usize>(
    m: &mut M,
    format: Format,
    neg_lo: M::V,
    hi: M::V,
    mut f: impl FnMut(&mut Text<'_, M>, M::V) -> [M::V; MID],
    mut combine: impl FnMut(&mut Text<'_, M>, [M::V; MID], [M::V; MID]) -> [M::V; OUT],
) -> [M::V; OUT] {
    match format {
        Format::F64 => {
            let mut text = Text { m, target: format };
            let lo = text.m.neg(neg_lo);
            let (at_lo, at_hi) = (f(&mut text, lo), f(&mut text, hi));
            combine(&mut text, at_lo, at_hi)
        }
        Format::F32 => {
            let lo = m.neg(neg_lo);
            let ([l0, l1], [h0, h1]) = (m.widen(lo), m.widen(hi));
            let values =
                m.repeat([[l0], [l1], [h0], [h1]], |m, [x]| f(&mut Text { m, target: format }, x));
            let [l0, l1, h0, h1] = values;
            let low = combine(&mut Text { m, target: format }, l0, h0);
            let high = combine(&mut Text { m, target: format }, l1, h1);
            std::array::from_fn(|i| m.narrow([low[i], high[i]]))
        }
    }
}

const F64: Format = Format::F64;

/// ln 2 = `LN_2_HI` + `LN_2_LO` to 2⁻⁹⁵; `LN_2_HI` has 41 bits, so its product with an exponent is exact.
pub(super) const LN_2_HI: f64 = f64::from_bits(0x3fe6_2e42_fefa_3000);
pub(super) const LN_2_LO: f64 = 2.823_529_056_303_157_7e-13;
/// π/2 in four parts, the first three of at most 33 bits, so that their products with k are exact. The parts and the
/// sum are compared with π in the tests.
const HALF_PI: [f64; 4] = [
    f64::from_bits(0x3ff9_21fb_5440_0000),
    f64::from_bits(0x3dd0_b461_1a60_0000),
    f64::from_bits(0x3ba3_198a_2e00_0000),
    f64::from_bits(0x397b_839a_2520_49c1),
];
/// π/2 − `HALF_PI[0]` in one part.
const HALF_PI_REST: f64 = f64::from_bits(0x3dd0_b461_1a62_6331);

/// Angles up to this magnitude are reduced exactly enough; beyond it sine and cosine are only known to be in [−1, 1].
pub(crate) const ANGLE_LIMIT: f64 = 1_048_576.0; // 2^20

impl<M: Machine> Text<'_, M> {
    /// A bound on the relative error of every approximation here.
    pub(crate) fn error(&self) -> f64 {
        match self.target {
            Format::F32 => f64::from_bits(0x3dd0_0000_0000_0000), // 2^-34
            Format::F64 => f64::from_bits(0x3cf0_0000_0000_0000), // 2^-48
        }
    }

    pub(super) fn number(&mut self, value: f64) -> M::V {
        self.m.number(F64, value)
    }

    pub(super) fn pick<T>(&self, f32: T, f64: T) -> T {
        match self.target {
            Format::F32 => f32,
            Format::F64 => f64,
        }
    }

    /// c₀ + z(c₁ + z(c₂ + …)).
    pub(super) fn series(&mut self, z: M::V, coefficients: &[f64]) -> M::V {
        let (last, rest) = coefficients.split_last().expect("a series has a term");
        let mut sum = self.number(*last);
        for &c in rest.iter().rev() {
            let product = self.m.mul(sum, z);
            let c = self.number(c);
            sum = self.m.add(product, c);
        }
        sum
    }

    /// An upper bound of what `value` approximates.
    pub(crate) fn above(&mut self, value: M::V) -> M::V {
        let error = self.error();
        let error = self.number(error);
        let magnitude = self.m.abs(value);
        let slack = self.m.mul(magnitude, error);
        self.m.add(value, slack)
    }

    /// [`Text::above`] of the negated value: minus a lower bound.
    pub(crate) fn above_negated(&mut self, value: M::V) -> M::V {
        let negated = self.m.neg(value);
        self.above(negated)
    }

    /// x − k·c.
    pub(super) fn subtract_multiple(&mut self, x: M::V, k: M::V, c: f64) -> M::V {
        let c = self.number(c);
        let multiple = self.m.mul(k, c);
        self.m.sub(x, multiple)
    }

    /// 2^k for integral k with −1022 ≤ k ≤ 1023.
    pub(super) fn power_of_two(&mut self, k: M::V) -> M::V {
        // Adding 2^52 + 1023 leaves k + 1023 in the low bits of the significand.
        let magic = self.number(4_503_599_627_370_496.0 + 1023.0);
        let biased = self.m.add(k, magic);
        self.m.shift_left(biased, 52)
    }

    /// Reduces an angle x for |x| ≤ [`ANGLE_LIMIT`].
    fn reduce(&mut self, x: M::V) -> Angle<M::V> {
        let two_over_pi = self.number(std::f64::consts::FRAC_2_PI);
        let quarters = self.m.mul(x, two_over_pi);
        let k = self.m.nearest(quarters);
        // The first product is exact and so is its difference. A rest may be as small as 2^-57; each further product is
        // exact, and its difference where it cancels, so that only the last rounds: in f32, 2^-67 of at least 2^-30.
        let mut rest = self.subtract_multiple(x, k, HALF_PI[0]);
        match self.target {
            Format::F32 => rest = self.subtract_multiple(rest, k, HALF_PI_REST),
            Format::F64 => {
                for part in &HALF_PI[1..] {
                    rest = self.subtract_multiple(rest, k, *part);
                }
            }
        }
        // 1.5 · 2^52 keeps negative k in the low bits too.
        let magic = self.number(6_755_399_441_055_744.0);
        let bits = self.m.add(k, magic);
        let half = self.number(0.5);
        let sign_bit = self.m.bits(F64, 1 << 63);
        let sign = self.m.and(rest, sign_bit);
        let side = self.m.or(sign, half);
        Angle { rest, bits, quarters: self.m.add(k, side) }
    }

    /// sin r for |r| ≤ π/4: the tails r¹³/13! and r¹⁹/19! are below 2⁻³⁶ and 2⁻⁶³ of it.
    fn sin_reduced(&mut self, r: M::V, z: M::V) -> M::V {
        let terms = self.pick(5, 8);
        let coefficients = reciprocal_factorials(terms, 3);
        let tail = self.series(z, &coefficients);
        let tail = self.m.mul(tail, z);
        let tail = self.m.mul(tail, r);
        self.m.add(tail, r)
    }

    /// cos r for |r| ≤ π/4: the tails r¹⁴/14! and r¹⁸/18! are below 2⁻⁴¹ and 2⁻⁵⁸.
    fn cos_reduced(&mut self, z: M::V) -> M::V {
        let terms = self.pick(6, 8);
        let coefficients = reciprocal_factorials(terms, 2);
        let tail = self.series(z, &coefficients);
        let tail = self.m.mul(tail, z);
        let one = self.number(1.0);
        self.m.add(tail, one)
    }

    /// The lanes of k whose bit `bit` is set, as a mask.
    fn bit_mask(&mut self, k: M::V, bit: u8) -> M::V {
        let one = self.m.bits(F64, 1 << bit);
        let zero = self.m.bits(F64, 0);
        let set = self.m.and(k, one);
        let set = self.m.shift_right(set, bit);
        self.m.int_sub(zero, set)
    }

    /// `value` with the sign bit flipped where bit 1 of k is set.
    fn flip_by_bit_1(&mut self, value: M::V, k: M::V) -> M::V {
        let two = self.m.bits(F64, 2);
        let set = self.m.and(k, two);
        let sign = self.m.shift_left(set, 62);
        self.m.xor(value, sign)
    }

    /// sin x for |x| ≤ [`ANGLE_LIMIT`], anything beyond; and [`Angle::quarters`].
    pub(crate) fn sin(&mut self, x: M::V) -> [M::V; 2] {
        let angle = self.reduce(x);
        let (sin, cos) = self.sin_cos(&angle);
        let odd = self.bit_mask(angle.bits, 0);
        let value = self.m.select(odd, cos, sin);
        [self.flip_by_bit_1(value, angle.bits), angle.quarters]
    }

    /// cos x for |x| ≤ [`ANGLE_LIMIT`], anything beyond; and [`Angle::quarters`].
    pub(crate) fn cos(&mut self, x: M::V) -> [M::V; 2] {
        let angle = self.reduce(x);
        let (sin, cos) = self.sin_cos(&angle);
        let odd = self.bit_mask(angle.bits, 0);
        let value = self.m.select(odd, sin, cos);
        let one = self.m.bits(F64, 1);
        let next = self.m.int_add(angle.bits, one);
        [self.flip_by_bit_1(value, next), angle.quarters]
    }

    /// tan x for |x| ≤ [`ANGLE_LIMIT`], anything beyond; and [`Angle::quarters`].
    pub(crate) fn tan(&mut self, x: M::V) -> [M::V; 2] {
        let angle = self.reduce(x);
        let (sin, cos) = self.sin_cos(&angle);
        let odd = self.bit_mask(angle.bits, 0);
        let minus_cos = self.m.neg(cos);
        let above = self.m.select(odd, minus_cos, sin);
        let below = self.m.select(odd, sin, cos);
        [self.m.div(above, below), angle.quarters]
    }

    /// Sine and cosine of a reduced angle.
    fn sin_cos(&mut self, angle: &Angle<M::V>) -> (M::V, M::V) {
        let z = self.m.mul(angle.rest, angle.rest);
        (self.sin_reduced(angle.rest, z), self.cos_reduced(z))
    }
}

/// An angle as k quarter turns and a rest.
struct Angle<V> {
    /// The angle less k·π/2.
    rest: V,
    /// k in the low bits.
    bits: V,
    /// k + ½ or k − ½, by the sign of the rest: it tells on which side of k quarters the angle is.
    quarters: V,
}

/// (−1)ⁿ / (first + 2n − 2)! for n = 1…terms: the series of sine (first = 3) and cosine (first = 2) after its lead.
fn reciprocal_factorials(terms: u32, first: u32) -> Vec<f64> {
    (1..=terms)
        .map(|n| {
            let factorial: f64 = (1..=first + 2 * n - 2).map(f64::from).product();
            if n % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_half_pi_make_up_half_pi() {
        // Its first 121 bits: OEIS A062964, halved.
        let half_pi = 0x192_1fb5_4442_d184_6989_8cc5_1701_b839_u128;
        let scaled = |part: f64| (part * 2_f64.powi(120)) as u128;
        let sum: u128 = HALF_PI.iter().map(|part| scaled(*part)).sum();
        assert_eq!(sum, half_pi);
        let rest = half_pi - scaled(HALF_PI[0]);
        assert!(scaled(HALF_PI_REST).abs_diff(rest) < 1 << 34);
        for part in &HALF_PI[..3] {
            assert!(part.to_bits().trailing_zeros() >= 53 - 33, "{part:e} has more than 33 bits");
        }
    }

    #[test]
    fn parts_of_ln_2_make_up_ln_2() {
        // Its first 128 bits: OEIS A068426.
        let ln_2 = 0xb172_17f7_d1cf_79ab_c9e3_b398_03f2_f6af_u128;
        let scaled = |part: f64| (part * 2_f64.powi(127) * 2.0) as u128;
        let sum = scaled(LN_2_HI) + scaled(LN_2_LO);
        assert!(sum.abs_diff(ln_2) < 1 << 33);
        assert!(LN_2_HI.to_bits().trailing_zeros() >= 11);
    }
}
