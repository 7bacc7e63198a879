//! Some rows of a picture: what one thread takes from nothing to colors while it is in the nearer
//! caches.

use crate::band::Band;
use crate::found::{Reason, Status};
use crate::gbuffer::{GBuffer, distance};
use crate::numbers::Numbers;
use crate::painted::{Window, are_misses, windows};
use crate::shade::Seen;
use crate::work::Work;
use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;
use std::cell::Cell;
use std::ops::Range;

/// Pixels that are made misses at a time.
const CLEARED: usize = 64;

/// Some neighbouring rows of a [`GBuffer`], all that is known of their pixels.
pub struct Rows<'a> {
    /// The first row, counted from the picture's top.
    pub(crate) first: usize,
    /// Pixels in a row.
    pub(crate) width: usize,
    pub(crate) status: &'a mut [Status],
    pub(crate) reason: &'a mut [Reason],
    /// Empty if they are not wanted.
    pub(crate) bracket: &'a mut [[f64; 2]],
    pub(crate) open_from: &'a mut [f64],
    pub(crate) drawn: &'a mut [f64],
    /// Of those that are painted.
    pub(crate) surface: Numbers<'a>,
    /// Empty if they are not kept.
    pub(crate) normal: &'a mut [[f32; 3]],
    /// These are empty if they are nowhere set.
    pub(crate) cap: &'a mut [bool],
    pub(crate) shadow: &'a mut [u8],
    pub(crate) occlusion: &'a mut [u8],
}

impl GBuffer {
    /// The picture in parts of so many rows each, from the top; the last may have fewer.
    pub(crate) fn rows(&mut self, rows: usize) -> Vec<Rows<'_>> {
        let width = self.width.max(1);
        let size = rows * width;
        let pixels = self.status.len();
        let count = pixels.div_ceil(size);
        let mut bracket = self.bracket.chunks_mut(size);
        let mut status = self.status.chunks_mut(size);
        let mut reason = self.reason.chunks_mut(size);
        let mut open_from = self.open_from.chunks_mut(size);
        let mut drawn = self.drawn.chunks_mut(size);
        let surface = &self.surface;
        let mut normal = self.normal.chunks_mut(size);
        let mut cap = self.cap.chunks_mut(size);
        let mut shadow = self.shadow.chunks_mut(size);
        let mut occlusion = self.occlusion.chunks_mut(size);
        let part = |part| Rows {
            first: part * rows,
            width,
            status: status.next().unwrap_or_default(),
            reason: reason.next().unwrap_or_default(),
            bracket: bracket.next().unwrap_or_default(),
            open_from: open_from.next().unwrap_or_default(),
            drawn: drawn.next().unwrap_or_default(),
            surface: surface.part(part * size..pixels.min((part + 1) * size)),
            normal: normal.next().unwrap_or_default(),
            cap: cap.next().unwrap_or_default(),
            shadow: shadow.next().unwrap_or_default(),
            occlusion: occlusion.next().unwrap_or_default(),
        };
        (0..count).map(part).collect()
    }
}

/// What was asked for by doing something with each part of a picture, on all threads. If there is
/// only one thread for that, it is done here: another one would have to be waited for twice, until
/// it wakes and until this one does.
pub(crate) fn work_on<P: Send>(parts: Vec<P>, work: impl Fn(P) -> Work + Send + Sync) -> Work {
    if rayon::current_num_threads() == 1 {
        parts.into_iter().map(work).sum()
    } else {
        // One by one: else a thread ends with several while others have nothing left.
        parts.into_par_iter().with_max_len(1).map(work).sum()
    }
}

impl Rows<'_> {
    /// Their pixels, counted from the picture's first.
    pub(crate) fn pixels(&self) -> Range<usize> {
        let first = self.first * self.width;
        first..first + self.status.len()
    }

    /// Makes every pixel a miss.
    pub(crate) fn clear(&mut self) {
        dispatch!(Level::new(), simd => self.clear_with(simd));
    }

    /// The same, compiled for such vectors.
    #[inline(always)]
    fn clear_with<S: Simd>(&mut self, _: S) {
        // What says nothing of a miss stays as it is: to write it would take time for nothing. Nor
        // need it be written that nothing is painted where the memory holds a miss of an earlier
        // picture.
        let parts = self.status.chunks_mut(CLEARED).zip(self.drawn.chunks_mut(CLEARED));
        for (status, drawn) in parts {
            if !status.first_chunk::<CLEARED>().is_some_and(are_misses) {
                status.fill(Status::Miss);
                drawn.fill(f64::INFINITY);
            }
        }
        self.bracket.fill([f64::NAN; 2]);
        self.cap.fill(false);
        self.shadow.fill(0);
        self.occlusion.fill(0);
    }

    /// [`GBuffer::distance`].
    pub(crate) fn distance(&self, pixel: usize) -> f64 {
        distance(self.status[pixel], self.open_from[pixel], self.drawn[pixel])
    }

    /// Where they are painted.
    pub(crate) fn windows(&self) -> Vec<Window> {
        windows(Level::new(), self.status, self.drawn, self.first, self.width)
    }

    /// What is to be lit: where normals go, and all else that counts.
    pub(crate) fn seen(&mut self) -> (&mut [[f32; 3]], Seen<'_>) {
        let seen = Seen {
            status: self.status,
            drawn: self.drawn,
            surface: self.surface,
            normal: &[],
            cap: self.cap,
            shadow: self.shadow,
            occlusion: self.occlusion,
            paint: &[],
        };
        (self.normal, seen)
    }

    /// Where a method writes what it finds. `only` says of each pixel of the picture whether it is
    /// wanted, if not all are; `before` holds other surfaces; `advance` is as a driver's.
    pub(crate) fn band<'a>(
        &'a mut self,
        only: &'a [bool],
        before: Option<&'a GBuffer>,
        advance: &'a dyn Fn(usize) -> bool,
    ) -> Band<'a> {
        let only = if only.is_empty() { only } else { &only[self.pixels()] };
        let before = before.map_or((&[][..], &[][..]), |before| {
            (&before.status[self.pixels()], &before.drawn[self.pixels()])
        });
        Band {
            top: self.first,
            width: self.width,
            height: self.status.len() / self.width,
            status: &mut *self.status,
            reason: &mut *self.reason,
            open_from: &mut *self.open_from,
            drawn: &mut *self.drawn,
            bracket: &mut *self.bracket,
            only,
            before,
            advance,
            found: Cell::new(0),
        }
    }
}
