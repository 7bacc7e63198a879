//! Definitions of functions that other systems have and this language has not. A text that uses
//! such a function without defining it gets the definition.

use crate::lex::arrangement::statements;
use crate::lex::spelling::plain_name;
use crate::limits::Limits;
use crate::messages::note::{Note, NoteKind};
use crate::span::Span;
use crate::tree::ast::{Definition, Name, Statement};
use crate::tree::builder::Builder;
use crate::tree::built_statement::BuiltStatement;
use crate::tree::scope::Scope;
use crate::tree::statement::ParsedStatement;

/// A function of another system: its name, its parameters and its value.
struct ForeignDefinition {
    name: &'static str,
    parameters: &'static [&'static str],
    body: &'static str,
    system: &'static str,
}

const fn of_pov(
    name: &'static str,
    parameters: &'static [&'static str],
    body: &'static str,
) -> ForeignDefinition {
    ForeignDefinition { name, parameters, body, system: "POV-Ray" }
}

/// Functions of POV-Ray's `functions.inc`, and a constant of MATLAB. The axis of POV-Ray's torus is
/// the y axis.
const DEFINITIONS: &[ForeignDefinition] = &[
    of_pov("f_r", &["a", "b", "c"], "sqrt(a^2 + b^2 + c^2)"),
    of_pov("f_sphere", &["a", "b", "c", "r"], "sqrt(a^2 + b^2 + c^2) - r"),
    of_pov("f_ellipsoid", &["a", "b", "c", "u", "v", "w"], "sqrt((a*u)^2 + (b*v)^2 + (c*w)^2)"),
    of_pov("f_torus", &["a", "b", "c", "u", "v"], "sqrt((sqrt(a^2 + c^2) - u)^2 + b^2) - v"),
    of_pov(
        "f_superellipsoid",
        &["a", "b", "c", "u", "v"],
        "1 - ((abs(a)^(2/u) + abs(b)^(2/u))^(u/v) + abs(c)^(2/v))^(v/2)",
    ),
    ForeignDefinition { name: "eps", parameters: &[], body: "2^-52", system: "MATLAB" },
];

/// The definitions of the functions that `lines` use and do not define, with notes. Adds the names
/// to `scope`.
pub(crate) fn foreign_definitions(
    text: &str,
    lines: &[ParsedStatement<'_>],
    scope: &mut Scope,
    limits: &Limits,
) -> (Vec<BuiltStatement>, Vec<Note>) {
    let (mut built, mut notes) = (Vec::new(), Vec::new());
    let tokens = || lines.iter().flat_map(|line| &line.raw.lexed.tokens);
    for definition in DEFINITIONS {
        let is_name = |span: Span| plain_name(&text[span.range()]) == definition.name;
        let place = tokens().map(|token| token.span).find(|span| is_name(*span));
        let Some(span) = place.filter(|_| !scope.is_defined(definition.name)) else { continue };
        let ForeignDefinition { name, parameters, body, system } = definition;
        let count = Some(parameters.len()).filter(|count| *count > 0);
        let left = count.map_or(String::new(), |_| format!("({})", parameters.join(", ")));
        let read = format!("{name}{left} = {body}");
        notes.push(Note { span, kind: NoteKind::ForeignDefinition { system, read } });
        scope.define(name, count);
        built.extend(define(definition, scope, limits));
    }
    (built, notes)
}

/// The statement of a definition.
fn define(
    definition: &ForeignDefinition,
    scope: &Scope,
    limits: &Limits,
) -> Option<BuiltStatement> {
    let span = Span::default();
    let name = |text: &&str| Name { text: (*text).to_owned(), span };
    let parameters: Vec<Name> = definition.parameters.iter().map(name).collect();
    let statements = statements(definition.body, limits).ok()?;
    let mut builder =
        Builder::new(definition.body, statements.first()?, scope, &parameters, limits);
    let body = builder.only_expression().ok()?;
    let used = builder.used;
    let parameters = Some(parameters).filter(|parameters| !parameters.is_empty());
    let name = name(&definition.name);
    let definition = Definition { name, parameters, body, range: None };
    Some(BuiltStatement { statement: Statement::Define(definition), span, notes: Vec::new(), used })
}
