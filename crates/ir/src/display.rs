//! Printing of expressions in the project's language.
//!
//! The text reads back as the same graph, except for constants known only by their bounds. Printing
//! does not recurse, so a deep graph cannot overflow the stack. [`TEXT_LIMIT`] limits the length.

use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use zeroset_ops::{Class, Notation};

/// Length in bytes at which text is cut off with `…`. A shared expression is printed at each use,
/// so text may be exponentially longer than its graph.
pub const TEXT_LIMIT: usize = 1 << 12;

/// Operator precedence of a text. The text needs brackets in a context of higher precedence.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Precedence {
    /// A sum or a difference.
    Sum,
    /// A term with a sign.
    Sign,
    /// A product or a quotient.
    Product,
    /// A power.
    Power,
    /// A number, a name or a call, or anything else that never needs brackets.
    Atom,
}

enum Piece {
    Text(String),
    Node(NodeId, Precedence),
}

/// The text of node `id`, with only the brackets that reading back needs. Parameter n is called
/// `names[n]`; if `names` has fewer entries, `p0`, `p1`, ….
pub fn display(graph: &Graph, id: NodeId, names: &[&str]) -> String {
    let mut text = String::new();
    let mut pending = vec![Piece::Node(id, Precedence::Sum)];
    while let Some(piece) = pending.pop() {
        if text.len() > TEXT_LIMIT {
            text.push('…');
            break;
        }
        match piece {
            Piece::Text(piece) => text.push_str(&piece),
            Piece::Node(id, place) => {
                let (precedence, pieces) = spell(graph, id, names);
                let bracketed = precedence < place;
                if bracketed {
                    pending.push(Piece::Text(")".into()));
                }
                pending.extend(pieces.into_iter().rev());
                if bracketed {
                    pending.push(Piece::Text("(".into()));
                }
            }
        }
    }
    text
}

/// The text of one node: its precedence and its pieces.
fn spell(graph: &Graph, id: NodeId, names: &[&str]) -> (Precedence, Vec<Piece>) {
    let text = |text: &str| Piece::Text(text.into());
    match graph.node(id) {
        Node::Variable(axis) => (Precedence::Atom, vec![text(axis.name())]),
        Node::Parameter(number) => {
            let name = names
                .get(*number as usize)
                .map_or_else(|| format!("p{number}"), |name| (*name).to_owned());
            (Precedence::Atom, vec![Piece::Text(name)])
        }
        Node::Constant(constant) => {
            let (precedence, digits) = number(constant);
            (precedence, vec![Piece::Text(digits)])
        }
        Node::Apply(op, operands) => {
            let symbol = match op.row().notation {
                Notation::Infix { symbol, .. } => symbol,
                Notation::Function | Notation::Internal => op.row().name,
            };
            let infix = |left, space: &str, right, precedence| {
                let pieces = vec![
                    Piece::Node(operands[0], left),
                    Piece::Text(format!("{space}{symbol}{space}")),
                    Piece::Node(operands[1], right),
                ];
                (precedence, pieces)
            };
            match op.row().class {
                Class::Negation => (
                    Precedence::Sign,
                    vec![text("-"), Piece::Node(operands[0], Precedence::Product)],
                ),
                Class::Sum => infix(Precedence::Sum, " ", Precedence::Product, Precedence::Sum),
                Class::Product | Class::Quotient => {
                    infix(Precedence::Product, "", Precedence::Power, Precedence::Product)
                }
                Class::Power => infix(Precedence::Atom, "", Precedence::Power, Precedence::Power),
                Class::Square
                | Class::Remainder
                | Class::FunctionOfTwo
                | Class::Extremum
                | Class::Choice
                | Class::Fallback
                | Class::Restriction(_)
                | Class::Function(_) => {
                    debug_assert!(!matches!(op.row().notation, Notation::Infix { .. }));
                    let mut pieces = vec![text(symbol), text("(")];
                    for (index, operand) in operands.iter().enumerate() {
                        if index > 0 {
                            pieces.push(text(", "));
                        }
                        pieces.push(Piece::Node(*operand, Precedence::Sum));
                    }
                    pieces.push(text(")"));
                    (Precedence::Atom, pieces)
                }
            }
        }
    }
}

