//! The state of a band while it is traced: the places of its tiles, and its unfinished pixels.

use super::Affine;
use super::classify::LengthLimits;
use super::coverage::Coverage;
use super::frame::RayFrame;
use super::level::Level;
use super::pixels::ROUNDED;
use super::pool::RayBuffers;
use crate::band::Band;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::painted::ones;
use crate::ray_result::Status;
use crate::scalar::Scalar;
use fearless_simd::prelude::*;
use std::ops::Range;

/// Number of pixels on the side of a tile, per level. A tile has sixteen parts of the next level.
pub(super) const SIDES: [usize; 2] = [16, 4];
/// The last level. Its tiles are split into rays.
pub(super) const LAST: usize = SIDES.len() - 1;

/// Minimum number of kernel calls between two checks for cancellation.
const CALLS_PER_CHECK: u64 = 16;

/// The state of a band while it is traced.
pub(super) struct BandTracer<'a, 'b, 'm, T: Scalar, S> {
    pub method: &'a Affine<'m, T>,
    pub rays: &'a RayGrid,
    pub frame: RayFrame,
    pub band: &'a mut Band<'b>,
    /// For each 4×4 tile, its unfinished pixels, as bits.
    pub open: Vec<u16>,
    /// Number of 4×4 tiles in a row of tiles.
    pub across: usize,
    pub coverage: &'a mut Coverage,
    /// Screen coordinates of columns and of rows of pixels, in groups of four. Unused for patches.
    pub screens: &'a [Vec<[f64; 4]>; 2],
    /// Largest |s| of a segment's ends.
    pub size: f64,
    pub limits: LengthLimits<T>,
    pub memory: &'a mut RayBuffers<T>,
    pub work: &'a mut KernelStats,
    /// Whether the band was canceled.
    pub over: bool,
    /// Number of kernel calls at the last check for cancellation.
    pub calls_at_check: u64,
    pub simd: S,
}

