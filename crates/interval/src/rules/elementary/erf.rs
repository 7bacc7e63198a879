//! The error function. It is 2x/√π times a power series in x² that [`CentredSeries`] computes.

use super::approximator::Approximator;
use super::centred::CentredSeries;
use super::double_double::{Approximation, DoubleDouble, TINY};
use crate::enclosure::{Enclosure, Operand};
use crate::machine::Machine;
use crate::rules::Rule;
use std::sync::LazyLock;

/// Middles of the ranges of x², in `f32` and in `f64`. The ranges end at x = 2√6 and x = 6. Beyond,
/// 1 − erf x is below 2⁻³⁷ and 2⁻⁵⁵.
const MIDDLES: [i128; 2] = [12, 18];
/// The values of the series are at least 0.147, so their relative errors are below 2⁻³⁵ and 2⁻⁵⁶.
static SERIES: LazyLock<[CentredSeries; 2]> = LazyLock::new(|| {
    let error = [2f64.powi(-38), 2f64.powi(-59)];
    [0, 1].map(|n| CentredSeries::erf(MIDDLES[n], error[n]))
});
/// 2/√π as head and tail.
const FACTOR: [f64; 2] = [std::f64::consts::FRAC_2_SQRT_PI, 1.533_545_961_316_588e-17];
/// Operands below [`TINY`] are scaled by two to this power, so that no product underflows.
const SCALE: i32 = 600;

impl<M: Machine> Rule<'_, M> {
    /// Bounds of the error function at both ends of its operand, each as [−lo, hi].
    pub(in crate::rules) fn erf_at_ends(&mut self, a: &Operand<M::V>) -> [[M::V; 2]; 2] {
        self.at_both_ends(a, |approx, x| approx.erf(x))
    }

    /// Encloses the error function, from its bounds at the ends of the operand. The function
    /// increases and stays within ±1.
    pub(in crate::rules) fn erf(
        &mut self,
        a: &Operand<M::V>,
        [first, last]: [[M::V; 2]; 2],
    ) -> Enclosure<M::V> {
        let one = self.number(1.0);
        let (neg_lo, hi) = (self.m.min(first[0], one), self.m.min(last[1], one));
        Enclosure { neg_lo, hi, ..a.value }
    }
}

impl<M: Machine> Approximator<'_, M> {
    /// erf x, odd in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁵⁴ in `f64`.
    pub(crate) fn erf(&mut self, x: M::V) -> Approximation<M::V> {
        let place = self.pick(0, 1);
        let middle = MIDDLES[place];
        let most = self.number((2.0 * middle as f64).sqrt());
        let least = self.m.neg(most);
        let x = self.m.max(x, least);
        let x = self.m.min(x, most);
        let w = self.beside_middle(x, reciprocal(middle as f64));
        let sum = self.centred(&SERIES[place], w);
        let factor = self.constant(FACTOR);
        let sum = self.times(factor, sum);
        let (x, exponent) = self.enlarged(x, 1);
        let value = self.times(x, sum);
        let error = self.pick(2f64.powi(-34), 2f64.powi(-54));
        Approximation { exponent, ..Approximation::new(value, error) }
    }

    /// Computes x² · `scale` − 1.
    pub(super) fn beside_middle(&mut self, x: M::V, scale: [f64; 2]) -> DoubleDouble<M::V> {
        let square = self.times(x, x);
        let scale = self.constant(scale);
        let ratio = self.times(square, scale);
        let minus_one = self.number(-1.0).into();
        self.sum(minus_one, ratio)
    }

    /// For results with tails, multiplies tiny operands by 2^600. Returns the exponent of the power
    /// of 2 by which the product of `count` such operands must then be multiplied.
    pub(super) fn enlarged(&mut self, x: M::V, count: i32) -> (M::V, Option<M::V>) {
        if !self.has_tails() || count == 0 {
            return (x, None);
        }
        let (magnitude, tiny) = (self.m.abs(x), self.number(TINY));
        let is_tiny = self.m.lt(magnitude, tiny);
        let (power, back) = (self.number(2f64.powi(SCALE)), self.number(f64::from(-SCALE * count)));
        let large = self.m.mul(x, power);
        (self.m.select(is_tiny, large, x), Some(self.m.and(is_tiny, back)))
    }
}

/// 1/n as head and tail.
pub(super) fn reciprocal(n: f64) -> [f64; 2] {
    let head = 1.0 / n;
    [head, -head.mul_add(n, -1.0) / n]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_the_factor_make_it_up() {
        // √π as head and tail (OEIS A002161).
        let root = [1.772_453_850_905_516, -7.666_586_499_825_799e-17];
        let [head, tail] = FACTOR;
        let product = head.mul_add(root[0], -2.0);
        let rest = head * root[1] + tail * root[0];
        assert!((product + rest).abs() < 1e-31, "{}", product + rest);
    }
}
