//! Operands and results of interval rules.

use crate::bounds::Interval;
use crate::machine::{Format, Machine};

/// Enclosures in lanes: negated lower bounds, upper bounds and facts.
#[derive(Clone, Copy, Debug)]
pub struct Enclosure<V> {
    /// The negated lower bounds, never NaN and never −∞.
    pub neg_lo: V,
    /// The upper bounds, never NaN and never −∞.
    pub hi: V,
    /// Facts about where the expression is defined and continuous.
    pub facts: Claims<V>,
}

impl<V: Copy> Enclosure<V> {
    /// The enclosure of an expression that is defined and continuous everywhere.
    pub fn total(neg_lo: V, hi: V) -> Self {
        Claims::TOTAL.with([neg_lo, hi])
    }

    /// Replaces each vector, always in the same order.
    #[must_use]
    pub fn map<U: Copy>(&self, f: &mut impl FnMut(V) -> U) -> Enclosure<U> {
        Enclosure { neg_lo: f(self.neg_lo), hi: f(self.hi), facts: self.facts.map(f) }
    }

    /// Combines the facts of this enclosure, which are about the operands, with `own`, the
    /// operation's claims about its domain.
    pub(crate) fn restricted<M: Machine<V = V>>(self, m: &mut M, own: &Claims<V>) -> Self {
        Self { facts: self.facts.and(m, own), ..self }
    }
}

/// Three facts per lane about where an expression is defined and continuous.
#[derive(Clone, Copy, Debug)]
pub struct Claims<V> {
    /// Lanes where the expression is defined at no point of the box.
    pub nowhere: Fact<V>,
    /// Lanes where the expression is defined at every point of the box.
    pub defined: Fact<V>,
    /// Lanes where the expression is defined and continuous at every point of the box.
    pub continuous: Fact<V>,
}

impl<V: Copy> Claims<V> {
    pub(crate) const TOTAL: Self =
        Self { nowhere: Fact::False, defined: Fact::True, continuous: Fact::True };

    /// The claims of an operation that is continuous where it is defined. It is defined at no point
    /// of the box in the lanes `nowhere`, and at every point in the lanes `throughout`.
    pub(crate) fn of_domain(nowhere: Fact<V>, throughout: Fact<V>) -> Self {
        Self { nowhere, defined: throughout, continuous: throughout }
    }

    pub(crate) fn with(self, [neg_lo, hi]: [V; 2]) -> Enclosure<V> {
        Enclosure { neg_lo, hi, facts: self }
    }

    /// Replaces each vector, always in the same order.
    #[must_use]
    pub fn map<U: Copy>(&self, f: &mut impl FnMut(V) -> U) -> Claims<U> {
        Claims {
            nowhere: self.nowhere.map(f),
            defined: self.defined.map(f),
            continuous: self.continuous.map(f),
        }
    }

    /// Encodes the three facts as digits to base 3: 0 for false, 1 for true, 2 for a mask.
    pub fn shape(&self) -> u128 {
        let Self { nowhere, defined, continuous } = self;
        [nowhere, defined, continuous].iter().fold(0, |code, fact| 3 * code + fact.shape())
    }

    pub(crate) fn and<M: Machine<V = V>>(self, m: &mut M, other: &Self) -> Self {
        Self {
            nowhere: self.nowhere.or(m, other.nowhere),
            defined: self.defined.and(m, other.defined),
            continuous: self.continuous.and(m, other.continuous),
        }
    }
}

/// A truth value per lane: a mask, or a constant that is known when code is compiled.
#[derive(Clone, Copy, Debug)]
pub enum Fact<V> {
    /// False in every lane.
    False,
    /// True in every lane.
    True,
    /// True in the lanes of this mask.
    Lanes(V),
}

impl<V: Copy> Fact<V> {
    /// Returns the lanes where both facts hold.
    #[must_use]
    pub fn and<M: Machine<V = V>>(self, m: &mut M, other: Self) -> Self {
        match (self, other) {
            (Self::False, _) | (_, Self::False) => Self::False,
            (Self::True, fact) | (fact, Self::True) => fact,
            (Self::Lanes(a), Self::Lanes(b)) => Self::Lanes(m.and(a, b)),
        }
    }

    /// Returns the lanes where at least one of the facts holds.
    #[must_use]
    pub fn or<M: Machine<V = V>>(self, m: &mut M, other: Self) -> Self {
        match (self, other) {
            (Self::True, _) | (_, Self::True) => Self::True,
            (Self::False, fact) | (fact, Self::False) => fact,
            (Self::Lanes(a), Self::Lanes(b)) => Self::Lanes(m.or(a, b)),
        }
    }

    /// Returns the lanes where the fact does not hold.
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

    /// Replaces the vector, if there is one.
    #[must_use]
    pub fn map<U>(self, f: &mut impl FnMut(V) -> U) -> Fact<U> {
        match self {
            Self::False => Fact::False,
            Self::True => Fact::True,
            Self::Lanes(mask) => Fact::Lanes(f(mask)),
        }
    }

    /// 0 if false everywhere, 1 if true everywhere, 2 for a mask.
    pub fn shape(&self) -> u128 {
        match self {
            Self::False => 0,
            Self::True => 1,
            Self::Lanes(_) => 2,
        }
    }

    /// Returns the fact as a mask.
    pub fn mask<M: Machine<V = V>>(self, m: &mut M, format: Format) -> V {
        match self {
            Self::False => m.bits(format, 0),
            Self::True => m.bits(format, u64::MAX),
            Self::Lanes(mask) => mask,
        }
    }
}

/// A value per lane, and what is known about the values when code is compiled.
#[derive(Clone, Copy, Debug)]
pub struct Term<W> {
    /// The value in each lane.
    pub value: W,
    /// Interval that contains the bounds of every lane whenever the code runs.
    pub range: Interval,
    /// The value's kind as an exponent, which matters only if an operation uses it as one.
    pub exponent: Exponent,
}

/// An enclosure as an operand of a rule.
pub type Operand<V> = Term<Enclosure<V>>;

/// The kind of an operand as an exponent, on which the domain of a power depends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Exponent {
    /// Not a constant integer. The domain of the power then has no bases below 0.
    #[default]
    Real,
    /// A constant integer that fits `i32`.
    Integer(i32),
    /// A constant integer that does not fit `i32`.
    LargeInteger {
        /// Whether the integer is odd.
        odd: bool,
    },
}

/// The sign that an operand's range proves for all its values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sign {
    Nonneg,
    Nonpos,
    Unknown,
}

impl<W> Term<W> {
    /// Returns `value` with this term's range and kind as an exponent.
    pub fn with<U>(&self, value: U) -> Term<U> {
        Term { value, range: self.range, exponent: self.exponent }
    }
}

impl<V: Copy> Operand<V> {
    /// Returns an operand that is not a constant integer.
    pub fn new(value: Enclosure<V>, range: Interval) -> Self {
        Self { value, range, exponent: Exponent::Real }
    }

    /// The sign of all values of the operand on the domain.
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
