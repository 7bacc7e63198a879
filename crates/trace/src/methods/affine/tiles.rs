//! Tiles of rays, from 16×16 pixels to 4×4, and from those to single rays.

use super::Affine;
use super::frame::{Frame, Tile};
use super::narrow::Scratch;
use super::rays::{Way, inside};
use crate::band::Band;
use crate::gbuffer::{Found, Status};
use crate::grid::RayGrid;
use crate::method::Start;
use crate::scalar::Scalar;
use crate::work::Work;
use zeroset_eval::{LANES, Planes, Tiles};

/// Pixels on the side of a tile, by level. Each holds sixteen of the next.
const SIDES: [usize; 2] = [16, 4];
/// A tile is split once its segment is no longer than so many times what it is wide.
const SLENDER: f64 = 2.0;
/// A segment that stays longer than this share of what it was is cut.
const STALLED: f64 = 0.6;
/// Where it is cut.
const CUT: f64 = 0.4609375;

/// Traces a band.
pub(super) fn trace<T: Scalar>(
    method: &Affine<'_, T>,
    rays: &RayGrid,
    band: &mut Band<'_>,
    work: &mut Work,
) {
    let frame = Frame::new(rays, method.region);
    let across = band.width.div_ceil(4);
    let mut open = vec![0_u16; across * 4];
    for (index, open) in open.iter_mut().enumerate() {
        let (left, top) = (4 * (index % across), 4 * (index / across));
        for bit in 0..16 {
            let is_inside = left + bit % 4 < band.width && top + bit / 4 < band.height;
            *open |= u16::from(is_inside) << bit;
        }
    }
    let levels = std::array::from_fn(|_| Level::new(frame.tiles()));
    let mut tracer =
        Tracer { method, rays, frame, band, open, across, scratch: Scratch::default(), work };
    let [mut coarse, mut fine] = levels;
    let places: Vec<[usize; 2]> =
        (0..tracer.band.width.div_ceil(SIDES[0])).map(|i| [i, 0]).collect();
    let span = tracer.frame.span;
    for places in places.chunks(LANES) {
        if !tracer.band.is_wanted() {
            return tracer.band.give_up(SIDES[0] * places[0][0]);
        }
        coarse.start(&tracer, places, 0, span);
        tracer.run(&mut coarse, Some(&mut fine), 0);
    }
}

/// Up to sixteen tiles of one size, and what is still to be looked at of each.
struct Level<T: Scalar> {
    places: [[usize; 2]; LANES],
    tiles: [Tile; LANES],
    stacks: [Vec<[f64; 2]>; LANES],
    batch: Tiles<T>,
    out: Planes<T>,
}

struct Tracer<'a, 'b, 'm, T: Scalar> {
    method: &'a Affine<'m, T>,
    rays: &'a RayGrid,
    frame: Frame,
    band: &'a mut Band<'b>,
    /// A bit per pixel of each 4×4 tile: whether it is not finished.
    open: Vec<u16>,
    /// Tiles of 4×4 in a row.
    across: usize,
    scratch: Scratch<T>,
    work: &'a mut Work,
}

impl<T: Scalar> Level<T> {
    fn new(batch: Tiles<T>) -> Self {
        Self {
            places: [[0; 2]; LANES],
            tiles: std::array::from_fn(|_| Tile { centre: [0.0; 2], half: [0.0; 2] }),
            stacks: Default::default(),
            batch,
            out: Planes::default(),
        }
    }

    /// Takes tiles of a level, by their columns and rows in units of tiles.
    fn start(
        &mut self,
        tracer: &Tracer<'_, '_, '_, T>,
        places: &[[usize; 2]],
        level: usize,
        segment: [f64; 2],
    ) {
        for stack in &mut self.stacks {
            stack.clear();
        }
        for (lane, &place) in places.iter().enumerate() {
            if !tracer.is_open(place, level) {
                continue;
            }
            let [columns, rows] = tracer.pixels(place, level);
            let top = tracer.band.top;
            let tile = Tile::new(tracer.rays, columns, rows.map(|row| top + row));
            if let Some([near, far]) = tracer.frame.clip(&tile, tracer.method.region, segment) {
                self.stacks[lane].push([-T::above(-near).into(), T::above(far).into()]);
            }
            self.places[lane] = place;
            self.tiles[lane] = tile;
        }
    }

    fn place(&mut self, slot: usize, lane: usize, reach: [f64; 2]) {
        let tile = &self.tiles[lane];
        for axis in 0..2 {
            self.batch.centre[axis][slot] = T::nearest(tile.centre[axis]);
            // The centre is rounded too.
            let half = tile.half[axis] + T::PATH_ERROR * reach[axis];
            self.batch.half[axis][slot] = T::above(half);
        }
    }
}

