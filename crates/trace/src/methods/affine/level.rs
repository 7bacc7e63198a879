//! Up to sixteen tiles of one size: their places, and the segments that still have to be examined.

use super::plane::{Plane, PlaneLanes};
use super::screens::{
    LANE_INDICES, PendingSegments, ends, outward, packed, saves_a_vector, spread,
};
use super::tiles::examined;
use super::tracer::{BandTracer, LAST, SIDES};
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::{f64x8, prelude::*, u8x16};
use std::ops::Range;
use zeroset_eval::{LANES, Lanes, Planes, Tiles};

/// The state of up to sixteen tiles of one size. The tiles' segments are the lanes of a batch.
#[derive(Default)]
pub(super) struct Level<T: Scalar> {
    /// Whether all segments of the tiles are in the region.
    pub within: bool,
    /// Lanes that hold a segment to be evaluated, as bits.
    pub live: u16,
    /// Column and row of the first tile.
    first: [usize; 2],
    /// The column and row of each tile, relative to the first tile.
    places: [[u8; 2]; LANES],
    /// Number of tiles.
    count: usize,
    /// For each lane, the index of its tile, row by row.
    tiles: [u8; LANES],
    /// For each lane, the number of evaluations of its tile.
    asked: [u8; LANES],
    /// For each tile, the segments put aside. The nearest is last.
    later: [PendingSegments<T>; LANES],
    /// Lanes whose tiles have segments put aside, as bits.
    waiting: u16,
    pub batch: Tiles<T>,
    pub out: Planes<T>,
    /// For each lane, a plane near which the zeros of its tile lie. Computed only with the option
    /// `contract`, if some tile's form proves hits, or some tile is split or examined ray by ray.
    pub planes: PlaneLanes<T>,
}

/// Number of evaluations after which a tile is split, together with all that remains of its
/// segment. Otherwise a tile far deeper than wide would be cut into a million segments.
const MAX_EVALUATIONS: u8 = 64;

/// Columns and rows of the tiles in a square of 4×4 tiles.
const SQUARE: [[u8; 2]; LANES] = {
    let mut places = [[0; 2]; LANES];
    let mut tile = 0;
    while tile < LANES {
        places[tile] = [tile as u8 % 4, tile as u8 / 4];
        tile += 1;
    }
    places
};

impl<T: Scalar> Level<T> {
    /// Returns the column and row of the tile in a lane. The unit is a tile.
    #[inline(always)]
    pub fn place(&self, lane: usize) -> [usize; 2] {
        let [column, row] = self.places[usize::from(self.tiles[lane])].map(usize::from);
        [self.first[0] + column, self.first[1] + row]
    }

    /// The columns and rows of all tiles, finished ones included.
    pub fn taken(&self) -> impl Iterator<Item = [usize; 2]> {
        let [left, top] = self.first;
        self.places[..self.count].iter().map(move |place| {
            let [column, row] = place.map(usize::from);
            [left + column, top + row]
        })
    }

    /// Starts with the unfinished tiles in these columns and rows, at most [`LANES`] tiles. Columns
    /// and rows count tiles. Each tile starts with `segment`, narrowed by the `plane` of its parent
    /// tile. Unless the tiles are `within` the region, segments are clipped to it.
    #[inline(always)]
    pub fn start(
        &mut self,
        tracer: &BandTracer<'_, '_, '_, T, impl Simd>,
        places: [Range<usize>; 2],
        level: usize,
        segment: [f64; 2],
        plane: Option<&Plane<T>>,
        within: bool,
    ) {
        self.within = within;
        self.asked = [0; LANES];
        self.live = match tracer.square(&places, level) {
            Some(square) => self.take_square(tracer, square),
            None => self.take(tracer, places, level),
        };
        if self.live == 0 {
            return;
        }
        let Tiles { near, far, .. } = &mut self.batch;
        [*near, *far] = segment.map(|end| Lanes::splat(T::nearest(end)));
        if tracer.rays.is_patched() {
            for lane in ones(self.live) {
                let row = tracer.band.top + self.place(lane)[1];
                let segment = examined::<T>(tracer.rays, row, tracer.frame.start, segment);
                [self.batch.near[lane], self.batch.far[lane]] = segment.map(T::nearest);
            }
        }
        self.live &= self.shorten(tracer, plane);
        self.live &= !tracer.hidden_lanes(self, self.live, level);
    }

    /// Sets the places of the tiles in these columns and rows. Returns the lanes of unfinished
    /// tiles, as bits.
    #[inline(always)]
    fn take(
        &mut self,
        tracer: &BandTracer<'_, '_, '_, T, impl Simd>,
        [columns, rows]: [Range<usize>; 2],
        level: usize,
    ) -> u16 {
        self.first = [columns.start, rows.start];
        self.tiles = LANE_INDICES;
        let mut across = [[0.0; 2]; LANES];
        for (extent, column) in across.iter_mut().zip(columns.clone()) {
            *extent = tracer.across(column, level);
        }
        let [mut centre, mut half] = [[Lanes::splat(0.0); 2]; 2];
        let (mut open, mut lane) = (0, 0);
        for (down, row) in rows.enumerate() {
            let upward = tracer.upward(row, level);
            if let Some(patch) = tracer.rays.patch(tracer.band.top + row) {
                across[0] = tracer.extent(0, patch.column, patch.column + 3);
            }
            for (aside, (extent, column)) in across.iter().zip(columns.clone()).enumerate() {
                self.places[lane] = [aside as u8, down as u8];
                for (axis, extent) in [extent, &upward].into_iter().enumerate() {
                    (centre[axis][lane], half[axis][lane]) = (extent[0], extent[1]);
                }
                open |= u16::from(tracer.is_open([column, row], level)) << lane;
                lane += 1;
            }
        }
        self.count = lane;
        let simd = tracer.simd;
        for axis in 0..2 {
            let [centre, half] = [f64::wide(simd, &centre[axis]), f64::wide(simd, &half[axis])];
            tracer.frame.place_tiles(axis, [centre, half], &mut self.batch);
        }
        open
    }

