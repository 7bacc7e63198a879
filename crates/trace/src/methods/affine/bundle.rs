//! The rays of a 4×4 tile, evaluated together. Each ray starts with the part of the tile's segment
//! that the tile's form does not rule out.
//!
//! Most rays are decided at once. The others continue in the [pool](super::pool), together with
//! rays of other tiles.

use super::level::Level;
use super::pixels::TilePixels;
use super::plane::Plane;
use super::pool::{ANYWHERE, RayBuffers, TileRay};
use super::screens::{ends, outward};
use super::tracer::BandTracer;
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::prelude::*;
use zeroset_eval::{LANES, Lanes};

/// A tile's remaining rays are not evaluated at once if they are at most this many. They wait in
/// the pool for rays of other tiles.
const FEW: u32 = 8;

impl<T: Scalar, S: Simd> BandTracer<'_, '_, '_, T, S> {
    /// Follows the unfinished rays of a 4×4 tile, or puts them into the pool. `within` states that
    /// the whole segment is in the region.
    #[inline(always)]
    pub(super) fn follow(
        &mut self,
        level: &Level<T>,
        lane: usize,
        segment: [f64; 2],
        within: bool,
    ) {
        let patch = self.patch(level.place(lane));
        let longest = T::nearest(self.method.longest * self.footprint(segment[0]));
        let rays = TileRay { tile: patch.tile, bit: 0, longest, within };
        if !self.method.task.options.contract || !within && self.method.task.region.is_cut() {
            for bit in ones(self.open[patch.index]) {
                self.set_apart(rays.at(bit), segment);
            }
            return;
        }
        let plane = level.planes.of(&level.batch, lane);
        let mut inside = ANYWHERE.map(|end| Lanes::splat(T::nearest(end)));
        let left = self.place(&patch, &plane, segment, within, &mut inside);
        let live = left & self.open[patch.index];
        if !within || live.count_ones() <= FEW {
            let mut rest = live;
            while rest != 0 {
                let [from, to] = self.add_to_pool(&mut rest, rays, 0);
                if !within {
                    for (bit, to) in ones(from).zip(ones(to)) {
                        self.memory.pool.cut_at_faces(to, inside.each_ref().map(|ends| ends[bit]));
                    }
                }
            }
            return;
        }
        let RayBuffers { tile_rays, contractions, .. } = &mut *self.memory;
        tile_rays.longest = Lanes::splat(longest);
        tile_rays.segments.count = LANES as u32 - live.leading_zeros();
        self.method.follower.eval(&tile_rays.segments, contractions);
        self.work.segments.called(live.count_ones());
        let limits = &self.limits;
        let mut classes = tile_rays.classify(self.simd, contractions, None, live, limits);
        if self.method.cleared {
            classes.leave_brackets_open();
        }
        if classes.short != 0 {
            self.open[patch.index] &= !classes.short;
            let found = self.between(&patch);
            self.write_hits(&patch, classes.short, classes.uneven, &found);
        }
        for bit in ones(classes.open) {
            let ends = self.memory.remaining(bit);
            self.set_apart(rays.at(bit), ends.map(Into::into));
        }
        // The far ends are copied, since evaluating the pool overwrites them.
        let last = self.memory.contractions.far;
        let mut rest = classes.shorter | classes.cut;
        while rest != 0 {
            let [from, to] = self.add_to_pool(&mut rest, rays, 1);
            if from & classes.cut != 0 {
                for (bit, to) in ones(from).zip(ones(to)) {
                    if classes.cut >> bit & 1 == 1 {
                        let cut = self.memory.tile_rays.segments.far[bit];
                        self.memory.pool.put_aside(to, [cut, last[bit]]);
                    }
                }
            }
        }
    }

    /// Writes the rays of a 4×4 tile to the batch. Each gets the part of `segment` that the tile's
    /// plane does not rule out.
    ///
    /// If `segment` is not `within` the region, the parts are also clipped to the region. Then
    /// `inside` gets, for each ray, the range of s in which it is proven to lie in the region.
    ///
    /// Returns the lanes with a non-empty part, as bits.
    #[inline(always)]
    fn place(
        &mut self,
        patch: &TilePixels,
        plane: &Plane<T>,
        segment: [f64; 2],
        within: bool,
        inside: &mut [Lanes<T>; 2],
    ) -> u16 {
        let simd = self.simd;
        let screens = patch.screens(simd);
        let mut at = [Lanes::splat(T::default()); 2];
        for (screens, at) in screens.into_iter().zip(&mut at) {
            T::narrow(screens, at);
        }
        let batch = &mut self.memory.tile_rays.segments;
        let [near, far] = [&mut batch.near, &mut batch.far];
        [*near, *far] = segment.map(|end| Lanes::splat(T::nearest(end)));
        let mut left = plane.narrow(simd, (&at, None), [near, far]);
        if !within {
            let region = self.method.task.region;
            let mut wide = [Lanes::splat(0.0); 2];
            for (screens, wide) in screens.into_iter().zip(&mut wide) {
                f64::narrow(screens, wide);
            }
            let asked = ends(simd, near, far);
            let mut clipped = asked;
            *inside = self.frame.clip_rays(simd, &wide, region, self.size, &mut clipped);
            left = outward(simd, &asked, &clipped, self.size, [near, far]);
        }
        self.frame.place(simd, &at, batch);
        left
    }
}
