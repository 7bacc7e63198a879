//! The ground of a graph: the places in the plane of its two independent variables at which it has
//! heights.
//!
//! All results are sampled, not proven. This module depends neither on surfaces nor on kernels.

use super::heights::{Grid, Heights, SIDE, place};

/// An end of the window is cut off if the part without heights is wider than this share of the
/// side.
const BARE: f64 = 0.1;

/// Number of halvings that locate an end between two rows of the grid.
const HALVINGS: u32 = 10;

/// The part of a graph's ground that is shown, relative to the center. It is sampled by a square
/// that is mapped to it.
#[derive(Clone, Copy, Debug)]
pub struct Ground {
    pub ranges: [[f64; 2]; 2],
}

impl Ground {
    /// Half the side of the square: half the longer side of the ground.
    pub fn half(&self) -> f64 {
        self.ranges.iter().map(|[low, high]| (high - low) / 2.0).fold(0.0, f64::max)
    }

    /// The place along axis `k` of the ground, for a place along the same axis of the square.
    pub fn along(&self, k: usize, place: f64) -> f64 {
        let [low, high] = self.ranges[k];
        low.midpoint(high) + place * ((high - low) / 2.0 / self.half())
    }

    /// The places in the ground, for places in the square.
    pub fn places(&self, places: &[[f64; 2]]) -> Vec<[f64; 2]> {
        places.iter().map(|[x, y]| [self.along(0, *x), self.along(1, *y)]).collect()
    }
}

/// Both ends of the ground along its two axes. `None` for an end at the border of the grid, or at
/// most `BARE` of the side away from it.
pub fn ends(heights: &Heights<'_>, grid: &Grid) -> [[Option<f64>; 2]; 2] {
    let place = |row: usize| place(grid.half, row);
    [0, 1].map(|axis| {
        let has_height = |row: usize, k: usize| {
            let n = if axis == 0 { row + k * SIDE } else { k + row * SIDE };
            grid.sampled[n].is_finite()
        };
        // Heights without neighbors, such as those of powers of negative numbers, do not count.
        let is_ground = |row: &usize| {
            let is_height = |k: usize| has_height(*row, k) && has_height(row + 1, k);
            (1..SIDE).any(|k| is_height(k - 1) && is_height(k))
        };
        let bare = |rows: usize| rows as f64 > BARE * (SIDE - 1) as f64;
        let first = (0..SIDE - 1).find(is_ground).filter(|row| bare(*row));
        let last = (0..SIDE - 1).rev().find(is_ground).map(|row| row + 1);
        let last = last.filter(|row| bare(SIDE - 1 - row));
        let end =
            |row: usize, beyond: usize| end(heights, grid.half, axis, [row, beyond].map(place));
        [first.map(|row| end(row, row - 1)), last.map(|row| end(row, row + 1))]
    })
}

/// The end of the ground between `row`, which has heights, and `beyond`, the next row outward.
fn end(heights: &Heights<'_>, half: f64, axis: usize, [mut row, mut beyond]: [f64; 2]) -> f64 {
    for _ in 0..HALVINGS {
        let middle = row.midpoint(beyond);
        let places = (0..SIDE).map(|k| place(half, k));
        let places = places.map(|k| if axis == 0 { [middle, k] } else { [k, middle] });
        let found = heights(&places.collect::<Vec<_>>());
        let is_ground = found.windows(2).any(|two| two.iter().all(|height| height.is_finite()));
        if is_ground { row = middle } else { beyond = middle }
    }
    row
}
