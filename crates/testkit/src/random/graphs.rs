//! Random expression graphs over every operation of the table, and values for their parameters.

use super::Rng;
use super::values::{Adversarial, Ends, below, from_exponents};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, NamedConstant, NodeId};
use zeroset_ops::{Op, TABLE};

/// Options of [`random_graph`].
#[derive(Clone, Debug)]
pub struct GraphOptions {
    /// Number of operations applied. Equal operations share one node.
    pub size: u32,
    /// Operations to choose from, at least one.
    pub ops: Vec<Op>,
    /// Number of parameters to choose from.
    pub parameters: u32,
    /// Whether constants may be huge, tiny or known only by their bounds.
    pub adversarial: bool,
}

impl Default for GraphOptions {
    /// Eight operations drawn from the whole table, no parameters, and adversarial constants.
    fn default() -> Self {
        Self {
            size: 8,
            ops: TABLE.iter().map(|row| row.op).collect(),
            parameters: 0,
            adversarial: true,
        }
    }
}

/// Returns an expression and its root, which is the operation applied last.
///
/// Operands are mostly recent nodes, so that formulas are deep and share sub-expressions. Exponents
/// and divisors are mostly constants, so that many formulas are defined somewhere.
///
/// # Panics
/// If `options.ops` is empty.
pub fn random_graph(rng: &mut Rng, options: &GraphOptions) -> (Graph, NodeId) {
    let mut graph = Graph::new();
    let mut nodes = vec![leaf(rng, options, &mut graph)];
    for _ in 0..options.size {
        let op = options.ops[below(rng, options.ops.len())];
        let mut operands = Vec::with_capacity(3);
        for place in 0..op.arity() {
            operands.push(operand(rng, options, &mut graph, &nodes, (op, place)));
        }
        nodes.push(graph.apply(op, &operands));
    }
    let root = nodes[nodes.len() - 1];
    (graph, root)
}

fn operand(
    rng: &mut Rng,
    options: &GraphOptions,
    graph: &mut Graph,
    nodes: &[NodeId],
    (op, place): (Op, usize),
) -> NodeId {
    let by_constant = matches!(op, Op::Pow | Op::Mod | Op::Div) && place == 1;
    match rng.u32(0..8) {
        0..=3 if by_constant => {
            let value = if op == Op::Pow {
                exponent(rng, options.adversarial)
            } else {
                random_constant(rng, options.adversarial)
            };
            graph.constant(value)
        }
        0..=3 => nodes[nodes.len() - 1 - below(rng, nodes.len().min(3))],
        4 => nodes[below(rng, nodes.len())],
        _ => leaf(rng, options, graph),
    }
}

fn leaf(rng: &mut Rng, options: &GraphOptions, graph: &mut Graph) -> NodeId {
    match rng.u32(0..8) {
        0 | 1 => {
            let value = random_constant(rng, options.adversarial);
            graph.constant(value)
        }
        2 | 3 if options.parameters > 0 => graph.parameter(rng.u32(0..options.parameters)),
        _ => graph.variable(Axis::ALL[below(rng, 3)]),
    }
}

fn exponent(rng: &mut Rng, adversarial: bool) -> Constant {
    let ratio = |n, d| Constant::ratio(n, d).unwrap_or_else(|| Constant::integer(1));
    match rng.u32(0..8) {
        0 => ratio(i64::from(rng.i32(-7..=7)), i64::from(rng.i32(1..=4))),
        1 => random_constant(rng, adversarial),
        2 => Constant::integer(i64::from(rng.i32(-40..=40))),
        3 if adversarial => {
            // An integer near a limit where code may treat integer exponents differently.
            let end = 1_i64 << [16, 31, 32][below(rng, 3)];
            Constant::integer((end + i64::from(rng.i32(-1..=1))) * if rng.bool() { 1 } else { -1 })
        }
        _ => Constant::integer(i64::from(rng.i32(-3..=6))),
    }
}

