//! Tiles of rays, from 16×16 pixels to 4×4, and from those to single rays.

use super::Affine;
use super::frame::Frame;
use super::level::Level;
use super::narrow::{BLURRED, COARSE, are_progress};
use super::plane::Plane;
use super::pool::Memory;
use super::room::Room;
use super::sift::Limits;
use crate::band::Band;
use crate::grid::RayGrid;
use crate::methods::way::CUT;
use crate::painted::ones;
use crate::scalar::Scalar;
use crate::widths::parts;
use crate::work::Work;
use fearless_simd::{Level as Vectors, dispatch, prelude::*};
use std::ops::Range;
use zeroset_eval::{LANES, Lanes};

/// Pixels on the side of a tile, by level. Each holds sixteen of the next.
pub(super) const SIDES: [usize; 2] = [16, 4];
/// The level of tiles whose parts are rays.
const LAST: usize = SIDES.len() - 1;
/// A tile is split once its segment is no longer than so many times what it is wide, by level.
const SLENDER: [f64; 2] = [3.0, 4.0];
/// The same of tiles that are patches: along an outline surfaces are deep and a patch is thin, and its rays are all there.
const SLENDER_PATCH: f64 = 12.0;
/// Or once its form changes so much more across the tile that what else it may be off by is no larger than so many times
/// that: then the surface is steep rather than curved, and a part of the tile needs a shorter segment.
const TILTED: f64 = 2.0;
/// A segment that stays longer than this share of what it was is not asked again, but that of a tile to be split, or cut.
const STALLED: f64 = 0.85;

/// Traces a band.
pub(super) fn trace<T: Scalar>(
    method: &Affine<'_, T>,
    frame: Frame,
    rays: &RayGrid,
    band: &mut Band<'_>,
    work: &mut Work,
) {
    let is_patched = rays.is_patched();
    let across = if is_patched { 1 } else { band.width.div_ceil(4) };
    let mut open =
        if is_patched { vec![u16::MAX; band.height] } else { open_pixels(band.width, band.height) };
    close_unasked(&mut open, band, across, is_patched);
    let mut room = method.rooms.take();
    let Room { levels, memory } = &mut *room;
    for level in levels.iter_mut() {
        level.batch = frame.tiles();
    }
    memory.set_error(frame.segments_error());
    let fours = |axis: usize, first: usize, count: usize| {
        (0..count).map(|four| rays.screens(axis, 2 * (first + 4 * four), 2)).collect()
    };
    let screens = if is_patched {
        Default::default()
    } else {
        [fours(0, 0, across), fours(1, band.top, open.len() / across)]
    };
    let size = frame.size();
    let blur = BLURRED * frame.error_in::<T>(size).max_element();
    let coarse = (COARSE * T::GRAIN * size).max(blur);
    let mut tracer = Tracer {
        method,
        rays,
        band,
        followed: vec![0; open.len()],
        open,
        across,
        screens,
        size,
        limits: Limits { grain: T::nearest(T::GRAIN * size), coarse: T::nearest(coarse) },
        memory,
        frame,
        work,
        vectors: Vectors::new(),
    };
    // Rounded outward once; all later ends are floats.
    let [near, far] = tracer.frame.span;
    let span = [-T::above(-near).into(), T::above(far).into()];
    let (first, count) = if is_patched {
        (LAST, tracer.band.height)
    } else {
        (0, tracer.band.width.div_ceil(SIDES[0]))
    };
    for start in (0..count).step_by(LANES) {
        if !tracer.band.is_wanted() {
            tracer.empty_pool();
            tracer.band.give_up(if is_patched { 0 } else { SIDES[0] * start });
            break;
        }
        let some = start..count.min(start + LANES);
        let places = if is_patched { [0..1, some] } else { [some, 0..1] };
        levels[first].start(&tracer, places, first, span, None, false);
        tracer.run(&mut levels[first..], first);
    }
    tracer.empty_pool();
    method.rooms.hand_back(room);
}

/// A bit for each pixel of each 4×4 tile, row by row: clear for what sticks out of the picture.
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

