//! Tiles of rays are split: from 16×16 pixels to 4×4 pixels, and from there to single rays.

use super::Affine;
use super::classify::LengthLimits;
use super::coverage::{Coverage, TileRanges};
use super::frame::RayFrame;
use super::level::Level;
use super::narrow::{MIN_BLUR_SHARE, STALL_LENGTH, are_progress};
use super::pool::{MAX_COLUMNS, RayBuffers};
use super::tracer::{BandTracer, LAST, SIDES};
use crate::band::Band;
use crate::grid::RayGrid;
use crate::kernel_stats::KernelStats;
use crate::methods::local_ray::CUT;
use crate::painted::ones;
use crate::scalar::Scalar;
use crate::simd_chunks::parts;
use fearless_simd::{Level as Vectors, prelude::*};
use std::ops::Range;
use zeroset_eval::dispatch;
use zeroset_eval::{LANES, Lanes, Tiles};

/// Per level, a tile is split if its segment is no longer than this many times the tile's width.
const SLENDER: [f64; 2] = [3.0, 4.0];
/// [`SLENDER`] for patches. It is larger, since patches lie at outlines, where surfaces are deep
/// and patches are narrow, and since the rays of a patch fill a batch.
const SLENDER_PATCH: f64 = 12.0;
/// A tile is also split if its form's error is at most this many times the form's change across the
/// tile. Then the surface is steep rather than curved, so the parts have shorter segments.
const TILTED: f64 = 2.0;
/// If more than this share of a segment's length is left, evaluating the segment again is no use.
/// Its tile is split, or the segment is cut.
const STALL_RATIO: f64 = 0.85;

/// A thread's buffers for a band, which are reused. Creating them takes a few hundred allocations.
#[derive(Default)]
pub(super) struct BandBuffers<T: Scalar> {
    levels: [Level<T>; SIDES.len()],
    memory: RayBuffers<T>,
    /// Memory for [`BandTracer::screens`].
    screens: [Vec<[f64; 4]>; 2],
    coverage: Coverage,
}

/// The state of a band that is traced part by part, between its parts.
pub(super) struct BandState<T: Scalar> {
    pub frame: RayFrame,
    /// As [`BandTracer::open`].
    open: Vec<u16>,
    across: usize,
    size: f64,
    limits: LengthLimits<T>,
    buffers: Box<BandBuffers<T>>,
}

/// A part of a band: some tiles, or some patches, over a segment of their rays.
#[derive(Clone, Debug)]
pub(super) struct BandPart {
    /// Level of the tiles. Patches are tiles of the last level in one column.
    pub level: usize,
    pub columns: Range<usize>,
    pub rows: Range<usize>,
    /// Values of s, which are floats of the tracer's precision.
    pub span: [f64; 2],
}

/// Center and half the extent of a part of the screen, per axis.
pub(super) type Area = [[f64; 2]; 2];

impl<T: Scalar> BandState<T> {
    pub fn new(method: &Affine<'_, T>, frame: RayFrame, rays: &RayGrid, band: &Band<'_>) -> Self {
        let is_patched = rays.is_patched();
        let across = if is_patched { 1 } else { band.width.div_ceil(4) };
        assert!(across <= MAX_COLUMNS && band.height <= SIDES[0], "{across} columns of tiles");
        let mut open = if is_patched {
            vec![u16::MAX; band.height]
        } else {
            open_pixels(band.width, band.height)
        };
        close_unasked(&mut open, band, across, is_patched);
        let mut buffers = method.buffers.take().unwrap_or_default();
        let BandBuffers { levels, memory, screens, coverage } = &mut *buffers;
        for level in levels.iter_mut() {
            level.batch = frame.tiles();
        }
        memory.set_error(frame.segments_error());
        if !is_patched {
            let parts = [[0, across], [band.top, open.len() / across]];
            for (axis, ([first, count], screens)) in
                parts.into_iter().zip(&mut *screens).enumerate()
            {
                screens.resize(count, [0.0; 4]);
                for (four, screens) in screens.iter_mut().enumerate() {
                    *screens = rays.screens(axis, 2 * (first + 4 * four), 2);
                }
            }
        }
        let [near, _] = span::<T>(&frame);
        coverage.begin([across, open.len() / across], near);
        for (row, [from, _]) in between(rays, band, &frame).enumerate() {
            coverage.begin_at(row, from);
        }
        let size = frame.size();
        let blur = MIN_BLUR_SHARE * frame.error_in::<T>(size).max_element();
        let coarse = (STALL_LENGTH * T::GRAIN * size).max(blur);
        let limits =
            LengthLimits { grain: T::nearest(T::GRAIN * size), coarse: T::nearest(coarse) };
        Self { frame, open, across, size, limits, buffers }
    }

