//! The pixels of a tile. Their rays get the hits that the tile's form proves, or are followed.

use super::super::local_ray::{self, LocalRay};
use super::plane::Plane;
use super::pool::{TilePlace, TileRay, place_of, tile_place};
use super::screens::spread;
use super::tracer::BandTracer;
use crate::method::Start;
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::{f64x8, prelude::*};
use glam::DVec3;
use std::cmp::Ordering;
use zeroset_eval::{Contractions, LANES, Lanes};
use zeroset_space::Basis;

/// Bound of the relative rounding error of a bracket's distance. Brackets are far longer than that.
pub(super) const ROUNDED: f64 = 1e-13;

/// A tile of 4×4 pixels. Its lanes and bits are pixels, row by row.
pub(super) struct TilePixels {
    pub tile: TilePlace,
    /// Index of the tile in [`BandTracer::open`].
    pub index: usize,
    /// Column and row of the first pixel, in the band.
    first: [usize; 2],
    /// Offset in the band, in columns and rows, from each row of the tile's pixels to the next row.
    next: [usize; 2],
    /// Screen coordinates of the tile's columns, then of its rows.
    pub across: [f64; 4],
    pub upward: [f64; 4],
}

impl TilePixels {
    /// Returns the screen coordinates of the tile's rays.
    #[inline(always)]
    pub(super) fn screens<S: Simd>(&self, simd: S) -> [[f64x8<S>; 2]; 2] {
        spread(simd, self.across, self.upward)
    }

    /// Returns the screen coordinates of the ray with index `bit`.
    fn screen(&self, bit: usize) -> [f64; 2] {
        [self.across[bit % 4], self.upward[bit / 4]]
    }

    /// Returns the column and row in the band of the pixel with index `bit`.
    fn pixel(&self, bit: usize) -> [usize; 2] {
        let [column, row] = self.first;
        [column + bit % 4 + bit / 4 * self.next[0], row + bit / 4 * self.next[1]]
    }
}

