//! Constant expressions: slider values, ranges, overrides.
//!
//! Sums, products, quotients and whole powers of decimals stay exact; everything else is enclosed.

use crate::ast::{Expr, ExprKind, Function, Value};
use crate::build::Builder;
use crate::error::{Error, ErrorKind, Errors, Fallible};
use crate::limits::Limits;
use crate::lower::Lowering;
use crate::scan::scan;
use crate::scope::Scope;
use crate::span::Span;
use crate::spelling::short_name;
use num_rational::BigRational;
use num_traits::{One, Zero};
use rustc_hash::FxHashMap;
use zeroset_interval::{Facts, Interval, fold};
use zeroset_ir::{Constant, Graph, Node, NodeId, Operands, simplify};
use zeroset_ops::Op;

/// Exponents up to this size are raised exactly; a power of a two-digit number then has a few
/// hundred bits.
const EXACT_EXPONENT: i64 = 128;

/// The value of a constant expression such as `1/3` or `2*pi`.
///
/// # Errors
/// What is wrong with the text, or that it varies, or has no value.
///
/// ```
/// use zeroset_syntax::constant;
/// assert_eq!(constant("0.5^2")?, zeroset_ir::Constant::ratio(1, 4).unwrap());
/// # Ok::<(), zeroset_syntax::Errors>(())
/// ```
pub fn constant(text: &str) -> Result<Constant, Errors> {
    evaluate_text(text, &Limits::default()).map_err(Errors::from)
}

/// The value of a constant expression given as text.
pub(crate) fn evaluate_text(text: &str, limits: &Limits) -> Fallible<Constant> {
    let pieces = scan(text, limits)?;
    match pieces.as_slice() {
        [] => Err(Error::new(Span::at(text.len()), ErrorKind::Empty)),
        [piece] => {
            let scope = Scope::default();
            let expr = Builder::new(text, piece, &scope, &[], limits).only_expression()?;
            evaluate(&expr, limits)
        }
        [_, second, ..] => {
            let found = short_name(&text[second.span.range()]);
            Err(Error::new(second.span, ErrorKind::Unexpected { found }))
        }
    }
}

/// The value of a constant expression.
pub(crate) fn evaluate(expr: &Expr, limits: &Limits) -> Fallible<Constant> {
    if let Some((name, span)) = varying(expr) {
        return Err(Error::new(span, ErrorKind::NotConstant { name }));
    }
    let mut lowering = Lowering::new(FxHashMap::default(), None, limits);
    let root = lowering.value(expr)?;
    let value = value(&lowering.graph, root).filter(|value| value.bounds().is_bounded());
    value.ok_or_else(|| Error::new(expr.span, ErrorKind::UndefinedConstant))
}

/// The ends of a range, which stands at `span`: the first must be below the second.
pub(crate) fn evaluate_range(
    low: &Expr,
    high: &Expr,
    span: Span,
    limits: &Limits,
) -> Fallible<(Constant, Constant)> {
    let (low, high) = (evaluate(low, limits)?, evaluate(high, limits)?);
    if low.bounds().lo >= high.bounds().hi {
        return Err(Error::new(span, ErrorKind::EmptyRange));
    }
    Ok((low, high))
}

/// The first name in `expr` that is not a constant of the language.
fn varying(expr: &Expr) -> Option<(String, Span)> {
    match &expr.kind {
        ExprKind::Number(_) | ExprKind::Name(Value::Constant(_)) => None,
        ExprKind::Name(value) => Some((value.name().to_owned(), expr.span)),
        ExprKind::Negate(inner) | ExprKind::Not(inner) => varying(inner),
        ExprKind::Sum(first, rest) => {
            varying(first).or_else(|| rest.iter().find_map(|(_, e)| varying(e)))
        }
        ExprKind::Product(first, rest) => {
            varying(first).or_else(|| rest.iter().find_map(|(_, e)| varying(e)))
        }
        ExprKind::Compare(first, rest) => {
            varying(first).or_else(|| rest.iter().find_map(|(_, e)| varying(e)))
        }
        ExprKind::Power(base, exponent) => varying(base).or_else(|| varying(exponent)),
        ExprKind::Call(Function::Defined(name), _) => Some((name.clone(), expr.span)),
        ExprKind::Call(_, items) | ExprKind::And(items) | ExprKind::Or(items) => {
            items.iter().find_map(varying)
        }
    }
}

/// The value of a node that depends on no coordinate and no parameter; `None` where it has none.
fn value(graph: &Graph, root: NodeId) -> Option<Constant> {
    let (value, facts) = values(graph, &[root]).into_iter().nth(root.index())??;
    facts.has(Facts::DEFINED).then_some(value)
}

/// The values of all nodes that `roots` need, by index; `None` for others and for what varies.
fn values(graph: &Graph, roots: &[NodeId]) -> Vec<Option<(Constant, Facts)>> {
    let needed = graph.reachable(roots);
    let mut values: Vec<Option<(Constant, Facts)>> = Vec::with_capacity(graph.len());
    for (id, node) in graph.iter() {
        let computed = match node {
            _ if !needed[id.index()] => None,
            Node::Constant(constant) => Some((constant.clone(), Facts::TOTAL)),
            Node::Variable(_) | Node::Parameter(_) => None,
            Node::Apply(op, operands) => apply(*op, operands, &values),
        };
        values.push(computed);
    }
    values
}

