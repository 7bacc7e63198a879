//! The pixels of a tile: hits that the tile's form proves, and rays that have to be followed.

use super::super::way::{self, Way};
use super::frame::Tile;
use super::narrow::{STALLED, STEADY, UNSTEADY};
use super::plane::Plane;
use super::tiles::{Level, Tracer};
use crate::method::Start;
use crate::scalar::{Four, Scalar};
use zeroset_eval::{Contractions, LANES, Lanes, Segments};

/// How often the segments of a tile's rays are narrowed together, before those that are left are followed one by one.
const ROUNDS: u32 = 4;

/// A tile of 4×4 pixels. Its lanes and bits are pixels, row by row.
struct Patch {
    /// Where its bits are among those of all tiles.
    index: usize,
    /// The first column and row.
    first: [usize; 2],
    /// How far the next row is: in columns and rows.
    next: [usize; 2],
    /// Screen coordinates of its columns.
    across: [f64; 4],
    /// Screen coordinates of its rows.
    upward: [f64; 4],
}

impl Patch {
    fn screen(&self, bit: usize) -> [f64; 2] {
        [self.across[bit % 4], self.upward[bit / 4]]
    }

    fn column(&self, bit: usize) -> usize {
        self.first[0] + bit % 4 + bit / 4 * self.next[0]
    }

    fn row(&self, bit: usize) -> usize {
        self.first[1] + bit / 4 * self.next[1]
    }
}

/// The places of the bits that are set.
fn ones(mut bits: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        bit
    })
}

/// What became of segments: a bit for each lane in use.
struct Sifted {
    /// There may be a zero.
    left: u16,
    /// There is one, and the segment is short enough, and got so at once, or else far shorter.
    short: u16,
    /// There may be one, and the segment got much shorter.
    shorter: u16,
}

/// Tells segments apart by what was asked of them, given how short they are to be, and how short they may be.
#[inline]
fn sift<T: Scalar>(
    batch: &Segments<T>,
    out: &Contractions<T>,
    [tolerance, grain]: [f64; 2],
) -> Sifted {
    let [tolerance, grain, stalled, steady, least] =
        [tolerance, grain, STALLED, STEADY, UNSTEADY * tolerance]
            .map(|number| T::Four::splat(T::nearest(number)));
    let (mut empty, mut short, mut shorter) = (0_u16, 0_u16, 0_u16);
    let bits = |mask, at| (T::Four::bits(mask) as u16) << at;
    for at in (0..batch.count as usize).step_by(4) {
        let four = |lanes: &Lanes<T>| T::Four::from_array(std::array::from_fn(|k| lanes[at + k]));
        let (near, far) = (four(&out.near), four(&out.far));
        let (length, before) = (far - near, four(&batch.far) - four(&batch.near));
        let much = grain.less(length) & length.at_most(before * stalled);
        empty |= bits(length.less(T::Four::splat(T::default())), at);
        let steady = length.at_most(tolerance) & length.at_most(before * steady);
        short |= bits(steady, at) | bits(length.at_most(least), at);
        shorter |= bits(much, at);
    }
    let used = u16::MAX >> (LANES as u32 - batch.count);
    let left = out.possible & used & !empty;
    Sifted { left, short: left & short & out.crossing, shorter: left & shorter }
}

