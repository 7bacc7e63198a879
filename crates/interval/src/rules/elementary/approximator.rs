//! Routines that approximate elementary functions on `f64` lanes, for results in `f32` or `f64`.
//!
//! A routine approximates a function by a short sequence of lane operations that round up. It
//! states a bound on its relative error, which includes truncation and rounding. Adding that error
//! gives bounds. Coefficients are those of Taylor series on the reduced range. A series ends where
//! its stated tail is below the claimed error. Split constants follow Cody and Waite (Software
//! Manual for the Elementary Functions, 1980).

use crate::machine::{Format, Machine};
use crate::rules::Rule;

/// Computes approximations for results in the format `target`. `F32` results need shorter series.
pub(crate) struct Approximator<'a, M> {
    pub(crate) m: &'a mut M,
    pub(crate) target: Format,
}

/// Applies `routine` to both `f64` halves of each vector of `format`. Joins the results, rounded
/// up.
pub(crate) fn by_halves<M: Machine, const IN: usize, const OUT: usize>(
    m: &mut M,
    format: Format,
    inputs: [M::V; IN],
    mut routine: impl FnMut(&mut Approximator<'_, M>, [M::V; IN]) -> [M::V; OUT],
) -> [M::V; OUT] {
    match format {
        Format::F64 => routine(&mut Approximator { m, target: format }, inputs),
        Format::F32 => {
            let halves = inputs.map(|input| m.widen(input));
            let rows = [halves.map(|half| half[0]), halves.map(|half| half[1])];
            let [low, high] =
                m.repeat(rows, |m, row| routine(&mut Approximator { m, target: format }, row));
            std::array::from_fn(|i| m.narrow([low[i], high[i]]))
        }
    }
}

/// Applies `f` to both ends, then `combine` to the two results. For `f32`, it does so for both
/// `f64` halves of each vector and joins them like [`by_halves`].
pub(crate) fn at_ends<M: Machine, const IN: usize, const MID: usize, const OUT: usize>(
    m: &mut M,
    target: Format,
    ends: [[M::V; IN]; 2],
    mut f: impl FnMut(&mut Approximator<'_, M>, [M::V; IN]) -> [M::V; MID],
    mut combine: impl FnMut(&mut Approximator<'_, M>, [M::V; MID], [M::V; MID]) -> [M::V; OUT],
) -> [M::V; OUT] {
    let f = |m: &mut M, row: [M::V; IN]| f(&mut Approximator { m, target }, row);
    if target == Format::F64 {
        let [lo, hi] = m.repeat(ends, f);
        return combine(&mut Approximator { m, target }, lo, hi);
    }
    let [lo, hi] = ends.map(|end| end.map(|part| m.widen(part)));
    let rows = [
        lo.map(|half| half[0]),
        lo.map(|half| half[1]),
        hi.map(|half| half[0]),
        hi.map(|half| half[1]),
    ];
    let [l0, l1, h0, h1] = m.repeat(rows, f);
    let low = combine(&mut Approximator { m, target }, l0, h0);
    let high = combine(&mut Approximator { m, target }, l1, h1);
    std::array::from_fn(|i| m.narrow([low[i], high[i]]))
}

const F64: Format = Format::F64;

/// `LN_2_HI` + `LN_2_LO` equals ln 2 to 2⁻⁹⁵. `LN_2_HI` has 41 bits, so its product with an
/// exponent is exact.
pub(super) const LN_2_HI: f64 = f64::from_bits(0x3fe6_2e42_fefa_3000);
pub(super) const LN_2_LO: f64 = 2.823_529_056_303_157_7e-13;
impl<M: Machine> Approximator<'_, M> {
    pub(super) fn number(&mut self, value: f64) -> M::V {
        self.m.number(F64, value)
    }

    pub(super) fn pick<T>(&self, f32: T, f64: T) -> T {
        self.target.pick(f32, f64)
    }

    /// Computes c₀ + z(c₁ + z(c₂ + …)).
    pub(super) fn series(&mut self, z: M::V, coefficients: &[f64]) -> M::V {
        Rule { m: self.m, format: F64 }.series(z, coefficients)
    }

    pub(super) fn subtract_multiple(&mut self, x: M::V, k: M::V, c: f64) -> M::V {
        let c = self.number(-c);
        self.m.mul_add(k, c, x)
    }

    /// Computes 2^k for integers −1022 ≤ k ≤ 1023.
    pub(super) fn power_of_two(&mut self, k: M::V) -> M::V {
        // Adding 2^52 + 1023 leaves k + 1023 in the low bits of the significand.
        let magic = self.number(4_503_599_627_370_496.0 + 1023.0);
        let biased = self.m.add(k, magic);
        self.m.shift_left(biased, 52)
    }
}

/// Returns 1 / (first + step·n)! for n = 0…terms − 1.
pub(super) fn reciprocal_factorials(terms: u32, first: u32, step: u32) -> Vec<f64> {
    (0..terms).map(|n| 1.0 / (1..=first + step * n).map(f64::from).product::<f64>()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_ln_2_make_up_ln_2() {
        // The first 128 bits of ln 2 (OEIS A068426).
        let ln_2 = 0xb172_17f7_d1cf_79ab_c9e3_b398_03f2_f6af_u128;
        let scaled = |part: f64| (part * 2_f64.powi(127) * 2.0) as u128;
        let sum = scaled(LN_2_HI) + scaled(LN_2_LO);
        assert!(sum.abs_diff(ln_2) < 1 << 33);
        assert!(LN_2_HI.to_bits().trailing_zeros() >= 11);
    }
}