/// At most `most` exponents without coordinates and parameters whose value may be an integer, but
/// is not known to be one: `log2(8)` is enclosed by two floats next to 3, and a power with it is
/// that of a real number, defined for bases >= 0 only.
pub(crate) fn near_integers(graph: &Graph, most: usize) -> Vec<NodeId> {
    let exponents: Vec<NodeId> = graph
        .iter()
        .filter_map(|(_, node)| match node {
            Node::Apply(Op::Pow, operands) => Some(operands[1]),
            Node::Variable(_) | Node::Parameter(_) | Node::Constant(_) | Node::Apply(..) => None,
        })
        .filter(|exponent| matches!(graph.node(*exponent), Node::Apply(..)))
        .collect();
    let values = values(graph, &exponents);
    let is_near = |id: &NodeId| {
        values[id.index()].as_ref().is_some_and(|(value, facts)| {
            let Interval { lo, hi } = value.bounds();
            let may_be_whole = value.exact().is_none() && lo.ceil() <= hi.floor();
            // A wide range tells nothing, and floats beyond 2⁵³ are all integers.
            facts.has(Facts::DEFINED) && may_be_whole && hi - lo < 0.5 && hi.abs() < 1e9
        })
    };
    let mut near: Vec<NodeId> = exponents.into_iter().filter(is_near).collect();
    near.sort_unstable();
    near.dedup();
    near.truncate(most);
    // Simplified, it may be known after all, as `pi/pi` is.
    near.retain(|id| {
        let simplified = simplify(graph, &[*id], &[Interval::ENTIRE; 3], &[]);
        simplified.is_ok_and(|(graph, roots)| match graph.node(roots[0]) {
            Node::Constant(value) => value.as_integer().is_none(),
            Node::Variable(_) | Node::Parameter(_) | Node::Apply(..) => true,
        })
    });
    near
}

fn apply(
    op: Op,
    operands: &Operands,
    values: &[Option<(Constant, Facts)>],
) -> Option<(Constant, Facts)> {
    let known: Option<Vec<&(Constant, Facts)>> =
        operands.iter().map(|id| values[id.index()].as_ref()).collect();
    let known = known?;
    let all_total = known.iter().all(|(_, facts)| facts.has(Facts::TOTAL));
    let exact: Option<Vec<&BigRational>> =
        known.iter().map(|(constant, _)| constant.exact()).collect();
    if let (true, Some(value)) = (all_total, exact.and_then(|exact| exactly(op, &exact))) {
        return Some((Constant::rational(value), Facts::TOTAL));
    }
    let boxes: Vec<(Interval, Facts)> =
        known.iter().map(|(constant, facts)| (constant.bounds(), *facts)).collect();
    let (bounds, facts) = fold(op, &boxes);
    Some((Constant::enclosed(bounds), facts))
}

/// The exact result of arithmetic on rational numbers, where it is rational and of moderate size.
fn exactly(op: Op, operands: &[&BigRational]) -> Option<BigRational> {
    match (op, operands) {
        (Op::Neg, [a]) => Some(-*a),
        (Op::Add, [a, b]) => Some(*a + *b),
        (Op::Sub, [a, b]) => Some(*a - *b),
        (Op::Mul, [a, b]) => Some(*a * *b),
        (Op::Div, [a, b]) if !b.is_zero() => Some(*a / *b),
        (Op::Pow, [a, b]) if b.is_integer() => {
            let exponent: i64 = b.numer().try_into().ok()?;
            if exponent.abs() > EXACT_EXPONENT || (a.is_zero() && exponent < 0) {
                return None;
            }
            let power = num_traits::pow((*a).clone(), exponent.unsigned_abs() as usize);
            Some(if exponent < 0 { BigRational::one() / power } else { power })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arithmetic_on_decimals_is_exact() {
        for (text, numerator, denominator) in [
            ("0.1 + 0.2", 3, 10),
            ("1/3*3", 1, 1),
            ("-2^2", -4, 1),
            ("2^-3", 1, 8),
            ("(1/3)^2", 1, 9),
            ("0^0", 1, 1),
            ("-(-5)", 5, 1),
        ] {
            let expected = Constant::ratio(numerator, denominator).expect("not zero");
            assert_eq!(constant(text).expect(text), expected, "{text}");
        }
    }

    #[test]
    fn other_values_are_enclosed_tightly() {
        for (text, value) in [
            ("2*pi", std::f64::consts::TAU),
            ("sqrt(2)", std::f64::consts::SQRT_2),
            ("(1+sqrt(5))/2", 1.618_033_988_749_895),
            ("sin(0.5)^2 + cos(0.5)^2", 1.0),
            ("max(1, 2, tau)", std::f64::consts::TAU),
            ("2^0.5", std::f64::consts::SQRT_2),
        ] {
            let bounds = constant(text).expect(text).bounds();
            assert!(bounds.lo <= value && value <= bounds.hi, "{text}: {bounds:?}");
            assert!(bounds.width() < 1e-13, "{text}: {bounds:?}");
        }
    }

    #[test]
    fn what_varies_or_has_no_value_is_refused() {
        for text in [
            "x", "t", "r", "1/0", "sqrt(-1)", "ln(0)", "9^9^9^9", "1e400", "", "1,2", "1 < 2",
            "1; 2", "0^-1",
        ] {
            assert!(constant(text).is_err(), "{text}");
        }
    }
}
