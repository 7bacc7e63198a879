//! Messages on standard error.

use super::terminal;
use std::io::{IsTerminal, Write};

/// An error message that is already formatted, with carets and a suggestion.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct FormattedError(pub String);

/// Prints an error and its causes on one line. Prints a [`FormattedError`] unchanged.
pub fn error(error: &anyhow::Error) {
    if let Some(diagnostic) = error.downcast_ref::<FormattedError>() {
        return say(&diagnostic.0);
    }
    say(&format!("{}: {error:#}", label("error", "31")));
}

/// Prints a note, which is not an error.
pub fn note(text: &str) {
    say(&format!("{}: {text}", label("note", "36")));
}

/// Writes to standard error. A failure is ignored, since nothing could report it.
pub fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Whether standard error takes colors: it is a terminal other than `dumb`, and `NO_COLOR` is empty
/// or not set (no-color.org).
pub fn colored() -> bool {
    std::io::stderr().is_terminal() && colors_are_wanted()
}

/// Whether standard output takes colors, by the rule of [`colored`].
pub fn colored_output() -> bool {
    std::io::stdout().is_terminal() && colors_are_wanted()
}

fn colors_are_wanted() -> bool {
    std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
        && std::env::var_os("TERM").is_none_or(|terminal| terminal != "dumb")
        && terminal::takes_escapes()
}

fn label(word: &str, code: &str) -> String {
    if colored() { format!("\x1b[1;{code}m{word}\x1b[0m") } else { word.to_owned() }
}
