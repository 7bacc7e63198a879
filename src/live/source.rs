//! Where a document came from.

use crate::gallery::Example;
use std::fmt;
use std::path::PathBuf;

/// Where a document came from; shown as what it is called in messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DocumentSource {
    /// The keyboard, or an argument.
    #[default]
    Typed,
    /// Standard input.
    Input,
    /// The gallery.
    Gallery(Example),
    /// This file, which it may be saved to.
    File(PathBuf),
}

impl fmt::Display for DocumentSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Typed => f.write_str("formula"),
            Self::Input => f.write_str("standard input"),
            Self::Gallery(example) => f.write_str(example.slug),
            Self::File(path) => path.display().fmt(f),
        }
    }
}
