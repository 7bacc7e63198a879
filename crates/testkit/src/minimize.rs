//! Shrinking of a case to a smaller one that fails in the same way.

use crate::case::Case;
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId, compact};

/// Returns a case no larger than `case` for which `fails` still holds. Cuts out one part of the
/// function after another while `fails` holds. Then drops each bound of the domain without which
/// `fails` still holds.
///
/// For n nodes, `fails` is called O(n²) times.
pub fn minimise(case: &Case, fails: &mut dyn FnMut(&Case) -> bool) -> Case {
    let mut best = case.clone();
    while let Some(smaller) = smaller(&best).into_iter().find(|candidate| fails(candidate)) {
        best = smaller;
    }
    for axis in 0..3 {
        let mut wider = best.clone();
        wider.assumptions.domain[axis] = Interval::ENTIRE;
        if fails(&wider) {
            best = wider;
        }
    }
    best
}

/// Returns every smaller case that results from cutting out one part.
fn smaller(case: &Case) -> Vec<Case> {
    let needed = case.graph.reachable(&[case.root]);
    let nodes = || case.graph.iter().filter(|(id, _)| needed[id.index()]);
    let mut found: Vec<Case> = nodes()
        .filter(|(id, _)| *id != case.root)
        .map(|(id, _)| case.with(&case.graph, id))
        .collect();
    for (id, node) in nodes() {
        let Node::Apply(_, operands) = node else { continue };
        found.extend(operands.iter().map(|operand| case.replaced(id, Replacement::Node(*operand))));
        found.push(case.replaced(id, Replacement::Variable));
        found.push(case.replaced(id, Replacement::One));
    }
    let size = case.size();
    found.retain(|candidate| candidate.size() < size);
    found
}

/// A replacement for a part that is cut out.
#[derive(Clone, Copy)]
enum Replacement {
    Node(NodeId),
    Variable,
    One,
}

impl Case {
    /// Returns the same case with another function.
    fn with(&self, graph: &Graph, root: NodeId) -> Self {
        let (graph, roots) = compact(graph, &[root]);
        Self { graph, root: roots[0], ..self.clone() }
    }

    fn replaced(&self, at: NodeId, part: Replacement) -> Self {
        let mut graph = Graph::new();
        let mut copies: Vec<NodeId> = Vec::with_capacity(self.graph.len());
        for (id, node) in self.graph.iter() {
            let copy = match (node, part) {
                (_, Replacement::Node(other)) if id == at => copies[other.index()],
                (_, Replacement::Variable) if id == at => graph.variable(Axis::X),
                (_, Replacement::One) if id == at => graph.constant(Constant::integer(1)),
                (Node::Variable(axis), _) => graph.variable(*axis),
                (Node::Parameter(number), _) => graph.parameter(*number),
                (Node::Constant(value), _) => graph.constant(value.clone()),
                (Node::Apply(op, operands), _) => {
                    let operands: Vec<_> = operands.iter().map(|id| copies[id.index()]).collect();
                    graph.apply(*op, &operands)
                }
            };
            copies.push(copy);
        }
        self.with(&graph, copies[self.root.index()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GraphOptions, Rng};
    use zeroset_ops::Op;

    #[test]
    fn what_does_not_matter_is_cut_out() {
        let seed = 0x5eed_0090;
        println!("seed {seed:#x}");
        let mut rng = Rng::with_seed(seed);
        let options = GraphOptions { size: 30, ..GraphOptions::default() };
        let holds = |case: &Case| {
            case.graph.iter().any(|(_, node)| matches!(node, Node::Apply(Op::Atan, _)))
        };
        let mut met = 0;
        while met < 20 {
            let case = Case::random(&mut rng, &options);
            let case = case.with(&case.graph, case.root);
            if holds(&case) {
                met += 1;
                let least = minimise(&case, &mut |case| holds(case));
                assert_eq!(least.size(), 2);
                assert_eq!(least.assumptions.domain, [Interval::ENTIRE; 3]);
            }
        }
    }
}
