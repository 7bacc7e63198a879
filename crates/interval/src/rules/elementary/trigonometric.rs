//! Routines for sine, cosine and tangent. Angles up to [`HalfPi::limit`] are reduced by multiples
//! of π/2.

use super::approximator::{Approximator, reciprocal_factorials};
use super::arc::ONE_SIXTH_TAIL;
use super::double_double::{Approximation, DoubleDouble};
use crate::bounds::Interval;
use crate::machine::{Format, Machine};

const F64: Format = Format::F64;

/// π/2 as a sum of parts. All parts but the last have so few bits that their products with any k up
/// to the limit are exact. The tests compare the parts with π.
pub(crate) struct HalfPi {
    /// The parts for results in `f32`.
    f32: &'static [f64],
    /// The parts for results in `f64`.
    f64: &'static [f64],
    /// Largest magnitude of an angle that is reduced, in `f32` and in `f64`.
    limits: [f64; 2],
}

/// The parts have 33 bits, for k of 20 bits.
static COMMON: HalfPi = HalfPi {
    f32: &[f64::from_bits(0x3ff9_21fb_5440_0000), f64::from_bits(0x3dd0_b461_1a62_6331)],
    f64: &[
        f64::from_bits(0x3ff9_21fb_5440_0000),
        f64::from_bits(0x3dd0_b461_1a60_0000),
        f64::from_bits(0x3ba3_198a_2e00_0000),
        f64::from_bits(0x397b_839a_2520_49c1),
    ],
    limits: [1_048_576.0; 2], // 2^20
};

/// The parts have 20 bits, for k of 33 bits. In `f32` the number of turns is exact for angles up to
/// 2²³. Beyond that, neighboring floats differ by more than half a radian.
static LARGE: HalfPi = HalfPi {
    f32: &[
        f64::from_bits(0x3ff9_21fa_0000_0000),
        f64::from_bits(0x3eb5_4442_0000_0000),
        f64::from_bits(0x3d6a_308d_3131_98a3),
    ],
    f64: &[
        f64::from_bits(0x3ff9_21fa_0000_0000),
        f64::from_bits(0x3eb5_4442_0000_0000),
        f64::from_bits(0x3d6a_308c_0000_0000),
        f64::from_bits(0x3c23_1318_0000_0000),
        f64::from_bits(0x3ae8_a2e0_0000_0000),
        f64::from_bits(0x397b_839a_2520_49c1),
    ],
    limits: [8_388_608.0, 8_589_934_592.0], // 2^23, 2^33
};

impl HalfPi {
    /// Returns the shortest sum that can reduce all angles within `range`. If there is none,
    /// returns the sum with the largest limit.
    pub(crate) fn for_angles(range: Interval) -> &'static Self {
        let limit = COMMON.limits[0];
        if (Interval { lo: -limit, hi: limit }).encloses(range) { &COMMON } else { &LARGE }
    }

    /// Largest magnitude of an angle that is reduced. For larger angles, sine and cosine are only
    /// known to be in [−1, 1].
    pub(crate) fn limit(&self, format: Format) -> f64 {
        format.pick(self.limits[0], self.limits[1])
    }
}

