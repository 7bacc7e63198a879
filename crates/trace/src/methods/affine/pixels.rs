//! The pixels of a tile: hits that the tile's form proves, and rays that have to be followed.

use super::super::way::{self, Way};
use super::frame::Frame;
use super::level::Level;
use super::narrow::{STALLED, STEADY, UNSTEADY};
use super::plane::Plane;
use super::screens::{Ends, HALF, ones, outward};
use super::tiles::Tracer;
use crate::method::Start;
use crate::scalar::{Four, Scalar};
use fearless_simd::{Level as Vectors, dispatch, f64x8, mask64x8, prelude::*};
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
    /// Screen coordinates of its rays.
    screens: [Lanes<f64>; 2],
}

impl Patch {
    fn screen(&self, bit: usize) -> [f64; 2] {
        [self.screens[0][bit], self.screens[1][bit]]
    }

    fn column(&self, bit: usize) -> usize {
        self.first[0] + bit % 4 + bit / 4 * self.next[0]
    }

    fn row(&self, bit: usize) -> usize {
        self.first[1] + bit / 4 * self.next[1]
    }
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

/// Tells segments in these lanes apart by what was asked of them, given how short they are to be, and how short they may be.
#[inline]
fn sift<T: Scalar>(
    batch: &Segments<T>,
    out: &Contractions<T>,
    live: u16,
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
    let left = out.possible & live & !empty;
    Sifted { left, short: left & short & out.crossing, shorter: left & shorter }
}

/// What is left of segments on the rays of a tile.
struct Left {
    /// Between which values of s, by the rays' bits.
    ends: Ends,
    /// The bits of the rays in the batch's lanes, once they have moved.
    rays: Option<[u8; LANES]>,
}

impl Left {
    fn new() -> Self {
        Self { ends: [Lanes::splat(0.0); 2], rays: None }
    }

    /// Takes what is left in these lanes; returns the bits of their rays.
    #[inline]
    fn take<T: Scalar>(&mut self, vectors: Vectors, lanes: u16, out: &Contractions<T>) -> u16 {
        let [from, to] = &mut self.ends;
        let Some(rays) = &self.rays else {
            if lanes != 0 {
                dispatch!(vectors, simd => {
                    blend(simd, lanes, &out.near, from);
                    blend(simd, lanes, &out.far, to);
                });
            }
            return lanes;
        };
        let mut bits = 0;
        for lane in ones(lanes) {
            let bit = usize::from(rays[lane]) % LANES;
            bits |= 1 << bit;
            (from[bit], to[bit]) = (out.near[lane].into(), out.far[lane].into());
        }
        bits
    }
}

/// Writes some lanes over others.
#[inline(always)]
fn blend<S: Simd, T: Scalar>(simd: S, lanes: u16, new: &Lanes<T>, all: &mut Lanes<f64>) {
    let (mut both, new) = (f64::wide(simd, all), T::wide(simd, new));
    for (k, (old, new)) in both.iter_mut().zip(new).enumerate() {
        let half = mask64x8::from_bitmask(simd, u64::from(lanes >> (HALF * k) & 0xff));
        *old = half.select(new, *old);
    }
    f64::narrow(both, all);
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
        let places = [screen(0), screen(1), screen(2), screen(3)];
        let across = places.map(|place| place[0]);
        let mut screens = [Lanes::splat(0.0); 2];
        for (row, place) in places.iter().enumerate() {
            screens[0].as_chunks_mut().0[row] = across;
            screens[1].as_chunks_mut().0[row] = [place[1]; 4];
        }
        Patch { index: row * self.across + column, first, next, screens }
    }

    /// Writes the hits that a tile's form proves on the rays of its pixels.
    pub(super) fn emit(&mut self, plane: &Plane, depth: usize, place: [usize; 2]) {
        let ([columns, rows], is_patched) = (self.pixels(place, depth), self.rays.is_patched());
        let (columns, rows) = if is_patched {
            (place[0]..=place[0], place[1]..=place[1])
        } else {
            (columns[0] / 4..=columns[1] / 4, rows[0] / 4..=rows[1] / 4)
        };
        for row in rows {
            for column in columns.clone() {
                let patch = self.patch([column, row]);
                let bits = std::mem::take(&mut self.open[patch.index]);
                if bits == 0 {
                    continue;
                }
                let found = dispatch!(self.vectors, simd => self.on_plane(simd, plane, &patch));
                self.write(&patch, bits, &found);
            }
        }
    }