    /// Returns the whole band, over the whole length of its rays.
    pub fn whole(&self, rays: &RayGrid, band: &Band<'_>) -> BandPart {
        let (level, columns, rows) = if rays.is_patched() {
            (LAST, 0..1, 0..band.height)
        } else {
            (0, 0..band.width.div_ceil(SIDES[0]), 0..1)
        };
        BandPart { level, columns, rows, span: span::<T>(&self.frame) }
    }

    /// Returns whether some tiles have pixels that are not finished.
    pub fn is_open(&self, part: &BandPart) -> bool {
        let [columns, rows] = self.tiles(part);
        let lines = self.open.chunks(self.across).take(rows.end).skip(rows.start);
        lines.flat_map(|row| &row[columns.clone()]).any(|open| *open != 0)
    }

    /// The 4×4 tiles of a part.
    fn tiles(&self, part: &BandPart) -> TileRanges {
        let finer = SIDES[part.level] / SIDES[LAST];
        let down = self.open.len() / self.across;
        [(&part.columns, self.across), (&part.rows, down)]
            .map(|(some, count)| finer * some.start..(finer * some.end).min(count))
    }

    /// Records that a part is proven to hold no zero, so it is not traced.
    pub fn pass_over(&mut self, part: &BandPart) {
        let tiles = self.tiles(part);
        self.buffers.coverage.extend(tiles, part.span);
    }

    /// Finishes pixels whose tile has not been examined up to this part. A zero found in this part
    /// need not be their ray's first.
    fn close_gaps(&mut self, part: &BandPart) {
        let [near, _] = span::<T>(&self.frame);
        if part.span[0] <= near {
            return;
        }
        let [columns, rows] = self.tiles(part);
        for row in rows {
            for tile in row * self.across + columns.start..row * self.across + columns.end {
                if !self.buffers.coverage.has_reached(tile, part.span[0]) {
                    self.open[tile] = 0;
                }
            }
        }
    }

    /// Makes the wanted pixels without a result misses, if their whole rays are examined.
    pub fn set_misses(&self, rays: &RayGrid, band: &mut Band<'_>) {
        let coverage = &self.buffers.coverage;
        let [_, far] = span::<T>(&self.frame);
        if band.wants_all() && coverage.have_reached(far) {
            band.set_misses();
            return;
        }
        let ends: Vec<f64> = between(rays, band, &self.frame).map(|[_, end]| end).collect();
        let end = |tile: usize| ends.get(tile).map_or(far, |end| end.min(far));
        for tile in (0..coverage.len()).filter(|tile| coverage.has_reached(*tile, end(*tile))) {
            let (columns, rows) = if rays.is_patched() {
                (0..band.width, tile..tile + 1)
            } else {
                let side = SIDES[LAST];
                let [column, row] = [tile % self.across, tile / self.across].map(|at| side * at);
                (column..band.width.min(column + side), row..band.height.min(row + side))
            };
            for row in rows {
                for column in columns.clone() {
                    if band.is_wanted_pixel(column, row) {
                        band.set_miss(column, row);
                    }
                }
            }
        }
    }

