//! Symbolic partial derivatives.
//!
//! Forward accumulation: one loop over the nodes carries the three partial derivatives of each, as nodes of the
//! same graph. Unlike reverse accumulation it keeps the branches of a choice apart, so that the derivative of the
//! branch not taken need not exist, and it encloses min and max by the hull of two derivatives, not by their sum.
//! The rules are those of `partials` in the table of operations; nothing here evaluates anything.

use crate::algebra::{add, div, is_zero, mul, neg, powi, sub};
use crate::constant::Constant;
use crate::graph::{Axis, Graph, Node, NodeId};
use num_traits::One;
use zeroset_ops::Op;

/// The partial derivatives of `root` by x, y and z, added to `graph`.
///
/// Each is the derivative at every point where `root` is differentiable and the rules' intermediate results exist.
/// Where `root` has a kink, a derivative is that of one side, or lies between those of both sides. Jumps count as
/// flat. The domain of a derivative is not that of `root`: it may be smaller (`sqrt` at 0) or larger.
///
/// The graph grows by at most a small constant times the number of nodes that `root` needs.
///
/// ```
/// use zeroset_ir::{Axis, Graph, gradient};
/// use zeroset_ops::Op;
/// let mut graph = Graph::new();
/// let x = graph.variable(Axis::X);
/// let root = graph.apply(Op::Sin, &[x]);
/// let by_x = gradient(&mut graph, root)[0];
/// assert_eq!(by_x, graph.apply(Op::Cos, &[x]));
/// ```
pub fn gradient(graph: &mut Graph, root: NodeId) -> [NodeId; 3] {
    let needed = graph.reachable(&[root]);
    let zero = graph.integer(0);
    let one = graph.integer(1);
    // Only the nodes up to the root have an entry; those that the rules add are never differentiated here.
    let mut partials = vec![[zero; 3]; root.index() + 1];
    let ids: Vec<NodeId> = graph
        .iter()
        .take(root.index() + 1)
        .map(|(id, _)| id)
        .filter(|id| needed[id.index()])
        .collect();
    for id in ids {
        match graph.node(id).clone() {
            Node::Variable(axis) => partials[id.index()][axis as usize] = one,
            Node::Parameter(_) | Node::Constant(_) => {}
            Node::Apply(op, operands) => {
                for axis in Axis::ALL {
                    let axis = axis as usize;
                    let inner: Vec<NodeId> =
                        operands.iter().map(|o| partials[o.index()][axis]).collect();
                    if inner.iter().all(|d| is_zero(graph, *d)) {
                        continue;
                    }
                    partials[id.index()][axis] = chain(graph, op, id, &operands, &inner);
                }
            }
        }
    }
    partials[root.index()]
}

