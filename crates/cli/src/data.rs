//! The directory for data that outlast the program: history, last document, recent files, number
//! of tips shown.

use super::output::OutputFile;
use std::path::{Path, PathBuf};

/// Returns the data directory, created if missing. `None` if it cannot be created.
pub fn data_directory() -> Option<PathBuf> {
    let directory = directory_for_data()?.join("zeroset");
    std::fs::create_dir_all(&directory).ok()?;
    Some(directory)
}

/// The directory in which programs have their data, by the custom of the system. On every system
/// the variable `XDG_DATA_HOME` names another one.
fn directory_for_data() -> Option<PathBuf> {
    let from =
        |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    from("XDG_DATA_HOME").or_else(|| {
        if cfg!(windows) {
            return from("LOCALAPPDATA");
        }
        let below =
            if cfg!(target_os = "macos") { "Library/Application Support" } else { ".local/share" };
        Some(from("HOME")?.join(below))
    })
}

/// Stores a text in the data directory at once, so that it is not lost if the program crashes.
pub fn store_text(name: &str, text: &str) {
    let Some(directory) = data_directory() else { return };
    // Failing to store the text is no reason to stop.
    if let Ok(output) = OutputFile::create(&directory.join(name)) {
        let _ = output.finish(|out| writeln!(out, "{text}"));
    }
}

/// The file with the recent files' paths, one a line, and the greatest number of them.
const RECENT: &str = "recent";
const MOST_RECENT: usize = 20;

/// Paths of the files that were opened or saved last, the latest first.
pub fn recent_files() -> Vec<String> {
    let read = |directory: PathBuf| std::fs::read_to_string(directory.join(RECENT)).ok();
    let text = data_directory().and_then(read).unwrap_or_default();
    text.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect()
}

/// Puts a file at the front of the recent files.
pub fn note_file(path: &Path) {
    let Ok(path) = path.canonicalize() else { return };
    // A path that is not one line of text cannot be listed.
    let Some(name) = path.to_str().filter(|name| !name.contains('\n')) else { return };
    let others = recent_files().into_iter().filter(|other| other != name);
    let all: Vec<String> = [name.to_owned()].into_iter().chain(others).take(MOST_RECENT).collect();
    store_text(RECENT, &all.join("\n"));
}
