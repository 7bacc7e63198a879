//! Tiles of rays, from 16×16 pixels to 4×4, and from those to single rays.

use super::Affine;
use super::frame::{Frame, Tile};
use super::narrow::{Scratch, is_progress};
use super::plane::Plane;
use super::slots::{Slots, Stack};
use crate::band::Band;
use crate::grid::{Patch, RayGrid};
use crate::methods::way::CUT;
use crate::scalar::Scalar;
use crate::work::Work;
use zeroset_eval::{Contractions, LANES, Planes, Segments, Tiles};

/// Pixels on the side of a tile, by level. Each holds sixteen of the next.
const SIDES: [usize; 2] = [16, 4];
/// The level of tiles whose parts are rays.
const LAST: usize = SIDES.len() - 1;
/// A tile is split once its segment is no longer than so many times what it is wide.
const SLENDER: f64 = 3.0;
/// The same of tiles that are patches: along an outline surfaces are deep and a patch is thin, and its rays are all there.
const SLENDER_PATCH: f64 = 12.0;
/// A segment that stays longer than this share of what it was is cut.
const STALLED: f64 = 0.75;

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
    let levels = std::array::from_fn(|_| Level::new(frame.tiles()));
    let size = frame.size();
    let mut tracer = Tracer {
        method,
        rays,
        band,
        open,
        across,
        size,
        segments: frame.segments(),
        contractions: Contractions::default(),
        frame,
        scratch: Scratch::default(),
        work,
    };
    let mut levels: [Level<T>; SIDES.len()] = levels;
    let first = if is_patched { LAST } else { 0 };
    let places: Vec<[usize; 2]> = if is_patched {
        (0..tracer.band.height).map(|row| [0, row]).collect()
    } else {
        (0..tracer.band.width.div_ceil(SIDES[0])).map(|column| [column, 0]).collect()
    };
    // Rounded outward once; all later ends are floats.
    let [near, far] = tracer.frame.span;
    let span = [-T::above(-near).into(), T::above(far).into()];
    for places in places.chunks(LANES) {
        if !tracer.band.is_wanted() {
            return tracer.band.give_up(SIDES[0] * places[0][0]);
        }
        levels[first].start(&tracer, places, first, span, None, false);
        tracer.run(&mut levels[first..], first);
    }
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

/// Up to sixteen tiles of one size, and what is still to be looked at of each.
pub(super) struct Level<T: Scalar> {
    /// Whether all of the tiles' segments are in the region.
    within: bool,
    pub places: [[usize; 2]; LANES],
    tiles: [Tile; LANES],
    stacks: [Stack; LANES],
    pub batch: Tiles<T>,
    pub out: Planes<T>,
}

pub(super) struct Tracer<'a, 'b, 'm, T: Scalar> {
    pub method: &'a Affine<'m, T>,
    pub rays: &'a RayGrid,
    pub frame: Frame,
    pub band: &'a mut Band<'b>,
    /// A bit per pixel of each 4×4 tile: whether it is not finished.
    pub open: Vec<u16>,
    /// Tiles of 4×4 in a row.
    pub across: usize,
    /// The farthest end of a segment.
    pub size: f64,
    pub segments: Segments<T>,
    pub contractions: Contractions<T>,
    pub scratch: Scratch<T>,
    pub work: &'a mut Work,
}

impl<T: Scalar> Level<T> {
    fn new(batch: Tiles<T>) -> Self {
        Self {
            within: false,
            places: [[0; 2]; LANES],
            tiles: std::array::from_fn(|_| Tile { centre: [0.0; 2], half: [0.0; 2] }),
            stacks: Default::default(),
            batch,
            out: Planes::default(),
        }
    }

