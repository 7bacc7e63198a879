//! Reads a text by the rules, or else as it was probably meant. Brackets that are open at the end
//! of a line are closed, or commas are read as decimal commas.

use crate::document::reading::{DocumentReader, Options};
use zeroset_parser::lex::decimal_comma::with_points;
use zeroset_parser::{ErrorKind, Errors};

/// Reads `text` by `read`, at first as it stands. If brackets are open at its end, reads it again
/// with them closed at the ends of their lines. If it has other errors, reads it again with decimal
/// commas between digits. If the second reading fails, returns the errors of the first.
pub(crate) fn with_other_readings<T>(
    text: &str,
    options: &Options<'_>,
    read: impl Fn(DocumentReader<'_>) -> Result<T, Errors>,
) -> Result<T, Errors> {
    let errors = match read(DocumentReader::new(text, options)) {
        Err(errors) => errors,
        found => return found,
    };
    if errors.iter().any(|error| matches!(error.kind, ErrorKind::Unclosed { .. })) {
        let mut reader = DocumentReader::new(text, options);
        reader.closes_brackets = true;
        return read(reader).map_err(|_| errors);
    }
    let Some((points, notes)) = with_points(text, &options.limits) else { return Err(errors) };
    let mut reader = DocumentReader::new(&points, options);
    reader.notes = notes;
    read(reader).map_err(|_| errors)
}
