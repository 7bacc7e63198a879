//! The painted pixels of a picture, in windows: sixteen pixels of a row, computed together.
//!
//! This module does not depend on what is computed for the pixels.

use crate::ray_result::{Status, UndecidedReason};
use fearless_simd::{Level, f64x8, prelude::*, u8x16};
use zeroset_eval::LANES;
use zeroset_eval::dispatch;

/// Number of rows that one thread shades at a time: few enough for the nearest caches. Neither this
/// number nor the windows depend on the number of threads.
pub const SHADED_ROWS: usize = 8;

/// Sixteen adjacent pixels of a row, one per lane. A window may extend beyond the row and the
/// picture.
#[derive(Clone, Copy, Debug)]
pub struct PixelWindow {
    /// Column of the first pixel, from the left edge of the picture.
    pub column: usize,
    /// Row of the window, from the top of the picture.
    pub row: usize,
    /// Index of the window's first pixel in the arrays of the rows that are being processed.
    pub index: usize,
    /// Lanes whose pixels are painted and wanted, as bits. Lane 0 is always set.
    pub wanted: u32,
}

/// The bits of all lanes.
pub const FULL: u32 = (1 << LANES) - 1;

impl PixelWindow {
    /// The lanes whose pixels are wanted.
    #[inline]
    pub fn lanes(self) -> impl Iterator<Item = usize> {
        ones(self.wanted as u16)
    }

    /// The indices of the wanted pixels.
    #[inline]
    pub fn pixels(self) -> impl Iterator<Item = usize> {
        let index = self.index;
        self.lanes().map(move |lane| index + lane)
    }

    /// Number of lanes up to the last wanted one.
    #[inline]
    pub fn count(self) -> u32 {
        u32::BITS - self.wanted.leading_zeros()
    }

    /// The elements of `all` for the window's pixels. For pixels beyond the end of `all`, the
    /// elements of `spare`.
    #[inline]
    pub fn load<'a, T: Copy>(&self, all: &'a [T], spare: &'a mut [T; LANES]) -> &'a [T; LANES] {
        let Some(all) = all.get(self.index..) else { return spare };
        if let Some(all) = all.first_chunk() {
            return all;
        }
        spare[..all.len()].copy_from_slice(all);
        spare
    }

    /// Stores the values of wanted lanes at the window's pixels in `all`.
    #[inline(always)]
    pub fn store<T: Copy>(&self, values: [T; LANES], all: &mut [T]) {
        let all = &mut all[self.index..];
        match all.first_chunk_mut() {
            Some(all) if self.wanted == FULL => *all = values,
            _ => self.store_runs(&values, all),
        }
    }

    /// As [`PixelWindow::store`], for colors. The caller has just written `colors`, sixteen bytes
    /// at a time. They are read in the same pieces: a wider read would wait until all of its pieces
    /// have reached the nearest cache.
    #[inline(always)]
    pub fn store_colors(&self, colors: &[[u8; 3]; LANES], all: &mut [[u8; 3]]) {
        let all = &mut all[self.index..];
        match all.first_chunk_mut::<LANES>() {
            Some(all) if self.wanted == FULL => {
                let to = all.as_flattened_mut().as_chunks_mut::<LANES>().0;
                let from = colors.as_flattened().as_chunks::<LANES>().0;
                for (to, from) in to.iter_mut().zip(from) {
                    *to = *from;
                }
            }
            _ => self.store_runs(colors, all),
        }
    }

    /// Stores the values of wanted lanes in `all`, whose first element belongs to lane 0.
    #[inline(never)]
    fn store_runs<T: Copy>(&self, values: &[T; LANES], all: &mut [T]) {
        let mut left = self.wanted;
        // Runs of adjacent lanes are stored one after another. Mostly there is only one.
        while left != 0 {
            let first = left.trailing_zeros() as usize;
            let end = first + (left >> first).trailing_ones() as usize;
            all[first..end].copy_from_slice(&values[first..end]);
            left &= !0 << end;
        }
    }
}

/// The lanes for which `holds` is true, as bits.
#[inline]
pub fn bits(holds: impl Fn(usize) -> bool) -> u32 {
    let (mut any, mut all) = (false, true);
    for lane in 0..LANES {
        any |= holds(lane);
        all &= holds(lane);
    }
    // Mostly no lane or all lanes are set. Both cases are tested for several lanes at once.
    match (any, all) {
        (false, _) => 0,
        (_, true) => FULL,
        _ => (0..LANES).fold(0, |bits, lane| bits | u32::from(holds(lane)) << lane),
    }
}

/// The positions of the set bits: the inverse of [`bits`].
#[inline]
pub(crate) fn ones(mut bits: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        bit
    })
}

/// The windows over all painted pixels of some rows, which begin in row `first` of a picture of
/// this width. `status` and `drawn` hold these rows' pixels. Each window starts with a painted
/// pixel. No two windows overlap.
pub fn windows(
    vectors: Level,
    status: &[Status],
    drawn: &[f64],
    first: usize,
    width: usize,
) -> Vec<PixelWindow> {
    let width = width.max(1);
    // Memory is reserved for the largest number of windows, since it is soon released.
    let mut found = Vec::with_capacity(status.len().div_ceil(width) * width.div_ceil(LANES));
    dispatch!(vectors, simd => find_windows(simd, status, drawn, first, width, &mut found));
    found
}

