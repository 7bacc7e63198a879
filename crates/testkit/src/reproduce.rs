//! Printing of a failing case as one line that `zeroset eval` reads.
//!
//! Numbers are written so that they read back exactly. Parts that no formula can express are listed
//! in a `note` of the line.

use std::collections::BTreeSet;
use std::fmt::Write;
use zeroset_eval::Real;
use zeroset_interval::Format;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId};
use zeroset_ops::Notation;

/// Greatest number of nodes in one expression; longer ones are split into definitions. It is far
/// below the text limit of `zeroset_ir::display` and the nesting limit of the parser.
const LONGEST_PIECE: usize = 100;

/// The point or box at which a function was evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// A point.
    At([f64; 3]),
    /// A box: per axis, its lower and upper end.
    Box([[f64; 2]; 3]),
}

impl Place {
    /// Returns the place for a box of `f32` or `f64`.
    pub fn over<T: Real>(region: &[[T; 2]; 3]) -> Self {
        Self::Box(region.map(|range| range.map(Into::into)))
    }
}

/// Returns a line of JSON for `zeroset eval -`: the function `root` of `graph`, and the place.
///
/// `parameters` holds the bounds of each parameter, by number. Sub-expressions that are used
/// several times become definitions, so the line is about as long as the graph.
///
/// ```
/// use zeroset_ir::{Axis, Graph};
/// use zeroset_testkit::{Place, reproduce};
///
/// let mut graph = Graph::new();
/// let x = graph.variable(Axis::X);
/// let root = graph.apply(zeroset_ops::Op::Sin, &[x]);
/// let line = reproduce(&graph, root, &[], &Place::At([0.5, -1.0, 0.0]));
/// assert_eq!(line, r#"{"f":"sin(x)","at":["0x1p-1","-0x1p0","0x0p0"]}"#);
/// ```
///
/// # Panics
/// If `root` does not belong to `graph`.
pub fn reproduce(graph: &Graph, root: NodeId, parameters: &[(f64, f64)], place: &Place) -> String {
    let (formula, notes) = document(graph, root, parameters);
    let place = match place {
        Place::At(point) => format!("\"at\":[{}]", joined(&point.map(quoted))),
        Place::Box(region) => {
            let range = |[lo, hi]: [f64; 2]| format!("[{}]", joined(&[lo, hi].map(quoted)));
            format!("\"box\":[{}]", joined(&region.map(range)))
        }
    };
    let formula = formula.replace('\n', "\\n");
    if notes.is_empty() {
        format!("{{\"f\":\"{formula}\",{place}}}")
    } else {
        let notes = notes.into_iter().collect::<Vec<_>>().join("; ");
        format!("{{\"f\":\"{formula}\",{place},\"note\":\"not typable as it stands: {notes}\"}}")
    }
}

/// Like [`reproduce`]. If `T` is `f64`, the line also selects this precision.
///
/// # Panics
/// If `root` does not belong to `graph`.
pub fn reproduce_in<T: Real>(
    graph: &Graph,
    root: NodeId,
    parameters: &[(f64, f64)],
    place: &Place,
) -> String {
    let line = reproduce(graph, root, parameters, place);
    match T::FORMAT {
        Format::F32 => line,
        Format::F64 => line.replacen('{', "{\"precision\":\"f64\",", 1),
    }
}

/// Returns the function `root` of `graph` as a text that reads back as the same function, or `None`
/// if part of it cannot be typed.
///
/// # Panics
/// If `root` does not belong to `graph`.
pub fn typed(graph: &Graph, root: NodeId, parameters: &[(f64, f64)]) -> Option<String> {
    let (formula, notes) = document(graph, root, parameters);
    notes.is_empty().then_some(formula)
}

fn joined<const N: usize>(parts: &[String; N]) -> String {
    parts.join(",")
}

fn quoted(value: f64) -> String {
    format!("\"{}\"", hexadecimal(value))
}

