//! Affine forms: values as linear functions of a few symbols plus an error.
//!
//! Over a segment of a ray, or over a tile of rays, a value is c + Σ sₖ·εₖ ± e, with every symbol
//! εₖ in [−1, 1]. Values share symbols, so correlated terms cancel (Comba and Stolfi 1993; for rays
//! Knoll, Hijazi, Kensler, Schott, Hansen and Hagen 2009). Each operation adds to e its rounding
//! and a bound on its nonlinear part.
//!
//! A form is valid only at points of the tile that lie in the domain for which the code is
//! compiled. So ranges that hold in the domain may be used even if the tile extends beyond it.

mod arithmetic;
mod functions;
mod pieces;
mod rays;
#[cfg(test)]
mod rounding;
mod solve;
mod waves;

use crate::bounds::Interval;
use crate::enclosure::{Claims, Enclosure, Exponent, Operand, Term};
use crate::machine::{Format, Machine};
use crate::rules::{Rule, enclose};
use crate::software::{Software, Vector128};
use std::f64::consts::{LOG2_E, LOG10_E};
use zeroset_ops::{Class, Op};

pub use rays::{PATH_UNITS, RayRange, TileRays, segment_coordinate, tile_coordinate};
pub use solve::{Contraction, contract};

/// Affine forms of `N` symbols in lanes, with the same facts as an [`Enclosure`].
///
/// If a form's center, slope or error is not finite, it claims nothing about the value.
#[derive(Clone, Copy, Debug)]
pub struct Form<V, const N: usize> {
    /// The form's value if all symbols are 0.
    pub centre: V,
    /// Coefficient of each symbol; `None` if the value depends on no symbol.
    pub slopes: Option<[V; N]>,
    /// Largest distance of the value from the linear function, not counting `units`; `None` if 0.
    error: Option<V>,
    /// Upper bound of |center| + Σ |slopes|, if one is known already.
    magnitude: Option<V>,
    /// Rounding that `error` does not include yet, in [units](Rule::unit) of `magnitude`. If it is
    /// not 0, `magnitude` must be known. Sums and products delay the rounding, so that a sum of
    /// many terms adds it only once.
    units: f64,
    /// Bounds of the value as −lo and hi, if some were found without the form.
    bounds: Option<[V; 2]>,
    /// Facts about where the value is defined and continuous.
    pub facts: Claims<V>,
}

/// An affine form as an operand of [`linearise`].
pub type FormOperand<V, const N: usize> = Term<Form<V, N>>;

impl<V: Copy, const N: usize> FormOperand<V, N> {
    /// Returns an operand about which only its form is known.
    fn new(value: Form<V, N>) -> Self {
        Self { value, range: Interval::ENTIRE, exponent: Exponent::Real }
    }
}

impl<V: Copy, const N: usize> Form<V, N> {
    /// Bound on the distance of the value from the linear function; `None` stands for 0.
    pub fn error<M: Machine<V = V>>(&self, m: &mut M, format: Format) -> Option<V> {
        Rule { m, format }.error_of(self)
    }

    /// The form with delayed rounding included in its error.
    #[must_use]
    pub fn settled<M: Machine<V = V>>(self, m: &mut M, format: Format) -> Self {
        Rule { m, format }.including_rounding(&FormOperand::new(self)).value
    }

    /// Replaces each vector, always in the same order.
    #[must_use]
    pub fn map<U: Copy>(&self, f: &mut impl FnMut(V) -> U) -> Form<U, N> {
        Form {
            centre: f(self.centre),
            slopes: self.slopes.map(|slopes| slopes.map(&mut *f)),
            error: self.error.map(&mut *f),
            magnitude: self.magnitude.map(&mut *f),
            units: self.units,
            bounds: self.bounds.map(|bounds| bounds.map(&mut *f)),
            facts: self.facts.map(f),
        }
    }

