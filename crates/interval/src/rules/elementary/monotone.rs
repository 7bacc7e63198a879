//! Rules of functions that are monotone, or monotone in the operand's magnitude. Routines evaluate
//! them at two ends.

use super::approximator::{Approximator, at_ends, by_halves};
use super::double_double::Approximation;
use super::logarithm::Base;
use crate::bounds::Interval;
use crate::enclosure::{Claims, Enclosure, Fact, Operand};
use crate::machine::{Format, Machine};
use crate::rules::Rule;

impl<M: Machine> Rule<'_, M> {
    /// Bounds of a function as [−lo, hi], from the operands where the function is least and
    /// greatest.
    fn bounds_at(
        &mut self,
        [least, greatest]: [M::V; 2],
        mut f: impl FnMut(&mut Approximator<'_, M>, M::V) -> Approximation<M::V>,
    ) -> [M::V; 2] {
        let target = self.format;
        match target {
            Format::F64 => {
                let [[neg_lo, _], [_, hi]] = self.m.repeat([[least], [greatest]], |m, [x]| {
                    let mut approx = Approximator { m, target };
                    let near = f(&mut approx, x);
                    [approx.negated_lower(&near), approx.upper(&near)]
                });
                [neg_lo, hi]
            }
            Format::F32 => {
                let ([l0, l1], [h0, h1]) = (self.m.widen(least), self.m.widen(greatest));
                let mut error = 0.0;
                let [l0, l1, h0, h1] = self.m.repeat([[l0], [l1], [h0], [h1]], |m, [x]| {
                    let near = f(&mut Approximator { m, target }, x);
                    error = near.error;
                    [near.sum.head]
                });
                let mut approx = Approximator { m: self.m, target };
                let lower =
                    [l0, l1].map(|[x]| approx.negated_lower(&Approximation::new(x.into(), error)));
                let upper = [h0, h1].map(|[x]| approx.upper(&Approximation::new(x.into(), error)));
                [self.m.narrow(lower), self.m.narrow(upper)]
            }
        }
    }

    /// Bounds of a function at both ends of its operand, each as [−lo, hi].
    pub(in crate::rules) fn at_both_ends(
        &mut self,
        a: &Operand<M::V>,
        mut f: impl FnMut(&mut Approximator<'_, M>, M::V) -> Approximation<M::V>,
    ) -> [[M::V; 2]; 2] {
        let ends = [[self.m.neg(a.value.neg_lo)], [a.value.hi]];
        let bounds_at = |approx: &mut Approximator<'_, M>, [x]: [M::V; 1]| {
            let near = f(approx, x);
            [approx.negated_lower(&near), approx.upper(&near)]
        };
        let format = self.format;
        let [neg_first, first, neg_last, last] =
            at_ends(self.m, format, ends, bounds_at, |_, [a, b], [c, d]| [a, b, c, d]);
        [[neg_first, first], [neg_last, last]]
    }

    /// Encloses an increasing function that is defined everywhere.
    pub(in crate::rules) fn increasing(
        &mut self,
        a: &Operand<M::V>,
        f: impl FnMut(&mut Approximator<'_, M>, M::V) -> Approximation<M::V>,
    ) -> Enclosure<M::V> {
        let ends = [self.m.neg(a.value.neg_lo), a.value.hi];
        a.value.facts.with(self.bounds_at(ends, f))
    }

    /// Encloses an increasing function that is infinite where its operand is. The routine `f` takes
    /// finite operands.
    pub(in crate::rules) fn increasing_unbounded(
        &mut self,
        a: &Operand<M::V>,
        f: impl FnMut(&mut Approximator<'_, M>, M::V) -> Approximation<M::V>,
    ) -> Enclosure<M::V> {
        let bounds = self.increasing(a, f);
        if a.range.is_bounded() {
            return bounds;
        }
        let infinity = self.infinity();
        let mut keep = |end: M::V, bound: M::V| {
            let unbounded = self.m.eq(end, infinity);
            self.m.select(unbounded, infinity, bound)
        };
        Enclosure {
            neg_lo: keep(a.value.neg_lo, bounds.neg_lo),
            hi: keep(a.value.hi, bounds.hi),
            ..bounds
        }
    }

    pub(in crate::rules) fn exp(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let ends = [a.value.neg_lo, a.value.hi];
        let bounds = by_halves(self.m, self.format, ends, |approx, ends| approx.exp(ends));
        a.value.facts.with(bounds)
    }

    pub(in crate::rules) fn logarithm(&mut self, a: &Operand<M::V>, base: Base) -> Enclosure<M::V> {
        let ends = self.positive_ends(a);
        let [mut neg_lo, mut hi] = by_halves(self.m, self.format, ends, |approx, [lo, hi]| {
            let (at_lo, at_hi) = (approx.ln(lo, base), approx.ln(hi, base));
            [approx.negated_lower(&at_lo), approx.upper(&at_hi)]
        });
        // The result is −∞ for a lower end ≤ 0, and +∞ for an infinite upper end.
        let infinity = self.infinity();
        if a.range.lo <= 0.0 {
            let zero = self.zero();
            let from_zero = self.m.le(zero, a.value.neg_lo);
            neg_lo = self.m.select(from_zero, infinity, neg_lo);
        }
        if a.range.hi == f64::INFINITY {
            let unbounded = self.m.eq(a.value.hi, infinity);
            hi = self.m.select(unbounded, infinity, hi);
        }
        let own = self.positive(a);
        a.value.facts.and(self.m, &own).with([neg_lo, hi])
    }

    /// The operand's `[lo, hi]`. An end that is not positive becomes the least positive number of
    /// the format.
    pub(in crate::rules) fn positive_ends(&mut self, a: &Operand<M::V>) -> [M::V; 2] {
        let lo = self.lo(&a.value);
        if a.range.lo > 0.0 {
            return [lo, a.value.hi];
        }
        let least = self.least_positive();
        [self.m.max(lo, least), self.m.max(a.value.hi, least)]
    }

    pub(in crate::rules) fn asin(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let own = self.between(a, -1.0, 1.0);
        let ends = self.limited_ends(a, -1.0, 1.0);
        let bounds = self.bounds_at(ends, |approx, x| approx.asin(x));
        a.value.facts.and(self.m, &own).with(bounds)
    }

    pub(in crate::rules) fn acos(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let own = self.between(a, -1.0, 1.0);
        let [lo, hi] = self.limited_ends(a, -1.0, 1.0);
        let bounds = self.bounds_at([hi, lo], |approx, x| approx.acos(x));
        a.value.facts.and(self.m, &own).with(bounds)
    }

    pub(in crate::rules) fn cosh(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let least = self.neg_mignitude(a);
        let ends = [least, self.magnitude(a)];
        let [neg_lo, hi] = self.bounds_at(ends, |approx, x| approx.cosh(x));
        // The hyperbolic cosine is never below 1.
        let minus_one = self.number(-1.0);
        Enclosure { neg_lo: self.m.min(neg_lo, minus_one), hi, ..a.value }
    }

    pub(in crate::rules) fn tanh(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let bounds = self.increasing(a, |approx, x| approx.tanh(x));
        // The hyperbolic tangent is never beyond ±1.
        let one = self.number(1.0);
        let (neg_lo, hi) = (self.m.min(bounds.neg_lo, one), self.m.min(bounds.hi, one));
        Enclosure { neg_lo, hi, ..bounds }
    }

    pub(in crate::rules) fn acosh(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let own = self.between(a, 1.0, f64::INFINITY);
        let ends = self.limited_ends(a, 1.0, f64::INFINITY);
        let [neg_lo, hi] = self.bounds_at(ends, |approx, x| approx.acosh(x));
        let hi = self.infinite_from(a, f64::INFINITY, hi);
        a.value.facts.and(self.m, &own).with([neg_lo, hi])
    }

    pub(in crate::rules) fn atanh(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let below_one = self.format.pick(f64::from(1_f32.next_down()), 1_f64.next_down());
        let ends = self.limited_ends(a, -below_one, below_one);
        let [neg_lo, hi] = self.bounds_at(ends, |approx, x| approx.atanh(x));
        let hi = self.infinite_from(a, 1.0, hi);
        let neg_lo = self.infinite_from(&a.negated(), 1.0, neg_lo);
        let own = self.between_ones(a);
        a.value.facts.and(self.m, &own).with([neg_lo, hi])
    }

    /// Takes +∞ in lanes where the operand's upper end is at least `limit`, else `bound`.
    fn infinite_from(&mut self, a: &Operand<M::V>, limit: f64, bound: M::V) -> M::V {
        if a.range.hi < limit {
            return bound;
        }
        let (limit, infinity) = (self.number(limit), self.infinity());
        let reached = self.m.le(limit, a.value.hi);
        self.m.select(reached, infinity, bound)
    }

    /// The operand's `[lo, hi]`, clamped to the domain from `least` to `most`.
    fn limited_ends(&mut self, a: &Operand<M::V>, least: f64, most: f64) -> [M::V; 2] {
        let ends = [self.lo(&a.value), a.value.hi];
        if (Interval { lo: least, hi: most }).encloses(a.range) {
            return ends;
        }
        let (least, most) = (self.number(least), self.number(most));
        ends.map(|end| {
            let end = self.m.max(end, least);
            self.m.min(end, most)
        })
    }

    /// Claims of an operation that is defined from `least` to `most`, ends included.
    fn between(&mut self, a: &Operand<M::V>, least: f64, most: f64) -> Claims<M::V> {
        if (Interval { lo: least, hi: most }).encloses(a.range) {
            return Claims::TOTAL;
        }
        let (above, below) = (self.number(-least), self.number(-most));
        let (least, most) = (self.number(least), self.number(most));
        let outside = [self.m.lt(a.value.hi, least), self.m.lt(a.value.neg_lo, below)];
        let inside = [self.m.le(a.value.neg_lo, above), self.m.le(a.value.hi, most)];
        self.domain(outside, inside)
    }

    /// Claims of an operation that is defined on (−1, 1).
    fn between_ones(&mut self, a: &Operand<M::V>) -> Claims<M::V> {
        if a.range.lo > -1.0 && a.range.hi < 1.0 {
            return Claims::TOTAL;
        }
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        let ends = [a.value.neg_lo, a.value.hi];
        let outside = ends.map(|end| self.m.le(end, minus_one));
        let inside = ends.map(|end| self.m.lt(end, one));
        self.domain(outside, inside)
    }

    fn domain(&mut self, outside: [M::V; 2], inside: [M::V; 2]) -> Claims<M::V> {
        let nowhere = self.m.or(outside[0], outside[1]);
        let throughout = self.m.and(inside[0], inside[1]);
        Claims::of_domain(Fact::Lanes(nowhere), Fact::Lanes(throughout))
    }
}
