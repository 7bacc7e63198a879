//! Finds where a document's text defines a value, and formats values. Knows definitions and their
//! ranges, but no pictures.

use std::borrow::Cow;
use std::ops::Range;
use zeroset_parser::Limits;
use zeroset_parser::tree::ast::Statement;
use zeroset_scene::number::number;
use zeroset_syntax::parse;

/// Name of the time.
pub(super) const TIME: &str = "t";

/// Place of a value's definition in a text.
pub(super) struct Place {
    /// Byte range of the value.
    pub body: Range<usize>,
    /// Byte ranges of the lower and the upper end of the value's range.
    pub range: Option<(Range<usize>, Range<usize>)>,
}

/// Finds the last definition of `name` as a value.
pub(super) fn place(text: &str, name: &str) -> Option<Place> {
    let statements = parse(text, &Limits::default()).ok()?;
    statements.iter().rev().find_map(|one| match one {
        Statement::Define(definition)
            if definition.name.text == name && definition.parameters.is_none() =>
        {
            let body = definition.body.span.range();
            let range = definition.range.as_ref();
            let range = range.map(|(low, high)| (low.span.range(), high.span.range()));
            // Definitions that the parser adds are not in the text.
            (!body.is_empty() && body.end <= text.len()).then_some(Place { body, range })
        }
        Statement::Define(_) | Statement::Draw { .. } | Statement::Curve(_) => None,
    })
}

/// The name that a statement defines, if any.
pub(super) fn name(statement: &Statement) -> Option<&str> {
    match statement {
        Statement::Define(definition) => Some(&definition.name.text),
        Statement::Draw { .. } | Statement::Curve(_) => None,
    }
}

/// A line, and a use of the coordinate that it may define: alone, `rho = 2` is a surface.
fn with_use(line: &str) -> Cow<'_, str> {
    let name = line.split('=').next().unwrap_or_default().trim();
    if ["r", "rho", "theta", "phi"].contains(&name) {
        format!("{line}\n0 = {name}").into()
    } else {
        line.into()
    }
}

/// The names that a line defines. Empty for a formula, and for a line with errors.
pub fn defined(line: &str) -> Vec<String> {
    let statements = parse(&with_use(line), &Limits::default()).unwrap_or_default();
    statements.iter().filter_map(name).map(str::to_owned).collect()
}

/// The value of `name` as typed, and the right side of its definition, which includes the range.
pub(super) fn right_side(text: &str, name: &str) -> Option<(String, String)> {
    let Place { body, range } = place(text, name)?;
    let value = text.get(body.clone())?.to_owned();
    let side = match range {
        Some((low, high)) => format!("{value} in [{}, {}]", text.get(low)?, text.get(high)?),
        None => value.clone(),
    };
    Some((value, side))
}

/// Returns the range that `text` gives to `name`, as an ending for `line`, a new definition of
/// `name`. The range is widened to hold the new value. `None` if `text` gives no range, if `line`
/// gives one, or if a value is not a number.
pub(super) fn kept_range(text: &str, line: &str, name: &str) -> Option<String> {
    let (low, high) = place(text, name)?.range?;
    let Place { body, range: None } = place(&with_use(line), name)? else { return None };
    let (value, low, high) = (line.get(body)?, text.get(low)?, text.get(high)?);
    let (least, most, at) = (number(low)?, number(high)?, number(value)?);
    let low = if at < least { value } else { low };
    let high = if at > most { value } else { high };
    Some(format!(" in [{low}, {high}]"))
}

/// The shortest text that reads as this number.
pub(super) fn format_value(value: f64) -> String {
    let size = value.abs();
    // Write -0 as 0.
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
    fn numbers_are_written_so_that_they_are_read() {
        for value in [0.0, -0.0, 1.5, -2.25e-9, 3e18, 1e-6, 0.1 + 0.2] {
            assert_eq!(number(&format_value(value)), Some(value), "{value}");
        }
    }
}
