//! The driver that all methods share: threads, cancellation, progress, and storing results.
//!
//! It does not know how a ray is followed.

use crate::gbuffer::{GBuffer, Kept};
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::method::{Segment, Start, Tracer};
use crate::ray_result::RayResult;
use crate::rows::{Rows, for_each_part};
use crate::squares::RAYS;
use glam::DVec3;
use rayon::prelude::*;
use std::cell::Cell;
use zeroset_space::Ray;

/// Number of rows in a band, the unit of work that threads share and that may be cancelled. It is
/// also the side, in pixels, of the largest tiles.
pub const BAND_ROWS: usize = 16;
/// Number of pixels in a list that one thread takes at a time.
const LIST: usize = 1024;

/// A method that traces one surface for one picture.
#[derive(Clone, Copy)]
pub struct Driver<'a> {
    /// The rays of the picture.
    pub rays: &'a RayGrid,
    /// The tracer that follows them.
    pub tracer: &'a dyn Tracer,
    /// Progress callback: gets the number of pixels finished since the last call. Returns `false`
    /// to end the work early. In a new picture, pixels that were not reached are then undecided and
    /// not painted; in an existing one, they stay as they were.
    pub advance: &'a (dyn Fn(usize) -> bool + Sync),
}

impl Driver<'_> {
    /// Traces all pixels into a buffer of misses.
    ///
    /// # Panics
    /// If the buffer has another size than the picture.
    pub fn picture(&self, buffer: &mut GBuffer) -> KernelStats {
        self.picture_where(&[], buffer)
    }

    /// Traces the pixels that `only` selects, row by row; all if it is empty. Other pixels may get
    /// results as a side effect: proofs, or nothing.
    ///
    /// # Panics
    /// If the buffer's size differs from the picture's, or the length of `only` differs from its
    /// number of pixels.
    pub fn picture_where(&self, only: &[bool], buffer: &mut GBuffer) -> KernelStats {
        assert_eq!((buffer.width, buffer.height), (self.rays.width(), self.rays.height()));
        assert!(only.is_empty() || only.len() == buffer.status.len(), "one for each pixel");
        for_each_part(buffer.rows(BAND_ROWS), |mut rows| self.rows(&mut rows, only, None))
    }

    /// Traces a new picture of the surface with this id. `kept` selects its optional quantities;
    /// `only` selects pixels as in [`Driver::picture_where`]. Zeros behind the hits of other
    /// surfaces in `before` need not be found. For each [`BAND_ROWS`] rows, calls `finish` with the
    /// rows and their element of `parts`, while the rows are in the nearer caches.
    ///
    /// # Panics
    /// If there are fewer parts than bands of rows, or if `only` or `before` has another size than
    /// the picture.
    pub fn new_picture<E: Send>(
        &self,
        surface: u16,
        kept: Kept,
        only: &[bool],
        before: Option<&GBuffer>,
        parts: Vec<E>,
        finish: impl Fn(&mut Rows<'_>, E) -> KernelStats + Sync,
    ) -> (GBuffer, KernelStats) {
        let (width, height) = (self.rays.width(), self.rays.height());
        let mut buffer = GBuffer::unset(width, height, surface, kept);
        assert!(only.is_empty() || only.len() == buffer.status.len(), "one for each pixel");
        assert!(parts.len() >= height.div_ceil(BAND_ROWS), "a part for each band");
        assert!(before.is_none_or(|before| (before.width, before.height) == (width, height)));
        let make = |(mut rows, part): (Rows<'_>, E)| {
            rows.clear();
            let mut work = self.rows(&mut rows, only, before);
            work += finish(&mut rows, part);
            work
        };
        let work = for_each_part(buffer.rows(BAND_ROWS).into_iter().zip(parts).collect(), make);
        (buffer, work)
    }

    fn rows(&self, rows: &mut Rows<'_>, only: &[bool], before: Option<&GBuffer>) -> KernelStats {
        let (mut work, told) = (KernelStats::default(), Cell::new(0));
        let advance = |found: usize| {
            told.set(told.get() + found);
            (self.advance)(found)
        };
        let mut band = rows.band(only, before, &advance);
        if band.is_wanted() {
            self.tracer.band(self.rays, &mut band, &mut work);
            // Pixels without a result are finished, too.
            (self.advance)((band.width * band.height).saturating_sub(told.get()));
        } else {
            band.give_up(0);
        }
        work
    }

    /// Sets `buffer.shadow` of painted points that the light does not reach. `towards` gets a
    /// pixel's column and row, and its point. It returns the unit vector to the light and the
    /// distance. Points already in shadow are skipped.
    ///
    /// A shadow ray starts `offset` away from its point, in world units. A zero counts only behind
    /// a place that is proven empty. Otherwise a surface would shade itself wherever enclosures are
    /// wide.
    pub fn shadows(
        &self,
        buffer: &mut GBuffer,
        towards: impl Fn([usize; 2], DVec3) -> (DVec3, f64) + Sync,
        offset: f64,
    ) -> KernelStats {
        buffer.shadow.resize(buffer.status.len(), 0);
        let is_lit = |pixel: &usize| buffer.is_drawn(*pixel) && buffer.shadow[*pixel] == 0;
        let painted: Vec<usize> = (0..buffer.drawn.len()).filter(is_lit).collect();
        let width = self.rays.width();
        let segment = |pixel: usize| {
            let [column, row] = [pixel % width, pixel / width];
            let ray = self.rays.ray(column, row);
            let t = ray.parameter(buffer.drawn[pixel]);
            let (way, distance) = towards([column, row], ray.at(t));
            // The origin is moved off the surface toward the eye, then along the light.
            let origin = ray.at(t - ray.parameter(offset)) + way * offset;
            // Any zero in the way is enough, so its distance is not refined.
            Segment {
                ray: Ray { origin, direction: way },
                to: distance,
                pixel: [f64::INFINITY, 0.0],
            }
        };
        self.follow(&painted, segment, Start::OnSurface, |pixel, found| {
            if found.drawn.is_finite() {
                buffer.shadow[pixel] = u8::MAX;
            }
        })
    }

    /// Follows rays onward, from one start per pixel, in world units. A pixel whose start is not
    /// finite is not changed. The results hold only behind these starts, and prove nothing about
    /// the ray before.
    ///
    /// # Panics
    /// If the number of starts differs from the number of pixels, or the buffer's size differs from
    /// the picture's.
    pub fn behind(&self, starts: &[f64], start: Start, buffer: &mut GBuffer) -> KernelStats {
        assert_eq!((buffer.width, buffer.height), (self.rays.width(), self.rays.height()));
        assert_eq!(starts.len(), buffer.status.len());
        let wanted = |pixel: &usize| starts[*pixel].is_finite();
        let pixels: Vec<usize> = (0..starts.len()).filter(wanted).collect();
        let [width, growth] = self.rays.pixel();
        let segment = |pixel: usize| {
            let ray = self.rays.ray_of(pixel);
            let t = ray.parameter(starts[pixel]);
            Segment {
                ray: Ray { origin: ray.at(t), ..ray },
                to: f64::INFINITY,
                pixel: [width + growth * t, growth],
            }
        };
        self.follow(&pixels, segment, start, |pixel, found| {
            let from = starts[pixel];
            let found = RayResult {
                distance: found.distance + from,
                drawn: found.drawn + from,
                bracket: found.bracket.map(|end| end + from),
                ..found
            };
            buffer.set(pixel, &found);
        })
    }

    /// Follows one ray per given pixel, until cancelled. Passes results other than misses to
    /// `tell`, with distances in world units.
    fn follow(
        &self,
        pixels: &[usize],
        segment: impl Fn(usize) -> Segment + Sync,
        start: Start,
        mut tell: impl FnMut(usize, RayResult),
    ) -> KernelStats {
        let follow = |pixels: &[usize]| {
            if !(self.advance)(0) {
                return None;
            }
            let (mut all, mut work) = (Vec::new(), KernelStats::default());
            let mut found = [RayResult::MISS; RAYS];
            for pixels in pixels.chunks(RAYS) {
                let rays: Vec<Segment> = pixels.iter().map(|&pixel| segment(pixel)).collect();
                let found = &mut found[..pixels.len()];
                self.tracer.follow(&rays, start, found, &mut work);
                for ((&pixel, found), Segment { ray, .. }) in pixels.iter().zip(found).zip(&rays) {
                    if !found.is_miss() {
                        all.push((pixel, found.scaled(ray.distance(1.0))));
                    }
                }
            }
            Some((all, work))
        };
        let parts: Vec<(Vec<_>, KernelStats)> =
            pixels.par_chunks(LIST).filter_map(follow).collect();
        let mut work = KernelStats::default();
        for (found, part) in parts {
            work += part;
            for (pixel, found) in found {
                tell(pixel, found);
            }
        }
        work
    }
}
