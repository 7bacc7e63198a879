//! Hoisting of expressions that depend on parameters alone, and so have the same value at every
//! point of a picture.
//!
//! This pass finds and replaces such expressions. The caller evaluates them.

use crate::compact::{compact, replaced};
use crate::graph::{Graph, Node, NodeId};
use crate::variability::{Variability, variabilities};

/// A graph in which fresh parameters replace the expressions that depend on parameters alone.
#[derive(Clone, Debug)]
pub struct Hoisted {
    /// The resulting graph. It holds only the nodes that the roots need.
    pub graph: Graph,
    /// The roots in the resulting graph.
    pub roots: Vec<NodeId>,
    /// Each fresh parameter's number, ascending, and the node of the original graph that computes
    /// its value. If that value is undefined, so is everything that uses the parameter.
    pub uniforms: Vec<(u32, NodeId)>,
}

/// Replaces expressions that depend on parameters but on no coordinate by fresh parameters. The
/// expressions can then be evaluated once per picture, not once per sample. Only the largest such
/// expressions are replaced. Bare parameters and constants stay.
///
/// Fresh parameters are numbered from `first`, or from one past the largest number in use,
/// whichever is larger.
///
/// ```
/// use zeroset_ir::{Axis, Graph, hoist};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let (x, w) = (graph.variable(Axis::X), graph.parameter(0));
/// let sin = graph.apply(Op::Sin, &[w]);
/// let root = graph.apply(Op::Mul, &[sin, x]);
/// let hoisted = hoist(&graph, &[root], 1);
/// assert_eq!(hoisted.uniforms, [(1, sin)]);
/// assert_eq!(hoisted.graph.len(), 3);
/// ```
pub fn hoist(graph: &Graph, roots: &[NodeId], first: u32) -> Hoisted {
    let needed = graph.reachable(roots);
    let variabilities = variabilities(graph);
    let mut fresh = first;
    let mut wanted = vec![false; graph.len()];
    for root in roots {
        wanted[root.index()] = true;
    }
    for (id, node) in graph.iter() {
        match node {
            Node::Parameter(number) => fresh = fresh.max(number.saturating_add(1)),
            // An expression is replaced as a whole if a node that depends on coordinates uses it.
            Node::Apply(_, operands)
                if needed[id.index()] && variabilities[id.index()] == Variability::Varying =>
            {
                operands.iter().for_each(|id| wanted[id.index()] = true);
            }
            Node::Variable(_) | Node::Constant(_) | Node::Apply(..) => {}
        }
    }
    let mut uniforms = Vec::new();
    let (copy, roots) = replaced(graph, roots, |copy, id, node| {
        let is_hoisted = matches!(node, Node::Apply(..))
            && variabilities[id.index()] == Variability::Uniform
            && wanted[id.index()];
        is_hoisted.then(|| {
            let number = fresh + uniforms.len() as u32;
            uniforms.push((number, id));
            copy.parameter(number)
        })
    });
    let (graph, roots) = compact(&copy, &roots);
    Hoisted { graph, roots, uniforms }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display;
    use crate::testing::TestGraphBuilder;
    use zeroset_ops::Op;

    #[test]
    fn only_maximal_expressions_of_parameters_are_hoisted() {
        let builder = TestGraphBuilder::default();
        let [x, y, _] = builder.xyz();
        let (a, b) = (builder.parameter(0), builder.parameter(3));
        let shared = a.f(Op::Sin);
        let constant = builder.number("2").f(Op::Sqrt);
        let root = x * shared + y * (shared + b.pow(2)) + constant * a - b * x + x.pow(2);
        let graph = builder.graph();
        let hoisted = hoist(&graph, &[root.id, shared.id, a.id], 2);
        let texts: Vec<(u32, String)> = hoisted
            .uniforms
            .iter()
            .map(|(number, id)| (*number, display(&graph, *id, &["a", "", "", "b"])))
            .collect();
        let expected = [(4, "sin(a)"), (5, "sin(a) + b^2"), (6, "sqrt(2)*a")];
        assert_eq!(texts, expected.map(|(number, text)| (number, text.to_owned())));
        let text = |root: usize| display(&hoisted.graph, hoisted.roots[root], &["a", "", "", "b"]);
        assert_eq!(text(0), "x*p4 + y*p5 + p6 - b*x + x^2");
        assert_eq!((text(1), text(2)), ("p4".into(), "a".into()));
    }
}