impl<T: Scalar> Tracer<'_, '_, '_, T> {
    fn patch(&self, [column, row]: [usize; 2]) -> Patch {
        let (mut first, mut next) = ([4 * column, 4 * row], [0, 1]);
        let mut corner = [first[0], self.band.top + first[1]];
        if let Some(patch) = self.rays.patch(self.band.top + row) {
            // It lies in one row of the band.
            (corner, first, next) = ([patch.column, patch.row], [0, row], [4, 0]);
        }
        let screen = |k: usize| self.rays.screen(2 * (corner[0] + k), 2 * (corner[1] + k));
        let screens: [[f64; 2]; 4] = std::array::from_fn(screen);
        Patch {
            index: row * self.across + column,
            first,
            next,
            across: screens.map(|screen| screen[0]),
            upward: screens.map(|screen| screen[1]),
        }
    }

    /// Writes the hits that a tile's form proves on the rays of its pixels.
    pub(super) fn emit(&mut self, plane: &Plane, depth: usize, place: [usize; 2]) {
        if self.rays.is_patched() {
            return self.emit_patch(plane, &self.patch(place));
        }
        let [columns, rows] = self.pixels(place, depth);
        for row in rows[0] / 4..=rows[1] / 4 {
            for column in columns[0] / 4..=columns[1] / 4 {
                self.emit_patch(plane, &self.patch([column, row]));
            }
        }
    }

    fn emit_patch(&mut self, plane: &Plane, patch: &Patch) {
        let start = self.frame.start;
        let along = patch.across.map(|a| start + plane.at([a, patch.upward[0]]));
        let open = std::mem::take(&mut self.open[patch.index]);
        for (row, &b) in patch.upward.iter().enumerate() {
            let four = open >> (4 * row) & 0xf;
            if four == 0 {
                continue;
            }
            let more = plane.rise(b - patch.upward[0]);
            let length = patch.across.map(|a| self.length([a, b]));
            let distance: [f64; 4] = std::array::from_fn(|k| (along[k] + more) * length[k]);
            let off = length.map(|length| plane.reach() * length);
            if four == 0xf {
                let (column, row) = (patch.column(4 * row), patch.row(4 * row));
                self.band.add_four_hits(column, row, &distance, &off);
            } else {
                let (column, row) = (patch.column(4 * row), patch.row(4 * row));
                for k in ones(four) {
                    self.band.add_hit(column + k, row, distance[k], off[k]);
                }
            }
        }
    }

    /// Follows the rays of a tile of 4×4 that are not finished, all of the segment being in the region: first all at once,
    /// each along what the tile's form leaves of it.
    pub(super) fn follow_within(
        &mut self,
        level: &Level<T>,
        [slot, lane]: [usize; 2],
        segment: [f64; 2],
    ) {
        let patch = self.patch(level.places[lane]);
        let plane = Plane::new(&level.batch, &level.out, slot);
        let mut bits = [0_u8; LANES];
        let mut count = self.place(level, &patch, &plane, segment, &mut bits);
        let tolerance = self.method.tolerance * self.footprint(segment[0]);
        let grain = T::GRAIN * self.size;
        let (mut ways, mut rest) = ([Way::NONE; LANES], [0; LANES]);
        let mut hard = 0;
        for round in 1..=ROUNDS {
            if count == 0 {
                break;
            }
            self.segments.count = count as u32;
            self.method.follower.ask(&self.segments, &mut self.contractions);
            self.work.segments.called(count as u32);
            let sifted = sift(&self.segments, &self.contractions, [tolerance, grain]);
            let hits = if self.method.cleared { 0 } else { sifted.short };
            let again = if round < ROUNDS { sifted.shorter & !hits } else { 0 };
            for slot in ones(hits) {
                self.hit(&patch, usize::from(bits[slot]), slot);
            }
            for slot in ones(sifted.left & !hits & !again) {
                let bit = usize::from(bits[slot]);
                let [origin, direction] = self.frame.ray(patch.screen(bit));
                ways[hard] = Way {
                    origin,
                    direction,
                    error: self.frame.error,
                    start: -self.frame.start,
                    span: [self.contractions.near[slot].into(), self.contractions.far[slot].into()],
                    inside: [f64::NEG_INFINITY, f64::INFINITY],
                    tolerance,
                };
                rest[hard] = bit;
                hard += 1;
            }
            count = 0;
            for slot in ones(again) {
                let batch = &mut self.segments;
                bits[count] = bits[slot];
                for lanes in batch.origin.iter_mut().chain(&mut batch.direction) {
                    lanes[count] = lanes[slot];
                }
                batch.near[count] = self.contractions.near[slot];
                batch.far[count] = self.contractions.far[slot];
                count += 1;
            }
        }
        if hard > 0 {
            self.follow_ways(&patch, &ways[..hard], &rest);
        }
    }

    /// Puts the rays of a tile of 4×4 that are not finished into the batch, each with what a form of the tile leaves of a
    /// segment; returns how many there are, and writes which.
    fn place(
        &mut self,
        level: &Level<T>,
        patch: &Patch,
        plane: &Plane,
        segment: [f64; 2],
        bits: &mut [u8; LANES],
    ) -> usize {
        let (near, far, meets) = plane.narrow::<T>(&patch.across, &patch.upward, segment);
        let batch = &mut self.segments;
        let four = |screen: [f64; 4]| T::Four::from_array(screen.map(T::nearest));
        let (across, upward) = (four(patch.across), patch.upward.map(T::nearest));
        for axis in 0..3 {
            for (parts, lanes) in [
                (&level.batch.origin, &mut batch.origin[axis]),
                (&level.batch.direction, &mut batch.direction[axis]),
            ] {
                let [base, a, b] = [0, 3, 6].map(|part| parts[part + axis][0]);
                let row = T::Four::splat(base) + across * T::Four::splat(a);
                for (lanes, &up) in lanes.as_chunks_mut().0.iter_mut().zip(&upward) {
                    *lanes = (row + T::Four::splat(up * b)).to_array();
                }
            }
        }
        let wanted = self.open[patch.index] & meets;
        if wanted == u16::MAX {
            (batch.near, batch.far) = (near, far);
            *bits = std::array::from_fn(|lane| lane as u8);
            return LANES;
        }
        let mut count = 0;
        for lane in ones(wanted) {
            bits[count] = lane as u8;
            for lanes in batch.origin.iter_mut().chain(&mut batch.direction) {
                lanes[count] = lanes[lane];
            }
            (batch.near[count], batch.far[count]) = (near[lane], far[lane]);
            count += 1;
        }
        count
    }

    /// Writes the hit on a pixel's ray that is proven in a lane of the batch.
    #[inline]
    fn hit(&mut self, patch: &Patch, bit: usize, slot: usize) {
        self.open[patch.index] &= !(1 << bit);
        let (from, to): (f64, f64) =
            (self.contractions.near[slot].into(), self.contractions.far[slot].into());
        let length = self.length(patch.screen(bit));
        let middle = self.frame.start + 0.5 * (from + to);
        // What these sums round is far below what kernels leave of a bracket.
        let off = (0.5 * (to - from) + 1e-13 * middle.abs()) * length;
        self.band.add_hit(patch.column(bit), patch.row(bit), middle * length, off);
    }

    /// The length of a ray's direction.
    #[inline]
    fn length(&self, [a, b]: [f64; 2]) -> f64 {
        if self.rays.is_parallel() { 1.0 } else { (1.0 + a * a + b * b).sqrt() }
    }

    /// Follows the rays of a tile of 4×4 that are not finished, each as far as it is in the region.
    pub(super) fn follow(&mut self, level: &Level<T>, lane: usize, segment: [f64; 2]) {
        let patch = self.patch(level.places[lane]);
        let region = self.method.region;
        let tolerance = self.method.tolerance * self.footprint(segment[0]);
        let (mut ways, mut bits) = ([Way::NONE; LANES], [0; LANES]);
        let mut count = 0;
        for bit in ones(self.open[patch.index]) {
            let screen = patch.screen(bit);
            let [origin, direction] = self.frame.ray(screen);
            let ray = Tile { centre: screen, half: [0.0; 2] };
            let Some(mut span) = self.frame.clip(&ray, region, segment) else { continue };
            let mut inside = way::between_faces([origin, direction, self.frame.error], region);
            if region.is_cut() {
                let ray = self.rays.ray(patch.column(bit), self.band.top + patch.row(bit));
                let start = self.frame.start;
                let Some((near, far)) = region.span(&ray) else { continue };
                let slack = 1e-15 * (near.abs() + start.abs());
                span = [span[0].max(near - start - slack), span[1].min(far - start + slack)];
                inside = way::inside(region, &ray, start);
            }
            if span[0] > span[1] {
                continue;
            }
            let (error, start) = (self.frame.error, -self.frame.start);
            ways[count] = Way { origin, direction, error, start, span, inside, tolerance };
            bits[count] = bit;
            count += 1;
        }
        if count > 0 {
            self.follow_ways(&patch, &ways[..count], &bits);
        }
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
