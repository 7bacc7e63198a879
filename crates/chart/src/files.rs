//! Atomic writing of files.

use crate::error::ChartError;
use serde::Serialize;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Writes a file atomically: a temporary file is written and then renamed.
///
/// # Errors
/// If the file cannot be written.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), ChartError> {
    let refuse = ChartError::of_file(path);
    let directory = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(directory).map_err(&refuse)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".zeroset-").suffix(".part");
    // A temporary file is readable by its owner only. Results get the usual permissions.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut file = builder.tempfile_in(directory).map_err(&refuse)?;
    file.write_all(bytes).map_err(&refuse)?;
    file.persist(path).map_err(|error| refuse(error.error))?;
    Ok(())
}

/// Writes rows as a CSV table with a header, atomically.
///
/// # Errors
/// If the table cannot be written.
pub fn write_csv<R: Serialize>(
    path: &Path,
    rows: impl IntoIterator<Item = R>,
) -> Result<(), ChartError> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    for row in rows {
        csv.serialize(row).map_err(ChartError::of_content(path))?;
    }
    write(path, &csv.into_inner().map_err(ChartError::of_content(path))?)
}
