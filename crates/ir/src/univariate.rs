//! Polynomials in one variable with exact coefficients.

use crate::algebra::{add, mul};
use crate::constant::{Constant, bits};
use crate::graph::{Axis, Graph, Node, NodeId};
use num_rational::BigRational;
use num_traits::{One, Zero};
use std::collections::HashMap;
use zeroset_ops::Op;

/// Largest degree of a polynomial. Polynomials of higher degree are left as they are.
const DEGREE_LIMIT: usize = 64;
/// Largest number of bits of a coefficient's numerator or denominator.
const BITS_LIMIT: u64 = 4096;
/// Largest number of nodes of an expression. Larger expressions are left as they are.
const NODE_LIMIT: usize = 2048;
/// Budget of exact arithmetic for all factors of one function. It counts products of two 64-bit
/// words and takes some tenths of a second.
pub(crate) const WORK_LIMIT: u64 = 2_500_000;

/// The coefficients of a polynomial, from the constant term on. The last coefficient is not 0.
type Coefficients = Vec<BigRational>;

/// Adds a polynomial to `graph` whose zeros are those of `root`, each of them simple. `None` if
/// `root` is not a polynomial in one variable with a multiple root, if it is too large, or if
/// `work` is used up. The cost is subtracted from `work`.
pub(crate) fn squarefree(graph: &mut Graph, root: NodeId, work: &mut u64) -> Option<NodeId> {
    let (axis, polynomial) = expanded(graph, root, work)?;
    let common = gcd(polynomial.clone(), derivative(&polynomial), work)?;
    if common.len() < 2 {
        return None;
    }
    let (simple, rest) = divided(polynomial, &common, work)?;
    debug_assert!(rest.is_empty(), "the common divisor divides");
    let variable = graph.variable(axis);
    let mut value = graph.integer(0);
    for coefficient in simple.into_iter().rev() {
        let coefficient = graph.constant(Constant::rational(coefficient));
        let product = mul(graph, value, variable);
        value = add(graph, product, coefficient);
    }
    Some(value)
}

/// The axis and the coefficients of `root`, if it is a polynomial in one variable of degree 2 or
/// more.
fn expanded(graph: &Graph, root: NodeId, work: &mut u64) -> Option<(Axis, Coefficients)> {
    let ids = graph.needed(&[root]);
    if ids.len() > NODE_LIMIT {
        return None;
    }
    let mut axis = None;
    let mut known: HashMap<NodeId, Coefficients> = HashMap::new();
    for id in ids {
        let polynomial = match graph.node(id) {
            Node::Constant(value) => trimmed(vec![value.exact()?.clone()]),
            Node::Parameter(_) => return None,
            Node::Variable(other) => {
                if *axis.get_or_insert(*other) != *other {
                    return None;
                }
                vec![BigRational::zero(), BigRational::one()]
            }
            Node::Apply(op, operands) => {
                let operand = |k: usize| &known[&operands[k]];
                if *op == Op::Neg {
                    scaled(operand(0), &-BigRational::one())
                } else if *op == Op::Add {
                    sum(operand(0), operand(1))
                } else if *op == Op::Sub {
                    sum(operand(0), &scaled(operand(1), &-BigRational::one()))
                } else if *op == Op::Mul {
                    product(operand(0), operand(1), work)?
                } else if *op == Op::Sqr {
                    product(operand(0), operand(0), work)?
                } else if *op == Op::Div && operand(1).len() == 1 {
                    scaled(operand(0), &operand(1)[0].recip())
                } else if *op == Op::Pow {
                    power(operand(0), graph.number(operands[1])?, work)?
                } else {
                    return None;
                }
            }
        };
        known.insert(id, polynomial);
    }
    let polynomial = known.remove(&root).filter(|polynomial| polynomial.len() > 2)?;
    axis.map(|axis| (axis, polynomial))
}

fn power(base: &Coefficients, exponent: &Constant, work: &mut u64) -> Option<Coefficients> {
    let exponent = usize::try_from(exponent.as_integer()?).ok()?;
    if exponent > DEGREE_LIMIT {
        return None; // powers of the polynomial 0 take nothing from `work`
    }
    let one = vec![BigRational::one()];
    (0..exponent).try_fold(one, |power, _| product(&power, base, work))
}

fn trimmed(mut polynomial: Coefficients) -> Coefficients {
    while polynomial.last().is_some_and(Zero::is_zero) {
        polynomial.pop();
    }
    polynomial
}

fn scaled(polynomial: &Coefficients, factor: &BigRational) -> Coefficients {
    trimmed(polynomial.iter().map(|coefficient| coefficient * factor).collect())
}

fn sum(a: &Coefficients, b: &Coefficients) -> Coefficients {
    let (long, short) = if a.len() >= b.len() { (a, b) } else { (b, a) };
    let mut sum = long.clone();
    sum.iter_mut().zip(short).for_each(|(into, other)| *into += other);
    trimmed(sum)
}

