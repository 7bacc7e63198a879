//! Routines for angles of ratios: asin, acos, atan, atan2.

use super::approximator::Approximator;
use super::double_double::{Approximation, DoubleDouble};
use crate::machine::{Format, Machine};

const F64: Format = Format::F64;
const SIGN: u64 = 1 << 63;
const TAN_EIGHTH_PI: f64 = std::f64::consts::SQRT_2 - 1.0;
const TAN_THREE_EIGHTHS_PI: f64 = std::f64::consts::SQRT_2 + 1.0;
/// π/4, π/2, 3π/4 and π, each as the nearest double and its difference from the exact value. The
/// tests compare them with π.
const QUARTER: [f64; 2] = [std::f64::consts::FRAC_PI_4, f64::from_bits(0x3c81_a626_3314_5c07)];
const HALF: [f64; 2] = [std::f64::consts::FRAC_PI_2, f64::from_bits(0x3c91_a626_3314_5c07)];
const THREE_QUARTERS: [f64; 2] =
    [f64::from_bits(0x4002_d97c_7f33_21d2), f64::from_bits(0x3c9a_7939_4c9e_8a0a)];
const WHOLE: [f64; 2] = [std::f64::consts::PI, f64::from_bits(0x3ca1_a626_3314_5c07)];
/// Differences of −1/3 and 1/6 from the doubles nearest to them.
const MINUS_ONE_THIRD_TAIL: f64 = -f64::from_bits(0x3c75_5555_5555_5555);
pub(super) const ONE_SIXTH_TAIL: f64 = f64::from_bits(0x3c65_5555_5555_5555);
/// Points farther from the origin than `FAR` are scaled down, and points nearer than `NEAR` up. So
/// sums do not overflow. Remainders underflow only for ratios below `TINY_RATIO`, at which angle
/// and ratio are equal.
const FAR: f64 = f64::from_bits((1023 + 900) << 52); // 2^900
const NEAR: f64 = f64::from_bits((1023 - 100) << 52); // 2^-100
const SCALE: f64 = f64::from_bits((1023 + 500) << 52); // 2^500
const TINY_RATIO: f64 = f64::from_bits((1023 - 800) << 52); // 2^-800

