//! Replacement of parameters in exponents by their values.
//!
//! The domain of definition of a power depends on whether its exponent is an integer. So the exact
//! value of a parameter in an exponent decides which function is meant. Changing such a value
//! requires compiling again.

use crate::compact::{compact, copy_node, place};
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use crate::variability::{Variability, variabilities};
use zeroset_ops::Class;

/// Replaces the parameters in each exponent that depends on no coordinate. Parameter n becomes
/// `values[n]`. Returns the resulting graph and its roots. The values of other parameters have no
/// effect, not even on the order of nodes.
///
/// # Panics
/// If a root does not belong to `graph`, or a parameter to be replaced has no value.
pub fn fix_exponents(graph: &Graph, roots: &[NodeId], values: &[Constant]) -> (Graph, Vec<NodeId>) {
    let variabilities = variabilities(graph);
    let is_uniform = |id: NodeId| variabilities[id.index()] != Variability::Varying;
    let exponents: Vec<NodeId> = graph
        .iter()
        .filter_map(|(_, node)| match node {
            Node::Apply(op, operands) if op.row().class == Class::Power => Some(operands[1]),
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => None,
        })
        .filter(|exponent| is_uniform(*exponent))
        .collect();
    let in_exponent = graph.reachable(&exponents);
    let mut fixed = Graph::new();
    // `places` has a copy of each node, in which only exponents have their parameters replaced.
    // `replaced` has a second copy of each node in an exponent, with all parameters replaced.
    let mut places: Vec<Option<NodeId>> = Vec::with_capacity(graph.len());
    let mut replaced: Vec<Option<NodeId>> = Vec::with_capacity(graph.len());
    for (id, node) in graph.iter() {
        let copy = match node {
            Node::Apply(op, operands)
                if op.row().class == Class::Power && is_uniform(operands[1]) =>
            {
                let base = place(&places, operands[0]);
                let exponent = place(&replaced, operands[1]);
                fixed.apply(*op, &[base, exponent])
            }
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => {
                copy_node(&mut fixed, node, |operand| place(&places, operand))
            }
        };
        places.push(Some(copy));
        replaced.push(in_exponent[id.index()].then(|| match node {
            Node::Parameter(number) => fixed.constant(values[*number as usize].clone()),
            Node::Variable(_) | Node::Constant(_) | Node::Apply(..) => {
                copy_node(&mut fixed, node, |operand| place(&replaced, operand))
            }
        }));
    }
    let roots: Vec<NodeId> = roots.iter().map(|root| place(&places, *root)).collect();
    compact(&fixed, &roots)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Axis;
    use zeroset_ops::Op;

    #[test]
    fn only_exponents_lose_their_parameters() {
        let mut graph = Graph::new();
        let (x, n) = (graph.variable(Axis::X), graph.parameter(0));
        let two = graph.integer(2);
        let exponent = graph.apply(Op::Mul, &[two, n]);
        let power = graph.apply(Op::Pow, &[x, exponent]);
        let root = graph.apply(Op::Sub, &[power, n]);
        let (fixed, roots) = fix_exponents(&graph, &[root], &[Constant::integer(3)]);

        let mut expected = Graph::new();
        let (x, n) = (expected.variable(Axis::X), expected.parameter(0));
        let (two, three) = (expected.integer(2), expected.integer(3));
        let exponent = expected.apply(Op::Mul, &[two, three]);
        let power = expected.apply(Op::Pow, &[x, exponent]);
        let wanted = expected.apply(Op::Sub, &[power, n]);
        let names = ["n"];
        let text = crate::display(&fixed, roots[0], &names);
        assert_eq!(text, crate::display(&expected, wanted, &names));
        assert!(text.ends_with("- n"), "{text}");
    }

    #[test]
    fn values_elsewhere_leave_no_trace() {
        let mut graph = Graph::new();
        let (n, x) = (graph.parameter(0), graph.variable(Axis::X));
        let two = graph.integer(2);
        let power = graph.apply(Op::Pow, &[x, two]);
        let root = graph.apply(Op::Sub, &[power, n]);
        let fixed = |value: i64| fix_exponents(&graph, &[root], &[Constant::integer(value)]);
        assert_eq!(fixed(2), fixed(3));
    }

    #[test]
    fn exponents_that_vary_keep_theirs() {
        let mut graph = Graph::new();
        let (x, n) = (graph.variable(Axis::X), graph.parameter(0));
        let exponent = graph.apply(Op::Mul, &[x, n]);
        let root = graph.apply(Op::Pow, &[x, exponent]);
        let (fixed, roots) = fix_exponents(&graph, &[root], &[Constant::integer(3)]);
        assert_eq!(crate::display(&fixed, roots[0], &["n"]), crate::display(&graph, root, &["n"]));
    }
}
