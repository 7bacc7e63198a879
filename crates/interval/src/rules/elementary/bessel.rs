//! Bessel functions of the first kind of the orders n = 0 to 3.
//!
//! Near 0, Jₙ(x) is (x/2)ⁿ times a power series in x², a [`CentredSeries`]. Far from 0 it is
//! √(2/πx) (P cos χ − Q sin χ) with χ = x − (2n + 1)π/4. P and Q are series in 1/x. Each errs by
//! less than its first omitted term (NIST Digital Library of Mathematical Functions, 10.17(iii)).
//! Sine and cosine of χ are sums of sin x and cos x over √2. So the angle is x itself.
//!
//! |Jₙ″| ≤ ½, since Jₙ(x) is the mean of cos(nθ − x sin θ) over θ, and sin² has the mean ½. So the
//! values over an interval of width w are within w²/16 of those at its ends, and of those between.
//!
//! Errors of these functions are relative to their amplitude, not to values near a zero.

use super::approximator::Approximator;
use super::centred::CentredSeries;
use super::double_double::{Approximation, DoubleDouble};
use super::erf::reciprocal;
use super::trigonometric::HalfPi;
use crate::bounds::Interval;
use crate::enclosure::{Enclosure, Operand};
use crate::machine::Machine;
use crate::rules::Rule;
use std::array;
use std::sync::LazyLock;

/// Number of orders: 0 to 3.
const ORDERS: usize = 4;
/// Middles of the ranges of (x/2)² that are near, in `f32` and in `f64`. The ranges end at |x| =
/// √128 and √512.
const MIDDLES: [i128; 2] = [16, 64];
/// Numbers of terms of P and of Q. At the end of the near range, terms of order 3 that are left out
/// are below 2⁻³²·⁶ in `f32` and 2⁻⁵⁸·⁷ in `f64`. Others are smaller.
const TERMS: [usize; 2] = [8, 12];
/// Errors of the functions far from 0, relative to 1/√(πx). In `f32` those of P and Q add up to
/// 0.4 · 2⁻³⁰, and those of sine and cosine to 0.2 · 2⁻³⁰. In `f64` the errors of sine and cosine,
/// by 2⁻⁵⁴ each, add up to 1.7 · 2⁻⁵⁴. Terms of P after 1 are below 0.0145; six roundings of them
/// add 0.5 · 2⁻⁵⁴, and the terms left out 0.1 · 2⁻⁵⁴.
const FAR_ERRORS: [f64; 2] = [1.0 / (1_u64 << 30) as f64, 3.0 / (1_u64 << 54) as f64];
/// Bounds of all values, rounded outward to multiples of 2⁻¹².
const RANGES: [Interval; ORDERS] = [
    Interval { lo: -0.402_832_031_25, hi: 1.0 },
    Interval { lo: -0.582_031_25, hi: 0.582_031_25 },
    Interval { lo: -0.313_720_703_125, hi: 0.486_572_265_625 },
    Interval { lo: -0.434_570_312_5, hi: 0.434_570_312_5 },
];
/// 1/π as head and tail.
const RECIPROCAL_PI: [f64; 2] = [std::f64::consts::FRAC_1_PI, -1.967_867_667_518_248_6e-17];

static SERIES: LazyLock<[[CentredSeries; ORDERS]; 2]> = LazyLock::new(|| {
    array::from_fn(|format| {
        array::from_fn(|order| {
            CentredSeries::bessel(order as i128, MIDDLES[format], near_error(format, order))
        })
    })
});

/// Error of the series near 0. Its factor (x/2)ⁿ is at most 32^(n/2) in `f32` and 128^(n/2) in
/// `f64`. So the function errs by less than 2⁻³³ and 2⁻⁵⁴.
fn near_error(format: usize, order: usize) -> f64 {
    2f64.powi([-35, -56][format] - [2, 3][format] * order as i32)
}

/// a₁, a₂, … of P and Q: aₖ = (4n² − 1²)(4n² − 3²)…(4n² − (2k − 1)²) / (k! 8ᵏ).
fn far_terms(order: usize) -> impl Iterator<Item = f64> {
    let square = (4 * order * order) as f64;
    (1..).scan(1.0, move |term, k| {
        let odd = f64::from(2 * k - 1);
        *term *= (square - odd * odd) / (8.0 * f64::from(k));
        Some(*term)
    })
}

