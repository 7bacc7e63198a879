//! Products u·ln u, which tend to 0 where u does.
//!
//! The logarithm is unbounded near 0, and so is an enclosure of the product. For all u > 0, −¾√u ≤
//! u·ln u ≤ u·(u − 1). With v = √u, the left side follows from v·ln v ≥ −1/e, since u·ln u =
//! 2v·(v·ln v) and 2/e < ¾. The right side follows from ln u ≤ u − 1. So clamping a product to
//! these bounds changes neither its values nor its domain.

use crate::algebra::{mul, neg, powi};
use crate::cancel::factors;
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use rustc_hash::FxHashMap;
use zeroset_ops::Op;

/// Returns a function with the values and the domain of definition of `root`, with bounded
/// enclosures of u·ln u near u = 0. The function is added to `graph`. It is `root` itself if there
/// is no such product.
///
/// ```
/// use zeroset_ir::{Axis, Graph, bounded_logarithms, display};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let x = graph.variable(Axis::X);
/// let ln = graph.apply(Op::Ln, &[x]);
/// let root = graph.apply(Op::Mul, &[x, ln]);
/// let root = bounded_logarithms(&mut graph, root);
/// assert_eq!(display(&graph, root, &[]), "min(max(x*ln(x), (-0.75)*sqrt(x)), x*(x + (-1)))");
/// ```
pub fn bounded_logarithms(graph: &mut Graph, root: NodeId) -> NodeId {
    let mut replaced: FxHashMap<NodeId, NodeId> = FxHashMap::default();
    for id in graph.needed(&[root]) {
        let Node::Apply(op, operands) = *graph.node(id) else { continue };
        let operands: Vec<NodeId> =
            operands.iter().map(|operand| *replaced.get(operand).unwrap_or(operand)).collect();
        let applied = graph.apply(op, &operands);
        let node = if op == Op::Mul { bounded(graph, applied) } else { None };
        let node = node.unwrap_or(applied);
        if node != id {
            replaced.insert(id, node);
        }
    }
    replaced.remove(&root).unwrap_or(root)
}

/// The product with its factors u and ln u replaced by the clamped u·ln u. `None` if it has no such
/// pair of factors.
fn bounded(graph: &mut Graph, product: NodeId) -> Option<NodeId> {
    let (is_negative, mut found) = factors(graph, product);
    let pair = found.keys().find_map(|ln| {
        let operand = graph.operands(*ln, Op::Ln)?[0];
        found.contains_key(&operand).then_some((operand, *ln))
    });
    let (u, ln) = pair?;
    for base in [u, ln] {
        let exponent = found.remove(&base)?;
        if exponent > 1 {
            found.insert(base, exponent - 1);
        }
    }
    let quarters = graph.constant(Constant::ratio(-3, 4)?);
    let (minus, root) = (graph.integer(-1), graph.apply(Op::Sqrt, &[u]));
    let low = graph.apply(Op::Mul, &[quarters, root]);
    let below = graph.apply(Op::Add, &[u, minus]);
    let high = graph.apply(Op::Mul, &[u, below]);
    let value = graph.apply(Op::Mul, &[u, ln]);
    let value = graph.apply(Op::Max, &[value, low]);
    let mut value = graph.apply(Op::Min, &[value, high]);
    for (base, exponent) in found {
        let power = powi(graph, base, i64::from(exponent));
        value = mul(graph, power, value);
    }
    Some(if is_negative { neg(graph, value) } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display;
    use crate::testing::{TestGraphBuilder, evaluate};

    #[test]
    fn values_and_domain_stay() {
        let builder = TestGraphBuilder::default();
        let [x, y, _] = builder.xyz();
        let root = (-(x * y * 3.0) * x.f(Op::Ln)).id;
        let mut graph = builder.graph();
        let bounded = bounded_logarithms(&mut graph, root);
        let text = display(&graph, bounded, &[]);
        assert!(text.contains("sqrt(x)"), "{text}");
        for k in -200..2000_i32 {
            for x in [f64::from(k) / 100.0, 2f64.powi(-k.abs() / 2)] {
                let values = evaluate(&graph, [x, 0.7, 0.0], &[]);
                let [before, after] = [root, bounded].map(|id| values[id.index()]);
                assert_eq!(before.is_some(), after.is_some(), "{x}");
                let (Some((a, ea)), Some((b, eb))) = (before, after) else { continue };
                assert!((a - b).abs() <= 1e-13 * a.abs() + ea + eb, "{x}: {a} {b}");
            }
        }
        // The logarithm of something else stays.
        let other = (x * y.f(Op::Ln)).id;
        let mut graph = builder.graph();
        assert_eq!(bounded_logarithms(&mut graph, other), other);
    }
}