/// The derivative of `id = op(operands)`, given the operands' derivatives `inner`.
#[allow(clippy::too_many_lines)] // one arm per operation
fn chain(graph: &mut Graph, op: Op, id: NodeId, operands: &[NodeId], inner: &[NodeId]) -> NodeId {
    let a = operands[0];
    let da = inner[0];
    match op {
        Op::Neg => neg(graph, da),
        Op::Abs => {
            let sign = graph.apply(Op::Sign, &[a]);
            mul(graph, sign, da)
        }
        Op::Sign | Op::Floor | Op::Ceil | Op::Round | Op::Trunc => graph.integer(0),
        Op::Fract | Op::WhereNonneg | Op::WherePositive | Op::WhereNonzero | Op::WhereDefined => da,
        Op::Sqr => {
            let two = graph.integer(2);
            let outer = mul(graph, two, a);
            mul(graph, outer, da)
        }
        Op::Sqrt => {
            let two = graph.integer(2);
            let below = mul(graph, two, id);
            div(graph, da, below)
        }
        Op::Cbrt => {
            let three = graph.integer(3);
            let square = powi(graph, id, 2);
            let below = mul(graph, three, square);
            div(graph, da, below)
        }
        Op::Exp => mul(graph, id, da),
        Op::Ln => div(graph, da, a),
        Op::Log2 => logarithm(graph, a, da, 2),
        Op::Log10 => logarithm(graph, a, da, 10),
        Op::Sin => {
            let cos = graph.apply(Op::Cos, &[a]);
            mul(graph, cos, da)
        }
        Op::Cos => {
            let sin = graph.apply(Op::Sin, &[a]);
            let product = mul(graph, sin, da);
            neg(graph, product)
        }
        Op::Tan => {
            let outer = one_plus_square(graph, id);
            mul(graph, outer, da)
        }
        Op::Asin => {
            let below = root_within_one(graph, a);
            div(graph, da, below)
        }
        Op::Acos => {
            let below = root_within_one(graph, a);
            let quotient = div(graph, da, below);
            neg(graph, quotient)
        }
        Op::Atan => {
            let below = one_plus_square(graph, a);
            div(graph, da, below)
        }
        Op::Sinh => {
            let cosh = graph.apply(Op::Cosh, &[a]);
            mul(graph, cosh, da)
        }
        Op::Cosh => {
            let sinh = graph.apply(Op::Sinh, &[a]);
            mul(graph, sinh, da)
        }
        Op::Tanh => {
            // 1 − tanh² loses all digits, and its sign, where the function is flat.
            let cosh = graph.apply(Op::Cosh, &[a]);
            let below = powi(graph, cosh, 2);
            div(graph, da, below)
        }
        Op::Asinh => {
            let square = one_plus_square(graph, a);
            let below = graph.apply(Op::Sqrt, &[square]);
            div(graph, da, below)
        }
        Op::Acosh => {
            let one = graph.integer(1);
            let (below_one, above) = (sub(graph, a, one), add(graph, a, one));
            let product = mul(graph, below_one, above);
            let below = graph.apply(Op::Sqrt, &[product]);
            div(graph, da, below)
        }
        Op::Atanh => {
            let below = within_one(graph, a);
            div(graph, da, below)
        }
        Op::Add => add(graph, da, inner[1]),
        Op::Sub => sub(graph, da, inner[1]),
        Op::Mul => {
            let left = mul(graph, da, operands[1]);
            let right = mul(graph, a, inner[1]);
            add(graph, left, right)
        }
        Op::Div => {
            // (da − (a/b)·db)/b shares the quotient, and needs one division where the rule of the table has two.
            let change = mul(graph, id, inner[1]);
            let above = sub(graph, da, change);
            div(graph, above, operands[1])
        }
        Op::Pow => power(graph, id, operands, inner),
        Op::Mod => {
            let db = inner[1];
            if is_zero(graph, db) {
                return da;
            }
            let quotient = graph.apply(Op::Div, operands);
            let floor = graph.apply(Op::Floor, &[quotient]);
            let change = mul(graph, floor, db);
            sub(graph, da, change)
        }
        Op::Atan2 => {
            let b = operands[1];
            let (left, right) = (mul(graph, b, da), mul(graph, a, inner[1]));
            let turn = sub(graph, left, right);
            let (a_square, b_square) = (powi(graph, a, 2), powi(graph, b, 2));
            let distance = add(graph, a_square, b_square);
            div(graph, turn, distance)
        }
        Op::Min => {
            let order = sub(graph, operands[1], a);
            choose(graph, order, inner[1], da)
        }
        Op::Max => {
            let order = sub(graph, a, operands[1]);
            choose(graph, order, inner[1], da)
        }
        Op::SelectNegative => choose(graph, a, inner[1], inner[2]),
        Op::Otherwise => {
            // Where a has a value and no derivative, that of the other operand stands in as well.
            let here = graph.apply(Op::WhereDefined, &[da, a]);
            graph.apply(op, &[here, inner[1]])
        }
    }
}

/// `negative` where `condition < 0`, else `other`.
fn choose(graph: &mut Graph, condition: NodeId, negative: NodeId, other: NodeId) -> NodeId {
    if negative == other {
        return other;
    }
    graph.apply(Op::SelectNegative, &[condition, negative, other])
}

fn one_plus_square(graph: &mut Graph, a: NodeId) -> NodeId {
    let square = powi(graph, a, 2);
    let one = graph.integer(1);
    add(graph, one, square)
}

/// `(1-a)*(1+a)`, which unlike 1 − a² is exact to the end near ±1.
fn within_one(graph: &mut Graph, a: NodeId) -> NodeId {
    let one = graph.integer(1);
    let (below, above) = (sub(graph, one, a), add(graph, one, a));
    mul(graph, below, above)
}

fn root_within_one(graph: &mut Graph, a: NodeId) -> NodeId {
    let product = within_one(graph, a);
    graph.apply(Op::Sqrt, &[product])
}

/// The derivative of the logarithm of `a` to an integer base.
fn logarithm(graph: &mut Graph, a: NodeId, da: NodeId, base: i64) -> NodeId {
    let base = graph.integer(base);
    let scale = graph.apply(Op::Ln, &[base]);
    let below = mul(graph, a, scale);
    div(graph, da, below)
}

fn power(graph: &mut Graph, id: NodeId, operands: &[NodeId], inner: &[NodeId]) -> NodeId {
    let (a, b) = (operands[0], operands[1]);
    let (da, db) = (inner[0], inner[1]);
    let by_base = if is_zero(graph, da) {
        da
    } else {
        let reduced = match graph.node(b) {
            Node::Constant(constant) => match constant.as_integer() {
                Some(n) => match n.checked_sub(1) {
                    Some(reduced) => powi(graph, a, reduced),
                    None => quotient(graph, id, a),
                },
                None => match constant.exact().cloned() {
                    Some(value) => {
                        let one = num_rational::BigRational::one();
                        let exponent = graph.constant(Constant::rational(value - one));
                        graph.apply(Op::Pow, &[a, exponent])
                    }
                    None => lowered(graph, a, b),
                },
            },
            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => lowered(graph, a, b),
        };
        let outer = mul(graph, b, reduced);
        mul(graph, outer, da)
    };
    if is_zero(graph, db) {
        return by_base; // no logarithm: the base may be negative or 0
    }
    let log = graph.apply(Op::Ln, &[a]);
    let outer = mul(graph, id, log);
    let by_exponent = mul(graph, outer, db);
    add(graph, by_base, by_exponent)
}

