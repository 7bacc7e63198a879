//! The interface of a renderer.

use anyhow::Result;
use zeroset_trace::PixelCounts;

/// A renderer that is prepared for one surface and size.
pub trait Side {
    /// Name of the renderer in the table.
    fn name(&self) -> String;

    /// Number of columns, and of rows, of the picture.
    fn size(&self) -> usize;

    /// Number of pictures per call of [`Side::draw`].
    fn pictures(&self) -> usize {
        1
    }

    /// Draws the picture; this call is measured.
    ///
    /// # Errors
    /// If the renderer cannot draw the picture.
    fn draw(&mut self) -> Result<()>;

    /// Returns the distances from the eye to what the last picture shows. They are in world units,
    /// row by row from the top; the background is at infinity.
    fn distances(&self) -> Vec<f64>;

    /// Calls that computed bounds of f for the last picture, if they are counted.
    fn enclosure_calls(&self) -> Option<EnclosureCalls> {
        None
    }

    /// Pixels of the last picture by status, for a renderer that proves something.
    fn pixels(&self) -> Option<PixelCounts> {
        None
    }

    /// Note on how the last picture was drawn.
    fn note(&self) -> Option<String> {
        None
    }

    /// Reason why the picture is not exactly the zero set, if it is not.
    fn remark(&self) -> Option<String> {
        None
    }
}

/// Calls that computed bounds of a function.
#[derive(Clone, Copy, Debug)]
pub struct EnclosureCalls {
    pub calls: u64,
    /// Mean number of boxes per call.
    pub lanes: f64,
}
