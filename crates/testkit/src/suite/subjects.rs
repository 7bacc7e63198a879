//! Small graphs that cover the table: each operation alone, over variables and constants.

use zeroset_eval::Real;
use zeroset_ir::{Axis, Constant, Graph, NamedConstant, Node, NodeId};
use zeroset_ops::{Op, TABLE};

/// One operation as a graph.
pub(super) struct OpGraph {
    pub(super) op: Op,
    pub(super) graph: Graph,
    pub(super) root: NodeId,
}

impl OpGraph {
    /// Returns whether all constants are within the range of `T`. If not, sampled values mean
    /// nothing.
    pub(super) fn fits<T: Real>(&self) -> bool {
        self.graph.iter().all(|(_, node)| match node {
            Node::Constant(value) => value.bounds().magnitude() <= T::LARGEST.into(),
            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => true,
        })
    }
}

/// All operations.
pub(super) fn every_op() -> Vec<Op> {
    TABLE.iter().map(|row| row.op).collect()
}

/// Returns the graphs of these operations among [`subjects`].
pub(super) fn subjects_of(ops: &[Op]) -> impl Iterator<Item = OpGraph> {
    subjects().into_iter().filter(|subject| ops.contains(&subject.op))
}

/// Returns graphs of every operation over x, y, z. For a binary operation there are also graphs
/// with equal operands, and with a constant on either side. Powers have more constants.
fn subjects() -> Vec<OpGraph> {
    let mut all = Vec::new();
    for row in TABLE {
        all.push(subject(row.op, |graph, place| graph.variable(Axis::ALL[place])));
        if row.arity != 2 {
            continue;
        }
        all.push(subject(row.op, |graph, _| graph.variable(Axis::X)));
        for constant in constants(row.op) {
            for side in 0..2 {
                all.push(subject(row.op, |graph, place| {
                    if place == side {
                        graph.constant(constant.clone())
                    } else {
                        graph.variable(Axis::X)
                    }
                }));
            }
        }
    }
    all
}

fn subject(op: Op, mut operand: impl FnMut(&mut Graph, usize) -> NodeId) -> OpGraph {
    let mut graph = Graph::new();
    let operands: Vec<NodeId> = (0..op.arity()).map(|place| operand(&mut graph, place)).collect();
    let root = graph.apply(op, &operands);
    OpGraph { op, graph, root }
}

fn constants(op: Op) -> Vec<Constant> {
    let mut all: Vec<Constant> = [-1, 0, 1, 2, 3].map(Constant::integer).into();
    all.extend(Constant::decimal("0.1"));
    all.push(Constant::Named(NamedConstant::Pi));
    all.extend(Constant::decimal("1e300"));
    if op == Op::Pow {
        all.extend([-7, -3, -2, 4, 5, 7, 8, 16, 31, 64, 1001].map(Constant::integer));
        for (numerator, denominator) in [(1, 2), (-1, 2), (1, 3), (3, 2), (-7, 3)] {
            all.extend(Constant::ratio(numerator, denominator));
        }
    }
    all
}
