//! Roots of a polynomial in one of its variables: the polynomials r for which v − r divides it.
//!
//! A variable of degree 1 has one root. For higher degrees, the other variables get values, and
//! each simple rational root t there is continued to a polynomial (Hensel's lemma): in powers of
//! the distance from these values, one degree after the other. The root is kept if it proves to be
//! one. So x² − y² has the roots y and −y, and x⁴ − y⁶·x² has 0, which is double, y³ and −y³.

use crate::graph::NodeId;
use crate::polynomial::{Polynomial, Work};
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, ToPrimitive, Zero};

/// Largest degree at which roots are looked for.
const DEGREE_LIMIT: u32 = 8;
/// Largest numerator and denominator whose divisors are looked for.
const DIVISOR_LIMIT: u64 = 1 << 20;
/// Values of the other variables, at which roots are rarely multiple.
const VALUES: [i64; 4] = [2, 3, 5, 7];

/// A variable, and a value at which a polynomial is 0.
pub(crate) type Root = (NodeId, Polynomial);

/// The roots of a polynomial in each variable whose leading coefficient is a number.
pub(crate) fn roots(polynomial: &Polynomial, work: &mut Work) -> Vec<Root> {
    let mut found = Vec::new();
    for variable in polynomial.variables() {
        let roots = match polynomial.degree(variable) {
            1 => linear_root(polynomial, variable, work).map(|root| vec![root]),
            2..=DEGREE_LIMIT => continued_roots(polynomial, variable, work),
            _ => None,
        };
        found.extend(roots.into_iter().flatten().map(|root| (variable, root)));
    }
    found
}

fn linear_root(polynomial: &Polynomial, variable: NodeId, work: &mut Work) -> Option<Polynomial> {
    let factor = polynomial.linear_factor(variable)?;
    let term = Polynomial::variable(variable).times(&Polynomial::constant(factor.clone()), work);
    let rest = term?.minus(polynomial);
    rest.times(&Polynomial::constant(factor.recip()), work)
}

/// The roots in a variable that are simple where the other variables have their [`VALUES`].
fn continued_roots(
    polynomial: &Polynomial,
    variable: NodeId,
    work: &mut Work,
) -> Option<Vec<Polynomial>> {
    let degree = polynomial.degree(variable);
    polynomial.coefficient(variable, degree).as_constant()?;
    let others = polynomial.variables().into_iter().filter(|other| *other != variable);
    let others: Vec<(NodeId, BigRational)> = others
        .zip(VALUES)
        .map(|(id, value)| (id, BigRational::from_integer(value.into())))
        .collect();
    if others.len() + 1 < polynomial.variables().len() {
        return None;
    }
    let moved = |polynomial: &Polynomial, sign: i64, work: &mut Work| {
        others.iter().try_fold(polynomial.clone(), |moved, (id, value)| {
            let value = value * BigRational::from_integer(sign.into());
            moved.substituted(
                *id,
                &Polynomial::variable(*id).plus(&Polynomial::constant(value)),
                work,
            )
        })
    };
    let local = moved(polynomial, 1, work)?;
    let at_values: Vec<BigRational> =
        (0..=degree).map(|n| local.coefficient(variable, n).constant_term()).collect();
    let mut found = Vec::new();
    for start in rational_roots(&at_values) {
        if let Some(root) = continued(&local, variable, &start, &at_values, work) {
            found.push(moved(&root, -1, work)?);
        }
    }
    Some(found)
}

/// The root that is `start` where all other variables are 0. `None` if it is no polynomial or is
/// multiple there.
fn continued(
    polynomial: &Polynomial,
    variable: NodeId,
    start: &BigRational,
    at_zero: &[BigRational],
    work: &mut Work,
) -> Option<Polynomial> {
    let terms = at_zero.iter().enumerate().skip(1);
    let slope: BigRational = terms
        .map(|(n, value)| value * BigRational::from_integer(n.into()) * start.pow(n as i32 - 1))
        .sum();
    if slope.is_zero() {
        return None;
    }
    let mut root = Polynomial::constant(start.clone());
    for degree in 1..=DEGREE_LIMIT {
        let rest = polynomial.substituted(variable, &root, work)?;
        if rest.is_zero() {
            return Some(root);
        }
        root = root.minus(&rest.part_of_degree(degree).scaled(&slope.recip()));
    }
    polynomial.substituted(variable, &root, work)?.is_zero().then_some(root)
}

