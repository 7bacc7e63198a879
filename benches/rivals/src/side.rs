//! The interface of a renderer.

use anyhow::Result;

/// A renderer that is prepared for one surface and size.
pub trait Side {
    /// Name in the table.
    fn name(&self) -> String;

    /// Side of the square picture, in pixels.
    fn size(&self) -> usize;

    /// Number of pictures per call of [`Side::draw`].
    fn pictures(&self) -> usize {
        1
    }

    /// Draws the picture; this call is measured.
    ///
    /// # Errors
    /// If it cannot draw.
    fn draw(&mut self) -> Result<()>;

    /// Distances of the last picture from the eye in world units, row by row from the top. Pixels
    /// of the background have infinity.
    fn distances(&self) -> Vec<f64>;

    /// Number and size of the calls for bounds of f in the last picture, if they are counted.
    fn enclosure_calls(&self) -> Option<EnclosureCalls> {
        None
    }

    /// A remark, if the picture does not show exactly the zero set.
    fn remark(&self) -> Option<String> {
        None
    }
}

/// Calls for bounds of a function.
#[derive(Clone, Copy, Debug)]
pub struct EnclosureCalls {
    /// Number of calls.
    pub calls: u64,
    /// Mean number of boxes per call.
    pub lanes: f64,
}
