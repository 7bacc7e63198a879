//! Bounds and facts of expressions over a whole domain, from one pass over their graph.

use crate::tape::Assumptions;
use zeroset_interval::{Decorated, Facts, Interval, fold};
use zeroset_ir::{Graph, Node, NodeId};

/// The bounds and facts of `root`, for all points and parameters within `assumptions`.
///
/// # Panics
/// If `assumptions` has no bounds for a parameter that `root` uses.
pub fn enclose(graph: &Graph, root: NodeId, assumptions: &Assumptions) -> (Interval, Facts) {
    enclose_all(graph, &[root], assumptions)[0]
}

/// The bounds and facts of each root, as [`enclose`] returns them, from one pass over the graph.
///
/// # Panics
/// If `assumptions` has no bounds for a parameter that a root uses.
pub fn enclose_all(
    graph: &Graph,
    roots: &[NodeId],
    assumptions: &Assumptions,
) -> Vec<(Interval, Facts)> {
    let needed = graph.reachable(roots);
    let mut known = vec![Decorated::from((Interval::ENTIRE, Facts::NONE)); graph.len()];
    for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        known[id.index()] = match node {
            Node::Variable(axis) => (assumptions.domain[*axis as usize], Facts::TOTAL).into(),
            Node::Parameter(number) => {
                (assumptions.parameters[*number as usize], Facts::TOTAL).into()
            }
            Node::Constant(value) => value.value(),
            Node::Apply(op, operands) => {
                let operands: Vec<_> = operands.iter().map(|id| known[id.index()]).collect();
                fold(*op, &operands).into()
            }
        };
    }
    let found = |root: &NodeId| (known[root.index()].bounds, known[root.index()].facts);
    roots.iter().map(found).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    fn of(formula: &str) -> (Interval, Facts) {
        let document = read(formula, &Options::default()).expect("reads");
        let assumptions = Assumptions::none(document.parameters.len());
        enclose(&document.graph, document.surfaces[0].root, &assumptions)
    }

    #[test]
    fn bounds_and_facts_follow_the_graph() {
        assert_eq!(of("x^2+1").0.lo, 1.0);
        assert!(of("sqrt(-1-x^2)").1.has(Facts::NOWHERE));
        assert!(!of("sqrt(1-x^2)").1.has(Facts::NOWHERE));
    }
}
