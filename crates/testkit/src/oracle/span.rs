//! Ranges of reals with `f64` ends, and their addition, subtraction, multiplication and division.

use super::around;
use super::rounded::{self, Rounded};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use zeroset_ir::Constant;

/// The reals from `lo` to `hi`. Never NaN; `lo ≤ hi`, `lo < +∞`, `hi > −∞`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

impl Span {
    pub(crate) const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// Returns the range from `lo` to `hi`, or all reals if these are not the ends of a range.
    pub(crate) fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY {
            // Adding +0 turns −0 into +0, so that no rule encounters −0.
            Self { lo: lo + 0.0, hi: hi + 0.0 }
        } else {
            Self::ENTIRE
        }
    }

    pub(crate) fn point(value: f64) -> Self {
        if value.is_finite() { Self::new(value, value) } else { Self::ENTIRE }
    }

    /// Returns a range that contains the exact values of two rounded results.
    pub(super) fn hull(a: Rounded, b: Rounded) -> Self {
        Self::of(&[a, b])
    }

    /// Returns a range that contains the exact values of `results`, which must not be empty.
    pub(super) fn of(results: &[Rounded]) -> Self {
        let lo = results.iter().map(|r| r.down()).fold(f64::INFINITY, f64::min);
        let hi = results.iter().map(|r| r.up()).fold(f64::NEG_INFINITY, f64::max);
        Self::new(lo, hi)
    }

    /// Returns a range that contains a constant of a graph.
    pub(crate) fn constant(value: &Constant) -> Self {
        match value {
            Constant::Exact(value) => rational(value),
            Constant::Named(_) | Constant::Enclosed(_) => {
                let bounds = value.bounds();
                Self::new(bounds.lo, bounds.hi)
            }
        }
    }

    pub(crate) fn has_zero(self) -> bool {
        self.lo <= 0.0 && 0.0 <= self.hi
    }

    pub(crate) fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    pub(crate) fn is_zero(self) -> bool {
        self.lo == 0.0 && self.hi == 0.0
    }

    pub(crate) fn union(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// Returns the part of the range between `lo` and `hi`, which must bound the true value.
    pub(crate) fn within(self, lo: f64, hi: f64) -> Self {
        Self::new(self.lo.clamp(lo, hi), self.hi.clamp(lo, hi))
    }

    pub(crate) fn neg(self) -> Self {
        Self::new(-self.hi, -self.lo)
    }

    pub(crate) fn abs(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            self.neg()
        } else {
            Self::new(0.0, self.hi.max(-self.lo))
        }
    }

    pub(crate) fn add(self, other: Self) -> Self {
        Self::hull(rounded::add(self.lo, other.lo), rounded::add(self.hi, other.hi))
    }

    pub(crate) fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    pub(crate) fn mul(self, other: Self) -> Self {
        Self::of(&self.corners(other, rounded::mul))
    }

    pub(crate) fn sqr(self) -> Self {
        let a = self.abs();
        Self::hull(rounded::mul(a.lo, a.lo), rounded::mul(a.hi, a.hi))
    }

    /// Divides by the members of `other` that are not 0.
    pub(crate) fn div(self, other: Self) -> Self {
        if self.is_zero() {
            return Self::point(0.0);
        }
        if other.lo < 0.0 && 0.0 < other.hi {
            return Self::ENTIRE;
        }
        // An end at 0 stands for arbitrarily small divisors with the sign of the other end.
        let other = if other.hi == 0.0 { Self { lo: other.lo, hi: -0.0 } } else { other };
        Self::of(&self.corners(other, rounded::div))
    }

    /// Returns `f` at the four pairs of ends of both ranges.
    pub(super) fn corners(self, other: Self, f: fn(f64, f64) -> Rounded) -> [Rounded; 4] {
        [f(self.lo, other.lo), f(self.lo, other.hi), f(self.hi, other.lo), f(self.hi, other.hi)]
    }

    /// Returns the range of a nondecreasing `f` from its values at both ends.
    pub(super) fn increasing(self, f: impl Fn(f64) -> Rounded) -> Self {
        Self::hull(f(self.lo), f(self.hi))
    }
}

/// Returns two floats that enclose a rational number. They are equal if the number is a float.
fn rational(value: &BigRational) -> Span {
    if value.is_integer() {
        return around(value.numer());
    }
    let exact = |x: f64| BigRational::from_float(x);
    // The rounded number is a guess, which exact comparisons correct.
    let Some(guess) = value.to_f64().filter(|x| x.is_finite()) else {
        let huge = Span::new(f64::MAX, f64::INFINITY);
        return if value.is_negative() { huge.neg() } else { huge };
    };
    let (mut lo, mut hi) = (guess, guess);
    while lo.is_finite() && exact(lo).is_some_and(|x| x > *value) {
        lo = lo.next_down();
    }
    while hi.is_finite() && exact(hi).is_some_and(|x| x < *value) {
        hi = hi.next_up();
    }
    Span::new(lo, hi)
}
