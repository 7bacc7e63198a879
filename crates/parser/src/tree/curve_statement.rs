//! Builds the trees of statements that draw curves, points and parametric surfaces.

use crate::lex::spelling::plain_name;
use crate::lex::token_kind::TokenKind::OpenParen;
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::NoteKind;
use crate::span::Span;
use crate::tree::ast::{
    Chain, ChainSign, CurveForm, CurveStatement, Expr, ExprKind, Function, Name, NamedValue,
    Statement,
};
use crate::tree::builder::{Builder, chain_of, product_of};
use crate::tree::built_statement::BuiltStatement;
use crate::tree::grammar::{Pair, Rule, parts};
use crate::tree::scope::NameMeaning::{Product, Unknown};
use crate::tree::scope::Scope;
use crate::tree::statement::ParsedStatement;

/// Half the length to which an infinite range of a parameter is cut.
const CUT: u8 = 5;
/// Spellings of infinity.
const INFINITIES: [&str; 9] =
    ["∞", "inf", "Inf", "INF", "infinity", "Infinity", "oo", r"\infty", "INFINITY"];

/// Builds the trees of a curve, a point or a parametric surface.
///
/// # Errors
/// If a formula of the line is wrong.
pub fn curve(
    text: &str,
    line: ParsedStatement<'_>,
    scope: &Scope,
    limits: &Limits,
) -> Fallible<BuiltStatement> {
    let span = line.raw.lexed.span;
    let rule = line.pair.as_rule();
    let parts = parts(line.pair);
    if rule == Rule::segment_line {
        let mut builder = Builder::new(text, &line.raw.lexed, scope, &[], limits);
        builder.aliases = line.raw.aliases.clone();
        let form = builder.segment(parts, span)?;
        let statement = Statement::Curve(CurveStatement { form, span });
        let Builder { notes, used, .. } = builder;
        return Ok(BuiltStatement { statement, span, notes, used });
    }
    let lexed = &line.raw.lexed;
    let mut builder = Builder::new(text, lexed, scope, &[], limits);
    let names = parts.iter().filter(|part| part.as_rule() == Rule::name);
    let name = |name| Name { text: plain_name(builder.typed(name)), span: builder.span(name) };
    let local: Vec<Name> = names.map(name).collect();
    if let [first, second] = local.as_slice()
        && first == second
    {
        let kind = ErrorKind::DuplicateParameter { name: first.text.clone() };
        return Err(Error::new(second.span, kind));
    }
    let mut inner = Builder::new(text, lexed, scope, &local, limits);
    builder.aliases = line.raw.aliases.clone();
    inner.aliases = line.raw.aliases.clone();
    let (mut at, mut equations, mut restrictions) = (Vec::new(), Vec::new(), Vec::new());
    let (mut ranges, mut label) = (Vec::new(), None);
    for part in parts {
        match part.as_rule() {
            Rule::point => at = inner.point(part)?,
            Rule::expression if rule == Rule::path_line => at = vec![inner.value(part)?],
            Rule::expression => equations.push(equation(&mut builder, part, lexed.tokens.get(1))?),
            Rule::bounds => ranges.push(builder.range(part, &local[ranges.len()])?),
            Rule::restriction => restrictions.extend(builder.restrictions(part)?),
            Rule::label => label = Some(builder.typed(&part).trim_matches('"').to_owned()),
            _ => {}
        }
    }
    let form = match (local.as_slice(), <[_; 2]>::try_from(ranges)) {
        ([u, v], Ok(ranges)) => {
            let parameters = [u.clone(), v.clone()];
            CurveForm::Patch { at, parameters, ranges: Box::new(ranges) }
        }
        ([parameter], Err(mut ranges)) if !ranges.is_empty() => {
            CurveForm::Path { at, parameter: parameter.clone(), range: Box::new(ranges.remove(0)) }
        }
        _ if rule == Rule::point_line => CurveForm::Point { at, label },
        _ => CurveForm::Equations { equations, restrictions },
    };
    let Builder { mut notes, mut used, .. } = inner;
    notes.extend(builder.notes);
    used.extend(builder.used);
    let statement = Statement::Curve(CurveStatement { form, span });
    Ok(BuiltStatement { statement, span, notes, used })
}

/// The name, if an expression is only a name.
fn name_of(expr: &Expr) -> Option<&str> {
    match &expr.kind {
        ExprKind::Name(value) => Some(value.name()),
        _ => None,
    }
}

