//! Definitions of functions that this language lacks and other systems have. A text that uses such
//! a function without defining it gets the definition.

use crate::document::implied_coordinates::define;
use zeroset_parser::lex::spelling::plain_name;
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::scope::Scope;
use zeroset_parser::tree::statement::ParsedStatement;
use zeroset_parser::{Limits, Note, NoteKind};

/// A system, and the name, the parameters and the value of a function that it has.
type ForeignDefinition = (&'static str, &'static str, &'static [&'static str], &'static str);

/// Functions of POV-Ray's `functions.inc`, and a constant of MATLAB. The axis of POV-Ray's torus is
/// the y axis, and its superellipsoid is positive inside.
const DEFINITIONS: &[ForeignDefinition] = &[
    ("POV-Ray", "f_r", &["a", "b", "c"], "sqrt(a^2 + b^2 + c^2)"),
    ("POV-Ray", "f_sphere", &["a", "b", "c", "r"], "sqrt(a^2 + b^2 + c^2) - r"),
    (
        "POV-Ray",
        "f_ellipsoid",
        &["a", "b", "c", "u", "v", "w"],
        "sqrt((a*u)^2 + (b*v)^2 + (c*w)^2)",
    ),
    ("POV-Ray", "f_torus", &["a", "b", "c", "u", "v"], "sqrt((sqrt(a^2 + c^2) - u)^2 + b^2) - v"),
    (
        "POV-Ray",
        "f_superellipsoid",
        &["a", "b", "c", "u", "v"],
        "1 - ((abs(a)^(2/u) + abs(b)^(2/u))^(u/v) + abs(c)^(2/v))^(v/2)",
    ),
    ("POV-Ray", "select", &["a", "b", "c"], "{a < 0: b, c}"),
    ("MATLAB", "eps", &[], "2^-52"),
    (
        "MATLAB",
        "peaks",
        &["a", "b"],
        "3*(1-a)^2*exp(-a^2-(b+1)^2)-10*(a/5-a^3-b^5)*exp(-a^2-b^2)-exp(-(a+1)^2-b^2)/3",
    ),
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
    for (system, name, parameters, body) in DEFINITIONS {
        if !text.contains(name) || scope.is_defined(name) {
            continue;
        }
        let mut places = lines.iter().flat_map(|l| &l.raw.lexed.tokens).map(|token| token.span);
        let Some(span) = places.find(|span| plain_name(&text[span.range()]) == *name) else {
            continue;
        };
        let count = Some(parameters.len()).filter(|count| *count > 0);
        let left = count.map_or(String::new(), |_| format!("({})", parameters.join(", ")));
        let read = format!("{name}{left} = {body}");
        notes.push(Note { span, kind: NoteKind::ForeignDefinition { system, read } });
        scope.define(name, count);
        built.extend(define(name, parameters, body, scope, limits));
    }
    (built, notes)
}
