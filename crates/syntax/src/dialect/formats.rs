//! Reads texts that are no program and no formula: files of `MathMod` and `CalcPlot3D`.
//!
//! Each formula is scanned in a copy of the text in which all else is blank, so places stay the
//! same.

use crate::dialect::plot_arguments::PlotRange;
use crate::dialect::program_words::Words;
use crate::dialect::scheme;
use crate::lex::scanner::scan;
use crate::lex::token::Token;
use crate::lex::token_kind::TokenKind::{self, *};
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::Note;
use crate::span::Span;
use std::ops::Range;

/// The statements of a text of another format, and a note on its domain.
pub(crate) type ForeignText = (Vec<Vec<Token>>, Option<Note>);

/// The ends of the range of an axis.
type Ends = (TokenKind, [Range<usize>; 2]);

/// Reads a text of another format; `None` for any other text.
pub(crate) fn foreign_text(text: &str, limits: &Limits) -> Fallible<Option<ForeignText>> {
    let trimmed = text.trim_start();
    if trimmed.starts_with('{') && trimmed.contains("\"Fxyz\"") {
        return mathmod(text, limits).map(Some);
    }
    if trimmed.starts_with("type=implicit;") {
        return calcplot(text, limits).map(Some);
    }
    scheme::scheme(text, limits)
}

/// A copy of `text` in which all bytes except those of `kept` are blank.
pub(crate) fn masked(text: &str, kept: &[Range<usize>]) -> String {
    let mut bytes = vec![b' '; text.len()];
    for range in kept {
        bytes[range.clone()].copy_from_slice(&text.as_bytes()[range.clone()]);
    }
    String::from_utf8(bytes).unwrap_or_default()
}

/// The tokens of a part of the text, which must be one statement.
fn part(text: &str, range: &Range<usize>, limits: &Limits) -> Fallible<Vec<Token>> {
    let kept = masked(text, std::slice::from_ref(range));
    let mut statements = scan(&kept, limits)?;
    match (statements.pop(), statements.is_empty()) {
        (Some(only), true) => Ok(only),
        _ => Err(Error::new(Span::new(range.start, range.end), ErrorKind::Unfinished)),
    }
}

/// Adds the domain with these ends to `formula`.
fn with_domain(
    text: &str,
    formula: Vec<Token>,
    ends: &[Ends],
    limits: &Limits,
) -> Fallible<ForeignText> {
    let (mut ranges, mut axes) = (Vec::new(), Vec::new());
    for (axis, [low, high]) in ends {
        let (low, high) = (part(text, low, limits)?, part(text, high, limits)?);
        ranges.push(PlotRange { name: None, low, high });
        axes.push(*axis);
    }
    let place = formula.first().map_or(Span::default(), |first| first.span);
    let (domain, note) = Words { text }.domain(&ranges, &axes, place);
    Ok((std::iter::once(formula).chain(domain).collect(), note))
}

/// The strings in `"key": ["a", "b"]`.
fn strings(text: &str, key: &str) -> Vec<Range<usize>> {
    let mut all = Vec::new();
    for (at, found) in text.match_indices(&format!("\"{key}\"")) {
        let start = at + found.len();
        let Some(list) = text[start..].trim_start().strip_prefix(':') else { continue };
        let Some(list) = list.trim_start().strip_prefix('[') else { continue };
        let start = text.len() - list.len();
        let inner = &list[..list.find(']').unwrap_or(0)];
        let marks: Vec<usize> = inner.match_indices('"').map(|(at, _)| start + at).collect();
        all.extend(marks.chunks_exact(2).map(|pair| pair[0] + 1..pair[1]));
    }
    all
}

/// Reads a file of `MathMod` with one implicit surface, `Fxyz`.
fn mathmod(text: &str, limits: &Limits) -> Fallible<ForeignText> {
    const MORE: [&str; 5] = ["Const", "Funct", "Varu", "Cnd", "Param3D"];
    let formulas = strings(text, "Fxyz");
    let has_more = MORE.iter().any(|key| text.contains(&format!("\"{key}\"")));
    let [formula] = formulas.as_slice() else { return Err(of_mathmod(text)) };
    if has_more {
        return Err(of_mathmod(text));
    }
    let ends = |axis: TokenKind, keys: [&str; 2]| {
        let [low, high] = keys.map(|key| strings(text, key).pop());
        Some((axis, [low?, high?]))
    };
    let ends = [ends(X, ["Xmin", "Xmax"]), ends(Y, ["Ymin", "Ymax"]), ends(Z, ["Zmin", "Zmax"])];
    let ends: Vec<Ends> = ends.into_iter().flatten().collect();
    with_domain(text, part(text, formula, limits)?, &ends, limits)
}

fn of_mathmod(text: &str) -> Box<Error> {
    let at = text.find("\"Fxyz\"").unwrap_or(0);
    let kind = ErrorKind::Format {
        format: "MathMod",
        read: "only one `Fxyz` without constants and functions is read",
        help: "paste one formula of `Fxyz` alone, and each constant as a line `a = 1`",
    };
    Error::new(Span::new(at, at + "\"Fxyz\"".len()), kind)
}

/// Reads the settings of an implicit surface of `CalcPlot3D`, such as `equation=x^2~1;xmin=-2`.
fn calcplot(text: &str, limits: &Limits) -> Fallible<ForeignText> {
    let value = |key: &str| {
        let at = text.find(&format!(";{key}="))? + key.len() + 2;
        let length = text[at..].find([';', '\n', '&']).unwrap_or(text.len() - at);
        Some(at..at + length)
    };
    let equation = value("equation").unwrap_or(0..0);
    let sign = equation.start + text[equation.clone()].find('~').unwrap_or(equation.len());
    let mut formula = part(text, &(equation.start..sign), limits)?;
    if sign < equation.end {
        formula.push(Token::new(Equals, Span::new(sign, sign + 1)));
        formula.extend(part(text, &(sign + 1..equation.end), limits)?);
    }
    let ends = |axis: TokenKind, keys: [&str; 2]| {
        let [low, high] = keys.map(value);
        Some((axis, [low?, high?]))
    };
    let ends = [ends(X, ["xmin", "xmax"]), ends(Y, ["ymin", "ymax"]), ends(Z, ["zmin", "zmax"])];
    let ends: Vec<Ends> = ends.into_iter().flatten().collect();
    with_domain(text, formula, &ends, limits)
}
