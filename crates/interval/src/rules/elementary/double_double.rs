//! Numbers as unevaluated sums, for routines whose results need more digits than a lane has.
//!
//! A routine computes the leading terms of its series in this arithmetic, and the rest in plain
//! lanes. Results in `f32` need no tails, so none are computed. Under rounding up, error-free
//! transforms have errors, but only of second order. Each operation here states its bound relative
//! to the exact result. The bound holds if operands' tails are at most 2⁻⁵⁰ of their heads and
//! nothing underflows. Sources: Dekker, A floating-point technique for extending the available
//! precision (1971); for directed rounding Boldo, Graillat, Muller, On the robustness of the `2Sum`
//! and `Fast2Sum` algorithms (2017).

use super::approximator::Approximator;
use crate::machine::{Format, Machine};
use crate::rules::Rule;

const F64: Format = Format::F64;
/// Mask that clears the low 27 bits of a significand. The product of two such numbers is exact.
const UPPER_HALF: u64 = !((1 << 27) - 1);
/// For |x| below this limit, a function with f(x) = x + O(x³) equals x within any claimed relative
/// error. Routines that approximate such functions would underflow there.
pub(super) const TINY: f64 = f64::from_bits((1023 - 400) << 52); // 2^-400

/// A number as the sum of head and tail.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DoubleDouble<V> {
    pub(crate) head: V,
    /// The tail, at most a few ulps of the head; `None` stands for 0.
    pub(crate) tail: Option<V>,
}

/// Result of a routine: the exact value is `(sum + δ) · 2^exponent`, with |δ| ≤ `error` · |head|
/// unless further errors are given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approximation<V> {
    pub(crate) sum: DoubleDouble<V>,
    /// Bound on the relative error, including truncation and rounding.
    pub(crate) error: f64,
    /// A further relative error per lane. It is allowed only if the sum has a tail.
    pub(crate) extra: Option<V>,
    /// A further absolute error per lane.
    pub(crate) absolute: Option<V>,
    /// The exponent, an integer; `None` stands for 0.
    pub(crate) exponent: Option<V>,
}

impl<V> Approximation<V> {
    pub(crate) fn new(sum: DoubleDouble<V>, error: f64) -> Self {
        Self { sum, error, extra: None, absolute: None, exponent: None }
    }
}

impl<V> From<V> for DoubleDouble<V> {
    fn from(head: V) -> Self {
        Self { head, tail: None }
    }
}

