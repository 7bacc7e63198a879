//! What expressions vary with.

use crate::graph::{Graph, Node};

/// What an expression varies with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// Nothing.
    Constant,
    /// Parameters only.
    Uniform,
    /// Coordinates.
    Varying,
}

/// What each node, by index, varies with as it is written.
pub fn ranks(graph: &Graph) -> Vec<Rank> {
    let mut ranks: Vec<Rank> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        ranks.push(match node {
            Node::Variable(_) => Rank::Varying,
            Node::Parameter(_) => Rank::Uniform,
            Node::Constant(_) => Rank::Constant,
            Node::Apply(_, operands) => {
                operands.iter().fold(Rank::Constant, |rank, id| rank.max(ranks[id.index()]))
            }
        });
    }
    ranks
}
