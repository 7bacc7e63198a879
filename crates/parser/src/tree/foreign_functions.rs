//! Reads functions of other systems: arithmetic such as `Plus[a, b]`, and functions with an
//! equivalent formula in this language, such as `Boole[c]`.

use crate::messages::error::{Error, ErrorKind, Fallible, plural};
use crate::span::Span;
use crate::tree::ast::{Chain, ChainSign, Expr, ExprKind, Function};
use crate::tree::builder::{Builder, chain_of, product_of, quotient_of};
use crate::tree::grammar::Pair;
use zeroset_ops::{Op, VectorFunction};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ForeignFunction {
    /// The sum or product of all arguments, or the difference or quotient of two arguments.
    Chain(Chain, ChainSign),
    Minus,
    /// The sum of a vector's components.
    Total,
    /// 1 where a condition holds, else 0.
    Boole,
    /// The remainder as in C, with the sign of the dividend.
    Remainder,
    /// The first argument. The others give an array its shape.
    Reshape,
}

/// The foreign function called `name`. `square` is true if its arguments are in square brackets.
pub(crate) fn foreign_function(name: &str, square: bool) -> Option<ForeignFunction> {
    Some(match name {
        "Plus" => ForeignFunction::Chain(Chain::Sum, ChainSign::Direct),
        "Times" => ForeignFunction::Chain(Chain::Product, ChainSign::Direct),
        "Minus" if square => ForeignFunction::Minus,
        "Subtract" if square => ForeignFunction::Chain(Chain::Sum, ChainSign::Inverse),
        "Divide" | "Rational" => ForeignFunction::Chain(Chain::Product, ChainSign::Inverse),
        "Total" => ForeignFunction::Total,
        "Boole" => ForeignFunction::Boole,
        "fmod" => ForeignFunction::Remainder,
        "reshape" => ForeignFunction::Reshape,
        _ => return None,
    })
}

impl Builder<'_> {
    /// Reads a call of a foreign function, whose arguments are in `group`.
    pub(crate) fn foreign_call(
        &mut self,
        kind: ForeignFunction,
        span: Span,
        group: Pair<'_>,
    ) -> Fallible<Expr> {
        let place = span.to(self.span(&group));
        let parts: Vec<Pair<'_>> = group.into_inner().collect();
        if let (ForeignFunction::Boole, [only]) = (kind, parts.as_slice()) {
            return Ok(self.condition_of(only.clone())?.indicator(place));
        }
        if let (ForeignFunction::Reshape, [first, ..]) = (kind, parts.as_slice()) {
            return self.argument(first.clone());
        }
        let count = match kind {
            ForeignFunction::Chain(_, ChainSign::Direct) => parts.len().max(1),
            ForeignFunction::Minus
            | ForeignFunction::Total
            | ForeignFunction::Boole
            | ForeignFunction::Reshape => 1,
            ForeignFunction::Chain(_, ChainSign::Inverse) | ForeignFunction::Remainder => 2,
        };
        if parts.len() != count {
            let name = self.text[span.range()].to_owned();
            let (expected, given) = (plural(count), parts.len());
            let kind = ErrorKind::WrongCount { name, expected, given, usage: None };
            return Err(Error::new(place, kind));
        }
        let values: Fallible<Vec<Expr>> =
            parts.into_iter().map(|part| self.argument(part)).collect();
        let mut values = values?.into_iter();
        let Some(first) = values.next() else {
            return Err(Error::new(place, ErrorKind::EmptyBrackets));
        };
        let expr = match kind {
            ForeignFunction::Chain(chain, sign) => {
                let all = std::iter::once(first).chain(values);
                chain_of(chain, all.map(|value| (sign, value)).collect())?
            }
            ForeignFunction::Minus => first.negated(place),
            ForeignFunction::Total => {
                let one = Expr::of_digits("1", place);
                let function = Function::OfVectors(VectorFunction::Dot);
                Expr::new(ExprKind::Call(function, vec![first, one]), place)
            }
            ForeignFunction::Boole | ForeignFunction::Reshape => first,
            ForeignFunction::Remainder => match values.next() {
                Some(divisor) => remainder(Op::Trunc, first, divisor, place)?,
                None => first,
            },
        };
        Ok(Expr::new(expr.kind, place))
    }
}

/// The remainder a − b r(a/b), where `op` is the rounding r.
///
/// # Errors
/// If an operand is not a number.
pub fn remainder(op: Op, a: Expr, b: Expr, span: Span) -> Fallible<Expr> {
    let quotient = quotient_of([a.clone(), b.clone()])?;
    let whole = Expr::new(ExprKind::Call(Function::Native(op), vec![quotient]), span);
    let multiple = product_of([b, whole])?;
    chain_of(Chain::Sum, vec![(ChainSign::Direct, a), (ChainSign::Inverse, multiple)])
}
