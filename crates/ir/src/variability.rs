//! The inputs that expressions depend on: none, parameters or coordinates.

use crate::graph::{Graph, Node};

/// The inputs that an expression depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Variability {
    /// An expression without inputs.
    Constant,
    /// An expression that depends on parameters only.
    Uniform,
    /// An expression that depends on coordinates, and perhaps on parameters.
    Varying,
}

/// The variability of each node, by index. It is the variability of the expression as written: `x -
/// x` counts as varying.
pub fn variabilities(graph: &Graph) -> Vec<Variability> {
    let mut variabilities: Vec<Variability> = Vec::with_capacity(graph.len());
    for (_, node) in graph.iter() {
        variabilities.push(match node {
            Node::Variable(_) => Variability::Varying,
            Node::Parameter(_) => Variability::Uniform,
            Node::Constant(_) => Variability::Constant,
            Node::Apply(_, operands) => operands
                .iter()
                .fold(Variability::Constant, |rank, id| rank.max(variabilities[id.index()])),
        });
    }
    variabilities
}