impl<M: Machine> Rule<'_, M> {
    /// Bounds of Jₙ at both ends of its operand, each as [−lo, hi].
    pub(in crate::rules) fn bessel_at_ends(
        &mut self,
        order: usize,
        a: &Operand<M::V>,
    ) -> [[M::V; 2]; 2] {
        let reach = Reach::of(a.range, self.format.pick(0, 1));
        let bounds = self.at_both_ends(a, |approx, x| approx.bessel(order, x, &reach));
        let Reach::Anywhere(half_pi) = reach else { return bounds };
        // Larger angles are not reduced.
        let (limit, infinity) = (self.number(half_pi.limit(self.format)), self.infinity());
        let ends = [a.value.neg_lo, a.value.hi];
        array::from_fn(|end| {
            let size = self.m.abs(ends[end]);
            let near = self.m.le(size, limit);
            bounds[end].map(|bound| self.m.select(near, bound, infinity))
        })
    }

    /// Encloses Jₙ from its bounds at the ends of the operand.
    pub(in crate::rules) fn bessel(
        &mut self,
        order: usize,
        a: &Operand<M::V>,
        [first, last]: [[M::V; 2]; 2],
    ) -> Enclosure<M::V> {
        let width = self.m.add(a.value.neg_lo, a.value.hi);
        // A little more than 1/16, for machines that do not round up.
        let share = self.number((1.0 + 2f64.powi(-16)) / 16.0);
        let scaled = self.m.mul(width, share);
        let bend = self.m.mul(scaled, width);
        // √x |Jₙ(x)| ≤ 0.903 for x > 0; it is greatest at the first extremum for n = 3.
        let nearest = self.neg_mignitude(a);
        let nearest = self.m.abs(nearest);
        let (root, one) = (self.m.sqrt(nearest), self.number(1.0));
        let amplitude = self.m.div(one, root);
        let range = RANGES[order];
        let [neg_lo, hi] = [(0, -range.lo), (1, range.hi)].map(|(side, limit)| {
            let bound = self.m.max(first[side], last[side]);
            let bound = self.m.add(bound, bend);
            let limit = self.number(limit);
            let limit = self.m.min(amplitude, limit);
            self.m.min(bound, limit)
        });
        Enclosure { neg_lo, hi, ..a.value }
    }
}

/// The operands for which a routine must work.
pub(crate) enum Reach {
    /// Operands in the near range.
    Near,
    /// All operands that these parts of π/2 can reduce.
    Anywhere(&'static HalfPi),
}

impl Reach {
    /// The reach that covers operands within `range`. `format` is 0 for `f32` and 1 for `f64`.
    pub(crate) fn of(range: Interval, format: usize) -> Self {
        let end = (8.0 * MIDDLES[format] as f64).sqrt().next_down();
        if (Interval { lo: -end, hi: end }).encloses(range) {
            Self::Near
        } else {
            Self::Anywhere(HalfPi::for_angles(range))
        }
    }
}

impl<M: Machine> Approximator<'_, M> {
    /// Jₙ(x) for n = `order`. Its absolute error is below 2⁻³² in `f32` and 2⁻⁵⁴ in `f64`.
    pub(crate) fn bessel(&mut self, order: usize, x: M::V, reach: &Reach) -> Approximation<M::V> {
        let near = self.bessel_near(order, x);
        let Reach::Anywhere(half_pi) = reach else { return near };
        let size = self.m.abs(x);
        let mut far = self.bessel_far(order, size, half_pi);
        if order % 2 == 1 {
            far.sum = self.signed(x, far.sum);
        }
        let square = self.m.mul(x, x);
        let end = self.number(8.0 * MIDDLES[self.pick(0, 1)] as f64);
        let is_near = self.m.le(square, end);
        let sum = self.choose(is_near, near.sum, far.sum);
        let absolute = match (near.absolute, far.absolute) {
            (Some(near), Some(far)) => Some(self.m.select(is_near, near, far)),
            (near, far) => near.or(far),
        };
        let exponent = near.exponent.map(|exponent| self.m.and(is_near, exponent));
        Approximation { absolute, exponent, ..Approximation::new(sum, near.error) }
    }