impl<M: Machine> Approximator<'_, M> {
    /// atan x, odd in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁵⁶ in `f64`, which follows
    /// from the error of [`Approximator::atan_reduced`].
    ///
    /// With t = |x|, the angle is atan t = base + atan u:
    /// - up to tan π/8, base = 0 and u = t,
    /// - up to tan 3π/8, base = π/4 and u = (t − 1)/(t + 1),
    /// - beyond, base = π/2 and u = −1/t.
    ///
    /// So |u| is at most tan π/8.
    pub(crate) fn atan(&mut self, x: M::V) -> Approximation<M::V> {
        let mut t = self.m.abs(x);
        if self.has_tails() {
            let finite = self.number(f64::MAX); // so that no remainder is ∞ − ∞
            t = self.m.min(t, finite);
        }
        let (low, high) = (self.number(TAN_EIGHTH_PI), self.number(TAN_THREE_EIGHTHS_PI));
        let (middle, far) = (self.m.lt(low, t), self.m.lt(high, t));
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        let (minus, plus) = if self.has_tails() {
            let (large, small) = (self.m.max(t, one), self.m.min(t, one));
            let minus_small = self.m.neg(small);
            let minus = self.plus(large, minus_small);
            let below_one = self.m.lt(t, one);
            (self.signed(below_one, minus), self.plus(large, small))
        } else {
            (self.m.sub(t, one).into(), self.m.add(t, one).into())
        };
        let numerator = self.choose(middle, minus, t.into());
        let numerator = self.choose(far, minus_one.into(), numerator);
        let denominator = self.choose(middle, plus, one.into());
        let denominator = self.choose(far, t.into(), denominator);
        let u = self.over(numerator, denominator);
        let base = self.masked(middle, QUARTER);
        let half = self.constant(HALF);
        let base = self.choose(far, half, base);
        let angle = self.atan_reduced(u);
        let angle = self.plus(base, angle);
        let angle = self.odd(x, angle);
        Approximation::new(angle, self.pick(2f64.powi(-34), 2f64.powi(-56)))
    }

    /// atan u for |u| ≤ 0.41422, to 2⁻³⁵ in `f32` and 2⁻⁵⁷ in `f64`.
    ///
    /// For z = u² ≤ 0.17158, the series' tail is below z¹⁴/29 in `f32` and z²²/45 in `f64`: 2⁻⁴⁰
    /// and 2⁻⁶¹ of u. In `f64` the terms from z²/5 on are at most 0.0053 of u, and five roundings
    /// by 2⁻⁵² affect them.
    fn atan_reduced(&mut self, u: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        let terms = self.pick(13, 21);
        let coefficients: Vec<f64> = (1..=terms)
            .map(|n| if n % 2 == 0 { 1.0 } else { -1.0 } / (2.0 * f64::from(n) + 1.0))
            .collect();
        self.odd_series(u, MINUS_ONE_THIRD_TAIL, &coefficients)
    }

    /// asin x for |x| ≤ 1, odd in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁵⁵ in `f64`,
    /// at most twice that of [`Approximator::arc_sine`].
    pub(crate) fn asin(&mut self, x: M::V) -> Approximation<M::V> {
        let (arc, beyond) = self.arc_sine(x);
        let half = self.constant(HALF);
        let minus_arc = self.opposite(arc);
        let rest = self.plus(half, minus_arc);
        let angle = self.choose(beyond, rest, arc);
        let angle = self.odd(x, angle);
        Approximation::new(angle, self.pick(2f64.powi(-34), 2f64.powi(-55)))
    }

    /// acos x for |x| ≤ 1, exactly 0 at 1. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁵⁶ in
    /// `f64`. This follows from the error of [`Approximator::arc_sine`]: if a constant is added to
    /// the arc, the arc is at most half the result.
    pub(crate) fn acos(&mut self, x: M::V) -> Approximation<M::V> {
        let (arc, beyond) = self.arc_sine(x);
        // acos x is π/2 − asin x. It equals 2 asin √((1 − x)/2) if x > ½, and π − 2 asin √((1 +
        // x)/2) if x < −½.
        let sign_bit = self.m.bits(F64, SIGN);
        let sign = self.m.and(x, sign_bit);
        let flip = self.m.and(beyond, sign_bit);
        let flip = self.m.xor(flip, sign_bit);
        let flip = self.m.xor(flip, sign);
        let arc = self.flipped(arc, flip);
        let zero = self.number(0.0);
        let negative = self.m.lt(x, zero);
        let straight = self.masked(negative, WHOLE);
        let half = self.constant(HALF);
        let base = self.choose(beyond, straight, half);
        let angle = self.plus(base, arc);
        Approximation::new(angle, self.pick(2f64.powi(-34), 2f64.powi(-56)))
    }

    /// Returns asin |x| for |x| ≤ ½, else 2 asin √((1 − |x|)/2), with the mask of the lanes where
    /// |x| > ½. The relative error is 2⁻³⁵ in `f32` and 2⁻⁵⁷ in `f64`.
    ///
    /// The argument w of the series has w² ≤ ¼. For its coefficients cₙ, the tail is below
    /// 1.34·c₁₄·w²⁸ in `f32` and 1.34·c₂₆·w⁵² in `f64`: 2⁻³⁵ and 2⁻⁶⁰ of w. In `f64` the terms from
    /// 3w⁴/40 on are at most 0.006 of w, and five roundings by 2⁻⁵² affect them.
    fn arc_sine(&mut self, x: M::V) -> (DoubleDouble<M::V>, M::V) {
        let t = self.m.abs(x);
        let (one, half) = (self.number(1.0), self.number(0.5));
        let beyond = self.m.lt(half, t);
        let rest = self.m.sub(one, t); // exact for |x| > ½
        let rest = self.m.mul(rest, half);
        let root = self.root(rest.into());
        let w = self.choose(beyond, root, t.into());
        let terms = self.pick(13, 25);
        let mut ratio = 1.0;
        let coefficients: Vec<f64> = (1..=terms)
            .map(|n| {
                let n = f64::from(n);
                ratio *= (2.0 * n - 1.0) / (2.0 * n);
                ratio / (2.0 * n + 1.0)
            })
            .collect();
        let arc = self.odd_series(w, ONE_SIXTH_TAIL, &coefficients);
        let two = self.number(2.0);
        let factor = self.m.select(beyond, two, one);
        (self.scaled(arc, factor), beyond)
    }

    /// The angle of the point (x, y), of which only one coordinate may be infinite. −0 counts as
    /// negative: y = −0 is below the x-axis, x = −0 left of the y-axis.
    ///
    /// The relative error is below 2⁻³⁴ in `f32` and 2⁻⁵⁵ in `f64`. It is 2⁻⁵² larger for angles
    /// below [`TINY_RATIO`].
    pub(crate) fn angle(&mut self, y: M::V, x: M::V) -> Approximation<M::V> {
        let (t, c) = self.moderate(y, x);
        let (low, high) = (self.number(TAN_EIGHTH_PI), self.number(TAN_THREE_EIGHTHS_PI));
        let (low, high) = (self.m.mul(c, low), self.m.mul(c, high));
        let (middle, far) = (self.m.lt(low, t), self.m.lt(high, t));
        let (large, small) = (self.m.max(t, c), self.m.min(t, c));
        let minus_small = self.m.neg(small);
        let difference = self.plus(large, minus_small);
        let flat = self.m.lt(t, c);
        let difference = self.signed(flat, difference);
        let sum = self.plus(large, small);
        let minus_c = self.m.neg(c);
        let above = self.choose(middle, difference, t.into());
        let above = self.choose(far, minus_c.into(), above);
        let below = self.choose(middle, sum, c.into());
        let mut below = self.choose(far, t.into(), below);
        // At the origin the ratio becomes 0, as on the rest of the x-axis.
        let least = self.number(f64::MIN_POSITIVE);
        below.head = self.m.max(below.head, least);
        let u = self.over(above, below);
        let arc = self.atan_reduced(u);
        // Left of the y-axis, the angle is π minus the angle of the mirrored point.
        let left = self.sign_of(x);
        let arc = self.flipped(arc, left);
        let (zero, half) = (self.constant([0.0; 2]), self.constant(HALF));
        let (quarter, whole) = (self.constant(QUARTER), self.constant(WHOLE));
        let three = self.constant(THREE_QUARTERS);
        let right_base = self.choose(middle, quarter, zero);
        let left_base = self.choose(middle, three, whole);
        let none = self.m.bits(F64, 0);
        let on_left = self.m.shift_right(left, 63);
        let on_left = self.m.int_sub(none, on_left);
        let base = self.choose(on_left, left_base, right_base);
        let base = self.choose(far, half, base);
        let mut angle = self.plus(base, arc);
        let mut extra = None;
        if self.has_tails() {
            // Next to the positive x-axis, the angle is the ratio |y|/|x|. It errs by an ulp or by
            // the least positive number, even if scaling down has rounded |y|.
            let tiny = self.number(TINY_RATIO);
            let magnitude = self.m.abs(angle.head);
            let is_tiny = self.m.lt(magnitude, tiny);
            angle = self.choose(is_tiny, u.head.into(), angle);
            let loose = self.number(2f64.powi(-52));
            extra = Some(self.m.and(is_tiny, loose));
        }
        let angle = self.signed(y, angle);
        Approximation {
            extra,
            ..Approximation::new(angle, self.pick(2f64.powi(-34), 2f64.powi(-55)))
        }
    }

    /// Returns |y| and |x|, scaled so that their distance from the origin is neither huge nor tiny.
    /// Infinite values become finite.
    fn moderate(&mut self, y: M::V, x: M::V) -> (M::V, M::V) {
        let (t, c) = (self.m.abs(y), self.m.abs(x));
        let (zero, one, infinity) =
            (self.number(0.0), self.number(1.0), self.number(f64::INFINITY));
        let (steep, flat) = (self.m.eq(t, infinity), self.m.eq(c, infinity));
        let t_finite = self.m.select(steep, one, t);
        let c_finite = self.m.select(flat, one, c);
        let t = self.m.select(flat, zero, t_finite);
        let c = self.m.select(steep, zero, c_finite);
        if !self.has_tails() {
            return (t, c); // no f32 is huge or tiny
        }
        let large = self.m.max(t, c);
        let (far, near) = (self.number(FAR), self.number(NEAR));
        let (is_far, is_near) = (self.m.lt(far, large), self.m.lt(large, near));
        let (up, down) = (self.number(SCALE), self.number(1.0 / SCALE));
        let scale = self.m.select(is_far, down, one);
        let scale = self.m.select(is_near, up, scale);
        (self.m.mul(t, scale), self.m.mul(c, scale))
    }

    /// Returns the constant in lanes where the mask is set, else 0.
    fn masked(&mut self, mask: M::V, constant: [f64; 2]) -> DoubleDouble<M::V> {
        let constant = self.constant(constant);
        self.each(constant, |approx, part| approx.m.and(mask, part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_and_tails_make_up_the_constants() {
        // The first 121 bits of π/2 (OEIS A062964, halved), of 1/3 and of 1/6.
        let half_pi = 0x192_1fb5_4442_d184_6989_8cc5_1701_b839_u128;
        let third = (1_u128 << 120) / 3;
        let scaled = |part: f64| (part * 2_f64.powi(120)) as u128;
        let near = |[head, tail]: [f64; 2], exact: u128| {
            assert!((scaled(head) + scaled(tail)).abs_diff(exact) < 1 << 15, "{head} {tail:e}");
        };
        near(QUARTER, half_pi / 2);
        near(HALF, half_pi);
        near(THREE_QUARTERS, half_pi * 3 / 2);
        near(WHOLE, half_pi * 2);
        near([1.0 / 3.0, -MINUS_ONE_THIRD_TAIL], third);
        near([1.0 / 6.0, ONE_SIXTH_TAIL], third / 2);
    }
}
