//! The directory for data that outlast the program: history, last document, number of tips shown.

use super::output::OutputFile;
use std::path::PathBuf;

/// Returns the data directory, created if missing. `None` if it cannot be created.
pub fn data_directory() -> Option<PathBuf> {
    let from = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let base = from("XDG_DATA_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(PathBuf::from(from("HOME")?).join(".local/share")))?;
    let directory = base.join("zeroset");
    std::fs::create_dir_all(&directory).ok()?;
    Some(directory)
}

/// Stores a text in the data directory at once, so that it is not lost if the program crashes.
pub fn store_text(name: &str, text: &str) {
    let Some(directory) = data_directory() else { return };
    // Failing to store the text is no reason to stop.
    if let Ok(output) = OutputFile::create(&directory.join(name)) {
        let _ = output.finish(|out| writeln!(out, "{text}"));
    }
}
