//! Routines for logarithms: ln, log2, log10, and the inverse hyperbolic functions asinh, acosh,
//! atanh.
//!
//! A number is 2ᵏ·m with √½ ≤ m < √2. Then ln m = 2 artanh s with s = (m − 1)/(m + 1), |s| ≤
//! 0.1716. If the number is 1 + u and k = 0, then s = u/(2 + u), so a small u loses no digits.

use super::approximator::{Approximator, LN_2_HI, LN_2_LO};
use super::double_double::{Approximation, DoubleDouble};
use crate::machine::{Format, Machine};

const F64: Format = Format::F64;
/// Bits of the double nearest to √½; `ONE` has the bits of 1.
const ROOT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
const ONE: u64 = 0x3ff0_0000_0000_0000;
/// For x above this limit (2³⁰), in `f64`, asinh x and acosh x equal ln 2x to 2⁻⁶⁶.
const LARGE: f64 = 1_073_741_824.0;
/// A limit above every `f32`, whose square is finite in `f64`.
const BEYOND_F32: f64 = f64::from_bits((1023 + 200) << 52); // 2^200

/// The lanes where x is above [`LARGE`], for results in `f64`.
#[derive(Clone, Copy)]
struct LargeLanes<V> {
    /// The mask of the lanes where x is above [`LARGE`].
    lanes: V,
    /// The value x, clamped to the largest finite number.
    x: V,
}

/// The base of a logarithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Base {
    E,
    Two,
    Ten,
}

impl Base {
    /// The logarithm of 2 as the sum of two parts. The first part has at most 41 bits, so its
    /// product with an exponent is exact.
    fn of_two(self) -> [f64; 2] {
        match self {
            Self::E => [LN_2_HI, LN_2_LO],
            Self::Two => [1.0, 0.0],
            Self::Ten => [LOG10_2_HI, LOG10_2_LO],
        }
    }

    /// The logarithm of e as head and tail, or `None` if it is 1.
    fn of_e(self) -> Option<[f64; 2]> {
        match self {
            Self::E => None,
            Self::Two => Some([std::f64::consts::LOG2_E, LOG2_E_TAIL]),
            Self::Ten => Some([std::f64::consts::LOG10_E, LOG10_E_TAIL]),
        }
    }
}

/// `LOG10_2_HI` + `LOG10_2_LO` equals log₁₀ 2 to 2⁻⁹⁶, and `LOG10_2_HI` has 41 bits. The tests
/// compare all split constants with the exact numbers.
const LOG10_2_HI: f64 = f64::from_bits(0x3fd3_4413_509f_7000);
const LOG10_2_LO: f64 = f64::from_bits(0x3d43_fde6_23e2_566b);
/// Differences of log₂ e, log₁₀ e and 1/3 from the doubles nearest to them.
const LOG2_E_TAIL: f64 = f64::from_bits(0x3c77_77d0_ffda_0d24);
const LOG10_E_TAIL: f64 = f64::from_bits(0x3c69_5355_baaa_fad3);
const ONE_THIRD_TAIL: f64 = f64::from_bits(0x3c75_5555_5555_5555);

