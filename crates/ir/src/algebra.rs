//! Builders of expressions that simplify at once: they drop factors 1 and terms 0, and compute with
//! exact numbers.
//!
//! Derivatives and rational forms use these builders, since they create many trivial terms. A
//! factor 0 removes the other factor, even where the other is undefined. So
//! [`simplify`](crate::simplify()) must not use these builders.

use crate::constant::Constant;
use crate::graph::{Graph, NodeId};
use zeroset_ops::Op;

fn is_integer(graph: &Graph, id: NodeId, value: i64) -> bool {
    graph.number(id).is_some_and(|number| number.as_integer() == Some(value))
}

fn negated(graph: &Graph, id: NodeId) -> Option<NodeId> {
    graph.operands(id, Op::Neg).map(|operands| operands[0])
}

pub(crate) fn is_zero(graph: &Graph, id: NodeId) -> bool {
    is_integer(graph, id, 0)
}

pub(crate) fn is_one(graph: &Graph, id: NodeId) -> bool {
    is_integer(graph, id, 1)
}

pub(crate) fn neg(graph: &mut Graph, a: NodeId) -> NodeId {
    if let Some(value) = graph.exact(a).cloned() {
        return graph.constant(Constant::rational(-value));
    }
    match negated(graph, a) {
        Some(inner) => inner,
        None => graph.apply(Op::Neg, &[a]),
    }
}

pub(crate) fn add(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    sum(graph, Op::Add, a, b)
}

pub(crate) fn sub(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    sum(graph, Op::Sub, a, b)
}

/// Adds the node `a + b`, or `a - b` if `op` is [`Op::Sub`].
pub(crate) fn sum(graph: &mut Graph, op: Op, a: NodeId, b: NodeId) -> NodeId {
    let minus = op == Op::Sub;
    if is_zero(graph, b) {
        return a;
    }
    if is_zero(graph, a) {
        return if minus { neg(graph, b) } else { b };
    }
    if let (Some(p), Some(q)) = (graph.exact(a), graph.exact(b)) {
        let sum = if minus { p - q } else { p + q };
        return graph.constant(Constant::rational(sum));
    }
    match negated(graph, b) {
        Some(inner) => graph.apply(if minus { Op::Add } else { Op::Sub }, &[a, inner]),
        None => graph.apply(op, &[a, b]),
    }
}

pub(crate) fn mul(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    if is_zero(graph, a) || is_one(graph, b) {
        return a;
    }
    if is_zero(graph, b) || is_one(graph, a) {
        return b;
    }
    if is_integer(graph, a, -1) {
        return neg(graph, b);
    }
    if is_integer(graph, b, -1) {
        return neg(graph, a);
    }
    if let (Some(p), Some(q)) = (graph.exact(a), graph.exact(b)) {
        let product = p * q;
        return graph.constant(Constant::rational(product));
    }
    if a == b {
        return graph.apply(Op::Sqr, &[a]);
    }
    graph.apply(Op::Mul, &[a, b])
}

/// Adds the node `a / b`. The quotient is not simplified if `b` is the number 0.
pub(crate) fn div(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    if is_one(graph, b) || (is_zero(graph, a) && !is_zero(graph, b)) {
        return a;
    }
    if let (Some(p), Some(q)) = (graph.exact(a), graph.exact(b))
        && !is_zero(graph, b)
    {
        let quotient = p / q;
        return graph.constant(Constant::rational(quotient));
    }
    graph.apply(Op::Div, &[a, b])
}

pub(crate) fn pow(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    match graph.number(b).and_then(Constant::as_integer) {
        Some(n) => powi(graph, a, n),
        None => graph.apply(Op::Pow, &[a, b]),
    }
}

/// Adds the node `a^exponent`.
pub(crate) fn powi(graph: &mut Graph, a: NodeId, exponent: i64) -> NodeId {
    match exponent {
        0 => graph.integer(1),
        1 => a,
        2 => graph.apply(Op::Sqr, &[a]),
        _ => {
            let exponent = graph.integer(exponent);
            graph.apply(Op::Pow, &[a, exponent])
        }
    }
}
