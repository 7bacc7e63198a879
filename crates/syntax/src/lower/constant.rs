//! Evaluates constant expressions: slider values, ranges, overrides.

use crate::lower::lowering::Lowering;
use zeroset_interval::Interval;
use zeroset_ir::{Constant, Graph, Node, NodeId, Variability, simplify, variabilities};
use zeroset_ops::Op;
use zeroset_parser::lex::arrangement::statements;
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::tree::ast::Expr;
use zeroset_parser::tree::builder::Builder;
use zeroset_parser::tree::scope::Scope;
use zeroset_parser::{Error, ErrorKind, Errors, Fallible, Limits, Span};

/// The value of a constant expression such as `1/3` or `2*pi`.
///
/// # Errors
/// Fails if the text is not an expression, if the expression varies, or if it has no value.
///
/// ```
/// use zeroset_syntax::constant;
/// assert_eq!(constant("0.5^2")?, zeroset_ir::Constant::ratio(1, 4).unwrap());
/// # Ok::<(), zeroset_parser::Errors>(())
/// ```
pub fn constant(text: &str) -> Result<Constant, Errors> {
    evaluate_text(text, &Limits::default()).map_err(Errors::from)
}

/// The value of a constant expression that is given as text.
pub(crate) fn evaluate_text(text: &str, limits: &Limits) -> Fallible<Constant> {
    let statements = statements(text, limits)?;
    match statements.as_slice() {
        [] => Err(Error::new(Span::at(text.len()), ErrorKind::Empty)),
        [lexed] => {
            let scope = Scope::default();
            let expr = Builder::new(text, lexed, &scope, &[], limits).only_expression()?;
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
    let mut lowering = Lowering::constant(limits);
    let root = lowering.value(expr)?;
    let value = values(&lowering.graph, &[root]).remove(0);
    value.ok_or_else(|| Error::new(expr.span, ErrorKind::UndefinedConstant))
}

/// The values of the constant nodes `roots`; `None` for a node that has no value.
pub(crate) fn values(graph: &Graph, roots: &[NodeId]) -> Vec<Option<Constant>> {
    let Ok((graph, roots)) = simplify(graph, roots, &[Interval::ENTIRE; 3], &[]) else {
        return vec![None; roots.len()];
    };
    let value = |root: &NodeId| graph.number(*root).filter(|value| value.bounds().is_bounded());
    roots.iter().map(|root| value(root).cloned()).collect()
}

/// Evaluates the ends of the range at `span`. Fails if `low` is certainly not below `high`.
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

/// Returns at most `most` constant exponents that may be integers but are not known to be. For
/// example, `log2(8)` is enclosed by two floats next to 3. A power with such an exponent is defined
/// only for bases ≥ 0, like a power with a real exponent.
pub(crate) fn near_integers(graph: &Graph, most: usize) -> Vec<NodeId> {
    let variabilities = variabilities(graph);
    let mut exponents = Vec::new();
    for (_, node) in graph.iter() {
        if let Node::Apply(Op::Pow, operands) = node
            && variabilities[operands[1].index()] == Variability::Constant
        {
            exponents.push(operands[1]);
        }
    }
    exponents.sort_unstable();
    exponents.dedup();
    let is_near = |value: &Constant| {
        let Interval { lo, hi } = value.bounds();
        let may_be_whole = value.exact().is_none() && lo.ceil() <= hi.floor();
        // Wide enclosures hold integers in any case. So do all enclosures of values beyond 2⁵³.
        may_be_whole && hi - lo < 0.5 && hi.abs() < 1e9
    };
    let values = values(graph, &exponents);
    let near = exponents.into_iter().zip(&values);
    near.filter(|(_, value)| value.as_ref().is_some_and(is_near))
        .map(|(exponent, _)| exponent)
        .take(most)
        .collect()
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
