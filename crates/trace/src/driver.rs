//! The driver that all methods share: threads, cancellation, progress, and storing results.
//!
//! It does not know how a ray is followed.

use crate::gbuffer::{GBuffer, Kept};
use crate::grid::{BAND_ROWS, RayGrid};
use crate::kernel_stats::KernelStats;
use crate::method::{Segment, Start, Tracer};
use crate::ray_result::{RayResult, Status};
use crate::rows::{Rows, for_each_part};
use crate::squares::RAYS;
use glam::DVec3;
use rayon::prelude::*;
use std::cell::Cell;
use zeroset_space::{Ray, Region};

/// Number of pixels that one thread takes from a list at a time.
const LIST: usize = 1024;

/// Runs a tracer on the rays of one picture.
#[derive(Clone, Copy)]
pub struct Driver<'a> {
    /// The rays of the picture.
    pub rays: &'a RayGrid,
    /// The tracer that follows the rays.
    pub tracer: &'a dyn Tracer,
    /// Progress callback. Its argument is the number of wanted pixels finished since the last call.
    /// It returns `false` to end the work early. Pixels not reached are then undecided and not
    /// painted.
    pub advance: &'a (dyn Fn(usize) -> bool + Sync),
}

impl Driver<'_> {
    /// Traces all pixels into a buffer whose pixels are all unseen.
    ///
    /// # Panics
    /// If the buffer's size differs from the picture's.
    pub fn picture(&self, buffer: &mut GBuffer) -> KernelStats {
        self.picture_where(&[], buffer)
    }

    /// Traces the pixels that `only` selects, row by row; all pixels if `only` is empty. They must
    /// be unseen. Other pixels stay as they are, or get a valid result as a side effect.
    ///
    /// # Panics
    /// If `buffer` or `only` does not have the picture's size.
    pub fn picture_where(&self, only: &[bool], buffer: &mut GBuffer) -> KernelStats {
        assert_eq!((buffer.width, buffer.height), (self.rays.width(), self.rays.height()));
        assert!(only.is_empty() || only.len() == buffer.status.len(), "one for each pixel");
        for_each_part(buffer.rows(BAND_ROWS), |mut rows| self.rows(&mut rows, only, (&[], &[])))
    }

    /// Traces a new picture of the surface with id `surface`. `kept` selects the buffer's optional
    /// quantities. `only` selects pixels as in [`Driver::picture_where`]; others stay unseen.
    /// `before` holds each pixel's result of other surfaces: the status, and the distance of the
    /// painted point. Zeros behind their hits need not be found. Without other surfaces its slices
    /// are empty. After each [`BAND_ROWS`] rows, calls `finish` with these rows and their element
    /// of `parts`, while the rows are still in the caches.
    ///
    /// # Panics
    /// If `parts` has fewer elements than the picture has bands, or if the size of `only` or
    /// `before` differs from the picture's.
    pub fn new_picture<E: Send>(
        &self,
        surface: u16,
        kept: Kept,
        only: &[bool],
        before: (&[Status], &[f64]),
        parts: Vec<E>,
        finish: impl Fn(&mut Rows<'_>, E) -> KernelStats + Sync,
    ) -> (GBuffer, KernelStats) {
        let (width, height) = (self.rays.width(), self.rays.height());
        let mut buffer = GBuffer::unset(width, height, surface, kept);
        assert!(only.is_empty() || only.len() == buffer.status.len(), "one for each pixel");
        assert!(parts.len() >= height.div_ceil(BAND_ROWS), "a part for each band");
        let is_whole = |count: usize| count == 0 || count == width * height;
        assert!(is_whole(before.0.len()) && before.0.len() == before.1.len(), "one for each pixel");
        let make = |(mut rows, part): (Rows<'_>, E)| {
            rows.clear();
            let mut work = self.rows(&mut rows, only, before);
            work += finish(&mut rows, part);
            work
        };
        let work = for_each_part(buffer.rows(BAND_ROWS).into_iter().zip(parts).collect(), make);
        (buffer, work)
    }

    /// Traces the wanted pixels of a band of rows, unless the caller cancels. Returns the work.
    fn rows(&self, rows: &mut Rows<'_>, only: &[bool], before: (&[Status], &[f64])) -> KernelStats {
        let (mut work, told) = (KernelStats::default(), Cell::new(0));
        let pixels = rows.pixels();
        let wanted = match only {
            [] => pixels.len(),
            only => only[pixels].iter().filter(|asked| **asked).count(),
        };
        let is_masked = !only.is_empty();
        let advance = |found: usize| {
            // The tracer may also set results of pixels that are not wanted.
            let found = if is_masked { found.min(wanted - told.get()) } else { found };
            told.set(told.get() + found);
            (self.advance)(found)
        };
        let mut band = rows.band(only, before, &advance);
        if band.is_wanted() {
            self.tracer.band(self.rays, &mut band, &mut work);
            // Pixels for which the tracer set no result are finished, too.
            (self.advance)(wanted.saturating_sub(told.get()));
        } else {
            band.give_up();
        }
        work
    }

    /// Sets `buffer.shadow` of painted points that the light does not reach. `towards` gets a
    /// pixel's column and row, and its painted point. It returns the unit vector to the light and
    /// the light's distance. Points already in shadow are skipped, and points from which the light
    /// is seen past `bounds`, which must hold the surface.
    ///
    /// A shadow ray starts `offset` away from the painted point, in world units. A zero on the
    /// shadow ray counts only behind a segment that is proven empty. Otherwise a surface would
    /// shade itself wherever enclosures are wide.
    pub fn shadows(
        &self,
        buffer: &mut GBuffer,
        towards: impl Fn([usize; 2], DVec3) -> (DVec3, f64) + Sync,
        offset: f64,
        bounds: &Region,
    ) -> KernelStats {
        buffer.shadow.resize(buffer.status.len(), 0);
        let width = self.rays.width();
        let segment = |pixel: usize| {
            let [column, row] = [pixel % width, pixel / width];
            let ray = self.rays.ray(column, row);
            let t = ray.parameter(buffer.drawn[pixel]);
            let (way, distance) = towards([column, row], ray.at(t));
            // The origin is moved off the surface: toward the eye, then toward the light.
            let origin = ray.at(t - ray.parameter(offset)) + way * offset;
            // Any zero before the light is enough, so a zero's distance is not refined.
            Segment {
                ray: Ray { origin, direction: way },
                to: distance,
                pixel: [f64::INFINITY, 0.0],
            }
        };
        let is_lit = |pixel: &usize| buffer.is_drawn(*pixel) && buffer.shadow[*pixel] == 0;
        let is_wanted = |pixel: &usize| is_lit(pixel) && segment(*pixel).within(bounds).is_some();
        let pixels = (0..buffer.drawn.len()).into_par_iter();
        let wanted: Vec<usize> = pixels.filter(is_wanted).collect();
        let is_hit = |found: &RayResult| found.drawn.is_finite();
        self.follow(&wanted, segment, Start::OnSurface, is_hit, |pixel, _| {
            buffer.shadow[pixel] = u8::MAX;
        })
    }

    /// Follows each pixel's ray onward from its element of `starts`, a distance in world units. A
    /// pixel whose start is not finite is not changed. The results prove nothing about the ray
    /// before its start.
    ///
    /// # Panics
    /// If `starts` or `buffer` does not have the picture's size.
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
        self.follow(
            &pixels,
            segment,
            start,
            |_| true,
            |pixel, found| {
                let from = starts[pixel];
                let found = RayResult {
                    distance: found.distance + from,
                    drawn: found.drawn + from,
                    bracket: found.bracket.map(|end| end + from),
                    ..found
                };
                buffer.set(pixel, &found);
            },
        )
    }

    /// Follows one ray for each of `pixels`, until the work is cancelled. Passes each pixel whose
    /// result `is_wanted` to `tell`, with that result. Distances in results are in world units.
    fn follow(
        &self,
        pixels: &[usize],
        segment: impl Fn(usize) -> Segment + Sync,
        start: Start,
        is_wanted: impl Fn(&RayResult) -> bool + Sync,
        mut tell: impl FnMut(usize, RayResult),
    ) -> KernelStats {
        let follow = |pixels: &[usize]| {
            if !(self.advance)(0) {
                return None;
            }
            let (mut all, mut work) = (Vec::new(), KernelStats::default());
            let mut found = [RayResult::UNSEEN; RAYS];
            for pixels in pixels.chunks(RAYS) {
                let rays: Vec<Segment> = pixels.iter().map(|&pixel| segment(pixel)).collect();
                let found = &mut found[..pixels.len()];
                found.fill(RayResult::UNSEEN);
                self.tracer.follow(&rays, start, found, &mut work);
                for ((&pixel, found), Segment { ray, .. }) in pixels.iter().zip(found).zip(&rays) {
                    if is_wanted(found) {
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
