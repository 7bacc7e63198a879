//! Functions of sums, as polynomials in functions of their parts, by addition theorems.
//!
//! In (x·sin y − y·sin x)/(x² − y²), the denominator has the factors p = x − y and q = x + y. With
//! x = (q + p)/2 and y = (q − p)/2, the numerator becomes a polynomial in p, q and the sines and
//! cosines of p/2 and q/2. In it, p and q are factors of the terms with sin(p/2) and sin(q/2).

use crate::graph::{Graph, Node, NodeId};
use crate::polynomial::{Polynomial, Work};
use crate::roots::{Root, roots};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use zeroset_ops::Op;

/// The odd and the even function of an addition theorem, by which a function is expressed, and the
/// sign s in even(a + b) = even(a)·even(b) + s·odd(a)·odd(b).
fn theorem(op: Op) -> Option<(Op, Op, i8)> {
    match op {
        Op::Sin | Op::Cos => Some((Op::Sin, Op::Cos, -1)),
        Op::Sinh | Op::Cosh | Op::Exp => Some((Op::Sinh, Op::Cosh, 1)),
        _ => None,
    }
}

/// Returns whether a polynomial has a function with an addition theorem.
pub(crate) fn has_sums(graph: &Graph, polynomial: &Polynomial) -> bool {
    let is_sum = |id: &NodeId| match graph.node(*id) {
        Node::Apply(op, _) => theorem(*op).is_some(),
        _ => false,
    };
    polynomial.variables().iter().any(is_sum)
}

/// Two linear factors of denominators, and the two variables that they determine.
pub(crate) struct FactorPair {
    factors: [Polynomial; 2],
    variables: [NodeId; 2],
    /// The coefficients of the variables in both factors, and their determinant.
    coefficients: [[BigRational; 2]; 2],
    determinant: BigRational,
}

/// Pairs of linear factors of the polynomials that are independent in two variables.
pub(crate) fn factor_pairs(denominators: &[Polynomial], work: &mut Work) -> Vec<FactorPair> {
    let found: Vec<Root> = denominators.iter().flat_map(|below| roots(below, work)).collect();
    let mut pairs = Vec::new();
    for (at, (variable, first)) in found.iter().enumerate() {
        for (_, second) in found[at + 1..].iter().filter(|(other, _)| other == variable) {
            pairs.extend(independent(*variable, [first, second]));
        }
    }
    pairs
}

/// The factors v − r for two roots r, if these differ in the coefficient of a second variable.
fn independent(variable: NodeId, roots: [&Polynomial; 2]) -> Option<FactorPair> {
    let factors = roots.map(|root| Polynomial::variable(variable).minus(root));
    let shared = factors[0].variables().into_iter().filter(|other| *other != variable);
    let mut shared = shared.filter_map(|other| {
        let coefficients = [linear(&factors[0], other)?, linear(&factors[1], other)?];
        let determinant = &coefficients[1] - &coefficients[0];
        (!determinant.is_zero()).then_some((other, coefficients, determinant))
    });
    let (other, [a, b], determinant) = shared.next()?;
    let one = BigRational::one;
    Some(FactorPair {
        factors,
        variables: [variable, other],
        coefficients: [[one(), a], [one(), b]],
        determinant,
    })
}

/// The coefficient of a variable in a polynomial that is linear in it, also if it is 0.
fn linear(polynomial: &Polynomial, variable: NodeId) -> Option<BigRational> {
    match polynomial.degree(variable) {
        0 => Some(BigRational::zero()),
        _ => polynomial.linear_factor(variable),
    }
}

impl FactorPair {
    /// The terms of a sum: a multiple of each factor, and a rest without both variables. `None` if
    /// there is only one term.
    fn terms(&self, sum: &Polynomial) -> Option<Vec<Polynomial>> {
        let [first, second] = &self.coefficients;
        let [a, b] = [linear(sum, self.variables[0])?, linear(sum, self.variables[1])?];
        let multiples = [
            (&a * &second[1] - &b * &second[0]) / &self.determinant,
            (&b * &first[0] - &a * &first[1]) / &self.determinant,
        ];
        let mut terms: Vec<Polynomial> = self
            .factors
            .iter()
            .zip(&multiples)
            .map(|(factor, multiple)| factor.scaled(multiple))
            .collect();
        terms.push(sum.clone().minus(&terms[0]).minus(&terms[1]));
        terms.retain(|term| !term.is_zero());
        (terms.len() > 1).then_some(terms)
    }

    /// The polynomial with the addition theorem in place of each function of a sum.
    pub fn expanded(
        &self,
        graph: &mut Graph,
        polynomial: &Polynomial,
        work: &mut Work,
    ) -> Option<Polynomial> {
        let mut result = polynomial.clone();
        for node in polynomial.variables() {
            let Node::Apply(op, operands) = *graph.node(node) else { continue };
            let Some((odd, even, sign)) = theorem(op) else { continue };
            let sign = BigRational::from_integer(sign.into());
            let sum = Polynomial::of(graph, operands[0], work);
            let Some(terms) = self.terms(&sum) else { continue };
            // The odd and the even function of the sum of the terms so far.
            let mut sums = [Polynomial::default(), Polynomial::constant(BigRational::one())];
            for term in terms {
                let next = values(graph, [odd, even], &term);
                let mut product = |a: usize, b: usize| sums[a].times(&next[b], work);
                let odd = product(0, 1)?.plus(&product(1, 0)?);
                let even = product(1, 1)?.plus(&product(0, 0)?.scaled(&sign));
                sums = [odd, even];
            }
            let value = match op {
                Op::Sin | Op::Sinh => sums[0].clone(),
                Op::Cos | Op::Cosh => sums[1].clone(),
                _ => sums[0].clone().plus(&sums[1]),
            };
            result = result.substituted(node, &value, work)?;
        }
        (result != *polynomial).then_some(result)
    }
}

/// An odd and an even function of a term. The same nodes serve the term and its negative.
fn values(graph: &mut Graph, ops: [Op; 2], term: &Polynomial) -> [Polynomial; 2] {
    let one = BigRational::one();
    let sign = if term.leading_coefficient().is_negative() { -one } else { one };
    let operand = term.scaled(&sign).emit(graph);
    let [odd, even] = ops.map(|op| Polynomial::variable(graph.apply(op, &[operand])));
    [odd.scaled(&sign), even]
}
