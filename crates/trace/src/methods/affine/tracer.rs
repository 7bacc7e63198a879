//! The state of a band while it is traced: the places of its tiles, and the pixels that are not
//! finished.

use super::Affine;
use super::classify::LengthLimits;
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

/// Pixels on the side of a tile, per level. Each tile holds sixteen of the next level.
pub(super) const SIDES: [usize; 2] = [16, 4];
/// Level of the tiles whose parts are rays.
pub(super) const LAST: usize = SIDES.len() - 1;

/// Minimum number of kernel calls between two checks whether the band is still wanted.
const CALLS_PER_CHECK: u64 = 16;

/// The state while a band is traced.
pub(super) struct BandTracer<'a, 'b, 'm, T: Scalar, S> {
    pub method: &'a Affine<'m, T>,
    pub rays: &'a RayGrid,
    pub frame: RayFrame,
    pub band: &'a mut Band<'b>,
    /// Per 4×4 tile, the pixels that are not finished, as bits.
    pub open: Vec<u16>,
    /// Number of 4×4 tiles in a row.
    pub across: usize,
    /// Screen coordinates of columns and of rows of pixels, in groups of four; unused for patches.
    pub screens: &'a [Vec<[f64; 4]>; 2],
    /// Largest |s| of a segment's end.
    pub size: f64,
    pub limits: LengthLimits<T>,
    pub memory: &'a mut RayBuffers<T>,
    pub work: &'a mut KernelStats,
    /// True if the rest of the band is no longer wanted.
    pub over: bool,
    /// Number of kernel calls at the last of these checks.
    pub calls_at_check: u64,
    /// Vector instructions of the processor.
    pub simd: S,
}

impl<T: Scalar, S: Simd> BandTracer<'_, '_, '_, T, S> {
    /// Returns the first and last column and row of a tile's pixels in the band.
    #[inline(always)]
    pub(super) fn pixels(&self, [column, row]: [usize; 2], level: usize) -> [[usize; 2]; 2] {
        let side = SIDES[level];
        let range = |place: usize, size: usize| [side * place, (side * place + side).min(size) - 1];
        [range(column, self.band.width), range(row, self.band.height)]
    }

    /// Returns the screen coordinate of the middle of a column of tiles, and the maximum distance
    /// of the tiles' rays from it.
    #[inline(always)]
    pub(super) fn across(&self, column: usize, level: usize) -> [f64; 2] {
        let [columns, _] = self.pixels([column, 0], level);
        self.extent(0, columns[0], columns[1])
    }

    /// Like [`Self::across`], for a row of tiles.
    #[inline(always)]
    pub(super) fn upward(&self, row: usize, level: usize) -> [f64; 2] {
        let top = self.band.top;
        if let Some(patch) = self.rays.patch(top + row) {
            return self.extent(1, patch.row, patch.row + 3);
        }
        let [_, rows] = self.pixels([0, row], level);
        self.extent(1, top + rows[0], top + rows[1])
    }

    /// Like [`Self::across`], for pixels `first` to `last` along an axis: columns (0) or rows (1).
    #[inline(always)]
    pub(super) fn extent(&self, axis: usize, first: usize, last: usize) -> [f64; 2] {
        let centre = self.rays.screen(first + last, first + last)[axis];
        [centre, (last - first) as f64 * self.rays.unit]
    }

    /// Returns the first column and row of these tiles, if they are 4×4 tiles of the last level
    /// with all pixels in the picture.
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

    /// Returns which tiles of a square have pixels that are not finished, as bits.
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

    /// Returns the part of a segment to examine, which is limited if the tile is a patch.
    pub(super) fn from(&self, place: [usize; 2], [near, far]: [f64; 2]) -> [f64; 2] {
        match self.rays.patch(self.band.top + place[1]) {
            Some(patch) => {
                let [from, until] = patch.between.map(|t| T::nearest(t - self.frame.start).into());
                [near.max(from), far.min(until)]
            }
            None => [near, far],
        }
    }

    /// Returns which of these lanes hold tiles whose remaining segments lie behind hits of other
    /// surfaces, as bits.
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

    /// Returns whether all rays of a tile, from s on, are behind hits of other surfaces.
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
        // The ray with the shortest direction has the least distance at s.
        let shortest = if self.rays.parallel { 1.0 } else { (1.0 + a * a + b * b).sqrt() };
        // A hit's bracket reaches no farther than this behind the painted point.
        let bracket = self.method.longest * self.footprint(s);
        let farthest = (self.frame.start + s - bracket) * shortest * (1.0 - ROUNDED);
        (rows[0]..=rows[1]).all(|row| {
            let some = row * self.band.width + columns[0]..=row * self.band.width + columns[1];
            let mut pixels = status[some.clone()].iter().zip(&drawn[some]);
            pixels.all(|(status, drawn)| *status == Status::Hit && *drawn <= farthest)
        })
    }

    /// Returns whether a tile has a pixel that is not finished.
    #[inline(always)]
    pub(super) fn is_open(&self, place: [usize; 2], level: usize) -> bool {
        self.any_in(&self.open, place, level)
    }

    /// Returns whether any bit of a tile is set, given the bits of each 4×4 tile.
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

    /// Returns the width of a pixel in units of s.
    #[inline(always)]
    pub(super) fn footprint(&self, s: f64) -> f64 {
        self.rays.footprint(self.frame.start + s)
    }

    /// Returns whether the rest of the band is no longer wanted. This is not checked at each call,
    /// since reading a clock takes as long as a short kernel call.
    #[inline(always)]
    pub(super) fn is_cancelled(&mut self) -> bool {
        let calls = self.work.tiles.calls + self.work.segments.calls;
        if calls >= self.calls_at_check + CALLS_PER_CHECK {
            (self.calls_at_check, self.over) = (calls, self.over || !self.band.is_wanted());
        }
        self.over
    }
}