/// Returns `value` exactly as a hexadecimal float like `0x1.8p-3`, or as `inf`, `-inf` or `nan`.
pub fn hexadecimal(value: f64) -> String {
    if value.is_nan() {
        return "nan".to_owned();
    }
    let sign = if value.is_sign_negative() { "-" } else { "" };
    if value.is_infinite() {
        return format!("{sign}inf");
    }
    let bits = value.to_bits();
    let (biased, fraction) = ((bits >> 52) & 0x7ff, bits & ((1 << 52) - 1));
    let (whole, exponent) = match (biased, fraction) {
        (0, 0) => (0, 0),
        (0, _) => (0, -1022),
        _ => (1, biased as i32 - 1023),
    };
    let digits = format!("{fraction:013x}");
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    format!("{sign}0x{whole}{point}{digits}p{exponent}")
}

/// A text under construction.
///
/// Shared sub-expressions and expressions too long for one line become definitions. In the graph
/// `pieces`, a parameter with the definition's name stands for the expression.
#[derive(Default)]
struct Document {
    pieces: Graph,
    names: Vec<String>,
    definitions: String,
    notes: BTreeSet<String>,
}

impl Document {
    /// Adds a parameter to `pieces` and returns it with its name.
    fn name(&mut self, prefix: &str, number: usize) -> (NodeId, String) {
        let name = letters(prefix, number);
        self.names.push(name.clone());
        (self.pieces.parameter(self.names.len() as u32 - 1), name)
    }

    fn text(&self, id: NodeId) -> String {
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        zeroset_ir::display(&self.pieces, id, &names)
    }

    fn define(&mut self, prefix: &str, number: usize, text: &str) -> NodeId {
        let (id, name) = self.name(prefix, number);
        let _ = writeln!(self.definitions, "{name} = {text}"); // a string accepts everything
        id
    }

    fn parameter(&mut self, number: usize, bounds: Option<&(f64, f64)>) -> NodeId {
        match bounds {
            Some((lo, hi)) if lo == hi => self.define("p", number, &decimal(*lo)),
            bounds => {
                let (lo, hi) = bounds.copied().unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                let (id, name) = self.name("p", number);
                let range = format!("[{}, {}]", hexadecimal(lo), hexadecimal(hi));
                self.notes.insert(format!("{name} lies in {range}"));
                id
            }
        }
    }

    fn constant(&mut self, value: &Constant) -> NodeId {
        if let Constant::Enclosed(_) = value {
            let bounds = value.bounds();
            let range = format!("[{}, {}]", hexadecimal(bounds.lo), hexadecimal(bounds.hi));
            self.notes.insert(format!("a constant lies in {range}"));
        }
        self.pieces.constant(value.clone())
    }
}

/// Returns the formula with its definitions, and notes on the parts that cannot be typed.
fn document(graph: &Graph, root: NodeId, parameters: &[(f64, f64)]) -> (String, BTreeSet<String>) {
    let needed = graph.reachable(&[root]);
    let mut uses = vec![0_u32; graph.len()];
    for (id, node) in graph.iter() {
        if let (true, Node::Apply(_, operands)) = (needed[id.index()], node) {
            operands.iter().for_each(|id| uses[id.index()] += 1);
        }
    }
    let mut document = Document::default();
    // Per node: its copy in `pieces`, and the number of nodes that its text spells out.
    let mut copies: Vec<(NodeId, usize)> = Vec::with_capacity(graph.len());
    let origin = document.pieces.variable(Axis::X);
    for (id, node) in graph.iter() {
        let copy = match node {
            _ if !needed[id.index()] => (origin, 1),
            Node::Variable(axis) => (document.pieces.variable(*axis), 1),
            Node::Parameter(number) => {
                let number = *number as usize;
                (document.parameter(number, parameters.get(number)), 1)
            }
            Node::Constant(value) => (document.constant(value), 1),
            Node::Apply(op, operands) => {
                if op.row().notation == Notation::Internal {
                    document.notes.insert(format!("{} is internal", op.row().name));
                }
                let ids: Vec<NodeId> = operands.iter().map(|id| copies[id.index()].0).collect();
                let lengths = operands.iter().map(|id| copies[id.index()].1);
                let length = 1 + lengths.sum::<usize>();
                let copy = document.pieces.apply(*op, &ids);
                if uses[id.index()] > 1 || length > LONGEST_PIECE {
                    let text = document.text(copy);
                    (document.define("v", id.index(), &text), 1)
                } else {
                    (copy, length)
                }
            }
        };
        copies.push(copy);
    }
    let formula = document.text(copies[root.index()].0);
    (document.definitions + &formula, document.notes)
}

