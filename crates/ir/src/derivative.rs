//! Symbolic partial derivatives.
//!
//! One loop over the nodes adds the three partial derivatives of each node to the same graph
//! (forward accumulation). Unlike reverse accumulation, this keeps the branches of a choice apart:
//! the derivative of an untaken branch need not exist. It also encloses derivatives of min and max
//! by a hull, not by a sum. The rules are the column `derivative` of the table of operations.

use crate::algebra::{add, div, is_zero, mul, neg, pow, sub};
use crate::graph::{Graph, Node, NodeId};
use rustc_hash::FxHashMap;
use zeroset_ops::{Class, Op, TABLE};

/// Adds the partial derivatives of `root` by x, y and z to `graph`, and returns their nodes.
///
/// The nodes equal the true partial derivatives wherever `root` is differentiable and the rules'
/// intermediate results exist. If the two operands of min or max are equal, the rules take the mean
/// of the operands' derivatives. At any other kink they take the derivative of one side, or a value
/// between those of both sides. Jumps contribute nothing. A partial derivative may be defined in a
/// smaller domain than `root` (`sqrt` at 0) or in a larger one.
///
/// The graph grows by at most a small constant times the number of nodes that `root` needs.
///
/// ```
/// use zeroset_ir::{Axis, Graph, gradient};
/// use zeroset_ops::Op;
///
/// let mut graph = Graph::new();
/// let x = graph.variable(Axis::X);
/// let root = graph.apply(Op::Sin, &[x]);
/// let by_x = gradient(&mut graph, root)[0];
/// assert_eq!(by_x, graph.apply(Op::Cos, &[x]));
/// ```
pub fn gradient(graph: &mut Graph, root: NodeId) -> [NodeId; 3] {
    partials(graph, root, |_, node| match node {
        Node::Variable(axis) => Some(*axis as usize),
        Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => None,
    })
}

/// Adds the derivative of `root` by `leaf` to `graph`, and returns its node. The rules are those of
/// [`gradient`]. The leaf may be any variable or parameter.
pub fn derivative(graph: &mut Graph, root: NodeId, leaf: NodeId) -> NodeId {
    let [by_leaf] = partials(graph, root, |id, _| (id == leaf).then_some(0));
    by_leaf
}

/// The derivatives of `root` by N leaves. `number` returns the index of each of these leaves, and
/// `None` for other nodes.
fn partials<const N: usize>(
    graph: &mut Graph,
    root: NodeId,
    number: impl Fn(NodeId, &Node) -> Option<usize>,
) -> [NodeId; N] {
    let ids = graph.needed(&[root]);
    let (zero, one) = (graph.integer(0), graph.integer(1));
    // Nodes that are not in the map have the derivative 0.
    let mut partials: FxHashMap<NodeId, [NodeId; N]> = FxHashMap::default();
    for id in ids {
        let node = graph.node(id).clone();
        let mut own = [zero; N];
        if let Some(leaf) = number(id, &node) {
            own[leaf] = one;
        } else if let Node::Apply(op, operands) = node {
            for (leaf, own) in own.iter_mut().enumerate() {
                let partial = |o: &NodeId| partials.get(o).map_or(zero, |all| all[leaf]);
                let inner: Vec<NodeId> = operands.iter().map(partial).collect();
                if !inner.iter().all(|d| is_zero(graph, *d)) {
                    *own = chain(graph, op, &operands, &inner);
                }
            }
        }
        if own != [zero; N] {
            partials.insert(id, own);
        }
    }
    partials.get(&root).copied().unwrap_or([zero; N])
}

/// Adds a copy of `root` in which `value` takes the place of `leaf`, and returns its node.
pub fn substitute(graph: &mut Graph, root: NodeId, leaf: NodeId, value: NodeId) -> NodeId {
    let mut copies: FxHashMap<NodeId, NodeId> = FxHashMap::from_iter([(leaf, value)]);
    for id in graph.needed(&[root]) {
        if let Node::Apply(op, operands) = *graph.node(id) {
            let copy = |operand: &NodeId| copies.get(operand).copied().unwrap_or(*operand);
            let copied: Vec<NodeId> = operands.iter().map(copy).collect();
            if copied != operands[..] {
                copies.insert(id, graph.apply(op, &copied));
            }
        }
    }
    copies.get(&root).copied().unwrap_or(root)
}

/// The derivative of `op(operands)`; `inner` holds the derivatives of the operands.
fn chain(graph: &mut Graph, op: Op, operands: &[NodeId], inner: &[NodeId]) -> NodeId {
    let row = op.row();
    if row.class == Class::Extremum && inner[0] == inner[1] {
        return inner[0];
    }
    formula(graph, row.derivative, operands, inner)
}

/// Adds the value of a formula of the table, whose operands and their derivatives are given.
pub(crate) fn formula(
    graph: &mut Graph,
    text: &'static str,
    operands: &[NodeId],
    inner: &[NodeId],
) -> NodeId {
    let mut parser = FormulaParser { graph, operands, inner, rest: text };
    let value = parser.sum();
    assert!(parser.rest.is_empty(), "{text}");
    value
}