    /// Takes tiles of a level, by their columns and rows in units of tiles, each with what the form of the tile that they
    /// are parts of leaves of a segment. If they are `within` the region, they need not be clipped to it.
    fn start(
        &mut self,
        tracer: &Tracer<'_, '_, '_, T>,
        places: &[[usize; 2]],
        level: usize,
        segment: [f64; 2],
        plane: Option<&Plane>,
        within: bool,
    ) {
        self.within = within;
        for (lane, &place) in places.iter().enumerate() {
            let stack = &mut self.stacks[lane];
            stack.clear();
            if !tracer.is_open(place, level) {
                continue;
            }
            let tile = tracer.tile(place, level);
            let segment = tracer.from(place, segment);
            let mut left = (segment[0] <= segment[1]).then_some(segment);
            if let Some(plane) = plane {
                left = plane.narrow_tile(&tile, segment);
            }
            if !within {
                let clip = |segment| tracer.frame.clip(&tile, tracer.method.region, segment);
                left = left.and_then(clip);
            }
            if let Some([near, far]) = left {
                // Ends that are floats already stay as they are.
                let slack = |end: f64, clipped: f64| {
                    if end == clipped { 0.0 } else { T::PATH_ERROR * (clipped.abs() + tracer.size) }
                };
                let near = T::nearest(near - slack(segment[0], near));
                let far = T::nearest(far + slack(segment[1], far));
                stack.push([near.into(), far.into()]);
            }
            self.places[lane] = place;
            self.tiles[lane] = tile;
        }
        for stack in &mut self.stacks[places.len()..] {
            stack.clear();
        }
    }

    fn place(&mut self, slot: usize, lane: usize, reach: [f64; 2]) {
        let tile = &self.tiles[lane];
        for (axis, reach) in reach.into_iter().enumerate() {
            self.batch.centre[axis][slot] = T::nearest(tile.centre[axis]);
            // The centre is rounded too, and so is this.
            let half = tile.half[axis] + T::PATH_ERROR * reach;
            self.batch.half[axis][slot] = T::nearest(half);
        }
    }
}

