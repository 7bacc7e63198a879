//! Polynomials of recorded values.

use std::collections::BTreeMap;

/// A factor of a monomial.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Atom {
    /// An input with a sign.
    Input(&'static str),
    /// The magnitude of an input, or an input that is not below 0.
    Size(&'static str),
    /// The magnitude of a recorded value, by its number.
    SizeOf(usize),
    /// The error of an operation, by its number: at least 0, and less than a unit of the exact
    /// result and of the rounded one.
    Rounding(usize),
}

pub(super) type Monomial = Vec<Atom>;

/// Coefficients are dyadic, so their products are exact.
pub(super) type Polynomial = BTreeMap<Monomial, f64>;

pub(super) fn constant(value: f64) -> Polynomial {
    if value == 0.0 { Polynomial::new() } else { Polynomial::from([(Vec::new(), value)]) }
}

pub(super) fn atom(atom: Atom) -> Polynomial {
    Polynomial::from([(vec![atom], 1.0)])
}

pub(super) fn plus(a: &Polynomial, b: &Polynomial, factor: f64) -> Polynomial {
    let mut sum = a.clone();
    for (monomial, value) in b {
        *sum.entry(monomial.clone()).or_default() += factor * value;
    }
    sum.retain(|_, value| *value != 0.0);
    sum
}

pub(super) fn joined(a: &Monomial, b: &Monomial) -> Monomial {
    let mut joined = [&a[..], b].concat();
    joined.sort();
    joined
}

pub(super) fn times(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut product = Polynomial::new();
    for (one, left) in a {
        for (other, right) in b {
            *product.entry(joined(one, other)).or_default() += left * right;
        }
    }
    product
}

/// The magnitude of a monomial, which is one.
pub(super) fn size(monomial: &Monomial) -> Monomial {
    let mut sizes: Monomial = monomial
        .iter()
        .map(|atom| match atom {
            Atom::Input(name) => Atom::Size(name),
            other => *other,
        })
        .collect();
    sizes.sort();
    sizes
}

/// The sum of the magnitudes of all terms.
pub(super) fn size_of_terms(polynomial: &Polynomial) -> Polynomial {
    let mut sum = Polynomial::new();
    for (monomial, value) in polynomial {
        *sum.entry(size(monomial)).or_default() += value.abs();
    }
    sum
}
