//! What expressions vary with.

use crate::graph::{Graph, Node};

/// What an expression varies with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variability {
    /// Nothing.
    Constant,
    /// Parameters only.
    Uniform,
    /// Coordinates.
    Varying,
}

/// What each node, by index, varies with as it is written.
pub fn ranks(graph: &Graph) -> Vec<Variability> {
    let mut ranks: Vec<Variability> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        ranks.push(match node {
            Node::Variable(_) => Variability::Varying,
            Node::Parameter(_) => Variability::Uniform,
            Node::Constant(_) => Variability::Constant,
            Node::Apply(_, operands) => {
                operands.iter().fold(Variability::Constant, |rank, id| rank.max(ranks[id.index()]))
            }
        });
    }
    ranks
}