impl<M: Machine> Approximator<'_, M> {
    /// Reduces an angle x up to the limit. The absolute error is 2⁻⁶⁷ for results in `f32`, the
    /// relative error 2⁻⁵⁸ for results in `f64`.
    ///
    /// If x is within 2⁻¹⁹ quarter turns of the middle between two multiples of π/2, k may belong
    /// to either. By continued fractions, no `f64` up to 2³³ but 0 is closer than 2⁻⁶⁰·⁵ to a
    /// multiple of π/2, and no `f32` up to 2²³ closer than 2⁻²⁷·⁹. The last product errs by 2⁻¹¹⁹
    /// in `f64`.
    fn reduce(&mut self, x: M::V, half_pi: &HalfPi) -> Angle<M::V> {
        let two_over_pi = self.number(std::f64::consts::FRAC_2_PI);
        let quarters = self.m.mul(x, two_over_pi);
        let k = self.m.nearest(quarters);
        let parts = self.pick(half_pi.f32, half_pi.f64);
        // The first product is exact, and so is its difference from x.
        let first = self.subtract_multiple(x, k, parts[0]);
        let (last, middle) = parts[1..].split_last().expect("two parts");
        let rest = if self.has_tails() {
            // The products of the middle parts are exact. Their differences are exact where they
            // cancel. Elsewhere the tails hold the rounding.
            let mut rest = DoubleDouble::from(first);
            for part in middle {
                let part = self.number(-part);
                let multiple = self.m.mul(k, part);
                let next = self.plus(rest.head, multiple);
                rest = DoubleDouble { head: next.head, tail: self.tails(rest.tail, next.tail) };
            }
            let last = self.number(-last);
            let multiple = self.m.mul(k, last);
            let tail = self.tails(rest.tail, Some(multiple)).expect("a product");
            self.plus(rest.head, tail)
        } else {
            // All differences but the last are exact.
            let rest =
                middle.iter().fold(first, |rest, part| self.subtract_multiple(rest, k, *part));
            self.subtract_multiple(rest, k, *last).into()
        };
        // Adding 1.5 · 2^52 leaves negative k in the low bits too.
        let magic = self.number(6_755_399_441_055_744.0);
        let bits = self.m.add(k, magic);
        let half = self.number(0.5);
        let sign = self.sign_of(rest.head);
        let side = self.m.or(sign, half);
        Angle { rest, bits, quarters: self.m.add(k, side) }
    }

    /// sin r for |r| ≤ π/4, to 2⁻³⁵ in `f32` and 2⁻⁵⁷ in `f64`.
    ///
    /// The omitted terms are at most r¹³/13! in `f32` and r¹⁹/19! in `f64`, below 2⁻³⁶ and 2⁻⁶³ of
    /// r. In `f64` the terms from r⁵/120 on are at most 0.0032 of r, and five roundings by 2⁻⁵²
    /// affect them.
    fn sin_reduced(&mut self, r: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        let terms = self.pick(5, 8);
        self.odd_series(r, -ONE_SIXTH_TAIL, &alternating(terms, 3))
    }

    /// cos r for |r| ≤ π/4, to 2⁻³⁵ in `f32` and 2⁻⁵⁴ in `f64`.
    ///
    /// The omitted terms are at most r¹⁴/14! in `f32` and r²⁰/20! in `f64`, below 2⁻⁴¹ and 2⁻⁶⁷. In
    /// `f64`, the terms from r⁴/24 on are at most 0.0159, and six roundings by 2⁻⁵² affect them.
    /// The relative error is this error over cos r, which is at least 0.707.
    fn cos_reduced(&mut self, r: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        let coefficients = alternating(self.pick(6, 9), 2);
        let one = self.number(1.0);
        let z = self.times(r, r);
        if !self.has_tails() {
            let later = self.series(z.head, &coefficients);
            let later = self.m.mul(later, z.head);
            return self.plus(one, later);
        }
        let later = self.series(z.head, &coefficients[1..]);
        let later = self.m.mul(later, z.head);
        let later = self.m.mul(later, z.head);
        let minus_half = self.number(-0.5);
        let second = self.scaled(z, minus_half);
        let sum = self.plus(one, second);
        self.plus(sum, later)
    }

    /// Mask of the lanes in which bit 0 of k is set.
    fn odd_lanes(&mut self, k: M::V) -> M::V {
        let (one, zero) = (self.m.bits(F64, 1), self.m.bits(F64, 0));
        let set = self.m.and(k, one);
        self.m.int_sub(zero, set)
    }

    /// Flips the sign of `value` in lanes where bit 1 of k is set.
    fn flip_by_bit_1(&mut self, value: DoubleDouble<M::V>, k: M::V) -> DoubleDouble<M::V> {
        let two = self.m.bits(F64, 2);
        let set = self.m.and(k, two);
        let sign = self.m.shift_left(set, 62);
        self.flipped(value, sign)
    }

    /// Returns sin x and [`Angle::quarters`]. Up to the limit, the relative error is below 2⁻³⁴ in
    /// `f32` and 2⁻⁵⁴ in `f64`. Beyond the limit, the sine is arbitrary.
    pub(crate) fn sin(&mut self, x: M::V, half_pi: &HalfPi) -> (Approximation<M::V>, M::V) {
        let angle = self.reduce(x, half_pi);
        let reduced = [self.sin_reduced(angle.rest), self.cos_reduced(angle.rest)];
        (self.sin_of(x, &angle, reduced), angle.quarters)
    }

    /// Returns cos x and [`Angle::quarters`]. Up to the limit, the relative error is that of
    /// [`Self::sin`]. Beyond the limit, the cosine is arbitrary.
    pub(crate) fn cos(&mut self, x: M::V, half_pi: &HalfPi) -> (Approximation<M::V>, M::V) {
        let angle = self.reduce(x, half_pi);
        let reduced = [self.sin_reduced(angle.rest), self.cos_reduced(angle.rest)];
        (self.cos_of(&angle, reduced), angle.quarters)
    }

    /// Returns sin x and cos x, as [`Self::sin`] and [`Self::cos`] do.
    pub(crate) fn waves(&mut self, x: M::V, half_pi: &HalfPi) -> [Approximation<M::V>; 2] {
        let angle = self.reduce(x, half_pi);
        let reduced = [self.sin_reduced(angle.rest), self.cos_reduced(angle.rest)];
        [self.sin_of(x, &angle, reduced), self.cos_of(&angle, reduced)]
    }

    /// The sine of x, from the sine and cosine of the reduced angle.
    fn sin_of(
        &mut self,
        x: M::V,
        angle: &Angle<M::V>,
        [sin, cos]: [DoubleDouble<M::V>; 2],
    ) -> Approximation<M::V> {
        let odd = self.odd_lanes(angle.bits);
        let value = self.choose(odd, cos, sin);
        let value = self.flip_by_bit_1(value, angle.bits);
        let value = self.or_tiny(x, value);
        Approximation::new(value, self.pick(WAVE_ERROR_F32, 2f64.powi(-54)))
    }

    /// The cosine of an angle, from the sine and cosine of the reduced angle.
    fn cos_of(
        &mut self,
        angle: &Angle<M::V>,
        [sin, cos]: [DoubleDouble<M::V>; 2],
    ) -> Approximation<M::V> {
        let odd = self.odd_lanes(angle.bits);
        let value = self.choose(odd, sin, cos);
        let one = self.m.bits(F64, 1);
        let next = self.m.int_add(angle.bits, one);
        let value = self.flip_by_bit_1(value, next);
        Approximation::new(value, self.pick(WAVE_ERROR_F32, 2f64.powi(-54)))
    }

    /// Returns tan x and [`Angle::quarters`]. Up to the limit, the relative error is below 2⁻³⁴ in
    /// `f32` and 2⁻⁵³ in `f64`: the sum of the errors of sine and cosine. Beyond the limit, the
    /// tangent is arbitrary.
    pub(crate) fn tan(&mut self, x: M::V, half_pi: &HalfPi) -> (Approximation<M::V>, M::V) {
        let angle = self.reduce(x, half_pi);
        let (sin, cos) = (self.sin_reduced(angle.rest), self.cos_reduced(angle.rest));
        let odd = self.odd_lanes(angle.bits);
        let minus_cos = self.opposite(cos);
        let above = self.choose(odd, minus_cos, sin);
        let below = self.choose(odd, sin, cos);
        let value = self.over(above, below);
        let value = self.or_tiny(x, value);
        (Approximation::new(value, self.pick(WAVE_ERROR_F32, 2f64.powi(-53))), angle.quarters)
    }
}

