//! The traverser of Knoll, Hijazi, Hansen, Wald and Hagen (UUSCI-2007-002): packets march through slabs of their
//! dominant axis, halving those in which the function may vanish, down to a fixed depth.
//!
//! It proves misses only. Where a slab of the last depth may hold a root it is drawn as one; nothing says that it does,
//! so such pixels are undecided.

use crate::camera::Ray;
use crate::gbuffer::{GBuffer, Status};
use crate::grid::RayGrid;
use crate::packet::{Packet, Segment};
use crate::region::Region;
use crate::scalar::Scalar;
use crate::slab::{Pair, Slab};
use crate::work::Work;
use glam::DVec3;
use rayon::prelude::*;
use zeroset_eval::IntervalKernel;

/// Largest depth over kernels of `f32`.
pub const MAX_DEPTH: u32 = <f32 as Scalar>::MAX_DEPTH;
/// Largest depth over kernels of `f64`.
pub const MAX_DEPTH_F64: u32 = <f64 as Scalar>::MAX_DEPTH;

/// Calls of the kernel for one packet, at most: as many as all slabs of depth 14 need, so that only deeper pictures can
/// reach it. A packet that hits a surface well needs 2 per level; one whose slabs stay undecided would need 2 to the depth.
pub const STEPS: u64 = 1 << 14;

/// How the traverser works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Knoll {
    /// Slabs are halved this many times, within [1, [`Scalar::MAX_DEPTH`]]: the last are 2^−depth of the region's extent.
    /// Rays that are not through after [`STEPS`] end in the slab that was looked at last, as if it were of the last depth;
    /// what is behind it stays unknown.
    pub depth: u32,
    /// Rays in a packet.
    pub width: PacketWidth,
    /// Whether a slab of the last depth in which the function is unbounded is passed over: an asymptote rather than a
    /// root. Its pixel then is undecided, but not drawn there.
    pub suppress_asymptotes: bool,
}

impl Default for Knoll {
    fn default() -> Self {
        Self { depth: 10, width: PacketWidth::Four, suppress_asymptotes: true }
    }
}

/// The number of rays that advance together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketWidth {
    /// 2×2 pixels, as in the paper.
    Four,
    /// 4×2 pixels.
    Eight,
    /// 4×4 pixels.
    Sixteen,
}

/// Pixels on the side of a tile: the unit of work that threads share and that may be cancelled.
const TILE: usize = 32;

/// Where rays start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Start {
    /// The first slab in which the function may vanish counts.
    Anywhere,
    /// On a surface, which does not count: slabs do only after an empty one.
    OnSurface,
}

/// What became of one ray, as distances from its origin.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    drawn: Option<f64>,
    suppressed: Option<f64>,
}

/// What became of one ray, as shares of its packet's extent.
#[derive(Clone, Copy, Debug)]
struct Outcome<T> {
    /// τ at the start of the slab that is drawn.
    drawn: Option<T>,
    /// τ at the start of the first slab that was passed over.
    suppressed: Option<T>,
}

