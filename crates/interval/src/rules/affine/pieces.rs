//! Affine forms of piecewise functions: magnitudes, extrema, remainders, choices, restrictions.
//!
//! In lanes where only one piece applies, the result is the form of that piece. In other lanes it
//! is a line between the pieces, or bounds.

use super::{Form, FormOperand};
use crate::bounds::Interval;
use crate::branch::Branch;
use crate::enclosure::{Enclosure, Fact, Operand};
use crate::machine::Machine;
use crate::rules::Rule;
use zeroset_ops::Op;

impl<M: Machine> Rule<'_, M> {
    /// The form of |x|. For 0 in [lo, hi] and −1 ≤ α ≤ 1, |x| − αx is ≥ 0, and greatest at an end.
    pub(super) fn form_abs<const N: usize>(&mut self, a: &FormOperand<M::V, N>) -> Form<M::V, N> {
        let bounds = self.operand(a);
        let value = self.abs(&bounds);
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        let Enclosure { neg_lo, hi, .. } = bounds.value;
        let (above, below) = (self.m.sub(hi, neg_lo), self.m.add(hi, neg_lo));
        let slope = self.m.div(above, below);
        let slope = self.m.min(slope, one);
        let slope = self.m.max(slope, minus_one);
        let at_lo = self.m.mul(slope, neg_lo);
        let at_lo = self.m.add(neg_lo, at_lo);
        let opposite = self.m.neg(slope);
        let at_hi = self.m.mul(opposite, hi);
        let at_hi = self.m.add(hi, at_hi);
        let most = self.m.max(at_lo, at_hi);
        let form = self.form_of_pieces(&a.value, &bounds, slope, most, [-1.0, 1.0]);
        self.with_bounds(&form, &value)
    }

    /// The form of a function of two linear pieces that meet at a = 0, where its value is 0.
    /// `pieces` are the slopes of the pieces. The function is between `slope`·a and `slope`·a +
    /// `most`. In lanes where a has one sign, the result is the form of one piece.
    fn form_of_pieces<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        bounds: &Operand<M::V>,
        slope: M::V,
        most: M::V,
        pieces: [f64; 2],
    ) -> Form<M::V, N> {
        let zero = self.zero();
        let [below, above] = pieces.map(|slope| self.number(slope));
        let half = self.number(0.5);
        let rest = self.m.mul(most, half);
        let positive = self.m.le(bounds.value.neg_lo, zero);
        let negative = self.m.le(bounds.value.hi, zero);
        let either = self.m.or(positive, negative);
        let slope = self.m.select(negative, below, slope);
        let slope = self.m.select(positive, above, slope);
        let rest = self.m.select(either, zero, rest);
        self.form_line(a, slope, rest, rest)
    }

    /// The form of max(a, b) = b + max(a − b, 0).
    pub(super) fn form_max<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        b: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let (a_bounds, b_bounds) = (self.operand(a), self.operand(b));
        let value = self.max(&a_bounds, &b_bounds);
        let (zero, one) = (self.zero(), self.number(1.0));
        let difference = self.form_difference(&a.value, &b.value);
        let bounds = self.operand(&FormOperand::new(difference));
        let Enclosure { neg_lo, hi, .. } = bounds.value;
        let width = self.m.add(hi, neg_lo);
        let slope = self.m.div(hi, width);
        let slope = self.m.min(slope, one);
        let slope = self.m.max(slope, zero);
        // The largest value of max(d, 0) − αd is −α·lo or (1 − α)·hi.
        let at_lo = self.m.mul(slope, neg_lo);
        let opposite = self.m.neg(slope);
        let at_hi = self.m.mul(opposite, hi);
        let at_hi = self.m.add(hi, at_hi);
        let most = self.m.max(at_lo, at_hi);
        let above = self.form_of_pieces(&difference, &bounds, slope, most, [0.0, 1.0]);
        let sum = self.form_sum(&b.value, &above);
        let first = self.m.le(neg_lo, zero);
        let second = self.m.le(hi, zero);
        let form = self.form_select(second, &b.value, &sum);
        let form = self.form_select(first, &a.value, &form);
        self.with_bounds(&form, &value)
    }

    /// The form of `a` in the lanes of the mask, and of `b` in the other lanes. Bounds and facts
    /// are taken from `b`.
    fn form_select<const N: usize>(
        &mut self,
        mask: M::V,
        a: &Form<M::V, N>,
        b: &Form<M::V, N>,
    ) -> Form<M::V, N> {
        let zero = self.zero();
        let slopes = match (a.slopes, b.slopes) {
            (None, None) => None,
            (a, b) => {
                let [a, b] = [a, b].map(|slopes| slopes.unwrap_or([zero; N]));
                Some(std::array::from_fn(|k| self.m.select(mask, a[k], b[k])))
            }
        };
        let error = match (self.error_of(a), self.error_of(b)) {
            (None, None) => None,
            (a, b) => Some(self.m.select(mask, a.unwrap_or(zero), b.unwrap_or(zero))),
        };
        Form {
            bounds: b.bounds,
            facts: b.facts,
            ..Form::total(self.m.select(mask, a.centre, b.centre), slopes, error)
        }
    }

    /// The form of x − floor(x).
    pub(super) fn form_fract<const N: usize>(&mut self, a: &FormOperand<M::V, N>) -> Form<M::V, N> {
        let bounds = self.operand(a);
        let value = self.fract(&bounds, Branch::Whole);
        let floor = self.floor(&bounds, Branch::Whole);
        let floor = self.form_between(&floor);
        let form = self.form_difference(&a.value, &floor);
        self.with_bounds(&form, &value)
    }

    /// The form of a − b·floor(a/b).
    pub(super) fn form_remainder<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        b: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let (a_bounds, b_bounds) = (self.operand(a), self.operand(b));
        let value = self.modulo(&a_bounds, &b_bounds, Branch::Whole);
        let quotient = self.div(&a_bounds, &b_bounds);
        let cells = self.floor(&Operand::new(quotient, Interval::ENTIRE), Branch::Whole);
        let cells = FormOperand::new(self.form_between(&cells));
        let multiple = if b.value.slopes.is_some() {
            self.form_product(&FormOperand::new(b.value), &cells)
        } else {
            let bounds = [&cells, b].map(|operand| self.operand(operand));
            let product = self.mul(&bounds[0], &bounds[1]);
            self.form_between(&product)
        };
        let form = self.form_difference(&a.value, &multiple);
        self.with_bounds(&form, &value)
    }

    /// The form of a choice: b where a < 0, c where a ≥ 0.
    pub(super) fn form_choice<const N: usize>(
        &mut self,
        operands: &[FormOperand<M::V, N>],
    ) -> Form<M::V, N> {
        let (bounds, value) = self.enclosed(Op::SelectNegative, operands);
        let plain = self.form_between(&value);
        let zero = self.zero();
        let a = &bounds[0].value;
        let defined = a.facts.defined.mask(self.m, self.format);
        let negative = self.m.lt(a.hi, zero);
        let negative = self.m.and(negative, defined);
        let other = self.m.le(a.neg_lo, zero);
        let other = self.m.and(other, defined);
        let form = self.form_select(other, &operands[2].value, &plain);
        self.form_select(negative, &operands[1].value, &form)
    }

    /// The form of a where a is defined, else of b.
    pub(super) fn form_otherwise<const N: usize>(
        &mut self,
        operands: &[FormOperand<M::V, N>],
    ) -> Form<M::V, N> {
        let plain = self.bounded(Op::Otherwise, operands);
        let defined = match operands[0].value.facts.defined {
            Fact::False => return plain,
            defined => defined.mask(self.m, self.format),
        };
        self.form_select(defined, &operands[0].value, &plain)
    }

    /// The form of the first operand, defined only where the second meets the condition of `op`.
    pub(super) fn form_restricted<const N: usize>(
        &mut self,
        op: Op,
        operands: &[FormOperand<M::V, N>],
    ) -> Form<M::V, N> {
        let (_, value) = self.enclosed(op, operands);
        Form { facts: value.facts, ..operands[0].value }
    }
}
