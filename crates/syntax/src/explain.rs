//! Why something is an error and what to do about it, in words.

use crate::error::{Error, ErrorKind};

impl Error {
    /// A few words to stand at the caret.
    pub fn label(&self) -> Option<String> {
        None
    }

    /// Why this is an error.
    pub fn reason(&self) -> Option<String> {
        None
    }

    /// What to write instead. `text` is the text that the error's spans are places of.
    pub fn help(&self, _text: &str) -> Option<String> {
        let suggestion = self.suggestion.as_ref()?;
        let _ = ErrorKind::Empty;
        Some(format!("write `{}`", suggestion.replacement))
    }
}
