//! What a line that was entered leads to, or why it is refused. Knows neither documents nor
//! commands.

use super::pipeline::missing_letter;
use zeroset_scene::program::ProgramError;
use zeroset_syntax::Errors;

/// What a line that was entered leads to.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// It is done.
    Done,
    /// It is done, and this is to be shown.
    Say(String),
    /// The caller is to find this text and hand it to [`Live::load`](super::Live::load).
    Load(String),
    /// The caller is to write [`Live::text`](super::Live::text) to this file, or to where it came
    /// from.
    Save(Option<String>),
    /// The caller is to write the picture to this file, or to one with a new name.
    Png(Option<String>),
    /// The caller is to show tips, or no longer.
    Tips(bool),
    /// The caller is to show how the document was read and compiled, with the code or without.
    Explain {
        /// Whether the code is asked for.
        code: bool,
    },
    /// The caller is to show what is in the gallery.
    Gallery,
    /// The caller is to end.
    Quit,
}

/// Why a line was not entered. Nothing has changed then.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The document would be wrong.
    #[error("{errors}")]
    Text {
        /// What it would be.
        text: String,
        /// What is wrong with it.
        errors: Errors,
    },
    /// A formula would have no surface: it is constant, or defined nowhere.
    #[error("{0}")]
    Program(ProgramError),
    /// The command is wrong.
    #[error("{0}")]
    Command(String),
}

impl Refusal {
    /// The one letter that lacks a value, if that is all that is wrong.
    pub fn missing_letter(&self) -> Option<char> {
        match self {
            Self::Text { errors, .. } => missing_letter(errors),
            Self::Program(_) | Self::Command(_) => None,
        }
    }

    /// What is wrong, with carets under a text.
    pub fn render(&self, color: bool) -> String {
        match self {
            Self::Text { text, errors } => errors.render(None, text, color),
            Self::Program(_) | Self::Command(_) => format!("error: {self}"),
        }
    }
}

// What the shape of a result asks for, everywhere the same.
#[allow(clippy::unnecessary_wraps)]
pub(super) fn say(text: String) -> Result<Reply, Refusal> {
    Ok(Reply::Say(text))
}

pub(super) fn refused<T>(message: String) -> Result<T, Refusal> {
    Err(Refusal::Command(message))
}
