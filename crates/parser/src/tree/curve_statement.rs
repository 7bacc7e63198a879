//! Builds the trees of statements that draw curves and points.

use crate::lex::spelling::plain_name;
use crate::lex::token_kind::TokenKind::OpenParen;
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::tree::ast::{CurveForm, CurveStatement, Expr, Name, Statement};
use crate::tree::builder::Builder;
use crate::tree::built_statement::BuiltStatement;
use crate::tree::grammar::{Pair, Rule, parts};
use crate::tree::scope::Scope;
use crate::tree::statement::ParsedStatement;

/// Builds the trees of a curve or a point.
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
    let lexed = &line.raw.lexed;
    let mut builder = Builder::new(text, lexed, scope, &[], limits);
    let parameter = parts.iter().find(|part| part.as_rule() == Rule::name);
    let parameter = parameter
        .map(|name| Name { text: plain_name(builder.typed(name)), span: builder.span(name) });
    let local: Vec<Name> = parameter.iter().cloned().collect();
    let mut inner = Builder::new(text, lexed, scope, &local, limits);
    builder.aliases = line.raw.aliases.clone();
    inner.aliases = line.raw.aliases.clone();
    let (mut at, mut equations, mut restrictions) = (Vec::new(), Vec::new(), Vec::new());
    let (mut range, mut label) = (None, None);
    for part in parts {
        match part.as_rule() {
            Rule::point => at = inner.point(part)?,
            Rule::expression if rule == Rule::path_line => at = vec![inner.value(part)?],
            Rule::expression => equations.push(equation(&mut builder, part, lexed.tokens.get(1))?),
            Rule::bounds => range = Some(Box::new(builder.bounds(part)?)),
            Rule::restriction => restrictions.extend(builder.restrictions(part)?),
            Rule::label => label = Some(builder.typed(&part).trim_matches('"').to_owned()),
            _ => {}
        }
    }
    let form = match (parameter, range) {
        (Some(parameter), Some(range)) => CurveForm::Path { at, parameter, range },
        _ if rule == Rule::point_line => CurveForm::Point { at, label },
        _ => CurveForm::Equations { equations, restrictions },
    };
    let Builder { mut notes, mut used, .. } = inner;
    notes.extend(builder.notes);
    used.extend(builder.used);
    let statement = Statement::Curve(CurveStatement { form, span });
    Ok(BuiltStatement { statement, span, notes, used })
}

/// Reads an equation of a curve. Coordinates in brackets lack the range of their parameter.
fn equation(
    builder: &mut Builder<'_>,
    part: Pair<'_>,
    first: Option<&crate::lex::token::Token>,
) -> Fallible<Expr> {
    let is_tuple = first.is_some_and(|first| first.kind == OpenParen);
    builder.expression(part).map_err(|mut error| {
        if is_tuple && error.kind == ErrorKind::Tuple {
            error.kind = ErrorKind::CurveRange;
        }
        error
    })
}

impl Builder<'_> {
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
