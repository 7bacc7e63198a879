//! Enclosing what is constant.

use crate::compact::{compact, copy_node, place};
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use zeroset_interval::{Decorated, Facts};

/// Replaces each expression of constants, where it is defined and bounded, by its enclosure.
pub(super) fn fold(graph: &Graph, roots: &[NodeId]) -> (Graph, Vec<NodeId>) {
    let mut folded = Graph::new();
    let mut places = vec![None; graph.len()];
    let mut values: Vec<Option<Decorated>> = vec![None; graph.len()];
    for (id, node) in graph.iter() {
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
        let constant = match (node, value) {
            (Node::Apply(..), Some(Decorated { bounds, facts, .. })) => (facts.has(Facts::DEFINED)
                && bounds.is_bounded())
            .then(|| folded.constant(Constant::enclosed(bounds))),
            (Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) | Node::Apply(..), _) => {
                None
            }
        };
        places[id.index()] = Some(match constant {
            Some(constant) => constant,
            None => copy_node(&mut folded, node, |operand| place(&places, operand)),
        });
    }
    let roots: Vec<NodeId> = roots.iter().map(|root| place(&places, *root)).collect();
    compact(&folded, &roots)
}