    /// Traces a part of the band. Returns whether the rest is no longer wanted.
    pub fn trace(
        &mut self,
        method: &Affine<'_, T>,
        rays: &RayGrid,
        band: &mut Band<'_>,
        part: &BandPart,
        work: &mut KernelStats,
    ) -> bool {
        self.close_gaps(part);
        dispatch!(Vectors::new(), simd => trace_with(simd, self, method, rays, band, part, work))
    }

    /// Keeps the buffers for another band.
    pub fn finish(self, method: &Affine<'_, T>) {
        method.buffers.hand_back(self.buffers);
    }
}

/// As [`BandState::trace`], compiled for vectors of type `S`.
#[inline(always)]
fn trace_with<T: Scalar, S: Simd>(
    simd: S,
    state: &mut BandState<T>,
    method: &Affine<'_, T>,
    rays: &RayGrid,
    band: &mut Band<'_>,
    part: &BandPart,
    work: &mut KernelStats,
) -> bool {
    let BandBuffers { levels, memory, screens, coverage } = &mut *state.buffers;
    let mut tracer = BandTracer {
        method,
        rays,
        band,
        open: std::mem::take(&mut state.open),
        across: state.across,
        coverage,
        screens,
        size: state.size,
        limits: state.limits,
        memory,
        frame: state.frame,
        work,
        over: false,
        calls_at_check: 0,
        simd,
    };
    let BandPart { level, columns, rows, span } = part;
    // Either all tiles are in one row, or there are at most sixteen.
    let step = if rows.len() == 1 { LANES } else { columns.len() };
    for start in columns.clone().step_by(step) {
        let some = start..columns.end.min(start + step);
        for start in rows.clone().step_by(LANES / some.len().min(LANES)) {
            if tracer.over || !tracer.band.is_wanted() {
                tracer.over = true;
                break;
            }
            let down = start..rows.end.min(start + LANES / some.len().min(LANES));
            levels[*level].start(&tracer, [some.clone(), down], *level, *span, None, false);
            if *level == LAST {
                tracer.run_last(&mut levels[LAST..]);
            } else {
                tracer.run::<0>(levels);
            }
            if tracer.over {
                break;
            }
            tracer.record(&levels[*level], *level, *span);
        }
        if tracer.over {
            break;
        }
    }
    tracer.drain_pool();
    if tracer.over {
        tracer.give_up_pool();
        return true;
    }
    state.open = tracer.open;
    false
}

/// The span of all rays. Its ends are rounded outward; all other ends are floats of `T` already.
fn span<T: Scalar>(frame: &RayFrame) -> [f64; 2] {
    let [near, far] = frame.span;
    [-T::above(-near).into(), T::above(far).into()]
}

/// For each patch of a band, the values of s between which it is examined. Empty if the rays are no
/// patches.
fn between(rays: &RayGrid, band: &Band<'_>, frame: &RayFrame) -> impl Iterator<Item = [f64; 2]> {
    let (start, rows) = (frame.start, band.top..band.top + band.height);
    let patches = rows.map_while(|row| rays.patch(row));
    patches.map(move |patch| patch.between.map(|t| t - start))
}

/// Returns the part of a segment to examine: for the patch in a row of the picture, the part in
/// [`Patch::between`](crate::Patch). Rays start at `start`.
#[inline(always)]
pub(super) fn examined<T: Scalar>(
    rays: &RayGrid,
    row: usize,
    start: f64,
    [near, far]: [f64; 2],
) -> [f64; 2] {
    match rays.patch(row) {
        Some(patch) => {
            let [from, until] = patch.between.map(|t| T::nearest(t - start).into());
            [near.max(from), far.min(until)]
        }
        None => [near, far],
    }
}

