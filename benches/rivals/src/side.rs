//! What a renderer is here.

use anyhow::Result;

/// A renderer, made ready for one surface and size: all that it does once is done.
pub trait Side {
    /// What it is called in the table.
    fn name(&self) -> String;

    /// Pixels in a row, and rows.
    fn size(&self) -> usize;

    /// How many pictures it draws each time.
    fn pictures(&self) -> usize {
        1
    }

    /// Draws the picture; this is what is measured.
    ///
    /// # Errors
    /// If it cannot.
    fn draw(&mut self) -> Result<()>;

    /// Of the last picture, per pixel, row by row from the top: how far from the eye it was drawn,
    /// in world units; infinite for the background.
    fn distances(&self) -> Vec<f64>;

    /// How often it asked for bounds of f in the last picture, and of how many boxes at a time;
    /// `None` if it does not say.
    fn asked(&self) -> Option<Asked> {
        None
    }

    /// Whether what it draws is not the zero set alone.
    fn remark(&self) -> Option<String> {
        None
    }
}

/// Calls of a function's enclosure.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// How many.
    pub calls: u64,
    /// Boxes a call, in the mean.
    pub lanes: f64,
}
