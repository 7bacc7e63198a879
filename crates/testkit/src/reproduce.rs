//! A failing case as one line that `zeroset eval` reads.
//!
//! Numbers are written so that they read back exactly. What no formula can spell is named in a
//! `note` of the line, not hidden.

use std::collections::BTreeSet;
use std::fmt::Write;
use zeroset_ir::{Axis, Constant, Graph, Node, NodeId};
use zeroset_ops::Notation;

/// Where a function was evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// At a point.
    At([f64; 3]),
    /// Over a box: per axis, its lower and upper end.
    Box([[f32; 2]; 3]),
}

/// A line of JSON for `zeroset eval -`: the function `root` of `graph`, and where.
///
/// `parameters` are bounds by number. Sub-expressions that are used several times become
/// definitions of their own, so the line is about as long as the graph.
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
            let range = |[lo, hi]: [f32; 2]| format!("[{}]", joined(&[lo, hi].map(quoted)));
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

fn joined<const N: usize>(parts: &[String; N]) -> String {
    parts.join(",")
}

fn quoted(value: impl Into<f64>) -> String {
    format!("\"{}\"", hexadecimal(value.into()))
}

/// `value` as a hexadecimal float like `0x1.8p-3`, exactly; else `inf`, `-inf` or `nan`.
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

/// The formula with its definitions, and what in it cannot be typed.
fn document(graph: &Graph, root: NodeId, parameters: &[(f64, f64)]) -> (String, BTreeSet<String>) {
    let needed = graph.reachable(&[root]);
    let mut uses = vec![0_u32; graph.len()];
    for (id, node) in graph.iter() {
        if let (true, Node::Apply(_, operands)) = (needed[id.index()], node) {
            operands.iter().for_each(|id| uses[id.index()] += 1);
        }
    }
    let mut lines = String::new();
    let mut notes = BTreeSet::new();
    let mut texts = vec![String::new(); graph.len()];
    for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        texts[id.index()] = match node {
            Node::Variable(axis) => match axis {
                Axis::X => "x".to_owned(),
                Axis::Y => "y".to_owned(),
                Axis::Z => "z".to_owned(),
            },
            Node::Parameter(number) => {
                let name = letters("p", *number as usize);
                let bounds = parameters.get(*number as usize);
                let (lo, hi) = bounds
                    .copied()
                    .unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                if lo == hi {
                    let _ = writeln!(lines, "{name} = {}", decimal(lo));
                } else {
                    let range = format!("[{}, {}]", hexadecimal(lo), hexadecimal(hi));
                    notes.insert(format!("{name} lies in {range}"));
                }
                name
            }
            Node::Constant(value) => constant(value, &mut notes),
            Node::Apply(op, operands) => {
                let row = op.row();
                let texts: Vec<&str> = operands.iter().map(|id| &*texts[id.index()]).collect();
                let text = match (row.notation, &*texts) {
                    (Notation::Infix { symbol, .. }, [a]) => format!("({symbol}{a})"),
                    (Notation::Infix { symbol, .. }, [a, b]) => format!("({a}{symbol}{b})"),
                    (Notation::Internal, _) => {
                        notes.insert(format!("{} is internal", row.name));
                        format!("{}({})", row.name, texts.join(", "))
                    }
                    (Notation::Function | Notation::Infix { .. }, _) => {
                        format!("{}({})", row.name, texts.join(", "))
                    }
                };
                if uses[id.index()] > 1 {
                    let name = letters("v", id.index());
                    let _ = writeln!(lines, "{name} = {text}");
                    name
                } else {
                    text
                }
            }
        };
    }
    lines.push_str(&texts[root.index()]);
    (lines, notes)
}

/// A name of letters only, since digits after a letter would read as a lost exponent.
fn letters(prefix: &str, mut number: usize) -> String {
    let mut name = prefix.to_owned();
    loop {
        // From `a` on, but without what might complete a known name.
        name.push(char::from(b'a' + (number % 16) as u8));
        number /= 16;
        if number == 0 {
            return name + "q";
        }
    }
}

fn constant(value: &Constant, notes: &mut BTreeSet<String>) -> String {
    let named = [
        (Constant::pi(), "pi"),
        (Constant::tau(), "tau"),
        (Constant::e(), "e"),
        (Constant::phi(), "phi"),
    ];
    if let Some((_, name)) = named.iter().find(|(constant, _)| constant == value) {
        return (*name).to_owned();
    }
    match value {
        Constant::Exact(value) if value.is_integer() => format!("({value})"),
        Constant::Exact(value) => format!("({}/{})", value.numer(), value.denom()),
        Constant::Enclosed([lo, hi]) => {
            let (lo, hi) = (f64::from_bits(*lo), f64::from_bits(*hi));
            let text = format!("enclosed({}, {})", hexadecimal(lo), hexadecimal(hi));
            notes.insert(format!("{text} is some number between these bounds"));
            text
        }
    }
}

/// All digits of a finite float.
fn decimal(value: f64) -> String {
    // The least subnormal ends at the 1074th digit.
    let digits = format!("{value:.1074}");
    let digits = digits.trim_end_matches('0').trim_end_matches('.');
    digits.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
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
    fn shared_parts_are_written_once() {
        let mut graph = Graph::new();
        let mut root = graph.variable(Axis::X);
        for _ in 0..1000 {
            root = graph.apply(Op::Mul, &[root, root]);
        }
        let line = reproduce(&graph, root, &[], &Place::At([1.0; 3]));
        assert!(line.len() < 40_000, "{}", line.len());
        assert!(
            line.starts_with(r#"{"f":"vbq = (x*x)\nvcq = (vbq*vbq)\n"#),
            "{line}"
        );
    }

    #[test]
    fn what_cannot_be_typed_is_said() {
        let mut graph = Graph::new();
        let p = graph.parameter(0);
        let q = graph.parameter(1);
        let half = graph.constant(Constant::ratio(-1, 2).expect("a ratio"));
        let pi = graph.constant(Constant::pi());
        let power = graph.apply(Op::Pow, &[pi, half]);
        let root = graph.apply(Op::WhereNonneg, &[p, power]);
        let root = graph.apply(Op::Min, &[root, q]);
        let region = Place::Box([[f32::NEG_INFINITY, 0.0], [1.0, 1.5], [0.0, 0.0]]);
        assert_eq!(
            reproduce(&graph, root, &[(0.25, 0.25), (0.0, 1.0)], &region),
            concat!(
                r#"{"f":"paq = 0.25\nmin(where_nonneg(paq, (pi^(-1/2))), pbq)","#,
                r#""box":[["-inf","0x0p0"],["0x1p0","0x1.8p0"],["0x0p0","0x0p0"]],"#,
                r#""note":"not typable as it stands: pbq lies in [0x0p0, 0x1p0]; "#,
                r#"where_nonneg is internal"}"#,
            )
        );
    }
}
