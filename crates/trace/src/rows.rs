//! Rows of a picture. One thread takes them from tracing to colors while they are in the caches.

use crate::band::Band;
use crate::gbuffer::{GBuffer, PixelCounts, distance};
use crate::kernel_stats::KernelStats;
use crate::painted::{PixelWindow, are_misses, windows};
use crate::ray_result::{Status, UndecidedReason};
use crate::surface_ids::SurfaceIdSlice;
use fearless_simd::{Level, Simd};
use std::cell::Cell;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};
use zeroset_eval::dispatch;

/// Number of pixels that are cleared at a time.
const CLEARED: usize = 64;

/// Adjacent rows of a [`GBuffer`], with all quantities of the rows' pixels.
pub struct Rows<'a> {
    /// The first row, counted from the picture's top.
    pub(crate) first: usize,
    /// Number of pixels in a row.
    pub(crate) width: usize,
    pub(crate) status: &'a mut [Status],
    pub(crate) reason: &'a mut [UndecidedReason],
    /// Empty if brackets are not kept.
    pub(crate) bracket: &'a mut [[f64; 2]],
    pub(crate) open_from: &'a mut [f64],
    pub(crate) drawn: &'a mut [f64],
    /// Empty if u and v are not kept.
    pub(crate) parameters: &'a mut [[f32; 2]],
    pub(crate) uneven: &'a mut [bool],
    /// Ids of the painted surfaces; meaningless for other pixels.
    pub(crate) surface: SurfaceIdSlice<'a>,
    /// Empty if normals are not kept.
    pub(crate) normal: &'a mut [[f32; 3]],
    /// May be empty if no pixel has a cap. Likewise `shadow` and `occlusion` if nothing is hidden.
    pub(crate) cap: &'a mut [bool],
    pub(crate) shadow: &'a mut [u8],
    pub(crate) occlusion: &'a mut [u8],
}

/// The quantities that shading reads, for adjacent pixels of a G-buffer.
#[derive(Clone, Copy)]
pub struct Columns<'a> {
    /// Statuses: [`GBuffer::status`].
    pub status: &'a [Status],
    /// Distances of painted points: [`GBuffer::drawn`].
    pub drawn: &'a [f64],
    /// Values of u and v: [`GBuffer::parameters`]; may be empty.
    pub parameters: &'a [[f32; 2]],
    /// Whether gradients change near painted points: [`GBuffer::uneven`].
    pub uneven: &'a [bool],
    /// Ids of painted surfaces: [`GBuffer::surface`].
    pub surface: SurfaceIdSlice<'a>,
    /// Normals: [`GBuffer::normal`]; may be empty.
    pub normal: &'a [[f32; 3]],
    /// Whether painted points lie on caps: [`GBuffer::cap`]. May be empty.
    pub cap: &'a [bool],
    /// Shares of hidden light: [`GBuffer::shadow`]; may be empty.
    pub shadow: &'a [u8],
    /// Shares of hidden surroundings: [`GBuffer::occlusion`]; may be empty.
    pub occlusion: &'a [u8],
}

impl GBuffer {
    /// The quantities that shading reads, for the pixels of a range.
    ///
    /// # Panics
    /// If the range exceeds the picture.
    pub fn columns(&self, pixels: Range<usize>) -> Columns<'_> {
        Columns {
            status: &self.status[pixels.clone()],
            drawn: &self.drawn[pixels.clone()],
            parameters: self.parameters.get(pixels.clone()).unwrap_or_default(),
            uneven: &self.uneven[pixels.clone()],
            surface: self.surface.part(pixels.clone()),
            normal: &self.normal[pixels.clone()],
            cap: self.cap.get(pixels.clone()).unwrap_or_default(),
            shadow: self.shadow.get(pixels.clone()).unwrap_or_default(),
            occlusion: self.occlusion.get(pixels).unwrap_or_default(),
        }
    }

    /// Divides the picture into parts of `rows` rows, and runs `work` on each part, on all threads.
    /// Returns the sum of the results.
    ///
    /// # Panics
    /// If `work` panics, after the other threads have finished.
    pub fn each_rows(
        &mut self,
        rows: usize,
        work: impl Fn(Rows<'_>) -> KernelStats + Sync,
    ) -> KernelStats {
        for_each_part(self.rows(rows), work)
    }

    /// Divides the picture into parts of `rows` rows, from the top. The last may have fewer.
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
        let mut parameters = self.parameters.chunks_mut(size);
        let mut uneven = self.uneven.chunks_mut(size);
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
            parameters: parameters.next().unwrap_or_default(),
            uneven: uneven.next().unwrap_or_default(),
            surface: surface.part(part * size..pixels.min((part + 1) * size)),
            normal: normal.next().unwrap_or_default(),
            cap: cap.next().unwrap_or_default(),
            shadow: shadow.next().unwrap_or_default(),
            occlusion: occlusion.next().unwrap_or_default(),
        };
        (0..count).map(part).collect()
    }
}

