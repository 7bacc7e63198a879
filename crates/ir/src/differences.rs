//! Differences f(u) − f(w) of a function, as products of u − w and a function without a pole.
//!
//! For (eˣ − eʸ)/(x − y), x − y is 0 where x is y. With w = y in place of u = x,
//! eᵘ = eʷ + (u − w)·Q. By the remainder theorem, u − w has the factor x − y.
//!
//! The functions Q follow from addition theorems, and from the extensions S of the table.

use crate::algebra::{add, div, mul, neg, sub};
use crate::compact::compact;
use crate::graph::{Graph, Node, NodeId, Operands};
use crate::polynomial::{Polynomial, Work};
use crate::regular::Nonneg;
use crate::roots::Root;
use crate::simplify::rewrite;
use num_rational::BigRational;
use num_traits::{One, Signed};
use std::collections::BTreeSet;
use zeroset_interval::Interval;
use zeroset_ops::{Domain, Op, Parity};

/// Functions of one operand whose differences are known.
#[rustfmt::skip]
const WITH_DIFFERENCES: [Op; 12] = [
    Op::Exp, Op::Ln, Op::Sqrt, Op::Cbrt, Op::Sin, Op::Cos, Op::Atan, Op::Sinh, Op::Cosh, Op::Tanh,
    Op::Asinh, Op::Atanh,
];

/// A node f(u) that is `value` + `divisor`·Q. The function Q depends on `parts`: u, w and u − w.
pub(crate) struct Shift {
    pub node: NodeId,
    pub op: Op,
    pub value: Polynomial,
    pub divisor: Polynomial,
    pub parts: [NodeId; 3],
    /// Whether Q may be undefined where u = w, although f(u) and f(w) are not.
    pub has_gap: bool,
}

/// Prepares a rewriting of node f(u), where w is u at the root. `None` if f has no addition
/// theorem, if u does not depend on the variable, or if f(w) may be undefined where f(u) is
/// defined.
pub(crate) fn shift(
    graph: &mut Graph,
    node: NodeId,
    root: &Root,
    known: &BTreeSet<NodeId>,
    work: &mut Work,
) -> Option<Shift> {
    let (op, operands, place) = function(graph, node)?;
    let u = Polynomial::of(graph, operands[place], work);
    let w = at_root(graph, &u, root, known, work)?;
    let divisor = u.clone().minus(&w);
    if divisor.is_zero() {
        return None;
    }
    let value = applied(graph, node, &w, known, work)?;
    let parts = [operands[place], w.emit(graph), divisor.emit(graph)];
    let has_gap = has_gap(graph, op, [&u, &w]);
    Some(Shift { node, op, value, divisor, parts, has_gap })
}

/// The operation and operands of node f(u) if f has an addition theorem, and the place of u.
fn function(graph: &Graph, node: NodeId) -> Option<(Op, Operands, usize)> {
    let Node::Apply(op, operands) = *graph.node(node) else { return None };
    let place = match op {
        _ if WITH_DIFFERENCES.contains(&op) => 0,
        Op::Pow if graph.exact(operands[0]).is_some_and(Signed::is_positive) => 1,
        _ => return None,
    };
    Some((op, operands, place))
}

/// A polynomial with the root's value in place of its variable, also within functions.
fn at_root(
    graph: &mut Graph,
    polynomial: &Polynomial,
    root: &Root,
    known: &BTreeSet<NodeId>,
    work: &mut Work,
) -> Option<Polynomial> {
    let (variable, value) = root;
    let mut result = polynomial.substituted(*variable, value, work)?;
    for node in polynomial.variables() {
        let Some((_, operands, place)) = function(graph, node) else { continue };
        let inner = Polynomial::of(graph, operands[place], work);
        let inner_at_root = at_root(graph, &inner, root, known, work)?;
        if inner_at_root != inner {
            let value = applied(graph, node, &inner_at_root, known, work)?;
            result = result.substituted(node, &value, work)?;
        }
    }
    Some(result)
}

