//! Differences f(u) − f(w) of a function, as products of u − w and a function without a pole.
//!
//! For (eˣ − eʸ)/(x − y), x − y is 0 where x is y. With w = y in place of u = x,
//! eᵘ = eʷ + (u − w)·Q. By the remainder theorem, u − w has the factor x − y.
//!
//! The functions Q follow from addition theorems, and from the extensions S of the table.

use crate::algebra::{add, div, mul, neg};
use crate::compact::compact;
use crate::graph::{Graph, Node, NodeId};
use crate::polynomial::{Polynomial, Work};
use crate::simplify::rewrite;
use num_rational::BigRational;
use num_traits::Signed;
use zeroset_interval::Interval;
use zeroset_ops::{Domain, Op};

/// A node f(u) that is `value` + `divisor`·Q. The function Q depends on `parts`: u, w and u − w.
pub(crate) struct Shift {
    pub node: NodeId,
    pub op: Op,
    pub value: Polynomial,
    pub divisor: Polynomial,
    pub parts: [NodeId; 3],
}

/// The variables in which a polynomial is linear. Each comes with the value at which the polynomial
/// is 0.
pub(crate) fn linear_roots(polynomial: &Polynomial, work: &mut Work) -> Vec<(NodeId, Polynomial)> {
    let root = |variable: NodeId| {
        let factor = polynomial.linear_factor(variable)?;
        let term =
            Polynomial::variable(variable).times(&Polynomial::constant(factor.clone()), work);
        let rest = term?.minus(polynomial);
        Some((variable, rest.times(&Polynomial::constant(factor.recip()), work)?))
    };
    polynomial.variables().into_iter().filter_map(root).collect()
}

/// Prepares a rewriting of node f(u), where w is u with `at` in place of the variable. `None` if f
/// has no addition theorem, if u does not depend on the variable, or if f(w) may be undefined where
/// f(u) is defined.
pub(crate) fn shift(
    graph: &mut Graph,
    node: NodeId,
    (variable, at): &(NodeId, Polynomial),
    known: &[NodeId],
    work: &mut Work,
) -> Option<Shift> {
    let Node::Apply(op, operands) = *graph.node(node) else { return None };
    let place = match op {
        Op::Exp | Op::Sin | Op::Cos | Op::Sinh | Op::Cosh | Op::Sqrt | Op::Cbrt | Op::Ln => 0,
        Op::Pow if graph.exact(operands[0]).is_some_and(Signed::is_positive) => 1,
        _ => return None,
    };
    let u = Polynomial::of(graph, operands[place], work);
    let w = u.substituted(*variable, at, work)?;
    let divisor = u.minus(&w);
    if divisor.is_zero() {
        return None;
    }
    let w_node = w.emit(graph);
    let mut shifted = operands.to_vec();
    shifted[place] = w_node;
    let value_node = graph.apply(op, &shifted);
    let value = match exact(graph, value_node, &w) {
        Some(value) => Polynomial::constant(value),
        None if known.contains(&value_node) || op.row().domain == Domain::All => {
            Polynomial::variable(value_node)
        }
        None => return None,
    };
    let difference = divisor.emit(graph);
    Some(Shift { node, op, value, divisor, parts: [operands[place], w_node, difference] })
}

/// The value of a constant node, if it is known to be rational.
fn exact(graph: &Graph, node: NodeId, operand: &Polynomial) -> Option<BigRational> {
    if !operand.variables().iter().all(|id| graph.number(*id).is_some()) {
        return None;
    }
    let (small, roots) = compact(graph, &[node]);
    let (small, roots) = rewrite(&small, &roots, &[Interval::ENTIRE; 3], &[]).ok()?;
    small.exact(roots[0]).cloned()
}

impl Shift {
    /// Returns whether Q may be undefined where u = w, although f(u) and f(w) are not.
    pub fn has_gap(&self) -> bool {
        let is_root = self.op == Op::Sqrt || self.op == Op::Cbrt;
        is_root && self.value.as_constant().is_none_or(|value| !value.is_positive())
    }
}

/// Adds Q(u, w) = (f(u) − f(w))/(u − w). `extension` adds the function S of an operation. Its
/// operands are the operation's operand, and that operand minus 0, or minus 1 for the logarithm.
pub(crate) fn difference_quotient(
    graph: &mut Graph,
    shift: &Shift,
    mut extension: impl FnMut(&mut Graph, Op, [NodeId; 2]) -> NodeId,
) -> NodeId {
    let Shift { node, op, parts: [u, w, difference], .. } = shift;
    let two = graph.integer(2);
    let sum = add(graph, *u, *w);
    let (middle, half) = (div(graph, sum, two), div(graph, *difference, two));
    let mut at_middle = |graph: &mut Graph, of_half: Op, of_middle: Op| {
        let half = extension(graph, of_half, [half, half]);
        let middle = graph.apply(of_middle, &[middle]);
        mul(graph, half, middle)
    };
    match op {
        Op::Sin => at_middle(graph, Op::Sin, Op::Cos),
        Op::Cos => {
            let product = at_middle(graph, Op::Sin, Op::Sin);
            neg(graph, product)
        }
        Op::Sinh => at_middle(graph, Op::Sinh, Op::Cosh),
        Op::Cosh => at_middle(graph, Op::Sinh, Op::Sinh),
        // eᵘ − eʷ = 2 e^((u+w)/2) sinh((u−w)/2)
        Op::Exp => at_middle(graph, Op::Sinh, Op::Exp),
        Op::Pow => {
            // aᵘ − aʷ = aʷ·(exp((u − w) ln a) − 1)
            let base = match graph.node(*node) {
                Node::Apply(_, operands) => operands[0],
                _ => *node,
            };
            let power = graph.apply(Op::Pow, &[base, *w]);
            let ln = graph.apply(Op::Ln, &[base]);
            let exponent = mul(graph, *difference, ln);
            let secant = extension(graph, Op::Exp, [exponent, exponent]);
            let factor = mul(graph, power, ln);
            mul(graph, factor, secant)
        }
        Op::Ln => {
            // ln u − ln w = ln(u/w), and u/w − 1 = (u − w)/w
            let ratio = div(graph, *u, *w);
            let above_one = div(graph, *difference, *w);
            let secant = extension(graph, Op::Ln, [ratio, above_one]);
            let quotient = div(graph, secant, *w);
            // The ratio of two negative numbers has a logarithm, too. If w and u/w are positive,
            // then so is u.
            let value = graph.apply(Op::Ln, &[*w]);
            graph.apply(Op::WhereDefined, &[quotient, value])
        }
        Op::Cbrt => {
            let [a, b] = [*u, *w].map(|id| graph.apply(Op::Cbrt, &[id]));
            let squares = [a, b].map(|id| graph.apply(Op::Sqr, &[id]));
            let (product, sum) = (mul(graph, a, b), add(graph, squares[0], squares[1]));
            let sum = add(graph, sum, product);
            let one = graph.integer(1);
            div(graph, one, sum)
        }
        _ => {
            let [a, b] = [*u, *w].map(|id| graph.apply(Op::Sqrt, &[id]));
            let (one, sum) = (graph.integer(1), add(graph, a, b));
            div(graph, one, sum)
        }
    }
}