/// Reads an equation of a curve. Coordinates in brackets lack the range of their parameter.
fn equation(
    builder: &mut Builder<'_>,
    part: Pair<'_>,
    first: Option<&crate::lex::token::Token>,
) -> Fallible<Expr> {
    let is_tuple = first.is_some_and(|first| first.kind == OpenParen);
    let expr = builder.expression(part);
    let is_point = match &expr {
        Ok(expr) => matches!(expr.kind, ExprKind::Call(Function::Vector(_), _)),
        Err(error) => error.kind == ErrorKind::Tuple,
    };
    match (expr, is_tuple && is_point) {
        (Ok(Expr { span, .. }), true) => Err(Error::new(span, ErrorKind::CurveRange)),
        (Err(error), true) => Err(Error::new(error.span, ErrorKind::CurveRange)),
        (expr, false) => expr,
    }
}

impl Builder<'_> {
    /// Reads the segment between two points. A single point is joined with the origin.
    fn segment(&mut self, parts: Vec<Pair<'_>>, span: Span) -> Fallible<CurveForm> {
        let mut ends = Vec::new();
        for part in parts {
            ends.push(self.argument(part)?);
        }
        // The ends must not contain the parameter's name.
        let named: Vec<&str> = ends.iter().flat_map(Expr::all_parts).filter_map(name_of).collect();
        let free = ["t", "s", "u", "v", "w"].into_iter().find(|name| !named.contains(name));
        let text = free.unwrap_or("k").to_owned();
        let parameter = Name { text: text.clone(), span };
        let share = || Expr::new(ExprKind::Name(NamedValue::Local(text.clone())), span);
        let at = match <[Expr; 2]>::try_from(ends) {
            Ok([from, to]) => {
                let way = chain_of(
                    Chain::Sum,
                    vec![(ChainSign::Direct, to), (ChainSign::Inverse, from.clone())],
                )?;
                let way = product_of([share(), way])?;
                chain_of(Chain::Sum, vec![(ChainSign::Direct, from), (ChainSign::Direct, way)])?
            }
            Err(ends) => product_of(std::iter::once(share()).chain(ends))?,
        };
        let end = |digit| Expr::of_digits(digit, span);
        let range = Box::new((end("0"), end("1")));
        Ok(CurveForm::Path { at: vec![at], parameter, range })
    }

    /// Reads the range of a parameter. An infinite range is cut, with a note.
    fn range(&mut self, pair: Pair<'_>, name: &Name) -> Fallible<(Expr, Expr)> {
        let span = self.span(&pair);
        let mut ends = pair.into_inner();
        let mut end = || ends.next().expect("bounds hold two expressions");
        let (low, high) = (end(), end());
        // `u in R` has one word for both ends.
        let is_all = self.span(&low) == self.span(&high);
        let from = is_all || self.is_infinite(&low, "-");
        let to = is_all || self.is_infinite(&high, "+");
        if from || to {
            self.note(span, NoteKind::CutRange { name: name.text.clone(), length: 2 * CUT });
        }
        let number = |size: u8| Expr::of_digits(size.to_string(), span);
        if from && to {
            let low = Expr::new(ExprKind::Negate(Box::new(number(CUT))), span);
            return Ok((low, number(CUT)));
        }
        let beside = |end: &Expr, sign| match &end.kind {
            ExprKind::Number(digits) if digits == "0" && sign == ChainSign::Direct => {
                Ok(number(2 * CUT))
            }
            _ => {
                let parts = vec![(ChainSign::Direct, end.clone()), (sign, number(2 * CUT))];
                chain_of(Chain::Sum, parts)
            }
        };
        if from {
            let high = self.value(high)?;
            return Ok((beside(&high, ChainSign::Inverse)?, high));
        }
        let low = self.value(low)?;
        let high = if to { beside(&low, ChainSign::Direct)? } else { self.value(high)? };
        Ok((low, high))
    }

    /// Returns whether the end of a range is infinity with this sign. A plus may be left out.
    fn is_infinite(&self, end: &Pair<'_>, sign: &str) -> bool {
        let typed = self.typed(end).replace('−', "-");
        let word = typed.strip_prefix(sign).or((sign == "+").then_some(&*typed));
        word.map(str::trim).is_some_and(|word| {
            INFINITIES.contains(&word) && matches!(self.scope.meaning(word, &[]), Unknown | Product)
        })
    }

    /// Reads the coordinates of a point, in brackets.
    fn point(&mut self, point: Pair<'_>) -> Fallible<Vec<Expr>> {
        let span = self.span(&point);
        let parts = parts(point);
        if parts.len() != 3 {
            return Err(Error::new(span, ErrorKind::PointSize { given: parts.len() }));
        }
        parts.into_iter().map(|part| self.value(part)).collect()
    }

    /// Reads the conditions in a pair of braces.
    pub(crate) fn restrictions(&mut self, braces: Pair<'_>) -> Fallible<Vec<Expr>> {
        let condition = |part: Pair<'_>| {
            let condition = self.expression(part)?;
            if condition.is_condition() {
                return Ok(condition);
            }
            Err(Error::new(condition.span, ErrorKind::RestrictionNotCondition))
        };
        braces.into_inner().map(condition).collect()
    }
}
