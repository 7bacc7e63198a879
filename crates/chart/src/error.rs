//! Errors, each with one message for the user.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Reasons why nothing was measured or charted.
#[derive(Debug, Error)]
pub enum ChartError {
    /// No surface has this name.
    #[error("there is no surface '{name}'; {ten} or a name of `zeroset gallery --list`")]
    UnknownSurface {
        /// The name that was given.
        name: String,
        /// Names of the ten surfaces of this crate.
        ten: String,
    },
    /// No case has this name.
    #[error("there is no case '{0}' in tests/data/stability")]
    UnknownCase(String),
    /// This version has no method with this name. Another version wrote the row.
    #[error("there is no method '{0}'")]
    UnknownMethod(String),
    /// A surface cannot be drawn or judged.
    #[error("{surface}: {why}")]
    ChartSurface {
        /// The surface's name.
        surface: String,
        /// The cause, as one phrase.
        why: String,
    },
    /// A file or directory cannot be read or written.
    #[error("{path}: {why}", path = path.display())]
    File {
        /// The file or directory.
        path: PathBuf,
        /// The cause.
        why: std::io::Error,
    },
    /// A file has invalid content.
    #[error("{path}: {why}", path = path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// The cause, as one phrase.
        why: String,
    },
    /// A chart could not be drawn.
    #[error("the chart {name} cannot be drawn: {why}")]
    Chart {
        /// The chart's name.
        name: String,
        /// The cause, as one phrase.
        why: String,
    },
}

impl ChartError {
    /// For `map_err`: turns an error of a surface into a [`ChartError`].
    pub fn of_surface<E: ToString>(surface: &str) -> impl Fn(E) -> Self {
        move |why| Self::ChartSurface { surface: surface.to_owned(), why: why.to_string() }
    }

    /// For `map_err`: turns an error of a chart into a [`ChartError`].
    pub fn of_chart<E: ToString>(name: &str) -> impl Fn(E) -> Self {
        move |why| Self::Chart { name: name.to_owned(), why: why.to_string() }
    }

    /// For `map_err`: turns an I/O error of a file into a [`ChartError`].
    pub fn of_file(path: &Path) -> impl Fn(std::io::Error) -> Self {
        move |why| Self::File { path: path.to_owned(), why }
    }

    /// For `map_err`: turns an error in a file's content into a [`ChartError`].
    pub fn of_content<E: ToString>(path: &Path) -> impl Fn(E) -> Self {
        move |why| Self::Content { path: path.to_owned(), why: why.to_string() }
    }
}
