//! The pool: rays of several tiles, followed together to the end.
//!
//! A tile often has few rays left, after its first evaluation or even before. A kernel takes little
//! longer for sixteen rays than for one. So these rays wait in the pool until there are sixteen. If
//! a segment is cut, the nearer part stays in its lane, and the farther part waits.
//!
//! Some rays are set apart and followed one by one. They need more precision than tiles have, or
//! are possible hits of a rational form, or a clipping plane or the edge of a ball cuts their tile.
//!
//! The pool holds a ray at most once. The next segment of its tile waits until the ray is finished.

use super::classify::EvaluatedSegments;
use super::narrow::Scratch;
use super::screens::{LANE_INDICES, PendingSegments, packed, saves_a_vector};
use super::tracer::SIDES;
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::{mask8x16, mask32x16, prelude::*, u8x16, u32x16};
use zeroset_eval::{Contractions, LANES, Lanes, Segments};

/// Place of a 4×4 tile in its band. The lowest [`COLUMN_BITS`] are the column, the others the row.
pub(super) type TilePlace = u32;

/// Number of bits for the column. The row needs few bits: a band of pixels has four rows of tiles,
/// and a band of patches has at most `SIDES[0]`. A picture may be very wide, so the column gets the
/// other bits.
const COLUMN_BITS: u32 = TilePlace::BITS - SIDES[0].ilog2();
/// Largest number of columns of tiles.
pub(super) const MAX_COLUMNS: usize = 1 << COLUMN_BITS;

/// Returns the place of the tile in this column and row.
#[inline(always)]
pub(super) fn tile_place([column, row]: [usize; 2]) -> TilePlace {
    (row << COLUMN_BITS | column) as TilePlace
}

/// Returns the column and row of a tile.
#[inline(always)]
pub(super) fn place_of(tile: TilePlace) -> [usize; 2] {
    [tile as usize % MAX_COLUMNS, tile as usize >> COLUMN_BITS]
}

/// A ray of a 4×4 tile.
#[derive(Clone, Copy, Default)]
pub(super) struct TileRay<T> {
    pub tile: TilePlace,
    /// Index of the ray's pixel among the tile's pixels.
    pub bit: u32,
    /// Maximum length of a hit's bracket.
    pub longest: T,
    /// Whether the ray's whole segment is in the region.
    pub within: bool,
}

impl<T> TileRay<T> {
    /// Returns the ray of the same tile whose pixel has index `bit`.
    #[inline(always)]
    pub fn at(self, bit: usize) -> Self {
        Self { bit: bit as u32, ..self }
    }
}

/// Rays that are followed together, one per lane.
#[derive(Default)]
pub(super) struct Pool<T: Scalar> {
    /// Lanes in use, as bits.
    pub live: u16,
    pub evaluated: EvaluatedSegments<T>,
    /// For each lane, the range of s in which the ray is proven to lie in the region.
    pub inside: [Lanes<T>; 2],
    pub tiles: [TilePlace; LANES],
    pub bits: [u32; LANES],
    /// Lanes whose rays are [within](TileRay::within) the region, as bits.
    within: u16,
    /// For each lane, the number of evaluations of the ray.
    pub rounds: [u8; LANES],
    /// For each lane, the segments put aside. The nearest is last.
    later: [PendingSegments<T>; LANES],
    /// Lanes that have segments put aside, as bits.
    waiting: u16,
    /// Rays that are followed one by one. Each has a first and a last s.
    pub apart: Vec<(TileRay<T>, [f64; 2])>,
}

/// Buffers that are reused from band to band.
#[derive(Default)]
pub(super) struct RayBuffers<T: Scalar> {
    /// The rays of one tile.
    pub tile_rays: EvaluatedSegments<T>,
    pub contractions: Contractions<T>,
    pub pool: Pool<T>,
    pub scratch: Scratch<T>,
}

/// The range in [`Pool::inside`] of a ray whose whole segment is in the region.
pub(super) const ANYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

impl<T: Scalar> RayBuffers<T> {
    /// Sets the error of rays' coordinates in both batches.
    pub fn set_error(&mut self, error: [Lanes<T>; 3]) {
        self.tile_rays.segments.error = error;
        self.pool.evaluated.segments.error = error;
    }

    /// Returns the part of a lane's segment that remains after the kernel narrowed it.
    pub fn remaining(&self, lane: usize) -> [T; 2] {
        [self.contractions.near[lane], self.contractions.far[lane]]
    }
}

impl<T: Scalar> Pool<T> {
    /// Puts a part of a lane's segment aside. It is evaluated after the nearer parts.
    pub fn put_aside(&mut self, lane: usize, part: [T; 2]) {
        self.later[lane].push(part);
        self.waiting |= 1 << lane;
    }

    /// Sets the range of s in which a lane's ray is proven to lie in the region, and cuts the ray's
    /// segment at the range's ends. The function's sign is unknown outside the region, so the parts
    /// are evaluated separately. All parts but the nearest are put aside.
    pub fn cut_at_faces(&mut self, lane: usize, [first, last]: [T; 2]) {
        let segments = &self.evaluated.segments;
        (self.inside[0][lane], self.inside[1][lane]) = (first, last);
        let (near, far) = (segments.near[lane], segments.far[lane]);
        let is_within = first <= near && far <= last;
        if is_within || !(first < last && near < last && first < far) {
            return;
        }
        let mut here = far;
        if last < far {
            here = last;
            self.put_aside(lane, [last, far]);
        }
        if near < first {
            self.put_aside(lane, [first, here]);
            here = first;
        }
        self.evaluated.segments.far[lane] = here;
    }

