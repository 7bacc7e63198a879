//! Rules of functions that jump: rounding to integers, sign, remainder.

use super::Rule;
use crate::bounds::Interval;
use crate::branch::Branch;
use crate::enclosure::{Claims, Enclosure, Fact, Operand};
use crate::machine::Machine;

impl<M: Machine> Rule<'_, M> {
    /// Encloses an integer-valued function f over a branch. The result is continuous in lanes where
    /// f has only one value. `opposite` is −f(−x), which maps −lo of the operand to −lo of the
    /// result.
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
        // The ends are compared, not subtracted: ∞ − ∞ would be NaN.
        let lo = self.m.neg(neg_lo);
        let one_value = self.m.eq(lo, hi);
        let continuous = a.value.facts.continuous.and(self.m, Fact::Lanes(one_value));
        Claims { continuous, ..a.value.facts }.with([neg_lo, hi])
    }

    /// Bounds of the integers of a branch as −lo and hi, from the bounds over the whole box. For a
    /// branch without integers, the result is another integer within the bounds.
    fn branch_of_steps(&mut self, neg_lo: M::V, hi: M::V, branch: Branch) -> (M::V, M::V) {
        let (infinity, minus_one) = (self.infinity(), self.number(-1.0));
        let neg_hi = self.m.neg(hi);
        let lowest = |rule: &mut Self| {
            // If the lower end is −∞, there is no lowest integer.
            let lo = rule.m.neg(neg_lo);
            let is_bounded = rule.m.lt(neg_lo, infinity);
            rule.m.select(is_bounded, lo, hi)
        };
        // Adding 1 to a large integer rounds back to it. The branch is then the whole box.
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
                // The highest integer is taken if there is none between the lowest and the highest.
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

    /// The sign of a: −1, 0 or 1.
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
            // The operand's bounds cover more than this branch, so the result is limited to [0, 1].
            neg_lo = self.m.min(neg_lo, zero);
            hi = self.m.min(hi, one);
        }
        let neg_lo = self.m.select(one_cell, neg_lo, zero);
        let hi = self.m.select(one_cell, hi, one);
        Enclosure { neg_lo, hi, ..floor }
    }

    /// Encloses a − b·floor(a/b), which is in [0, b) for b > 0 and in (b, 0] for b < 0.
    pub(super) fn modulo(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
        branch: Branch,
    ) -> Enclosure<M::V> {
        let entire = Interval::ENTIRE;
        let quotient = Operand::new(self.div(a, b), entire);
        let cells = Operand::new(self.floor(&quotient, branch), entire);
        // `mul` guards against 0·∞ because the range of `cells` is unbounded.
        let multiple = Operand::new(self.mul(b, &cells), entire);
        let direct = self.add(a, &multiple.negated());
        // If the quotient is finite, both the direct bounds and [min(0, b), max(0, b)] hold, so
        // they are intersected. The intersection is not empty if the function is defined somewhere.
        let zero = self.zero();
        let within_neg_lo = self.m.max(b.value.neg_lo, zero);
        let within_hi = self.m.max(b.value.hi, zero);
        let neg_lo = self.m.min(direct.neg_lo, within_neg_lo);
        let hi = self.m.min(direct.hi, within_hi);
        // The intersection is empty if a lane is undefined everywhere, or if rounding adds a
        // multiple to a branch without points. Later rules still need bounds that are in order, and
        // within the bounds over larger boxes.
        let (least, most) = (self.m.neg(within_neg_lo), self.m.neg(within_hi));
        let neg_lo = self.m.max(neg_lo, most);
        let hi = self.m.max(hi, least);
        Enclosure { neg_lo, hi, ..direct }
    }
}
