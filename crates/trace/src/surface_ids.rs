//! The surface that is painted in each pixel.

use std::ops::{Index, Range};

/// The id of the surface that is painted, per pixel; meaningless where the background shows. If all
/// pixels have the same id, as in most pictures, it is stored once.
#[derive(Clone, Debug, Default)]
pub struct SurfaceIds {
    all: u16,
    /// Empty if all pixels have the id `all`.
    each: Vec<u16>,
}

impl SurfaceIds {
    /// Gives all pixels the same id.
    pub fn fill(&mut self, number: u16) {
        self.all = number;
        self.each.clear();
    }

    /// Gives one of `pixels` pixels an id.
    ///
    /// # Panics
    /// If there is no such pixel.
    pub fn set(&mut self, pixel: usize, number: u16, pixels: usize) {
        assert!(pixel < pixels, "pixel {pixel} of {pixels}");
        if self[pixel] != number {
            self.each.resize(pixels, self.all);
            self.each[pixel] = number;
        }
    }

    /// Keeps only the given pixels.
    pub(crate) fn crop(&mut self, pixels: &Range<usize>) {
        self.each.truncate(pixels.end);
        self.each.drain(..pixels.start.min(self.each.len()));
    }

    /// The ids of the given pixels.
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

/// The ids of neighboring pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct SurfaceIdSlice<'a> {
    /// The id of all pixels, if `each` is empty.
    pub all: u16,
    /// One id per pixel, or empty.
    pub each: &'a [u16],
}
