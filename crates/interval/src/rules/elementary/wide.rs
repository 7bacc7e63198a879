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
const LN_2_HI: f64 = f64::from_bits(0x3fe6_2e42_fefa_3000);
const LN_2_LO: f64 = 2.823_529_056_303_157_7e-13;
/// Bits of the double nearest to √½, and of 1.
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const ONE: u64 = 0x3ff0_0000_0000_0000;
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

    fn number(&mut self, value: f64) -> M::V {
        self.m.number(F64, value)
    }

    fn pick<T>(&self, f32: T, f64: T) -> T {
        match self.target {
            Format::F32 => f32,
            Format::F64 => f64,
        }
    }

    /// c₀ + z(c₁ + z(c₂ + …)).
    fn series(&mut self, z: M::V, coefficients: &[f64]) -> M::V {
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

    /// `[−lo, hi]` of the exponential of `[−lo, hi]`; infinite ends are allowed.
    pub(crate) fn exp(&mut self, [neg_lo, hi]: [M::V; 2]) -> [M::V; 2] {
        let lo = self.m.neg(neg_lo);
        let slack = self.error();
        let (down, up) = (self.number(-(1.0 - slack)), self.number(1.0 + slack));
        [self.exp_times(lo, down), self.exp_times(hi, up)]
    }

    /// exp(x), near enough.
    pub(crate) fn exp_near(&mut self, x: M::V) -> M::V {
        let one = self.number(1.0);
        self.exp_times(x, one)
    }

    /// exp(x) · factor, each operation on the product rounded up.
    fn exp_times(&mut self, x: M::V, factor: M::V) -> M::V {
        // Past these, results overflow or underflow the target whatever x is.
        let (least, most) = self.pick((-160.0, 128.0), (-760.0, 720.0));
        let (least, most) = (self.number(least), self.number(most));
        let x = self.m.max(x, least);
        let x = self.m.min(x, most);
        let log2_e = self.number(std::f64::consts::LOG2_E);
        let scaled = self.m.mul(x, log2_e);
        let k = self.m.nearest(scaled);
        let r = self.subtract_multiple(x, k, LN_2_HI);
        let r = self.subtract_multiple(r, k, LN_2_LO);
        // |r| ≤ 0.3467: the tail r¹⁰/10! is below 2⁻³⁷, r¹⁴/14! below 2⁻⁵⁷.
        let terms = self.pick(9, 13);
        let mut factorial = 1.0;
        let coefficients: Vec<f64> = (0..=terms)
            .map(|n| {
                factorial *= f64::from(n.max(1));
                1.0 / factorial
            })
            .collect();
        let mantissa = self.series(r, &coefficients);
        let product = self.m.mul(mantissa, factor);
        match self.target {
            Format::F32 => {
                let power = self.power_of_two(k);
                self.m.mul(product, power)
            }
            Format::F64 => {
                // 2^k may be out of range where exp(x) is not: two factors.
                let half = self.number(0.5);
                let k_half = self.m.mul(k, half);
                let first = self.m.floor(k_half);
                let second = self.m.sub(k, first);
                let first = self.power_of_two(first);
                let second = self.power_of_two(second);
                let product = self.m.mul(product, first);
                self.m.mul(product, second)
            }
        }
    }

    /// x − k·c.
    fn subtract_multiple(&mut self, x: M::V, k: M::V, c: f64) -> M::V {
        let c = self.number(c);
        let multiple = self.m.mul(k, c);
        self.m.sub(x, multiple)
    }

    /// 2^k for integral k with −1022 ≤ k ≤ 1023.
    fn power_of_two(&mut self, k: M::V) -> M::V {
        // Adding 2^52 + 1023 leaves k + 1023 in the low bits of the significand.
        let magic = self.number(4_503_599_627_370_496.0 + 1023.0);
        let biased = self.m.add(k, magic);
        self.m.shift_left(biased, 52)
    }

    /// ln(x) for finite x > 0, times `scale`.
    pub(crate) fn ln(&mut self, x: M::V, scale: f64) -> M::V {
        let (x, offset) = match self.target {
            Format::F32 => (x, None), // every positive f32 is a normal f64
            Format::F64 => {
                let (tiny, factor) = (self.number(f64::MIN_POSITIVE), self.number(2f64.powi(64)));
                let subnormal = self.m.lt(x, tiny);
                let scaled = self.m.mul(x, factor);
                let bits = self.number(-64.0);
                (self.m.select(subnormal, scaled, x), Some(self.m.and(subnormal, bits)))
            }
        };
        // x = 2^k · m with √½ ≤ m < √2: shift the bits so that the exponent field steps at √½.
        let shift = self.m.bits(F64, ONE - ROOT_HALF);
        let shifted = self.m.int_add(x, shift);
        let exponent = self.m.shift_right(shifted, 52);
        let magic = self.number(4_503_599_627_370_496.0);
        let k = self.m.or(exponent, magic);
        let bias = self.number(4_503_599_627_370_496.0 + 1023.0);
        let mut k = self.m.sub(k, bias);
        if let Some(offset) = offset {
            k = self.m.add(k, offset);
        }
        let field = self.m.bits(F64, 0xfff0_0000_0000_0000);
        let power = self.m.and(shifted, field);
        let m = self.m.int_sub(x, power);
        let one_bits = self.m.bits(F64, ONE);
        let m = self.m.int_add(m, one_bits);
        // ln m = 2 artanh s, s = (m − 1)/(m + 1); s² ≤ 0.02944, so the tails are below 2⁻³⁹ and 2⁻⁵⁵.
        let (one, two) = (self.number(1.0), self.number(2.0));
        let f = self.m.sub(m, one);
        let below = self.m.add(f, two);
        let s = self.m.div(f, below);
        let z = self.m.mul(s, s);
        let terms = self.pick(6, 9);
        let coefficients: Vec<f64> =
            (1..=terms).map(|n| 2.0 / (2.0 * f64::from(n) + 1.0)).collect();
        let tail = self.series(z, &coefficients);
        let tail = self.m.mul(tail, z);
        let sum = self.m.add(tail, two);
        let ln_m = self.m.mul(sum, s);
        let (ln_2_hi, ln_2_lo) = (self.number(LN_2_HI), self.number(LN_2_LO));
        let rest = self.m.mul(k, ln_2_lo);
        let rest = self.m.add(rest, ln_m);
        let main = self.m.mul(k, ln_2_hi);
        let ln = self.m.add(main, rest);
        if scale == 1.0 {
            return ln;
        }
        let scale = self.number(scale);
        self.m.mul(ln, scale)
    }

    /// ∛x, odd in x, for finite x.
    pub(crate) fn cbrt(&mut self, x: M::V) -> M::V {
        let magnitude = self.m.abs(x);
        // exp(ln|x|/3), then one Newton step, which squares its error.
        let third = self.number(1.0 / 3.0);
        let ln = self.ln(magnitude, 1.0);
        let exponent = self.m.mul(ln, third);
        let guess = self.exp_near(exponent);
        let square = self.m.mul(guess, guess);
        let ratio = self.m.div(magnitude, square);
        let excess = self.m.sub(ratio, guess);
        let correction = self.m.mul(excess, third);
        let root = self.m.add(guess, correction);
        let sign_bit = self.m.bits(F64, 1 << 63);
        let sign = self.m.and(x, sign_bit);
        let signed = self.m.or(root, sign);
        let zero = self.number(0.0);
        let is_zero = self.m.eq(x, zero);
        self.m.select(is_zero, x, signed)
    }

    /// atan(x), odd in x.
    pub(crate) fn atan(&mut self, x: M::V) -> M::V {
        const TAN_EIGHTH_PI: f64 = std::f64::consts::SQRT_2 - 1.0;
        const TAN_THREE_EIGHTHS_PI: f64 = std::f64::consts::SQRT_2 + 1.0;
        let t = self.m.abs(x);
        let (low, high) = (self.number(TAN_EIGHTH_PI), self.number(TAN_THREE_EIGHTHS_PI));
        let (middle, far) = (self.m.lt(low, t), self.m.lt(high, t));
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        // atan t = π/4 + atan((t − 1)/(t + 1)) = π/2 + atan(−1/t): |quotient| ≤ tan π/8.
        let (minus, plus) = (self.m.sub(t, one), self.m.add(t, one));
        let above = self.m.select(middle, minus, t);
        let above = self.m.select(far, minus_one, above);
        let below = self.m.select(middle, plus, one);
        let below = self.m.select(far, t, below);
        let u = self.m.div(above, below);
        let (quarter, half) =
            (self.number(std::f64::consts::FRAC_PI_4), self.number(std::f64::consts::FRAC_PI_2));
        let base = self.m.and(middle, quarter);
        let base = self.m.select(far, half, base);
        // u² ≤ 0.17158: the tails z¹⁴/29 and z²⁰/41 are below 2⁻⁴⁰ and 2⁻⁵⁶.
        let z = self.m.mul(u, u);
        let terms = self.pick(13, 19);
        let coefficients: Vec<f64> = (1..=terms)
            .map(|n| if n % 2 == 0 { 1.0 } else { -1.0 } / (2.0 * f64::from(n) + 1.0))
            .collect();
        let tail = self.series(z, &coefficients);
        let tail = self.m.mul(tail, z);
        let tail = self.m.mul(tail, u);
        let sum = self.m.add(tail, u);
        let angle = self.m.add(base, sum);
        let sign_bit = self.m.bits(F64, 1 << 63);
        let sign = self.m.and(x, sign_bit);
        self.m.or(angle, sign)
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
