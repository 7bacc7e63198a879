//! Which surface is painted where.

use std::ops::{Index, Range};

/// The number of the surface that is painted, by pixel; meaningless where the background shows.
/// Where all pixels have the same, as in most pictures, nothing is kept by pixel.
#[derive(Clone, Debug, Default)]
pub struct SurfaceIds {
    all: u16,
    /// Empty if all have that number.
    each: Vec<u16>,
}

impl SurfaceIds {
    /// Gives all pixels a number.
    pub fn fill(&mut self, number: u16) {
        self.all = number;
        self.each.clear();
    }

    /// Gives one of so many pixels a number.
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

    /// Keeps only some pixels.
    pub fn crop(&mut self, pixels: &Range<usize>) {
        self.each.truncate(pixels.end);
        self.each.drain(..pixels.start.min(self.each.len()));
    }

    /// Those of some pixels.
    pub fn part(&self, pixels: Range<usize>) -> Numbers<'_> {
        Numbers { all: self.all, each: self.each.get(pixels).unwrap_or_default() }
    }
}

impl Index<usize> for SurfaceIds {
    type Output = u16;

    fn index(&self, pixel: usize) -> &u16 {
        if self.each.is_empty() { &self.all } else { &self.each[pixel] }
    }
}

/// The numbers of neighbouring pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Numbers<'a> {
    /// The number of all pixels, if `each` is empty.
    pub all: u16,
    /// Empty if all have that number.
    pub each: &'a [u16],
}