    /// A code for the structure of the form, which is known when code is compiled: the vectors that
    /// exist, the facts that hold, and the number of units.
    pub fn shape(&self) -> u128 {
        let has = [
            self.slopes.is_some(),
            self.error.is_some(),
            self.magnitude.is_some(),
            self.bounds.is_some(),
        ];
        let vectors = has.into_iter().fold(0, |code, has| 2 * code + u128::from(has));
        let units = u128::from(self.units.to_bits());
        units << 64 | vectors << 32 | self.facts.shape()
    }

    /// The form of a coordinate, which is defined everywhere. It is linear up to `error`, which
    /// includes the rounding of `centre` and `slopes`.
    pub fn coordinate(centre: V, slopes: [V; N], error: V) -> Self {
        Self::total(centre, Some(slopes), Some(error))
    }

    /// The form of a value that is defined and continuous everywhere. It has no bounds of its own.
    fn total(centre: V, slopes: Option<[V; N]>, error: Option<V>) -> Self {
        let facts = Claims::TOTAL;
        Self { centre, slopes, error, magnitude: None, units: 0.0, bounds: None, facts }
    }

    /// The form of a value that is known only by bounds, such as a parameter.
    pub fn between<M: Machine<V = V>>(m: &mut M, format: Format, value: &Enclosure<V>) -> Self {
        Rule { m, format }.form_between(value)
    }

    /// The form of a constant within `bounds`, which are exact in `format`. The software machine
    /// computes the form, so `m` only loads constants.
    pub fn constant<M: Machine<V = V>>(m: &mut M, format: Format, bounds: Interval) -> Self {
        let mut software = Software::new();
        let [neg_lo, hi] = [-bounds.lo, bounds.hi].map(|end| software.number(format, end));
        let (mut centre, mut error) = (hi, None);
        if bounds.singleton().is_none() {
            let (middle, half) = Rule { m: &mut software, format }.middle(neg_lo, hi);
            (centre, error) = (middle, Some(half));
        }
        let magnitude = software.abs(centre);
        let mut lift = |value: Vector128| {
            let bits = match value {
                Vector128::F32([lane, ..]) => lane.into(),
                Vector128::F64([lane, _]) => lane,
            };
            m.bits(format, bits)
        };
        Self {
            magnitude: Some(lift(magnitude)),
            bounds: Some([neg_lo, hi].map(&mut lift)),
            ..Self::total(lift(centre), None, error.map(&mut lift))
        }
    }
}

/// Returns bounds of a value from its form, its stored bounds and its range, with its facts.
pub fn form_bounds<M: Machine, const N: usize>(
    m: &mut M,
    format: Format,
    value: &FormOperand<M::V, N>,
) -> Enclosure<M::V> {
    Rule { m, format }.operand(value).value
}