/// Returns a bit for each pixel of each 4×4 tile, row by row. Bits outside the band are clear.
fn open_pixels(width: usize, height: usize) -> Vec<u16> {
    let (across, down) = (width.div_ceil(4), height.div_ceil(4));
    let mut open = vec![u16::MAX; across * down];
    let kept = |size: usize| (0..4).map(move |k| u16::from(size.is_multiple_of(4) || k < size % 4));
    let columns: u16 = kept(width).enumerate().map(|(k, bit)| (0x1111 * bit) << k).sum();
    let rows: u16 = kept(height).enumerate().map(|(k, bit)| (0xf * bit) << (4 * k)).sum();
    for row in 0..down {
        open[row * across + across - 1] &= columns;
    }
    for last in &mut open[(down - 1) * across..] {
        *last &= rows;
    }
    open
}

/// Clears the bits of pixels that the band does not want.
fn close_unasked(open: &mut [u16], band: &Band<'_>, across: usize, is_patched: bool) {
    if band.wants_all() {
        return;
    }
    for (index, open) in open.iter_mut().enumerate() {
        let [column, row] = [4 * (index % across), 4 * (index / across)];
        let four = |k: usize| {
            if is_patched {
                band.wanted_of_four(4 * k, index)
            } else {
                band.wanted_of_four(column, row + k)
            }
        };
        *open &= (0..4).map(|k| four(k) << (4 * k)).sum::<u16>();
    }
}

/// Decisions about tiles that may hold a zero. Each is a set of lanes, as bits. A lane is in at
/// most one of the first four sets.
struct TileClasses<T> {
    /// Tiles whose form proves a zero on each ray, and locates it closely enough.
    flat: u16,
    /// Tiles whose segment got much shorter. The segment is evaluated once more.
    shorter: u16,
    /// Tiles that are split: their parts are examined next.
    finer: u16,
    /// Tiles whose segment is cut in two.
    cut: u16,
    /// Tiles of `finer` that reached the limit of evaluations. Each of their parts gets the whole
    /// remaining segment.
    exhausted: u16,
    /// Tiles whose remaining segment lies in the region.
    within: u16,
    /// Far ends of the tiles' remaining segments.
    far: Lanes<T>,
}

