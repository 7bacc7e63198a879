//! Sums and products whose parts are still being collected, before they become nodes.

use super::numbers;
use crate::graph::NodeId;
use num_rational::BigRational;
use num_traits::{One, Zero};
use zeroset_ops::Restriction;

/// An expression of the given graph, as rewritten so far.
#[derive(Clone, Debug)]
pub(super) enum PartialExpr {
    /// A node of the simplified graph.
    Node(NodeId),
    /// A sum that may still grow.
    Sum(Sum),
    /// A product that may still grow.
    Product(Product),
}

/// A condition for an expression to be defined: the node must meet the restriction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Condition(pub(super) Restriction, pub(super) NodeId);

/// A sum `±(constant + Σ cᵢ·tᵢ)`. The terms tᵢ are nodes without coefficients of their own.
#[derive(Clone, Debug, Default)]
pub(super) struct Sum {
    /// Whether constants and coefficients are stored with the opposite sign. Negating the sum only
    /// flips this flag. Otherwise nested differences would take quadratic time.
    negated: bool,
    constants: Vec<BigRational>,
    terms: Vec<(NodeId, BigRational)>,
    pub(super) conditions: Vec<Condition>,
}

impl Sum {
    pub(super) fn negate(&mut self) {
        self.negated = !self.negated;
    }

    pub(super) fn add_constant(&mut self, value: BigRational) {
        if !value.is_zero() {
            self.constants.push(if self.negated { -value } else { value });
        }
    }

    pub(super) fn add_term(&mut self, term: NodeId, coefficient: BigRational) {
        let signed = if self.negated { -coefficient } else { coefficient };
        self.terms.push((term, signed));
    }

    /// Adds `other` to this sum. The shorter list of terms is moved into the longer one.
    pub(super) fn plus(mut self, mut other: Self) -> Self {
        if self.terms.len() + self.constants.len() < other.terms.len() + other.constants.len() {
            std::mem::swap(&mut self, &mut other);
        }
        let flip = self.negated != other.negated;
        let signed = |value: BigRational| if flip { -value } else { value };
        self.constants.extend(other.constants.into_iter().map(signed));
        self.terms.extend(other.terms.into_iter().map(|(term, c)| (term, signed(c))));
        self.conditions.append(&mut other.conditions);
        self
    }

    /// Returns the constants, the terms and the conditions, with `negated` applied.
    pub(super) fn into_parts(
        self,
    ) -> (Vec<BigRational>, Vec<(NodeId, BigRational)>, Vec<Condition>) {
        if !self.negated {
            return (self.constants, self.terms, self.conditions);
        }
        (
            self.constants.into_iter().map(|c| -c).collect(),
            self.terms.into_iter().map(|(term, c)| (term, -c)).collect(),
            self.conditions,
        )
    }
}

/// A base to an integer power.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Factor {
    pub(super) base: NodeId,
    pub(super) exponent: i64,
    /// Whether the factor is undefined where its base is 0, even if its exponent is not negative.
    pub(super) nonzero: bool,
}

impl Factor {
    /// The condition under which the factor is defined.
    pub(super) fn condition(&self) -> Condition {
        let nonzero = self.nonzero || self.exponent < 0;
        let restriction = if nonzero { Restriction::Nonzero } else { Restriction::Defined };
        Condition(restriction, self.base)
    }
}

/// A product `coefficient · Π baseᵢ^exponentᵢ`.
#[derive(Clone, Debug)]
pub(super) struct Product {
    pub(super) coefficient: BigRational,
    pub(super) factors: Vec<Factor>,
    pub(super) conditions: Vec<Condition>,
    /// Whether equal bases may still have to be merged. While a long product grows, merging after
    /// each step would take quadratic time.
    pub(super) is_unmerged: bool,
}

impl Product {
    pub(super) fn number(coefficient: BigRational) -> Self {
        Self { coefficient, factors: Vec::new(), conditions: Vec::new(), is_unmerged: false }
    }

    pub(super) fn power(base: NodeId, exponent: i64) -> Self {
        let factors = vec![Factor { base, exponent, nonzero: false }];
        Self { factors, ..Self::number(BigRational::one()) }
    }

    /// The value of the product, if it has no factors and no conditions.
    pub(super) fn as_number(&self) -> Option<&BigRational> {
        (self.factors.is_empty() && self.conditions.is_empty()).then_some(&self.coefficient)
    }

    /// The `n`-th power of the product. `None` if an exponent or the coefficient is too large.
    pub(super) fn raised(&self, n: i64) -> Option<Self> {
        /// Largest exponent of a factor. A larger power becomes a node of its own.
        const EXPONENT_LIMIT: u64 = 1 << 16;
        let mut result = self.clone();
        result.coefficient = numbers::power(&self.coefficient, n)?;
        for factor in &mut result.factors {
            factor.nonzero |= factor.exponent < 0 || n < 0;
            factor.exponent = factor.exponent.checked_mul(n)?;
            if factor.exponent.unsigned_abs() > EXPONENT_LIMIT {
                return None;
            }
        }
        Some(result)
    }
}
