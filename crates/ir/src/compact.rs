//! Copying the nodes that some roots need into a new graph.

use crate::graph::{Graph, Node, NodeId};
use rustc_hash::FxHashMap;

/// If fewer than one node in this many is copied, copies are found by hashing.
const SPARSE: usize = 64;

/// Returns a graph that holds only the nodes that `roots` need, in the same order, and the ids of
/// the roots in that graph.
///
/// # Panics
/// If a root does not belong to `graph`.
pub fn compact(graph: &Graph, roots: &[NodeId]) -> (Graph, Vec<NodeId>) {
    replaced(graph, roots, |_, _, _| None)
}

/// Like [`compact`], but `replacement` may supply a node of the copy in place of a copied node.
///
/// # Panics
/// If a root does not belong to `graph`.
pub fn replaced(
    graph: &Graph,
    roots: &[NodeId],
    mut replacement: impl FnMut(&mut Graph, NodeId, &Node) -> Option<NodeId>,
) -> (Graph, Vec<NodeId>) {
    let needed = graph.needed(roots);
    let mut copy = Graph::with_capacity(needed.len());
    if needed.len() * SPARSE < graph.len() {
        // Few of the nodes are copied. A table of all nodes would take longer to clear than the
        // copy takes.
        let mut places: FxHashMap<NodeId, NodeId> = FxHashMap::default();
        for id in needed {
            let node = graph.node(id);
            let other = replacement(&mut copy, id, node);
            places.insert(
                id,
                other.unwrap_or_else(|| copy_node(&mut copy, node, |operand| places[&operand])),
            );
        }
        return (copy, roots.iter().map(|root| places[root]).collect());
    }
    let mut places: Vec<Option<NodeId>> = vec![None; graph.len()];
    for id in needed {
        let node = graph.node(id);
        places[id.index()] = Some(match replacement(&mut copy, id, node) {
            Some(other) => other,
            None => copy_node(&mut copy, node, |operand| place(&places, operand)),
        });
    }
    let roots = roots.iter().map(|root| place(&places, *root)).collect();
    (copy, roots)
}

/// Adds a copy of `node` to `graph`. The function `place` returns the id of an operand's copy.
pub(crate) fn copy_node(
    graph: &mut Graph,
    node: &Node,
    place: impl Fn(NodeId) -> NodeId,
) -> NodeId {
    match node {
        Node::Variable(axis) => graph.variable(*axis),
        Node::Parameter(number) => graph.parameter(*number),
        Node::Constant(value) => graph.constant(value.clone()),
        Node::Apply(op, operands) => {
            let mut copies = [operands[0]; 3];
            for (copy, id) in copies.iter_mut().zip(operands.iter()) {
                *copy = place(*id);
            }
            graph.apply(*op, &copies[..operands.len()])
        }
    }
}

/// The id of the copy of node `id` in the new graph. The node must have been copied already.
pub(crate) fn place(places: &[Option<NodeId>], id: NodeId) -> NodeId {
    places[id.index()].expect("operands come before their users")
}
