//! Reads texts that are no programs, such as files of `CalcPlot3D`. Their formulas are scanned in a
//! copy of the text in which all else is blank, so places stay the same.

use crate::mathmod::mathmod;
use crate::plot_arguments::PlotRange;
use crate::program::{ForeignStatement, ForeignText};
use crate::scheme::scheme;
use std::ops::Range;
use zeroset_parser::lex::scanner::{is_python, scan};
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::lex::token::Token;
use zeroset_parser::lex::token_kind::TokenKind::Equals;
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Note, NoteKind, Span};

/// Number of keys that a note quotes.
const MAX_KEYS: usize = 6;

/// The reason for refusing a surface of three.js: a function sets its coordinates one by one.
const THREE_JS: ErrorKind = ErrorKind::Format {
    format: "three.js",
    read: "functions that set a point, as `ParametricGeometry` takes, are not read",
    help: "write the coordinates: `(cos u, sin u, v) for u in [0, 2pi], v in [0, 1]`",
};

/// The reason for refusing a surface of `MathMod` in four dimensions.
const FOUR_DIMENSIONS: ErrorKind = ErrorKind::Format {
    format: "MathMod",
    read: "surfaces in four dimensions (`Param4D`) are not read",
    help: "write three coordinates, as in `(cos u, sin u, v) for u in [0, 2pi], v in [0, 1]`",
};

