//! Enclosure of constant expressions.

use crate::compact::{compact, replaced};
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use zeroset_interval::{Decorated, Facts};

/// Replaces each constant expression by its enclosure, if the expression is defined and bounded.
pub(super) fn fold(graph: &Graph, roots: &[NodeId]) -> (Graph, Vec<NodeId>) {
    let mut values: Vec<Option<Decorated>> = vec![None; graph.len()];
    let (folded, roots) = replaced(graph, roots, |folded, id, node| {
        let value = match node {
            Node::Variable(_) | Node::Parameter(_) => None,
            Node::Constant(constant) => Some(constant.value()),
            Node::Apply(op, operands) => operands
                .iter()
                .map(|operand| values[operand.index()])
                .collect::<Option<Vec<_>>>()
                .map(|operands| zeroset_interval::fold(*op, &operands).into()),
        };
        values[id.index()] = value;
        let Decorated { bounds, facts, .. } = value.filter(|_| matches!(node, Node::Apply(..)))?;
        (facts.has(Facts::DEFINED) && bounds.is_bounded())
            .then(|| folded.constant(Constant::enclosed(bounds)))
    });
    compact(&folded, &roots)
}
