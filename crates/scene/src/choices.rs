//! The parts of a function that is a choice of minima and maxima.

use crate::kernels::{CodeStore, Evaluator};
use crate::program::{Program, ProgramError};
use crate::simplified::Simplified;
use std::sync::{Arc, OnceLock};
use zeroset_ir::{Graph, Node, NodeId, simplify};
use zeroset_ops::Op;

/// Largest number of parts.
const MOST_PARTS: usize = 128;

/// Minima and maxima of parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The part with this number.
    Part(usize),
    /// The least of some functions, at least two.
    Min(Vec<Choice>),
    /// The greatest of some functions, at least two.
    Max(Vec<Choice>),
}

/// Nodes in place of numbers of parts.
enum Nodes {
    Part(NodeId),
    Min(Vec<Nodes>),
    Max(Vec<Nodes>),
}

impl Nodes {
    /// The same choice of other functions, with the least and the greatest exchanged if `turned`.
    fn map(
        self,
        graph: &mut Graph,
        turned: bool,
        f: &dyn Fn(&mut Graph, NodeId) -> NodeId,
    ) -> Self {
        let mut each = |all: Vec<Self>| all.into_iter().map(|n| n.map(graph, turned, f)).collect();
        match self {
            Self::Min(all) if turned => Self::Max(each(all)),
            Self::Max(all) if turned => Self::Min(each(all)),
            Self::Min(all) => Self::Min(each(all)),
            Self::Max(all) => Self::Max(each(all)),
            Self::Part(node) => Self::Part(f(graph, node)),
        }
    }

    fn is_part(&self) -> bool {
        matches!(self, Self::Part(_))
    }

    fn parts(&self) -> usize {
        match self {
            Self::Part(_) => 1,
            Self::Min(all) | Self::Max(all) => all.iter().map(Self::parts).sum(),
        }
    }

    /// The choice, with its parts numbered and added to `parts`.
    fn numbered(self, parts: &mut Vec<NodeId>) -> Choice {
        let mut each = |all: Vec<Self>, is_min: bool| {
            let mut flat = Vec::new();
            for choice in all.into_iter().map(|choice| choice.numbered(parts)) {
                match choice {
                    Choice::Min(inner) if is_min => flat.extend(inner),
                    Choice::Max(inner) if !is_min => flat.extend(inner),
                    other => flat.push(other),
                }
            }
            flat
        };
        match self {
            Self::Min(all) => Choice::Min(each(all, true)),
            Self::Max(all) => Choice::Max(each(all, false)),
            Self::Part(node) => {
                let number = parts.iter().position(|part| *part == node).unwrap_or_else(|| {
                    parts.push(node);
                    parts.len() - 1
                });
                Choice::Part(number)
            }
        }
    }
}

/// For each node, whether it is a choice: a minimum, maximum or absolute value, or a sum with one.
fn choices(graph: &Graph) -> Vec<bool> {
    let mut found = vec![false; graph.len()];
    for (id, node) in graph.iter() {
        if let Node::Apply(op, operands) = node {
            found[id.index()] = match op {
                Op::Min | Op::Max | Op::Abs => true,
                Op::Neg | Op::Add | Op::Sub => operands.iter().any(|one| found[one.index()]),
                _ => false,
            };
        }
    }
    found
}

/// The choice that a node is. Sums with a choice are choices of sums. At most `left` choices are
/// taken apart, since a node that is shared is taken apart each time.
fn nodes(graph: &mut Graph, is_choice: &[bool], node: NodeId, left: &mut usize) -> Nodes {
    let Node::Apply(op, operands) = graph.node(node).clone() else { return Nodes::Part(node) };
    if *left == 0 || !is_choice[node.index()] {
        return Nodes::Part(node);
    }
    *left -= 1;
    let operands: Vec<NodeId> = operands.to_vec();
    let mut inner = |graph: &mut Graph, k: usize| nodes(graph, is_choice, operands[k], left);
    let negated = |graph: &mut Graph, node: NodeId| graph.apply(Op::Neg, &[node]);
    match op {
        Op::Min => Nodes::Min((0..operands.len()).map(|k| inner(graph, k)).collect()),
        Op::Max => Nodes::Max((0..operands.len()).map(|k| inner(graph, k)).collect()),
        Op::Abs => {
            let part = operands[0];
            Nodes::Max(vec![Nodes::Part(part), Nodes::Part(negated(graph, part))])
        }
        Op::Neg => inner(graph, 0).map(graph, true, &negated),
        Op::Add | Op::Sub => {
            let (left, right) = (inner(graph, 0), inner(graph, 1));
            let (one, other) = (operands[0], operands[1]);
            match (left.is_part(), right.is_part()) {
                (false, true) => {
                    left.map(graph, false, &|graph, part| graph.apply(op, &[part, other]))
                }
                (true, false) => {
                    right.map(graph, op == Op::Sub, &|graph, part| graph.apply(op, &[one, part]))
                }
                _ => Nodes::Part(node),
            }
        }
        _ => Nodes::Part(node),
    }
}

