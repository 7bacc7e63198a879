//! Antialiasing. A pixel on an edge gets the mean color of many rays, each traced and lit like the
//! ray through its center.

use super::PREVIEWED;
use super::layers::Layered;
use super::paint::Coloring;
use super::trace::{PreparedSurface, RenderPass};
use crate::picture::Settings;
use crate::pixels::ColorBuffer;
use crate::progress::Done;
use glam::Vec4;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use zeroset_eval::{KernelFloat, LANES};
use zeroset_scene::program::ProgramError;
use zeroset_shade::{Displayed, Pattern, UndecidedStyle, edges, is_creased, is_smooth, slope};
use zeroset_trace::{BAND_ROWS, GBuffer, Patch, RayGrid, Status, TraceOptions};

/// Number of pixels that are antialiased together, small enough for the inner caches.
const PART: usize = 64;

/// The finer rays of a pixel are traced only near the depths that the picture has at the pixel and
/// its neighbors. The margin is `MARGIN_PIXELS` pixel widths, plus `SLOPE_FACTOR` times the change
/// of depth that the slope explains.
const MARGIN_PIXELS: f64 = 4.0;
const SLOPE_FACTOR: f64 = 2.0;

/// Two buffers for the finer rays of some pixels: one for all surfaces, one for a single surface.
type LayerBuffers = [GBuffer; 2];

impl<T: KernelFloat> RenderPass<'_, T> {
    /// Replaces pixels on edges by the mean over finer rays. Returns the number of these rays.
    /// `behind` is set for pixels with an edge behind a translucent surface. It may be empty.
    pub(super) fn smooth_edges(
        &self,
        rays: &RayGrid,
        picture: &GBuffer,
        behind: &[bool],
        finish: &Coloring<'_>,
        pixels: &mut ColorBuffer,
    ) -> Result<usize, ProgramError> {
        let Settings { antialias: pattern, options: TraceOptions { tolerance, .. }, .. } =
            *self.settings;
        // The tolerance is in pixels. Scaled by the pattern, it is the same in world units for
        // finer pixels.
        let tolerance = tolerance * pattern.side as f64;
        let seen = Displayed::new(picture, rays);
        let mut wanted = edges(&seen.buffer, &seen.rays);
        wanted.iter_mut().zip(behind).for_each(|(all, edge)| *all |= edge);
        // Keep the marks of undecided pixels.
        let marks = finish.appearance.undecided != UndecidedStyle::Shade;
        let is_marked = |pixel: usize| marks && picture.status[pixel] == Status::Undecided;
        let is_own = |pixel: usize| {
            self.own.as_ref().is_none_or(|own| own.contains(&(pixel / rays.width())))
        };
        let wanted =
            (0..wanted.len()).filter(|&pixel| wanted[pixel] && is_own(pixel) && !is_marked(pixel));
        let mut wanted: Vec<usize> = wanted.collect();
        let tracers =
            self.tracers(rays, |options| TraceOptions { tolerance, least: PREVIEWED, ..options })?;
        if tracers.len() > 1 {
            // Few surfaces are near all pixels that are antialiased together.
            let tile = |pixel: usize| {
                [pixel / rays.width(), pixel % rays.width()].map(|place| place / BAND_ROWS)
            };
            wanted.sort_by_key(|pixel| tile(*pixel));
        }
        let edge = Edges {
            pass: self,
            tracers: &tracers,
            rays,
            finer: rays.finer(pattern.side),
            picture,
            seen: &seen,
            pattern,
            finish,
            is_hidden: picture.shadow.iter().chain(&picture.occlusion).any(|hidden| *hidden > 0),
            has_one: tracers.len() == 1 && !self.is_translucent() && !rays.is_stretched(),
        };
        let new = || [0; 2].map(|size| GBuffer::new(size, size, 0));
        let smooth = |buffers: &mut LayerBuffers, pixels: &[usize]| {
            let found = edge.smooth(buffers, pixels);
            (self.advance)(Done::Edges { now: pixels.len(), all: wanted.len() });
            found
        };
        (self.advance)(Done::Edges { now: 0, all: wanted.len() });
        let found: Result<Vec<_>, ProgramError> =
            wanted.par_chunks(PART).map_init(new, smooth).collect();
        for (pixel, color) in found?.into_iter().flatten() {
            pixels.set(pixel, color);
        }
        Ok(wanted.len() * pattern.count())
    }
}

