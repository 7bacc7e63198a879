//! Quadratic blends, however they are spelled.
//!
//! Many programs write the smooth minimum of a and b as mix(b, a, h) − k·h·(1 − h) with
//! h = clamp(1/2 + (b − a)/2k, 0, 1). This equals min(a, b) − max(k − |a − b|, 0)²/4k, which has
//! narrower enclosures. Where one operand decides, parts of space drop the other.
//!
//! More generally, let h = clamp(e, 0, 1), and let N = A + C·(h² − 2e·h) with a number C and with A
//! and e free of h. The difference is −C times a function of e that is 0 below 0, e² up to 1, and
//! 2e − 1 beyond. So N is the blend of A and B = A − C·(2e − 1) with the width k = |C|: of the
//! minimum if C > 0, else of the maximum. As polynomials in h and other parts, both are compared
//! exactly.

use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use crate::polynomial::{Polynomial, Work};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rustc_hash::FxHashMap;
use std::collections::BTreeSet;
use zeroset_ops::{Class, Op};

/// Most products of terms that are computed to test one sum.
const WORK_LIMIT: u32 = 4_000;
/// Most clamps of a sum that are tried.
const CLAMP_LIMIT: usize = 4;
/// Most nodes among which the operands of a blend are sought.
const NODES: usize = 48;

/// The clamps of a sum or product, with their degrees.
type Clamps = Vec<(NodeId, u32)>;

/// Writes the quadratic blends of a [rewritten](crate::rewrite) function as
/// min(a, b) − c·max(k − |a − b|, 0)².
///
/// The new function has the values and the domain of definition of `root`. It is added to `graph`.
/// It is `root` itself if no blend is spelled otherwise.
pub fn quadratic_blends(graph: &mut Graph, root: NodeId) -> NodeId {
    let needed = graph.needed(&[root]);
    if !needed.iter().any(|&id| clamped(graph, id).is_some()) {
        return root;
    }
    let mut replaced: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    let mut clamps: FxHashMap<NodeId, Clamps> = FxHashMap::default();
    for id in needed {
        let Node::Apply(op, operands) = *graph.node(id) else { continue };
        let operands: Vec<NodeId> =
            operands.iter().map(|operand| *replaced.get(operand).unwrap_or(operand)).collect();
        let mut node = graph.apply(op, &operands);
        let mut own = own_clamps(graph, node, &clamps);
        if op.row().class == Class::Sum {
            let square = |(clamp, degree): &(NodeId, u32)| (*degree == 2).then_some(*clamp);
            let blend = own.iter().filter_map(square).find_map(|clamp| blend(graph, node, clamp));
            if let Some(blend) = blend {
                (node, own) = (blend, Clamps::new());
            }
        }
        if !own.is_empty() {
            clamps.insert(node, own);
        }
        if node != id {
            replaced.insert(id, node);
        }
    }
    replaced.remove(&root).unwrap_or(root)
}

/// The node e if a node is clamp(e, 0, 1).
fn clamped(graph: &Graph, id: NodeId) -> Option<NodeId> {
    let with = |id: NodeId, op: Op, end: i64| {
        let &[a, b] = graph.operands(id, op)? else { return None };
        let is_end = |id: NodeId| graph.number(id).is_some_and(|n| n.as_integer() == Some(end));
        if is_end(b) { Some(a) } else { is_end(a).then_some(b) }
    };
    let above = |id| with(id, Op::Max, 0);
    let below = |id| with(id, Op::Min, 1);
    below(id).and_then(above).or_else(|| above(id).and_then(below))
}

/// The clamps of which a node is a polynomial, with its degree in each.
fn own_clamps(graph: &Graph, id: NodeId, clamps: &FxHashMap<NodeId, Clamps>) -> Clamps {
    if clamped(graph, id).is_some() {
        return vec![(id, 1)];
    }
    let mut own = Clamps::new();
    let Node::Apply(op, operands) = graph.node(id) else { return own };
    let class = op.row().class;
    let of = |operand: NodeId| clamps.get(&operand).into_iter().flatten().copied();
    match class {
        Class::Sum | Class::Product | Class::Negation | Class::Square | Class::Quotient => {}
        _ => return own,
    }
    for (clamp, degree) in operands.iter().flat_map(|&operand| of(operand)) {
        let degree = if class == Class::Square { 2 * degree } else { degree };
        match own.iter_mut().find(|(other, _)| *other == clamp) {
            Some((_, known)) if class == Class::Product => *known += degree,
            Some((_, known)) => *known = degree.max(*known),
            None => own.push((clamp, degree)),
        }
    }
    own.truncate(CLAMP_LIMIT);
    own
}

