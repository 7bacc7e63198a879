//! Charts as data, and how they are drawn.
//!
//! It knows nothing of surfaces and methods.

mod draw;
mod scale;

pub use draw::draw;
use scale::Scale;
pub use scale::written;

use crate::error::ChartError;
use crate::files::write;
use std::path::Path;

/// A chart.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// What its file is called, without extension.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// What the horizontal axis is, with its unit.
    pub x: String,
    /// What the vertical axis is, with its unit.
    pub y: String,
    /// Names of places 0, 1, 2 … of the horizontal axis, which is logarithmic if there are none.
    pub places: Vec<String>,
    /// What is drawn, from back to front.
    pub series: Vec<Series>,
    /// A wide pale line behind all others, and what it is.
    pub front: Option<(String, Vec<[f64; 2]>)>,
    /// A horizontal line.
    pub level: Option<f64>,
    /// Further lines of the legend.
    pub notes: Vec<String>,
}

impl Figure {
    /// Draws it into a directory.
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
pub struct Series {
    /// What the legend calls it; nothing if it does not.
    pub name: String,
    /// Which color.
    pub color: usize,
    /// How marks look.
    pub shape: Shape,
    /// Whether a line joins the marks.
    pub is_joined: bool,
    /// The marks.
    pub marks: Vec<Mark>,
    /// Thin lines behind them.
    pub behind: Vec<Vec<[f64; 2]>>,
}

/// One value.
#[derive(Clone, Debug, Default)]
pub struct Mark {
    /// Where it is.
    pub at: [f64; 2],
    /// A vertical bar through it.
    pub bar: Option<[f64; 2]>,
    /// A word beside it.
    pub label: String,
}

/// How marks look.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// A disc.
    #[default]
    Disc,
    /// A square.
    Square,
    /// A triangle.
    Triangle,
    /// Nothing but its bar, which is thick.
    Bar,
}