    /// The distances at which rays meet a plane, and how far from that a zero may be.
    #[inline(always)]
    fn on_plane<S: Simd>(&self, simd: S, plane: &Plane, patch: &Patch) -> [Lanes<f64>; 2] {
        let mut found = [Lanes::splat(0.0); 2];
        let (mut distance, mut off) = (plane.at(simd, &patch.screens), self.lengths(simd, patch));
        for (distance, off) in distance.iter_mut().zip(&mut off) {
            *distance = (self.frame.start + *distance) * *off;
            *off *= plane.reach();
        }
        f64::narrow(distance, &mut found[0]);
        f64::narrow(off, &mut found[1]);
        found
    }

    /// The distances in the middle of brackets, and how far those reach.
    #[inline(always)]
    fn between<S: Simd>(&self, simd: S, patch: &Patch, ends: &Ends) -> [Lanes<f64>; 2] {
        let mut found = [Lanes::splat(0.0); 2];
        let [mut from, mut to] = [f64::wide(simd, &ends[0]), f64::wide(simd, &ends[1])];
        let lengths = self.lengths(simd, patch);
        for ((from, to), length) in from.iter_mut().zip(&mut to).zip(lengths) {
            let middle = self.frame.start + 0.5 * (*from + *to);
            // What these sums round is far below what kernels leave of a bracket.
            let off = 0.5 * (*to - *from) + 1e-13 * middle.abs();
            (*from, *to) = (middle * length, off * length);
        }
        f64::narrow(from, &mut found[0]);
        f64::narrow(to, &mut found[1]);
        found
    }

    /// The lengths of rays' directions.
    #[inline(always)]
    fn lengths<S: Simd>(&self, simd: S, patch: &Patch) -> [f64x8<S>; 2] {
        if self.rays.is_parallel() {
            return [f64x8::splat(simd, 1.0); 2];
        }
        let mut a = f64::wide(simd, &patch.screens[0]);
        let b = f64::wide(simd, &patch.screens[1]);
        for (a, b) in a.iter_mut().zip(b) {
            *a = (1.0 + *a * *a + b * b).sqrt();
        }
        a
    }

    /// Writes hits at distances, on the rays with these bits.
    fn write(&mut self, patch: &Patch, bits: u16, [distance, off]: &[Lanes<f64>; 2]) {
        let [distance, off] = [distance.as_chunks::<4>().0, off.as_chunks::<4>().0];
        for row in 0..4 {
            let four = bits >> (4 * row) & 0xf;
            let (column, line) = (patch.column(4 * row), patch.row(4 * row));
            if four == 0xf {
                self.band.add_four_hits(column, line, &distance[row], &off[row]);
            } else {
                for k in ones(four) {
                    self.band.add_hit(column + k, line, distance[row][k], off[row][k]);
                }
            }
        }
    }

    /// Follows the rays of a tile of 4×4 that are not finished, all of the segment being in the region: first all at once,
    /// each along what the tile's form leaves of it.
    pub(super) fn follow_within(&mut self, level: &Level<T>, slot: usize, segment: [f64; 2]) {
        let patch = self.patch(level.places[slot]);
        let plane = Plane::new(&level.batch, &level.out, slot);
        let left = dispatch!(self.vectors, simd => self.place(simd, &patch, &plane, segment));
        let mut live = left & self.open[patch.index];
        let tolerance = self.method.tolerance * self.footprint(segment[0]);
        let grain = T::GRAIN * self.size;
        let (mut rest, mut hits, mut hard) = (Left::new(), 0, 0);
        for round in 1..=ROUNDS {
            if live == 0 {
                break;
            }
            live = self.pack(live, &mut rest.rays);
            self.segments.count = LANES as u32 - live.leading_zeros();
            self.method.follower.ask(&self.segments, &mut self.contractions);
            self.work.segments.called(live.count_ones());
            let sifted = sift(&self.segments, &self.contractions, live, [tolerance, grain]);
            let short = if self.method.cleared { 0 } else { sifted.short };
            live = if round < ROUNDS { sifted.shorter & !short } else { 0 };
            hits |= rest.take(self.vectors, short, &self.contractions);
            let open = sifted.left & !short & !live;
            hard |= rest.take(self.vectors, open, &self.contractions);
            let Contractions { near, far, .. } = &self.contractions;
            (self.segments.near, self.segments.far) = (*near, *far);
        }
        if hits != 0 {
            self.open[patch.index] &= !hits;
            let found = dispatch!(self.vectors, simd => self.between(simd, &patch, &rest.ends));
            self.write(&patch, hits, &found);
        }
        if hard != 0 {
            let (mut ways, mut bits) = ([Way::NONE; LANES], [0; LANES]);
            let mut count = 0;
            for bit in ones(hard) {
                let [origin, direction] = self.frame.ray(patch.screen(bit));
                ways[count] = Way {
                    origin,
                    direction,
                    error: self.frame.error,
                    start: -self.frame.start,
                    span: [rest.ends[0][bit], rest.ends[1][bit]],
                    inside: [f64::NEG_INFINITY, f64::INFINITY],
                    tolerance,
                };
                bits[count] = bit;
                count += 1;
            }
            self.follow_ways(&patch, &ways[..count], &bits);
        }
    }

