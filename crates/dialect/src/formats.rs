//! Reads texts that are no programs: files of `MathMod` and `CalcPlot3D`. Their formulas are
//! scanned in a copy of the text in which all else is blank, so places stay the same.

use crate::plot_arguments::PlotRange;
use crate::program::ForeignText;
use crate::program_words::Words;
use crate::scheme::scheme;
use std::ops::Range;
use zeroset_parser::lex::scanner::scan;
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::lex::token::Token;
use zeroset_parser::lex::token_kind::TokenKind::{self, Equals, X, Y, Z};
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Note, NoteKind, Span};

/// Number of keys that a note quotes.
const MAX_KEYS: usize = 6;

/// Reads a text of another format; `None` for any other text.
pub(crate) fn foreign_text(text: &str, limits: &Limits) -> Fallible<Option<ForeignText>> {
    let is_mathmod = text.trim_start().starts_with('{') && text.contains("\"Fxyz\"");
    if !is_mathmod && !text.starts_with("type=implicit;") {
        return scheme(text, limits);
    }
    let lower = text.to_ascii_lowercase();
    let find = |key: &str| if is_mathmod { string(&lower, key) } else { setting(&lower, key) };
    let has_more = is_mathmod
        && ["const", "funct", "varu", "cnd"]
            .iter()
            .any(|key| lower.contains(&format!("\"{key}\"")));
    let formula = find(if is_mathmod { "fxyz" } else { "equation" }).filter(|_| !has_more);
    let Some(formula) = formula else {
        let kind = ErrorKind::Format {
            format: "MathMod",
            read: "only one `Fxyz` without constants and functions is read",
            help: "paste one formula of `Fxyz` alone, and each constant as a line `a = 1`",
        };
        return Err(Error::new(Span::at(0), kind));
    };
    // `CalcPlot3D` writes `~` for the equals sign.
    let sign = text[formula.clone()].find('~').map_or(formula.end, |at| formula.start + at);
    let mut statement = part(text, formula.start..sign, limits)?;
    if sign < formula.end {
        statement.push(Token::new(Equals, Span::new(sign, sign + 1)));
        statement.extend(part(text, sign + 1..formula.end, limits)?);
    }
    let (mut ranges, mut axes) = (Vec::new(), Vec::new());
    for (axis, letter) in [(X, 'x'), (Y, 'y'), (Z, 'z')] {
        let ends = ["min", "max"].map(|end| find(&format!("{letter}{end}")));
        if let [Some(low), Some(high)] = ends {
            let (low, high) = (part(text, low, limits)?, part(text, high, limits)?);
            ranges.push(PlotRange { name: None, low, high });
            axes.push(axis);
        }
    }
    let (domain, note) = Words { text }.domain(&ranges, &axes, statement[0].span);
    let left = unread_keys(&lower, is_mathmod, &axes);
    let span = statement[0].span;
    let left = left.map(|left| Note { span, kind: NoteKind::FileLeftOut { left } });
    let notes = note.into_iter().chain(left).collect();
    Ok(Some((std::iter::once(statement).chain(domain).collect(), notes)))
}

/// Quotes the keys of a file that are not read; `None` if all are read. `axes` have ranges.
fn unread_keys(text: &str, is_mathmod: bool, axes: &[TokenKind]) -> Option<String> {
    let ends =
        axes.iter().flat_map(|axis| ["min", "max"].map(|end| format!("{}{end}", axis.as_char())));
    let read: Vec<String> = ends.chain(["type", "equation", "fxyz"].map(str::to_owned)).collect();
    let keys: Vec<&str> = if is_mathmod {
        // A key whose value is a group has no value of its own.
        let pairs = text.split('"').skip(1).step_by(2).zip(text.split('"').skip(2).step_by(2));
        let value = |behind: &str| {
            let value = behind.trim_start().strip_prefix(':').map(str::trim_start);
            value.is_some_and(|value| !value.starts_with('{'))
        };
        pairs.filter(|(_, behind)| value(behind)).map(|(key, _)| key).collect()
    } else {
        text.split([';', '\n', '&'])
            .filter_map(|part| Some(part.split_once('=')?.0.trim()))
            .collect()
    };
    let mut left: Vec<String> = Vec::new();
    for key in keys.into_iter().filter(|key| !read.iter().any(|one| one == key)) {
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
    (!left.is_empty()).then(|| left.join(", "))
}

/// The only string in `"key": ["string"]`.
fn string(text: &str, key: &str) -> Option<Range<usize>> {
    let at = text.find(&format!("\"{key}\""))? + key.len() + 2;
    let open = at + text[at..].find('"')? + 1;
    let close = open + text[open..].find('"')?;
    text[close + 1..].trim_start().starts_with(']').then_some(open..close)
}

/// The value in `;key=value;`.
fn setting(text: &str, key: &str) -> Option<Range<usize>> {
    let at = text.find(&format!(";{key}="))? + key.len() + 2;
    Some(at..at + text[at..].find([';', '\n', '&']).unwrap_or(text.len() - at))
}

/// The tokens of a part of the text, which must be one statement.
fn part(text: &str, range: Range<usize>, limits: &Limits) -> Fallible<Vec<Token>> {
    let kept = format!("{}{}", " ".repeat(range.start), &text[range.clone()]);
    let mut statements = scan(&kept, limits)?;
    let only = statements.pop().filter(|_| statements.is_empty());
    only.ok_or_else(|| Error::new(Span::new(range.start, range.end), ErrorKind::Unfinished))
}