/// `a^(b-1)` for an exponent that is not known exactly.
fn lowered(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let one = graph.integer(1);
    let exponent = graph.apply(Op::Sub, &[b, one]);
    graph.apply(Op::Pow, &[a, exponent])
}

/// `a^b / a`, for an exponent that cannot be lowered.
fn quotient(graph: &mut Graph, power: NodeId, a: NodeId) -> NodeId {
    graph.apply(Op::Div, &[power, a])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display;
    use crate::testing::{Random, evaluate};

    fn apply(graph: &mut Graph, op: Op, operands: &[NodeId]) -> NodeId {
        graph.apply(op, operands)
    }

    #[test]
    fn a_constant_exponent_needs_no_logarithm() {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let three = graph.integer(3);
        let root = apply(&mut graph, Op::Pow, &[x, three]);
        let before = graph.len();
        let partials = gradient(&mut graph, root);
        let ln = graph.iter().skip(before).find(|(_, node)| matches!(node, Node::Apply(Op::Ln, _)));
        assert!(ln.is_none());
        let square = apply(&mut graph, Op::Sqr, &[x]);
        assert_eq!(partials[0], apply(&mut graph, Op::Mul, &[three, square]));
        assert!(is_zero(&graph, partials[1]) && is_zero(&graph, partials[2]));
    }

    #[test]
    fn a_parameter_does_not_vary_in_space() {
        let mut graph = Graph::new();
        let a = graph.parameter(0);
        let x = graph.variable(Axis::X);
        let root = graph.apply(Op::Mul, &[a, x]);
        assert_eq!(gradient(&mut graph, root)[0], a);
    }

    #[test]
    fn a_chain_of_products_stays_linear() {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let y = graph.variable(Axis::Y);
        let mut root = x;
        for _ in 0..1000 {
            let product = graph.apply(Op::Mul, &[root, root]);
            root = graph.apply(Op::Add, &[product, y]);
        }
        let before = graph.len();
        gradient(&mut graph, root);
        assert!(graph.len() < 8 * before, "{} from {before}", graph.len());
    }

    #[test]
    fn the_smaller_operand_gives_the_derivative_of_min() {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let y = graph.variable(Axis::Y);
        let root = graph.apply(Op::Min, &[x, y]);
        let by_x = gradient(&mut graph, root)[0];
        let order = graph.apply(Op::Sub, &[y, x]);
        let (zero, one) = (graph.integer(0), graph.integer(1));
        assert_eq!(by_x, graph.apply(Op::SelectNegative, &[order, zero, one]));
    }

    #[test]
    fn derivatives_agree_with_central_differences() {
        const STEP: f64 = 1e-5;
        let seed = 0xd1ff_0000;
        let mut compared = 0;
        for case in 0..25_000_u64 {
            let mut random = Random(seed + case);
            let size = 1 + random.below(8);
            let (mut graph, root) = random.graph(size);
            let partials = gradient(&mut graph, root);
            let at = [0; 3].map(|_| random.coordinate() + 1e-3);
            let parameters = [random.coordinate(), random.coordinate()];
            let value = |at: [f64; 3], id: NodeId| {
                evaluate(&graph, at, &parameters)[id.index()]
                    .filter(|(v, e)| *e < 1e-10 && v.abs() < 1e3)
            };
            for axis in 0..3 {
                let moved = |steps: f64| {
                    let mut at = at;
                    at[axis] += steps * STEP;
                    value(at, root).map(|v| v.0)
                };
                let (Some(a), Some(b), Some(c), Some(d), Some(e), Some(f)) =
                    (moved(-2.0), moved(-1.0), moved(1.0), moved(2.0), moved(-0.7), moved(0.7))
                else {
                    continue;
                };
                let central = (c - b) / (2.0 * STEP);
                let wide = (d - a) / (4.0 * STEP);
                let narrow = (f - e) / (1.4 * STEP);
                // Where the steps disagree there is a kink, a jump or a steep bend nearby.
                let close = |other: f64| (central - other).abs() <= 1e-6 * (1.0 + central.abs());
                if !close(wide) || !close(narrow) {
                    continue;
                }
                let Some((partial, _)) = value(at, partials[axis]) else {
                    continue;
                };
                compared += 1;
                assert!(
                    (partial - central).abs() <= 1e-4 * (1.0 + central.abs()),
                    "seed {:#x}: d/d{axis} {} = {} is {partial}, not {central}, at {at:?} {parameters:?}",
                    seed + case,
                    display(&graph, root, &[]),
                    display(&graph, partials[axis], &[]),
                );
            }
        }
        assert!(compared > 20_000, "{compared}");
    }
}
