//! The directory for what outlives the program: history, the last document, which tips were shown.

use super::output::Output;
use std::path::PathBuf;

/// Where history and the last document are kept, or `None` if there is no place for them.
pub fn data_directory() -> Option<PathBuf> {
    let from = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
    let base = from("XDG_DATA_HOME")
        .map(PathBuf::from)
        .or_else(|| Some(PathBuf::from(from("HOME")?).join(".local/share")))?;
    let directory = base.join("zeroset");
    std::fs::create_dir_all(&directory).ok()?;
    Some(directory)
}

/// Keeps a text under this name, so that it is there after whatever ends the program.
pub fn keep(name: &str, text: &str) {
    let Some(directory) = data_directory() else { return };
    // What cannot be kept is no reason to stop.
    if let Ok(output) = Output::create(&directory.join(name)) {
        let _ = output.finish(|out| writeln!(out, "{text}"));
    }
}
