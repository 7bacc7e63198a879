//! Charts as data, and their drawing.
//!
//! This module knows nothing of surfaces and methods.

mod draw;
mod scale;

pub use draw::draw;
use scale::AxisScale;
pub use scale::written;

use crate::error::ChartError;
use crate::files::write;
use std::path::Path;

/// A chart, with its data and labels.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Name of its file, without extension.
    pub name: String,
    /// Title.
    pub title: String,
    /// Label of the horizontal axis, with its unit.
    pub x: String,
    /// Label of the vertical axis, with its unit.
    pub y: String,
    /// Names of the places 0, 1, 2 … on the horizontal axis. If empty, the axis is logarithmic.
    pub places: Vec<String>,
    /// The series, from back to front.
    pub series: Vec<PlotSeries>,
    /// Label and points of a wide pale line behind all other lines.
    pub front: Option<(String, Vec<[f64; 2]>)>,
    /// Value at which a horizontal line is drawn.
    pub level: Option<f64>,
    /// Further lines of the legend.
    pub notes: Vec<String>,
}

impl Figure {
    /// Draws the figure into a file of a directory.
    ///
    /// # Errors
    /// If it cannot be drawn or written.
    pub fn save(&self, directory: &Path) -> Result<(), ChartError> {
        let path = directory.join(&self.name).with_extension("svg");
        write(&path, draw(self)?.as_bytes())
    }
}

/// Marks of one color and shape.
#[derive(Clone, Debug, Default)]
pub struct PlotSeries {
    /// Name in the legend. If empty, the legend does not list the series.
    pub name: String,
    /// Number of the color of the series. Colors repeat after the last.
    pub color: usize,
    /// Shape of the marks.
    pub shape: MarkShape,
    /// True if a line joins the marks.
    pub is_joined: bool,
    /// Marks.
    pub marks: Vec<PlotMark>,
    /// Thin lines behind the marks.
    pub behind: Vec<Vec<[f64; 2]>>,
}

/// A value of a series.
#[derive(Clone, Debug, Default)]
pub struct PlotMark {
    /// Values on the horizontal and the vertical axis.
    pub at: [f64; 2],
    /// Ends of a vertical bar through the mark.
    pub bar: Option<[f64; 2]>,
    /// Text beside the mark.
    pub label: String,
}

/// Shapes of marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MarkShape {
    /// A disc.
    #[default]
    Disc,
    /// A square.
    Square,
    /// A triangle.
    Triangle,
    /// A thick bar without a mark.
    Bar,
}