/// The product of two polynomials, or `None` if it is too large or `work` is used up.
fn product(a: &Coefficients, b: &Coefficients, work: &mut u64) -> Option<Coefficients> {
    if a.is_empty() || b.is_empty() {
        return Some(Coefficients::new());
    }
    let mut product = vec![BigRational::zero(); a.len() + b.len() - 1];
    if product.len() > DEGREE_LIMIT + 1 {
        return None;
    }
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            spend(work, a, b)?;
            product[i + j] += a * b;
        }
    }
    is_moderate(&product).then_some(product)
}

/// Subtracts from `work` the cost of multiplying `a` and `b`, and of the gcd that adding the
/// product to a number takes. `None` if `work` is used up.
fn spend(work: &mut u64, a: &BigRational, b: &BigRational) -> Option<()> {
    let words = |value: &BigRational| 1 + bits(value) / 64;
    *work = work.checked_sub((words(a) + words(b)).pow(2))?;
    Some(())
}

fn is_moderate(polynomial: &[BigRational]) -> bool {
    polynomial.iter().all(|value| bits(value) <= BITS_LIMIT)
}

fn derivative(polynomial: &Coefficients) -> Coefficients {
    let term =
        |(n, coefficient): (usize, &BigRational)| coefficient * BigRational::from_integer(n.into());
    trimmed(polynomial.iter().enumerate().skip(1).map(term).collect())
}

/// Quotient and remainder of polynomials; `None` if they grow too large or `work` is used up.
fn divided(
    mut rest: Coefficients,
    by: &Coefficients,
    work: &mut u64,
) -> Option<(Coefficients, Coefficients)> {
    let last = by.last()?;
    let mut quotient = vec![BigRational::zero(); (rest.len() + 1).saturating_sub(by.len())];
    while rest.len() >= by.len() {
        let factor = rest.last()? / last;
        let shift = rest.len() - by.len();
        for (k, coefficient) in by.iter().enumerate() {
            spend(work, coefficient, &factor)?;
            rest[shift + k] -= coefficient * &factor;
        }
        quotient[shift] = factor;
        rest = trimmed(rest);
        if !is_moderate(&rest) {
            return None;
        }
    }
    Some((quotient, rest))
}

/// The greatest common divisor by Euclid's algorithm, with leading coefficient 1. `None` if numbers
/// grow too large or `work` is used up.
fn gcd(mut a: Coefficients, mut b: Coefficients, work: &mut u64) -> Option<Coefficients> {
    while let Some(last) = b.last() {
        let monic = scaled(&b, &last.recip());
        let (_, rest) = divided(a, &monic, work)?;
        (a, b) = (monic, rest);
    }
    Some(a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display::display;

    /// The text of the squarefree part of a polynomial in x, given by its coefficients.
    fn simple(coefficients: &[i64]) -> Option<String> {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let mut root = graph.integer(0);
        for (n, coefficient) in coefficients.iter().enumerate() {
            let (n, coefficient) = (graph.integer(n as i64), graph.integer(*coefficient));
            let power = graph.apply(Op::Pow, &[x, n]);
            let term = graph.apply(Op::Mul, &[coefficient, power]);
            root = graph.apply(Op::Add, &[root, term]);
        }
        squarefree(&mut graph, root, &mut { WORK_LIMIT }).map(|root| display(&graph, root, &[]))
    }

    #[test]
    fn multiple_roots_become_simple() {
        // The polynomial (x − 1)⁷.
        assert_eq!(simple(&[-1, 7, -21, 35, -35, 21, -7, 1]).as_deref(), Some("x + (-1)"));
        // The polynomial (x² − 2)², whose roots are irrational.
        assert_eq!(simple(&[4, 0, -4, 0, 1]).as_deref(), Some("sqr(x) + (-2)"));
        // The polynomial (x − 1)² (x + 2).
        assert!(simple(&[2, -3, 0, 1]).is_some());
        // The polynomial (x² + 1)² has no real root, and neither has the result.
        assert_eq!(simple(&[1, 0, 2, 0, 1]).as_deref(), Some("sqr(x) + 1"));
    }

    #[test]
    fn what_would_take_too_long_stays_as_typed() {
        let mut graph = Graph::new();
        let (x, one, ten) = (graph.variable(Axis::X), graph.integer(1), graph.integer(10));
        let sum = graph.apply(Op::Add, &[x, one]);
        let root = graph.apply(Op::Pow, &[sum, ten]);
        assert!(squarefree(&mut graph, root, &mut { WORK_LIMIT }).is_some());
        let mut work = 100;
        assert!(squarefree(&mut graph, root, &mut work).is_none() && work < 100);
    }

    #[test]
    fn a_huge_power_of_nothing_is_not_multiplied_out() {
        let mut graph = Graph::new();
        let (x, huge) = (graph.variable(Axis::X), graph.integer(4_000_000_000_000_000_001));
        let nothing = graph.apply(Op::Sub, &[x, x]);
        let power = graph.apply(Op::Pow, &[nothing, huge]);
        let root = graph.apply(Op::Add, &[x, power]);
        assert!(squarefree(&mut graph, root, &mut { WORK_LIMIT }).is_none());
    }

    #[test]
    fn simple_roots_stay_as_typed() {
        assert_eq!(simple(&[-1, 0, 1]), None);
        assert_eq!(simple(&[6, -5, 1]), None);
        assert_eq!(simple(&[0, 1]), None);
        assert_eq!(simple(&[7]), None);
    }
}