impl<M: Machine> Approximator<'_, M> {
    /// The logarithm of finite x > 0. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁶⁰ in `f64`.
    ///
    /// In `f64` only [`Approximator::twice_artanh`] errs by more than 2⁻⁷⁰. Its value is never
    /// larger in magnitude than its sum with k·ln 2.
    pub(crate) fn ln(&mut self, x: M::V, base: Base) -> Approximation<M::V> {
        let (k, m) = self.significand(x);
        let one = self.number(1.0);
        let f = self.m.sub(m, one);
        let ln = self.ln_of_parts(k, f.into(), base);
        Approximation::new(ln, self.pick(2f64.powi(-34), 2f64.powi(-60)))
    }

    /// Returns k and m such that x = 2ᵏ·m exactly and √½ ≤ m < √2, for x > 0.
    pub(super) fn significand(&mut self, x: M::V) -> (M::V, M::V) {
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
        // Adding `shift` makes the exponent field change at √½ instead of at 1.
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
        (k, self.m.int_add(m, one_bits))
    }

    /// Computes the logarithm of 2ᵏ(1 + f) for √½ ≤ 1 + f ≤ √2.
    fn ln_of_parts(&mut self, k: M::V, f: DoubleDouble<M::V>, base: Base) -> DoubleDouble<M::V> {
        let two = self.number(2.0);
        let below = self.plus(two, f);
        let s = self.over(f, below);
        self.ln_of_quotient(k, s, base)
    }

    /// Computes the logarithm of 2ᵏ(1 + s)/(1 − s) for |s| ≤ 0.1716.
    fn ln_of_quotient(&mut self, k: M::V, s: DoubleDouble<M::V>, base: Base) -> DoubleDouble<M::V> {
        let mut ln = self.twice_artanh(s);
        if let Some(scale) = base.of_e() {
            let scale = self.constant(scale);
            ln = self.times(ln, scale);
        }
        let [unit, rest] = base.of_two();
        let unit = self.number(unit);
        let main = self.m.mul(k, unit);
        if rest == 0.0 {
            return self.plus(main, ln);
        }
        let rest = self.number(rest);
        let rest = self.m.mul(k, rest);
        if self.has_tails() {
            let sum = self.plus(main, ln);
            return self.plus(sum, rest);
        }
        let rest = self.plus(rest, ln);
        self.plus(main, rest)
    }

    /// 2 artanh s for |s| ≤ 0.1716, to 2⁻³⁶ in `f32` and 2⁻⁶¹ in `f64`.
    ///
    /// For z = s² ≤ 0.02944, the tail of the series is below 2⁻³⁹ in `f32` and 2⁻⁶⁵ in `f64`. In
    /// `f64` only the terms from z²/5 on are rounded to a lane. They are at most 0.00018 of s, and
    /// five roundings by 2⁻⁵² affect them.
    fn twice_artanh(&mut self, s: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        let terms = self.pick(6, 11);
        if self.has_tails() {
            let coefficients: Vec<f64> =
                (1..=terms).map(|n| 1.0 / (2.0 * f64::from(n) + 1.0)).collect();
            let half = self.odd_series(s, ONE_THIRD_TAIL, &coefficients);
            let two = self.number(2.0);
            return self.scaled(half, two);
        }
        let z = self.m.mul(s.head, s.head);
        let coefficients: Vec<f64> =
            (1..=terms).map(|n| 2.0 / (2.0 * f64::from(n) + 1.0)).collect();
        let tail = self.series(z, &coefficients);
        let tail = self.m.mul(tail, z);
        let two = self.number(2.0);
        let sum = self.m.add(tail, two);
        self.m.mul(sum, s.head).into()
    }

    /// Computes ln(1 + u) for u ≥ 0, but ln 2x in the lanes of `large`.
    fn ln_one_plus(
        &mut self,
        u: DoubleDouble<M::V>,
        large: Option<LargeLanes<M::V>>,
    ) -> DoubleDouble<M::V> {
        let (one, zero) = (self.number(1.0), self.number(0.0));
        let mut whole = self.plus_nonneg(one.into(), u);
        if let Some(LargeLanes { lanes, x }) = large {
            whole = self.choose(lanes, x.into(), whole);
        }
        let (mut k, m) = self.significand(whole.head);
        let f = self.m.sub(m, one);
        let mut f = DoubleDouble::from(f);
        if let Some(tail) = whole.tail {
            let minus_k = self.m.neg(k);
            let power = self.power_of_two(minus_k);
            let tail = self.m.mul(tail, power);
            f = self.plus(f, tail);
        }
        // If u is small, 1 + u has lost digits of u. In this case k = 0, and f is u itself.
        let near_one = self.m.eq(k, zero);
        let f = self.choose(near_one, u, f);
        if let Some(LargeLanes { lanes, .. }) = large {
            let doubled = self.m.and(lanes, one);
            k = self.m.add(k, doubled);
        }
        self.ln_of_parts(k, f, Base::E)
    }

    /// In `f64`, returns x clamped to [`LARGE`], and the lanes where x exceeds it. In `f32`,
    /// returns x clamped to [`BEYOND_F32`], and `None`.
    fn large(&mut self, x: M::V) -> (M::V, Option<LargeLanes<M::V>>) {
        let limit = self.pick(BEYOND_F32, LARGE);
        let limit = self.number(limit);
        let limited = self.m.min(x, limit);
        if !self.has_tails() {
            return (limited, None);
        }
        let finite = self.number(f64::MAX);
        let lanes = self.m.lt(limit, x);
        let x = self.m.min(x, finite);
        (limited, Some(LargeLanes { lanes, x }))
    }

    /// asinh x for finite x, odd in x: ln(1 + u) for u = |x| + x²/(1 + √(1 + x²)). Its relative
    /// error is below 2⁻³⁴ in `f32` and 2⁻⁶⁰ in `f64`: u errs by 2⁻⁶⁹, and the logarithm as stated
    /// for [`Approximator::ln`].
    pub(crate) fn asinh(&mut self, x: M::V) -> Approximation<M::V> {
        let magnitude = self.m.abs(x);
        let (t, large) = self.large(magnitude);
        let one = self.number(1.0);
        let square = self.times(t, t);
        let below = self.plus_nonneg(one.into(), square);
        let below = self.root(below);
        let below = self.plus(below, one);
        let excess = self.over(square, below);
        let u = self.plus(t, excess);
        let ln = self.ln_one_plus(u, large);
        let ln = self.odd(x, ln);
        Approximation::new(ln, self.pick(2f64.powi(-34), 2f64.powi(-60)))
    }

    /// acosh x for finite x ≥ 1, exactly 0 at 1: ln(1 + u) for u = x − 1 + √((x − 1)(x + 1)). Its
    /// relative error is that of asinh.
    pub(crate) fn acosh(&mut self, x: M::V) -> Approximation<M::V> {
        let (x, large) = self.large(x);
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        let (below, above) = (self.plus(x, minus_one), self.plus(x, one));
        let product = self.times(below, above);
        let root = self.root(product);
        let u = self.plus(root, below);
        let ln = self.ln_one_plus(u, large);
        Approximation::new(ln, self.pick(2f64.powi(-34), 2f64.powi(-60)))
    }

    /// atanh x for |x| < 1, odd in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁶⁰ in `f64`.
    ///
    /// Let (1 + |x|)/(1 − |x|) = 2ᵏ·m. Then s = ((1 + |x|) − 2ᵏ(1 − |x|)) / ((1 + |x|) + 2ᵏ(1 −
    /// |x|)). For k = 0, s is |x|.
    pub(crate) fn atanh(&mut self, x: M::V) -> Approximation<M::V> {
        let t = self.m.abs(x);
        let (one, zero, minus_t) = (self.number(1.0), self.number(0.0), self.m.neg(t));
        let (above, below) = (self.plus(one, t), self.plus(one, minus_t));
        let ratio = self.m.div(above.head, below.head);
        let (k, _) = self.significand(ratio);
        let power = self.power_of_two(k);
        let below = self.scaled(below, power);
        // The heads differ by less than a factor of 2, so their difference is exact.
        let minus_below = self.opposite(below);
        let (difference, sum) = (self.plus(above, minus_below), self.plus_nonneg(above, below));
        let s = self.over(difference, sum);
        let near_zero = self.m.eq(k, zero);
        let s = self.choose(near_zero, t.into(), s);
        let twice = self.ln_of_quotient(k, s, Base::E);
        let half = self.number(0.5);
        let atanh = self.scaled(twice, half);
        let atanh = self.odd(x, atanh);
        Approximation::new(atanh, self.pick(2f64.powi(-34), 2f64.powi(-60)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_and_tails_make_up_the_constants() {
        // These are OEIS A007524, A007525 and A002285: the first 127 bits after the point. For log₂
        // e, which is above 1, they are the first 128 bits.
        let log10_2 = 0x2688_26a1_3ef3_fde6_23e2_566b_02df_245e_u128;
        let log2_e = 0xb8aa_3b29_5c17_f0bb_be87_fed0_691d_3e88_u128;
        let log10_e = 0x3796_f62a_4dca_1c65_4d56_eaab_eb4c_f70c_u128;
        let scaled = |part: f64| (part * 2_f64.powi(127)) as u128;
        let near = |[head, tail]: [f64; 2], exact: u128| {
            assert!((scaled(head) + scaled(tail)).abs_diff(exact) < 1 << 31, "{head} {tail:e}");
        };
        near(Base::Ten.of_two(), log10_2);
        near(Base::Two.of_e().expect("two parts"), log2_e);
        near(Base::Ten.of_e().expect("two parts"), log10_e);
        near([1.0 / 3.0, ONE_THIRD_TAIL], (1 << 127) / 3);
        assert!(LOG10_2_HI.to_bits().trailing_zeros() >= 11);
    }
}
