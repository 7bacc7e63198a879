//! Where a document came from.

use std::fmt;
use std::path::PathBuf;
use zeroset_scene::gallery::Example;

/// Where a document came from; shown as what it is called in messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DocumentSource {
    /// The keyboard, or an argument.
    #[default]
    Typed,
    /// What is called so and can be read but once, such as standard input.
    Stream(String),
    /// The gallery.
    Gallery(Example),
    /// This file, which it may be saved to.
    File(PathBuf),
}

impl fmt::Display for DocumentSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Typed => f.write_str("formula"),
            Self::Stream(name) => f.write_str(name),
            Self::Gallery(example) => f.write_str(example.slug),
            Self::File(path) => path.display().fmt(f),
        }
    }
}
