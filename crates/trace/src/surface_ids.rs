//! Ids of the surfaces that are painted in a picture's pixels.

use std::ops::{Index, Range};

/// The id of the painted surface, for each pixel. Meaningless if nothing is painted. If all pixels
/// have the same id, as in most pictures, it is stored once.
#[derive(Clone, Debug, Default)]
pub struct SurfaceIds {
    all: u16,
    /// Empty if all pixels have the id `all`.
    each: Vec<u16>,
}

impl SurfaceIds {
    /// Gives all pixels the id `number`.
    pub fn fill(&mut self, number: u16) {
        self.all = number;
        self.each.clear();
    }

    /// Gives a pixel the id `number`. `pixels` is the number of all pixels.
    ///
    /// # Panics
    /// If `pixel` is not below `pixels`.
    pub fn set(&mut self, pixel: usize, number: u16, pixels: usize) {
        assert!(pixel < pixels, "pixel {pixel} of {pixels}");
        if self[pixel] != number {
            self.each.resize(pixels, self.all);
            self.each[pixel] = number;
        }
    }

    /// Removes all pixels outside the range.
    pub(crate) fn crop(&mut self, pixels: &Range<usize>) {
        self.each.truncate(pixels.end);
        self.each.drain(..pixels.start.min(self.each.len()));
    }

    /// The ids of the pixels in the range.
    pub fn part(&self, pixels: Range<usize>) -> SurfaceIdSlice<'_> {
        SurfaceIdSlice { all: self.all, each: self.each.get(pixels).unwrap_or_default() }
    }
}

impl Index<usize> for SurfaceIds {
    type Output = u16;

    fn index(&self, pixel: usize) -> &u16 {
        if self.each.is_empty() { &self.all } else { &self.each[pixel] }
    }
}

/// The ids of adjacent pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceIdSlice<'a> {
    /// The id of all pixels if `each` is empty.
    pub all: u16,
    /// One id per pixel. Empty if all have the id `all`.
    pub each: &'a [u16],
}
