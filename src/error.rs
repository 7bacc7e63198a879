//! The library's error type, and messages that point into a text.

use std::fmt;
use std::ops::Range;
use std::path::Path;
use zeroset_parser::{Errors, Note, Span};
use zeroset_render::limit::Limit;
use zeroset_scene::view::SceneError;

/// Name of a text in messages. The command line uses the same name for a formula.
const TEXT_NAME: &str = "formula";

/// An error of this library.
///
/// `Display` is the message that the program `zeroset` prints. For an error in a text, it has
/// several lines, with a caret under each place:
///
/// ```
/// let error = zeroset::Function::parse("x^2 + foo(y)").unwrap_err();
/// assert!(error.to_string().starts_with("error: there is no function `foo`\n --> formula:1:7"));
/// assert_eq!(error.diagnostics()[0].span, 6..9);
/// ```
///
/// Other messages are one sentence. `Debug` prints the same as `Display`, so an error returned by
/// `main` is readable.
#[derive(Clone, PartialEq, Eq)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    diagnostics: Vec<Diagnostic>,
}

/// The cause of an [`Error`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The text breaks a rule of the language. [`Error::diagnostics`] tells where.
    Syntax,
    /// The text is valid, but its formula has no surface or is too large to compile.
    Formula,
    /// An argument or a setting is out of range.
    Argument,
    /// A file cannot be written.
    File,
}

/// A message about a place in a text: an error, or a note on how the text was read.
///
/// `Display` shows the line with a caret under the place.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Diagnostic {
    /// The message, in one line.
    pub message: String,
    /// The place in the text, in bytes.
    pub span: Range<usize>,
    /// A suggested correction: a range of bytes in the text, and its replacement.
    pub suggestion: Option<(Range<usize>, String)>,
    rendered: String,
}

impl Error {
    pub(crate) fn new(kind: ErrorKind, message: impl fmt::Display) -> Self {
        Self { kind, message: message.to_string(), diagnostics: Vec::new() }
    }

    pub(crate) fn argument(message: impl fmt::Display) -> Self {
        Self::new(ErrorKind::Argument, message)
    }

    /// The error of work that was not done when its limit ended it.
    pub(crate) fn unfinished(work: &str, limit: &Limit) -> Self {
        if limit.is_stopped() {
            return Self::argument(format!("{work} stopped"));
        }
        let seconds = limit.budget.unwrap_or_default().as_secs_f64();
        Self::argument(format!("{work} not done within {seconds} s"))
    }

    pub(crate) fn formula(message: impl fmt::Display) -> Self {
        Self::new(ErrorKind::Formula, message)
    }

    pub(crate) fn scene(error: SceneError) -> Self {
        match error {
            SceneError::Camera(error) => Self::argument(error),
            SceneError::Region(error) => Self::argument(error),
            SceneError::Program(error) => Self::formula(error),
            error @ SceneError::Far { .. } => Self::formula(error),
        }
    }

    pub(crate) fn file(path: &Path, error: &std::io::Error) -> Self {
        Self::new(ErrorKind::File, format!("cannot write '{}': {error}", path.display()))
    }

    pub(crate) fn syntax(errors: &Errors, text: &str) -> Self {
        let diagnostic = |error: &zeroset_parser::Error| Diagnostic {
            message: error.message(),
            span: error.span.range(),
            suggestion: error.suggestion.as_ref().map(|s| (s.span.range(), s.replacement.clone())),
            rendered: error.render(Some(TEXT_NAME), text, false),
        };
        Self {
            kind: ErrorKind::Syntax,
            message: errors.render(Some(TEXT_NAME), text, false),
            diagnostics: errors.iter().map(diagnostic).collect(),
        }
    }

    /// Returns the cause.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// Returns the errors in the text, in the order of their places. Empty unless the kind is
    /// [`ErrorKind::Syntax`].
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }
}

impl Diagnostic {
    pub(crate) fn note(note: &Note, text: &str) -> Self {
        let Note { span: Span { start, end }, .. } = *note;
        let rendered = note.render(Some(TEXT_NAME), text, false);
        Self { message: note.message(), span: start..end, suggestion: None, rendered }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.rendered)
    }
}
