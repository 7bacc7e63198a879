//! The proof that the rays of tiles are examined from end to end.
//!
//! A pixel without a result becomes a miss only if its tile has reached the far end of its rays. A
//! tile gets there by segments that follow each other without a gap. Each segment was examined, or
//! proven empty as a whole. So code that leaves out a tile cannot make its pixels misses.

use std::ops::Range;

/// For each 4×4 tile of a band, the s up to which its rays are examined. For patches, each row of
/// the band is a tile.
#[derive(Default)]
pub(super) struct Coverage {
    reached: Vec<f64>,
    /// Number of tiles in a row.
    across: usize,
}

/// Some tiles: their columns, then their rows.
pub(super) type TileRanges = [Range<usize>; 2];

impl Coverage {
    /// Resets the tiles: `across` columns and `down` rows, whose rays start at `near`.
    pub fn begin(&mut self, [across, down]: [usize; 2], near: f64) {
        self.across = across;
        self.reached.clear();
        self.reached.resize(across * down, near);
    }

    /// Records that a tile's rays need not be examined before `start`.
    pub fn begin_at(&mut self, tile: usize, start: f64) {
        self.reached[tile] = self.reached[tile].max(start);
    }

    /// Records that tiles are examined between the ends of `span`. Tiles that have not reached
    /// its near end stay where they are.
    #[inline]
    pub fn extend(&mut self, [columns, rows]: TileRanges, [near, far]: [f64; 2]) {
        for row in rows {
            let first = row * self.across;
            for reached in &mut self.reached[first + columns.start..first + columns.end] {
                *reached = if *reached >= near { reached.max(far) } else { *reached };
            }
        }
    }

    /// Returns whether a tile is examined up to `end`.
    #[inline]
    pub fn has_reached(&self, tile: usize, end: f64) -> bool {
        self.reached[tile] >= end
    }

    /// Number of tiles.
    pub fn len(&self) -> usize {
        self.reached.len()
    }

    /// Returns whether all tiles are examined up to `end`.
    pub fn have_reached(&self, end: f64) -> bool {
        self.reached.iter().all(|reached| *reached >= end)
    }

    /// Records that a part of a tile's rays is not examined and never will be.
    pub fn lose(&mut self, tile: usize) {
        self.reached[tile] = f64::NEG_INFINITY;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_reaches_the_end_only_without_gaps() {
        let mut coverage = Coverage::default();
        coverage.begin([3, 2], 0.0);
        let ends = |coverage: &Coverage| {
            [0, 1, 2, 3, 4, 5]
                .map(|tile| (0..9).rev().find(|end| coverage.has_reached(tile, f64::from(*end))))
        };
        coverage.extend([0..2, 0..2], [0.0, 2.0]);
        assert_eq!(ends(&coverage), [2, 2, 0, 2, 2, 0].map(Some));
        // Tiles 2 and 5 have not been examined before 1. Others have, partly twice.
        coverage.extend([0..3, 0..2], [1.0, 5.0]);
        assert_eq!(ends(&coverage), [5, 5, 0, 5, 5, 0].map(Some));
        coverage.lose(1);
        coverage.extend([0..3, 0..1], [0.0, 8.0]);
        assert_eq!(ends(&coverage), [Some(8), None, Some(8), Some(5), Some(5), Some(0)]);
    }
}