impl<T: Scalar> Tracer<'_, '_, '_, T> {
    /// The first and last column and row of a tile's pixels in the band.
    fn pixels(&self, [column, row]: [usize; 2], level: usize) -> [[usize; 2]; 2] {
        let side = SIDES[level];
        let range = |place: usize, size: usize| [side * place, (side * place + side).min(size) - 1];
        [range(column, self.band.width), range(row, self.band.height)]
    }

    /// Whether some pixel of a tile is not finished.
    fn is_open(&self, [column, row]: [usize; 2], level: usize) -> bool {
        if level == 1 {
            return self.open[row * self.across + column] != 0;
        }
        let columns = 4 * column..(4 * column + 4).min(self.across);
        (0..4).any(|row| columns.clone().any(|column| self.open[row * self.across + column] != 0))
    }

    /// The width of a pixel in units of s.
    fn footprint(&self, s: f64) -> f64 {
        let unit = 2.0 * self.rays.unit();
        if self.rays.is_parallel() { unit } else { unit * (self.frame.start + s) }
    }

    fn run(&mut self, level: &mut Level<T>, mut next: Option<&mut Level<T>>, depth: usize) {
        let mut slots: Vec<usize> =
            (0..LANES).filter(|&lane| !level.stacks[lane].is_empty()).collect();
        let mut moved = true;
        while !slots.is_empty() {
            if moved {
                for (slot, &lane) in slots.iter().enumerate() {
                    level.place(slot, lane, self.frame.reach);
                }
                level.batch.count = slots.len() as u32;
            }
            for (slot, &lane) in slots.iter().enumerate() {
                if let Some(&[near, far]) = level.stacks[lane].last() {
                    level.batch.near[slot] = T::nearest(near);
                    level.batch.far[slot] = T::nearest(far);
                }
            }
            self.method.tiles.ask(&level.batch, &mut level.out);
            self.work.tiles.calls += 1;
            let mut live = 0;
            for (slot, &lane) in slots.iter().enumerate() {
                let Some(segment) = level.stacks[lane].pop() else { continue };
                self.work.tiles.lanes += 1;
                if level.out.possible >> slot & 1 == 1 {
                    self.judge(level, next.as_deref_mut(), depth, [slot, lane], segment);
                }
                live += usize::from(!level.stacks[lane].is_empty());
            }
            moved = live.div_ceil(4) < slots.len().div_ceil(4);
            if moved {
                slots.retain(|&lane| !level.stacks[lane].is_empty());
            }
        }
    }

    /// What is to be done with a tile that may hold a zero.
    fn judge(
        &mut self,
        level: &mut Level<T>,
        next: Option<&mut Level<T>>,
        depth: usize,
        [slot, lane]: [usize; 2],
        [near, far]: [f64; 2],
    ) {
        let new: [f64; 2] = [level.out.near[slot].into(), level.out.far[slot].into()];
        let shorter = new[1] - new[0];
        if shorter < 0.0 {
            return;
        }
        let tile = &level.tiles[lane];
        let place = level.places[lane];
        let footprint = self.footprint(new[0]);
        let crossing = level.out.crossing >> slot & 1 == 1;
        if crossing
            && !self.method.cleared
            && self.method.region.clip().is_none()
            && let error = level.out.error[slot].into()
            && let slope = level.out.slope[2][slot].into()
            && let half = level.out.half[slot].into()
            && 2.0 * half * error <= self.method.tolerance * footprint * f64::abs(slope)
            && self.frame.is_inside(tile, self.method.region, [near, far])
        {
            self.emit(level, depth, slot, place);
            level.stacks[lane].clear();
            return;
        }
        let width = SIDES[depth] as f64 * footprint;
        let cut: f64 = T::nearest(new[0] + CUT * shorter).into();
        // Too short for these floats, or not finite: such a segment would come back for ever.
        let is_last = !(new[0] < cut && cut < new[1]);
        let is_slender = crossing || shorter <= SLENDER * width;
        if !is_last && shorter <= STALLED * (far - near) && (crossing || !is_slender) {
            level.stacks[lane].push(new);
        } else if is_slender || is_last {
            if let Some(fine) = next {
                let [column, row] = place;
                let children: [[usize; 2]; LANES] =
                    std::array::from_fn(|i| [4 * column + i % 4, 4 * row + i / 4]);
                let rows = self.band.height.div_ceil(SIDES[1]);
                let children = children.map(|[column, row]| {
                    // What sticks out of the picture is finished: any such place will do.
                    [column.min(self.across - 1), row.min(rows - 1)]
                });
                let mut given = [[0; 2]; LANES];
                let mut count = 0;
                for child in children {
                    if !given[..count].contains(&child) {
                        given[count] = child;
                        count += 1;
                    }
                }
                fine.start(self, &given[..count], depth + 1, new);
                self.run(fine, None, depth + 1);
            } else {
                self.follow(level, lane, new);
            }
            if !self.is_open(place, depth) {
                level.stacks[lane].clear();
            }
        } else {
            level.stacks[lane].push([cut, new[1]]);
            level.stacks[lane].push([new[0], cut]);
        }
    }

    /// Writes the hits that a tile's form proves.
    fn emit(&mut self, level: &Level<T>, depth: usize, slot: usize, place: [usize; 2]) {
        let [columns, rows] = self.pixels(place, depth);
        let (out, batch) = (&level.out, &level.batch);
        let [value, error, middle, half]: [f64; 4] =
            [out.value[slot], out.error[slot], out.middle[slot], out.half[slot]].map(Into::into);
        let slope: [f64; 3] = out.slope.map(|lanes| lanes[slot].into());
        let centre: [f64; 2] = batch.centre.map(|lanes| lanes[slot].into());
        let reach: [f64; 2] = batch.half.map(|lanes| lanes[slot].into());
        let per_value = -half / slope[2];
        // What these few operations round is far below what single precision leaves of the rest.
        let off = (per_value * error).abs() * (1.0 + 1e-9) + 1e-13 * (middle.abs() + half);
        for row in rows[0]..=rows[1] {
            let [_, b] = self.rays.screen(0, 2 * (self.band.top + row));
            let up = value + slope[2 - 1] * (b - centre[1]) / reach[1];
            for column in columns[0]..=columns[1] {
                let bit = 1 << (column % 4 + 4 * (row % 4));
                let open = &mut self.open[(row / 4) * self.across + column / 4];
                if *open & bit == 0 {
                    continue;
                }
                *open &= !bit;
                let [a, _] = self.rays.screen(2 * column, 0);
                let across = slope[0] * (a - centre[0]) / reach[0];
                let t = self.frame.start + middle + per_value * (up + across);
                let length =
                    if self.rays.is_parallel() { 1.0 } else { (1.0 + a * a + b * b).sqrt() };
                let found = Found {
                    status: Status::Hit,
                    distance: t,
                    drawn: t,
                    bracket: [t - off, t + off],
                    ..Found::MISS
                };
                self.band.add(column, row, &found.scaled(length));
            }
        }
    }

    /// Follows the rays of a tile of 4×4 that are not finished.
    fn follow(&mut self, level: &Level<T>, lane: usize, segment: [f64; 2]) {
        let place = level.places[lane];
        let [columns, rows] = self.pixels(place, 1);
        let region = self.method.region;
        let is_inside =
            region.clip().is_none() && self.frame.is_inside(&level.tiles[lane], region, segment);
        let index = place[1] * self.across + place[0];
        let tolerance = self.method.tolerance * self.footprint(segment[0]);
        let mut ways = Vec::with_capacity(LANES);
        let mut pixels = [[0; 2]; LANES];
        for row in rows[0]..=rows[1] {
            for column in columns[0]..=columns[1] {
                if self.open[index] >> (column % 4 + 4 * (row % 4)) & 1 == 0 {
                    continue;
                }
                let screen = self.rays.screen(2 * column, 2 * (self.band.top + row));
                let [origin, direction] = self.frame.ray(screen);
                let mut span = segment;
                let mut within = [f64::NEG_INFINITY, f64::INFINITY];
                if !is_inside {
                    let ray = self.rays.ray(column, self.band.top + row);
                    let start = self.frame.start;
                    let Some((near, far)) = region.span(&ray) else { continue };
                    let slack = 1e-15 * (near.abs() + start.abs());
                    span = [span[0].max(near - start - slack), span[1].min(far - start + slack)];
                    if span[0] > span[1] {
                        continue;
                    }
                    within = inside(region, &ray, start, span);
                }
                let error = self.frame.error;
                pixels[ways.len()] = [column, row];
                ways.push(Way { origin, direction, error, span, inside: within, tolerance });
            }
        }
        if ways.is_empty() {
            return;
        }
        let outcomes =
            self.method.follower.follow(&ways, Start::Anywhere, &mut self.scratch, self.work);
        for (outcome, [column, row]) in outcomes[..ways.len()].iter().zip(pixels) {
            let found = outcome.found(self.frame.start);
            if found.is_miss() {
                continue;
            }
            let [a, b] = self.rays.screen(2 * column, 2 * (self.band.top + row));
            let length = if self.rays.is_parallel() { 1.0 } else { (1.0 + a * a + b * b).sqrt() };
            let found = found.scaled(length);
            let is_over = found.drawn.is_finite();
            self.band.add(column, row, &found);
            if is_over {
                self.open[index] &= !(1 << (column % 4 + 4 * (row % 4)));
            }
        }
    }
}
