//! The reply to an entered line, or its refusal. Knows neither documents nor commands.

use super::pipeline::missing_letter;
use zeroset_parser::Errors;
use zeroset_scene::program::ProgramError;

/// The reply to an entered line. Some replies ask the caller to do something.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// The line was carried out.
    Done,
    /// The line was carried out, and this message is to be shown.
    Say(String),
    /// The caller should find this document and pass it to [`Live::load`](super::Live::load).
    Load(String),
    /// The caller should write [`Live::text`](super::Live::text) to this file. `None` is the file
    /// that the document came from.
    Save(Option<String>),
    /// The caller should write the picture to this file. `None` is a file with a new name.
    Png(Option<String>),
    /// The caller should write the surfaces as triangles to this file.
    Mesh {
        /// The file. Its extension names the format.
        to: String,
        /// Largest distance between triangles and surface, in world units.
        tolerance: Option<f64>,
    },
    /// The caller should show the measures of the surfaces.
    Measure,
    /// The caller should show tips, or stop showing them.
    Tips(bool),
    /// The caller should show how the document was read and compiled.
    Explain {
        /// Set if the generated code is wanted.
        code: bool,
    },
    /// The caller should show the gallery.
    Gallery,
    /// The caller should quit.
    Quit,
}

/// Why a line was refused. The document is unchanged.
#[derive(Debug, thiserror::Error)]
pub enum Refusal {
    /// The document would have errors.
    #[error("{errors}")]
    Text {
        /// The text with the line entered.
        text: String,
        /// The errors in that text.
        errors: Errors,
    },
    /// A formula would have no surface: it is constant, or undefined everywhere.
    #[error("{0}")]
    Program(ProgramError),
    /// The command has an error.
    #[error("{0}")]
    Command(String),
}

impl Refusal {
    /// The undefined single letter, if no other error exists.
    pub fn missing_letter(&self) -> Option<char> {
        match self {
            Self::Text { errors, .. } => missing_letter(errors),
            Self::Program(_) | Self::Command(_) => None,
        }
    }

    /// The error message, with carets under the text if there is one.
    pub fn render(&self, color: bool) -> String {
        match self {
            Self::Text { text, errors } => errors.render(None, text, color),
            Self::Program(_) | Self::Command(_) => format!("error: {self}"),
        }
    }
}

// Returns a `Result`, as all command functions do.
#[allow(clippy::unnecessary_wraps)]
pub(super) fn say(text: String) -> Result<Reply, Refusal> {
    Ok(Reply::Say(text))
}

pub(super) fn refused<T>(message: String) -> Result<T, Refusal> {
    Err(Refusal::Command(message))
}

/// The error for a number outside 1 to `count`. `noun` says what is counted, such as surfaces.
pub(super) fn no_such(noun: &str, number: usize, count: usize) -> Refusal {
    Refusal::Command(match count {
        0 => "nothing is drawn".to_owned(),
        1 => format!("there is no {noun} {number}; there is only {noun} 1"),
        _ => format!("there is no {noun} {number}; they are numbered 1 to {count}"),
    })
}
