//! Values for letters without one, as in `(x/a)^2 + (y/b)^2 = 1`.

use super::Mistake;
use crate::document::reading::{self, Options};
use std::collections::BTreeSet;
use std::ops::Range;
use zeroset_parser::ErrorKind;

/// Largest number of letters that get a value.
const MOST_LETTERS: usize = 6;

/// The line that gives values to all letters of the statement at `place` that lack one. `None` if
/// the text then still has an error, or for a single letter, for which the usual advice is as good.
pub(super) fn missing(
    mistake: &Mistake<'_>,
    place: &Range<usize>,
    options: &Options<'_>,
) -> Option<String> {
    let mut letters = BTreeSet::new();
    let mut unknown = mistake.kind.clone();
    let definitions = loop {
        let ErrorKind::UnknownName { name, .. } = &unknown else { return None };
        let before = letters.len();
        let is_short = name.len() <= 2 && name.bytes().all(|c| c.is_ascii_alphabetic());
        letters.extend(name.chars().filter(|c| is_short && !"xyzteijXYZ".contains(*c)));
        if letters.len() == before || letters.len() > MOST_LETTERS {
            return None;
        }
        let values: Vec<String> = letters.iter().map(|letter| format!("{letter} = 1")).collect();
        let definitions = values.join("; ");
        let shift = definitions.len() + 1;
        // Above the text, since a program runs its statements in order.
        let Err(errors) = reading::read(&format!("{definitions}\n{}", mistake.text), options)
        else {
            break definitions;
        };
        let own = place.start + shift..=place.end + shift;
        match errors.iter().find(|error| own.contains(&error.span.start)) {
            Some(error) => unknown = error.kind.clone(),
            None => break definitions,
        }
    };
    let named: Vec<String> = letters.iter().map(|letter| format!("`{letter}`")).collect();
    (letters.len() > 1)
        .then(|| format!("give a value to {}: write `{definitions}`", named.join(", ")))
}