impl Program {
    /// A surface's function as minima and maxima of parts, and a program whose surfaces are the
    /// parts. A function without minima and maxima, or with too many parts, is one part.
    ///
    /// # Errors
    /// If a part is too large.
    ///
    /// # Panics
    /// If there is no such surface.
    pub fn choices(&self, surface: usize) -> Result<(Choice, Self), ProgramError> {
        let whole = self.simplified();
        let (mut graph, root) = whole.symbolic(surface);
        let is_choice = choices(&graph);
        let mut choice = nodes(&mut graph, &is_choice, root, &mut { MOST_PARTS });
        if choice.parts() > MOST_PARTS {
            choice = Nodes::Part(root);
        }
        let mut parts = Vec::new();
        let choice = choice.numbered(&mut parts);
        let assumptions = whole.assumptions.clone();
        let (simple, roots) =
            simplify(&graph, &parts, &assumptions.domain, &assumptions.parameters)?;
        let count = parts.len();
        let simplified = Simplified {
            graph: simple,
            roots,
            symbolic: (graph, parts),
            typed: whole.typed.clone(),
            assumptions,
            nodes_before: whole.nodes_before,
            solid: vec![whole.solid[surface]; count],
            holds_zeros: vec![whole.holds_zeros[surface]; count],
            reduced: vec![false; count],
            filled: vec![false; count],
            cleared: (0..count).map(|_| OnceLock::new()).collect(),
        };
        let store = CodeStore::new(Arc::new(simplified), Evaluator::Native);
        Ok((choice, Self::of(Arc::new(store), self.values().to_vec())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_interval::Interval;
    use zeroset_syntax::{Options, read};

    #[test]
    fn choices_are_found_below_signs_and_sums() {
        use Choice::{Max, Min, Part};
        for (text, expected, parts) in [
            ("x^2+y^2 <= 1", Part(0), 1),
            ("max(x, y) = 1", Max(vec![Part(0), Part(1)]), 2),
            ("max(abs(x), abs(y), abs(z)) = 1", Max((0..6).map(Part).collect()), 6),
            ("1 - max(x, y) = z", Min(vec![Part(0), Part(1)]), 2),
            ("max(x, -min(y, z)) = 0", Max(vec![Part(0), Part(1), Part(2)]), 3),
        ] {
            let document = read(text, &Options::default()).expect(text);
            let domain = [Interval { lo: -2.0, hi: 2.0 }; 3];
            let program = Program::new(&document, domain).expect(text);
            let (choice, found) = program.choices(0).expect(text);
            assert_eq!((choice, found.roots().len()), (expected, parts), "{text}");
        }
    }

    /// A choice that is shared is taken apart each time that it occurs: here 2⁶⁰ times, were there
    /// no limit.
    #[test]
    fn shared_choices_are_taken_apart_within_a_limit() {
        let line = |k: usize| format!("a{k} = max(a{}, z - a{})\n", k - 1, k - 1);
        let lines: String = (1..=60).map(line).collect();
        let text = format!("a0 = max(x, y)\n{lines}0 = a60");
        let document = read(&text, &Options::default()).expect("reads");
        let program = Program::new(&document, [Interval { lo: -2.0, hi: 2.0 }; 3]).expect("small");
        let (choice, found) = program.choices(0).expect("small");
        assert!(matches!(choice, Choice::Min(_) | Choice::Max(_)));
        assert!((2..=MOST_PARTS).contains(&found.roots().len()));
    }
}
