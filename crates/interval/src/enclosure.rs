//! What an interval rule takes and gives.

use crate::bounds::Interval;
use crate::machine::{Format, Machine};

/// Lanes of enclosures: −lo and hi, and what is known of the expression's domain.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure<V> {
    /// The negated lower ends. Never NaN, never −∞.
    pub neg_lo: V,
    /// The upper ends. Never NaN, never −∞.
    pub hi: V,
    /// Where the expression is defined and continuous.
    pub facts: Claims<V>,
}

impl<V: Copy> Enclosure<V> {
    /// Bounds of an expression that is defined and continuous everywhere.
    pub fn total(neg_lo: V, hi: V) -> Self {
        Claims::TOTAL.with([neg_lo, hi])
    }

    /// The same, defined and continuous only where an operation of it is.
    pub(crate) fn restricted<M: Machine<V = V>>(self, m: &mut M, own: &Claims<V>) -> Self {
        Self { facts: self.facts.and(m, own), ..self }
    }
}

/// What is known of an expression's domain: three facts.
#[derive(Clone, Copy, Debug)]
pub struct Claims<V> {
    /// Lanes where the expression is defined nowhere in the box.
    pub nowhere: Fact<V>,
    /// Lanes where it is defined throughout the box.
    pub defined: Fact<V>,
    /// Lanes where it is defined and continuous throughout the box.
    pub continuous: Fact<V>,
}

impl<V: Copy> Claims<V> {
    pub(crate) const TOTAL: Self =
        Self { nowhere: Fact::False, defined: Fact::True, continuous: Fact::True };

    /// Those of an operation that is continuous where it is defined: the lanes where it is defined
    /// at no point, and those where it is at every point.
    pub(crate) fn of_domain(nowhere: Fact<V>, throughout: Fact<V>) -> Self {
        Self { nowhere, defined: throughout, continuous: throughout }
    }

    pub(crate) fn with(self, [neg_lo, hi]: [V; 2]) -> Enclosure<V> {
        Enclosure { neg_lo, hi, facts: self }
    }

    pub(crate) fn and<M: Machine<V = V>>(self, m: &mut M, other: &Self) -> Self {
        Self {
            nowhere: self.nowhere.or(m, other.nowhere),
            defined: self.defined.and(m, other.defined),
            continuous: self.continuous.and(m, other.continuous),
        }
    }
}

/// A truth per lane: known when the code is made, or a mask.
#[derive(Clone, Copy, Debug)]
pub enum Fact<V> {
    /// In no lane.
    False,
    /// In every lane.
    True,
    /// Where the mask is set.
    Lanes(V),
}

impl<V: Copy> Fact<V> {
    /// Both.
    #[must_use]
    pub fn and<M: Machine<V = V>>(self, m: &mut M, other: Self) -> Self {
        match (self, other) {
            (Self::False, _) | (_, Self::False) => Self::False,
            (Self::True, fact) | (fact, Self::True) => fact,
            (Self::Lanes(a), Self::Lanes(b)) => Self::Lanes(m.and(a, b)),
        }
    }

    /// Either.
    #[must_use]
    pub fn or<M: Machine<V = V>>(self, m: &mut M, other: Self) -> Self {
        match (self, other) {
            (Self::True, _) | (_, Self::True) => Self::True,
            (Self::False, fact) | (fact, Self::False) => fact,
            (Self::Lanes(a), Self::Lanes(b)) => Self::Lanes(m.or(a, b)),
        }
    }

    /// In the other lanes.
    #[must_use]
    pub fn not<M: Machine<V = V>>(self, m: &mut M, format: Format) -> Self {
        match self {
            Self::False => Self::True,
            Self::True => Self::False,
            Self::Lanes(mask) => {
                let ones = m.bits(format, u64::MAX);
                Self::Lanes(m.xor(mask, ones))
            }
        }
    }

    /// The fact as a mask.
    pub fn mask<M: Machine<V = V>>(self, m: &mut M, format: Format) -> V {
        match self {
            Self::False => m.bits(format, 0),
            Self::True => m.bits(format, u64::MAX),
            Self::Lanes(mask) => mask,
        }
    }
}

/// A value in lanes, and what is known of it whenever the code runs.
#[derive(Clone, Copy, Debug)]
pub struct Term<W> {
    /// The lanes.
    pub value: W,
    /// Every lane's bounds lie within these, for every box the code will ever see.
    pub range: Interval,
    /// Whether it is a constant integer; asked of exponents only.
    pub exponent: Exponent,
}

/// An operand of a rule.
pub type Operand<V> = Term<Enclosure<V>>;

/// What an operand is as an exponent: the domain of a power depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Exponent {
    /// It varies, or is a constant that is no integer: bases below 0 are outside the domain.
    #[default]
    Real,
    /// It is this integer, at every sample.
    Integer(i32),
    /// It is an integer too large for `i32`.
    LargeInteger {
        /// Whether it is odd.
        odd: bool,
    },
}

/// A sign that an operand's bounds are known to have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Nonneg,
    Nonpos,
    Unknown,
}

impl<W> Term<W> {
    /// Another value of which the same is known.
    pub fn with<U>(&self, value: U) -> Term<U> {
        Term { value, range: self.range, exponent: self.exponent }
    }
}

impl<V: Copy> Operand<V> {
    /// An operand that is no constant integer.
    pub fn new(value: Enclosure<V>, range: Interval) -> Self {
        Self { value, range, exponent: Exponent::Real }
    }

    pub(crate) fn sign(&self) -> Sign {
        if self.range.lo >= 0.0 {
            Sign::Nonneg
        } else if self.range.hi <= 0.0 {
            Sign::Nonpos
        } else {
            Sign::Unknown
        }
    }

    pub(crate) fn negated(&self) -> Self {
        Self {
            value: Enclosure { neg_lo: self.value.hi, hi: self.value.neg_lo, ..self.value },
            range: Interval { lo: -self.range.hi, hi: -self.range.lo },
            exponent: Exponent::Real,
        }
    }
}
