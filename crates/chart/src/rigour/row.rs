//! A row of results: a kernel or a picture of a surface, in one precision and one arithmetic.

use serde::{Deserialize, Serialize};
use std::fmt;
use zeroset_jit::comparison::Arithmetic;

/// The task that is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Workload {
    /// Bounds over boxes that are a sixteenth of the domain wide.
    Boxes,
    /// Narrowing of segments of single rays by affine forms.
    Segments,
    /// Narrowing of tiles of rays by affine forms.
    Tiles,
    /// Whole pictures traced by the method `affine`.
    Picture,
}

impl fmt::Display for Workload {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

/// Name of an arithmetic in results.
pub fn name(arithmetic: Arithmetic) -> String {
    format!("{arithmetic:?}").to_lowercase()
}

/// A row of results. Times are medians and quartiles, in nanoseconds per lane or per pixel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // names of columns
pub struct RigourRow {
    pub surface: String,
    pub asked: Workload,
    pub precision: String,
    pub arithmetic: String,
    pub ns: f64,
    pub ns_lower: f64,
    pub ns_upper: f64,
    /// Time relative to the unsound arithmetic in the same round.
    pub times_unsound: f64,
    pub times_unsound_lower: f64,
    pub times_unsound_upper: f64,
    /// Size of the kernel's code, in bytes.
    pub code_bytes: Option<usize>,
    /// Width of bounds, length of narrowed segments or error of tiles, as a multiple of the
    /// rounded-up kernel's: the median over lanes.
    pub width: Option<f64>,
    /// Width of bounds at single points, as a multiple of the rounded-up kernel's: the median over
    /// lanes. At points, all width comes from rounding.
    pub width_at_points: Option<f64>,
    /// Number of undecided pixels.
    pub undecided: Option<usize>,
    /// Side of the square picture, in pixels.
    pub size: usize,
    pub repeats: usize,
    pub seed: u64,
    pub version: String,
    pub rustc: String,
    pub flags: String,
    pub processor: String,
}
