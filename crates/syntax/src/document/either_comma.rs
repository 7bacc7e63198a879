//! Reads a text whose commas separate, or else are decimal.

use crate::document::reading::{DocumentReader, Options};
use zeroset_parser::Errors;
use zeroset_parser::lex::decimal_comma::with_points;

/// Reads `text` by `read`, at first with commas as separators. If that fails, reads all commas
/// between digits as decimal commas. If both fail, returns the errors of the first reading.
pub(crate) fn with_either_comma<T>(
    text: &str,
    options: &Options<'_>,
    read: impl Fn(DocumentReader<'_>) -> Result<T, Errors>,
) -> Result<T, Errors> {
    read(DocumentReader::new(text, options)).or_else(|errors| {
        let Some((points, notes)) = with_points(text, &options.limits) else { return Err(errors) };
        let mut reader = DocumentReader::new(&points, options);
        reader.notes = notes;
        read(reader).map_err(|_| errors)
    })
}