/// Returns the form of `op` over lanes of operands, all in `format`.
///
/// # Panics
/// If the number of operands is not the arity of `op`.
pub fn linearise<M: Machine, const N: usize>(
    m: &mut M,
    format: Format,
    op: Op,
    operands: &[FormOperand<M::V, N>],
) -> Form<M::V, N> {
    assert_eq!(operands.len(), op.arity(), "{op:?}");
    let mut rule = Rule { m, format };
    let including_rounding: Vec<_>;
    let operands = if matches!(op.row().class, Class::Negation | Class::Sum | Class::Product) {
        // These operations accept forms with delayed rounding.
        operands
    } else {
        including_rounding =
            operands.iter().map(|operand| rule.including_rounding(operand)).collect();
        &including_rounding[..]
    };
    let a = &operands[0];
    // If no operand depends on a symbol, a form would be no better than bounds.
    if operands.iter().all(|operand| operand.value.slopes.is_none()) {
        return rule.bounded(op, operands);
    }
    match op {
        Op::Neg => rule.form_neg(&a.value),
        Op::Add => rule.form_sum(&a.value, &operands[1].value),
        Op::Sub => rule.form_difference(&a.value, &operands[1].value),
        Op::Mul => rule.form_product(a, &operands[1]),
        Op::Div => rule.form_quotient(a, &operands[1]),
        Op::Sqr => rule.form_square(a),
        Op::Pow => rule.form_power(a, &operands[1]),
        Op::Abs => rule.form_abs(a),
        Op::Min => {
            let (a, b) = (rule.form_neg_operand(a), rule.form_neg_operand(&operands[1]));
            let most = rule.form_max(&a, &b);
            rule.form_neg(&most)
        }
        Op::Max => rule.form_max(a, &operands[1]),
        Op::Fract => rule.form_fract(a),
        Op::Mod => rule.form_remainder(a, &operands[1]),
        Op::SelectNegative => rule.form_choice(operands),
        Op::Otherwise => rule.form_otherwise(operands),
        Op::WhereNonneg | Op::WherePositive | Op::WhereNonzero | Op::WhereDefined => {
            rule.form_restricted(op, operands)
        }
        Op::Sqrt => rule.form_sqrt(a),
        Op::Sin | Op::Cos => {
            let both = rule.form_waves(a);
            both[usize::from(op == Op::Cos)]
        }
        Op::Exp => rule.form_curve(op, Rule::shape_of_exp, a),
        Op::Ln => rule.form_curve(op, Rule::shape_of_ln, a),
        Op::Log2 => rule.form_curve(op, |rule, at| rule.shape_of_logarithm(LOG2_E, at), a),
        Op::Log10 => rule.form_curve(op, |rule, at| rule.shape_of_logarithm(LOG10_E, at), a),
        Op::Cbrt => rule.form_curve(op, Rule::shape_of_cbrt, a),
        Op::Tan => rule.form_curve(op, Rule::shape_of_tan, a),
        Op::Asin => rule.form_curve(op, Rule::shape_of_asin, a),
        Op::Acos => rule.form_curve(op, Rule::shape_of_acos, a),
        Op::Atan => rule.form_curve(op, Rule::shape_of_atan, a),
        Op::Sinh => rule.form_curve(op, |rule, at| rule.shape_of_hyperbolic(Op::Cosh, at), a),
        Op::Cosh => rule.form_curve(op, |rule, at| rule.shape_of_hyperbolic(Op::Sinh, at), a),
        Op::Tanh => rule.form_curve(op, Rule::shape_of_tanh, a),
        Op::Asinh => rule.form_curve(op, Rule::shape_of_asinh, a),
        Op::Acosh => rule.form_curve(op, Rule::shape_of_acosh, a),
        Op::Atanh => rule.form_curve(op, Rule::shape_of_atanh, a),
        Op::Erf => {
            let bounds = rule.operand(a);
            let ends = rule.erf_at_ends(&bounds);
            let value = rule.erf(&bounds, ends);
            // |f″| = 4|x| exp(−x²)/√π is greatest at 1/√2.
            rule.form_chord(a, &bounds, ends, &value, 0.968_75)
        }
        Op::BesselJ0 | Op::BesselJ1 | Op::BesselJ2 | Op::BesselJ3 => {
            let (order, bounds) = (op.bessel_order(), rule.operand(a));
            let ends = rule.bessel_at_ends(order, &bounds);
            let value = rule.bessel(order, &bounds, ends);
            rule.form_chord(a, &bounds, ends, &value, 0.5)
        }
        Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc | Op::Atan2 => {
            rule.bounded(op, operands)
        }
    }
}

/// Returns the forms of `op` and its twin for the same operand, or `None` if the two share no work.
pub fn linearise_sincos<M: Machine, const N: usize>(
    m: &mut M,
    format: Format,
    op: Op,
    a: &FormOperand<M::V, N>,
) -> Option<[Form<M::V, N>; 2]> {
    if op.row().twin.is_none() || a.value.slopes.is_none() {
        return None;
    }
    let mut rule = Rule { m, format };
    let a = rule.including_rounding(a);
    let [sin, cos] = rule.form_waves(&a);
    Some(if op == Op::Sin { [sin, cos] } else { [cos, sin] })
}