/// Clears the bits of pixels of which nobody asks what becomes of them.
fn close_unasked(open: &mut [u16], band: &Band<'_>, across: usize, is_patched: bool) {
    if band.is_all_asked() {
        return;
    }
    for (index, open) in open.iter_mut().enumerate() {
        let [column, row] = [4 * (index % across), 4 * (index / across)];
        let four = |k: usize| {
            if is_patched {
                band.asked_of_four(4 * k, index)
            } else {
                band.asked_of_four(column, row + k)
            }
        };
        *open &= (0..4).map(|k| four(k) << (4 * k)).sum::<u16>();
    }
}

/// What is to be done with tiles that were asked about, and that may hold a zero: a bit a lane, each in one of the first four
/// at most.
struct Verdicts<T> {
    /// The form proves a zero on each ray, and tells it from its neighbours closely enough.
    flat: u16,
    /// What is left is much shorter, and looked at once more.
    shorter: u16,
    /// The tile's parts are looked at.
    finer: u16,
    /// What is left is cut in two.
    cut: u16,
    /// Where all of what is left lies in the region.
    within: u16,
    /// The far ends of what is left.
    far: Lanes<T>,
}

pub(super) struct Tracer<'a, 'b, 'm, T: Scalar> {
    pub method: &'a Affine<'m, T>,
    pub rays: &'a RayGrid,
    pub frame: Frame,
    pub band: &'a mut Band<'b>,
    /// A bit per pixel of each 4×4 tile: whether it is not finished.
    pub open: Vec<u16>,
    /// The same: whether its ray is in the pool, or set apart.
    pub followed: Vec<u16>,
    /// Tiles of 4×4 in a row.
    pub across: usize,
    /// Screen coordinates of columns and rows of pixels, by fours; none of patches.
    pub screens: [Vec<[f64; 4]>; 2],
    /// The farthest end of a segment.
    pub size: f64,
    pub limits: Limits<T>,
    pub memory: &'a mut Memory<T>,
    pub work: &'a mut Work,
    /// Those that the processor has.
    pub vectors: Vectors,
}