/// Appends windows that contain all painted pixels to `found`. `first` is the number of the first
/// row.
#[inline(always)]
fn find_windows<S: Simd>(
    simd: S,
    status: &[Status],
    drawn: &[f64],
    first: usize,
    width: usize,
    found: &mut Vec<PixelWindow>,
) {
    for (row, (status, drawn)) in status.chunks(width).zip(drawn.chunks(width)).enumerate() {
        let mut column = 0;
        while column < drawn.len() {
            // Most unpainted pixels are skipped by comparing one byte per pixel.
            if status[column..].first_chunk::<LANES>().is_some_and(are_misses) {
                column += LANES;
                continue;
            }
            let mut wanted = painted(simd, &status[column..], &drawn[column..]);
            // A window starts at a painted pixel, so that few lanes are unused.
            if wanted & 1 == 0 {
                column += (wanted | 1 << LANES).trailing_zeros() as usize;
                if wanted == 0 {
                    continue;
                }
                wanted = painted(simd, &status[column..], &drawn[column..]);
            }
            found.push(PixelWindow {
                column,
                row: first + row,
                index: row * width + column,
                wanted,
            });
            column += LANES;
        }
    }
}

/// Returns whether all of these pixels are misses. Then none is painted.
#[inline]
pub(crate) fn are_misses<const N: usize>(status: &[Status; N]) -> bool {
    status.iter().fold(0, |any, status| any | *status as u8) == Status::Miss as u8
}

/// Returns whether all of these pixels are unseen.
#[inline]
pub(crate) fn are_unseen(status: [Status; 4], reason: [UndecidedReason; 4]) -> bool {
    let mut other = 0;
    for pixel in 0..4 {
        other |= status[pixel] as u8 ^ Status::Undecided as u8;
        other |= reason[pixel] as u8 ^ UndecidedReason::Unseen as u8;
    }
    other == 0
}

/// The painted pixels among the first sixteen of `status` and `drawn`, as bits.
#[inline(always)]
fn painted<S: Simd>(simd: S, status: &[Status], drawn: &[f64]) -> u32 {
    // For a decided pixel the status suffices, one byte: a hit is painted, and a miss is not.
    if let Some(status) = status.first_chunk::<LANES>() {
        let mut bytes = [0; LANES];
        for (byte, status) in bytes.iter_mut().zip(status) {
            *byte = *status as u8;
        }
        let bytes = u8x16::simd_from(simd, bytes);
        if bytes.simd_eq(Status::Undecided as u8).all_false() {
            return bytes.simd_eq(Status::Hit as u8).to_bitmask() as u32;
        }
    }
    let mut spare = [f64::INFINITY; LANES];
    let drawn = drawn.first_chunk().unwrap_or_else(
        #[inline(always)]
        || {
            spare[..drawn.len()].copy_from_slice(drawn);
            &spare
        },
    );
    let (low, high) = (f64x8::from_slice(simd, &drawn[..8]), f64x8::from_slice(simd, &drawn[8..]));
    let bits = [low.is_finite().to_bitmask() as u32, high.is_finite().to_bitmask() as u32];
    bits[0] | bits[1] << 8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_painted_pixel_is_in_one_window() {
        for (width, height) in [(1, 1), (5, 3), (16, 4), (33, 8), (100, 7)] {
            for (step, open) in [(1, 0), (2, 0), (3, 0), (17, 0), (1, 40), (3, 40), (17, 1)] {
                let paint = |pixel| if pixel % step == 0 { pixel as f64 } else { f64::INFINITY };
                let drawn: Vec<f64> = (0..width * height).map(paint).collect();
                // An undecided pixel may be painted or not.
                let status = |(pixel, drawn): (usize, &f64)| match drawn.is_finite() {
                    _ if open > 0 && pixel % open == 0 => Status::Undecided,
                    true => Status::Hit,
                    false => Status::Miss,
                };
                let status: Vec<Status> = drawn.iter().enumerate().map(status).collect();
                let mut copied = vec![f64::INFINITY; drawn.len()];
                let mut seen = Vec::new();
                for window in windows(Level::new(), &status, &drawn, 40, width) {
                    assert_eq!(window.index, (window.row - 40) * width + window.column);
                    assert!(window.wanted & 1 == 1 && (1..=16).contains(&window.count()));
                    seen.extend(window.pixels());
                    let mut spare = [0.0; LANES];
                    window.store(*window.load(&drawn, &mut spare), &mut copied);
                }
                let expected: Vec<usize> =
                    (0..width * height).filter(|pixel| pixel % step == 0).collect();
                assert_eq!(seen, expected, "{width}×{height}, {step}");
                assert_eq!(copied, drawn);
            }
        }
    }
}
