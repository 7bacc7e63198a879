//! The rays of a tile of 4×4 pixels, followed together: each along what the tile's form leaves of its segment.
//!
//! What is left of a segment after it was asked stays in its lane: all of it where it got much shorter, else its nearer part,
//! and the other one comes later. Followed one by one are rays on which the arithmetic of tiles is at its end, what may be a hit
//! of a cleared form, and all rays of tiles that a clipping plane or the edge of a ball cuts.

use super::super::way::CUT;
use super::frame::Frame;
use super::level::Level;
use super::narrow::{STALLED, STEADY, UNSTEADY, are_progress};
use super::pixels::Patch;
use super::plane::Plane;
use super::screens::{Ends, HALF, UNMOVED, move_to_first, outward, saves_a_vector};
use super::tiles::Tracer;
use crate::painted::ones;
use crate::scalar::Scalar;
use crate::widths::parts;
use fearless_simd::{Level as Vectors, dispatch, f64x4, mask64x8, prelude::*};
use zeroset_eval::{Contractions, LANES, Lanes, Segments};

/// How often the segments of a tile's rays are asked together, before those that are left are followed one by one.
const ROUNDS: u32 = 64;

/// Lengths of segments that decide what becomes of them.
struct Limits<T> {
    /// Of a bracket, where the form was as good as linear.
    longest: T,
    /// Of a bracket, where it was not.
    least: T,
    /// Of the shortest segments.
    grain: T,
    /// Of the shortest that are cut: below it is rounding that keeps them from getting shorter.
    coarse: T,
}

/// What became of segments that may hold a zero: a bit for each lane in use.
struct Sifted {
    /// Something is left.
    left: u16,
    /// It is short enough for a bracket, and got so at once, or else is far shorter; its ends have opposite signs.
    short: u16,
    /// It got much shorter.
    shorter: u16,
    /// It is cut in two.
    cut: u16,
}

/// What is known of the rays of a tile while they are followed.
struct Bundle<T: Scalar> {
    /// The bits of the rays in the batch's lanes, once they have moved.
    rays: Option<[u8; LANES]>,
    /// By lane, between which values of s the ray is certainly in the region, unless all rays are.
    inside: Option<[Lanes<T>; 2]>,
    /// Between which values of s the zeros of hits, or those of which nothing is proven, are, by the rays' bits.
    ends: Ends,
    /// By the rays' bits, where parts that come later were put aside.
    later: u16,
}

impl<T: Scalar> Bundle<T> {
    /// The bits of the rays in these lanes.
    #[inline]
    fn bits(&self, lanes: u16) -> u16 {
        match &self.rays {
            Some(rays) => ones(lanes).map(|lane| 1 << rays[lane]).sum(),
            None => lanes,
        }
    }

    /// The bit of the ray in a lane.
    #[inline]
    fn bit(&self, lane: usize) -> usize {
        self.rays.map_or(lane, |rays| usize::from(rays[lane]) % LANES)
    }

    /// Takes what is left in these lanes; returns the bits of their rays.
    #[inline]
    fn take(&mut self, vectors: Vectors, lanes: u16, [near, far]: [&Lanes<T>; 2]) -> u16 {
        let [from, to] = &mut self.ends;
        let Some(rays) = &self.rays else {
            if lanes != 0 {
                dispatch!(vectors, simd => {
                    blend(simd, lanes, near, from);
                    blend(simd, lanes, far, to);
                });
            }
            return lanes;
        };
        for lane in ones(lanes) {
            let bit = usize::from(rays[lane]) % LANES;
            (from[bit], to[bit]) = (near[lane].into(), far[lane].into());
        }
        self.bits(lanes)
    }

