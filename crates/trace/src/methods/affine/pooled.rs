//! Follows the rays in the pool, and the rays that were set apart.

use super::pool::{Pool, RayBuffers, TileRay};
use super::screens::LANE_INDICES;
use super::tracer::BandTracer;
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::{mask32x16, prelude::*, u8x16, u32x16};
use zeroset_eval::{LANES, Segments};

/// Number of evaluations after which a ray is set apart with the rest of its segment.
const ROUNDS: u8 = 64;

/// Returns the lowest `count` of the set bits.
#[inline(always)]
fn lowest<S: Simd>(simd: S, bits: u16, count: u32) -> u16 {
    let first = u32x16::simd_from(simd, LANE_INDICES.map(u32::from)).simd_lt(count);
    let first = first.select(u32x16::splat(simd, 1), u32x16::splat(simd, 0));
    let spread = first.expand(mask32x16::from_bitmask(simd, u64::from(bits)));
    spread.simd_gt(0).to_bitmask() as u16
}

impl<T: Scalar, S: Simd> BandTracer<'_, '_, '_, T, S> {
    /// Puts rays of a tile into the pool: as many as there are free lanes, and at least one. `rest`
    /// has the rays' lanes in the tile's batch, which are also their bits in the tile. Added rays
    /// are removed from `rest`. `rounds` is the number of evaluations that the rays have had.
    /// Returns the added rays' lanes in the batch and in the pool, in the same order.
    #[inline(always)]
    pub(super) fn add_to_pool(&mut self, rest: &mut u16, rays: TileRay<T>, rounds: u8) -> [u16; 2] {
        while self.memory.pool.live == u16::MAX {
            self.evaluate_pool();
        }
        let RayBuffers { tile_rays, pool, .. } = &mut *self.memory;
        let (wanted, free) = (rest.count_ones(), pool.live.count_zeros());
        let mut from = *rest;
        if free < wanted {
            from = lowest(self.simd, from, free);
        }
        let to = lowest(self.simd, !pool.live, wanted);
        pool.take(self.simd, rays, &tile_rays.segments, [from, to], rounds);
        *rest &= !from;
        [from, to]
    }

    /// Sets a ray apart: it is followed alone, between these values of s.
    pub(super) fn set_apart(&mut self, ray: TileRay<T>, ends: [f64; 2]) {
        let apart = &mut self.memory.pool.apart;
        apart.push((ray, ends));
        if apart.len() == LANES {
            self.follow_apart();
        }
    }

    /// Follows all rays in the pool and all rays set apart to the end.
    pub(super) fn drain_pool(&mut self) {
        while !self.over && self.advance_pending() {}
    }

    /// Gives up all rays in the pool and all rays set apart.
    pub(super) fn give_up_pool(&mut self) {
        let Pool { live, tiles, bits, .. } = self.memory.pool;
        let pooled = ones(live).map(|lane| (tiles[lane], bits[lane]));
        let apart = std::mem::take(&mut self.memory.pool.apart);
        for (tile, bit) in pooled.chain(apart.iter().map(|(ray, _)| (ray.tile, ray.bit))) {
            let ray = TileRay { tile, bit, ..TileRay::default() };
            let ([column, row], _) = self.pixel_of(&ray);
            self.band.give_up_pixel(column, row);
        }
    }

    /// Evaluates the pool once. If it is empty, follows the rays set apart. Returns `false` if all
    /// rays are finished.
    #[inline(always)]
    pub(super) fn advance_pending(&mut self) -> bool {
        if self.memory.pool.live != 0 {
            self.evaluate_pool();
        } else if self.memory.pool.apart.is_empty() {
            return false;
        } else {
            self.follow_apart();
        }
        true
    }

    /// Follows all rays that were set apart.
    fn follow_apart(&mut self) {
        if self.is_cancelled() {
            return;
        }
        let mut apart = std::mem::take(&mut self.memory.pool.apart);
        for some in apart.chunks(LANES) {
            self.follow_each(some);
        }
        apart.clear();
        self.memory.pool.apart = apart;
    }

    /// Evaluates the segments in the pool once.
    #[inline(always)]
    fn evaluate_pool(&mut self) {
        // Called from many places, so the code is kept out of line, compiled for the same vectors.
        self.simd.vectorize(
            #[inline(always)]
            || self.evaluate_pool_once(),
        );
    }

    /// Evaluates the segments of all rays in the pool once. Rays that are decided, or that were
    /// evaluated too often, leave the pool.
    #[inline(always)]
    fn evaluate_pool_once(&mut self) {
        let RayBuffers { pool, contractions, .. } = &mut *self.memory;
        pool.pack(self.simd);
        let live = pool.live;
        pool.evaluated.segments.count = LANES as u32 - live.leading_zeros();
        self.method.follower.eval(&pool.evaluated.segments, contractions);
        self.work.segments.called(live.count_ones());
        let limits = &self.limits;
        let simd = self.simd;
        let mut classes =
            pool.evaluated.classify(simd, contractions, Some(&pool.inside), live, limits);
        if self.method.cleared {
            classes.leave_brackets_open();
        }
        let rounds = u8x16::simd_from(simd, pool.rounds) + 1;
        rounds.store_slice(&mut pool.rounds);
        let exhausted = rounds.simd_eq(ROUNDS).to_bitmask() as u16;
        for lane in ones(classes.cut) {
            pool.put_aside(lane, [pool.evaluated.segments.far[lane], contractions.far[lane]]);
        }
        pool.resume(classes.empty);
        for lane in ones(classes.short) {
            let ends = self.memory.remaining(lane);
            let (ray, _) = self.memory.pool.free_lane(lane);
            self.add_hit(&ray, ends.map(Into::into), classes.uneven >> lane & 1 == 1);
        }
        let over = exhausted & self.memory.pool.live & !classes.open;
        for lane in ones(classes.open | over) {
            let mut ends = self.memory.remaining(lane);
            if over >> lane & 1 == 1 {
                let Segments { near, far, .. } = &self.memory.pool.evaluated.segments;
                ends = [near[lane], far[lane]];
            }
            let (ray, last) = self.memory.pool.free_lane(lane);
            // The undecided part reaches to the end of all segments that were put aside.
            let [near, far] = [ends[0], last.unwrap_or(ends[1])];
            self.set_apart(ray, [near.into(), far.into()]);
        }
    }
}
