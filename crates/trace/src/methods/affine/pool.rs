//! Rays of several tiles, followed together to the end.
//!
//! When the rays of a tile were asked once, few of them are left, and a kernel takes sixteen in little more time than one. So
//! those wait here until there are sixteen, and so do rays of which a tile has few from the start. What is left of a segment after it was asked stays in its lane: all of it where it
//! got much shorter, else its nearer part, and the other one comes later. Set apart to be followed one by one are rays on which
//! the arithmetic of tiles is at its end, what may be a hit of a cleared form, and all rays of tiles that a clipping plane or
//! the edge of a ball cuts.
//!
//! A ray is here once at most: nothing that comes later is asked of its tile before it is finished.

use super::narrow::Scratch;
use super::screens::{packed, saves_a_vector};
use super::sift::Asked;
use super::slots::Stack;
use super::tiles::Tracer;
use crate::painted::ones;
use crate::scalar::Scalar;
use fearless_simd::{Level as Vectors, dispatch};
use zeroset_eval::{Contractions, LANES, Lanes, Segments};

/// How often a segment of a ray is asked before what is left of it is set apart.
const ROUNDS: u8 = 64;

/// A ray of a tile of 4×4.
#[derive(Clone, Copy, Default)]
pub(super) struct TileRay {
    /// Where the bits of its tile are among those of all tiles.
    pub index: usize,
    /// Its bit among those of the tile's pixels.
    pub bit: usize,
    /// The pixel's column and row in the band.
    pub pixel: [usize; 2],
    /// Its screen coordinates.
    pub screen: [f64; 2],
    /// The longest bracket of a hit.
    pub longest: f64,
    /// Whether all that is asked of it is in the region.
    pub within: bool,
}

/// Rays that are followed together, a lane each.
pub(super) struct Pool<T: Scalar> {
    /// The lanes in use, as bits.
    live: u16,
    asked: Asked<T>,
    rays: [TileRay; LANES],
    rounds: [u8; LANES],
    /// What comes after the segment in a lane, and bits, clear where there is none of it.
    later: [Stack<T>; LANES],
    waiting: u16,
    /// Rays that are followed one by one, each between two values of s.
    apart: Vec<(TileRay, [f64; 2])>,
}

/// Memory of one band after another.
pub(super) struct Memory<T: Scalar> {
    /// The rays of one tile.
    pub fresh: Asked<T>,
    pub contractions: Contractions<T>,
    pub pool: Pool<T>,
    pub scratch: Scratch<T>,
}

impl<T: Scalar> Default for Memory<T> {
    fn default() -> Self {
        Self {
            fresh: Asked::default(),
            contractions: Contractions::default(),
            pool: Pool {
                live: 0,
                asked: Asked::default(),
                rays: [TileRay::default(); LANES],
                rounds: [0; LANES],
                later: Default::default(),
                waiting: 0,
                apart: Vec::new(),
            },
            scratch: Scratch::default(),
        }
    }
}

impl<T: Scalar> Memory<T> {
    /// For rays whose coordinates have this error.
    pub fn set_error(&mut self, error: [Lanes<T>; 3]) {
        self.fresh.segments.error = error;
        self.pool.asked.segments.error = error;
    }

    /// What a kernel left in a lane.
    pub fn left(&self, lane: usize) -> [T; 2] {
        [self.contractions.near[lane], self.contractions.far[lane]]
    }
}

impl<T: Scalar> Pool<T> {
    /// Puts a part of the segment in a lane aside: it is asked after what is nearer.
    pub fn put_aside(&mut self, lane: usize, part: [T; 2]) {
        self.later[lane].push(part);
        self.waiting |= 1 << lane;
    }

    /// Puts the parts of a segment aside that lie behind where its ray is certainly in the region, and those in it that lie
    /// behind others: where a ray leaves the region no sign is known, so those parts are looked at apart.
    pub fn cut_at_faces(&mut self, lane: usize, [first, last]: [T; 2]) {
        let Asked { segments, inside, .. } = &mut self.asked;
        (inside[0][lane], inside[1][lane]) = (first, last);
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
        self.asked.segments.far[lane] = here;
    }

    /// Lets go of a lane; returns its ray, and how far what was put aside of it reaches, if anything was.
    fn finish(&mut self, lane: usize) -> (TileRay, Option<T>) {
        self.live &= !(1 << lane);
        let mut last = None;
        if self.waiting >> lane & 1 == 1 {
            self.waiting &= !(1 << lane);
            last = self.later[lane].first().map(|part| part[1]);
            self.later[lane].clear();
        }
        (self.rays[lane], last)
    }

    /// Goes on with what was put aside of the rays in lanes of which nothing is left, and lets go of the others; returns those.
    fn go_on(&mut self, done: u16) -> u16 {
        self.live &= !done;
        for lane in ones(done & self.waiting) {
            if let Some([near, far]) = self.later[lane].pop() {
                let Segments { near: nears, far: fars, .. } = &mut self.asked.segments;
                (nears[lane], fars[lane]) = (near, far);
                self.live |= 1 << lane;
            }
            if self.later[lane].is_empty() {
                self.waiting &= !(1 << lane);
            }
        }
        done & !self.live
    }

