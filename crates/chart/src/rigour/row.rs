//! One line of results: a kernel or a picture of a surface, in one precision and one arithmetic.

use serde::{Deserialize, Serialize};
use std::fmt;
use zeroset_jit::comparison::Arithmetic;

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Asked {
    /// Bounds over boxes, a sixteenth of the domain wide.
    Boxes,
    /// Segments of single rays, narrowed by affine forms.
    Segments,
    /// Tiles of rays, narrowed by affine forms.
    Tiles,
    /// Whole pictures traced by the method `affine`.
    Picture,
}

impl fmt::Display for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&format!("{self:?}").to_lowercase())
    }
}

/// What an arithmetic is called in results.
pub fn name(arithmetic: Arithmetic) -> String {
    format!("{arithmetic:?}").to_lowercase()
}

/// A line of results. Times are nanoseconds a lane, of pictures a pixel: medians and quartiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // names of columns
pub struct Row {
    pub surface: String,
    pub asked: Asked,
    pub precision: String,
    pub arithmetic: String,
    pub ns: f64,
    pub ns_lower: f64,
    pub ns_upper: f64,
    /// Over the time without rigour in the same round.
    pub times_unsound: f64,
    pub times_unsound_lower: f64,
    pub times_unsound_upper: f64,
    /// Of the kernel.
    pub code_bytes: Option<usize>,
    /// Of bounds, of what is left of segments, or of errors in tiles, over that of rounding up: the
    /// median over lanes.
    pub width: Option<f64>,
    /// Of bounds at single points, where there is nothing but rounding.
    pub width_at_points: Option<f64>,
    /// Pixels.
    pub undecided: Option<usize>,
    /// Pixels in a row, and rows.
    pub size: usize,
    pub repeats: usize,
    pub seed: u64,
    pub version: String,
    pub rustc: String,
    pub flags: String,
    pub processor: String,
}
