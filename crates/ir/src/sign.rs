//! Replacement of a function by one that has the same sign, and that is narrower to enclose.
//!
//! The exact distance to a corner is min(m, 0) + √(max(u, 0)² + max(v, 0)²), where m = max(u, v).
//! Its sign is that of m: both are m where m ≤ 0, and above 0 elsewhere. Enclosures of m are
//! narrow. Those of the distance are not, since the root bends without bound near 0: tracing a box
//! takes 30 times as long.

use crate::graph::{Graph, Node, NodeId};
use zeroset_ops::Op;

/// Largest number of faces that meet in a corner.
const MOST_FACES: usize = 8;

/// Operations whose sign depends only on the signs of all operands.
const BY_SIGNS: [Op; 6] = [Op::Neg, Op::Abs, Op::Min, Op::Max, Op::SelectNegative, Op::Otherwise];

/// Operations with the sign of their first operand. The others decide where a value exists.
const WHERE: [Op; 4] = [Op::WhereNonneg, Op::WherePositive, Op::WhereNonzero, Op::WhereDefined];

/// Returns a function that has the sign and the domain of definition of `root`. Distances to
/// corners become maxima where only their sign matters. The function is added to `graph`. It is
/// `root` itself if there is nothing to replace.
pub fn same_sign(graph: &mut Graph, root: NodeId) -> NodeId {
    let needed = graph.needed(&[root]);
    let mut signs: Vec<NodeId> = Vec::with_capacity(root.index() + 1);
    let mut has_corner = false;
    for id in needed {
        // Nodes that the root does not need stand for themselves.
        while signs.len() < id.index() {
            signs.push(root);
        }
        let (op, operands) = match graph.node(id) {
            Node::Apply(op, operands) => (*op, operands.to_vec()),
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) => {
                signs.push(id);
                continue;
            }
        };
        let sign = |at: usize| signs[operands[at].index()];
        let replaced = if BY_SIGNS.contains(&op) {
            let operands: Vec<NodeId> = (0..operands.len()).map(sign).collect();
            graph.apply(op, &operands)
        } else if WHERE.contains(&op) {
            graph.apply(op, &[sign(0), operands[1]])
        } else if let Some(faces) = corner(graph, id) {
            has_corner = true;
            signs[faces.index()]
        } else if let Some(shifted) = beside_corner(graph, op, &operands) {
            has_corner = true;
            shifted
        } else {
            match factor(graph, op, &operands) {
                Some((at, true)) => sign(at),
                Some((at, false)) => graph.apply(Op::Neg, &[sign(at)]),
                None => id,
            }
        };
        signs.push(replaced);
    }
    if has_corner { signs[root.index()] } else { root }
}

/// The maximum m of the faces, if node `id` is the distance to the corner in which they meet.
fn corner(graph: &Graph, id: NodeId) -> Option<NodeId> {
    let operands = graph.operands(id, Op::Add)?;
    corner_of(graph, operands[0], operands[1])
        .or_else(|| corner_of(graph, operands[1], operands[0]))
}

/// As [`corner`], for the two terms of the sum.
fn corner_of(graph: &Graph, inside: NodeId, outside: NodeId) -> Option<NodeId> {
    let faces = other_than_zero(graph, inside, Op::Min)?;
    let mut open = vec![graph.operands(outside, Op::Sqrt)?[0]];
    let mut distances = Vec::new();
    while let Some(term) = open.pop() {
        if let Some(terms) = graph.operands(term, Op::Add) {
            open.extend(terms);
        } else {
            distances.push(other_than_zero(graph, base_of_square(graph, term)?, Op::Max)?);
        }
        if open.len() + distances.len() > MOST_FACES {
            return None;
        }
    }
    // The faces are joined in any order. A face may itself be a maximum.
    let mut open = vec![faces];
    let mut found = Vec::new();
    while let Some(node) = open.pop() {
        if distances.contains(&node) {
            found.push(node);
        } else {
            open.extend(graph.operands(node, Op::Max)?);
        }
        if open.len() + found.len() > MOST_FACES {
            return None;
        }
    }
    distances.iter().all(|face| found.contains(face)).then_some(faces)
}