    /// Puts the rays of a tile of 4×4 into the batch, each with what a form of the tile leaves of a segment; returns on which
    /// anything is left.
    #[inline(always)]
    fn place<S: Simd>(&mut self, simd: S, patch: &Patch, plane: &Plane, segment: [f64; 2]) -> u16 {
        let asked = segment.map(Lanes::splat);
        let mut left = asked;
        plane.narrow::<_, T>(simd, (&patch.screens, None), &mut left);
        let batch = &mut self.segments;
        let a = f64::wide(simd, &patch.screens[0]);
        let b = f64::wide(simd, &patch.screens[1]);
        for axis in 0..3 {
            let Frame { origin, direction, .. } = &self.frame;
            for (parts, lanes) in
                [(origin, &mut batch.origin[axis]), (direction, &mut batch.direction[axis])]
            {
                let mut numbers = a;
                for (number, b) in numbers.iter_mut().zip(b) {
                    *number = parts[0][axis] + *number * parts[1][axis] + b * parts[2][axis];
                }
                T::narrow(numbers, lanes);
            }
        }
        outward(simd, &asked, &left, self.size, [&mut batch.near, &mut batch.far])
    }

    /// Moves the rays that are live to the first lanes, where that saves a vector; returns the lanes that are live then.
    fn pack(&mut self, live: u16, rays: &mut Option<[u8; LANES]>) -> u16 {
        let (count, last) = (live.count_ones(), LANES as u32 - live.leading_zeros());
        if count.div_ceil(4) == last.div_ceil(4) {
            return live;
        }
        let rays = rays.get_or_insert_with(|| std::array::from_fn(|lane| lane as u8));
        for (to, from) in ones(live).enumerate() {
            rays[to] = rays[from];
        }
        dispatch!(self.vectors, simd => {
            let Segments { origin, direction, near, far, .. } = &mut self.segments;
            for lanes in origin.iter_mut().chain(direction).chain([near, far]) {
                T::pack(simd, lanes, live);
            }
        });
        (1 << count) - 1
    }

    /// Follows the rays of a tile of 4×4 that are not finished, each as far as it is in the region.
    pub(super) fn follow(&mut self, level: &Level<T>, slot: usize, segment: [f64; 2]) {
        let patch = self.patch(level.places[slot]);
        let region = self.method.region;
        let tolerance = self.method.tolerance * self.footprint(segment[0]);
        let (mut ways, mut bits) = ([Way::NONE; LANES], [0; LANES]);
        let mut count = 0;
        let mut ends = segment.map(Lanes::splat);
        dispatch!(self.vectors, simd => self.frame.clip(simd, (&patch.screens, None), region, &mut ends));
        for bit in ones(self.open[patch.index]) {
            let [origin, direction] = self.frame.ray(patch.screen(bit));
            let mut span = [ends[0][bit], ends[1][bit]];
            let mut inside = way::between_faces([origin, direction, self.frame.error], region);
            if region.is_cut() {
                let ray = self.rays.ray(patch.column(bit), self.band.top + patch.row(bit));
                let start = self.frame.start;
                let Some((near, far)) = region.span(&ray) else { continue };
                let slack = 1e-15 * (near.abs() + start.abs());
                span = [span[0].max(near - start - slack), span[1].min(far - start + slack)];
                inside = way::inside(region, &ray, start);
            }
            // Not so either if one is not a number.
            let is_left = span[0] <= span[1];
            if !is_left {
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

    /// The length of a ray's direction.
    #[inline]
    fn length(&self, [a, b]: [f64; 2]) -> f64 {
        if self.rays.is_parallel() { 1.0 } else { (1.0 + a * a + b * b).sqrt() }
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
