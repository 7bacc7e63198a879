//! A rectangle of a picture's pixels, whose layers are kept at the same time.
//!
//! Colors and edges depend on the pixels beside, so the pixels around a block are traced, too.

use std::ops::Range;
use zeroset_trace::{BAND_ROWS, RayGrid};

/// A rectangle of pixels. It begins and ends at multiples of [`BAND_ROWS`] or at the picture's
/// border, so that tracers form the same tiles as in the whole picture.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub columns: Range<usize>,
    pub rows: Range<usize>,
}

/// Divides a range at a multiple of [`BAND_ROWS`] into halves. `range` becomes the first. `None` if
/// it is too short.
fn halve(range: &mut Range<usize>) -> Option<Range<usize>> {
    let middle = range.start + (range.len() / 2).next_multiple_of(BAND_ROWS);
    (middle < range.end).then(|| {
        let rest = middle..range.end;
        range.end = middle;
        rest
    })
}

impl Block {
    /// Blocks that cover the picture, each with at most about `pixels` pixels. Patches are not
    /// divided.
    pub fn of_picture(rays: &RayGrid, pixels: usize) -> Vec<Self> {
        let (width, height) = (rays.width(), rays.height());
        if rays.is_patched() {
            return vec![Self { columns: 0..width, rows: 0..height }];
        }
        let rows = (pixels / width.max(1) / BAND_ROWS).max(1) * BAND_ROWS;
        let block = |top: usize| Self { columns: 0..width, rows: top..(top + rows).min(height) };
        (0..height).step_by(rows).map(block).collect()
    }

    /// Divides the block: first into bands, then a band into columns. Returns the part that is cut
    /// off. `None` if the block is as small as can be.
    pub fn halve(&mut self, rays: &RayGrid) -> Option<Self> {
        if rays.is_patched() {
            return None;
        }
        let rows = halve(&mut self.rows).map(|rows| Self { rows, ..self.clone() });
        rows.or_else(|| halve(&mut self.columns).map(|columns| Self { columns, ..self.clone() }))
    }

    /// The block, extended on each side by [`BAND_ROWS`] pixels that lie in the picture.
    pub fn known(&self, rays: &RayGrid) -> Self {
        let around = |range: &Range<usize>, end: usize| {
            range.start.saturating_sub(BAND_ROWS)..(range.end + BAND_ROWS).min(end)
        };
        Self {
            columns: around(&self.columns, rays.width()),
            rows: around(&self.rows, rays.height()),
        }
    }

    /// The block's part of the rays.
    pub fn rays(&self, rays: &RayGrid) -> RayGrid {
        if rays.is_patched() {
            return rays.clone();
        }
        rays.part(self.columns.clone(), self.rows.clone())
    }

    /// The block's part of `all`, which has an element for each pixel of the picture or is empty.
    pub fn part(&self, all: &[bool], width: usize) -> Vec<bool> {
        if all.is_empty() {
            return Vec::new();
        }
        self.pixels_of(self, width).map(|(pixel, _)| all[pixel]).collect()
    }

    /// The indices of the block's pixels, first in the picture, then in the block `known`, which
    /// contains it.
    pub fn pixels_of(&self, known: &Self, width: usize) -> impl Iterator<Item = (usize, usize)> {
        let [left, top] = [known.columns.start, known.rows.start];
        let own = known.columns.len();
        self.rows.clone().flat_map(move |row| {
            let columns = self.columns.clone();
            columns.map(move |column| (row * width + column, (row - top) * own + column - left))
        })
    }

    /// Sets the elements of `all` for those of the block's pixels whose element of `part` is set.
    pub fn mark(&self, part: &[bool], all: &mut [bool], width: usize) {
        self.pixels_of(self, width).for_each(|(pixel, own)| all[pixel] |= part[own]);
    }

    /// Returns whether the pixel with this index in a picture of this width is in the block.
    pub fn contains(&self, pixel: usize, width: usize) -> bool {
        self.rows.contains(&(pixel / width)) && self.columns.contains(&(pixel % width))
    }
}