impl<T: Scalar> Tracer<'_, '_, '_, T> {
    /// The first and last column and row of a tile's pixels in the band.
    pub(super) fn pixels(&self, [column, row]: [usize; 2], level: usize) -> [[usize; 2]; 2] {
        let side = SIDES[level];
        let range = |place: usize, size: usize| [side * place, (side * place + side).min(size) - 1];
        [range(column, self.band.width), range(row, self.band.height)]
    }

    /// The rays of a tile.
    fn tile(&self, place: [usize; 2], level: usize) -> Tile {
        let top = self.band.top;
        if let Some(Patch { column, row, .. }) = self.rays.patch(top + place[1]) {
            return Tile::new(self.rays, [column, column + 3], [row, row + 3]);
        }
        let [columns, rows] = self.pixels(place, level);
        Tile::new(self.rays, columns, rows.map(|row| top + row))
    }

    /// What is to be looked at of a segment.
    fn from(&self, place: [usize; 2], [near, far]: [f64; 2]) -> [f64; 2] {
        match self.rays.patch(self.band.top + place[1]) {
            Some(patch) => {
                let [from, until] = patch.between.map(|t| T::nearest(t - self.frame.start).into());
                [near.max(from), far.min(until)]
            }
            None => [near, far],
        }
    }

    /// Whether some pixel of a tile is not finished.
    fn is_open(&self, [column, row]: [usize; 2], level: usize) -> bool {
        let side = SIDES[level] / SIDES[LAST];
        let range = |place: usize, size: usize| side * place..(side * place + side).min(size);
        let (columns, rows) =
            (range(column, self.across), range(row, self.open.len() / self.across));
        rows.into_iter().any(|row| {
            let start = row * self.across;
            self.open[start + columns.start..start + columns.end].iter().any(|&open| open != 0)
        })
    }

    /// The width of a pixel in units of s.
    pub(super) fn footprint(&self, s: f64) -> f64 {
        self.rays.footprint(self.frame.start + s)
    }

    fn run(&mut self, levels: &mut [Level<T>], depth: usize) {
        let (level, finer) = levels.split_first_mut().expect("a level");
        let mut slots = Slots::new(&level.stacks);
        let mut moved = true;
        while !slots.is_empty() {
            if moved {
                for (slot, lane) in slots.all() {
                    level.place(slot, lane, self.frame.reach);
                }
                level.batch.count = slots.len() as u32;
            }
            for (slot, lane) in slots.all() {
                if let Some(&[near, far]) = level.stacks[lane].last() {
                    level.batch.near[slot] = T::nearest(near);
                    level.batch.far[slot] = T::nearest(far);
                }
            }
            self.method.tiles.ask(&level.batch, &mut level.out);
            self.work.tiles.calls += 1;
            for (slot, lane) in slots.all() {
                let Some(segment) = level.stacks[lane].pop() else { continue };
                self.work.tiles.lanes += 1;
                if level.out.possible >> slot & 1 == 1 {
                    self.judge(level, finer, depth, [slot, lane], segment);
                }
            }
            moved = slots.pack(&level.stacks);
        }
    }

    /// What is to be done with a tile that may hold a zero.
    fn judge(
        &mut self,
        level: &mut Level<T>,
        finer: &mut [Level<T>],
        depth: usize,
        [slot, lane]: [usize; 2],
        [near, far]: [f64; 2],
    ) {
        let contracts = self.method.options.ideas.contract;
        let new: [f64; 2] = if contracts {
            [level.out.near[slot].into(), level.out.far[slot].into()]
        } else {
            [near, far]
        };
        let shorter = new[1] - new[0];
        if shorter < 0.0 {
            return;
        }
        let footprint = self.footprint(new[0]);
        let crossing = level.out.crossing >> slot & 1 == 1;
        if crossing && contracts && !self.method.cleared {
            let error: f64 = level.out.error[slot].into();
            let slope: f64 = level.out.slope[2][slot].into();
            let half: f64 = level.out.half[slot].into();
            let enough = self.method.tolerance * footprint * slope.abs();
            if 2.0 * half * error <= enough && self.is_within(level, lane, [near, far]) {
                let plane = Plane::new(&level.batch, &level.out, slot);
                self.emit(&plane, depth, level.places[lane]);
                level.stacks[lane].clear();
                return;
            }
        }
        let cut: f64 = T::nearest(new[0] + CUT * shorter).into();
        // Too short for these floats, or not finite: such a segment would come back for ever.
        // An eye in the region has no pixel's width before it to stop at.
        let is_last = !is_progress(new, cut, far - near) || shorter <= T::GRAIN * self.size;
        let slender = if self.rays.is_patched() { SLENDER_PATCH } else { SLENDER };
        let slender = shorter <= slender * SIDES[depth] as f64 * footprint;
        if !is_last && shorter <= STALLED * (far - near) {
            level.stacks[lane].push(new);
        } else if crossing || slender || is_last {
            let within = self.is_within(level, lane, new);
            if !finer.is_empty() {
                self.split(level, finer, depth, [slot, lane], new, within);
            } else if within && contracts {
                self.follow_within(level, [slot, lane], new);
            } else {
                self.follow(level, lane, new);
            }
            if !self.is_open(level.places[lane], depth) {
                level.stacks[lane].clear();
            }
        } else {
            level.stacks[lane].push([cut, new[1]]);
            level.stacks[lane].push([new[0], cut]);
        }
    }

    fn is_within(&self, level: &Level<T>, lane: usize, segment: [f64; 2]) -> bool {
        let region = self.method.region;
        level.within
            || region.clip().is_none() && self.frame.is_inside(&level.tiles[lane], region, segment)
    }

    /// Looks at the sixteen parts of a tile.
    fn split(
        &mut self,
        level: &Level<T>,
        finer: &mut [Level<T>],
        depth: usize,
        [slot, lane]: [usize; 2],
        segment: [f64; 2],
        within: bool,
    ) {
        let [column, row] = level.places[lane].map(|place| 4 * place);
        let side = SIDES[depth + 1];
        let (columns, rows) = (self.band.width.div_ceil(side), self.band.height.div_ceil(side));
        let mut parts = [[0; 2]; LANES];
        let mut count = 0;
        for row in row..(row + 4).min(rows) {
            for column in column..(column + 4).min(columns) {
                parts[count] = [column, row];
                count += 1;
            }
        }
        let plane = self.method.options.ideas.contract;
        let plane = plane.then(|| Plane::new(&level.batch, &level.out, slot));
        finer[0].start(self, &parts[..count], depth + 1, segment, plane.as_ref(), within);
        self.run(finer, depth + 1);
    }
}
