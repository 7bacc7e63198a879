//! Where a document's text defines a value, and the same text with another value there. Knows
//! definitions and their ranges, but nothing of pictures.

use super::draft::entered;
use crate::scene::number;
use std::ops::Range;
use zeroset_syntax::ast::{Definition, Statement};
use zeroset_syntax::{Limits, Span, parse};

/// Where the definition of one value stands in a text, in bytes.
struct Place {
    /// The value itself.
    body: Range<usize>,
    /// The lower and the upper end of its range.
    range: Option<(Range<usize>, Range<usize>)>,
}

impl Place {
    fn of(definition: &Definition) -> Self {
        let bytes = |span: Span| span.start..span.end;
        let range = definition.range.as_ref();
        Self {
            body: bytes(definition.body.span),
            range: range.map(|(low, high)| (bytes(low.span), bytes(high.span))),
        }
    }
}

/// Where `name` is defined as a value; the last definition counts.
fn place(text: &str, name: &str) -> Option<Place> {
    let statements = parse(text, &Limits::default()).ok()?;
    statements.iter().rev().find_map(|one| match one {
        Statement::Define(definition)
            if definition.name.text == name && definition.parameters.is_none() =>
        {
            let place = Place::of(definition);
            // What reading adds stands nowhere.
            (!place.body.is_empty() && place.body.end <= text.len()).then_some(place)
        }
        Statement::Define(_) | Statement::Draw { .. } => None,
    })
}

/// The names that a line defines.
pub(super) fn defined(line: &str) -> Vec<String> {
    let statements = parse(line, &Limits::default()).unwrap_or_default();
    let name = |one: Statement| match one {
        Statement::Define(definition) => Some(definition.name.text),
        Statement::Draw { .. } => None,
    };
    statements.into_iter().filter_map(name).collect()
}

/// A value and the whole right side of its definition, range included, as they were typed.
pub(super) fn right_side(text: &str, name: &str) -> Option<(String, String)> {
    let Place { body, range } = place(text, name)?;
    let value = text.get(body.clone())?.to_owned();
    let side = match range {
        Some((low, high)) => format!("{value} in [{}, {}]", text.get(low)?, text.get(high)?),
        None => value.clone(),
    };
    Some((value, side))
}

/// The range of a value, as it was typed.
fn typed_range(text: &str, name: &str) -> Option<(String, String)> {
    let (low, high) = place(text, name)?.range?;
    Some((text.get(low)?.to_owned(), text.get(high)?.to_owned()))
}

/// What is to follow `line`, a definition of `name`, so that the range which `text` gives it stays:
/// extended where the new value lies beyond; nothing if the line has a range or is no number.
pub(super) fn kept_range(text: &str, line: &str, name: &str) -> String {
    let kept = || {
        let (low, high) = typed_range(text, name)?;
        let Place { body, range: None } = place(line, name)? else { return None };
        let value = line.get(body)?;
        let (least, most, at) = (number(&low)?, number(&high)?, number(value)?);
        let low = if at < least { value } else { &low };
        let high = if at > most { value } else { &high };
        Some(format!(" in [{low}, {high}]"))
    };
    kept().unwrap_or_default()
}

/// The text with another value for `name`, and with this range if it has none; its definition is
/// added if there is none.
pub(super) fn with_value(text: &str, name: &str, value: &str, range: &str) -> Option<String> {
    let Some(Place { body, range: typed }) = place(text, name) else {
        // A text that lacks a value given on the command line is read with the definition only.
        let joined = format!("{}\n{name} = {value} in {range}", text.trim_end());
        return parse(&joined, &Limits::default()).is_ok().then_some(joined);
    };
    let with = |what: &str| format!("{}{what}{}", &text[..body.start], &text[body.end..]);
    if let Some((low, high)) = typed {
        let holds = || {
            let (low, high) = (number(&text[low])?, number(&text[high])?);
            Some((low..=high).contains(&number(value)?))
        };
        // One from the command line may lie beyond the range, and then so may its neighbours.
        let extended = || entered(text, &format!("{name} = {value}"), false);
        return Some(if holds() == Some(false) { extended() } else { with(value) });
    }
    // A program's definition, say, has no place for a range.
    let is_read = |new: &String| right_side(new, name).is_some_and(|(read, _)| read == value);
    [format!("{value} in {range}"), value.to_owned()].iter().map(|what| with(what)).find(is_read)
}

/// A number as it is typed, no longer than it need be.
pub(super) fn written(value: f64) -> String {
    let size = value.abs();
    // Zero has no sign.
    if value == 0.0 {
        "0".to_owned()
    } else if (1e-6..1e15).contains(&size) {
        value.to_string()
    } else {
        format!("{value:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_changed_where_it_stands() {
        for (text, value, expected) in [
            ("r = 2 in [0, 5] # radius\nx = r", "3.5", "r = 3.5 in [0, 5] # radius\nx = r"),
            ("r = 2 in [0, 5] # radius\nx = r", "7", "r = 7 in [0, 7] # radius\nx = r"),
            ("r = 2\nx = r", "-1", "r = -1 in [0, 9]\nx = r"),
            ("s = 1; r = -2; x = r", "0.5", "s = 1; r = 0.5 in [0, 9]; x = r"),
            ("x = r", "0.5", "x = r\nr = 0.5 in [0, 9]"),
        ] {
            assert_eq!(with_value(text, "r", value, "[0, 9]").as_deref(), Some(expected), "{text}");
        }
        let program = "float r = 0.5;\nfloat d = length(p) - r;";
        let new = with_value(program, "r", "0.75", "[0, 1]").expect("a value");
        assert!(parse(&new, &Limits::default()).is_ok(), "{new}");
        assert_eq!(right_side(&new, "r").map(|(value, _)| value).as_deref(), Some("0.75"));
    }

    #[test]
    fn numbers_are_written_so_that_they_are_read() {
        for value in [0.0, -0.0, 1.5, -2.25e-9, 3e18, 1e-6, 0.1 + 0.2] {
            assert_eq!(number(&written(value)), Some(value), "{value}");
        }
    }
}