/// Returns the blend that equals a sum with this clamp. `None` if the sum is not a blend.
fn blend(graph: &mut Graph, sum: NodeId, clamp: NodeId) -> Option<NodeId> {
    let work = &mut Work(WORK_LIMIT);
    let inner = clamped(graph, clamp)?;
    let whole = Polynomial::of(graph, sum, work);
    if whole.degree(clamp) != 2 {
        return None;
    }
    let factor = whole.coefficient(clamp, 2).as_constant()?;
    let position = Polynomial::of(graph, inner, work);
    let twice = position.scaled(&(&factor + &factor));
    if factor.is_zero() || !whole.coefficient(clamp, 1).plus(&twice).is_zero() {
        return None;
    }
    let first = whole.coefficient(clamp, 0);
    let second = first.clone().minus(&twice).plus(&Polynomial::constant(factor.clone()));
    let parts = parts(graph, [sum, inner], clamp);
    let mut find = |wanted: &Polynomial| {
        parts.iter().copied().find(|&part| Polynomial::of(graph, part, work) == *wanted)
    };
    let negative = |polynomial: &Polynomial| polynomial.scaled(&-BigRational::one());
    let (a, b, is_negated) = match (find(&first), find(&second)) {
        (Some(a), Some(b)) => (a, b, false),
        _ => (find(&negative(&first))?, find(&negative(&second))?, true),
    };
    // The blend must be defined where the sum is, and nowhere else.
    let leaves = |id: NodeId| Polynomial::leaves(graph, id);
    let of_operands: BTreeSet<NodeId> = &leaves(a) | &leaves(b);
    let mut others = &leaves(sum) | &leaves(inner);
    others.remove(&clamp);
    if !others.is_subset(&of_operands) {
        return None;
    }
    let is_max = factor.is_negative() != is_negated;
    let width = factor.abs();
    let share = (&width + &width + &width + &width).recip();
    let [width, share] = [width, share].map(|number| graph.constant(Constant::rational(number)));
    let zero = graph.integer(0);
    let (extremum, join) = if is_max { (Op::Max, Op::Add) } else { (Op::Min, Op::Sub) };
    let ends = graph.apply(extremum, &[a, b]);
    let difference = graph.apply(Op::Sub, &[a, b]);
    let distance = graph.apply(Op::Abs, &[difference]);
    let rest = graph.apply(Op::Sub, &[width, distance]);
    let rest = graph.apply(Op::Max, &[rest, zero]);
    let square = graph.apply(Op::Sqr, &[rest]);
    let bulge = graph.apply(Op::Mul, &[share, square]);
    let blend = graph.apply(join, &[ends, bulge]);
    Some(if is_negated { graph.apply(Op::Neg, &[blend]) } else { blend })
}

