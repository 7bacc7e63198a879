//! Routines for the hyperbolic functions sinh, cosh and tanh.
//!
//! Let |x| = k·ln 2 + r with |r| ≤ 0.3467, and q = 4⁻ᵏ. Since e^±r = cosh r ± sinh r,
//!
//! - 2¹⁻ᵏ sinh|x| = (1 − q) cosh r + (1 + q) sinh r,
//! - 2¹⁻ᵏ cosh|x| = (1 + q) cosh r + (1 − q) sinh r.
//!
//! For k = 0 the first sum is 2 sinh r alone, so small operands lose no digits. For k ≥ 1 both sums
//! are at least 0.35.

use super::approximator::{Approximator, LN_2_HI, LN_2_LO, reciprocal_factorials};
use super::double_double::{Approximation, DoubleDouble};
use crate::machine::Machine;

/// The quantities k, q, cosh r and sinh r for e^|x|, as defined at the top of this file.
struct ExponentialParts<V> {
    /// k.
    exponent: V,
    /// 4⁻ᵏ.
    q: V,
    cosh: DoubleDouble<V>,
    sinh: DoubleDouble<V>,
}

impl<M: Machine> Approximator<'_, M> {
    /// sinh x, odd in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁵⁴ in `f64`.
    ///
    /// Tails of the series are below 2⁻³⁷ in `f32` and 2⁻⁶¹ in `f64`. In `f64` the terms of sinh r
    /// from r³/6 on are at most 0.0072, those of cosh r from r⁴/24 on at most 0.0007. Both sums of
    /// terms err by six ulps. Times 1 + q ≤ 1.25 and relative to 0.35, both errors are 0.19 · 2⁻⁵².
    /// For k = 0 only the error of sinh r counts, relative to r: 0.13 · 2⁻⁵².
    pub(crate) fn sinh(&mut self, x: M::V) -> Approximation<M::V> {
        let parts = self.exponential_parts(x);
        let minus_q = self.m.neg(parts.q);
        let sum = self.half_sum(&parts, minus_q);
        // A tiny x is doubled, because `halved` halves it for k = 0.
        let twice = self.m.add(x, x);
        let sum = self.signed(x, sum);
        let sum = self.or_where_tiny(x, twice, sum);
        self.halved(sum, parts.exponent, self.pick(2f64.powi(-34), 2f64.powi(-54)))
    }

    /// cosh x, even in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁵⁴ in `f64`. The proof is
    /// that for sinh, but the sum 2¹⁻ᵏ cosh|x| is at least 0.7.
    pub(crate) fn cosh(&mut self, x: M::V) -> Approximation<M::V> {
        let parts = self.exponential_parts(x);
        let sum = self.half_sum(&parts, parts.q);
        self.halved(sum, parts.exponent, self.pick(2f64.powi(-34), 2f64.powi(-54)))
    }

    /// tanh x, odd in x. Its relative error is below 2⁻³⁴ in `f32` and 2⁻⁵³ in `f64`: the sum of
    /// the errors of sinh and cosh.
    pub(crate) fn tanh(&mut self, x: M::V) -> Approximation<M::V> {
        let parts = self.exponential_parts(x);
        let minus_q = self.m.neg(parts.q);
        let above = self.half_sum(&parts, minus_q);
        let below = self.half_sum(&parts, parts.q);
        let quotient = self.over(above, below);
        let quotient = self.odd(x, quotient);
        Approximation::new(quotient, self.pick(2f64.powi(-34), 2f64.powi(-53)))
    }

    fn exponential_parts(&mut self, x: M::V) -> ExponentialParts<M::V> {
        // Beyond these limits, sinh and cosh overflow the target. There tanh differs from 1 by far
        // less than an ulp.
        let most = self.pick(128.0, 720.0);
        let most = self.number(most);
        let magnitude = self.m.abs(x);
        let x = self.m.min(magnitude, most);
        let log2_e = self.number(std::f64::consts::LOG2_E);
        let scaled = self.m.mul(x, log2_e);
        let exponent = self.m.nearest(scaled);
        // The first product and the first difference are exact. The second product errs by 2⁻⁸³.
        let r = self.subtract_multiple(x, exponent, LN_2_HI);
        let minus_lo = self.number(-LN_2_LO);
        let rest = self.m.mul(exponent, minus_lo);
        let r = self.plus(r, rest);
        // If k > 64, 4⁻ᵏ is far below an ulp of 1, and might underflow.
        let limit = self.number(64.0);
        let k = self.m.min(exponent, limit);
        let minus_two = self.number(-2.0);
        let k = self.m.mul(k, minus_two);
        let q = self.power_of_two(k);
        let (sinh_terms, cosh_terms) = (self.pick(4, 6), self.pick(3, 6));
        // z = r² ≤ 0.1202. The tail of sinh is z⁵/11! < 2⁻⁴⁰ in `f32`, z⁷/15! < 2⁻⁶¹ in `f64`. The
        // tail of cosh is z⁵/10! < 2⁻³⁷ in `f32`, z⁸/16! < 2⁻⁶⁸ in `f64`.
        let z = self.times(r, r);
        let sinh = self.series(z.head, &reciprocal_factorials(sinh_terms, 3, 2));
        let sinh = self.m.mul(sinh, z.head);
        let sinh = self.m.mul(sinh, r.head);
        let sinh = self.plus(r, sinh);
        let cosh = self.series(z.head, &reciprocal_factorials(cosh_terms, 4, 2));
        let square = self.m.mul(z.head, z.head);
        let cosh = self.m.mul(cosh, square);
        let (half, one) = (self.number(0.5), self.number(1.0));
        let z_half = self.scaled(z, half);
        let cosh = self.plus(z_half, cosh);
        let cosh = self.plus(one, cosh);
        ExponentialParts { exponent, q, cosh, sinh }
    }

    /// Computes (1 + p) cosh r + (1 − p) sinh r.
    fn half_sum(&mut self, parts: &ExponentialParts<M::V>, p: M::V) -> DoubleDouble<M::V> {
        let (one, minus_p) = (self.number(1.0), self.m.neg(p));
        let (above, below) = (self.plus(one, p), self.plus(one, minus_p));
        let (cosh, sinh) = (self.times(above, parts.cosh), self.times(below, parts.sinh));
        self.plus(cosh, sinh)
    }

    /// Computes sum · 2ᵏ⁻¹.
    fn halved(&mut self, sum: DoubleDouble<M::V>, k: M::V, error: f64) -> Approximation<M::V> {
        let one = self.number(1.0);
        let exponent = self.m.sub(k, one);
        if self.has_tails() {
            return Approximation { exponent: Some(exponent), ..Approximation::new(sum, error) };
        }
        // A result beyond the range of `f32` is still finite in `f64`.
        let power = self.power_of_two(exponent);
        let sum = self.scaled(sum, power);
        Approximation::new(sum, error)
    }
}