/// Returns a name of letters only, since digits could be read as a mistyped exponent.
fn letters(prefix: &str, mut number: usize) -> String {
    let mut name = prefix.to_owned();
    loop {
        name.push(char::from(b'a' + (number % 16) as u8));
        number /= 16;
        if number == 0 {
            // No name of the language ends in q, so there is no conflict.
            return name + "q";
        }
    }
}

/// Returns a finite float in decimal, with all its digits.
fn decimal(value: f64) -> String {
    // The last digit of the least subnormal is the 1074th decimal.
    let digits = format!("{value:.1074}");
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    digits.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_ir::NamedConstant;
    use zeroset_ops::Op;

    #[test]
    fn hexadecimal_floats_are_exact() {
        for (value, text) in [
            (0.0, "0x0p0"),
            (-0.0, "-0x0p0"),
            (0.1875, "0x1.8p-3"),
            (-1.0, "-0x1p0"),
            (0.1, "0x1.999999999999ap-4"),
            (f64::MAX, "0x1.fffffffffffffp1023"),
            (f64::from_bits(1), "0x0.0000000000001p-1022"),
            (f64::from(f32::from_bits(1)), "0x1p-149"),
            (f64::NEG_INFINITY, "-inf"),
            (f64::NAN, "nan"),
        ] {
            assert_eq!(hexadecimal(value), text);
        }
    }

    #[test]
    fn the_precision_is_part_of_the_line() {
        let mut graph = Graph::new();
        let x = graph.variable(Axis::X);
        let place = Place::over(&[[0.5, 1.0]; 3]);
        let single = reproduce_in::<f32>(&graph, x, &[], &place);
        assert_eq!(single, reproduce(&graph, x, &[], &place));
        let double = reproduce_in::<f64>(&graph, x, &[], &place);
        assert_eq!(double, single.replace("{\"f\"", "{\"precision\":\"f64\",\"f\""));
    }

    #[test]
    fn shared_parts_are_written_once() {
        let mut graph = Graph::new();
        let mut root = graph.variable(Axis::X);
        for _ in 0..1000 {
            root = graph.apply(Op::Mul, &[root, root]);
        }
        let line = reproduce(&graph, root, &[], &Place::At([1.0; 3]));
        assert!(line.len() < 40_000, "{}", line.len());
        assert!(line.starts_with(r#"{"f":"vbq = x*x\nvcq = vbq*vbq\n"#), "{line}");
    }

    #[test]
    fn what_cannot_be_typed_is_said() {
        let mut graph = Graph::new();
        let p = graph.parameter(0);
        let q = graph.parameter(1);
        let half = graph.constant(Constant::ratio(-1, 2).expect("a ratio"));
        let pi = graph.constant(Constant::Named(NamedConstant::Pi));
        let power = graph.apply(Op::Pow, &[pi, half]);
        let root = graph.apply(Op::WhereNonneg, &[p, power]);
        let root = graph.apply(Op::Min, &[root, q]);
        let region = Place::Box([[f64::NEG_INFINITY, 0.0], [1.0, 1.5], [0.0, 0.0]]);
        assert_eq!(
            reproduce(&graph, root, &[(0.25, 0.25), (0.0, 1.0)], &region),
            concat!(
                r#"{"f":"paq = 0.25\nmin(where_nonneg(paq, pi^(-0.5)), pbq)","#,
                r#""box":[["-inf","0x0p0"],["0x1p0","0x1.8p0"],["0x0p0","0x0p0"]],"#,
                r#""note":"not typable as it stands: pbq lies in [0x0p0, 0x1p0]; "#,
                r#"where_nonneg is internal"}"#,
            )
        );
    }
}