impl<T: Scalar> Tracer<'_, '_, '_, T> {
    /// The first and last column and row of a tile's pixels in the band.
    pub(super) fn pixels(&self, [column, row]: [usize; 2], level: usize) -> [[usize; 2]; 2] {
        let side = SIDES[level];
        let range = |place: usize, size: usize| [side * place, (side * place + side).min(size) - 1];
        [range(column, self.band.width), range(row, self.band.height)]
    }

    /// The screen coordinate in the middle of a column of tiles, and how far its rays are from that.
    #[inline]
    pub(super) fn across(&self, column: usize, level: usize) -> [f64; 2] {
        let [columns, _] = self.pixels([column, 0], level);
        self.extent(0, columns[0], columns[1])
    }

    /// The same of a row of tiles.
    #[inline]
    pub(super) fn upward(&self, row: usize, level: usize) -> [f64; 2] {
        let top = self.band.top;
        if let Some(patch) = self.rays.patch(top + row) {
            return self.extent(1, patch.row, patch.row + 3);
        }
        let [_, rows] = self.pixels([0, row], level);
        self.extent(1, top + rows[0], top + rows[1])
    }

    /// The same of some columns of pixels, or rows, the last included.
    #[inline]
    pub(super) fn extent(&self, axis: usize, first: usize, last: usize) -> [f64; 2] {
        let centre = self.rays.screen(first + last, first + last)[axis];
        [centre, (last - first) as f64 * self.rays.unit()]
    }

    /// The first column and row of these tiles, if they are a square of sixteen of the last level with all of their pixels in
    /// the picture.
    #[inline]
    pub(super) fn square(
        &self,
        [columns, rows]: &[Range<usize>; 2],
        level: usize,
    ) -> Option<[usize; 2]> {
        let side = SIDES[level];
        let is_square = level == LAST
            && !self.rays.is_patched()
            && (columns.len(), rows.len()) == (4, 4)
            && side * columns.end <= self.band.width
            && side * rows.end <= self.band.height;
        is_square.then_some([columns.start, rows.start])
    }

    /// The screen coordinates in the middle of a square's columns, and of its rows.
    #[inline]
    pub(super) fn centres(&self, [column, row]: [usize; 2]) -> [[f64; 4]; 2] {
        let side = SIDES[LAST];
        let centres = |axis: usize, first: usize| {
            // The sum of a tile's first and last pixel.
            self.rays.screens(axis, 2 * first + side - 1, 2 * side)
        };
        [centres(0, side * column), centres(1, self.band.top + side * row)]
    }

    /// How far the rays of a square's tiles are from the middle of each.
    #[inline]
    pub(super) fn reach(&self) -> f64 {
        (SIDES[LAST] - 1) as f64 * self.rays.unit()
    }

    /// Which of a square's tiles have pixels that are not finished, as bits.
    #[inline]
    pub(super) fn open_in_square(&self, [column, row]: [usize; 2]) -> u16 {
        let mut all = 0;
        for k in 0..4 {
            let first = (row + k) * self.across + column;
            for (tile, open) in self.open[first..first + 4].iter().enumerate() {
                all |= u16::from(*open != 0) << (4 * k + tile);
            }
        }
        all
    }

    /// What is to be looked at of a segment.
    pub(super) fn from(&self, place: [usize; 2], [near, far]: [f64; 2]) -> [f64; 2] {
        match self.rays.patch(self.band.top + place[1]) {
            Some(patch) => {
                let [from, until] = patch.between.map(|t| T::nearest(t - self.frame.start).into());
                [near.max(from), far.min(until)]
            }
            None => [near, far],
        }
    }

    /// Whether some pixel of a tile is not finished.
    #[inline]
    pub(super) fn is_open(&self, place: [usize; 2], level: usize) -> bool {
        self.any_in(&self.open, place, level)
    }

    /// Whether any bit of a tile is set among bits of each 4×4 tile.
    #[inline]
    fn any_in(&self, bits: &[u16], [column, row]: [usize; 2], level: usize) -> bool {
        if level == LAST {
            return bits[row * self.across + column] != 0;
        }
        let side = SIDES[level] / SIDES[LAST];
        let range = |place: usize, size: usize| side * place..(side * place + side).min(size);
        let (columns, rows) = (range(column, self.across), range(row, bits.len() / self.across));
        rows.into_iter().any(|row| {
            let start = row * self.across;
            let some = &bits[start + columns.start..start + columns.end];
            some.iter().fold(0, |any, bits| any | bits) != 0
        })
    }

    /// The width of a pixel in units of s.
    #[inline]
    pub(super) fn footprint(&self, s: f64) -> f64 {
        self.rays.footprint(self.frame.start + s)
    }

    fn run(&mut self, levels: &mut [Level<T>], depth: usize) {
        let (level, finer) = levels.split_first_mut().expect("a level");
        while level.live != 0 {
            level.pack(self.vectors);
            self.method.tiles.ask(&level.batch, &mut level.out);
            self.work.tiles.called(level.live.count_ones());
            let possible = level.live & level.out.possible;
            let mut kept = 0;
            if possible != 0 {
                let verdicts =
                    dispatch!(self.vectors, simd => self.verdicts(simd, level, depth, possible));
                kept = verdicts.shorter | verdicts.cut;
                self.act(level, finer, depth, &verdicts);
            }
            let later = level.keep(kept);
            self.go_on(level, later, depth);
        }
    }

    /// Goes on with what was put aside of the tiles in these lanes, each once none of its rays is followed any more.
    fn go_on(&mut self, level: &mut Level<T>, mut lanes: u16, depth: usize) {
        while lanes != 0 {
            for lane in ones(lanes) {
                let place = level.place(lane);
                if !self.any_in(&self.followed, place, depth) {
                    level.go_on(lane, self.is_open(place, depth));
                    lanes &= !(1 << lane);
                }
            }
            let is_done = lanes == 0 || self.follow_more();
            assert!(is_done, "rays that are followed are in the pool or set apart");
        }
    }

    /// What is to be done with the tiles that may hold a zero. What is left of their segments, or the nearer part of what is
    /// cut, takes their place.
    #[inline(always)]
    fn verdicts<S: Simd>(
        &self,
        simd: S,
        level: &mut Level<T>,
        depth: usize,
        possible: u16,
    ) -> Verdicts<T> {
        let contracts = self.method.options.ideas.contract;
        let Level { batch, out, .. } = level;
        let [_, growth] = self.rays.pixel();
        let slender = if self.rays.is_patched() { SLENDER_PATCH } else { SLENDER[depth] };
        let [longest, width, growth, slender, grain] = [
            self.method.longest,
            self.footprint(0.0),
            growth,
            slender * SIDES[depth] as f64,
            T::GRAIN * self.size,
        ]
        .map(T::nearest);
        let [twice, stalled, share, tilted] = [2.0, STALLED, CUT, TILTED].map(T::nearest);
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
            let footprint = near * growth + width;
            empty |= part.bits(left.simd_lt(T::default()));
            narrowed |= part.bits(first.simd_le(near) & far.simd_le(last));
            // Not where both overflow.
            let enough = footprint * along.abs() * longest;
            fine |= part.bits((half * error * twice).simd_lt(enough));
            shorter |= part.bits(left.simd_le(before * stalled));
            let tilt = across.abs() + upward.abs();
            let is_tilted = error.simd_le(tilt * tilted);
            short |= part.bits(left.simd_le(footprint * slender) | is_tilted);
            let between = near + left * share;
            // An eye in the region has no pixel's width before it to stop at.
            let progress = are_progress([near, far], between, before);
            whole |= part.bits(left.simd_gt(grain) & progress);
            part.store(near, &mut batch.near);
            part.store(far, &mut batch.far);
            part.store(between, &mut cut);
        }
        let last = !whole;
        let (possible, crossing) = (possible & !empty, out.crossing);
        let is_flat = contracts && !self.method.cleared;
        let mut flat = if is_flat { possible & crossing & fine } else { 0 };
        let shorter = possible & shorter & !last;
        let finer = possible & (crossing | short | last) & !shorter;
        let mut within = u16::MAX;
        if !level.within {
            let region = self.method.region;
            within = 0;
            if region.clip().is_none() && flat | finer != 0 {
                let rays = level.screens.rays();
                if flat != 0 {
                    // Where all that was asked about lies in the region, so does any part of it.
                    let asked = asked.each_ref().map(|ends| T::wide(simd, ends));
                    let all = self.frame.inside(simd, rays, region, asked);
                    flat &= all;
                    within = all & narrowed;
                }
                if finer & !within != 0 {
                    let left =
                        [&level.batch.near, &level.batch.far].map(|ends| T::wide(simd, ends));
                    within |= self.frame.inside(simd, rays, region, left);
                }
            } else {
                flat = 0;
            }
        }
        let (shorter, finer) = (shorter & !flat, finer & !flat);
        let cuts = possible & !(flat | shorter | finer);
        let far = level.batch.far;
        for lane in ones(cuts) {
            level.batch.far[lane] = cut[lane];
        }
        Verdicts { flat, shorter, finer, cut: cuts, within, far }
    }

    /// Does with tiles what is to be done.
    fn act(
        &mut self,
        level: &mut Level<T>,
        finer: &mut [Level<T>],
        depth: usize,
        verdicts: &Verdicts<T>,
    ) {
        for lane in ones(verdicts.cut) {
            level.put_aside(lane, [level.batch.far[lane], verdicts.far[lane]]);
        }
        for lane in ones(verdicts.flat) {
            let plane = Plane::new(&level.batch, &level.out, lane);
            self.emit(&plane, depth, level.place(lane));
        }
        for lane in ones(verdicts.finer) {
            let segment = [level.batch.near[lane].into(), verdicts.far[lane].into()];
            let within = verdicts.within >> lane & 1 == 1;
            if finer.is_empty() {
                self.follow(level, lane, segment, within);
            } else {
                self.split(level, finer, depth, lane, segment, within);
            }
        }
    }

    /// Looks at the sixteen parts of a tile.
    fn split(
        &mut self,
        level: &Level<T>,
        finer: &mut [Level<T>],
        depth: usize,
        lane: usize,
        segment: [f64; 2],
        within: bool,
    ) {
        let [column, row] = level.place(lane).map(|place| 4 * place);
        let side = SIDES[depth + 1];
        let (columns, rows) = (self.band.width.div_ceil(side), self.band.height.div_ceil(side));
        let parts = [column..columns.min(column + 4), row..rows.min(row + 4)];
        let plane = self.method.options.ideas.contract;
        let plane = plane.then(|| Plane::new(&level.batch, &level.out, lane));
        finer[0].start(self, parts, depth + 1, segment, plane.as_ref(), within);
        self.run(finer, depth + 1);
    }
}