/// The function of `node` with operand w. `None` if its value may be undefined where that of `node`
/// is defined.
fn applied(
    graph: &mut Graph,
    node: NodeId,
    w: &Polynomial,
    known: &BTreeSet<NodeId>,
    work: &mut Work,
) -> Option<Polynomial> {
    let (op, operands, place) = function(graph, node)?;
    // Equal sums may be different nodes, and cos(−w) is cos(w).
    for other in known {
        let Some((other_op, others, _)) = function(graph, *other) else { continue };
        if other_op != op || (place == 1 && others[0] != operands[0]) {
            continue;
        }
        let operand = Polynomial::of(graph, others[place], work);
        let minus_one = -BigRational::one();
        let factor = match op.row().parity {
            _ if operand == *w => BigRational::one(),
            Parity::Even if operand.scaled(&minus_one) == *w => BigRational::one(),
            Parity::Odd if operand.scaled(&minus_one) == *w => minus_one,
            Parity::Even | Parity::Odd | Parity::Neither => continue,
        };
        return Some(Polynomial::variable(*other).scaled(&factor));
    }
    let mut operands = operands.to_vec();
    operands[place] = w.emit(graph);
    let value = graph.apply(op, &operands);
    match exact(graph, value, w) {
        Some(value) => Some(Polynomial::constant(value)),
        None => (op.row().domain == Domain::All).then(|| Polynomial::variable(value)),
    }
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

/// Whether Q may be undefined where u = w, although f(u) and f(w) are not.
fn has_gap(graph: &mut Graph, op: Op, operands: [&Polynomial; 2]) -> bool {
    match op {
        // Q is undefined where both roots are 0.
        Op::Sqrt | Op::Cbrt => !operands.into_iter().any(|operand| is_positive(graph, operand)),
        _ => false,
    }
}

/// Whether a polynomial is a number above 0, or the sum of one and of terms that are never below 0.
fn is_positive(graph: &mut Graph, polynomial: &Polynomial) -> bool {
    let least = polynomial.constant_term();
    let rest = polynomial.clone().minus(&Polynomial::constant(least.clone()));
    let rest = rest.emit(graph);
    least.is_positive() && Nonneg::default().holds(graph, rest)
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
        Op::Tanh => {
            let secant = extension(graph, Op::Sinh, [*difference; 2]);
            let [a, b] = [*u, *w].map(|id| graph.apply(Op::Cosh, &[id]));
            let below = mul(graph, a, b);
            div(graph, secant, below)
        }
        Op::Atan | Op::Asinh | Op::Atanh => inverse_quotient(graph, shift, extension),
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

/// Adds the Q of an inverse function. Let α and β be the function's values at u and w.
///
/// - tan((α − β)/2) = sin(α − β)/(1 + cos(α − β)) = (u − w)/(ab + 1 + uw) for atan.
/// - sinh(α − β) = u√(1 + w²) − w√(1 + u²) = (u − w)·(1 − uw + ab)/(a + b) for asinh, where a and b
///   are the roots. The numerator is at least 1, since ab ≥ |uw|.
/// - tanh(α − β) = (u − w)/(1 − uw) for atanh.
///
/// Half the difference of two angles is within ±π/2, so atan gives it back.
fn inverse_quotient(
    graph: &mut Graph,
    shift: &Shift,
    mut extension: impl FnMut(&mut Graph, Op, [NodeId; 2]) -> NodeId,
) -> NodeId {
    let Shift { op, parts: [u, w, difference], .. } = shift;
    let [one, two] = [1, 2].map(|n| graph.integer(n));
    let product = mul(graph, *u, *w);
    let root = |graph: &mut Graph, id: NodeId| {
        let square = mul(graph, id, id);
        let sum = add(graph, one, square);
        graph.apply(Op::Sqrt, &[sum])
    };
    let (a, b) = (root(graph, *u), root(graph, *w));
    let sum = add(graph, a, b);
    // The quotient of the tangent, or of the hyperbolic function, by u − w.
    let (inverse, slope) = match op {
        Op::Asinh => {
            let above = mul(graph, a, b);
            let above = add(graph, above, one);
            let above = sub(graph, above, product);
            (Op::Asinh, div(graph, above, sum))
        }
        Op::Atanh => {
            let below = sub(graph, one, product);
            (Op::Atanh, div(graph, one, below))
        }
        _ => {
            let below = mul(graph, a, b);
            let below = add(graph, below, one);
            let below = add(graph, below, product);
            (Op::Atan, div(graph, one, below))
        }
    };
    let operand = mul(graph, slope, *difference);
    let secant = extension(graph, inverse, [operand; 2]);
    let quotient = mul(graph, secant, slope);
    if *op == Op::Atan { mul(graph, two, quotient) } else { quotient }
}
