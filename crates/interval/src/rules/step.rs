//! Functions that jump: rounding to integers, sign, remainder.

use super::Rule;
use crate::bounds::Interval;
use crate::branch::Branch;
use crate::enclosure::{Claims, Enclosure, Fact, Operand};
use crate::machine::Machine;

impl<M: Machine> Rule<'_, M> {
    /// Bounds of an integer-valued function f over a branch, continuous where it takes one value
    /// there. `opposite` is −f(−x), by which −lo becomes that of the bounds.
    pub(super) fn steps(
        &mut self,
        a: &Operand<M::V>,
        branch: Branch,
        opposite: impl FnOnce(&mut Self, M::V) -> M::V,
        f: impl FnOnce(&mut Self, M::V) -> M::V,
    ) -> Enclosure<M::V> {
        let neg_lo = opposite(self, a.value.neg_lo);
        let hi = f(self, a.value.hi);
        let (neg_lo, hi) = self.branch_of_steps(neg_lo, hi, branch);
        // lo = hi, as −(−lo) = hi; ∞ − ∞ is NaN and claims nothing.
        let lo = self.m.neg(neg_lo);
        let one_value = self.m.eq(lo, hi);
        let continuous = a.value.facts.continuous.and(self.m, Fact::Lanes(one_value));
        Claims { continuous, ..a.value.facts }.with([neg_lo, hi])
    }

    /// The integers within bounds that belong to a branch; one of them at least, also where none
    /// does.
    fn branch_of_steps(&mut self, neg_lo: M::V, hi: M::V, branch: Branch) -> (M::V, M::V) {
        let (infinity, minus_one) = (self.infinity(), self.number(-1.0));
        let neg_hi = self.m.neg(hi);
        let lowest = |rule: &mut Self| {
            // The lowest integer above −∞ has no value of its own.
            let lo = rule.m.neg(neg_lo);
            let is_bounded = rule.m.lt(neg_lo, infinity);
            rule.m.select(is_bounded, lo, hi)
        };
        // Large integers are not changed by one more, rounded outward; so the rest then is the
        // whole.
        let second = |rule: &mut Self| {
            let second = rule.m.add(neg_lo, minus_one);
            rule.m.max(second, neg_hi)
        };
        match branch {
            Branch::Whole => (neg_lo, hi),
            Branch::Low => (neg_lo, lowest(self)),
            Branch::Rest => (second(self), hi),
            Branch::Middle => {
                let neg_lo = second(self);
                let last_but_one = self.m.add(hi, minus_one);
                let lo = self.m.neg(neg_lo);
                // Between two neighbours there is no integer, and the upper one stands in.
                (neg_lo, self.m.max(last_but_one, lo))
            }
            Branch::High => {
                let is_bounded = self.m.lt(hi, infinity);
                (self.m.select(is_bounded, neg_hi, neg_lo), hi)
            }
        }
    }

    pub(super) fn floor(&mut self, a: &Operand<M::V>, branch: Branch) -> Enclosure<M::V> {
        self.steps(a, branch, |rule, x| rule.m.ceil(x), |rule, x| rule.m.floor(x))
    }

    /// −1, 0 or 1.
    pub(crate) fn sign_of(&mut self, a: M::V) -> M::V {
        let (zero, one, minus_one) = (self.zero(), self.number(1.0), self.number(-1.0));
        let positive = self.gt(a, zero);
        let negative = self.m.lt(a, zero);
        let up = self.m.and(positive, one);
        let down = self.m.and(negative, minus_one);
        self.m.or(up, down)
    }

    pub(super) fn fract(&mut self, a: &Operand<M::V>, branch: Branch) -> Enclosure<M::V> {
        let (zero, one) = (self.zero(), self.number(1.0));
        let floor = self.floor(a, branch);
        let floor_lo = self.m.neg(floor.neg_lo);
        let one_cell = self.m.eq(floor_lo, floor.hi);
        let mut neg_lo = self.m.add(a.value.neg_lo, floor.hi);
        let mut hi = self.m.sub(a.value.hi, floor.hi);
        if branch != Branch::Whole {
            // A branch's cell may be one of several in the box.
            neg_lo = self.m.min(neg_lo, zero);
            hi = self.m.min(hi, one);
        }
        let neg_lo = self.m.select(one_cell, neg_lo, zero);
        let hi = self.m.select(one_cell, hi, one);
        Enclosure { neg_lo, hi, ..floor }
    }

    /// a − b·floor(a/b), within [0, b) for b > 0 and (b, 0] for b < 0.
    pub(super) fn modulo(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
        branch: Branch,
    ) -> Enclosure<M::V> {
        let entire = Interval::ENTIRE;
        let quotient = Operand::new(self.div(a, b), entire);
        let cells = Operand::new(self.floor(&quotient, branch), entire);
        // Whole cells; unbounded range, so the product is guarded.
        let multiple = Operand::new(self.mul(b, &cells), entire);
        let direct = self.add(a, &multiple.negated());
        // Where the quotient is finite, the direct bounds and [min(0, b), max(0, b)] both hold:
        // take the tighter. Their intersection is never empty where the function is defined
        // somewhere.
        let zero = self.zero();
        let within_neg_lo = self.m.max(b.value.neg_lo, zero);
        let within_hi = self.m.max(b.value.hi, zero);
        let neg_lo = self.m.min(direct.neg_lo, within_neg_lo);
        let hi = self.m.min(direct.hi, within_hi);
        // A branch's cell that is there by rounding only has no point, and a lane that is nowhere
        // defined no value: what comes next may rely on their bounds, too, to be in order and
        // within those over larger boxes.
        let (least, most) = (self.m.neg(within_neg_lo), self.m.neg(within_hi));
        let neg_lo = self.m.max(neg_lo, most);
        let hi = self.m.max(hi, least);
        Enclosure { neg_lo, hi, ..direct }
    }
}
