//! Bands: rows of a picture. One thread fills a band at a time.

use crate::gbuffer::is_unseen;
use crate::painted::are_unseen;
use crate::ray_result::{LENGTH_ERROR, RayResult, Status, UndecidedReason};
use fearless_simd::{Level, Simd};
use std::cell::Cell;
use std::ops::Range;
use zeroset_eval::dispatch;

/// Adjacent rows of a picture, into which a tracer writes results. Pixels for which it writes none
/// stay [unseen](UndecidedReason::Unseen).
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
    /// Empty if u and v are not kept.
    pub(crate) parameters: &'a mut [[f32; 2]],
    pub(crate) uneven: &'a mut [bool],
    /// Whether each pixel is wanted, row by row. If empty, all are wanted.
    pub(crate) only: &'a [bool],
    /// Results of surfaces traced before this one: each pixel's status, and the distance of its
    /// painted point. Empty for the first surface.
    pub(crate) before: (&'a [Status], &'a [f64]),
    /// Progress callback. Its argument is the number of results since the last call. It returns
    /// whether more results are wanted.
    pub(crate) advance: &'a dyn Fn(usize) -> bool,
    /// Number of results not yet reported to `advance`.
    pub(crate) found: Cell<usize>,
}

impl Band<'_> {
    /// Reports progress, and returns whether the remaining results are wanted. Tracers must call
    /// this regularly. After `false`, they must call [`Band::give_up`] for the remaining columns.
    pub fn is_wanted(&self) -> bool {
        (self.advance)(self.found.take())
    }

    /// Returns whether the pixel in this column and row of the band is wanted.
    #[inline]
    pub fn is_wanted_pixel(&self, column: usize, row: usize) -> bool {
        self.only.is_empty() || self.only[row * self.width + column]
    }

    /// Returns which of a row's four pixels from `column` on are wanted, as bits. Bits beyond the
    /// row are 0. [`Band::only`] must not be empty.
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

    /// Returns whether all pixels of the band are wanted.
    pub fn wants_all(&self) -> bool {
        self.only.is_empty()
    }

    /// Makes all unseen pixels undecided from the eye on, for lack of time.
    pub fn give_up(&mut self) {
        for row in 0..self.height {
            for column in 0..self.width {
                self.give_up_pixel(column, row);
            }
        }
    }

    /// Makes an unseen pixel undecided, for lack of time. Any other result stays: its proof is
    /// valid.
    pub fn give_up_pixel(&mut self, column: usize, row: usize) {
        if self.is_unseen(row * self.width + column) {
            self.set(column, row, &RayResult::GIVEN_UP);
        }
    }

    /// Makes a pixel a miss, unless it has a result. Its whole ray must be proven to have no zero
    /// before that result.
    #[inline]
    pub fn set_miss(&mut self, column: usize, row: usize) {
        let pixel = row * self.width + column;
        if self.is_unseen(pixel) {
            self.status[pixel] = Status::Miss;
        }
    }

    /// As [`Band::set_miss`], for all pixels of the band.
    pub fn set_misses(&mut self) {
        dispatch!(Level::new(), simd => self.set_misses_with(simd));
    }

    /// As [`Band::set_misses`], compiled for vectors of type `S`.
    #[inline(always)]
    fn set_misses_with<S: Simd>(&mut self, _: S) {
        for (status, reason) in self.status.iter_mut().zip(&*self.reason) {
            *status = if is_unseen(*status, *reason) { Status::Miss } else { *status };
        }
    }

    #[inline]
    fn is_unseen(&self, pixel: usize) -> bool {
        is_unseen(self.status[pixel], self.reason[pixel])
    }

    /// Returns whether a pixel has neither a hit nor an undecided segment. A miss counts as free: a
    /// zero that is proven elsewhere outweighs it.
    #[inline]
    fn is_free(&self, pixel: usize) -> bool {
        self.is_unseen(pixel) || self.status[pixel] == Status::Miss
    }

    /// Writes the result for the ray of the pixel in this column and row of the band. The result's
    /// distances must be in world units.
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
        if let Some(parameters) = self.parameters.get_mut(pixel) {
            *parameters = found.parameters;
        }
    }

    #[inline]
    fn count(&self, pixels: usize) {
        self.found.set(self.found.get() + pixels);
    }

    /// Adds a result that lies behind all earlier results for the same pixel. An earlier hit or
    /// undecided segment stays, and only its painted point may change.
    #[inline]
    pub fn add(&mut self, column: usize, row: usize, found: &RayResult) {
        let pixel = row * self.width + column;
        if self.is_free(pixel) {
            self.set(column, row, found);
        } else {
            self.paint(pixel, found.drawn);
        }
    }

    /// Paints a point of an undecided pixel, unless a nearer point is painted. A point before the
    /// undecided segment is moved to the segment's start.
    #[inline]
    fn paint(&mut self, pixel: usize, distance: f64) {
        if self.status[pixel] == Status::Undecided {
            self.drawn[pixel] = self.drawn[pixel].min(distance.max(self.open_from[pixel]));
        }
    }

    /// As [`Band::add`], for a hit whose bracket is from `distance − off` to `distance + off`.
    /// `uneven` is for [`GBuffer::uneven`](crate::GBuffer::uneven).
    #[inline]
    pub fn add_hit(&mut self, column: usize, row: usize, [distance, off]: [f64; 2], uneven: bool) {
        let pixel = row * self.width + column;
        if self.is_free(pixel) {
            self.count(1);
            (self.status[pixel], self.drawn[pixel]) = (Status::Hit, distance);
            if uneven {
                self.uneven[pixel] = true;
            }
            if let Some(bracket) = self.bracket.get_mut(pixel) {
                // The bracket is extended by the rounding of the distance.
                let off = off + LENGTH_ERROR * distance.abs();
                *bracket = [distance - off, distance + off];
            }
        } else {
            self.paint(pixel, distance);
        }
    }

    /// Marks a pixel as [uneven](crate::GBuffer::uneven).
    pub fn mark_uneven(&mut self, column: usize, row: usize) {
        self.uneven[row * self.width + column] = true;
    }

    /// As [`Band::add_hit`], for a square of 4×4 pixels whose first pixel is in this column and
    /// row. None is marked as uneven. If one of the pixels is not unseen or the band keeps
    /// brackets, writes nothing and returns `false`.
    #[inline]
    pub fn add_square_of_hits(
        &mut self,
        column: usize,
        row: usize,
        distance: &[[f64; 4]; 4],
    ) -> bool {
        let first = row * self.width + column;
        let pixels = first..first + 3 * self.width + 4;
        let (Some(status), Some(reason), Some(drawn)) = (
            self.status.get_mut(pixels.clone()),
            self.reason.get(pixels.clone()),
            self.drawn.get_mut(pixels),
        ) else {
            return false;
        };
        let rows = [0, 1, 2, 3].map(|row| row * self.width..row * self.width + 4);
        let is_free = |row: &Range<usize>| {
            let (status, reason) = (&status[row.clone()], &reason[row.clone()]);
            let (Some(status), Some(reason)) = (status.first_chunk(), reason.first_chunk()) else {
                return false;
            };
            are_unseen(*status, *reason)
        };
        if !self.bracket.is_empty() || !rows.iter().all(is_free) {
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
