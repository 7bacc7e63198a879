//! Rows of a picture: what one thread fills at a time.

use crate::painted::are_misses;
use crate::ray_result::{LENGTH_ERROR, RayResult, Status, UndecidedReason};
use std::cell::Cell;
use std::ops::Range;

/// Some neighbouring rows of a picture, and where what is found of their pixels goes.
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
    /// Whether a pixel is wanted, row by row; empty if all are.
    pub(crate) only: &'a [bool],
    /// Of each pixel, what is proven of the surfaces that were looked for before, and where they
    /// are painted; empty if there are none.
    pub(crate) before: (&'a [Status], &'a [f64]),
    /// Told of how many pixels something was found since it was last called.
    pub(crate) advance: &'a dyn Fn(usize) -> bool,
    /// So many that it was not told of yet.
    pub(crate) found: Cell<usize>,
}

impl Band<'_> {
    /// Whether what is still to be found is wanted. To be asked every now and then; after a
    /// `false`, columns that were not reached are to be [given up](Band::give_up).
    pub fn is_wanted(&self) -> bool {
        (self.advance)(self.found.take())
    }

    /// Whether anybody asks what becomes of a pixel, given by its column and its row in the band.
    #[inline]
    pub fn is_asked(&self, column: usize, row: usize) -> bool {
        self.only.is_empty() || self.only[row * self.width + column]
    }

    /// The same of four pixels of a row, as bits; clear for what sticks out of the band.
    #[inline]
    pub(crate) fn asked_of_four(&self, column: usize, row: usize) -> u16 {
        let Some(rest) = self.only.get(row * self.width + column..(row + 1) * self.width) else {
            return 0;
        };
        if let Some([a, b, c, d]) = rest.first_chunk() {
            return u16::from(*a) | u16::from(*b) << 1 | u16::from(*c) << 2 | u16::from(*d) << 3;
        }
        rest.iter().enumerate().map(|(k, asked)| u16::from(*asked) << k).sum()
    }

    /// Whether that is so of every pixel.
    pub fn is_all_asked(&self) -> bool {
        self.only.is_empty()
    }

    /// Calls all pixels from this column on undecided from the eye on, for lack of time: to leave
    /// them misses would be a claim.
    pub fn give_up(&mut self, from: usize) {
        for row in 0..self.height {
            for column in from..self.width {
                self.give_up_pixel(column, row);
            }
        }
    }

    /// The same of one pixel. What was found on its ray was found behind nothing but what is proven
    /// empty, and stays.
    pub fn give_up_pixel(&mut self, column: usize, row: usize) {
        if self.status[row * self.width + column] == Status::Miss {
            self.set(column, row, &RayResult::GIVEN_UP);
        }
    }

    /// Writes what became of the ray through a pixel, given by its column and its row in the band;
    /// distances in world units.
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

    /// Writes what was found on a ray behind all that was found before: what is proven stays as it
    /// is where something was, and only what is painted may be new.
    #[inline]
    pub fn add(&mut self, column: usize, row: usize, found: &RayResult) {
        let pixel = row * self.width + column;
        if self.status[pixel] == Status::Miss {
            self.set(column, row, found);
        } else {
            self.paint(pixel, found.drawn);
        }
    }

    /// Paints a place on a ray of which something is known before it, unless that is painted:
    /// nowhere that is proven empty.
    #[inline]
    fn paint(&mut self, pixel: usize, distance: f64) {
        if self.status[pixel] == Status::Undecided {
            self.drawn[pixel] = self.drawn[pixel].min(distance.max(self.open_from[pixel]));
        }
    }

    /// As [`Band::add`] for a hit at `distance`, whose bracket reaches as far as `off` to either
    /// side.
    #[inline]
    pub fn add_hit(&mut self, column: usize, row: usize, distance: f64, off: f64) {
        let pixel = row * self.width + column;
        if self.status[pixel] == Status::Miss {
            self.count(1);
            (self.status[pixel], self.drawn[pixel]) = (Status::Hit, distance);
            if let Some(bracket) = self.bracket.get_mut(pixel) {
                // The distance itself is rounded.
                let off = off + LENGTH_ERROR * distance.abs();
                *bracket = [distance - off, distance + off];
            }
        } else {
            self.paint(pixel, distance);
        }
    }

    /// As [`Band::add_hit`] for a square of four rows of four pixels, from this column and row on:
    /// only where nothing else was found, and no brackets are kept. Otherwise does nothing, and
    /// returns `false`.
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