    /// The Bessel function of this order near 0, from its series in (x/2)².
    fn bessel_near(&mut self, order: usize, x: M::V) -> Approximation<M::V> {
        let place = self.pick(0, 1);
        let w = self.beside_middle(x, reciprocal(4.0 * MIDDLES[place] as f64));
        let series = self.centred(&SERIES[place][order], w);
        let (x, exponent) = self.enlarged(x, order as i32);
        let half = self.number(0.5);
        let half = DoubleDouble::from(self.m.mul(x, half));
        let one = DoubleDouble::from(self.number(1.0));
        let power =
            (1..=order).fold(one, |power, n| if n == 1 { half } else { self.times(power, half) });
        let sum = if order == 0 { series } else { self.times(power, series) };
        let error = self.number(near_error(place, order));
        let size = self.m.abs(power.head);
        let absolute = self.m.mul(size, error);
        // The products err by 2⁻⁷⁰. Without tails they err by six roundings.
        let error = self.pick(2f64.powi(-48), 2f64.powi(-68));
        Approximation { absolute: Some(absolute), exponent, ..Approximation::new(sum, error) }
    }

    /// Jₙ(x) for x beyond the near range.
    fn bessel_far(&mut self, order: usize, x: M::V, half_pi: &HalfPi) -> Approximation<M::V> {
        let place = self.pick(0, 1);
        let [p, q] = self.bessel_factors(order, x);
        let [sin, cos] = self.waves(x, half_pi).map(|wave| wave.sum);
        let minus_cos = self.opposite(cos);
        let (above, below) = (self.sum(cos, sin), self.sum(sin, minus_cos));
        // `above` and `below` are √2 cos χ and √2 sin χ for order 0. For order 1 they are −√2 sin χ
        // and √2 cos χ. Order 2 has the negated values of order 0, and order 3 those of order 1.
        let value = if order.is_multiple_of(2) {
            let (p, q) = (self.times(p, above), self.times(q, below));
            let q = self.opposite(q);
            self.sum(p, q)
        } else {
            let (p, q) = (self.times(p, below), self.times(q, above));
            self.sum(p, q)
        };
        let value = if order >= 2 { self.opposite(value) } else { value };
        let reciprocal_pi = self.constant(RECIPROCAL_PI);
        let root = self.over(reciprocal_pi, x);
        let root = self.root(root);
        let error = self.number(FAR_ERRORS[place]);
        let absolute = self.m.mul(root.head, error);
        let sum = self.times(root, value);
        Approximation { absolute: Some(absolute), ..Approximation::new(sum, 0.0) }
    }

    /// P and Q for order n. The first term of Q has a tail; the others are small.
    fn bessel_factors(&mut self, order: usize, x: M::V) -> [DoubleDouble<M::V>; 2] {
        let count = 2 * TERMS[self.pick(0, 1)] - 1;
        let signed: Vec<f64> = far_terms(order)
            .take(count)
            .enumerate()
            .map(|(i, term)| if i.div_ceil(2) % 2 == 0 { term } else { -term })
            .collect();
        let part = |first: usize| signed[first..].iter().step_by(2).copied().collect::<Vec<_>>();
        let one = self.number(1.0);
        let inverse = self.m.div(one, x);
        let y = self.m.mul(inverse, inverse);
        let p = self.series(y, &part(1));
        let p = self.m.mul(p, y);
        let p = self.plus(one, p);
        let q = self.series(y, &part(2));
        let q = self.m.mul(q, y);
        let q = self.m.mul(q, inverse);
        let first = self.number(signed[0]);
        let first = self.over(first, x);
        [p, self.plus(first, q)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_the_reciprocal_of_pi_make_it_up() {
        // π as head and tail.
        let pi = [std::f64::consts::PI, 1.224_646_799_147_353_2e-16];
        let [head, tail] = RECIPROCAL_PI;
        let product = head.mul_add(pi[0], -1.0);
        assert!((product + head * pi[1] + tail * pi[0]).abs() < 1e-31);
    }
}
