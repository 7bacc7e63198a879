//! Bands: rows of a picture that one thread fills at a time.

use crate::painted::are_misses;
use crate::ray_result::{LENGTH_ERROR, RayResult, Status, UndecidedReason};
use std::cell::Cell;
use std::ops::Range;

/// Adjacent rows of a picture, into which results are written.
pub struct Band<'a> {
    /// The first row, counted from the picture's top.
    pub top: usize,
    /// Pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    pub(crate) status: &'a mut [Status],
    pub(crate) reason: &'a mut [UndecidedReason],
    pub(crate) open_from: &'a mut [f64],
    pub(crate) drawn: &'a mut [f64],
    pub(crate) bracket: &'a mut [[f64; 2]],
    /// Whether each pixel is wanted, row by row; empty if all are.
    pub(crate) only: &'a [bool],
    /// Results for surfaces traced before: proofs, and distances of painted points. Empty if this
    /// is the first surface.
    pub(crate) before: (&'a [Status], &'a [f64]),
    /// Progress callback: gets the number of results since the last call.
    pub(crate) advance: &'a dyn Fn(usize) -> bool,
    /// Number of results not yet reported.
    pub(crate) found: Cell<usize>,
}

impl Band<'_> {
    /// Reports progress, and returns whether the remaining results are still wanted. Must be called
    /// regularly. Once this returns `false`, call [`Band::give_up`] for the remaining columns.
    pub fn is_wanted(&self) -> bool {
        (self.advance)(self.found.take())
    }

    /// Returns whether a pixel is wanted, given its column and its row in the band.
    #[inline]
    pub fn is_wanted_pixel(&self, column: usize, row: usize) -> bool {
        self.only.is_empty() || self.only[row * self.width + column]
    }

    /// As [`Band::is_wanted_pixel`], for four pixels of a row, as bits. Bits beyond the row are 0.
    #[inline]
    pub(crate) fn wanted_of_four(&self, column: usize, row: usize) -> u16 {
        let Some(rest) = self.only.get(row * self.width + column..(row + 1) * self.width) else {
            return 0;
        };
        if let Some([a, b, c, d]) = rest.first_chunk() {
            return u16::from(*a) | u16::from(*b) << 1 | u16::from(*c) << 2 | u16::from(*d) << 3;
        }
        rest.iter().enumerate().map(|(k, asked)| u16::from(*asked) << k).sum()
    }

    /// Returns whether all pixels are wanted.
    pub fn wants_all(&self) -> bool {
        self.only.is_empty()
    }

    /// Sets all misses from this column on to undecided, for lack of time: nothing is known about
    /// these rays from the eye on. To leave them as misses would claim a proof.
    pub fn give_up(&mut self, from: usize) {
        for row in 0..self.height {
            for column in from..self.width {
                self.give_up_pixel(column, row);
            }
        }
    }

    /// Sets a pixel to undecided if it is a miss. A pixel with another result keeps it, since its
    /// ray is proven empty up to there.
    pub fn give_up_pixel(&mut self, column: usize, row: usize) {
        if self.status[row * self.width + column] == Status::Miss {
            self.set(column, row, &RayResult::GIVEN_UP);
        }
    }

    /// Writes the result for a pixel's ray, given its column and its row in the band. Distances are
    /// in world units.
    #[inline]
    pub fn set(&mut self, column: usize, row: usize, found: &RayResult) {
        let pixel = row * self.width + column;
        debug_assert!(found.status != Status::Hit || found.distance == found.drawn);
        debug_assert!(found.status != Status::Miss || !found.drawn.is_finite());
        self.count(1);
        self.status[pixel] = found.status;
        self.drawn[pixel] = found.drawn;
        if found.status == Status::Undecided {
            (self.reason[pixel], self.open_from[pixel]) = (found.reason, found.distance);
        }
        if let Some(bracket) = self.bracket.get_mut(pixel) {
            *bracket = found.bracket;
        }
    }

    #[inline]
    fn count(&self, pixels: usize) {
        self.found.set(self.found.get() + pixels);
    }

    /// Adds a result that lies behind all earlier ones on the same ray. If there is an earlier one,
    /// its proof stays, and only the painted point may change.
    #[inline]
    pub fn add(&mut self, column: usize, row: usize, found: &RayResult) {
        let pixel = row * self.width + column;
        if self.status[pixel] == Status::Miss {
            self.set(column, row, found);
        } else {
            self.paint(pixel, found.drawn);
        }
    }

    /// Paints a point behind the start of an undecided segment, unless a nearer one is painted. The
    /// part of the ray that is proven empty is never painted.
    #[inline]
    fn paint(&mut self, pixel: usize, distance: f64) {
        if self.status[pixel] == Status::Undecided {
            self.drawn[pixel] = self.drawn[pixel].min(distance.max(self.open_from[pixel]));
        }
    }

    /// As [`Band::add`] for a hit at `distance`, whose bracket is from `distance − off` to
    /// `distance + off`.
    #[inline]
    pub fn add_hit(&mut self, column: usize, row: usize, distance: f64, off: f64) {
        let pixel = row * self.width + column;
        if self.status[pixel] == Status::Miss {
            self.count(1);
            (self.status[pixel], self.drawn[pixel]) = (Status::Hit, distance);
            if let Some(bracket) = self.bracket.get_mut(pixel) {
                // The bracket is extended by the rounding of the distance.
                let off = off + LENGTH_ERROR * distance.abs();
                *bracket = [distance - off, distance + off];
            }
        } else {
            self.paint(pixel, distance);
        }
    }

    /// As [`Band::add_hit`] for the 4×4 pixels from this column and row on. Does nothing and
    /// returns `false` if a pixel already has a result, or if brackets are kept.
    #[inline]
    pub fn add_square_of_hits(
        &mut self,
        column: usize,
        row: usize,
        distance: &[[f64; 4]; 4],
    ) -> bool {
        let first = row * self.width + column;
        let pixels = first..first + 3 * self.width + 4;
        let (Some(status), Some(drawn)) =
            (self.status.get_mut(pixels.clone()), self.drawn.get_mut(pixels))
        else {
            return false;
        };
        let rows = [0, 1, 2, 3].map(|row| row * self.width..row * self.width + 4);
        let is_miss =
            |row: &Range<usize>| status[row.clone()].first_chunk::<4>().is_some_and(are_misses);
        if !self.bracket.is_empty() || !rows.iter().all(is_miss) {
            return false;
        }
        for (row, distance) in rows.into_iter().zip(distance) {
            status[row.clone()].fill(Status::Hit);
            drawn[row].copy_from_slice(distance);
        }
        self.count(16);
        true
    }
}
