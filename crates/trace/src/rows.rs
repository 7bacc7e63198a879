//! Some rows of a picture: what one thread takes from nothing to colours while it is in the nearer caches.

use crate::band::Band;
use crate::gbuffer::{GBuffer, Reason, Status};
use crate::painted::{Window, windows};
use fearless_simd::Level;
use rayon::prelude::*;
use std::ops::Range;

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
    pub(crate) distance: &'a mut [f64],
    pub(crate) drawn: &'a mut [f64],
    pub(crate) surface: &'a mut [u16],
    pub(crate) normal: &'a mut [[f32; 3]],
    pub(crate) cap: &'a mut [bool],
    pub(crate) shadow: &'a mut [u8],
    pub(crate) occlusion: &'a mut [u8],
    /// Where they are painted, if somebody looked.
    windows: Option<Vec<Window>>,
}

impl GBuffer {
    /// The picture in parts of so many rows each, from the top; the last may have fewer.
    pub(crate) fn rows(&mut self, rows: usize) -> impl IndexedParallelIterator<Item = Rows<'_>> {
        let width = self.width.max(1);
        let size = rows * width;
        let count = self.status.len().div_ceil(size);
        let mut bracket = self.bracket.chunks_mut(size);
        let mut status = self.status.chunks_mut(size);
        let mut reason = self.reason.chunks_mut(size);
        let mut distance = self.distance.chunks_mut(size);
        let mut drawn = self.drawn.chunks_mut(size);
        let mut surface = self.surface.chunks_mut(size);
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
            distance: distance.next().unwrap_or_default(),
            drawn: drawn.next().unwrap_or_default(),
            surface: surface.next().unwrap_or_default(),
            normal: normal.next().unwrap_or_default(),
            cap: cap.next().unwrap_or_default(),
            shadow: shadow.next().unwrap_or_default(),
            occlusion: occlusion.next().unwrap_or_default(),
            windows: None,
        };
        (0..count).map(part).collect::<Vec<_>>().into_par_iter()
    }
}

impl Rows<'_> {
    /// Their pixels, counted from the picture's first.
    pub(crate) fn pixels(&self) -> Range<usize> {
        let first = self.first * self.width;
        first..first + self.status.len()
    }

    /// Makes every pixel a miss, for the surface with this number.
    pub(crate) fn clear(&mut self, surface: u16) {
        self.status.fill(Status::Miss);
        self.reason.fill(Reason::None);
        self.bracket.fill([f64::NAN; 2]);
        self.distance.fill(f64::INFINITY);
        self.drawn.fill(f64::INFINITY);
        self.surface.fill(surface);
        // As numbers, so that it is the library's `memset`.
        self.normal.as_flattened_mut().fill(0.0);
        self.cap.fill(false);
        self.shadow.fill(0);
        self.occlusion.fill(0);
    }

    /// Where they are painted. To be [given back](Self::keep), unless what is painted changes.
    pub(crate) fn windows(&mut self) -> Vec<Window> {
        let look = || windows(Level::new(), self.drawn, self.first, self.width);
        self.windows.take().unwrap_or_else(look)
    }

    /// Keeps what was seen of where they are painted.
    pub(crate) fn keep(&mut self, windows: Vec<Window>) {
        self.windows = Some(windows);
    }

    /// Forgets it: what is painted changes.
    pub(crate) fn forget(&mut self) {
        self.windows = None;
    }

    /// Where a method writes what it finds. `only` says of each pixel of the picture whether it is wanted, if not all are;
    /// `wanted` whether the work is to go on.
    pub(crate) fn band<'a>(
        &'a mut self,
        only: &'a [bool],
        wanted: &'a (dyn Fn() -> bool + Sync),
    ) -> Band<'a> {
        let only = if only.is_empty() { only } else { &only[self.pixels()] };
        self.forget();
        Band {
            top: self.first,
            width: self.width,
            height: self.status.len() / self.width,
            status: &mut *self.status,
            reason: &mut *self.reason,
            distance: &mut *self.distance,
            drawn: &mut *self.drawn,
            bracket: &mut *self.bracket,
            only,
            wanted,
        }
    }
}
