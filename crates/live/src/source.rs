//! The source of a document.

use std::fmt;
use std::path::PathBuf;
use zeroset_scene::gallery::Example;

/// The source of a document. It is displayed as the name used in messages.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DocumentSource {
    /// The keyboard or a command-line argument.
    #[default]
    Typed,
    /// A named stream that can be read only once, such as standard input.
    Stream(String),
    /// An example of the gallery.
    Gallery(Example),
    /// A file, to which the document may be saved.
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