/// Reads a text of another format; `None` for any other text.
pub(crate) fn foreign_text(text: &str, limits: &Limits) -> Fallible<Option<ForeignText>> {
    if is_mathmod(text) {
        return mathmod(text, limits).map(Some);
    }
    if text.trim_start().starts_with('{')
        && let Some(at) = text.find("\"Param4D\"")
    {
        return Err(Error::new(Span::new(at, at + "\"Param4D\"".len()), FOUR_DIMENSIONS));
    }
    if let Some(at) = text.find("ParametricGeometry(").filter(|_| text.contains("target.set(")) {
        return Err(Error::new(Span::new(at, at + "ParametricGeometry".len()), THREE_JS));
    }
    if !text.starts_with("type=implicit;") {
        return match scheme(text, limits)? {
            None if !is_python(text) => typed_equation(text, limits),
            found => Ok(found),
        };
    }
    let lower = text.to_ascii_lowercase();
    let find = |key: &str| setting(&lower, key);
    let Some(formula) = find("equation") else {
        return Err(Error::new(Span::at(0), ErrorKind::NoFormula));
    };
    // `CalcPlot3D` writes `~` for the equals sign.
    let sign = text[formula.clone()].find('~').map_or(formula.end, |at| formula.start + at);
    let mut statement = part(text, formula.start..sign, limits)?;
    if sign < formula.end {
        statement.push(Token::new(Equals, Span::new(sign, sign + 1)));
        statement.extend(part(text, sign + 1..formula.end, limits)?);
    }
    let mut ranges = Vec::new();
    for letter in ['x', 'y', 'z'] {
        let ends = ["min", "max"].map(|end| find(&format!("{letter}{end}")));
        if let [Some(low), Some(high)] = ends {
            let (low, high) = (part(text, low, limits)?, part(text, high, limits)?);
            ranges.push(PlotRange { name: None, low, high });
        }
    }
    let span = statement[0].span;
    let read = ["type", "equation", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax"];
    let keys = text.split([';', '\n', '&']).filter_map(|part| Some(part.split_once('=')?.0.trim()));
    let notes = left_note(keys, &read, span).into_iter().collect();
    let statements = vec![ForeignStatement::plain(statement)];
    let boxes = if ranges.len() == 3 { vec![ranges] } else { Vec::new() };
    Ok(Some(ForeignText { statements, boxes, notes, span }))
}

/// Returns whether a text is a script of `MathMod`.
pub(crate) fn is_mathmod(text: &str) -> bool {
    let keys = ["\"Fxyz\"", "\"Iso3D\"", "\"Param3D\""];
    text.trim_start().starts_with('{') && keys.iter().any(|key| text.contains(key))
}

/// Reads `{name: 'A', equation: 'x^2 + y^2 - 1'}` or `expression = "x^2 + y^2 - r"` of a gallery,
/// with parameters such as `{name = "r", value = 1}`.
fn typed_equation(text: &str, limits: &Limits) -> Fallible<Option<ForeignText>> {
    let is_apart = |c: char| " \t\"'".contains(c);
    // The places of the values of a key, without quotation marks.
    let values = |key: &str, quoted: bool| -> Vec<Range<usize>> {
        let mut found = Vec::new();
        for (at, _) in text.match_indices(key) {
            let rest = text[at + key.len()..].trim_start_matches(is_apart);
            let Some(value) = rest.strip_prefix([':', '=']).map(|value| value.trim_start()) else {
                continue;
            };
            let (open, end) = match value.chars().next().filter(|mark| "\"'`".contains(*mark)) {
                Some(mark) if quoted => (1, value[1..].find(mark).map(|end| end + 1)),
                None if !quoted => (0, value.find([',', '}', '\n'])),
                _ => continue,
            };
            let start = text.len() - value.len();
            found.extend(end.map(|end| start + open..start + end));
        }
        found
    };
    let formulas = ["equation", "expression"].map(|key| values(key, true)).concat();
    let [formula] = formulas.as_slice() else { return Ok(None) };
    let mut statements = Vec::new();
    for value in values("value", false) {
        let name = values("name", true).into_iter().rfind(|name| name.end < value.start);
        let Some(name) = name else { continue };
        let mut line = part(text, name, limits)?;
        line.push(Token::new(Equals, Span::at(value.start)));
        line.extend(part(text, value, limits)?);
        statements.push(ForeignStatement::plain(line));
    }
    let statement = part(text, formula.clone(), limits)?;
    let span = statement[0].span;
    statements.push(ForeignStatement::plain(statement));
    Ok(Some(ForeignText { statements, boxes: Vec::new(), notes: Vec::new(), span }))
}

/// The note on the keys of a text in JSON that are not among `read`; `None` if all are.
pub(crate) fn unread_keys(text: &str, read: &[&str], span: Span) -> Option<Note> {
    // A key whose value is a group has no value of its own.
    let pairs = text.split('"').skip(1).step_by(2).zip(text.split('"').skip(2).step_by(2));
    let value = |behind: &str| {
        let value = behind.trim_start().strip_prefix(':').map(str::trim_start);
        value.is_some_and(|value| !value.starts_with('{'))
    };
    let keys = pairs.filter(|(_, behind)| value(behind)).map(|(key, _)| key);
    left_note(keys, read, span)
}

/// The note on the `keys` that are not among `read`; `None` if all are.
fn left_note<'a>(keys: impl Iterator<Item = &'a str>, read: &[&str], span: Span) -> Option<Note> {
    let mut left: Vec<String> = Vec::new();
    for key in keys.filter(|key| !read.iter().any(|one| one.eq_ignore_ascii_case(key))) {
        let key = format!("`{}`", short_name(key));
        if !left.contains(&key) {
            left.push(key);
        }
        if left.len() > MAX_KEYS {
            left.truncate(MAX_KEYS);
            left.push("…".to_owned());
            break;
        }
    }
    let kind = NoteKind::FileLeftOut { left: left.join(", ") };
    (!left.is_empty()).then_some(Note { span, kind })
}

/// The value in `;key=value;`.
fn setting(text: &str, key: &str) -> Option<Range<usize>> {
    let at = text.find(&format!(";{key}="))? + key.len() + 2;
    Some(at..at + text[at..].find([';', '\n', '&']).unwrap_or(text.len() - at))
}

/// The tokens of a part of the text, which must be one statement.
pub(crate) fn part(text: &str, range: Range<usize>, limits: &Limits) -> Fallible<Vec<Token>> {
    // JSON writes a line break or a tab inside of a string with a backslash.
    let typed = text[range.clone()].replace("\\n", "  ").replace("\\t", "  ").replace("\\/", " /");
    let kept = format!("{}{typed}", " ".repeat(range.start));
    let mut statements = scan(&kept, limits)?;
    let only = statements.pop().filter(|_| statements.is_empty());
    only.ok_or_else(|| Error::new(Span::new(range.start, range.end), ErrorKind::Unfinished))
}