/// Runs `work` on each part of a picture, on all threads. Returns the sum of the results. Threads
/// take parts from the middle of the picture outward. The outermost parts mostly show little, so
/// all threads end at about the same time. (On two threads, a sphere takes 0.52 of its time on one
/// thread. With parts in arbitrary order, it would take 0.56.)
///
/// # Panics
/// If `work` panics, after the other threads have finished.
pub(crate) fn for_each_part<P: Send>(
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
        // To hand the only part to another thread would cost two waits: until that thread wakes,
        // and until this thread does.
        take();
    } else {
        rayon::scope(|scope| {
            (1..threads).for_each(|_| scope.spawn(|_| take()));
            take();
        });
    }
    all.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// Orders parts from the ends to the middle: the first, the last, the second, and so on.
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
    /// Number of pixels with each status.
    pub fn counts(&self) -> PixelCounts {
        PixelCounts::of(self.status)
    }

    /// The indices of the rows' pixels in the picture.
    pub fn pixels(&self) -> Range<usize> {
        let first = self.first * self.width;
        first..first + self.status.len()
    }

    /// Makes every pixel unseen.
    pub(crate) fn clear(&mut self) {
        dispatch!(Level::new(), simd => self.clear_with(simd));
    }

    /// As [`Rows::clear`], compiled for vectors of type `S`.
    #[inline(always)]
    fn clear_with<S: Simd>(&mut self, _: S) {
        // Quantities without a meaning for an unseen pixel are not written, which saves time. Where
        // an earlier picture in this memory has misses, nothing is painted.
        let parts = self.status.chunks(CLEARED).zip(self.drawn.chunks_mut(CLEARED));
        for (status, drawn) in parts {
            if !status.first_chunk::<CLEARED>().is_some_and(are_misses) {
                drawn.fill(f64::INFINITY);
            }
        }
        self.status.fill(Status::Undecided);
        self.reason.fill(UndecidedReason::Unseen);
        self.uneven.fill(false);
        self.bracket.fill([f64::NAN; 2]);
        self.cap.fill(false);
        self.shadow.fill(0);
        self.occlusion.fill(0);
    }

    /// Distance of a pixel's hit or first undecided segment: [`GBuffer::distance`].
    pub(crate) fn distance(&self, pixel: usize) -> f64 {
        let distances = [self.open_from[pixel], self.drawn[pixel]];
        distance(self.status[pixel], self.reason[pixel], distances)
    }

    /// The windows over all painted pixels of the rows.
    pub fn windows(&self) -> Vec<PixelWindow> {
        windows(Level::new(), self.status, self.drawn, self.first, self.width)
    }

    /// The normals, to be written, and the other quantities that shading reads. The normals are
    /// empty if they are not kept.
    pub fn columns(&mut self) -> (&mut [[f32; 3]], Columns<'_>) {
        let columns = Columns {
            status: self.status,
            drawn: self.drawn,
            parameters: self.parameters,
            uneven: self.uneven,
            surface: self.surface,
            normal: &[],
            cap: self.cap,
            shadow: self.shadow,
            occlusion: self.occlusion,
        };
        (self.normal, columns)
    }

    /// The band of these rows, which a tracer writes results to. `only` selects pixels of the
    /// picture; if empty, all. `before` holds the picture's results of other surfaces. `advance` is
    /// [`Driver::advance`](crate::Driver::advance).
    pub(crate) fn band<'a>(
        &'a mut self,
        only: &'a [bool],
        before: (&'a [Status], &'a [f64]),
        advance: &'a dyn Fn(usize) -> bool,
    ) -> Band<'a> {
        let only = if only.is_empty() { only } else { &only[self.pixels()] };
        let before = match before {
            ([], _) => before,
            (status, drawn) => (&status[self.pixels()], &drawn[self.pixels()]),
        };
        Band {
            top: self.first,
            width: self.width,
            height: self.status.len() / self.width,
            status: &mut *self.status,
            reason: &mut *self.reason,
            open_from: &mut *self.open_from,
            drawn: &mut *self.drawn,
            bracket: &mut *self.bracket,
            parameters: &mut *self.parameters,
            uneven: &mut *self.uneven,
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
                    for_each_part((0..count).collect(), |part| {
                        taken.lock().expect("no panic").push(part);
                        KernelStats { given_up: 1, ..KernelStats::default() }
                    })
                },
            );
            assert_eq!(taken.into_inner().expect("no panic"), expected);
        }
        let work = |part| KernelStats { given_up: part, ..KernelStats::default() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        assert_eq!(pool.install(|| for_each_part((0..100).collect(), work)).given_up, 99 * 100 / 2);
    }

    #[test]
    fn a_panic_on_any_thread_is_the_caller_s() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        for bad in 0..8 {
            let work = |part| if part == bad { panic!("{part}") } else { KernelStats::default() };
            let run = || pool.install(|| for_each_part((0..8).collect(), work));
            let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run));
            let told = caught.expect_err("a panic").downcast::<String>().expect("its words");
            assert_eq!(*told, bad.to_string());
        }
    }
}