    /// Frees a lane. Returns its ray, and the far end of the segments put aside for it, if any.
    #[inline(always)]
    pub fn free_lane(&mut self, lane: usize) -> (TileRay<T>, Option<T>) {
        self.live &= !(1 << lane);
        let mut last = None;
        if self.waiting >> lane & 1 == 1 {
            self.waiting &= !(1 << lane);
            last = self.later[lane].first().map(|part| part[1]);
            self.later[lane].clear();
        }
        let ray = TileRay {
            tile: self.tiles[lane],
            bit: self.bits[lane],
            longest: self.evaluated.longest[lane],
            within: self.within >> lane & 1 == 1,
        };
        (ray, last)
    }

    /// Continues each lane in `done` with the next segment put aside for it. Frees lanes without
    /// any.
    #[inline(always)]
    pub fn resume(&mut self, done: u16) {
        self.live &= !done;
        for lane in ones(done & self.waiting) {
            if let Some([near, far]) = self.later[lane].pop() {
                let Segments { near: nears, far: fars, .. } = &mut self.evaluated.segments;
                (nears[lane], fars[lane]) = (near, far);
                self.live |= 1 << lane;
            }
            if self.later[lane].is_empty() {
                self.waiting &= !(1 << lane);
            }
        }
    }

    /// Returns whether a ray of a tile is in the pool or set apart. `place` counts tiles of this
    /// tile's size. The columns and rows of the 4×4 tiles in this tile differ only in the `finer`
    /// lowest bits.
    #[inline(always)]
    pub fn has_ray_of<S: Simd>(&self, simd: S, place: [usize; 2], finer: u32) -> bool {
        let counts = !tile_place([(1 << finer) - 1; 2]);
        let tile = tile_place(place.map(|place| place << finer));
        let tiles = u32x16::simd_from(simd, self.tiles) & counts;
        let same = tiles.simd_eq(tile).to_bitmask() as u16;
        same & self.live != 0 || self.apart.iter().any(|(ray, _)| ray.tile & counts == tile)
    }

    /// Copies rays of a tile to the pool: from the lanes `from` of the tile's batch to the free
    /// lanes `to`. A ray's bit in the tile is its lane in the batch.
    #[inline(always)]
    pub fn take<S: Simd>(
        &mut self,
        simd: S,
        rays: TileRay<T>,
        batch: &Segments<T>,
        [from, to]: [u16; 2],
        rounds: u8,
    ) {
        let EvaluatedSegments { segments, longest } = &mut self.evaluated;
        for axis in 0..3 {
            T::copy(simd, &batch.origin[axis], from, &mut segments.origin[axis], to);
            T::copy(simd, &batch.direction[axis], from, &mut segments.direction[axis], to);
        }
        T::copy(simd, &batch.near, from, &mut segments.near, to);
        T::copy(simd, &batch.far, from, &mut segments.far, to);
        T::set(simd, rays.longest, longest, to);
        for (ends, end) in self.inside.iter_mut().zip(ANYWHERE) {
            T::set(simd, T::nearest(end), ends, to);
        }
        let wide = mask32x16::from_bitmask(simd, u64::from(to));
        let tiles = u32x16::simd_from(simd, self.tiles);
        wide.select(u32x16::splat(simd, rays.tile), tiles).store_slice(&mut self.tiles);
        let bits = u32x16::simd_from(simd, LANE_INDICES.map(u32::from));
        let bits = bits.compress(mask32x16::from_bitmask(simd, u64::from(from)));
        let bits = bits.expand_merge(wide, u32x16::simd_from(simd, self.bits));
        bits.store_slice(&mut self.bits);
        let old = u8x16::simd_from(simd, self.rounds);
        let narrow = mask8x16::from_bitmask(simd, u64::from(to));
        narrow.select(u8x16::splat(simd, rounds), old).store_slice(&mut self.rounds);
        self.within = self.within & !to | if rays.within { to } else { 0 };
        self.live |= to;
    }

    /// Moves the rays to the front if that saves a vector.
    #[inline(always)]
    pub fn pack<S: Simd>(&mut self, simd: S) {
        if !saves_a_vector::<T, S>(self.live) {
            return;
        }
        // The compiler keeps this copy in a register. It would read `self.live` again for each
        // quantity.
        let kept = self.live;
        let (EvaluatedSegments { segments, longest }, [first, last]) =
            (&mut self.evaluated, &mut self.inside);
        let Segments { origin, direction, near, far, .. } = segments;
        let ([ox, oy, oz], [dx, dy, dz]) = (origin, direction);
        for lanes in [ox, oy, oz, dx, dy, dz, near, far, longest, first, last] {
            T::pack(simd, lanes, kept);
        }
        let wide = mask32x16::from_bitmask(simd, u64::from(kept));
        for lanes in [&mut self.tiles, &mut self.bits] {
            u32x16::simd_from(simd, *lanes).compress(wide).store_slice(lanes);
        }
        let (mut waiting, mut within) = (0, 0);
        for (to, from) in ones(kept).enumerate() {
            self.rounds[to] = self.rounds[from];
            self.later.swap(to, from);
            waiting |= (self.waiting >> from & 1) << to;
            within |= (self.within >> from & 1) << to;
        }
        (self.waiting, self.within) = (waiting, within);
        self.live = packed(kept);
    }
}