/// The operand a of `op(a, 0)` or `op(0, a)`.
fn other_than_zero(graph: &Graph, id: NodeId, op: Op) -> Option<NodeId> {
    let operands = graph.operands(id, op)?;
    let is_zero = |id: NodeId| graph.number(id).is_some_and(crate::Constant::is_zero);
    match (is_zero(operands[0]), is_zero(operands[1])) {
        (false, true) => Some(operands[0]),
        (true, false) => Some(operands[1]),
        _ => None,
    }
}

fn base_of_square(graph: &Graph, id: NodeId) -> Option<NodeId> {
    if let Some(operands) = graph.operands(id, Op::Sqr) {
        return Some(operands[0]);
    }
    let operands = graph.operands(id, Op::Pow)?;
    (graph.number(operands[1])?.as_integer() == Some(2)).then_some(operands[0])
}

/// m + c, for a sum of the distance to a corner and a constant c ≥ 0. Where m ≤ 0, the distance is
/// m. Elsewhere both sums are above 0.
fn beside_corner(graph: &mut Graph, op: Op, operands: &[NodeId]) -> Option<NodeId> {
    let is_sum = op == Op::Add || op == Op::Sub;
    let &[first, second] = operands else { return None };
    let faces = corner(graph, first).filter(|_| is_sum)?;
    let bounds = graph.number(second)?.bounds();
    let is_nonneg = if op == Op::Add { bounds.lo >= 0.0 } else { bounds.hi <= 0.0 };
    is_nonneg.then(|| graph.apply(op, &[faces, second]))
}

