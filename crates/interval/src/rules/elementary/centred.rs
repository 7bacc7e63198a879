//! Power series about the middle of a range, for entire functions.
//!
//! Let f(u) = Σ (−u)ᵐ aₘ. Then f(U(1 + w)) is a power series in w. For |w| ≤ 1 it covers all u from
//! 0 to 2U. Terms of the series for f cancel near 2U. Terms of this series are smaller, and they
//! fall faster. Coefficients are computed as integers in units of 2⁻⁹⁰.

use super::approximator::Approximator;
use super::double_double::DoubleDouble;
use crate::machine::Machine;

/// Number of fraction bits of a coefficient.
const FRACTION: i32 = 90;
/// A number of terms that suffices for all series: the terms beyond sum to less than 2⁻⁹⁰.
const TERMS: usize = 128;

/// A polynomial in w for |w| ≤ 1.
pub(super) struct CentredSeries {
    /// The coefficients as sums of head and tail, starting with the coefficient of w⁰.
    coefficients: Vec<[f64; 2]>,
    /// Index of the first coefficient whose term is computed without a tail.
    plain: usize,
}

impl CentredSeries {
    /// The series for Jₙ(x) / (x/2)ⁿ with n = `order`, where (x/2)² = `middle` · (1 + w). Its error
    /// is at most `error`, including that of [`Approximator::centred`] in `f64`.
    ///
    /// Here aₘ = 1/(m! (m + n)!). The coefficient of wᵏ is
    /// (−1)ᵏ Σⱼ (−1)ʲ Uᵏ⁺ʲ / (k! j! (k + j + n)!).
    pub(super) fn bessel(order: i128, middle: i128, error: f64) -> Self {
        let mut first = (1..=order).fold(1 << FRACTION, |first, factor| first / factor);
        let coefficient = |k: i128| {
            let (mut term, mut sum, mut j) = (first, 0, 0);
            while term > 0 {
                sum += if (k + j) % 2 == 0 { term } else { -term };
                j += 1;
                term = term * middle / (j * (k + j + order));
            }
            first = first * middle / ((k + 1) * (k + 1 + order));
            sum
        };
        Self::economized((0..TERMS as i128).map(coefficient).collect(), error)
    }

    /// The series for √π/2 · erf(x)/x, where x² = `middle` · (1 + w). Its error is at most `error`,
    /// including that of [`Approximator::centred`] in `f64`.
    ///
    /// Here aₘ = 1/(m! (2m + 1)). The coefficient of wᵏ is (−1)ᵏ Cₖ. Cₖ is Uᵏ/k! times the integral
    /// of s²ᵏ exp(−Us²) over s from 0 to 1. By parts, (2k + 1) Cₖ = Pₖ + (2k + 2) Cₖ₊₁, where
    /// Pₖ = exp(−U) Uᵏ/k!.
    pub(super) fn erf(middle: i128, error: f64) -> Self {
        let powers: Vec<i128> = (1..2 * TERMS as i128)
            .scan(1 << FRACTION, |power, k| {
                let this = *power;
                *power = this * middle / k;
                Some(this)
            })
            .collect();
        // The sum of all powers is exp(U).
        let sum: i128 = powers.iter().sum();
        let mut next = 0;
        let mut coefficients: Vec<i128> = (0..TERMS)
            .rev()
            .map(|k| {
                let weight = divided(powers[k], sum);
                let k = k as i128;
                next = (weight + (2 * k + 2) * next) / (2 * k + 1);
                if k % 2 == 0 { next } else { -next }
            })
            .collect();
        coefficients.reverse();
        Self::economized(coefficients, error)
    }