/// The precedence and text of a constant: a short decimal, a quotient, a name or bounds.
fn number(constant: &Constant) -> (Precedence, String) {
    let value = match constant {
        Constant::Exact(value) => value,
        Constant::Named(name) => return (Precedence::Atom, name.name().into()),
        Constant::Enclosed(_) => {
            let bounds = constant.bounds();
            return (Precedence::Atom, format!("[{:?}, {:?}]", bounds.lo, bounds.hi));
        }
    };
    let sign = if value.is_negative() { Precedence::Sign } else { Precedence::Atom };
    match decimal(value) {
        Some(text) => (sign, text),
        None => (Precedence::Product, format!("{}/{}", value.numer(), value.denom())),
    }
}

fn decimal(value: &BigRational) -> Option<String> {
    /// Largest number of digits after the point. Longer fractions read better as quotients.
    const PLACES: usize = 6;
    let mut denominator = value.denom().clone();
    let mut places = 0;
    let mut scaled = value.clone();
    while !denominator.is_one() {
        if places == PLACES {
            return None;
        }
        places += 1;
        scaled *= BigRational::from_integer(10.into());
        denominator.clone_from(scaled.denom());
    }
    if places == 0 {
        return Some(value.numer().to_string());
    }
    let digits = format!("{:0>width$}", scaled.numer().abs().to_string(), width = places + 1);
    let (whole, fraction) = digits.split_at(digits.len() - places);
    let sign = if value.is_negative() && !value.is_zero() { "-" } else { "" };
    Some(format!("{sign}{whole}.{fraction}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constant::NamedConstant;
    use crate::graph::Axis;
    use zeroset_ops::Op;

    #[test]
    fn brackets_are_as_few_as_read_back() {
        let mut g = Graph::new();
        let x = g.variable(Axis::X);
        let y = g.variable(Axis::Y);
        let a = g.parameter(0);
        let b = g.parameter(1);
        let sum = g.apply(Op::Add, &[x, y]);
        let less = g.apply(Op::Sub, &[a, sum]);
        assert_eq!(display(&g, less, &["a"]), "a - (x + y)");
        let product = g.apply(Op::Mul, &[sum, b]);
        assert_eq!(display(&g, product, &["a"]), "(x + y)*p1");
        let product = g.apply(Op::Mul, &[x, product]);
        assert_eq!(display(&g, product, &["a", "b"]), "x*((x + y)*b)");
        let neg = g.apply(Op::Neg, &[x]);
        let two = g.integer(2);
        let square = g.apply(Op::Pow, &[neg, two]);
        assert_eq!(display(&g, square, &[]), "(-x)^2");
        let neg = g.apply(Op::Neg, &[square]);
        assert_eq!(display(&g, neg, &[]), "-(-x)^2");
        let tower = g.apply(Op::Pow, &[x, square]);
        assert_eq!(display(&g, tower, &[]), "x^(-x)^2");
        let tower = g.apply(Op::Pow, &[square, x]);
        assert_eq!(display(&g, tower, &[]), "((-x)^2)^x");
        let min = g.apply(Op::Min, &[sum, x]);
        assert_eq!(display(&g, min, &[]), "min(x + y, x)");
    }

    #[test]
    fn numbers_read_back() {
        let text = |c: Constant| number(&c).1;
        assert_eq!(text(Constant::integer(-12)), "-12");
        assert_eq!(text(Constant::ratio(-1, 20).unwrap()), "-0.05");
        assert_eq!(text(Constant::ratio(5, 2).unwrap()), "2.5");
        assert_eq!(text(Constant::ratio(1, 3).unwrap()), "1/3");
        assert_eq!(text(Constant::Named(NamedConstant::Pi)), "pi");
        let mut g = Graph::new();
        let third = g.constant(Constant::ratio(1, 3).unwrap());
        let x = g.variable(Axis::X);
        let product = g.apply(Op::Mul, &[x, third]);
        assert_eq!(display(&g, product, &[]), "x*(1/3)");
    }

    #[test]
    fn deep_and_exponential_expressions_end() {
        let mut g = Graph::new();
        let mut root = g.variable(Axis::X);
        for _ in 0..100_000 {
            root = g.apply(Op::Sin, &[root]);
        }
        assert!(display(&g, root, &[]).ends_with('…'));
        let mut root = g.variable(Axis::X);
        for _ in 0..200 {
            root = g.apply(Op::Add, &[root, root]);
        }
        assert!(display(&g, root, &[]).len() < TEXT_LIMIT + 100);
    }
}