impl<M: Machine> Rule<'_, M> {
    /// The unit of rounding. A result, rounded up or to nearest, errs by less than this fraction of
    /// itself.
    fn unit(&self) -> f64 {
        2f64.powi(self.format.pick(-23, -52))
    }

    fn plus_tiny(&mut self, error: M::V) -> M::V {
        let tiny = self.tiny();
        self.m.add(error, tiny)
    }

    /// More than the total error of a dozen subnormal results.
    fn tiny(&mut self) -> M::V {
        self.m.bits(self.format, 64)
    }

    /// The form that has only the bounds from the operation's interval rule.
    fn bounded<const N: usize>(
        &mut self,
        op: Op,
        operands: &[FormOperand<M::V, N>],
    ) -> Form<M::V, N> {
        let (_, value) = self.enclosed(op, operands);
        self.form_between(&value)
    }

    /// The bounds of all operands, and the enclosure by the operation's interval rule.
    fn enclosed<const N: usize>(
        &mut self,
        op: Op,
        operands: &[FormOperand<M::V, N>],
    ) -> (Vec<Operand<M::V>>, Enclosure<M::V>) {
        let operands: Vec<_> = operands.iter().map(|operand| self.operand(operand)).collect();
        let value = enclose(self.m, self.format, op, &operands);
        (operands, value)
    }

    /// The middle of bounds, and at least half their width: lo and hi are within middle ± half.
    fn middle(&mut self, neg_lo: M::V, hi: M::V) -> (M::V, M::V) {
        let half = self.number(0.5);
        let sum = self.m.sub(hi, neg_lo);
        let middle = self.m.mul(sum, half);
        let above = self.m.sub(hi, middle);
        let below = self.m.add(neg_lo, middle);
        (middle, self.m.max(above, below))
    }

    fn form_between<const N: usize>(&mut self, value: &Enclosure<M::V>) -> Form<M::V, N> {
        let (centre, error) = self.middle(value.neg_lo, value.hi);
        Form {
            bounds: Some([value.neg_lo, value.hi]),
            facts: value.facts,
            ..Form::total(centre, None, Some(error))
        }
    }

    /// Σ |slopes|, or `None` if the form depends on no symbol.
    fn spread<const N: usize>(&mut self, a: &Form<M::V, N>) -> Option<M::V> {
        let slopes = a.slopes?;
        let sizes = slopes.map(|slope| self.m.abs(slope));
        let (first, rest) = sizes.split_first().expect("a symbol");
        Some(rest.iter().fold(*first, |sum, size| self.m.add(sum, *size)))
    }

    /// Upper bound of |center| + Σ |slopes|.
    fn magnitude_of<const N: usize>(&mut self, a: &Form<M::V, N>) -> M::V {
        if let Some(magnitude) = a.magnitude {
            return magnitude;
        }
        let size = self.m.abs(a.centre);
        match self.spread(a) {
            Some(spread) => self.m.add(size, spread),
            None => size,
        }
    }

    /// The form's error, including delayed rounding.
    fn error_of<const N: usize>(&mut self, a: &Form<M::V, N>) -> Option<M::V> {
        match a.magnitude {
            Some(magnitude) if a.units > 0.0 => Some(self.rounded(a.error, a.units, magnitude)),
            _ => a.error,
        }
    }

    /// The operand with delayed rounding added to its error, so that uses need not add it again.
    fn including_rounding<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
    ) -> FormOperand<M::V, N> {
        let value = Form { error: self.error_of(&a.value), units: 0.0, ..a.value };
        FormOperand { value, ..*a }
    }

    /// Applies `op` to pairs of centers or slopes. The errors of forms count the rounding of `op`.
    fn pairwise<const N: usize>(
        &mut self,
        a: [M::V; N],
        b: [M::V; N],
        op: impl Fn(&mut M, M::V, M::V) -> M::V,
    ) -> [M::V; N] {
        std::array::from_fn(|k| op(self.m, a[k], b[k]))
    }

    /// The operand's bounds for an interval rule. For a form that depends on a symbol, they are the
    /// intersection of its own bounds, its stored bounds and the operand's range.
    fn operand<const N: usize>(&mut self, a: &FormOperand<M::V, N>) -> Operand<M::V> {
        let bounds = match (a.value.slopes, a.value.bounds) {
            (None, Some(bounds)) => bounds,
            (_, known) => {
                let spread = self.spread(&a.value);
                let error = self.error_of(&a.value);
                let [mut neg_lo, mut hi] = match self.sum_of(spread, error) {
                    Some(reach) => {
                        [self.m.sub(reach, a.value.centre), self.m.add(reach, a.value.centre)]
                    }
                    None => [self.m.neg(a.value.centre), a.value.centre],
                };
                // If the form's own bound is NaN, `min` returns the stored bound.
                if let Some([known_neg_lo, known_hi]) = known {
                    neg_lo = self.m.min(neg_lo, known_neg_lo);
                    hi = self.m.min(hi, known_hi);
                }
                self.within([neg_lo, hi], a.range)
            }
        };
        a.with(a.value.facts.with(bounds))
    }

    /// Like [`Self::operand`], but if bounds are stored, the form's own bounds are not computed.
    fn operand_from_bounds<const N: usize>(&mut self, a: &FormOperand<M::V, N>) -> Operand<M::V> {
        let (Some(_), Some(bounds)) = (a.value.slopes, a.value.bounds) else {
            return self.operand(a);
        };
        let bounds = self.within(bounds, a.range);
        a.with(a.value.facts.with(bounds))
    }

    /// Intersects bounds with `range`, which holds on the whole domain.
    fn within(&mut self, [neg_lo, hi]: [M::V; 2], range: Interval) -> [M::V; 2] {
        let (range_neg_lo, range_hi) = (self.number(-range.lo), self.number(range.hi));
        let neg_lo = self.m.min(neg_lo, range_neg_lo);
        let hi = self.m.min(hi, range_hi);
        // If bounds and range are disjoint, there is no value, and any bounds hold. They must still
        // be in order, since rules rely on it.
        let range_lo = self.number(range.lo);
        let hi = self.m.max(hi, range_lo);
        let neg_hi = self.m.neg(hi);
        [self.m.max(neg_lo, neg_hi), hi]
    }

    /// Adds the bounds and facts of `value`, the interval rule's result, to `form`. In lanes where
    /// the form's error is not below half the width of these bounds, they replace the form.
    fn with_bounds<const N: usize>(
        &mut self,
        form: &Form<M::V, N>,
        value: &Enclosure<M::V>,
    ) -> Form<M::V, N> {
        let plain = self.form_between::<N>(value);
        let (Some(error), Some(width)) = (self.error_of(form), plain.error) else {
            return Form { facts: value.facts, bounds: plain.bounds, ..*form };
        };
        let better = self.m.lt(error, width);
        let zero = self.zero();
        Form {
            centre: self.m.select(better, form.centre, plain.centre),
            slopes: form
                .slopes
                .map(|slopes| slopes.map(|slope| self.m.select(better, slope, zero))),
            error: Some(self.m.select(better, error, width)),
            magnitude: None,
            ..plain
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_has_the_form_that_its_bounds_have() {
        let m = &mut Software::new();
        let above = |number: f64| f64::from((number as f32).next_up());
        for lo in [-3.0, -f64::from(1e-45_f32), 0.0, 0.5, 2f64.powi(100), f64::from(f32::MAX)] {
            for hi in [lo, above(lo), above(above(above(lo)))] {
                for format in [Format::F32, Format::F64] {
                    let [neg_lo, upper] = [-lo, hi].map(|end| m.number(format, end));
                    let enclosure = Enclosure::total(neg_lo, upper);
                    let form = Form::<_, 3>::constant(m, format, Interval { lo, hi });
                    assert_eq!(form.bounds, Some([neg_lo, upper]), "{lo} to {hi}");
                    assert_eq!(form.magnitude, Some(m.abs(form.centre)));
                    assert_eq!(form.error.is_none(), lo == hi);
                    let middle = Form::<_, 3>::between(m, format, &enclosure);
                    // For lo = hi, `between` may overflow when it adds the ends. `constant` does
                    // not add them.
                    if lo != hi || lo < 1e38 {
                        let zero = m.number(format, 0.0);
                        assert_eq!(form.centre, middle.centre, "{lo} to {hi}");
                        assert_eq!(form.error.unwrap_or(zero), middle.error.expect("some"));
                    }
                }
            }
        }
    }
}
