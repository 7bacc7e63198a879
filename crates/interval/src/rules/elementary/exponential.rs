//! Routines for exponentials, powers with a real exponent, and cube roots.

use super::approximator::{Approximator, LN_2_HI, LN_2_LO, reciprocal_factorials};
use super::double_double::{Approximation, DoubleDouble};
use super::logarithm::Base;
use crate::machine::{Format, Machine};

const F64: Format = Format::F64;
/// Mask that keeps 17 bits of a significand, so that the cube of the number is exact.
const UPPER_THIRD: u64 = !((1 << 36) - 1);
/// Limit to which a power's exponent is clamped. Beyond it, powers of any base but 1 overflow or
/// underflow. Up to it, the product of exponent and logarithm is finite.
const HUGE_EXPONENT: f64 = f64::from_bits((1023 + 600) << 52); // 2^600

impl<M: Machine> Approximator<'_, M> {
    /// Encloses exp over an interval. Operand and result are `[−lo, hi]`; ends may be infinite.
    pub(crate) fn exp(&mut self, [neg_lo, hi]: [M::V; 2]) -> [M::V; 2] {
        let lo = self.m.neg(neg_lo);
        match self.target {
            Format::F32 => {
                let slack = EXP_ERROR_F32;
                let (down, up) = (self.number(-(1.0 - slack)), self.number(1.0 + slack));
                [self.exp_times(lo, down), self.exp_times(hi, up)]
            }
            Format::F64 => {
                let (at_lo, at_hi) = (self.exp_of(lo.into()), self.exp_of(hi.into()));
                [self.negated_lower(&at_lo), self.upper(&at_hi)]
            }
        }
    }

    /// Approximates exp(x) without a stated error.
    pub(crate) fn exp_near(&mut self, x: impl Into<DoubleDouble<M::V>>) -> M::V {
        let x = x.into();
        match self.target {
            Format::F32 => {
                let one = self.number(1.0);
                self.exp_times(x.head, one)
            }
            Format::F64 => {
                let near = self.exp_of(x);
                self.value(&near)
            }
        }
    }

    /// Clamps x to `least`..=`most`. Returns k and x − k·ln 2 for the nearest integer k, so that |x
    /// − k·ln 2| ≤ 0.3467.
    fn exponent_and_rest(
        &mut self,
        x: DoubleDouble<M::V>,
        [least, most]: [f64; 2],
    ) -> (M::V, DoubleDouble<M::V>) {
        let (least, most) = (self.number(least), self.number(most));
        let head = self.m.max(x.head, least);
        let head = self.m.min(head, most);
        let log2_e = self.number(std::f64::consts::LOG2_E);
        let scaled = self.m.mul(head, log2_e);
        let k = self.m.nearest(scaled);
        // The first product and the first difference are exact. The second product errs by 2⁻⁸³.
        let rest = self.subtract_multiple(head, k, LN_2_HI);
        if !self.has_tails() {
            return (k, self.subtract_multiple(rest, k, LN_2_LO).into());
        }
        let minus_lo = self.number(-LN_2_LO);
        let low = self.m.mul(k, minus_lo);
        let mut rest = self.plus(rest, low);
        if let (Some(a), Some(b)) = (rest.tail, x.tail) {
            // If x was clamped, the tail of x is dropped.
            let unlimited = self.m.eq(head, x.head);
            let b = self.m.and(unlimited, b);
            let tail = self.m.add(a, b);
            // The tail may be many ulps of the rest, but the higher terms of series use only the
            // head. So the tail is added to the head.
            rest = self.plus(rest.head, tail);
        }
        (k, rest)
    }

    /// exp(x) · factor for results in `f32`. Products are rounded up, so a negative factor gives a
    /// negated lower bound. The relative error is below [`EXP_ERROR_F32`].
    fn exp_times(&mut self, x: M::V, factor: M::V) -> M::V {
        // Results beyond these limits overflow or underflow the target.
        let (k, r) = self.exponent_and_rest(x.into(), [-160.0, 128.0]);
        // For |r| ≤ 0.3467, the omitted terms of the series, from r¹⁰/10! on, sum to less than
        // 2⁻³⁷.
        let mantissa = self.series(r.head, &reciprocal_factorials(10, 0, 1));
        let product = self.m.mul(mantissa, factor);
        let power = self.power_of_two(k);
        self.m.mul(product, power)
    }

    /// exp(x) in `f64`, with a relative error below 2⁻⁵⁵.
    ///
    /// The tail r¹⁵/15! is below 2⁻⁶³. The terms from r³/6 on are at most 0.0072 and err by six
    /// ulps. Relative to the sum, which is at least 0.707, this is 0.061 · 2⁻⁵². For results in the
    /// range of floats, the tail of x is at most a few ulps of x.
    pub(super) fn exp_of(&mut self, x: DoubleDouble<M::V>) -> Approximation<M::V> {
        let (k, r) = self.exponent_and_rest(x, [-760.0, 720.0]);
        let (one, half) = (self.number(1.0), self.number(0.5));
        let square = self.times(r, r);
        let square_half = self.scaled(square, half);
        let later = self.series(r.head, &reciprocal_factorials(12, 3, 1));
        let later = self.m.mul(later, r.head);
        let later = self.m.mul(later, square.head);
        let sum = self.plus(one, r);
        let sum = self.plus(sum, square_half);
        let sum = self.plus(sum, later);
        Approximation { exponent: Some(k), ..Approximation::new(sum, 2f64.powi(-55)) }
    }

    /// Encloses aᵇ in `f64` as `[−lo, hi]`, for finite a > 0. Ends of b may be infinite. An end
    /// exp(e) has a relative error below 2⁻⁵⁵ + 2⁻⁵⁹·|e|.
    ///
    /// The exponents e are the products of the ends of ln a and of b. The logarithm has a relative
    /// error of 2⁻⁶⁰. Comparing heads, then tails, finds the extreme exponents.
    pub(crate) fn power(&mut self, a: [M::V; 2], [b_neg_lo, b_hi]: [M::V; 2]) -> [M::V; 2] {
        let b_lo = self.m.neg(b_neg_lo);
        let ln = a.map(|a| self.ln(a, Base::E).sum);
        let mut products = Vec::new();
        for ln in ln {
            for b in [b_lo, b_hi] {
                let product = self.times_limited(ln, b);
                let tail = product.tail.expect("f64 has tails");
                products.push(self.plus(product.head, tail));
            }
        }
        let first = products[0];
        let (mut lo, mut hi) = (first, first);
        for &product in &products[1..] {
            let below = self.precedes(product, lo);
            lo = self.choose(below, product, lo);
            let above = self.precedes(hi, product);
            hi = self.choose(above, product, hi);
        }
        let [lo, hi] = [lo, hi].map(|exponent| {
            let near = self.exp_of(exponent);
            let magnitude = self.m.abs(exponent.head);
            // If the exponent is beyond ±1024, the result is 0 or ∞. A larger error would not widen
            // its bounds.
            let limit = self.number(1024.0);
            let magnitude = self.m.min(magnitude, limit);
            let relative = self.number(2f64.powi(-59));
            let extra = self.m.mul(magnitude, relative);
            Approximation { extra: Some(extra), ..near }
        });
        [self.negated_lower(&lo), self.upper(&hi)]
    }

    /// Computes a logarithm times an exponent. In `f64` the exponent is clamped to
    /// ±[`HUGE_EXPONENT`].
    pub(crate) fn times_limited(
        &mut self,
        ln: DoubleDouble<M::V>,
        mut b: M::V,
    ) -> DoubleDouble<M::V> {
        if self.has_tails() {
            let (least, most) = (self.number(-HUGE_EXPONENT), self.number(HUGE_EXPONENT));
            b = self.m.max(b, least);
            b = self.m.min(b, most);
        }
        self.times(ln, b)
    }

    /// Mask of a < b, for sums whose heads are rounded up.
    fn precedes(&mut self, a: DoubleDouble<M::V>, b: DoubleDouble<M::V>) -> M::V {
        let zero = self.number(0.0);
        let less = self.m.lt(a.head, b.head);
        let same = self.m.eq(a.head, b.head);
        let (a, b) = (a.tail.unwrap_or(zero), b.tail.unwrap_or(zero));
        let smaller = self.m.lt(a, b);
        let tie = self.m.and(same, smaller);
        self.m.or(less, tie)
    }

    /// ∛x for finite x, odd in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁶³ in `f64`.
    pub(crate) fn cbrt(&mut self, x: M::V) -> Approximation<M::V> {
        let magnitude = self.m.abs(x);
        if !self.has_tails() {
            // A Newton step squares the relative error of the guess.
            let guess = self.cbrt_guess(magnitude);
            let square = self.m.mul(guess, guess);
            let ratio = self.m.div(magnitude, square);
            let excess = self.m.sub(ratio, guess);
            let third = self.number(1.0 / 3.0);
            let correction = self.m.mul(excess, third);
            let root = self.m.add(guess, correction);
            return Approximation::new(self.odd_cbrt(root.into(), x), 2f64.powi(-34));
        }
        // Let |x| = 8ʲ·y. The number y is exact.
        let (k, m) = self.significand(magnitude);
        let (third, three) = (self.number(1.0 / 3.0), self.number(3.0));
        let exponent = self.m.mul(k, third);
        let exponent = self.m.floor(exponent);
        let whole = self.m.mul(exponent, three);
        let rest = self.m.sub(k, whole);
        let power = self.power_of_two(rest);
        let y = self.m.mul(m, power);
        // The guess g has 17 bits, so g³ and y − g³ are exact. Then ∛y = g·∛(1 + w), with w = (y −
        // g³)/g³ ≤ 2⁻¹⁴. The tail of the series in w is below 2⁻⁷². Its terms are below 2⁻¹⁵ and
        // have a relative error of 2⁻⁵⁰.
        let guess = Approximator { m: self.m, target: Format::F32 }.cbrt_guess(y);
        let mask = self.m.bits(F64, UPPER_THIRD);
        let guess = self.m.and(guess, mask);
        let cube = self.m.mul(guess, guess);
        let cube = self.m.mul(cube, guess);
        let excess = self.m.sub(y, cube);
        let w = self.m.div(excess, cube);
        let terms = self.series(w, &[1.0 / 3.0, -1.0 / 9.0, 5.0 / 81.0, -10.0 / 243.0]);
        let terms = self.m.mul(terms, w);
        let terms = self.m.mul(terms, guess);
        let root = self.plus(guess, terms);
        let root = self.odd_cbrt(root, x);
        Approximation { exponent: Some(exponent), ..Approximation::new(root, 2f64.powi(-63)) }
    }

    /// ∛x = exp(ln x / 3) for x > 0, with a relative error of about 2⁻³².
    fn cbrt_guess(&mut self, x: M::V) -> M::V {
        let third = self.number(1.0 / 3.0);
        let ln = self.ln(x, Base::E).sum.head;
        let exponent = self.m.mul(ln, third);
        self.exp_near(exponent)
    }

    /// Gives a cube root the sign of x. The result is 0 at 0.
    fn odd_cbrt(&mut self, root: DoubleDouble<M::V>, x: M::V) -> DoubleDouble<M::V> {
        let signed = self.signed(x, root);
        let zero = self.number(0.0);
        let is_zero = self.m.eq(x, zero);
        self.choose(is_zero, x.into(), signed)
    }
}

/// Bound on the relative error of [`Approximator::exp_times`]: truncation by 2⁻³⁷, and rounding.
const EXP_ERROR_F32: f64 = f64::from_bits((1023 - 34) << 52);