impl Knoll {
    /// Traces a picture. `advance` is told how many pixels were finished since it was last called, and ends the work
    /// early by returning `false`; pixels not reached are then left as misses.
    pub fn trace<K: IntervalKernel<T> + ?Sized, T: Scalar>(
        self,
        frame: &RayGrid,
        region: &Region,
        kernel: &K,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> (GBuffer, Work) {
        match self.width {
            PacketWidth::Four => self.picture::<K, T, 1>(frame, region, kernel, advance),
            PacketWidth::Eight => self.picture::<K, T, 2>(frame, region, kernel, advance),
            PacketWidth::Sixteen => self.picture::<K, T, 4>(frame, region, kernel, advance),
        }
    }

    fn picture<K: IntervalKernel<T> + ?Sized, T: Scalar, const GROUPS: usize>(
        self,
        frame: &RayGrid,
        region: &Region,
        kernel: &K,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> (GBuffer, Work) {
        let (width, height) = (frame.width(), frame.height());
        let mut buffer = GBuffer::new(width, height, 0);
        let mut work = Work::default();
        let across = width.div_ceil(TILE);
        let tiles: Vec<(Vec<Pixel>, Work)> = (0..across * height.div_ceil(TILE))
            .into_par_iter()
            .map(|tile| {
                if !advance(0) {
                    return Default::default();
                }
                let (left, top) = (TILE * (tile % across), TILE * (tile / across));
                let done = self.tile::<K, T, GROUPS>(frame, region, kernel, left, top);
                advance((width - left).min(TILE) * (height - top).min(TILE));
                done
            })
            .collect();
        for (pixels, done) in tiles {
            work += done;
            for Pixel { index, status, distance, drawn } in pixels {
                buffer.status[index] = status;
                buffer.distance[index] = distance;
                buffer.drawn[index] = drawn;
            }
        }
        (buffer, work)
    }

    fn tile<K: IntervalKernel<T> + ?Sized, T: Scalar, const GROUPS: usize>(
        self,
        frame: &RayGrid,
        region: &Region,
        kernel: &K,
        left: usize,
        top: usize,
    ) -> (Vec<Pixel>, Work) {
        let (width, height) = (frame.width(), frame.height());
        // A packet's extent in pixels: 2×2, 4×2 or 4×4.
        let (columns, rows) = (if GROUPS == 1 { 2 } else { 4 }, if GROUPS == 4 { 4 } else { 2 });
        let mut pixels = Vec::with_capacity(TILE * TILE);
        let mut work = Work::default();
        let unset = Segment { origin: DVec3::ZERO, direction: DVec3::Z, to: f64::INFINITY };
        let mut segments = [[unset; 4]; GROUPS];
        for y in (top..(top + TILE).min(height)).step_by(rows) {
            for x in (left..(left + TILE).min(width)).step_by(columns) {
                // Rays beyond the picture's edge repeat its last ones.
                let place = |group: usize, lane: usize| {
                    let i = x + 2 * (group % 2) + lane % 2;
                    let j = y + 2 * (group / 2) + lane / 2;
                    (i.min(width - 1), j.min(height - 1))
                };
                for (group, segments) in segments.iter_mut().enumerate() {
                    for (lane, segment) in segments.iter_mut().enumerate() {
                        let (i, j) = place(group, lane);
                        let Ray { origin, direction } = frame.ray(i, j);
                        (segment.origin, segment.direction) = (origin, direction);
                    }
                }
                let outcomes = self.rays(&segments, region, kernel, Start::Anywhere, &mut work);
                for (group, outcomes) in outcomes.iter().enumerate() {
                    for (lane, outcome) in outcomes.iter().enumerate() {
                        let (i, j) = place(group, lane);
                        pixels.extend(outcome.pixel(j * width + i));
                    }
                }
            }
        }
        (pixels, work)
    }

    /// Follows rays, together if they advance together and otherwise one by one.
    fn rays<K: IntervalKernel<T> + ?Sized, T: Scalar, const GROUPS: usize>(
        self,
        segments: &[[Segment; 4]; GROUPS],
        region: &Region,
        kernel: &K,
        start: Start,
        work: &mut Work,
    ) -> [[Found; 4]; GROUPS] {
        if let Some(packet) = Packet::new(segments, region) {
            let outcomes = self.packet(&packet, kernel, start, work);
            let mut found = [[Found::default(); 4]; GROUPS];
            for group in 0..GROUPS {
                for lane in 0..4 {
                    let segment = &segments[group][lane];
                    let at = |share| packet.distance(share, group, lane, segment);
                    let Outcome { drawn, suppressed } = outcomes[group][lane];
                    found[group][lane] =
                        Found { drawn: drawn.map(at), suppressed: suppressed.map(at) };
                }
            }
            return found;
        }
        // One by one: a packet of one ray, four times, always advances together. Were it not so (a direction that is
        // not a number), nothing would be known of the ray.
        let unknown = Found { drawn: None, suppressed: Some(0.0) };
        segments.map(|group| {
            group.map(|one| match Packet::<T, 1>::new(&[[one; 4]], region) {
                Some(_) => self.rays(&[[one; 4]], region, kernel, start, work)[0][0],
                None => unknown,
            })
        })
    }

    fn packet<K: IntervalKernel<T> + ?Sized, T: Scalar, const GROUPS: usize>(
        self,
        packet: &Packet<T, GROUPS>,
        kernel: &K,
        start: Start,
        work: &mut Work,
    ) -> [[Outcome<T>; 4]; GROUPS] {
        let mut outcomes = [[Outcome::default(); 4]; GROUPS];
        let mut alive: [u32; GROUPS] =
            std::array::from_fn(|group| !packet.groups[group].outside() & 0b1111);
        let mut leaving = match start {
            Start::Anywhere => [0; GROUPS],
            Start::OnSurface => alive,
        };
        let mut pair = Pair::default();
        // What was found in the second half of the slab being searched, per level.
        let mut second = [Slab::<GROUPS>::default(); MAX_DEPTH_F64 as usize];
        let last = self.depth - 1;
        let mut done = Work::default();
        // Slab `index` of 2^(level + 1) spans τ from index · 2^−(level + 1) to the next: exact.
        let (mut level, mut index) = (0_u32, 0_u64);
        loop {
            let size = T::halved(level + 1);
            let from = T::integer(index) * size;
            let mut slab = if index % 2 == 0 {
                // Both halves of a slab in one call: the second is nearly always needed, and the two overlap in the
                // processor (two calls would take 1.6 times as long on the sphere).
                if !pair.prepare(packet, &alive, from, size) && packet.all_left(&alive, from) {
                    break;
                }
                let [first, other] = pair.enclose(kernel, &mut done);
                second[level as usize] = other;
                first
            } else {
                second[level as usize]
            };
            if start == Start::OnSurface {
                // Until a lane has come through an empty slab, it is still at the surface that it started from.
                for (leaving, (asked, found)) in
                    leaving.iter_mut().zip(slab.active.iter().zip(&slab.vanishing))
                {
                    *leaving &= !(asked & !found);
                }
            }
            let mut vanishing = 0;
            for (found, alive) in slab.vanishing.iter_mut().zip(&alive) {
                *found &= alive;
                vanishing |= *found;
            }
            let is_last = done.interval_calls >= STEPS;
            if vanishing != 0 {
                if level < last && !is_last {
                    level += 1;
                    index *= 2;
                    continue;
                }
                for group in 0..GROUPS {
                    slab.vanishing[group] &= !leaving[group];
                    alive[group] &= !self.record(&slab, group, from, &mut outcomes[group]);
                }
                if alive.iter().all(|&lanes| lanes == 0) && !is_last {
                    break;
                }
            }
            if is_last {
                // What is behind this slab stays unknown; what was found in front of it does not change by that.
                let behind = from + size;
                for (group, outcomes) in outcomes.iter_mut().enumerate() {
                    let left = alive[group] & packet.groups[group].meets(behind, T::integer(2));
                    done.given_up += u64::from((left | slab.vanishing[group]).count_ones());
                    for (lane, outcome) in outcomes.iter_mut().enumerate() {
                        if left >> lane & 1 == 1 {
                            outcome.suppressed.get_or_insert(behind);
                        }
                    }
                }
                break;
            }
            // On to the next slab, and up to the largest that starts there.
            index += 1;
            let up = index.trailing_zeros();
            if up > level {
                break; // the end of the region
            }
            index >>= up;
            level -= up;
        }
        *work += done;
        outcomes
    }

    /// Notes a slab of the last depth in which lanes of a group may vanish; returns the lanes that are drawn there.
    fn record<T: Scalar, const GROUPS: usize>(
        self,
        slab: &Slab<GROUPS>,
        group: usize,
        from: T,
        outcomes: &mut [Outcome<T>; 4],
    ) -> u32 {
        let mut drawn = slab.vanishing[group];
        if self.suppress_asymptotes {
            drawn &= !slab.unbounded[group];
        }
        for (lane, outcome) in outcomes.iter_mut().enumerate() {
            if drawn >> lane & 1 == 1 {
                outcome.drawn = Some(from);
            } else if slab.vanishing[group] >> lane & 1 == 1 {
                outcome.suppressed.get_or_insert(from);
            }
        }
        drawn
    }

    /// Finds which painted points of `buffer` do not see the light, at this traverser's depth. A ray starts
    /// `offset` away from its point (in world units), and what it meets before it is clear of that surface does not
    /// count: otherwise a surface would shade itself wherever enclosures are wide.
    ///
    /// `wanted` is asked before each tile, and ends the work early by returning `false`.
    #[allow(clippy::too_many_arguments)] // what a ray needs, and no two of it belong together
    pub fn shadows<K: IntervalKernel<T> + ?Sized, T: Scalar>(
        self,
        buffer: &mut GBuffer,
        frame: &RayGrid,
        region: &Region,
        kernel: &K,
        light: &crate::light::Light,
        offset: f64,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Work {
        let painted: Vec<usize> =
            (0..buffer.drawn.len()).filter(|&pixel| buffer.is_drawn(pixel)).collect();
        let parts: Vec<(Vec<(usize, bool)>, Work)> = painted
            .par_chunks(TILE * TILE)
            .map(|pixels| {
                let mut work = Work::default();
                let mut found = Vec::with_capacity(pixels.len());
                if !wanted() {
                    return (found, work);
                }
                for four in pixels.chunks(4) {
                    let segment = |lane: usize| {
                        let pixel = four[lane.min(four.len() - 1)];
                        let ray = frame.ray_of(pixel);
                        let t = ray.parameter(buffer.drawn[pixel]);
                        let (way, distance) = light.towards(ray.at(t));
                        // Off the surface on the side of the eye, then along the light.
                        let origin = ray.at(t - ray.parameter(offset)) + way * offset;
                        Segment { origin, direction: way, to: distance }
                    };
                    let segments = [std::array::from_fn(segment)];
                    let [outcomes] =
                        self.rays(&segments, region, kernel, Start::OnSurface, &mut work);
                    let hidden = outcomes.map(|outcome| outcome.drawn.is_some());
                    found.extend(four.iter().copied().zip(hidden));
                }
                (found, work)
            })
            .collect();
        let mut work = Work::default();
        for (found, done) in parts {
            work += done;
            for (pixel, hidden) in found {
                buffer.shadow[pixel] = hidden;
            }
        }
        work
    }
}

impl<T> Default for Outcome<T> {
    fn default() -> Self {
        Self { drawn: None, suppressed: None }
    }
}

/// A pixel that is not a miss.
struct Pixel {
    index: usize,
    status: Status,
    distance: f64,
    drawn: f64,
}

impl Found {
    /// The pixel that this makes, or `None` for a miss. Only what was found decides, however far away that is.
    fn pixel(&self, index: usize) -> Option<Pixel> {
        let first = self.suppressed.into_iter().chain(self.drawn).reduce(f64::min);
        let drawn = self.drawn.unwrap_or(f64::INFINITY);
        first.map(|distance| Pixel { index, status: Status::Undecided, distance, drawn })
    }
}