    /// The shortest polynomial that differs by at most `error` / 4 from the one with these
    /// coefficients.
    ///
    /// As a sum of Chebyshev polynomials, which are at most 1, the polynomial may lose terms. The
    /// sum of their coefficients bounds the change.
    fn economized(coefficients: Vec<i128>, error: f64) -> Self {
        let most = to_fixed(error / 4.0);
        let mut chebyshev: Vec<i128> = Vec::new();
        for coefficient in coefficients.into_iter().rev() {
            chebyshev = times_w(&chebyshev);
            chebyshev[0] += coefficient;
        }
        let mut lost = 0;
        while let Some(last) = chebyshev.last()
            && lost + last.abs() <= most
        {
            lost += last.abs();
            chebyshev.pop();
        }
        let powers = to_powers(&chebyshev);
        // A coefficient without a tail, and each of the two roundings of a step, err by 2⁻⁵² of the
        // sum from there on.
        let (mut rest, mut rounding) = (0.0, 0.0);
        let mut plain = powers.len();
        while plain > 0 {
            rest += to_float(powers[plain - 1])[0].abs();
            rounding += 3.0 * 2f64.powi(-52) * rest;
            if rounding > error / 4.0 {
                break;
            }
            plain -= 1;
        }
        Self { coefficients: powers.into_iter().map(to_float).collect(), plain }
    }
}

/// The quotient of two numbers of the same unit, in units of 2⁻⁹⁰. It needs 0 ≤ `above` < `below`.
fn divided(mut above: i128, below: i128) -> i128 {
    (0..FRACTION).fold(0, |quotient, _| {
        above *= 2;
        let digit = above / below;
        above %= below;
        2 * quotient + digit
    })
}

/// The product of w and a sum of Chebyshev polynomials: w Tᵢ = (Tᵢ₋₁ + Tᵢ₊₁)/2.
fn times_w(sum: &[i128]) -> Vec<i128> {
    let mut product = vec![0; sum.len() + 1];
    for (i, coefficient) in sum.iter().enumerate() {
        let half = coefficient / 2;
        product[i + 1] += half;
        product[i.abs_diff(1)] += coefficient - half;
    }
    product
}

/// The coefficients of the powers of w in a sum of Chebyshev polynomials: Tᵢ₊₁ = 2w Tᵢ − Tᵢ₋₁.
fn to_powers(sum: &[i128]) -> Vec<i128> {
    let mut powers = vec![0; sum.len()];
    let (mut this, mut before) = (vec![1], vec![0]);
    for (i, coefficient) in sum.iter().enumerate() {
        powers.iter_mut().zip(&this).for_each(|(power, factor)| *power += coefficient * factor);
        let factor = if i == 0 { 1 } else { 2 };
        let mut next = vec![0];
        next.extend(this.iter().map(|power| factor * power));
        next.iter_mut().zip(&before).for_each(|(power, old)| *power -= old);
        before = std::mem::replace(&mut this, next);
    }
    powers
}

fn to_fixed(number: f64) -> i128 {
    (number * 2f64.powi(FRACTION)) as i128
}

/// The number as the sum of the nearest float and the rest.
fn to_float(fixed: i128) -> [f64; 2] {
    let head = fixed as f64;
    let tail = (fixed - head as i128) as f64;
    [head, tail].map(|part| part * 2f64.powi(-FRACTION))
}

impl<M: Machine> Approximator<'_, M> {
    /// Computes the polynomial at w. For results in `f32`, plain lanes add a rounding error: 2⁻⁵⁰
    /// times the number of terms times the sum of the coefficients' magnitudes.
    pub(super) fn centred(
        &mut self,
        series: &CentredSeries,
        w: DoubleDouble<M::V>,
    ) -> DoubleDouble<M::V> {
        let first = if self.has_tails() { series.plain } else { 0 };
        let heads: Vec<f64> = series.coefficients[first..].iter().map(|c| c[0]).collect();
        let later = self.series(w.head, &heads).into();
        series.coefficients[..first].iter().rev().fold(later, |sum, coefficient| {
            let coefficient = self.constant(*coefficient);
            let product = self.times(sum, w);
            self.sum(coefficient, product)
        })
    }
}