    /// Moves the rays to the first lanes, where that saves a vector.
    fn pack(&mut self, vectors: Vectors) {
        if !saves_a_vector::<T>(self.live) {
            return;
        }
        dispatch!(vectors, simd => {
            // A copy of its own, which need not be read again for each quantity.
            let kept = self.live;
            let Asked { segments, longest, inside: [first, last] } = &mut self.asked;
            let Segments { origin, direction, near, far, .. } = segments;
            let ([ox, oy, oz], [dx, dy, dz]) = (origin, direction);
            for lanes in [ox, oy, oz, dx, dy, dz, near, far, longest, first, last] {
                T::pack(simd, lanes, kept);
            }
        });
        let mut waiting = 0;
        for (to, from) in ones(self.live).enumerate() {
            self.rays[to] = self.rays[from];
            self.rounds[to] = self.rounds[from];
            self.later.swap(to, from);
            waiting |= (self.waiting >> from & 1) << to;
        }
        self.waiting = waiting;
        self.live = packed(self.live);
    }
}

impl<T: Scalar> Tracer<'_, '_, '_, T> {
    /// Puts a ray that was asked so often into the pool, with its lane of the rays of its tile; returns its lane there.
    pub(super) fn admit(&mut self, from: usize, ray: TileRay, rounds: u8) -> usize {
        while self.memory.pool.live == u16::MAX {
            self.ask_pool();
        }
        let Memory { fresh, pool, .. } = &mut *self.memory;
        let to = pool.live.trailing_ones() as usize;
        let Asked { segments, longest, inside } = &mut pool.asked;
        for axis in 0..3 {
            segments.origin[axis][to] = fresh.segments.origin[axis][from];
            segments.direction[axis][to] = fresh.segments.direction[axis][from];
        }
        (segments.near[to], segments.far[to]) =
            (fresh.segments.near[from], fresh.segments.far[from]);
        longest[to] = T::nearest(ray.longest);
        (inside[0][to], inside[1][to]) = (fresh.inside[0][from], fresh.inside[1][from]);
        self.followed[ray.index] |= 1 << ray.bit;
        (pool.rays[to], pool.rounds[to]) = (ray, rounds);
        pool.live |= 1 << to;
        to
    }

    /// Sets a ray apart, to be followed alone.
    pub(super) fn set_apart(&mut self, ray: TileRay, ends: [f64; 2]) {
        self.followed[ray.index] |= 1 << ray.bit;
        let apart = &mut self.memory.pool.apart;
        apart.push((ray, ends));
        if apart.len() == LANES {
            self.follow_apart();
        }
    }

    /// Follows all rays in the pool to the end, and those that were set apart.
    pub(super) fn empty_pool(&mut self) {
        while self.follow_more() {}
    }

    /// Asks the rays in the pool once, or if there are none follows those that were set apart; returns `false` if there are
    /// none either.
    pub(super) fn follow_more(&mut self) -> bool {
        if self.memory.pool.live != 0 {
            self.ask_pool();
        } else if self.memory.pool.apart.is_empty() {
            return false;
        } else {
            self.follow_apart();
        }
        true
    }

    /// Follows the rays that were set apart.
    fn follow_apart(&mut self) {
        let mut apart = std::mem::take(&mut self.memory.pool.apart);
        for some in apart.chunks(LANES) {
            self.follow_each(some);
        }
        for (ray, _) in &apart {
            self.followed[ray.index] &= !(1 << ray.bit);
        }
        apart.clear();
        self.memory.pool.apart = apart;
    }

    /// Asks the segments in the pool once.
    fn ask_pool(&mut self) {
        let Memory { pool, contractions, .. } = &mut *self.memory;
        pool.pack(self.vectors);
        let live = pool.live;
        pool.asked.segments.count = LANES as u32 - live.leading_zeros();
        self.method.follower.ask(&pool.asked.segments, contractions);
        self.work.segments.called(live.count_ones());
        let limits = &self.limits;
        let mut sifted =
            dispatch!(self.vectors, simd => pool.asked.sift(simd, contractions, live, limits));
        if self.method.cleared {
            sifted.doubt();
        }
        let mut tired = 0;
        for (lane, rounds) in pool.rounds.iter_mut().enumerate() {
            *rounds = rounds.wrapping_add(1);
            tired |= u16::from(*rounds == ROUNDS) << lane;
        }
        for lane in ones(sifted.cut) {
            pool.put_aside(lane, [pool.asked.segments.far[lane], contractions.far[lane]]);
        }
        for lane in ones(pool.go_on(sifted.empty)) {
            let ray = &pool.rays[lane];
            self.followed[ray.index] &= !(1 << ray.bit);
        }
        for lane in ones(sifted.short) {
            let ends = self.memory.left(lane);
            let (ray, _) = self.memory.pool.finish(lane);
            self.followed[ray.index] &= !(1 << ray.bit);
            self.add_hit(&ray, ends.map(Into::into));
        }
        let over = tired & self.memory.pool.live & !sifted.open;
        for lane in ones(sifted.open | over) {
            let mut ends = self.memory.left(lane);
            if over >> lane & 1 == 1 {
                let Segments { near, far, .. } = &self.memory.pool.asked.segments;
                ends = [near[lane], far[lane]];
            }
            let (ray, last) = self.memory.pool.finish(lane);
            // What stays open of a ray reaches to the end of what was put aside.
            let [near, far] = [ends[0], last.unwrap_or(ends[1])];
            self.set_apart(ray, [near.into(), far.into()]);
        }
    }
}