/// Returns a constant as a user might type it: a small integer, a short decimal, a ratio, π, τ, e
/// or φ. If `adversarial`, also huge and tiny decimals, adversarial `f32` numbers, integers about
/// 2⁵³, and numbers known only by their bounds.
pub fn random_constant(rng: &mut Rng, adversarial: bool) -> Constant {
    let decimal = |text: String| Constant::decimal(&text).unwrap_or_else(|| Constant::integer(0));
    let kinds = if adversarial { 12 } else { 6 };
    match rng.u32(0..kinds) {
        0 | 1 => Constant::integer(i64::from(rng.i32(-3..=5))),
        2 => Constant::integer(i64::from(rng.i32(-1000..=1000))),
        3 => decimal(format!("{}.{}", rng.u32(0..10), rng.u32(0..1000))),
        4 => Constant::ratio(i64::from(rng.i32(-20..=20)), i64::from(rng.i32(1..=20)))
            .unwrap_or_else(|| Constant::integer(1)),
        5 => match rng.u32(0..4) {
            0 => Constant::Named(NamedConstant::Pi),
            1 => Constant::Named(NamedConstant::Tau),
            2 => Constant::Named(NamedConstant::E),
            _ => Constant::Named(NamedConstant::Phi),
        },
        6 => decimal(format!("{}e{}", rng.u32(1..100), rng.i32(20..=340))),
        7 => decimal(format!("{}e-{}", rng.u32(1..100), rng.i32(20..=340))),
        8 => Constant::integer((1 << 53) + i64::from(rng.i32(-3..=3))),
        9 => {
            let value = f64::from(f32::adversarial(rng, Ends::Finite));
            enclosed(value, value.next_up())
        }
        10 => {
            let value = f64::from(f32::adversarial(rng, Ends::Finite));
            enclosed(value, value + f64::from(from_exponents::<f32>(rng, -40, 2)))
        }
        _ => {
            let value = f64::from(f32::adversarial(rng, Ends::Finite));
            enclosed(value, value)
        }
    }
}

/// Returns a constant of which only two finite bounds are known, `lo` ≤ `hi`.
fn enclosed(lo: f64, hi: f64) -> Constant {
    Constant::enclosed(Interval { lo, hi })
}

/// Returns bounds for each of `count` parameters: one number, two neighboring floats, or a range.
pub fn random_parameters(rng: &mut Rng, count: u32) -> Vec<(f64, f64)> {
    (0..count)
        .map(|_| {
            let value = f64::from(f32::adversarial(rng, Ends::Finite));
            match rng.u32(0..4) {
                0 | 1 => (value, value),
                2 => (value, value.next_up()),
                _ => (value, value + f64::from(from_exponents::<f32>(rng, -24, 1))),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Defined, enclose_at};
    use zeroset_ir::Node;

    const SEED: u64 = 0x5eed_0030;

    #[test]
    fn every_operation_and_kind_of_leaf_is_drawn() {
        let mut rng = Rng::with_seed(SEED);
        let mut seen = vec![0; TABLE.len()];
        let (mut axes, mut parameters, mut exact, mut enclosed) = (0, 0, 0, 0);
        let options = GraphOptions { parameters: 2, ..GraphOptions::default() };
        for _ in 0..2000 {
            let (graph, root) = random_graph(&mut rng, &options);
            let needed = graph.reachable(&[root]);
            for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
                match node {
                    Node::Variable(axis) => axes |= 1 << *axis as u32,
                    Node::Parameter(number) => parameters |= 1 << number,
                    Node::Constant(value) if value.exact().is_some() => exact += 1,
                    Node::Constant(_) => enclosed += 1,
                    Node::Apply(op, _) => seen[*op as usize] += 1,
                }
                assert!(id.index() < graph.len());
            }
        }
        for row in TABLE {
            assert!(seen[row.op as usize] > 50, "{}: {seen:?}", row.name);
        }
        assert_eq!((axes, parameters), (0b111, 0b11));
        assert!(exact > 500 && enclosed > 200, "{exact} {enclosed}");
    }

    #[test]
    fn only_the_operations_asked_for_are_drawn() {
        let mut rng = Rng::with_seed(SEED);
        let options = GraphOptions { ops: vec![Op::Add, Op::Sin], ..GraphOptions::default() };
        for _ in 0..100 {
            let (graph, root) = random_graph(&mut rng, &options);
            assert!(matches!(graph.node(root), Node::Apply(Op::Add | Op::Sin, _)));
            let other = graph
                .iter()
                .any(|(_, node)| matches!(node, Node::Apply(op, _) if !options.ops.contains(op)));
            assert!(!other);
        }
    }

    /// If no formula were defined anywhere, every property would hold trivially.
    #[test]
    fn a_fair_share_of_formulas_has_finite_values() {
        let mut rng = Rng::with_seed(SEED);
        let (mut defined, mut narrow) = (0, 0);
        for _ in 0..2000 {
            let (graph, root) = random_graph(&mut rng, &GraphOptions::default());
            let region = crate::random_box::<f32>(&mut rng, Ends::Finite);
            let point = crate::point_in_box(&mut rng, &region);
            let claim = enclose_at(&graph, &[root], point, &[])[0];
            defined += u32::from(claim.defined == Defined::Yes);
            let width = claim.hi - claim.lo;
            narrow += u32::from(claim.defined == Defined::Yes && width <= claim.hi.abs() * 1e-9);
        }
        assert!(defined > 800 && narrow > 500, "{defined} {narrow}");
    }
}