impl<M: Machine> Approximator<'_, M> {
    pub(super) fn has_tails(&self) -> bool {
        self.target == F64
    }

    pub(super) fn constant(&mut self, [head, tail]: [f64; 2]) -> DoubleDouble<M::V> {
        let tail = (self.has_tails() && tail != 0.0).then(|| self.number(tail));
        DoubleDouble { head: self.number(head), tail }
    }

    /// The sum of two tails.
    pub(super) fn tails(&mut self, a: Option<M::V>, b: Option<M::V>) -> Option<M::V> {
        Rule { m: self.m, format: F64 }.sum_of(a, b)
    }

    /// Computes a + b to 2⁻¹⁰⁰ of |a| + |b|. It needs |a| ≥ |b| or a = 0.
    pub(super) fn plus(
        &mut self,
        a: impl Into<DoubleDouble<M::V>>,
        b: impl Into<DoubleDouble<M::V>>,
    ) -> DoubleDouble<M::V> {
        let (a, b) = (a.into(), b.into());
        let head = self.m.add(a.head, b.head);
        if !self.has_tails() {
            return head.into();
        }
        // `held`, the part of b that the head contains, is exact. The rest of b, which the head
        // lacks, is exact up to rounding of second order.
        let held = self.m.sub(head, a.head);
        let lacking = self.m.sub(b.head, held);
        let tails = self.tails(a.tail, b.tail);
        DoubleDouble { head, tail: self.tails(Some(lacking), tails) }
    }

    /// Computes a + b to 2⁻¹⁰⁰ of |a| + |b|, in any order.
    pub(super) fn sum(
        &mut self,
        a: DoubleDouble<M::V>,
        b: DoubleDouble<M::V>,
    ) -> DoubleDouble<M::V> {
        let head = self.m.add(a.head, b.head);
        if !self.has_tails() {
            return head.into();
        }
        // The head contains `b_held` of b and `a_held` of a. The rests of both, which the head
        // lacks, are exact up to rounding of second order.
        let b_held = self.m.sub(head, a.head);
        let a_held = self.m.sub(head, b_held);
        let (a_rest, b_rest) = (self.m.sub(a.head, a_held), self.m.sub(b.head, b_held));
        let rest = self.m.add(a_rest, b_rest);
        let tails = self.tails(a.tail, b.tail);
        DoubleDouble { head, tail: self.tails(Some(rest), tails) }
    }

    /// Computes a + b for a and b ≥ 0, in any order.
    pub(super) fn plus_nonneg(
        &mut self,
        a: DoubleDouble<M::V>,
        b: DoubleDouble<M::V>,
    ) -> DoubleDouble<M::V> {
        if !self.has_tails() {
            return self.plus(a, b);
        }
        let (large, small) = (self.m.max(a.head, b.head), self.m.min(a.head, b.head));
        let sum = self.plus(large, small);
        let tails = self.tails(a.tail, b.tail);
        DoubleDouble { tail: self.tails(sum.tail, tails), ..sum }
    }

    /// Computes a · b to 2⁻⁷².
    ///
    /// The difference `upper` − `head` is exact: it is a multiple of the last place of the product
    /// of the upper halves. It is below 2⁻²³ of the product, and so are the terms added to it.
    /// Three additions of such terms err by 2⁻⁵² of them each.
    pub(super) fn times(
        &mut self,
        a: impl Into<DoubleDouble<M::V>>,
        b: impl Into<DoubleDouble<M::V>>,
    ) -> DoubleDouble<M::V> {
        let (a, b) = (a.into(), b.into());
        let head = self.m.mul(a.head, b.head);
        if !self.has_tails() {
            return head.into();
        }
        let mask = self.m.bits(F64, UPPER_HALF);
        let (a_upper, b_upper) = (self.m.and(a.head, mask), self.m.and(b.head, mask));
        let (a_lower, b_lower) = (self.m.sub(a.head, a_upper), self.m.sub(b.head, b_upper));
        let upper = self.m.mul(a_upper, b_upper);
        let mut tail = self.m.sub(upper, head);
        for (a, b) in [(a_upper, b_lower), (a_lower, b_upper), (a_lower, b_lower)] {
            let product = self.m.mul(a, b);
            tail = self.m.add(tail, product);
        }
        for (head, other) in [(a.head, b.tail), (b.head, a.tail)] {
            if let Some(other) = other {
                let product = self.m.mul(head, other);
                tail = self.m.add(tail, product);
            }
        }
        DoubleDouble { head, tail: Some(tail) }
    }

    /// Computes a / b to 2⁻⁷¹.
    pub(super) fn over(
        &mut self,
        a: impl Into<DoubleDouble<M::V>>,
        b: impl Into<DoubleDouble<M::V>>,
    ) -> DoubleDouble<M::V> {
        let (a, b) = (a.into(), b.into());
        let head = self.m.div(a.head, b.head);
        if !self.has_tails() {
            return head.into();
        }
        // The tail is the remainder divided by b. The first difference in the remainder is exact,
        // because its operands are a few ulps apart.
        let product = self.times(head, b);
        let rest = self.difference(a, product);
        DoubleDouble { head, tail: Some(self.m.div(rest, b.head)) }
    }

    /// Computes √a to 2⁻⁷¹, for a ≥ 0.
    pub(super) fn root(&mut self, a: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        let head = self.m.sqrt(a.head);
        if !self.has_tails() {
            return head.into();
        }
        let square = self.times(head, head);
        let rest = self.difference(a, square);
        let twice = self.m.add(head, head);
        let tiny = self.number(TINY);
        let twice = self.m.max(twice, tiny); // not 0/0 for a = 0
        DoubleDouble { head, tail: Some(self.m.div(rest, twice)) }
    }

    /// Computes a − b in one lane. The heads are a few ulps apart, so their difference is exact.
    fn difference(&mut self, a: DoubleDouble<M::V>, b: DoubleDouble<M::V>) -> M::V {
        let mut rest = self.m.sub(a.head, b.head);
        if let Some(tail) = b.tail {
            rest = self.m.sub(rest, tail);
        }
        if let Some(tail) = a.tail {
            rest = self.m.add(rest, tail);
        }
        rest
    }

    /// Applies `f`, which must be exact, to head and tail.
    pub(super) fn each(
        &mut self,
        a: DoubleDouble<M::V>,
        mut f: impl FnMut(&mut Self, M::V) -> M::V,
    ) -> DoubleDouble<M::V> {
        DoubleDouble { head: f(self, a.head), tail: a.tail.map(|tail| f(self, tail)) }
    }

    /// Computes a times a power of two.
    pub(super) fn scaled(&mut self, a: DoubleDouble<M::V>, power: M::V) -> DoubleDouble<M::V> {
        self.each(a, |approx, part| approx.m.mul(part, power))
    }

    /// Flips the sign of `a` in lanes where the sign bit of `sign` is set. All other bits of `sign`
    /// must be 0.
    pub(super) fn flipped(&mut self, a: DoubleDouble<M::V>, sign: M::V) -> DoubleDouble<M::V> {
        self.each(a, |approx, part| approx.m.xor(part, sign))
    }

    pub(super) fn opposite(&mut self, a: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        self.each(a, |approx, part| approx.m.neg(part))
    }

    pub(super) fn sign_of(&mut self, a: M::V) -> M::V {
        let sign_bit = self.m.bits(F64, 1 << 63);
        self.m.and(a, sign_bit)
    }

    /// Takes a where the mask is set, else b.
    pub(super) fn choose(
        &mut self,
        mask: M::V,
        a: DoubleDouble<M::V>,
        b: DoubleDouble<M::V>,
    ) -> DoubleDouble<M::V> {
        let head = self.m.select(mask, a.head, b.head);
        let tail = match (a.tail, b.tail) {
            (None, None) => None,
            (a, b) => {
                let zero = self.number(0.0);
                Some(self.m.select(mask, a.unwrap_or(zero), b.unwrap_or(zero)))
            }
        };
        DoubleDouble { head, tail }
    }

    /// Computes the odd series w + c₁w³ + c₂w⁵ + …. `coefficients` begin with c₁, whose tail is
    /// `first_tail`.
    ///
    /// Let z = w², and let R bound the terms from c₂ on, relative to w. The error relative to w is
    /// below 2⁻⁵²·5·R + 2⁻⁶⁹ for results with tails. For other results it is below 2⁻⁵²·6·(the
    /// terms from c₁ on). Each term is a product of few factors. Each Horner step errs by two ulps
    /// of a sum, and the next factor z, below ⅔, makes that error small.
    pub(super) fn odd_series(
        &mut self,
        w: DoubleDouble<M::V>,
        first_tail: f64,
        coefficients: &[f64],
    ) -> DoubleDouble<M::V> {
        let z = self.times(w, w);
        if !self.has_tails() {
            let terms = self.series(z.head, coefficients);
            let terms = self.m.mul(terms, z.head);
            let terms = self.m.mul(terms, w.head);
            return self.plus(w, terms);
        }
        let later = self.series(z.head, &coefficients[1..]);
        let later = self.m.mul(later, z.head);
        let first = self.constant([coefficients[0], first_tail]);
        let factor = self.plus(first, later);
        let factor = self.times(z, factor);
        let terms = self.times(w, factor);
        self.plus(w, terms)
    }

    /// Gives `value` the sign of x.
    pub(super) fn signed(&mut self, x: M::V, value: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        let sign = self.sign_of(x);
        self.flipped(value, sign)
    }

    /// Computes an odd function with f(x) = x + O(x³), given its value at |x|.
    pub(super) fn odd(&mut self, x: M::V, value: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        let value = self.signed(x, value);
        self.or_tiny(x, value)
    }

    /// Takes x where x is tiny, else `value`.
    pub(super) fn or_tiny(&mut self, x: M::V, value: DoubleDouble<M::V>) -> DoubleDouble<M::V> {
        self.or_where_tiny(x, x, value)
    }

    /// Takes `other` where x is tiny, else `value`.
    pub(super) fn or_where_tiny(
        &mut self,
        x: M::V,
        other: M::V,
        value: DoubleDouble<M::V>,
    ) -> DoubleDouble<M::V> {
        if !self.has_tails() {
            return value; // cubes of `f32` do not underflow
        }
        let (magnitude, tiny) = (self.m.abs(x), self.number(TINY));
        let is_tiny = self.m.lt(magnitude, tiny);
        self.choose(is_tiny, other.into(), value)
    }

    /// Computes an upper bound of the value that `near` approximates. Only the last addition rounds
    /// at the size of the value.
    pub(crate) fn upper(&mut self, near: &Approximation<M::V>) -> M::V {
        let slack = self.slack(near);
        let bound = match near.sum.tail {
            None => self.m.add(near.sum.head, slack),
            Some(tail) => {
                let rest = self.m.add(tail, slack);
                self.m.add(near.sum.head, rest)
            }
        };
        self.raised(bound, near.exponent)
    }

    /// Computes a negated lower bound of the value that `near` approximates.
    pub(crate) fn negated_lower(&mut self, near: &Approximation<M::V>) -> M::V {
        let slack = self.slack(near);
        let rest = match near.sum.tail {
            None => slack,
            Some(tail) => self.m.sub(slack, tail),
        };
        let bound = self.m.sub(rest, near.sum.head);
        self.raised(bound, near.exponent)
    }

    /// Computes the value that `near` approximates, rounded to one lane.
    pub(crate) fn value(&mut self, near: &Approximation<M::V>) -> M::V {
        let value = match near.sum.tail {
            None => near.sum.head,
            Some(tail) => self.m.add(near.sum.head, tail),
        };
        self.raised(value, near.exponent)
    }

    /// A bound of the absolute error of an approximation.
    fn slack(&mut self, near: &Approximation<M::V>) -> M::V {
        let (magnitude, mut error) = (self.m.abs(near.sum.head), self.number(near.error));
        if let Some(extra) = near.extra {
            error = self.m.add(error, extra);
        }
        // The product is rounded up, so it is positive unless the head is 0.
        let slack = self.m.mul(magnitude, error);
        near.absolute.map_or(slack, |absolute| self.m.add(slack, absolute))
    }

    /// Computes value · 2^exponent in two steps, because 2^exponent may be out of range when the
    /// product is not. The first step is exact, so only the second rounds, even for subnormal
    /// results.
    fn raised(&mut self, value: M::V, exponent: Option<M::V>) -> M::V {
        let Some(exponent) = exponent else {
            return value;
        };
        let half = self.number(0.5);
        let first = self.m.mul(exponent, half);
        let first = self.m.floor(first);
        let second = self.m.sub(exponent, first);
        let (first, second) = (self.power_of_two(first), self.power_of_two(second));
        let value = self.m.mul(value, first);
        self.m.mul(value, second)
    }
}