type Combine = fn(&mut Graph, NodeId, NodeId) -> NodeId;

/// Parses a row's formula into nodes. Panics if the formula is malformed.
struct FormulaParser<'a> {
    graph: &'a mut Graph,
    operands: &'a [NodeId],
    inner: &'a [NodeId],
    rest: &'static str,
}

impl FormulaParser<'_> {
    fn eat(&mut self, symbol: &str) -> bool {
        let rest = self.rest.strip_prefix(symbol).map(str::trim_start);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn sum(&mut self) -> NodeId {
        let first = if self.eat("-") {
            let product = self.product();
            neg(self.graph, product)
        } else {
            self.product()
        };
        self.joined(first, Self::product, [("+", add), ("-", sub)])
    }

    fn product(&mut self) -> NodeId {
        let first = self.power();
        self.joined(first, Self::power, [("*", mul), ("/", div)])
    }

    /// Parses further parts and combines `first` with them. One of the two symbols in `by` must
    /// stand before each part.
    fn joined(
        &mut self,
        first: NodeId,
        part: fn(&mut Self) -> NodeId,
        by: [(&str, Combine); 2],
    ) -> NodeId {
        let mut whole = first;
        while let Some((_, join)) = by.iter().find(|(symbol, _)| self.eat(symbol)) {
            let next = part(self);
            whole = join(self.graph, whole, next);
        }
        whole
    }

    fn power(&mut self) -> NodeId {
        let base = self.atom();
        if !self.eat("^") {
            return base;
        }
        let exponent = self.atom();
        pow(self.graph, base, exponent)
    }

    fn atom(&mut self) -> NodeId {
        if self.eat("(") {
            let sum = self.sum();
            assert!(self.eat(")"), "{}", self.rest);
            return sum;
        }
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = self.rest.find(|c| !is_word(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        match word {
            "a" => self.operands[0],
            "b" => self.operands[1],
            "da" => self.inner[0],
            "db" => self.inner[1],
            "dc" => self.inner[2],
            _ => match word.parse() {
                Ok(number) => self.graph.integer(number),
                Err(_) => self.call(word),
            },
        }
    }

    fn call(&mut self, name: &str) -> NodeId {
        let row = TABLE.iter().find(|row| row.name == name);
        let row = row.unwrap_or_else(|| panic!("no operation {name:?}"));
        let mut operands = Vec::new();
        while self.eat(if operands.is_empty() { "(" } else { "," }) {
            operands.push(self.sum());
        }
        assert!(self.eat(")"), "{}", self.rest);
        match operands[..] {
            [_, negative, other] if negative == other => other,
            _ => self.graph.apply(row.op, &operands),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display;
    use crate::graph::Axis;
    use crate::testing::{Random, TestGraphBuilder, evaluate};
    use zeroset_interval::{Decorated, Facts, Interval, fold};
    use zeroset_ops::composed;

    fn apply(graph: &mut Graph, op: Op, operands: &[NodeId]) -> NodeId {
        graph.apply(op, operands)
    }

    #[test]
    fn a_constant_exponent_needs_no_logarithm() {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let three = graph.integer(3);
        let root = apply(&mut graph, Op::Pow, &[x, three]);
        let partials = gradient(&mut graph, root);
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
    fn a_tie_has_the_mean_of_both_derivatives() {
        let mut graph = Graph::new();
        let [x, y, z] = Axis::ALL.map(|axis| graph.variable(axis));
        for op in [Op::Min, Op::Max] {
            let extremum = graph.apply(op, &[x, y]);
            let root = graph.apply(Op::Add, &[extremum, z]);
            let partials = gradient(&mut graph, root);
            let at = |at: [f64; 3]| {
                let values = evaluate(&graph, at, &[]);
                partials.map(|id| values[id.index()].expect("defined").0)
            };
            assert_eq!(at([0.25, 0.25, 0.0]), [0.5, 0.5, 1.0]);
            let [low, high] = [[0.0, 1.0, 1.0], [1.0, 0.0, 1.0]];
            let (less, more) = if op == Op::Min { (high, low) } else { (low, high) };
            assert_eq!((at([0.25, 0.5, 0.0]), at([0.5, 0.25, 0.0])), (less, more));
            assert_eq!(partials[2], graph.integer(1), "both sides agree");
        }
    }

    #[test]
    fn a_blend_on_its_seam_leans_to_neither_side() {
        let blend = composed("blend").next().expect("a row");
        assert_eq!(blend.body, "min(a, b)-max(k-abs(a-b), 0)^2/(4*k)");
        let builder = TestGraphBuilder::default();
        let [x, y, _] = builder.xyz();
        let gap = (1.0 - (x - y).f(Op::Abs)).apply(Op::Max, &[builder.number("0")]);
        let root = (x.apply(Op::Min, &[y]) - gap.pow(2) / 4.0).id;
        let mut graph = builder.graph();
        let partials = gradient(&mut graph, root);
        let values = evaluate(&graph, [0.3, 0.3, 0.0], &[]);
        let at_seam = partials.map(|id| values[id.index()].expect("defined").0);
        assert_eq!(at_seam, [0.5, 0.5, 0.0]);
    }

    #[test]
    fn every_row_states_a_derivative() {
        for row in TABLE {
            let mut graph = Graph::new();
            let operands = Axis::ALL.map(|axis| graph.variable(axis));
            let root = graph.apply(row.op, &operands[..row.op.arity()]);
            gradient(&mut graph, root); // panics where a rule cannot be read
        }
    }

    fn facts_at(graph: &Graph, root: NodeId, at: &[f64; 3]) -> Facts {
        value_at(graph, root, at).facts
    }

    /// The enclosure of a node at a point.
    fn value_at(graph: &Graph, root: NodeId, at: &[f64; 3]) -> Decorated {
        let mut known: FxHashMap<NodeId, Decorated> = FxHashMap::default();
        for id in graph.needed(&[root]) {
            let value = match graph.node(id) {
                Node::Variable(axis) => {
                    let at = Interval::point(at[*axis as usize]).expect("finite");
                    Decorated::from((at, Facts::TOTAL))
                }
                Node::Constant(value) => value.value(),
                Node::Parameter(_) => unreachable!("there are no parameters"),
                Node::Apply(op, operands) => {
                    let operands: Vec<_> = operands.iter().map(|id| known[id]).collect();
                    fold(*op, &operands).into()
                }
            };
            known.insert(id, value);
        }
        known[&root]
    }

    #[test]
    fn a_smooth_function_has_a_derivative_wherever_it_is_defined() {
        // The square of a smaller number than this underflows.
        const LEAST: f64 = 1e-150;
        let sizes = [0.0, 5e-324, 1e-300, 1e-9, 0.5, 0.999, 1.0, 1.5, 3.0, 40.0, 800.0, 1e9, 1e300];
        let points: Vec<f64> = sizes.iter().flat_map(|size| [*size, -size]).collect();
        let mut proven = 0;
        for row in TABLE {
            let arity = row.op.arity();
            for index in 0..points.len().pow(arity as u32) {
                let digit = |place: u32| points[index / points.len().pow(place) % points.len()];
                let at = [0, 1, 2].map(digit);
                let is_corner =
                    |corners: &[i32]| arity == 1 && corners.iter().any(|c| f64::from(*c) == at[0]);
                // The base of a real power is at least 0: there its domain ends.
                if row.corners.is_some_and(is_corner) || row.op == Op::Pow && at[0] == 0.0 {
                    continue;
                }
                let mut graph = Graph::new();
                let operands = Axis::ALL.map(|axis| graph.variable(axis));
                let root = graph.apply(row.op, &operands[..arity]);
                if !facts_at(&graph, root, &at).has(Facts::DEFINED) {
                    continue;
                }
                let is_tiny = at[..arity].iter().any(|v| *v != 0.0 && v.abs() < LEAST);
                for partial in gradient(&mut graph, root) {
                    let facts = facts_at(&graph, partial, &at);
                    let holds = if is_tiny {
                        !facts.has(Facts::NOWHERE)
                    } else {
                        facts.has(Facts::DEFINED)
                    };
                    assert!(holds, "{} at {:?}: {facts:?}", row.name, &at[..arity]);
                    proven += usize::from(!is_tiny);
                }
            }
        }
        assert!(proven > 50_000, "{proven}");
    }

    #[test]
    fn derivatives_at_zero_are_those_of_the_series() {
        // Jₙ(x) = Σ (-1)ᵏ (x/2)²ᵏ⁺ⁿ/(k! (k + n)!). From the fifth derivative on, it may be
        // undefined at 0, but not wrong.
        let exact = [
            (Op::BesselJ0, [0.0, -0.5, 0.0, 0.375, 0.0, -0.3125]),
            (Op::BesselJ1, [0.5, 0.0, -0.375, 0.0, 0.3125, 0.0]),
            (Op::BesselJ2, [0.0, 0.25, 0.0, -0.25, 0.0, 0.234_375]),
            (Op::BesselJ3, [0.0, 0.0, 0.125, 0.0, -0.156_25, 0.0]),
        ];
        for (op, exact) in exact {
            let mut graph = Graph::new();
            let x = graph.variable(Axis::X);
            let mut root = graph.apply(op, &[x]);
            for (order, exact) in (1..).zip(exact) {
                root = derivative(&mut graph, root, x);
                let Decorated { bounds, facts, .. } = value_at(&graph, root, &[0.0; 3]);
                assert!(facts.has(Facts::DEFINED) || order > 4, "{op:?}, {order}: {facts:?}");
                let is_near = (bounds.lo - exact).abs() < 1e-9 && (bounds.hi - exact).abs() < 1e-9;
                let is_defined = !facts.has(Facts::NOWHERE);
                assert!(!is_defined || is_near, "{op:?}, {order}: {bounds:?}, not {exact}");
            }
        }
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
                // If the three difference quotients disagree, a kink, a jump or a steep bend is
                // near.
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