/// Bound on the relative error of sine, cosine and tangent in `f32`.
pub(super) const WAVE_ERROR_F32: f64 = f64::from_bits((1023 - 34) << 52);

/// An angle as k quarter turns and a rest.
struct Angle<V> {
    /// The angle minus k·π/2.
    rest: DoubleDouble<V>,
    /// The integer k, in the low bits.
    bits: V,
    /// k + ½ if the rest is positive, k − ½ if it is negative: a count of quarter turns on the
    /// angle's side of k.
    quarters: V,
}

/// Returns (−1)ⁿ / (first + 2n − 2)! for n = 1…terms. This is the series of sine (first = 3) or
/// cosine (first = 2) without its first term.
fn alternating(terms: u32, first: u32) -> Vec<f64> {
    let mut coefficients = reciprocal_factorials(terms, first, 2);
    coefficients.iter_mut().step_by(2).for_each(|c| *c = -*c);
    coefficients
}

#[cfg(test)]
impl Approximator<'_, super::recorded::Program> {
    /// Names the parts of a reduced angle.
    pub(super) fn name_reduced(&mut self, x: usize, half_pi: &HalfPi) {
        let Angle { rest, bits, .. } = self.reduce(x, half_pi);
        self.m.name("rest", rest.head);
        self.m.name("rest tail", rest.tail.expect("a tail"));
        self.m.name("turns", bits);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_half_pi_make_up_half_pi() {
        // The first 121 bits of π/2 (OEIS A062964, halved).
        let half_pi = 0x192_1fb5_4442_d184_6989_8cc5_1701_b839_u128;
        let scaled = |part: &f64| (part * 2_f64.powi(120)) as u128;
        let sum = |parts: &[f64]| parts.iter().map(scaled).sum::<u128>();
        for (table, bits) in [(&COMMON, 33), (&LARGE, 20)] {
            assert_eq!(sum(table.f64), half_pi);
            assert!(sum(table.f32).abs_diff(half_pi) < 1 << 34);
            for part in [table.f32, table.f64].iter().flat_map(|parts| &parts[..parts.len() - 1]) {
                let zeros = part.to_bits().trailing_zeros();
                assert!(zeros >= 53 - bits, "{part:e} has more than {bits} bits");
            }
        }
        // The last part has the next bits of π/2, up to the 156th.
        assert_eq!(COMMON.f64[3] * 2_f64.powi(156), 0x1b_839a_2520_49c1_u64 as f64);
    }
}