    /// As [`Self::take`], for the [square](BandTracer::square) that begins in this column and row.
    #[inline(always)]
    fn take_square(
        &mut self,
        tracer: &BandTracer<'_, '_, '_, T, impl Simd>,
        [column, row]: [usize; 2],
    ) -> u16 {
        self.first = [column, row];
        (self.places, self.count) = (SQUARE, LANES);
        self.tiles = LANE_INDICES;
        let side = SIDES[LAST];
        // A tile's center is halfway between its first and last pixel. `screens` takes the sum of
        // the two pixels' columns or rows.
        let across = tracer.rays.screens(0, 2 * side * column + side - 1, 2 * side);
        let top = tracer.band.top + side * row;
        let upward = tracer.rays.screens(1, 2 * top + side - 1, 2 * side);
        let half = f64x8::splat(tracer.simd, (side - 1) as f64 * tracer.rays.unit);
        for (axis, centre) in spread(tracer.simd, across, upward).into_iter().enumerate() {
            tracer.frame.place_tiles(axis, [centre, [half; 2]], &mut self.batch);
        }
        tracer.open_in_square([column, row])
    }

    /// Shortens the segments in the batch to the parts that may hold a zero in the region. Returns
    /// the lanes with a non-empty part, as bits.
    #[inline(always)]
    fn shorten<S: Simd>(
        &mut self,
        tracer: &BandTracer<'_, '_, '_, T, S>,
        plane: Option<&Plane<T>>,
    ) -> u16 {
        let simd = tracer.simd;
        let Tiles { centre, half, near, far, .. } = &mut self.batch;
        let mut left = u16::MAX;
        if let Some(plane) = plane {
            left = plane.narrow(simd, (centre, Some(half)), [near, far]);
        }
        if !self.within {
            let region = tracer.method.task.region;
            let asked = ends(simd, near, far);
            let mut clipped = asked;
            tracer.frame.clip(simd, (centre, Some(half)), region, &mut clipped);
            left = outward(simd, &asked, &clipped, tracer.size, [near, far]);
        }
        left
    }

    /// Puts a part of a lane's segment aside. It is evaluated after the nearer parts.
    #[inline(always)]
    pub fn put_aside(&mut self, lane: usize, part: [T; 2]) {
        let tile = usize::from(self.tiles[lane]);
        self.later[tile].push(part);
        self.waiting |= 1 << lane;
    }

    /// Counts one evaluation of each tile. Returns the lanes whose tiles have been evaluated
    /// [`MAX_EVALUATIONS`] times, as bits.
    #[inline(always)]
    pub fn count_evaluation(&mut self, simd: impl Simd) -> u16 {
        let asked = u8x16::simd_from(simd, self.asked) + 1;
        asked.store_slice(&mut self.asked);
        asked.simd_ge(MAX_EVALUATIONS).to_bitmask() as u16
    }

    /// Joins all segments that were put aside for a lane's tile into one.
    #[inline(always)]
    pub fn merge_later(&mut self, lane: usize) {
        let later = &mut self.later[usize::from(self.tiles[lane])];
        if let ([_, far], Some([near, _])) =
            (later.first().copied().unwrap_or_default(), later.pop())
        {
            later.clear();
            later.push([near, far]);
        }
    }

    /// Keeps the segments in the lanes `kept` and drops the others. Returns the dropped lanes whose
    /// tiles have segments put aside, as bits.
    #[inline(always)]
    pub fn retain(&mut self, kept: u16) -> u16 {
        let done = self.live & !kept;
        self.live &= kept;
        done & self.waiting
    }

    /// Continues with the next segment that was put aside for a lane's tile. If the tile has no
    /// unfinished pixel (`is_open` is false), drops all of its segments.
    #[inline(always)]
    pub fn resume(&mut self, lane: usize, is_open: bool) {
        let tile = usize::from(self.tiles[lane]);
        if !is_open {
            self.later[tile].clear();
        }
        if let Some([near, far]) = self.later[tile].pop() {
            (self.batch.near[lane], self.batch.far[lane]) = (near, far);
            self.live |= 1 << lane;
        }
        if self.later[tile].is_empty() {
            self.waiting &= !(1 << lane);
        }
    }

    /// Moves the live lanes to the front if that saves a vector.
    #[inline(always)]
    pub fn pack<S: Simd>(&mut self, simd: S) {
        if saves_a_vector::<T, S>(self.live) {
            self.pack_batch(simd);
            let mut waiting = 0;
            for (to, from) in ones(self.live).enumerate() {
                self.tiles[to] = self.tiles[from];
                self.asked[to] = self.asked[from];
                waiting |= (self.waiting >> from & 1) << to;
            }
            self.waiting = waiting;
            self.live = packed(self.live);
        }
        self.batch.count = LANES as u32 - self.live.leading_zeros();
    }

    /// Moves the live tiles of the batch to its first lanes.
    #[inline(always)]
    fn pack_batch<S: Simd>(&mut self, simd: S) {
        // The compiler keeps this copy in a register. It would read `self.live` again for each
        // quantity.
        let kept = self.live;
        let Tiles { centre: [across, up], half: [wide, high], near, far, .. } = &mut self.batch;
        for lanes in [across, up, wide, high, near, far] {
            T::pack(simd, lanes, kept);
        }
    }
}
