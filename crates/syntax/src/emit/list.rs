//! Writes an expression list.

use super::number::described;
use super::{EmitError, Format, function, parameter_error};
use crate::document::reading::Document;
use crate::list::opcode::{Meaning, OPCODES};
use rustc_hash::FxHashMap;
use std::fmt::Write as _;
use zeroset_ir::{Constant, Graph, Node, NodeId};
use zeroset_ops::Op;

/// Largest whole exponent that is written as products.
const LARGEST_EXPONENT: i64 = 64;

/// Writes the only surface of `document`.
pub(super) fn emit(document: &Document) -> Result<String, EmitError> {
    let graph = &document.graph;
    let root = function(document, &document.surfaces[0]);
    let mut writer = Writer { graph, text: String::new(), names: FxHashMap::default(), count: 0 };
    let needed = graph.reachable(&[root]);
    let mut places: Vec<u32> = vec![0; graph.len()];
    // Writes only the nodes that the root needs in the format's operations, in the order of the
    // graph. A constant is written at its first use, so constants in exponents get no line.
    for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        places[id.index()] = match node {
            Node::Constant(_) => continue,
            Node::Variable(axis) => writer.line(&format!("var-{}", axis.name())),
            Node::Parameter(number) => {
                return Err(parameter_error(document, Format::Vm, *number));
            }
            Node::Apply(op, operands) => writer.apply(*op, operands, &places)?,
        };
    }
    // The last line is the function. A constant function has no line yet. A function whose line is
    // not the last one, because an equal line came first, is written again.
    let last = writer.value(root, &places)?;
    if last + 1 != writer.count {
        let zero = writer.constant(&Constant::integer(0))?;
        writer.names.clear();
        writer.line(&format!("add _{last:x} _{zero:x}"));
    }
    Ok(writer.text)
}

struct Writer<'a> {
    graph: &'a Graph,
    text: String,
    /// The number of each line, by its operation and operands.
    names: FxHashMap<String, u32>,
    count: u32,
}

impl Writer<'_> {
    /// The number of the line with this operation. Writes the line unless there is one.
    fn line(&mut self, operation: &str) -> u32 {
        if let Some(number) = self.names.get(operation) {
            return *number;
        }
        let number = self.count;
        let _ = writeln!(self.text, "_{number:x} {operation}");
        self.names.insert(operation.to_owned(), number);
        self.count += 1;
        number
    }

    fn constant(&mut self, constant: &Constant) -> Result<u32, EmitError> {
        let digits = constant.digits();
        let digits = digits.ok_or_else(|| EmitError::missing(Format::Vm, described(constant)))?;
        Ok(self.line(&format!("const {digits}")))
    }

    /// The number of a node's line.
    fn value(&mut self, id: NodeId, places: &[u32]) -> Result<u32, EmitError> {
        match self.graph.node(id) {
            Node::Constant(constant) => self.constant(constant),
            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => Ok(places[id.index()]),
        }
    }

    fn unary(&mut self, name: &str, a: u32) -> u32 {
        self.line(&format!("{name} _{a:x}"))
    }

    fn binary(&mut self, name: &str, a: u32, b: u32) -> u32 {
        self.line(&format!("{name} _{a:x} _{b:x}"))
    }

    /// Writes the lines of an operation. Returns the number of the last one.
    fn apply(&mut self, op: Op, operands: &[NodeId], places: &[u32]) -> Result<u32, EmitError> {
        let is_native =
            |meaning: &Meaning| matches!(meaning, Meaning::Native(native) if *native == op);
        if let Some(row) = OPCODES.iter().find(|row| is_native(&row.meaning)) {
            let a = self.value(operands[0], places)?;
            return Ok(match operands.get(1) {
                None => self.unary(row.name, a),
                Some(b) => {
                    let b = self.value(*b, places)?;
                    self.binary(row.name, a, b)
                }
            });
        }
        if op == Op::Pow
            && let Some(exponent) = self.graph.number(operands[1]).and_then(Constant::as_integer)
            && (1..=LARGEST_EXPONENT).contains(&exponent.abs())
        {
            let base = self.value(operands[0], places)?;
            let power = self.power(base, exponent.unsigned_abs());
            if exponent > 0 {
                return Ok(power);
            }
            let one = self.constant(&Constant::integer(1))?;
            return Ok(self.binary("div", one, power));
        }
        if op == Op::Sign {
            if let Some([a, b]) = applied(self.graph, operands[0], Op::Sub) {
                let [a, b] = [self.value(*a, places)?, self.value(*b, places)?];
                return Ok(self.binary("compare", a, b));
            }
            let a = self.value(operands[0], places)?;
            let zero = self.constant(&Constant::integer(0))?;
            return Ok(self.binary("compare", a, zero));
        }
        if let Some((name, operands)) = composed(self.graph, op, operands) {
            let a = self.value(operands[0], places)?;
            return Ok(match operands.get(1) {
                None => self.unary(name, a),
                Some(b) => {
                    let b = self.value(*b, places)?;
                    self.binary(name, a, b)
                }
            });
        }
        let what = if op == Op::Pow {
            let exponent = self.graph.number(operands[1]).map(described);
            format!("a power whose exponent is {}", exponent.unwrap_or("not constant".to_owned()))
        } else {
            format!("`{}`: {}", op.row().name, op.row().doc)
        };
        Err(EmitError::missing(Format::Vm, what))
    }

    /// A power by squares and products.
    fn power(&mut self, base: u32, exponent: u64) -> u32 {
        let mut power = base;
        // All bits below the highest one, from high to low.
        for bit in (0..exponent.ilog2()).rev() {
            power = self.unary("square", power);
            if exponent >> bit & 1 == 1 {
                power = self.binary("mul", power, base);
            }
        }
        power
    }
}

/// The operands of a node that applies `op`.
fn applied(graph: &Graph, node: NodeId, op: Op) -> Option<&[NodeId]> {
    match graph.node(node) {
        Node::Apply(found, operands) if *found == op => Some(operands),
        Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => None,
    }
}

/// The list operation that is read as this operation, and its operands. `None` if no list operation
/// is read as this operation.
fn composed(graph: &Graph, op: Op, operands: &[NodeId]) -> Option<(&'static str, Vec<NodeId>)> {
    if op == Op::SelectNegative {
        let size = applied(graph, applied(graph, operands[0], Op::Neg)?[0], Op::Abs)?[0];
        let is = |node: NodeId, value: i64| {
            graph.number(node).and_then(Constant::as_integer) == Some(value)
        };
        return Some(match (operands[1], operands[2]) {
            (off, at) if is(off, 0) && is(at, 1) => ("not", vec![size]),
            (off, at) if off == size => ("or", vec![size, at]),
            (off, at) if is(at, 0) => ("and", vec![size, off]),
            _ => return None,
        });
    }
    if op == Op::Mod {
        if graph.number(operands[1]).is_some_and(|b| b.bounds().lo > 0.0) {
            return Some(("mod", operands.to_vec()));
        }
        let size = applied(graph, operands[1], Op::Abs)?;
        return Some(("mod", vec![operands[0], size[0]]));
    }
    None
}
