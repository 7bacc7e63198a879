//! Errors as Python exceptions.

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use zeroset::ErrorKind;

pyo3::create_exception!(
    zeroset,
    Error,
    PyValueError,
    "A formula or an argument that cannot be used. The message of an error in a text shows the line \
     with a caret under the place."
);

/// The exception for an error of the library: `OSError` for files, else [`Error`].
pub fn exception(error: &zeroset::Error) -> PyErr {
    match error.kind() {
        ErrorKind::File => PyOSError::new_err(error.to_string()),
        _ => Error::new_err(error.to_string()),
    }
}

/// An [`Error`] with this message.
pub fn wrong(message: impl Into<String>) -> PyErr {
    Error::new_err(message.into())
}
