//! Rules of minimum, maximum, choice and restriction.

use super::Rule;
use crate::branch::Branch;
use crate::enclosure::{Claims, Enclosure, Fact, Operand};
use crate::machine::Machine;

impl<M: Machine> Rule<'_, M> {
    pub(super) fn min(&mut self, a: &Operand<M::V>, b: &Operand<M::V>) -> Enclosure<M::V> {
        let neg_lo = self.m.max(a.value.neg_lo, b.value.neg_lo);
        let hi = self.m.min(a.value.hi, b.value.hi);
        self.combine(neg_lo, hi, a, b)
    }

    pub(super) fn max(&mut self, a: &Operand<M::V>, b: &Operand<M::V>) -> Enclosure<M::V> {
        let neg_lo = self.m.min(a.value.neg_lo, b.value.neg_lo);
        let hi = self.m.max(a.value.hi, b.value.hi);
        self.combine(neg_lo, hi, a, b)
    }

    /// Encloses b where a < 0, c where a ≥ 0. If a has both signs, the result is the hull of b and
    /// c. On a branch it is only b or only c.
    pub(super) fn select_negative(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
        c: &Operand<M::V>,
        branch: Branch,
    ) -> Enclosure<M::V> {
        let zero = self.zero();
        let mut negative = self.m.lt(a.value.hi, zero);
        let mut nonneg = self.m.le(a.value.neg_lo, zero);
        match branch {
            Branch::Whole | Branch::Middle => {}
            // In lanes where a has both signs, only the operand of this branch counts.
            Branch::Low => negative = self.not(nonneg),
            Branch::Rest | Branch::High => nonneg = self.not(negative),
        }
        let (b, c) = (&b.value, &c.value);
        let pick = |rule: &mut Self, b: M::V, c: M::V, both: M::V| {
            let rest = rule.m.select(nonneg, c, both);
            rule.m.select(negative, b, rest)
        };
        let both_neg_lo = self.m.max(b.neg_lo, c.neg_lo);
        let both_hi = self.m.max(b.hi, c.hi);
        let neg_lo = pick(self, b.neg_lo, c.neg_lo, both_neg_lo);
        let hi = pick(self, b.hi, c.hi, both_hi);
        // A fact holds for the result if it holds for the operand that is chosen, or for both.
        let mut fact = |b: Fact<M::V>, c: Fact<M::V>| {
            let on_b = b.and(self.m, Fact::Lanes(negative));
            let on_c = c.and(self.m, Fact::Lanes(nonneg));
            let either = on_b.or(self.m, on_c);
            let both = b.and(self.m, c);
            (either, both)
        };
        let (nowhere, nowhere_both) = fact(b.facts.nowhere, c.facts.nowhere);
        let (defined, defined_both) = fact(b.facts.defined, c.facts.defined);
        let (continuous, _) = fact(b.facts.continuous, c.facts.continuous);
        let nowhere = nowhere.or(self.m, nowhere_both);
        let defined = defined.or(self.m, defined_both);
        let own = Claims { nowhere, defined, continuous };
        own.and(self.m, &a.value.facts).with([neg_lo, hi])
    }

    /// Encloses a where a is defined, else b. If a is defined in only part of the box, the result
    /// is the hull of a and b. On a branch it is only a or only b.
    pub(super) fn otherwise(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
        branch: Branch,
    ) -> Enclosure<M::V> {
        let (a, b) = (&a.value, &b.value);
        let (own, other) = (a.facts, b.facts);
        let only_a = own.defined.mask(self.m, self.format);
        let only_b = own.nowhere.mask(self.m, self.format);
        let pick = |rule: &mut Self, a: M::V, b: M::V| {
            let both = match branch {
                Branch::Whole | Branch::Middle => rule.m.max(a, b),
                Branch::Low => a,
                Branch::Rest | Branch::High => b,
            };
            let rest = rule.m.select(only_b, b, both);
            rule.m.select(only_a, a, rest)
        };
        let neg_lo = pick(self, a.neg_lo, b.neg_lo);
        let hi = pick(self, a.hi, b.hi);
        let continuous_b = other.continuous.and(self.m, own.nowhere);
        let facts = Claims {
            nowhere: own.nowhere.and(self.m, other.nowhere),
            defined: own.defined.or(self.m, other.defined),
            continuous: own.continuous.or(self.m, continuous_b),
        };
        facts.with([neg_lo, hi])
    }

    /// Encloses `a`, defined only where `b` is.
    pub(super) fn with_facts_of(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
    ) -> Enclosure<M::V> {
        // The result may be continuous even where b is not: b only has to be defined.
        let (own, other) = (a.value.facts, b.value.facts);
        let allowed = Claims { continuous: other.defined, ..other };
        Enclosure { facts: own.and(self.m, &allowed), ..a.value }
    }

    /// Encloses `a`, defined only where `b` lies in a domain whose claims `domain` returns.
    pub(super) fn where_in(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
        domain: impl FnOnce(&mut Self, &Operand<M::V>) -> Claims<M::V>,
    ) -> Enclosure<M::V> {
        let own = domain(self, b);
        self.with_facts_of(a, b).restricted(self.m, &own)
    }

    /// Claims of an operation that is defined where the operand is ≥ 0.
    pub(super) fn nonneg(&mut self, a: &Operand<M::V>) -> Claims<M::V> {
        if a.range.lo >= 0.0 {
            return Claims::TOTAL;
        }
        let zero = self.zero();
        let nowhere = self.m.lt(a.value.hi, zero);
        Claims::of_domain(Fact::Lanes(nowhere), Fact::Lanes(self.m.le(a.value.neg_lo, zero)))
    }

    /// Claims of an operation that is defined where the operand is > 0.
    pub(super) fn positive(&mut self, a: &Operand<M::V>) -> Claims<M::V> {
        if a.range.lo > 0.0 {
            return Claims::TOTAL;
        }
        let zero = self.zero();
        let nowhere = self.m.le(a.value.hi, zero);
        Claims::of_domain(Fact::Lanes(nowhere), Fact::Lanes(self.m.lt(a.value.neg_lo, zero)))
    }
}