struct Edges<'a, T> {
    pass: &'a RenderPass<'a, T>,
    tracers: &'a [PreparedSurface<'a>],
    rays: &'a RayGrid,
    finer: RayGrid,
    picture: &'a GBuffer,
    seen: &'a Displayed<'a>,
    pattern: Pattern,
    finish: &'a Coloring<'a>,
    /// Set if the picture has shadows or ambient occlusion.
    is_hidden: bool,
    /// Set if there is a single surface, it is opaque, and space is not stretched.
    has_one: bool,
}

impl<T: KernelFloat> Edges<'_, T> {
    /// Returns the mean light and opacity of each pixel that needs antialiasing.
    fn smooth(
        &self,
        [all, layer]: &mut LayerBuffers,
        pixels: &[usize],
    ) -> Result<Vec<(usize, Vec4)>, ProgramError> {
        if !self.pass.is_wanted() {
            return Ok(Vec::new());
        }
        let patches = pixels.iter().flat_map(|pixel| self.patches(*pixel)).collect();
        let rays = self.finer.patches(patches);
        let mut only = Vec::new();
        if !self.pattern.is_full() {
            only = self.pattern.rays().repeat(pixels.len());
        }
        let mut is_smooth = vec![false; pixels.len()];
        let places =
            pixels.iter().map(|pixel| [pixel % self.rays.width(), pixel / self.rays.width()]);
        let places: Vec<[usize; 2]> = places.collect();
        let ends = [0, 1].map(|axis| {
            let along = || places.iter().map(|place| place[axis]);
            along().min().unwrap_or(0)..along().max().map_or(0, |last| last + 1)
        });
        let mut near = Vec::new();
        for prepared in self.tracers {
            let PreparedSurface { surface, tracer, window } = prepared;
            let shows = |&[column, row]: &[usize; 2]| window.contains(column, row);
            if !window.shows(&ends[0], &ends[1]) || !places.iter().any(shows) {
                continue;
            }
            let target = if near.is_empty() { &mut *all } else { &mut *layer };
            target.reset(rays.width(), rays.height(), 0);
            self.pass.make_room(*surface, target);
            let mut own = Cow::Borrowed(&only);
            if !places.iter().all(shows) {
                let rays = self.pattern.rays();
                let asked = |place| rays.iter().map(move |asked| *asked && shows(place));
                own = Cow::Owned(places.iter().flat_map(asked).collect());
                // Rays outside of the window miss the surface.
                for (n, _) in places.iter().enumerate().filter(|(_, place)| !shows(place)) {
                    target.miss(n * rays.len()..(n + 1) * rays.len());
                }
            }
            self.pass.find(*surface, &**tracer, &rays, &own, target, &|_| true)?;
            if self.has_one && self.pattern.is_full() {
                is_smooth = self.reset_smooth(pixels, &rays, target);
            }
            self.pass.compute_normals(*surface, &rays, target)?;
            if !near.is_empty() {
                all.merge(layer);
            }
            near.push(prepared);
        }
        if near.is_empty() {
            // All windows are elsewhere.
            all.reset(rays.width(), rays.height(), 0);
            all.miss(0..all.drawn.len());
        }
        let places = self.pattern.side * self.pattern.side;
        if self.is_hidden {
            all.keep_as(self.picture);
            for (n, &pixel) in pixels.iter().enumerate().filter(|(n, _)| !is_smooth[*n]) {
                self.copy_hidden_light(all, n * places..(n + 1) * places, pixel);
            }
        }
        let ground = |n: usize| self.finish.ground_at(pixels[n / places]);
        let layered = Layered {
            rays: &rays,
            picture: all,
            only: &only,
            tracers: &near,
            finish: self.finish,
            ground: &ground,
            side: self.pattern.side,
        };
        let mut finer = self.pass.colored(&layered, &mut [])?;
        for n in 0..all.drawn.len() {
            if let Some(ground) = ground(n).filter(|_| !all.is_drawn(n)) {
                finer.set(n, ground);
            }
        }
        if !self.pass.is_wanted() {
            // Some of these colors may be missing.
            return Ok(Vec::new());
        }
        let mean = |n: usize| (pixels[n], self.pattern.mean(|place| finer.get(n * places + place)));
        let found = (0..pixels.len()).filter(|n| !is_smooth[*n]).map(mean).collect();
        finer.colors.hand_back();
        Ok(found)
    }

    /// Finds the pixels that need no antialiasing, since all their rays meet the same smooth part
    /// of a surface. Resets the results of their finer rays.
    fn reset_smooth(&self, pixels: &[usize], rays: &RayGrid, finer: &mut GBuffer) -> Vec<bool> {
        let patches = rays.height() / pixels.len();
        let leave = |(n, &pixel): (usize, &usize)| {
            let rows = n * patches..(n + 1) * patches;
            let normal = self.picture.normal[pixel];
            let is_smooth = self.picture.is_drawn(pixel)
                && !is_creased(self.picture, self.rays, pixel)
                && rows.clone().all(|row| is_smooth(finer, rays, row, normal));
            if is_smooth {
                finer.forget(rows.start * LANES..rows.end * LANES);
            }
            is_smooth
        };
        pixels.iter().enumerate().map(leave).collect()
    }

    /// The patches of finer rays that cover a pixel.
    fn patches(&self, pixel: usize) -> impl Iterator<Item = Patch> {
        let (column, row) = (pixel % self.rays.width(), pixel / self.rays.width());
        let Displayed { buffer: picture, rays } = self.seen;
        let ray = rays.ray(column, row);
        let along = ray.direction.normalize().as_vec3();
        let (mut nearest, mut farthest, mut is_outline) = (f64::INFINITY, 0.0_f64, false);
        for there in around(self.rays, pixel) {
            let drawn = picture.drawn[there];
            if !drawn.is_finite() {
                is_outline = true;
                continue;
            }
            let steep = f64::from(slope(picture.normal[there], along));
            let margin = (MARGIN_PIXELS + SLOPE_FACTOR * steep) * rays.footprint(drawn);
            nearest = nearest.min(drawn - margin);
            farthest = farthest.max(drawn + margin);
        }
        // If a finer ray near an outline meets nothing up to `farthest`, it meets nothing farther
        // away.
        let until = if is_outline { farthest } else { f64::INFINITY };
        let between = [nearest, until].map(|distance| ray.parameter(distance));
        let [first, top] = [column, row].map(|place| place * self.pattern.side);
        self.pattern.patches().map(move |[x, y]| Patch { column: first + x, row: top + y, between })
    }

    /// Copies shadow and occlusion to the finer points at `places`. Candidates are the points of
    /// the pixel and its neighbors. The source is the candidate on the same surface that is nearest
    /// in depth.
    fn copy_hidden_light(&self, finer: &mut GBuffer, places: Range<usize>, pixel: usize) {
        let picture = self.picture;
        let (mut known, mut count) = ([0; 9], 0);
        for there in around(self.rays, pixel).filter(|there| picture.is_drawn(*there)) {
            known[count] = there;
            count += 1;
        }
        for n in places {
            let (drawn, surface) = (finer.drawn[n], finer.surface[n]);
            if !drawn.is_finite() {
                continue;
            }
            let (mut nearest, mut least) = (None, f64::INFINITY);
            for &there in &known[..count] {
                let off = (picture.drawn[there] - drawn).abs();
                if off < least && picture.surface[there] == surface {
                    (nearest, least) = (Some(there), off);
                }
            }
            if let Some(nearest) = nearest {
                for (mine, theirs) in [
                    (&mut finer.shadow, &picture.shadow),
                    (&mut finer.occlusion, &picture.occlusion),
                ] {
                    // The array is empty if the picture has no shadows or no occlusion.
                    if let Some(hidden) = theirs.get(nearest) {
                        mine[n] = *hidden;
                    }
                }
            }
        }
    }
}

/// A pixel and its neighbors.
fn around(rays: &RayGrid, pixel: usize) -> impl Iterator<Item = usize> {
    let (width, height) = (rays.width(), rays.height());
    let (column, row) = (pixel % width, pixel / width);
    let columns = column.saturating_sub(1)..(column + 2).min(width);
    let rows = row.saturating_sub(1)..(row + 2).min(height);
    rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
}