impl<T: Scalar, S: Simd> BandTracer<'_, '_, '_, T, S> {
    /// Returns a tile's first and last column in the band, then its first and last row.
    #[inline(always)]
    pub(super) fn pixels(&self, [column, row]: [usize; 2], level: usize) -> [[usize; 2]; 2] {
        let side = SIDES[level];
        let range = |place: usize, size: usize| [side * place, (side * place + side).min(size) - 1];
        [range(column, self.band.width), range(row, self.band.height)]
    }

    /// Returns the screen coordinate of the middle of a column of tiles, and the largest distance
    /// of the column's rays from the middle.
    #[inline(always)]
    pub(super) fn across(&self, column: usize, level: usize) -> [f64; 2] {
        let [columns, _] = self.pixels([column, 0], level);
        self.extent(0, columns[0], columns[1])
    }

    /// As [`Self::across`], for a row of tiles.
    #[inline(always)]
    pub(super) fn upward(&self, row: usize, level: usize) -> [f64; 2] {
        let top = self.band.top;
        if let Some(patch) = self.rays.patch(top + row) {
            return self.extent(1, patch.row, patch.row + 3);
        }
        let [_, rows] = self.pixels([0, row], level);
        self.extent(1, top + rows[0], top + rows[1])
    }

    /// As [`Self::across`], for pixels `first` to `last` on an axis: 0 for columns, 1 for rows.
    #[inline(always)]
    pub(super) fn extent(&self, axis: usize, first: usize, last: usize) -> [f64; 2] {
        let centre = self.rays.screen(first + last, first + last)[axis];
        [centre, (last - first) as f64 * self.rays.unit]
    }

    /// Returns the first column and row of a range of tiles, if they are a square of sixteen tiles
    /// of the last level. `None` if rays are in patches, or a pixel is outside of the band.
    #[inline(always)]
    pub(super) fn square(
        &self,
        [columns, rows]: &[Range<usize>; 2],
        level: usize,
    ) -> Option<[usize; 2]> {
        let side = SIDES[level];
        let is_square = level == LAST
            && !self.rays.is_patched()
            && (columns.len(), rows.len()) == (4, 4)
            && side * columns.end <= self.band.width
            && side * rows.end <= self.band.height;
        is_square.then_some([columns.start, rows.start])
    }

    /// Returns the tiles of a square that have unfinished pixels, as bits.
    #[inline(always)]
    pub(super) fn open_in_square(&self, [column, row]: [usize; 2]) -> u16 {
        let mut all = 0;
        for k in 0..4 {
            let first = (row + k) * self.across + column;
            for (tile, open) in self.open[first..first + 4].iter().enumerate() {
                all |= u16::from(*open != 0) << (4 * k + tile);
            }
        }
        all
    }

    /// Returns those of `lanes` whose remaining segments are [hidden](Self::is_hidden), as bits.
    #[inline(always)]
    pub(super) fn hidden_lanes(&self, level: &Level<T>, lanes: u16, depth: usize) -> u16 {
        if self.band.before.0.is_empty() {
            return 0;
        }
        let is_hidden = |lane: &usize| {
            self.is_hidden(level.place(*lane), depth, level.batch.near[*lane].into())
        };
        ones(lanes).filter(is_hidden).map(|lane| 1 << lane).sum()
    }

    /// Returns whether all rays of a tile, from s on, lie behind hits of other surfaces.
    pub(super) fn is_hidden(&self, place: [usize; 2], level: usize, s: f64) -> bool {
        let (status, drawn) = self.band.before;
        if status.is_empty() {
            return false;
        }
        let [columns, rows] = self.pixels(place, level);
        let aside = |axis: usize, [first, last]: [usize; 2]| {
            let [centre, half] = self.extent(axis, first, last);
            (centre.abs() - half).max(0.0)
        };
        let (a, b) = (aside(0, columns), aside(1, rows.map(|row| self.band.top + row)));
        // The ray of the tile with the shortest direction has the least distance at s.
        let shortest = if self.rays.parallel { 1.0 } else { (1.0 + a * a + b * b).sqrt() };
        // In space, it is at least this long.
        let shortest = shortest / self.rays.stretch().max_element();
        // The bracket of another surface's hit ends at most this far behind the painted point.
        let bracket = self.method.longest * self.footprint(s);
        let farthest = (self.frame.start + s - bracket) * shortest * (1.0 - ROUNDED);
        (rows[0]..=rows[1]).all(|row| {
            let some = row * self.band.width + columns[0]..=row * self.band.width + columns[1];
            let mut pixels = status[some.clone()].iter().zip(&drawn[some]);
            pixels.all(|(status, drawn)| *status == Status::Hit && *drawn <= farthest)
        })
    }

    /// Returns whether a tile has an unfinished pixel.
    #[inline(always)]
    pub(super) fn is_open(&self, place: [usize; 2], level: usize) -> bool {
        self.any_in(&self.open, place, level)
    }

    /// Returns whether any bit of a tile is set. `bits` has the bits of each 4×4 tile.
    #[inline(always)]
    fn any_in(&self, bits: &[u16], [column, row]: [usize; 2], level: usize) -> bool {
        if level == LAST {
            return bits[row * self.across + column] != 0;
        }
        let side = SIDES[level] / SIDES[LAST];
        let range = |place: usize, size: usize| side * place..(side * place + side).min(size);
        let (columns, rows) = (range(column, self.across), range(row, bits.len() / self.across));
        rows.into_iter().any(|row| {
            let start = row * self.across;
            let some = &bits[start + columns.start..start + columns.end];
            some.iter().fold(0, |any, bits| any | bits) != 0
        })
    }

    /// Returns the width of a pixel at s, in units of s.
    #[inline(always)]
    pub(super) fn footprint(&self, s: f64) -> f64 {
        self.rays.footprint(self.frame.start + s)
    }

    /// Returns whether the rest of the band is unwanted. Few calls check this, since reading a
    /// clock takes as long as a short kernel call.
    #[inline(always)]
    pub(super) fn is_cancelled(&mut self) -> bool {
        let calls = self.work.tiles.calls + self.work.segments.calls;
        if calls >= self.calls_at_check + CALLS_PER_CHECK {
            (self.calls_at_check, self.over) = (calls, self.over || !self.band.is_wanted());
        }
        self.over
    }
}
