//! The rays of a tile of 4×4 pixels, asked together: each along what the tile's form leaves of its segment.
//!
//! Most meet something or nothing at once. Those that do not go on in the [pool](super::pool), with rays of other tiles.

use super::frame::Frame;
use super::level::Level;
use super::pixels::Patch;
use super::plane::Plane;
use super::pool::Memory;
use super::screens::outward;
use super::tiles::Tracer;
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::{dispatch, f64x4, prelude::*};
use zeroset_eval::{LANES, Lanes};

/// So few rays of a tile are not asked on their own: they wait in the pool for others.
const FEW: u32 = 8;

impl<T: Scalar> Tracer<'_, '_, '_, T> {
    /// Follows the rays of a tile of 4×4 that are not finished, or puts them into the pool. `within`: all of the segment is in
    /// the region.
    pub(super) fn follow(
        &mut self,
        level: &Level<T>,
        lane: usize,
        segment: [f64; 2],
        within: bool,
    ) {
        let patch = self.patch(level.place(lane));
        let longest = self.method.longest * self.footprint(segment[0]);
        if !self.method.options.ideas.contract || !within && self.method.region.is_cut() {
            for bit in ones(self.open[patch.index]) {
                self.set_apart(patch.ray(bit, longest, within), segment);
            }
            return;
        }
        let plane = Plane::new(&level.batch, &level.out, lane);
        let mut inside =
            [f64::NEG_INFINITY, f64::INFINITY].map(|end| Lanes::splat(T::nearest(end)));
        let left = dispatch!(self.vectors, simd => {
            self.place(simd, &patch, &plane, segment, within, &mut inside)
        });
        let live = left & self.open[patch.index];
        if !within || live.count_ones() <= FEW {
            for bit in ones(live) {
                let to = self.admit(bit, patch.ray(bit, longest, within), 0);
                if !within {
                    self.memory.pool.cut_at_faces(to, inside.map(|ends| ends[bit]));
                }
            }
            return;
        }
        let Memory { fresh, contractions, .. } = &mut *self.memory;
        fresh.longest = Lanes::splat(T::nearest(longest));
        fresh.segments.count = LANES as u32 - live.leading_zeros();
        self.method.follower.ask(&fresh.segments, contractions);
        self.work.segments.called(live.count_ones());
        let limits = &self.limits;
        let mut sifted =
            dispatch!(self.vectors, simd => fresh.sift(simd, contractions, live, limits));
        if self.method.cleared {
            sifted.doubt();
        }
        if sifted.short != 0 {
            self.open[patch.index] &= !sifted.short;
            let found = dispatch!(self.vectors, simd => self.between(simd, &patch));
            self.write(&patch, sifted.short, &found);
        }
        for bit in ones(sifted.open) {
            let ends = self.memory.left(bit);
            self.set_apart(patch.ray(bit, longest, within), ends.map(Into::into));
        }
        // What is left is read before others are asked.
        let last = self.memory.contractions.far;
        for bit in ones(sifted.shorter | sifted.cut) {
            let to = self.admit(bit, patch.ray(bit, longest, within), 1);
            if sifted.cut >> bit & 1 == 1 {
                let cut = self.memory.fresh.segments.far[bit];
                self.memory.pool.put_aside(to, [cut, last[bit]]);
            }
        }
    }

    /// Puts the rays of a tile of 4×4 into the batch, each with what a form of the tile leaves of a segment, and if that is
    /// not `within` the region, what may be in it, and where that certainly is; returns on which anything is left.
    #[inline(always)]
    fn place<S: Simd>(
        &mut self,
        simd: S,
        patch: &Patch,
        plane: &Plane,
        segment: [f64; 2],
        within: bool,
        inside: &mut [Lanes<T>; 2],
    ) -> u16 {
        let asked = segment.map(Lanes::splat);
        let (mut left, screens) = (asked, patch.screens());
        plane.narrow::<_, T>(simd, (&screens, None), &mut left);
        if !within {
            let region = self.method.region;
            *inside = self.frame.clip_rays(simd, &screens, region, self.size, &mut left);
        }
        let batch = &mut self.memory.fresh.segments;
        let Frame { origin, direction, .. } = &self.frame;
        for axis in 0..3 {
            for (parts, lanes) in
                [(origin, &mut batch.origin[axis]), (direction, &mut batch.direction[axis])]
            {
                // What a column of the tile has in common, and what a row has.
                let along = parts[0][axis] + f64x4::simd_from(simd, patch.across) * parts[1][axis];
                let up = patch.upward.map(|upward| upward * parts[2][axis]);
                let rows = [
                    (along + up[0]).combine(along + up[1]),
                    (along + up[2]).combine(along + up[3]),
                ];
                T::narrow(rows, lanes);
            }
        }
        outward(simd, &asked, &left, self.size, [&mut batch.near, &mut batch.far])
    }
}
