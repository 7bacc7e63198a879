//! A machine that records.

use super::polynomial::{Atom, Polynomial, atom, constant, plus, size_of_terms, times};
use crate::machine::{Format, Machine};

/// A machine whose vectors are numbers of recorded values.
#[derive(Clone, Default)]
pub(super) struct Recorder {
    pub(super) values: Vec<Polynomial>,
    /// The exact result of each operation that rounds.
    pub(super) exact: Vec<Polynomial>,
    /// Whether a·b + c is rounded once.
    pub(super) fuses: bool,
}

impl Recorder {
    pub(super) fn record(&mut self, value: Polynomial) -> usize {
        self.values.push(value);
        self.values.len() - 1
    }

    pub(super) fn input(&mut self, name: &'static str) -> usize {
        self.record(atom(Atom::Input(name)))
    }

    /// An input that is not below 0.
    pub(super) fn magnitude(&mut self, name: &'static str) -> usize {
        self.record(atom(Atom::Size(name)))
    }

    fn rounded(&mut self, exact: Polynomial) -> usize {
        let rounding = atom(Atom::Rounding(self.exact.len()));
        let value = plus(&exact, &rounding, 1.0);
        self.exact.push(exact);
        self.record(value)
    }

    /// A product. Products by powers of two are exact.
    fn product(&self, a: usize, b: usize) -> (Polynomial, bool) {
        let (a, b) = (&self.values[a], &self.values[b]);
        let is_power = |factor: &Polynomial| {
            let value = factor.get(&Vec::new()).copied().unwrap_or(0.0);
            factor.len() == 1 && value.abs().log2().fract() == 0.0
        };
        let is_exact = a.is_empty() || b.is_empty() || is_power(a) || is_power(b);
        (times(a, b), is_exact)
    }
}

impl Machine for Recorder {
    type V = usize;

    fn number(&mut self, _: Format, value: f64) -> usize {
        self.record(constant(value))
    }

    /// Numbers below all normal ones count as 0, as the page says of its model.
    fn bits(&mut self, _: Format, bits: u64) -> usize {
        assert_eq!(bits, 64, "only `tiny` is made of bits");
        self.record(Polynomial::new())
    }

    fn add(&mut self, a: usize, b: usize) -> usize {
        let (one, other) = (&self.values[a], &self.values[b]);
        let sum = plus(one, other, 1.0);
        if one.is_empty() || other.is_empty() { self.record(sum) } else { self.rounded(sum) }
    }

    fn sub(&mut self, a: usize, b: usize) -> usize {
        let opposite = self.neg(b);
        self.add(a, opposite)
    }

    fn mul(&mut self, a: usize, b: usize) -> usize {
        let (product, is_exact) = self.product(a, b);
        if is_exact { self.record(product) } else { self.rounded(product) }
    }

    fn mul_add(&mut self, a: usize, b: usize, c: usize) -> usize {
        if !self.fuses {
            let product = self.mul(a, b);
            return self.add(product, c);
        }
        let (product, is_exact) = self.product(a, b);
        let sum = plus(&product, &self.values[c], 1.0);
        let is_exact = is_exact && self.values[c].is_empty();
        if is_exact { self.record(sum) } else { self.rounded(sum) }
    }

    fn neg(&mut self, a: usize) -> usize {
        let opposite = plus(&Polynomial::new(), &self.values[a], -1.0);
        self.record(opposite)
    }

    fn abs(&mut self, a: usize) -> usize {
        let value = &self.values[a];
        let sizes = size_of_terms(value);
        if value.len() <= 1 || sizes == *value {
            return self.record(sizes);
        }
        self.record(atom(Atom::SizeOf(a)))
    }

    not_recorded! {
        div(a: usize, b: usize) -> usize;
        sqrt(a: usize) -> usize;
        min(a: usize, b: usize) -> usize;
        max(a: usize, b: usize) -> usize;
        lt(a: usize, b: usize) -> usize;
        select(mask: usize, a: usize, b: usize) -> usize;
    }
    integers_and_bits_are_not_recorded!(usize);
}
