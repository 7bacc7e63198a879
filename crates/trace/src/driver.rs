//! What all methods share: threads, cancelling, progress, and where findings go.
//!
//! How a ray is followed is not known here.

use crate::gbuffer::{GBuffer, Kept};
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::method::{Segment, Start, Tracer};
use crate::ray_result::RayResult;
use crate::rows::{Rows, work_on};
use crate::squares::RAYS;
use glam::DVec3;
use rayon::prelude::*;
use std::cell::Cell;
use zeroset_space::Ray;

/// Rows of a band, the unit of work that threads share and that may be cancelled; and pixels on the
/// side of its squares.
pub const BAND_ROWS: usize = 16;
/// Pixels of a list that go together.
const LIST: usize = 1024;

/// A method at work on one surface, as seen from one place.
#[derive(Clone, Copy)]
pub struct Driver<'a> {
    /// Where rays start and go.
    pub rays: &'a RayGrid,
    /// What follows them.
    pub tracer: &'a dyn Tracer,
    /// Told how many pixels were finished since it was last called; ends the work early by
    /// returning `false`. Pixels of a new picture that were not reached then are undecided and not
    /// painted, and those followed on are as they were.
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

    /// Traces the pixels for which `only` says so, row by row, all if it is empty. Of others it may
    /// write what it finds by the way: a proof or nothing.
    ///
    /// # Panics
    /// If the buffer has another size than the picture, or `only` another number of pixels.
    pub fn picture_where(&self, only: &[bool], buffer: &mut GBuffer) -> KernelStats {
        assert_eq!((buffer.width, buffer.height), (self.rays.width(), self.rays.height()));
        assert!(only.is_empty() || only.len() == buffer.status.len(), "one for each pixel");
        work_on(buffer.rows(BAND_ROWS), |mut rows| self.rows(&mut rows, only, None))
    }

    /// A new picture of the surface with this number, otherwise as [`Driver::picture_where`] makes
    /// it, with what is to be `kept`. What lies behind the hits of other surfaces, found `before`,
    /// need not be found. Each [`BAND_ROWS`] rows are handed to `finish` while they are in the
    /// nearer caches, together with what of `parts` is theirs.
    ///
    /// # Panics
    /// If there are fewer parts than bands of rows, `only` has another number of pixels, or
    /// `before` another size.
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
        let work = work_on(buffer.rows(BAND_ROWS).into_iter().zip(parts).collect(), make);
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
            // Where nothing was found is known now, too.
            (self.advance)((band.width * band.height).saturating_sub(told.get()));
        } else {
            band.give_up(0);
        }
        work
    }

    /// Adds to `buffer.shadow` which painted points do not see the light. `towards` gives, for a
    /// pixel's column and row and its point, the unit vector to the light and the distance. Points
    /// that are dark already are left out. A ray
    /// starts `offset` away from its point (in world units), and what it meets before it is clear
    /// of that surface does not count: otherwise a surface would shade itself wherever enclosures
    /// are wide.
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
            // Off the surface on the side of the eye, then along the light.
            let origin = ray.at(t - ray.parameter(offset)) + way * offset;
            // That something is in the way is enough.
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

    /// Follows the rays of pixels on from the given distances, in world units; where those are not
    /// finite, the pixel stays as it is. What is found is behind something else, and tells nothing
    /// of the whole ray.
    ///
    /// # Panics
    /// If there are not as many distances as pixels, or the buffer has another size than the
    /// picture.
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

    /// Follows a ray for each of some pixels, as long as that is wanted; tells what is no miss,
    /// distances in world units.
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
