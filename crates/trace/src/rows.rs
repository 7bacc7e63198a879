//! Some rows of a picture: what one thread takes from nothing to colors while it is in the nearer
//! caches.

use crate::band::Band;
use crate::gbuffer::{GBuffer, PixelCounts, distance};
use crate::kernel_stats::KernelStats;
use crate::painted::{Window, are_misses, windows};
use crate::ray_result::{Status, UndecidedReason};
use crate::surface_ids::Numbers;
use fearless_simd::{Level, Simd, dispatch};
use std::cell::Cell;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Pixels that are made misses at a time.
const CLEARED: usize = 64;

/// Some neighbouring rows of a [`GBuffer`], all that is known of their pixels.
pub struct Rows<'a> {
    /// The first row, counted from the picture's top.
    pub(crate) first: usize,
    /// Pixels in a row.
    pub(crate) width: usize,
    pub(crate) status: &'a mut [Status],
    pub(crate) reason: &'a mut [UndecidedReason],
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

/// The columns of a G-buffer that shading reads, for neighbouring pixels.
#[derive(Clone, Copy)]
pub struct Columns<'a> {
    /// [`GBuffer::status`].
    pub status: &'a [Status],
    /// [`GBuffer::drawn`].
    pub drawn: &'a [f64],
    /// [`GBuffer::surface`].
    pub surface: Numbers<'a>,
    /// [`GBuffer::normal`]; may be empty.
    pub normal: &'a [[f32; 3]],
    /// [`GBuffer::cap`]; may be empty.
    pub cap: &'a [bool],
    /// [`GBuffer::shadow`]; may be empty.
    pub shadow: &'a [u8],
    /// [`GBuffer::occlusion`]; may be empty.
    pub occlusion: &'a [u8],
}

impl GBuffer {
    /// The columns that shading reads, for a range of pixels.
    ///
    /// # Panics
    /// If there are no such pixels.
    pub fn columns(&self, pixels: Range<usize>) -> Columns<'_> {
        Columns {
            status: &self.status[pixels.clone()],
            drawn: &self.drawn[pixels.clone()],
            surface: self.surface.part(pixels.clone()),
            normal: &self.normal[pixels.clone()],
            cap: self.cap.get(pixels.clone()).unwrap_or_default(),
            shadow: self.shadow.get(pixels.clone()).unwrap_or_default(),
            occlusion: self.occlusion.get(pixels).unwrap_or_default(),
        }
    }

    /// Does `work` on each part of so many rows, on all threads, and returns what it took.
    ///
    /// # Panics
    /// As `work`, once the other threads are done.
    pub fn each_rows(
        &mut self,
        rows: usize,
        work: impl Fn(Rows<'_>) -> KernelStats + Sync,
    ) -> KernelStats {
        work_on(self.rows(rows), work)
    }

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

/// What was asked for by doing something with each part of a picture, on all threads. Each takes
/// one part after another, from the middle of the picture outward: mostly there is little in the
/// last ones, so that no thread ends long before the others (a sphere on two threads takes 0.52 of
/// one's time, and 0.56 where any part may be the last).
///
/// # Panics
/// As `work`, once the other threads are done.
pub(crate) fn work_on<P: Send>(
    parts: Vec<P>,
    work: impl Fn(P) -> KernelStats + Sync,
) -> KernelStats {
    let threads = rayon::current_num_threads().min(parts.len());
    let rest = Mutex::new(outside_first(parts));
    let next = || rest.lock().unwrap_or_else(PoisonError::into_inner).pop();
    let all = Mutex::new(KernelStats::default());
    let take = || {
        let own: KernelStats = std::iter::from_fn(next).map(&work).sum();
        *all.lock().unwrap_or_else(PoisonError::into_inner) += own;
    };
    if threads <= 1 {
        // Another thread would have to be waited for twice, until it wakes and until this one does.
        take();
    } else {
        rayon::scope(|scope| {
            (1..threads).for_each(|_| scope.spawn(|_| take()));
            take();
        });
    }
    all.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// From both ends in turn to the middle.
fn outside_first<P>(parts: Vec<P>) -> Vec<P> {
    let mut rest = parts.into_iter();
    let mut ordered = Vec::with_capacity(rest.len());
    while let Some(first) = rest.next() {
        ordered.push(first);
        ordered.extend(rest.next_back());
    }
    ordered
}

impl Rows<'_> {
    /// How many of their pixels have each status.
    pub fn counts(&self) -> PixelCounts {
        PixelCounts::of(self.status)
    }

    /// Their pixels, counted from the picture's first.
    pub fn pixels(&self) -> Range<usize> {
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
    pub fn windows(&self) -> Vec<Window> {
        windows(Level::new(), self.status, self.drawn, self.first, self.width)
    }

    /// Where normals go, empty if they are not kept, and the columns that shading reads. The
    /// columns' own normals are empty.
    pub fn columns(&mut self) -> (&mut [[f32; 3]], Columns<'_>) {
        let columns = Columns {
            status: self.status,
            drawn: self.drawn,
            surface: self.surface,
            normal: &[],
            cap: self.cap,
            shadow: self.shadow,
            occlusion: self.occlusion,
        };
        (self.normal, columns)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_taken_once_from_the_middle_outward() {
        for (count, expected) in [(0, vec![]), (1, vec![0]), (5, vec![2, 3, 1, 4, 0])] {
            let taken = Mutex::new(Vec::new());
            rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread").install(
                || {
                    work_on((0..count).collect(), |part| {
                        taken.lock().expect("no panic").push(part);
                        KernelStats { given_up: 1, ..KernelStats::default() }
                    })
                },
            );
            assert_eq!(taken.into_inner().expect("no panic"), expected);
        }
        let work = |part| KernelStats { given_up: part, ..KernelStats::default() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        assert_eq!(pool.install(|| work_on((0..100).collect(), work)).given_up, 99 * 100 / 2);
    }

    #[test]
    fn a_panic_on_any_thread_is_the_caller_s() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        for bad in 0..8 {
            let work = |part| if part == bad { panic!("{part}") } else { KernelStats::default() };
            let run = || pool.install(|| work_on((0..8).collect(), work));
            let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run));
            let told = caught.expect_err("a panic").downcast::<String>().expect("its words");
            assert_eq!(*told, bad.to_string());
        }
    }
}
