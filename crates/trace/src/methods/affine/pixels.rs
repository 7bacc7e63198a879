//! The pixels of a tile: hits that the tile's form proves, and rays that have to be followed.

use super::super::way::{self, Way};
use super::plane::Plane;
use super::screens::Ends;
use super::tiles::Tracer;
use crate::method::Start;
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::{dispatch, f64x8, prelude::*};
use zeroset_eval::{LANES, Lanes};

/// A tile of 4×4 pixels. Its lanes and bits are pixels, row by row.
pub(super) struct Patch {
    /// Where its bits are among those of all tiles.
    pub index: usize,
    /// The first column and row.
    first: [usize; 2],
    /// How far the next row is: in columns and rows.
    next: [usize; 2],
    /// Screen coordinates of its columns and rows.
    pub across: [f64; 4],
    pub upward: [f64; 4],
}

impl Patch {
    pub(super) fn screen(&self, bit: usize) -> [f64; 2] {
        [self.across[bit % 4], self.upward[bit / 4]]
    }

    /// Those of its rays.
    #[inline(always)]
    pub(super) fn screens(&self) -> [Lanes<f64>; 2] {
        let mut screens = [Lanes::splat(0.0); 2];
        for (row, upward) in self.upward.into_iter().enumerate() {
            screens[0].as_chunks_mut().0[row] = self.across;
            screens[1].as_chunks_mut().0[row] = [upward; 4];
        }
        screens
    }

    fn column(&self, bit: usize) -> usize {
        self.first[0] + bit % 4 + bit / 4 * self.next[0]
    }

    fn row(&self, bit: usize) -> usize {
        self.first[1] + bit / 4 * self.next[1]
    }
}

