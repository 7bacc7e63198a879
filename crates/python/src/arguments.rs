//! Arguments of Python functions as settings of the library.

use crate::error::{exception, wrong};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;
use zeroset::{Background, Domain, Precision, UndecidedStyle};

/// A domain: a word, half the edge of a cube around the origin, or ranges of x, y and z.
#[derive(FromPyObject)]
pub enum DomainArgument {
    /// Half the edge of a cube.
    #[pyo3(transparent)]
    Cube(f64),
    /// The word `auto`.
    #[pyo3(transparent)]
    Word(String),
    /// Lower and upper end of x, y and z.
    #[pyo3(transparent)]
    Box([[f64; 2]; 3]),
}

/// The domain that an argument sets. Without an argument, it is the text's domain.
pub fn domain(argument: Option<DomainArgument>) -> PyResult<Domain> {
    match argument {
        None => Ok(Domain::Text),
        Some(DomainArgument::Cube(half)) => Ok([-half..=half, -half..=half, -half..=half].into()),
        Some(DomainArgument::Box(ranges)) => Ok(ranges.map(|[low, high]| low..=high).into()),
        Some(DomainArgument::Word(word)) if word == "auto" => Ok(Domain::Auto),
        Some(DomainArgument::Word(word)) => Err(wrong(format!(
            "domain={word:?}: a domain is a number, three pairs of numbers, or \"auto\""
        ))),
    }
}

/// The background of an argument: bytes of red, green and blue, or a word.
pub fn background(argument: &Bound<'_, PyAny>) -> PyResult<Background> {
    match argument.extract::<String>() {
        Ok(word) => chosen("background", &word, &[("transparent", Background::Transparent)]),
        Err(_) => Ok(argument.extract::<[u8; 3]>()?.into()),
    }
}

/// Reads a name, such as the name of a method.
pub fn named<T: FromStr<Err = zeroset::Error>>(name: &str) -> PyResult<T> {
    name.parse().map_err(|error: zeroset::Error| exception(&error))
}

/// Reads the name of one of these choices.
pub fn chosen<T: Copy>(what: &str, name: &str, choices: &[(&str, T)]) -> PyResult<T> {
    let found = choices.iter().find(|(known, _)| *known == name);
    found.map(|(_, choice)| *choice).ok_or_else(|| {
        let known = choices.iter().map(|(known, _)| format!("{known:?}")).collect::<Vec<_>>();
        wrong(format!("{what}={name:?}: known are {}", known.join(", ")))
    })
}

/// Names of precisions.
pub const PRECISIONS: [(&str, Precision); 3] =
    [("auto", Precision::Auto), ("f32", Precision::F32), ("f64", Precision::F64)];
/// Names of the appearances of undecided pixels.
pub const UNDECIDED: [(&str, UndecidedStyle); 4] = [
    ("shade", UndecidedStyle::Shade),
    ("hatch", UndecidedStyle::Hatch),
    ("tint", UndecidedStyle::Tint),
    ("miss", UndecidedStyle::Miss),
];

/// A number of seconds.
pub fn seconds(budget: f64) -> PyResult<Duration> {
    Duration::try_from_secs_f64(budget)
        .map_err(|_| wrong(format!("budget={budget}: seconds, at least 0")))
}

/// The rows of an array of points (N, 3).
pub fn points<'a>(name: &str, array: &'a PyReadonlyArray2<'_, f64>) -> PyResult<&'a [[f64; 3]]> {
    let [rows, columns] = [array.shape()[0], array.shape()[1]];
    if columns != 3 {
        return Err(wrong(format!("{name} has the shape ({rows}, {columns}), not (N, 3)")));
    }
    // The Python half gives contiguous arrays.
    let numbers = array.as_slice().map_err(|_| wrong(format!("{name} is not contiguous")))?;
    Ok(numbers.as_chunks::<3>().0)
}

/// The names under which pip knows modules.
const PACKAGES: [(&str, &str); 3] =
    [("PIL.Image", "pillow"), ("trimesh", "trimesh"), ("pyvista", "pyvista")];

/// Imports a module that is not among the package's requirements, for `user`.
pub fn import<'py>(py: Python<'py>, module: &str, user: &str) -> PyResult<Bound<'py, PyModule>> {
    py.import(module).map_err(|error| {
        let package = PACKAGES.iter().find(|(known, _)| *known == module);
        let package = package.map_or(module, |(_, package)| package);
        let message = format!("{user} needs {package}: pip install {package}");
        let missing = PyImportError::new_err(message);
        missing.set_cause(py, Some(error));
        missing
    })
}

/// The ends of a range.
pub fn ends(range: &RangeInclusive<f64>) -> [f64; 2] {
    [*range.start(), *range.end()]
}