/// The nodes of which two sums are built by sums, products and quotients, and the sums. The parts
/// of the clamp are not among them.
fn parts(graph: &Graph, sums: [NodeId; 2], clamp: NodeId) -> Vec<NodeId> {
    let mut parts: Vec<NodeId> = Vec::new();
    let mut next = 0;
    parts.extend(sums);
    while let Some(&id) = parts.get(next) {
        next += 1;
        let Node::Apply(op, operands) = graph.node(id) else { continue };
        let is_open = matches!(
            op.row().class,
            Class::Sum | Class::Product | Class::Negation | Class::Square | Class::Quotient
        );
        for &operand in operands.iter().filter(|_| is_open) {
            if operand != clamp && parts.len() < NODES && !parts.contains(&operand) {
                parts.push(operand);
            }
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{TestExpr, TestGraphBuilder, evaluate};
    use crate::{display, rewrite};
    use zeroset_interval::Interval;

    /// Smooth minima and maxima of a and b with the width 0.3, in several spellings.
    fn spellings<'a>(
        builder: &'a TestGraphBuilder,
        [a, b]: [TestExpr<'a>; 2],
    ) -> Vec<(TestExpr<'a>, bool)> {
        let [zero, one, half, k] = ["0", "1", "0.5", "0.3"].map(|text| builder.number(text));
        let clamp = |e: TestExpr<'a>| e.apply(Op::Max, &[zero]).apply(Op::Min, &[one]);
        let h = clamp(half + half * (b - a) / k);
        let outside = (half + (b - a) / (k + k)).apply(Op::Min, &[one]).apply(Op::Max, &[zero]);
        let other = clamp(half - half * (b - a) / k);
        vec![
            (b * (one - h) + a * h - k * h * (one - h), true),
            (b + h * (a - b) - k * h * (one - h), true),
            (b + outside * (a - b) - k * (outside - outside * outside), true),
            (k * h * (one - h) - a * h - b * (one - h), true),
            (b * (one - other) + a * other + k * other * (one - other), true),
            // The width is another, a clamp is left out, and a term is added.
            (b * (one - h) + a * h - half * h * (one - h), false),
            (b * (one - h) + a * (half + half * (b - a) / k) - k * h * (one - h), false),
            (b * (one - h) + a * h - k * h * (one - h) + a, false),
            (b * (one - h) + a * h - k * h * (one - h) + half * h, false),
        ]
    }

    /// A function as programs pass it on.
    fn simpler(graph: &Graph, root: NodeId) -> (Graph, NodeId) {
        let (graph, roots) = rewrite(graph, &[root], &[Interval::ENTIRE; 3], &[]).expect("short");
        (graph, roots[0])
    }

    #[test]
    fn all_spellings_become_one() {
        let builder = TestGraphBuilder::default();
        let [x, y, z] = builder.xyz();
        let [one, two] = ["1", "2"].map(|text| builder.number(text));
        let a = (x * x + y * y).f(Op::Sqrt) - one;
        let b = (x - one) * (y * two - z).f(Op::Sqrt);
        for (number, (spelled, is_blend)) in spellings(&builder, [a, b]).into_iter().enumerate() {
            let (mut graph, root) = simpler(&builder.graph(), spelled.id);
            let blend = quadratic_blends(&mut graph, root);
            let text = display(&graph, blend, &[]);
            assert_eq!(blend != root, is_blend, "{number}: {text}");
            for n in 0..4000_i32 {
                let at = [n % 16, n / 16 % 16, n / 256].map(|k| f64::from(k) / 4.0 - 2.0);
                let values = evaluate(&graph, at, &[]);
                let [before, after] = [root, blend].map(|id| values[id.index()]);
                assert_eq!(before.is_some(), after.is_some(), "{number}: {at:?}");
                let (Some((p, ep)), Some((q, eq))) = (before, after) else { continue };
                assert!((p - q).abs() <= 1e-12 + ep + eq, "{number}: {at:?}: {p} {q}");
            }
        }
    }

    #[test]
    fn a_tower_of_blends_is_one_of_the_plain_form() {
        let builder = TestGraphBuilder::default();
        let [x, y, _] = builder.xyz();
        let mut all = x;
        for n in 0..40 {
            let number = builder.constant(Constant::ratio(n, 7).expect("a number"));
            all = spellings(&builder, [all, (x - number) * y])[0].0;
        }
        let (mut graph, root) = simpler(&builder.graph(), all.id);
        let blend = quadratic_blends(&mut graph, root);
        let needed = graph.needed(&[blend]);
        assert!(!needed.iter().any(|&id| clamped(&graph, id).is_some()));
    }

    #[test]
    fn a_part_that_cancels_keeps_its_domain() {
        let builder = TestGraphBuilder::default();
        let [x, y, z] = builder.xyz();
        let [zero, one, half, k] = ["0", "1", "0.5", "0.3"].map(|text| builder.number(text));
        let h = half + half * (y - x) / k;
        let h = h.apply(Op::Max, &[zero]).apply(Op::Min, &[one]);
        let gap = z.f(Op::Sqrt);
        // Neither operand of the difference is a blend.
        let root = (y * (one - h) + x * h + gap) - (k * h * (one - h) + gap);
        let mut graph = builder.graph();
        let blend = quadratic_blends(&mut graph, root.id);
        let values = evaluate(&graph, [0.5, 0.25, -1.0], &[]);
        assert!(values[blend.index()].is_none());
    }
}