impl<T: Scalar, S: Simd> BandTracer<'_, '_, '_, T, S> {
    /// Records that the tiles of a level are examined over a span.
    #[inline(always)]
    fn record(&mut self, level: &Level<T>, depth: usize, span: [f64; 2]) {
        let finer = SIDES[depth] / SIDES[LAST];
        let counts = [self.across, self.open.len() / self.across];
        for [column, row] in level.taken() {
            let range =
                |place: usize, count: usize| finer * place..(finer * place + finer).min(count);
            self.coverage.extend([range(column, counts[0]), range(row, counts[1])], span);
        }
    }

    /// Examines tiles of the last level.
    #[inline(always)]
    fn run_last(&mut self, levels: &mut [Level<T>]) {
        // Inlining into both callers saves 2 % of a frame's instructions, but doubles the time to
        // compile `trace`. So development builds call it instead.
        #[cfg(not(debug_assertions))]
        self.run::<LAST>(levels);
        #[cfg(debug_assertions)]
        self.simd.vectorize(
            #[inline(always)]
            || self.run::<LAST>(levels),
        );
    }

    /// Evaluates and halves the tiles of the first level until none is live.
    #[inline(always)]
    fn run<const DEPTH: usize>(&mut self, levels: &mut [Level<T>]) {
        let (level, finer) = levels.split_first_mut().expect("a level");
        while level.live != 0 && !self.is_cancelled() {
            level.pack(self.simd);
            self.method.tiles.eval(&level.batch, &mut level.out);
            self.work.tiles.called(level.live.count_ones());
            let possible = level.live & level.out.possible;
            let exhausted = level.count_evaluation(self.simd);
            let mut kept = 0;
            if possible != 0 {
                let tile_classes = self.tile_classes::<DEPTH>(level, possible, exhausted);
                kept = tile_classes.shorter | tile_classes.cut;
                self.apply_classes::<DEPTH>(level, finer, &tile_classes);
            }
            let later = level.retain(kept);
            self.resume(level, later, DEPTH);
        }
    }

    /// Continues with the segments that were put aside for the tiles in `lanes`. A tile waits until
    /// none of its rays is being followed.
    #[inline(always)]
    fn resume(&mut self, level: &mut Level<T>, mut lanes: u16, depth: usize) {
        while lanes != 0 && !self.over {
            for lane in ones(lanes) {
                let place = level.place(lane);
                // Columns and rows of each finer level have two more bits.
                let finer = 2 * (LAST - depth) as u32;
                if !self.memory.pool.has_ray_of(self.simd, place, finer) {
                    level.resume(lane, self.is_open(place, depth));
                    lanes &= !(1 << lane);
                }
            }
            let is_done = lanes == 0 || self.advance_pending();
            assert!(is_done, "rays that are followed are in the pool or set apart");
        }
    }

    /// Decides what to do with the tiles that may hold a zero. Replaces each segment by its
    /// remaining part. If that part is cut, replaces it by the nearer half.
    #[inline(always)]
    fn tile_classes<const DEPTH: usize>(
        &self,
        level: &mut Level<T>,
        possible: u16,
        exhausted: u16,
    ) -> TileClasses<T> {
        let simd = self.simd;
        let contracts = self.method.task.options.contract;
        let Level { batch, out, .. } = level;
        let [_, growth] = self.rays.pixel();
        let slender = if self.rays.is_patched() { SLENDER_PATCH } else { SLENDER[DEPTH] };
        let [longest, width, growth, slender, grain] = [
            self.method.longest,
            self.footprint(0.0),
            growth,
            slender * SIDES[DEPTH] as f64,
            T::GRAIN * self.size,
        ]
        .map(T::nearest);
        let [twice, stalled, share, tilted] = [2.0, STALL_RATIO, CUT, TILTED].map(T::nearest);
        let (mut empty, mut fine, mut shorter, mut short, mut whole) = (0, 0, 0, 0, 0);
        let (mut narrowed, mut cut) = (0, Lanes::splat(T::default()));
        let asked = [batch.near, batch.far];
        for part in parts::<S, T::Vector<S>>(simd, batch.count as usize) {
            let [first, last] = asked.each_ref().map(|ends| part.load(ends));
            let (mut near, mut far) = (first, last);
            if contracts {
                (near, far) = (part.load(&out.near), part.load(&out.far));
            }
            let [across, upward, along] = out.slope.each_ref().map(|slope| part.load(slope));
            let [half, error] = [part.load(&out.half), part.load(&out.error)];
            let (before, left) = (last - first, far - near);
            let footprint = near.mul_add(growth, width);
            empty |= part.bits(left.simd_lt(T::default()));
            narrowed |= part.bits(first.simd_le(near) & far.simd_le(last));
            // The comparison is false if both sides overflow.
            let enough = footprint * along.abs() * longest;
            fine |= part.bits((half * error * twice).simd_lt(enough));
            shorter |= part.bits(left.simd_le(before * stalled));
            let tilt = across.abs() + upward.abs();
            let is_tilted = error.simd_le(tilt * tilted);
            short |= part.bits(left.simd_le(footprint * slender) | is_tilted);
            let between = left.mul_add(share, near);
            // If the eye is in the region, a pixel at the eye has width 0. Then only `grain` ends
            // the cutting.
            let progress = are_progress([near, far], between, before);
            whole |= part.bits(left.simd_gt(grain) & progress);
            part.store(near, &mut batch.near);
            part.store(far, &mut batch.far);
            part.store(between, &mut cut);
        }
        let (last, crossing) = (!whole, out.crossing);
        let mut possible = possible & !empty;
        possible &= !self.hidden_lanes(level, possible, DEPTH);
        let is_flat = contracts && !self.method.cleared;
        let mut flat = if is_flat { possible & crossing & fine } else { 0 };
        let shorter = possible & shorter & !last;
        let exhausted = exhausted & possible & !shorter;
        let finer = possible & (crossing | short | last) & !shorter | exhausted;
        let mut within = u16::MAX;
        if !level.within {
            let region = self.method.task.region;
            within = 0;
            if region.clip().is_none() && flat | finer != 0 {
                let Tiles { centre, half, near, far, .. } = &level.batch;
                let rays = (centre, Some(half));
                if flat != 0 {
                    // The remaining part of a segment in the region is in the region, too.
                    let asked = asked.each_ref().map(|ends| T::wide(simd, ends));
                    let all = self.frame.inside(simd, rays, region, asked);
                    flat &= all;
                    within = all & narrowed;
                }
                if finer & !within != 0 {
                    let left = [near, far].map(|ends| T::wide(simd, ends));
                    within |= self.frame.inside(simd, rays, region, left);
                }
            } else {
                flat = 0;
            }
        }
        let (shorter, finer) = (shorter & !flat, finer & !flat);
        let cuts = possible & !(flat | shorter | finer);
        let far = level.batch.far;
        if cuts != 0 {
            for part in parts::<S, T::Vector<S>>(simd, level.batch.count as usize) {
                let far = part.mask(cuts).select(part.load(&cut), part.load(&far));
                part.store(far, &mut level.batch.far);
            }
        }
        TileClasses { flat, shorter, finer, cut: cuts, exhausted: exhausted & finer, within, far }
    }

    /// Carries out the decisions of [`Self::tile_classes`].
    #[inline(always)]
    fn apply_classes<const DEPTH: usize>(
        &mut self,
        level: &mut Level<T>,
        finer: &mut [Level<T>],
        tile_classes: &TileClasses<T>,
    ) {
        for lane in ones(tile_classes.cut) {
            let cut = level.batch.far[lane];
            if !self.is_hidden(level.place(lane), DEPTH, cut.into()) {
                level.put_aside(lane, [cut, tile_classes.far[lane]]);
            }
        }
        if tile_classes.flat | tile_classes.finer != 0 && self.method.task.options.contract {
            let Level { planes, batch, out, .. } = &mut *level;
            planes.find(self.simd, batch, out, self.frame.reach);
        }
        for lane in ones(tile_classes.flat) {
            let plane = level.planes.of(&level.batch, lane);
            self.write_plane_hits(&plane, DEPTH, level.place(lane));
        }
        for lane in ones(tile_classes.exhausted) {
            level.merge_later(lane);
        }
        for lane in ones(tile_classes.finer) {
            let segment = [level.batch.near[lane].into(), tile_classes.far[lane].into()];
            let within = tile_classes.within >> lane & 1 == 1;
            if DEPTH == LAST {
                self.follow(level, lane, segment, within);
            } else {
                self.split(level, finer, lane, segment, within);
            }
        }
    }

    /// Splits a tile: examines its sixteen parts.
    #[inline(always)]
    fn split(
        &mut self,
        level: &Level<T>,
        finer: &mut [Level<T>],
        lane: usize,
        segment: [f64; 2],
        within: bool,
    ) {
        let [column, row] = level.place(lane).map(|place| 4 * place);
        let side = SIDES[LAST];
        let (columns, rows) = (self.band.width.div_ceil(side), self.band.height.div_ceil(side));
        let parts = [column..columns.min(column + 4), row..rows.min(row + 4)];
        let plane = self.method.task.options.contract;
        let plane = plane.then(|| level.planes.of(&level.batch, lane));
        finer[0].start(self, parts, LAST, segment, plane.as_ref(), within);
        self.run_last(finer);
    }
}
