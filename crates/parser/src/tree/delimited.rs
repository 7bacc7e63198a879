//! Reads delimited factors, such as brackets and fractions. Each is one factor in any context.

use crate::lex::spelling::vulgar;
use crate::lex::token_kind::TokenKind::{OpenBracket, OpenCeiling, OpenFloor};
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::span::Span;
use crate::tree::ast::{Chain, Expr, ExprKind, Function, NamedValue};
use crate::tree::builder::{Builder, number_only, quotient_of};
use crate::tree::grammar::{Pair, Rule, first_kind};
use crate::tree::scope::Callee;
use zeroset_ops::{Differential, Op, VectorFunction};

/// Beginnings of double bars, which mean the same as single bars, except around a matrix.
const DOUBLE_BARS: &[&str] = &[r"\begin{V", r"\|", r"\left\|", "‖", r"\lVert", r"\Vert"];

impl Builder<'_> {
    /// Reads round or square brackets.
    pub(crate) fn group(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        match only_part(&pair) {
            Some(only) => {
                let mut expr = self.expression(only)?;
                expr.span = span;
                Ok(expr)
            }
            None => self.several(pair, span),
        }
    }

    /// Reads brackets that are empty or hold several expressions.
    #[inline(never)] // keeps the stack frames of nested brackets small
    fn several(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        if pair.clone().into_inner().next().is_none() {
            return Err(Error::new(span, ErrorKind::EmptyBrackets));
        }
        let count = pair.clone().into_inner().count();
        // In `(x - 0,5)`, the comma may be decimal.
        let is_vector = matches!(count, 2..=4) && !(count == 2 && self.has_decimal_comma(span));
        if first_kind(&pair) == Some(OpenBracket) || is_vector {
            return self.nested(span, 1, |b| b.list(pair, span));
        }
        Err(Error::new(span, ErrorKind::Tuple))
    }

    /// Returns whether digits touch a comma on both sides.
    fn has_decimal_comma(&self, span: Span) -> bool {
        self.text.as_bytes()[span.range()]
            .windows(3)
            .any(|near| near[0].is_ascii_digit() && near[1] == b',' && near[2].is_ascii_digit())
    }

    /// Reads a delimited factor that is no `group`, such as braces, bars, a fraction or a root.
    pub(crate) fn delimited(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        // Each kind of factor has its own function, so a level has only one kind's stack frame.
        match pair.as_rule() {
            Rule::enclosed => self.enclosed(pair, span),
            Rule::choice => self.choice(pair, span),
            Rule::list => self.list(pair, span),
            Rule::series => self.big_series(pair, span),
            Rule::fraction => self.fraction(pair, span),
            Rule::vulgar => vulgar_fraction(self.typed(&pair), span),
            Rule::root => self.root(pair, span),
            _ => {
                let expr = self.sum(first_part(pair))?;
                number_only(&expr)?;
                Ok(expr)
            }
        }
    }

    #[inline(never)]
    fn enclosed(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let op = match first_kind(&pair) {
            Some(OpenFloor) => Op::Floor,
            Some(OpenCeiling) => Op::Ceil,
            _ => Op::Abs,
        };
        let is_double = DOUBLE_BARS.iter().any(|bars| self.typed(&pair).starts_with(bars));
        let inner = self.argument(first_part(pair))?;
        if op == Op::Abs && self.is_vector(&inner) {
            return Ok(self.length_of(inner, span));
        }
        if op == Op::Abs && matches!(inner.kind, ExprKind::Call(Function::Matrix(_), _)) {
            // Double bars around a matrix may mean any of several norms.
            if is_double {
                return Err(Error::new(span, ErrorKind::Matrix));
            }
            let function = Function::OfVectors(VectorFunction::Determinant);
            return Ok(Expr::new(ExprKind::Call(function, vec![inner]), span));
        }
        Ok(native(op, inner, span))
    }

    /// Returns whether an expression is a vector by its form or by the forms of definitions.
    pub(crate) fn is_vector(&self, expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Name(NamedValue::Defined(name)) => self.scope.vectors.contains(name),
            ExprKind::Negate(inner) => self.is_vector(inner),
            ExprKind::Chain(..) => expr.parts().into_iter().any(|part| self.is_vector(part)),
            _ => is_vector(expr),
        }
    }

    #[inline(never)]
    fn length_of(&self, vector: Expr, span: Span) -> Expr {
        let length = self.scope.signatures(&Callee::BuiltIn("length".to_owned()));
        let length = length.function(1).expect("a function of one value");
        Expr::new(ExprKind::Call(length, vec![vector]), span)
    }

    #[inline(never)]
    fn fraction(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let parts: Fallible<Vec<Expr>> = pair.into_inner().map(|part| self.part(part)).collect();
        let mut quotient = quotient_of(parts?)?;
        quotient.span = span;
        Ok(quotient)
    }

    #[inline(never)]
    fn root(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let mut inner = pair.into_inner();
        let first = inner.next().expect("a root has braces");
        let Some(radicand) = inner.next() else {
            return self.part(first).map(|radicand| native(Op::Sqrt, radicand, span));
        };
        let index = self.value(first_part(first))?;
        let radicand = self.part(radicand)?;
        Ok(Expr::new(ExprKind::Call(Function::Root, vec![radicand, index]), span))
    }

    /// Reads a part of a fraction, or a radicand: one digit, one letter, or braces.
    #[inline(never)]
    fn part(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::digit => Ok(Expr::of_digits(self.typed(&pair), span)),
            Rule::name => self.letter(pair),
            _ => self.nested(span, 1, |b| b.delimited(pair, span)),
        }
    }
}

/// The only part of `pair`; `None` if there are more parts or none.
#[inline(never)]
fn only_part<'i>(pair: &Pair<'i>) -> Option<Pair<'i>> {
    let mut inner = pair.clone().into_inner();
    inner.next().filter(|_| inner.next().is_none())
}

/// The first part of `pair`, which must have one.
#[inline(never)]
fn first_part(pair: Pair<'_>) -> Pair<'_> {
    pair.into_inner().next().expect("the grammar has something in brackets")
}

/// Reads a fraction that is one character, such as `½`.
#[inline(never)]
fn vulgar_fraction(typed: &str, span: Span) -> Fallible<Expr> {
    let digits = typed.chars().next().and_then(vulgar);
    let digits = digits.expect("the scanner knows no others");
    quotient_of(digits.map(|digit| Expr::of_digits(digit, span)))
}

/// Returns whether an expression is a vector by its form alone, without regard to definitions.
pub(crate) fn is_vector(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Call(
            Function::Vector(_) | Function::OfDerivatives(Differential::Gradient),
            _,
        ) => true,
        ExprKind::Component(_, letters) => letters.len() > 1,
        // An operation on a vector gives a vector.
        ExprKind::Call(Function::Native(_), arguments) => arguments.iter().any(is_vector),
        ExprKind::Negate(inner) => is_vector(inner),
        ExprKind::Chain(Chain::Sum, ..) => expr.parts().into_iter().any(is_vector),
        _ => false,
    }
}

pub(crate) fn native(op: Op, argument: Expr, span: Span) -> Expr {
    Expr::new(ExprKind::Call(Function::Native(op), vec![argument]), span)
}