/// The rational roots of a polynomial in one variable, from its coefficients. Its leading
/// coefficient is not 0. Too large coefficients have none.
fn rational_roots(coefficients: &[BigRational]) -> Vec<BigRational> {
    let value = |at: &BigRational| {
        let one_more = |value: BigRational, next: &BigRational| value * at + next;
        coefficients.iter().rev().fold(BigRational::zero(), one_more)
    };
    let common = coefficients.iter().fold(BigInt::one(), |common, next| common.lcm(next.denom()));
    let whole = |value: &BigRational| (value * &common).to_integer();
    let mut nonzero = coefficients.iter().filter(|value| !value.is_zero());
    let Some(first) = nonzero.next() else { return Vec::new() };
    let last = nonzero.next_back().unwrap_or(first);
    let (numerators, denominators) = (divisors(&whole(first)), divisors(&whole(last)));
    let mut found: Vec<BigRational> = denominators
        .iter()
        .flat_map(|below| numerators.iter().map(move |above| (above, below)))
        .flat_map(|(above, below)| {
            [1, -1].map(|sign| BigRational::new((above * sign).into(), (*below).into()))
        })
        .chain([BigRational::zero()])
        .filter(|at| value(at).is_zero())
        .collect();
    found.sort();
    found.dedup();
    found
}

/// The positive divisors of a number. None if it is large.
fn divisors(number: &BigInt) -> Vec<i64> {
    let magnitude = number.magnitude().to_u64().filter(|value| *value <= DIVISOR_LIMIT);
    let magnitude = magnitude.unwrap_or(0) as i64;
    let small: Vec<i64> = (1..=magnitude.isqrt()).filter(|n| magnitude % n == 0).collect();
    small.iter().map(|n| magnitude / n).chain(small.iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Axis, Graph};

    /// The values in x at which a polynomial in x and y is 0, from rows of coefficient and
    /// exponents.
    fn roots_in_x(terms: &[(i64, u32, u32)]) -> Vec<Polynomial> {
        let mut work = Work(20_000);
        let (polynomial, [x, _]) = polynomial(terms, &mut work);
        let roots = roots(&polynomial, &mut work);
        roots.into_iter().filter(|(id, _)| *id == x).map(|(_, root)| root).collect()
    }

    fn polynomial(terms: &[(i64, u32, u32)], work: &mut Work) -> (Polynomial, [NodeId; 2]) {
        let mut graph = Graph::new();
        let ids = [Axis::X, Axis::Y].map(|axis| graph.variable(axis));
        let [x, y] = ids.map(Polynomial::variable);
        let term = |work: &mut Work, (factor, m, n): (i64, u32, u32)| {
            let factor = Polynomial::constant(BigRational::from_integer(factor.into()));
            factor.times(&x.raised(m, work)?, work)?.times(&y.raised(n, work)?, work)
        };
        let add = |sum: Polynomial, next| sum.plus(&term(work, next).expect("small"));
        (terms.iter().copied().fold(Polynomial::default(), add), ids)
    }

    #[track_caller]
    fn assert_roots(terms: &[(i64, u32, u32)], expected: &[&[(i64, u32, u32)]]) {
        let found = roots_in_x(terms);
        let expected: Vec<Polynomial> =
            expected.iter().map(|terms| polynomial(terms, &mut Work(20_000)).0).collect();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(expected.iter().all(|root| found.contains(root)), "{found:?}");
    }

    #[test]
    fn factors_of_degree_one_are_found() {
        assert_roots(&[(2, 1, 0), (-6, 0, 2)], &[&[(3, 0, 2)]]);
        assert_roots(&[(1, 2, 0), (-1, 0, 2)], &[&[(1, 0, 1)], &[(-1, 0, 1)]]);
        assert_roots(&[(1, 3, 0), (-1, 0, 3)], &[&[(1, 0, 1)]]);
        assert_roots(&[(1, 2, 0), (-1, 0, 6)], &[&[(1, 0, 3)], &[(-1, 0, 3)]]);
        // The product (x + 2y)(x − y + 3).
        assert_roots(
            &[(1, 2, 0), (1, 1, 1), (-2, 0, 2), (3, 1, 0), (6, 0, 1)],
            &[&[(-2, 0, 1)], &[(1, 0, 1), (-3, 0, 0)]],
        );
        assert_roots(&[(1, 3, 0), (-1, 1, 0)], &[&[(1, 0, 0)], &[(-1, 0, 0)], &[]]);
    }

    #[test]
    fn other_polynomials_have_no_roots() {
        assert_roots(&[(1, 2, 0), (1, 0, 2)], &[]);
        assert_roots(&[(1, 2, 0), (-1, 0, 1)], &[]);
        assert_roots(&[(1, 2, 0), (-1, 0, 2), (1, 0, 0)], &[]);
        // A double root is not continued.
        assert_roots(&[(1, 2, 0), (-2, 1, 1), (1, 0, 2)], &[]);
    }
}
