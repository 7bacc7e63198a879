//! What is one factor whatever surrounds it: brackets, braces, bars, fractions, roots, choices.

use crate::ast::{Expr, ExprKind, Function, ProductSign};
use crate::build::{Builder, number_only, product_of};
use crate::error::{Error, ErrorKind, Fallible};
use crate::grammar::{Pair, Rule};
use crate::scope::Callee;
use crate::span::Span;
use crate::spelling::vulgar;
use zeroset_ops::Op;

impl Builder<'_> {
    /// Round or square brackets around one expression.
    pub(crate) fn group(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        let is_square = pair.as_str().starts_with('[');
        let whole = pair.clone();
        let mut inner = pair.into_inner();
        let kind = match (inner.next(), inner.next()) {
            (Some(only), None) => {
                return self.expression(only).map(|expr| Expr::new(expr.kind, span));
            }
            (None, _) => ErrorKind::EmptyBrackets,
            _ if is_square => return self.deeper(span, 1, |b| b.list(whole, span)),
            _ => ErrorKind::Tuple,
        };
        Err(Error::new(span, kind))
    }

    /// Braces, bars, brackets that round, a fraction or a root.
    pub(crate) fn closed(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let rule = pair.as_rule();
        let first = pair.as_str().chars().next();
        let typed = self.typed(&pair);
        let whole = pair.clone();
        let mut inner = pair.into_inner();
        match rule {
            Rule::enclosed => {
                let op = match first {
                    Some('⌊') => Op::Floor,
                    Some('⌈') => Op::Ceil,
                    _ => Op::Abs,
                };
                let inner = self.argument(inner.next().expect("bars hold an expression"))?;
                if op == Op::Abs && is_vector(&inner) {
                    let length = self.scope.forms(&Callee::BuiltIn("length".to_owned()));
                    let length = length.function(1).expect("a function of one value");
                    return Ok(Expr::new(ExprKind::Call(length, vec![inner]), span));
                }
                Ok(native(op, inner, span))
            }
            Rule::choice => self.choice(whole, span),
            Rule::list => self.list(whole, span),
            Rule::series => self.big_series(whole, span),
            Rule::fraction => {
                let parts: Fallible<_> = inner.map(|part| self.part(part)).collect();
                product_of(parts?).map(|quotient| Expr::new(quotient.kind, span))
            }
            Rule::vulgar => {
                let digits = typed.chars().next().and_then(vulgar);
                let digits = digits.expect("the scanner knows no others");
                let part = |digit: char| (ProductSign::Over, number(digit.to_string(), span));
                product_of(digits.map(part).to_vec())
            }
            Rule::root => {
                let first = inner.next().expect("a root has braces");
                let Some(radicand) = inner.next() else {
                    let (_, radicand) = self.part(first)?;
                    return Ok(native(Op::Sqrt, radicand, span));
                };
                let index = self.value(first.into_inner().next().expect("an index"))?;
                let (_, radicand) = self.part(radicand)?;
                Ok(Expr::new(ExprKind::Call(Function::Root, vec![radicand, index]), span))
            }
            _ => {
                let expr = self.sum(inner.next().expect("braces hold a sum"))?;
                number_only(&expr)?;
                Ok(expr)
            }
        }
    }

    /// A part of a fraction, or what is below a root: one digit, or braces.
    fn part(&mut self, pair: Pair<'_>) -> Fallible<(ProductSign, Expr)> {
        let span = self.span(&pair);
        let part = match pair.as_rule() {
            Rule::digit => number(self.typed(&pair).to_owned(), span),
            _ => self.deeper(span, 1, |b| b.closed(pair, span))?,
        };
        Ok((ProductSign::Over, part))
    }
}

/// Whether an expression is a vector by its form alone.
pub(crate) fn is_vector(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Call(Function::Vector(_), _) => true,
        ExprKind::Component(_, letters) => letters.len() > 1,
        // An operation on a vector is one.
        ExprKind::Call(Function::Native(_), arguments) => arguments.iter().any(is_vector),
        ExprKind::Negate(inner) => is_vector(inner),
        ExprKind::Sum(first, rest) => is_vector(first) || rest.iter().any(|(_, e)| is_vector(e)),
        _ => false,
    }
}

pub(crate) fn number(digits: String, span: Span) -> Expr {
    Expr::new(ExprKind::Number(digits), span)
}

pub(crate) fn native(op: Op, argument: Expr, span: Span) -> Expr {
    Expr::new(ExprKind::Call(Function::Native(op), vec![argument]), span)
}
