//! What can go wrong, each with one message for the user.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why nothing was measured, or charted.
#[derive(Debug, Error)]
pub enum ChartError {
    /// No such surface.
    #[error("there is no surface '{name}'; {ten} or a name of `zeroset gallery --list`")]
    UnknownSurface {
        /// What was asked for.
        name: String,
        /// The names of the ten.
        ten: String,
    },
    /// No such case.
    #[error("there is no case '{0}' in tests/data/stability")]
    UnknownCase(String),
    /// No such method: a row was made by another version.
    #[error("there is no method '{0}'")]
    UnknownMethod(String),
    /// A surface has no picture, or none that can be judged.
    #[error("{surface}: {why}")]
    Surface {
        /// Its name.
        surface: String,
        /// One phrase.
        why: String,
    },
    /// A file or directory cannot be read or written.
    #[error("{path}: {why}", path = path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        why: std::io::Error,
    },
    /// A file is there, and is not what it should be.
    #[error("{path}: {why}", path = path.display())]
    Content {
        /// Which.
        path: PathBuf,
        /// One phrase.
        why: String,
    },
    /// A chart could not be drawn.
    #[error("the chart {name} cannot be drawn: {why}")]
    Chart {
        /// Which.
        name: String,
        /// One phrase.
        why: String,
    },
}

impl ChartError {
    /// For `map_err`: of a surface.
    pub fn of_surface<E: ToString>(surface: &str) -> impl Fn(E) -> Self {
        move |why| Self::Surface { surface: surface.to_owned(), why: why.to_string() }
    }

    /// For `map_err`: of a chart.
    pub fn of_chart<E: ToString>(name: &str) -> impl Fn(E) -> Self {
        move |why| Self::Chart { name: name.to_owned(), why: why.to_string() }
    }

    /// For `map_err`: of a file.
    pub fn of_file(path: &Path) -> impl Fn(std::io::Error) -> Self {
        move |why| Self::File { path: path.to_owned(), why }
    }

    /// For `map_err`: of what is in a file.
    pub fn of_content<E: ToString>(path: &Path) -> impl Fn(E) -> Self {
        move |why| Self::Content { path: path.to_owned(), why: why.to_string() }
    }
}
