//! The operations of expression lists, by the names that fidget 0.5.1 reads, and `recip`.
//!
//! Their values are those of real numbers. Operations on the bits of floats have no equal among
//! functions of real numbers. They are listed so that their error can say so.

use rustc_hash::FxHashMap;
use std::sync::LazyLock;
use zeroset_ir::{Axis, Constant, Graph, NodeId};
use zeroset_ops::Op;

/// A row of the table: the name of an operation, and its meaning.
pub(crate) struct Opcode {
    pub name: &'static str,
    pub meaning: Meaning,
}

/// The value that a line with an operation has.
pub(crate) enum Meaning {
    /// The decimal that follows.
    Constant,
    /// A coordinate.
    Variable(Axis),
    /// An operation of the table.
    Native(Op),
    /// A value of one operand, made of operations of the table.
    OfOne(fn(&mut Graph, NodeId) -> NodeId),
    /// A value of two operands, made of operations of the table.
    OfTwo(fn(&mut Graph, NodeId, NodeId) -> NodeId),
    /// A function of the bits of floats, with this number of operands.
    OfBits(usize),
}

impl Opcode {
    /// Number of words after the operation.
    pub fn operands(&self) -> usize {
        match &self.meaning {
            Meaning::Variable(_) => 0,
            Meaning::Constant | Meaning::OfOne(_) => 1,
            Meaning::OfTwo(_) => 2,
            Meaning::Native(op) => op.arity(),
            Meaning::OfBits(count) => *count,
        }
    }
}

const fn row(name: &'static str, meaning: Meaning) -> Opcode {
    Opcode { name, meaning }
}

/// All operations.
#[rustfmt::skip] // one row a line
pub(crate) const OPCODES: &[Opcode] = &[
    row("const", Meaning::Constant),
    row("var-x", Meaning::Variable(Axis::X)),
    row("var-y", Meaning::Variable(Axis::Y)),
    row("var-z", Meaning::Variable(Axis::Z)),
    row("neg", Meaning::Native(Op::Neg)),
    row("abs", Meaning::Native(Op::Abs)),
    row("recip", Meaning::OfOne(reciprocal)),
    row("sqrt", Meaning::Native(Op::Sqrt)),
    row("square", Meaning::Native(Op::Sqr)),
    row("floor", Meaning::Native(Op::Floor)),
    row("ceil", Meaning::Native(Op::Ceil)),
    row("round", Meaning::OfOne(round)),
    row("sin", Meaning::Native(Op::Sin)),
    row("cos", Meaning::Native(Op::Cos)),
    row("tan", Meaning::Native(Op::Tan)),
    row("asin", Meaning::Native(Op::Asin)),
    row("acos", Meaning::Native(Op::Acos)),
    row("atan", Meaning::Native(Op::Atan)),
    row("exp", Meaning::Native(Op::Exp)),
    row("ln", Meaning::Native(Op::Ln)),
    row("not", Meaning::OfOne(not)),
    row("rand", Meaning::OfBits(1)),
    row("add", Meaning::Native(Op::Add)),
    row("sub", Meaning::Native(Op::Sub)),
    row("mul", Meaning::Native(Op::Mul)),
    row("div", Meaning::Native(Op::Div)),
    row("min", Meaning::Native(Op::Min)),
    row("max", Meaning::Native(Op::Max)),
    row("atan2", Meaning::Native(Op::Atan2)),
    row("mod", Meaning::OfTwo(modulo)),
    row("compare", Meaning::OfTwo(compare)),
    row("and", Meaning::OfTwo(and)),
    row("or", Meaning::OfTwo(or)),
    row("mix", Meaning::OfBits(2)),
];

/// The operation with this name.
pub(crate) fn opcode(name: &str) -> Option<&'static Opcode> {
    static BY_NAME: LazyLock<FxHashMap<&str, &Opcode>> =
        LazyLock::new(|| OPCODES.iter().map(|opcode| (opcode.name, opcode)).collect());
    BY_NAME.get(name).copied()
}

fn reciprocal(graph: &mut Graph, a: NodeId) -> NodeId {
    let one = graph.integer(1);
    graph.apply(Op::Div, &[one, a])
}

/// The nearest integer, halves away from 0: sign(a)·⌊|a| + ½⌋.
fn round(graph: &mut Graph, a: NodeId) -> NodeId {
    let half = Constant::ratio(1, 2).expect("2 is not 0");
    let half = graph.constant(half);
    let size = graph.apply(Op::Abs, &[a]);
    let sum = graph.apply(Op::Add, &[size, half]);
    let whole = graph.apply(Op::Floor, &[sum]);
    let sign = graph.apply(Op::Sign, &[a]);
    graph.apply(Op::Mul, &[sign, whole])
}

/// The remainder in [0, |b|).
fn modulo(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let is_positive = graph.number(b).is_some_and(|number| number.bounds().lo > 0.0);
    let size = if is_positive { b } else { graph.apply(Op::Abs, &[b]) };
    graph.apply(Op::Mod, &[a, size])
}

/// −1, 0 or 1, by the order of a and b.
fn compare(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let difference = graph.apply(Op::Sub, &[a, b]);
    graph.apply(Op::Sign, &[difference])
}

/// `off` where `a` is not 0, else `at`.
fn by_zero(graph: &mut Graph, a: NodeId, off: NodeId, at: NodeId) -> NodeId {
    let size = graph.apply(Op::Abs, &[a]);
    let opposite = graph.apply(Op::Neg, &[size]);
    graph.apply(Op::SelectNegative, &[opposite, off, at])
}

fn not(graph: &mut Graph, a: NodeId) -> NodeId {
    let [zero, one] = [0, 1].map(|value| graph.integer(value));
    by_zero(graph, a, zero, one)
}

fn and(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    let zero = graph.integer(0);
    by_zero(graph, a, b, zero)
}

fn or(graph: &mut Graph, a: NodeId, b: NodeId) -> NodeId {
    by_zero(graph, a, a, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_one_row_and_operands_fit() {
        for (index, row) in OPCODES.iter().enumerate() {
            assert!(OPCODES[..index].iter().all(|other| other.name != row.name), "{}", row.name);
            assert!(row.operands() <= 2, "{}", row.name);
        }
    }
}