impl<T: Scalar, S: Simd> BandTracer<'_, '_, '_, T, S> {
    #[inline(always)]
    pub(super) fn patch(&self, [column, row]: [usize; 2]) -> TilePixels {
        let (mut first, mut next) = ([4 * column, 4 * row], [0, 1]);
        let [across, upward] = match self.rays.patch(self.band.top + row) {
            Some(patch) => {
                // The pixels of a patch lie in one row of the band.
                (first, next) = ([0, row], [4, 0]);
                [0, 1].map(|axis| self.rays.screens(axis, 2 * [patch.column, patch.row][axis], 2))
            }
            None => [self.screens[0][column], self.screens[1][row]],
        };
        let index = row * self.across + column;
        TilePixels { tile: tile_place([column, row]), index, first, next, across, upward }
    }

    /// Returns the column and row of a ray's pixel in the band, and the ray's screen coordinates.
    #[inline(always)]
    pub(super) fn pixel_of(&self, ray: &TileRay<T>) -> ([usize; 2], [f64; 2]) {
        let ([column, row], bit) = (place_of(ray.tile), ray.bit as usize % LANES);
        if self.rays.is_patched() {
            let patch = self.patch([column, row]);
            return (patch.pixel(bit), patch.screen(bit));
        }
        let (across, down) = (bit % 4, bit / 4);
        let screen = [self.screens[0][column][across], self.screens[1][row][down]];
        ([4 * column + across, 4 * row + down], screen)
    }

    /// Marks the pixel of a ray as finished.
    #[inline(always)]
    fn mark_finished(&mut self, ray: &TileRay<T>) {
        let [column, row] = place_of(ray.tile);
        self.open[row * self.across + column] &= !(1 << ray.bit);
    }

    /// Records that a part of a ray is not examined. No pixel of its tile becomes a miss.
    fn lose(&mut self, ray: &TileRay<T>) {
        let [column, row] = place_of(ray.tile);
        self.coverage.lose(row * self.across + column);
    }

    /// Writes the hits that a tile's form proves on the tile's rays.
    #[inline(always)]
    pub(super) fn write_plane_hits(&mut self, plane: &Plane<T>, depth: usize, place: [usize; 2]) {
        let ([columns, rows], is_patched) = (self.pixels(place, depth), self.rays.is_patched());
        let (columns, rows) = if is_patched {
            (place[0]..=place[0], place[1]..=place[1])
        } else {
            (columns[0] / 4..=columns[1] / 4, rows[0] / 4..=rows[1] / 4)
        };
        for row in rows {
            for column in columns.clone() {
                let patch = self.patch([column, row]);
                let bits = std::mem::take(&mut self.open[patch.index]);
                if bits == 0 {
                    continue;
                }
                let found = self.plane_hits(plane, &patch);
                self.write_hits(&patch, bits, 0, &found);
            }
        }
    }

    /// Returns the distances at which a tile's rays meet a plane, and how far from there zeros may
    /// be.
    #[inline(always)]
    fn plane_hits(&self, plane: &Plane<T>, patch: &TilePixels) -> [Lanes<f64>; 2] {
        let mut found = [Lanes::splat(0.0); 2];
        let reach: f64 = plane.reach.into();
        let (mut distance, mut off) = (plane.at(patch.screens(self.simd)), self.lengths(patch));
        for (distance, off) in distance.iter_mut().zip(&mut off) {
            *distance = (self.frame.start + *distance) * *off;
            *off *= reach;
        }
        f64::narrow(distance, &mut found[0]);
        f64::narrow(off, &mut found[1]);
        found
    }

    /// Returns for each ray the distance of its bracket's middle, and half the bracket's length
    /// with a bound on the middle's rounding error.
    #[inline(always)]
    pub(super) fn between(&self, patch: &TilePixels) -> [Lanes<f64>; 2] {
        let simd = self.simd;
        let mut found = [Lanes::splat(0.0); 2];
        let Contractions { near, far, .. } = &self.memory.contractions;
        let (mut from, mut to) = (T::wide(simd, near), T::wide(simd, far));
        let lengths = self.lengths(patch);
        for ((from, to), length) in from.iter_mut().zip(&mut to).zip(lengths) {
            let middle = self.frame.start + 0.5 * (*from + *to);
            let off = 0.5 * (*to - *from) + ROUNDED * middle.abs();
            (*from, *to) = (middle * length, off * length);
        }
        f64::narrow(from, &mut found[0]);
        f64::narrow(to, &mut found[1]);
        found
    }

    /// Writes a hit in the middle of a bracket, and marks the ray's pixel as finished. The
    /// distances are computed as in [`Self::between`]. `uneven` is for [`Band::add_hit`].
    ///
    /// [`Band::add_hit`]: crate::Band::add_hit
    #[inline(always)]
    pub(super) fn add_hit(&mut self, ray: &TileRay<T>, [near, far]: [f64; 2], uneven: bool) {
        let middle = self.frame.start + 0.5 * (near + far);
        let off = 0.5 * (far - near) + ROUNDED * middle.abs();
        let ([column, row], screen) = self.pixel_of(ray);
        let length = self.length(screen);
        self.mark_finished(ray);
        self.band.add_hit(column, row, [middle * length, off * length], uneven);
    }

    /// Returns the lengths of the directions of a tile's rays.
    #[inline(always)]
    fn lengths(&self, patch: &TilePixels) -> [f64x8<S>; 2] {
        let simd = self.simd;
        if self.rays.parallel {
            return [f64x8::splat(simd, self.rays.axes.forward.length()); 2];
        }
        let [mut a, b] = patch.screens(simd);
        let is_stretched = self.rays.is_stretched();
        for (a, b) in a.iter_mut().zip(b) {
            // Each product is rounded before it is added, as in `length`. The neighbors of a pixel
            // determine which of the two functions is used for it, so both must agree.
            let square = if is_stretched {
                let Basis { forward, right, up } = self.rays.axes;
                let way = |axis: usize| forward[axis] + *a * right[axis] + b * up[axis];
                let (x, y, z) = (way(0), way(1), way(2));
                x * x + y * y + z * z
            } else {
                1.0 + *a * *a + b * b
            };
            *a = square.sqrt();
        }
        a
    }

    /// Writes hits on the rays with these bits, at `distance`. Brackets reach `off` to both sides.
    /// In brackets of rays with a bit in `uneven`, the gradient's direction may change.
    #[inline(always)]
    pub(super) fn write_hits(
        &mut self,
        patch: &TilePixels,
        bits: u16,
        uneven: u16,
        [distance, off]: &[Lanes<f64>; 2],
    ) {
        let [distance, off] = [distance.as_chunks::<4>().0, off.as_chunks::<4>().0];
        let [column, row] = patch.first;
        let is_whole = bits == u16::MAX && patch.next == [0, 1];
        if is_whole
            && let Some(distance) = distance.first_chunk()
            && self.band.add_square_of_hits(column, row, distance)
        {
            for bit in ones(uneven) {
                let [column, row] = patch.pixel(bit);
                self.band.mark_uneven(column, row);
            }
            return;
        }
        for bit in ones(bits) {
            let bracket = [distance[bit / 4][bit % 4], off[bit / 4][bit % 4]];
            let [column, row] = patch.pixel(bit);
            self.band.add_hit(column, row, bracket, uneven >> bit & 1 == 1);
        }
    }

    /// Returns the length of the direction of the ray with these screen coordinates.
    #[inline]
    fn length(&self, [a, b]: [f64; 2]) -> f64 {
        let Basis { forward, right, up } = self.rays.axes;
        if self.rays.parallel {
            forward.length()
        } else if self.rays.is_stretched() {
            let DVec3 { x, y, z } = forward + a * right + b * up;
            (x * x + y * y + z * z).sqrt()
        } else {
            (1.0 + a * a + b * b).sqrt()
        }
    }

    /// Follows up to sixteen rays to the end. Rays that may leave the region are first clipped to
    /// it.
    pub(super) fn follow_each(&mut self, rays: &[(TileRay<T>, [f64; 2])]) {
        let (region, error, start) = (self.method.task.region, self.frame.error, self.frame.start);
        let [mut screens, mut spans] = [[Lanes::splat(0.0); 2]; 2];
        let mut pixels = [[0; 2]; LANES];
        for (lane, (ray, span)) in rays.iter().enumerate() {
            let screen;
            (pixels[lane], screen) = self.pixel_of(ray);
            for k in 0..2 {
                (screens[k][lane], spans[k][lane]) = (screen[k], span[k]);
            }
        }
        let screen = |lane: usize| screens.each_ref().map(|lanes| lanes[lane]);
        let mut insides = [f64::NEG_INFINITY, f64::INFINITY].map(Lanes::splat);
        if rays.iter().any(|(ray, _)| !ray.within) {
            // Rays are clipped as closely as `f64` allows, since a ray may be undecided where it
            // leaves the region.
            let Self { simd, size, .. } = *self;
            insides = self.frame.clip_rays(simd, &screens, region, size, &mut spans);
        }
        let (mut local_rays, mut lanes) = ([LocalRay::default(); LANES], [0; LANES]);
        let mut count = 0;
        for (lane, (ray, span)) in rays.iter().enumerate() {
            let [origin, direction] = self.frame.ray(screen(lane));
            let (mut span, mut inside) = (*span, [f64::NEG_INFINITY, f64::INFINITY]);
            if !ray.within {
                (span, inside) = (spans.map(|ends| ends[lane]), insides.map(|ends| ends[lane]));
                if region.is_cut() {
                    let [column, row] = pixels[lane];
                    let ray = self.rays.ray(column, self.band.top + row);
                    let Some((near, far)) = region.span(&ray) else { continue };
                    let slack = 1e-15 * (near.abs() + start.abs());
                    span = [span[0].max(near - start - slack), span[1].min(far - start + slack)];
                    inside = local_ray::inside(region, &ray, start);
                }
            }
            // Rounded to `T`, a segment may begin slightly behind the eye.
            span[0] = span[0].max(-start);
            match span[0].partial_cmp(&span[1]) {
                Some(Ordering::Greater) => continue,
                Some(_) => {}
                // An end is NaN, so nothing is known about the ray.
                None => {
                    self.lose(ray);
                    continue;
                }
            }
            let longest = ray.longest.into();
            local_rays[count] =
                LocalRay { origin, direction, error, start: -start, span, inside, longest };
            lanes[count] = lane;
            count += 1;
        }
        if count == 0 {
            return;
        }
        let follower = &self.method.follower;
        let scratch = &mut self.memory.scratch;
        let outcomes = follower.follow(&local_rays[..count], Start::Anywhere, scratch, self.work);
        for (outcome, lane) in outcomes[..count].iter().zip(lanes) {
            let found = outcome.found(start);
            if found.is_miss() {
                continue;
            }
            if found.is_unseen() {
                self.lose(&rays[lane].0);
                continue;
            }
            if found.drawn.is_finite() {
                self.mark_finished(&rays[lane].0);
            }
            let found = found.scaled(self.length(screen(lane)));
            let [column, row] = pixels[lane];
            self.band.add(column, row, &found);
            // Most rays that are followed singly meet the surface where forms are not linear.
            self.band.mark_uneven(column, row);
        }
    }
}