impl<T: Scalar> Tracer<'_, '_, '_, T> {
    pub(super) fn patch(&self, [column, row]: [usize; 2]) -> Patch {
        let (mut first, mut next) = ([4 * column, 4 * row], [0, 1]);
        let [across, upward] = match self.rays.patch(self.band.top + row) {
            Some(patch) => {
                // It lies in one row of the band.
                (first, next) = ([0, row], [4, 0]);
                [0, 1].map(|axis| self.rays.screens(axis, 2 * [patch.column, patch.row][axis], 2))
            }
            None => [self.screens[0][column], self.screens[1][row]],
        };
        Patch { index: row * self.across + column, first, next, across, upward }
    }

    /// Writes the hits that a tile's form proves on the rays of its pixels.
    pub(super) fn emit(&mut self, plane: &Plane, depth: usize, place: [usize; 2]) {
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
                let found = dispatch!(self.vectors, simd => self.on_plane(simd, plane, &patch));
                self.write(&patch, bits, &found);
            }
        }
    }

    /// The distances at which rays meet a plane, and how far from that a zero may be.
    #[inline(always)]
    fn on_plane<S: Simd>(&self, simd: S, plane: &Plane, patch: &Patch) -> [Lanes<f64>; 2] {
        let mut found = [Lanes::splat(0.0); 2];
        let (mut distance, mut off) = (plane.at(simd, &patch.screens()), self.lengths(simd, patch));
        for (distance, off) in distance.iter_mut().zip(&mut off) {
            *distance = (self.frame.start + *distance) * *off;
            *off *= plane.reach();
        }
        f64::narrow(distance, &mut found[0]);
        f64::narrow(off, &mut found[1]);
        found
    }

    /// The distances in the middle of brackets, and how far those reach.
    #[inline(always)]
    pub(super) fn between<S: Simd>(&self, simd: S, patch: &Patch, ends: &Ends) -> [Lanes<f64>; 2] {
        let mut found = [Lanes::splat(0.0); 2];
        let [mut from, mut to] = [f64::wide(simd, &ends[0]), f64::wide(simd, &ends[1])];
        let lengths = self.lengths(simd, patch);
        for ((from, to), length) in from.iter_mut().zip(&mut to).zip(lengths) {
            let middle = self.frame.start + 0.5 * (*from + *to);
            // What these sums round is far below what kernels leave of a bracket.
            let off = 0.5 * (*to - *from) + 1e-13 * middle.abs();
            (*from, *to) = (middle * length, off * length);
        }
        f64::narrow(from, &mut found[0]);
        f64::narrow(to, &mut found[1]);
        found
    }

    /// The lengths of rays' directions.
    #[inline(always)]
    fn lengths<S: Simd>(&self, simd: S, patch: &Patch) -> [f64x8<S>; 2] {
        if self.rays.is_parallel() {
            return [f64x8::splat(simd, 1.0); 2];
        }
        let screens = patch.screens();
        let mut a = f64::wide(simd, &screens[0]);
        let b = f64::wide(simd, &screens[1]);
        for (a, b) in a.iter_mut().zip(b) {
            *a = (1.0 + *a * *a + b * b).sqrt();
        }
        a
    }

    /// Writes hits at distances, on the rays with these bits.
    pub(super) fn write(&mut self, patch: &Patch, bits: u16, [distance, off]: &[Lanes<f64>; 2]) {
        let [distance, off] = [distance.as_chunks::<4>().0, off.as_chunks::<4>().0];
        let [column, row] = patch.first;
        let is_whole = bits == u16::MAX && patch.next == [0, 1];
        if is_whole
            && let Some(distance) = distance.first_chunk()
            && self.band.add_square_of_hits(column, row, distance)
        {
            return;
        }
        for bit in ones(bits) {
            let (distance, off) = (distance[bit / 4][bit % 4], off[bit / 4][bit % 4]);
            self.band.add_hit(patch.column(bit), patch.row(bit), distance, off);
        }
    }

    /// Follows these rays of a tile of 4×4 one by one between `ends`, each as far as it is in the region, unless all is
    /// `within` it.
    pub(super) fn follow_apart(
        &mut self,
        patch: &Patch,
        rays: u16,
        mut ends: Ends,
        longest: f64,
        within: bool,
    ) {
        let (region, error, start) = (self.method.region, self.frame.error, self.frame.start);
        let mut insides = [f64::NEG_INFINITY, f64::INFINITY].map(Lanes::splat);
        if !within {
            // As closely as f64 knows where they leave the region, which may be all that is left to tell.
            let screens = patch.screens();
            dispatch!(self.vectors, simd => {
                insides = self.frame.clip_rays(simd, &screens, region, self.size, &mut ends);
            });
        }
        let (mut ways, mut bits) = ([Way::NONE; LANES], [0; LANES]);
        let mut count = 0;
        for bit in ones(rays) {
            let [origin, direction] = self.frame.ray(patch.screen(bit));
            let mut span = ends.map(|ends| ends[bit]);
            let mut inside = insides.map(|ends| ends[bit]);
            if !within && region.is_cut() {
                let ray = self.rays.ray(patch.column(bit), self.band.top + patch.row(bit));
                let Some((near, far)) = region.span(&ray) else { continue };
                let slack = 1e-15 * (near.abs() + start.abs());
                span = [span[0].max(near - start - slack), span[1].min(far - start + slack)];
                inside = way::inside(region, &ray, start);
            }
            // Not so either if one is not a number.
            let is_left = span[0] <= span[1];
            if !is_left {
                continue;
            }
            ways[count] = Way { origin, direction, error, start: -start, span, inside, longest };
            bits[count] = bit;
            count += 1;
        }
        if count > 0 {
            self.follow_ways(patch, &ways[..count], &bits);
        }
    }

    /// The length of a ray's direction.
    #[inline]
    fn length(&self, [a, b]: [f64; 2]) -> f64 {
        if self.rays.is_parallel() { 1.0 } else { (1.0 + a * a + b * b).sqrt() }
    }

    /// Follows rays of a tile of 4×4, given by their bits, one by one to the end.
    fn follow_ways(&mut self, patch: &Patch, ways: &[Way], bits: &[usize; LANES]) {
        let follower = &self.method.follower;
        let outcomes = follower.follow(ways, Start::Anywhere, &mut self.scratch, self.work);
        for (outcome, &bit) in outcomes[..ways.len()].iter().zip(bits) {
            let found = outcome.found(self.frame.start);
            if found.is_miss() {
                continue;
            }
            if found.drawn.is_finite() {
                self.open[patch.index] &= !(1 << bit);
            }
            let found = found.scaled(self.length(patch.screen(bit)));
            self.band.add(patch.column(bit), patch.row(bit), &found);
        }
    }
}
