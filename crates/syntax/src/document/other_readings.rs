//! Reads a text by the rules, or else as it was probably meant. Brackets that are open at the end
//! of a line are closed, or commas are read as decimal commas. Marks of lists are left out first.

use crate::document::list_marks::without_list_marks;
use crate::document::reading::{DocumentReader, Options};
use zeroset_parser::lex::decimal_comma::with_points;
use zeroset_parser::{ErrorKind, Errors, Note};

/// Reads `text` by `read`, without marks of lists. If that fails, reads it with them. If both fail,
/// returns the errors of the first reading.
pub(crate) fn with_other_readings<T>(
    text: &str,
    options: &Options<'_>,
    read: impl Fn(DocumentReader<'_>) -> Result<T, Errors>,
) -> Result<T, Errors> {
    if let Some((plain, notes)) = without_list_marks(text) {
        return closed_or_with_points(&plain, options, &notes, &read).or_else(|errors| {
            closed_or_with_points(text, options, &[], &read).map_err(|_| errors)
        });
    }
    closed_or_with_points(text, options, &[], &read)
}

/// Reads `text` by `read`, at first as it stands. If brackets are open at its end, reads it again
/// with them closed at the ends of their lines. If it has other errors, reads it again with decimal
/// commas between digits. If the second reading fails, returns the errors of the first. `own` are
/// notes on the text.
fn closed_or_with_points<T>(
    text: &str,
    options: &Options<'_>,
    own: &[Note],
    read: &impl Fn(DocumentReader<'_>) -> Result<T, Errors>,
) -> Result<T, Errors> {
    let new_reader = || {
        let mut reader = DocumentReader::new(text, options);
        reader.notes = own.to_vec();
        reader
    };
    let errors = match read(new_reader()) {
        Err(errors) => errors,
        found => return found,
    };
    if errors.iter().any(|error| matches!(error.kind, ErrorKind::Unclosed { .. })) {
        let mut reader = new_reader();
        reader.closes_brackets = true;
        return read(reader).map_err(|_| errors);
    }
    let Some((points, notes)) = with_points(text, &options.limits) else { return Err(errors) };
    let mut reader = DocumentReader::new(&points, options);
    reader.notes = own.iter().cloned().chain(notes).collect();
    read(reader).map_err(|_| errors)
}