    /// Tells the segments in these lanes apart by what was asked of them, and puts what is left of each, or its nearer part,
    /// in its place.
    #[inline(always)]
    fn sift<S: Simd>(
        &self,
        simd: S,
        batch: &mut Segments<T>,
        out: &Contractions<T>,
        live: u16,
        limits: &Limits<T>,
    ) -> Sifted {
        let Limits { longest, least, grain, coarse } = *limits;
        let [stalled, steady, share] = [STALLED, STEADY, CUT].map(T::nearest);
        let (mut empty, mut short, mut shorter, mut cut) = (0, 0, 0, 0);
        let mut within = if self.inside.is_some() { 0 } else { u16::MAX };
        for part in parts::<S, T::Vector<S>>(simd, batch.count as usize) {
            let asked = [part.load(&batch.near), part.load(&batch.far)];
            if let Some([first, last]) = &self.inside {
                let inside = part.load(first).simd_le(asked[0]) & asked[1].simd_le(part.load(last));
                within |= part.bits(inside);
            }
            let (near, far) = (part.load(&out.near), part.load(&out.far));
            let (length, before) = (far - near, asked[1] - asked[0]);
            empty |= part.bits(length.simd_lt(T::default()));
            let enough = length.simd_le(longest) & length.simd_le(before * steady);
            short |= part.bits(enough | length.simd_le(least));
            let much = length.simd_le(before * stalled);
            shorter |= part.bits(much & length.simd_gt(grain));
            let between = near + length * share;
            let progress = are_progress([near, far], between, before);
            cut |= part.bits(length.simd_gt(coarse) & progress);
            part.store(near, &mut batch.near);
            part.store(much.select(far, between), &mut batch.far);
        }
        let left = out.possible & live & !empty;
        let short = left & short & out.crossing & within;
        let shorter = left & shorter & !short;
        Sifted { left, short, shorter, cut: left & cut & !short & !shorter }
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
    /// Follows the rays of a tile of 4×4 that are not finished. `within`: all of the segment is in the region.
    pub(super) fn follow(
        &mut self,
        level: &Level<T>,
        lane: usize,
        segment: [f64; 2],
        within: bool,
    ) {
        let patch = self.patch(level.place(lane));
        let longest = self.method.longest * self.footprint(segment[0]);
        if !self.method.options.ideas.contract || !within && self.method.region.is_cut() {
            let (rays, ends) = (self.open[patch.index], segment.map(Lanes::splat));
            return self.follow_apart(&patch, rays, ends, longest, within);
        }
        let plane = Plane::new(&level.batch, &level.out, lane);
        let mut bundle = Bundle { rays: None, inside: None, ends: Default::default(), later: 0 };
        let left = dispatch!(self.vectors, simd => {
            self.place(simd, &patch, &plane, segment, within, &mut bundle.inside)
        });
        let mut live = left & self.open[patch.index];
        if live == 0 {
            return;
        }
        if !within {
            self.cut_at_faces(live, &mut bundle);
        }
        let limits = Limits {
            longest: T::nearest(longest),
            least: T::nearest(UNSTEADY * longest),
            grain: T::nearest(T::GRAIN * self.size),
            coarse: T::nearest(self.coarse),
        };
        let (mut hits, mut hard) = (0, 0);
        for _ in 0..ROUNDS {
            live = self.pack(live, &mut bundle);
            self.segments.count = LANES as u32 - live.leading_zeros();
            self.method.follower.ask(&self.segments, &mut self.contractions);
            self.work.segments.called(live.count_ones());
            let out = &self.contractions;
            let batch = &mut self.segments;
            let Sifted { left, mut short, shorter, cut } =
                dispatch!(self.vectors, simd => bundle.sift(simd, batch, out, live, &limits));
            let mut open = left & !short & !shorter & !cut;
            if self.method.cleared {
                // A zero of the numerator is none of the function's.
                open |= std::mem::take(&mut short);
            }
            let Contractions { near, far, .. } = out;
            hits |= bundle.take(self.vectors, short, [near, far]);
            hard |= bundle.take(self.vectors, open, [near, far]);
            for lane in ones(cut) {
                let bit = bundle.bit(lane);
                bundle.later |= 1 << bit;
                self.later[bit].push([self.segments.far[lane], far[lane]]);
            }
            let empty = live & !left;
            live = shorter | cut;
            if bundle.later != 0 {
                live |= self.go_on(empty, &bundle);
            }
            if live == 0 {
                break;
            }
        }
        let Segments { near, far, .. } = &self.segments;
        hard |= bundle.take(self.vectors, live, [near, far]);
        if hits != 0 {
            self.open[patch.index] &= !hits;
            let found = dispatch!(self.vectors, simd => self.between(simd, &patch, &bundle.ends));
            self.write(&patch, hits, &found);
        }
        for bit in ones(bundle.later) {
            // What stays open of a ray reaches to the end of what was put aside.
            if let Some([_, last]) = self.later[bit].first()
                && hard >> bit & 1 == 1
            {
                bundle.ends[1][bit] = (*last).into();
            }
            self.later[bit].clear();
        }
        if hard != 0 {
            self.follow_apart(&patch, hard, bundle.ends, longest, within);
        }
    }

    /// Goes on with what comes later on the rays in these lanes; returns those in which there was something.
    fn go_on(&mut self, lanes: u16, bundle: &Bundle<T>) -> u16 {
        let mut more = 0;
        for lane in ones(lanes) {
            if let Some([near, far]) = self.later[bundle.bit(lane)].pop() {
                (self.segments.near[lane], self.segments.far[lane]) = (near, far);
                more |= 1 << lane;
            }
        }
        more
    }

    /// Puts parts of segments aside that lie behind where rays are certainly in the region, and those in it that lie behind
    /// others: where a ray leaves the region no sign is known, so those parts are looked at apart.
    fn cut_at_faces(&mut self, live: u16, bundle: &mut Bundle<T>) {
        let Some([firsts, lasts]) = &bundle.inside else { return };
        for lane in ones(live) {
            let (first, last) = (firsts[lane], lasts[lane]);
            let (near, far) = (self.segments.near[lane], self.segments.far[lane]);
            let is_within = first <= near && far <= last;
            if is_within || !(first < last && near < last && first < far) {
                continue;
            }
            let (mut here, later) = ([near, far], &mut self.later[lane]);
            if last < far {
                later.push([last, far]);
                here[1] = last;
            }
            if near < first {
                later.push([first, here[1]]);
                here[1] = first;
            }
            self.segments.far[lane] = here[1];
            bundle.later |= 1 << lane;
        }
    }

    /// Puts the rays of a tile of 4×4 into the batch, each with what a form of the tile leaves of a segment, and if that is
    /// not `within` the region, what may be in it, and where that certainly is; returns on which anything is left.
    #[inline(always)]
    fn place<S: Simd>(
        &mut self,
        simd: S,
        patch: &Patch,
        plane: &Plane,
        segment: [f64; 2],
        within: bool,
        inside: &mut Option<[Lanes<T>; 2]>,
    ) -> u16 {
        let asked = segment.map(Lanes::splat);
        let (mut left, screens) = (asked, patch.screens());
        plane.narrow::<_, T>(simd, (&screens, None), &mut left);
        if !within {
            let region = self.method.region;
            *inside = Some(self.frame.clip_rays(simd, &screens, region, self.size, &mut left));
        }
        let batch = &mut self.segments;
        let Frame { origin, direction, .. } = &self.frame;
        for axis in 0..3 {
            for (parts, lanes) in
                [(origin, &mut batch.origin[axis]), (direction, &mut batch.direction[axis])]
            {
                // What a column of the tile has in common, and what a row has.
                let along = parts[0][axis] + f64x4::simd_from(simd, patch.across) * parts[1][axis];
                let up = patch.upward.map(|upward| upward * parts[2][axis]);
                let rows = [
                    (along + up[0]).combine(along + up[1]),
                    (along + up[2]).combine(along + up[3]),
                ];
                T::narrow(rows, lanes);
            }
        }
        outward(simd, &asked, &left, self.size, [&mut batch.near, &mut batch.far])
    }

    /// Moves the rays that are live to the first lanes, where that saves a vector; returns the lanes that are live then.
    fn pack(&mut self, live: u16, bundle: &mut Bundle<T>) -> u16 {
        if !saves_a_vector(live) {
            return live;
        }
        let first = move_to_first(bundle.rays.get_or_insert(UNMOVED), live);
        let inside = &mut bundle.inside;
        dispatch!(self.vectors, simd => {
            // A copy of its own, which need not be read again for each quantity.
            let kept = live;
            let Segments { origin, direction, near, far, .. } = &mut self.segments;
            let ([ox, oy, oz], [dx, dy, dz]) = (origin, direction);
            for lanes in [ox, oy, oz, dx, dy, dz, near, far] {
                T::pack(simd, lanes, kept);
            }
            if let Some([first, last]) = inside {
                T::pack(simd, first, kept);
                T::pack(simd, last, kept);
            }
        });
        first
    }
}