/// The index of the operand whose sign a product or a quotient with a constant has, and whether
/// the constant is positive.
fn factor(graph: &Graph, op: Op, operands: &[NodeId]) -> Option<(usize, bool)> {
    let sign = |at: usize| {
        let bounds = graph.number(operands[at])?.bounds();
        let is_known = bounds.lo > 0.0 || bounds.hi < 0.0;
        is_known.then_some(bounds.lo > 0.0)
    };
    if op != Op::Mul && op != Op::Div {
        return None;
    }
    let second = sign(1).map(|positive| (0, positive));
    second.or_else(|| sign(0).filter(|_| op == Op::Mul).map(|positive| (1, positive)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Constant;
    use crate::display::display;
    use crate::graph::Axis;
    use crate::testing::{Random, evaluate};

    /// The distance to the corner of the half-spaces u ≤ 0 and v ≤ 0.
    fn distance(g: &mut Graph, u: NodeId, v: NodeId) -> NodeId {
        let (zero, two) = (g.integer(0), g.integer(2));
        let faces = g.apply(Op::Max, &[u, v]);
        let inside = g.apply(Op::Min, &[faces, zero]);
        let [u, v] = [u, v].map(|face| {
            let positive = g.apply(Op::Max, &[face, zero]);
            g.apply(Op::Pow, &[positive, two])
        });
        let sum = g.apply(Op::Add, &[u, v]);
        let outside = g.apply(Op::Sqrt, &[sum]);
        g.apply(Op::Add, &[inside, outside])
    }

    fn shown(make: impl Fn(&mut Graph, NodeId, NodeId) -> NodeId) -> String {
        let mut graph = Graph::new();
        let [x, y] = [Axis::X, Axis::Y].map(|axis| graph.variable(axis));
        let corner = distance(&mut graph, x, y);
        let root = make(&mut graph, corner, x);
        let sign = same_sign(&mut graph, root);
        if sign == root { "the same".to_owned() } else { display(&graph, sign, &[]) }
    }

    #[test]
    fn corners_become_maxima_where_only_their_sign_matters() {
        assert_eq!(shown(|_, corner, _| corner), "max(x, y)");
        assert_eq!(shown(|g, corner, x| g.apply(Op::Min, &[x, corner])), "min(x, max(x, y))");
        let nested = shown(|g, corner, _| {
            let z = g.variable(Axis::Z);
            let both = distance(g, corner, z);
            let three = g.integer(-3);
            g.apply(Op::Mul, &[three, both])
        });
        assert_eq!(nested, "-max(max(x, y), z)");
        let shrunk = |constant: i64| {
            shown(|g, corner, _| {
                let constant = g.integer(constant);
                g.apply(Op::Add, &[corner, constant])
            })
        };
        assert_eq!(shrunk(2), "max(x, y) + 2");
        assert_eq!(shrunk(-2), "the same");
    }

    #[test]
    fn values_that_matter_stay() {
        assert_eq!(
            shown(|g, _, x| {
                let two = g.integer(2);
                g.apply(Op::Mul, &[two, x])
            }),
            "the same"
        );
        assert_eq!(shown(|g, corner, x| g.apply(Op::Add, &[x, corner])), "the same");
        assert_eq!(shown(|g, corner, _| g.apply(Op::Sin, &[corner])), "the same");
        // The root holds a face that the maximum does not, and the other way round.
        let other = |faces: [Axis; 2]| {
            let mut g = Graph::new();
            let [x, y] = [Axis::X, Axis::Y].map(|axis| g.variable(axis));
            let corner = distance(&mut g, x, y);
            let outside = g.node(corner).clone();
            let Node::Apply(_, terms) = outside else { panic!("a sum") };
            let [a, b] = faces.map(|axis| g.variable(axis));
            let zero = g.integer(0);
            let maximum = g.apply(Op::Max, &[a, b]);
            let inside = g.apply(Op::Min, &[maximum, zero]);
            let root = g.apply(Op::Add, &[inside, terms[1]]);
            same_sign(&mut g, root) == root
        };
        assert!(other([Axis::X, Axis::X]) && other([Axis::X, Axis::Z]));
        assert!(!other([Axis::Y, Axis::X]));
    }

    /// Draws random trees of corners, minima, factors and shifts, and compares signs before and
    /// after.
    #[test]
    fn signs_agree_at_random_points() {
        let seed = 0x5161;
        println!("seed {seed}");
        let mut rng = Random(seed);
        let mut replaced = 0;
        for _ in 0..2000 {
            let mut g = Graph::new();
            let mut nodes: Vec<NodeId> = Axis::ALL.iter().map(|axis| g.variable(*axis)).collect();
            for _ in 0..6 {
                let [a, b] = [0; 2].map(|_| nodes[rng.below(nodes.len())]);
                let number = Constant::ratio(rng.below(9) as i64 - 4, 2).expect("a number");
                let number = g.constant(number);
                nodes.push(match rng.below(8) {
                    0..3 => distance(&mut g, a, b),
                    3 => g.apply(Op::Min, &[a, b]),
                    4 => g.apply(Op::Sub, &[a, number]),
                    5 => g.apply(Op::Add, &[a, number]),
                    6 => g.apply(Op::Mul, &[number, a]),
                    _ => g.apply(Op::Neg, &[a]),
                });
            }
            let root = nodes[nodes.len() - 1];
            let sign = same_sign(&mut g, root);
            replaced += usize::from(sign != root);
            for _ in 0..50 {
                let point = [0; 3].map(|_| rng.below(13) as f64 / 2.0 - 3.0);
                let values = evaluate(&g, point, &[]);
                let value = |id: NodeId| values[id.index()].expect("defined").0;
                let (before, after) = (value(root), value(sign));
                let near = before.abs() < 1e-9 && after.abs() < 1e-9;
                let agree = before.partial_cmp(&0.0) == after.partial_cmp(&0.0);
                let [left, right] = [root, sign].map(|id| display(&g, id, &[]));
                assert!(near || agree, "{point:?}: {left} = {before}, {right} = {after}");
            }
        }
        assert!(replaced > 1000, "{replaced}");
    }
}
