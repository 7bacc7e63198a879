//! Caps: the faces where the region cuts a solid open.
//!
//! A tracer finds the boundary f = 0 of a solid f ≤ 0. The solid is also visible where a ray enters
//! the region inside the solid.

use crate::gbuffer::GBuffer;
use crate::grid::{BAND_ROWS, RayGrid};
use crate::kernel_stats::KernelStats;
use crate::ray_result::{RayResult, Status, UndecidedReason};
use crate::rows::{Rows, for_each_part};
use zeroset_eval::{Boxes, Enclose, Kernel, LANES, Real};
use zeroset_interval::{Facts, Interval};
use zeroset_space::{Entry, Ray, Region};

/// Number of entry points that are enclosed at a time.
const BATCH: usize = 256;

/// Whether a ray's entry point lies in the solid.
#[derive(Clone, Copy, PartialEq)]
enum Inside {
    Yes,
    No,
    Unknown(UndecidedReason),
}

/// How often the region's faces are examined in search of the solid, and into how many parts along
/// each axis they are divided in between.
const ROUNDS: usize = 3;
const PARTS: usize = 4;

/// Returns whether the region may cut the solid f ≤ 0. If not, [`cap`] changes nothing: f is proven
/// to be above 0, or undefined, at all points of the region's faces. A region that is cut by a
/// plane or a ball is not examined.
pub fn may_cut<T: Real>(region: &Region, kernel: &dyn Kernel<Enclose, T>) -> bool {
    if region.is_cut() {
        return true;
    }
    let (low, high) = (region.low(), region.high());
    let whole = [0, 1, 2].map(|axis| Interval { lo: low[axis], hi: high[axis] });
    let mut cells: Vec<[Interval; 3]> = Vec::new();
    for axis in 0..3 {
        for end in [low[axis], high[axis]] {
            let mut face = whole;
            face[axis] = Interval { lo: end, hi: end };
            cells.push(face);
        }
    }
    for round in 0..ROUNDS {
        if round > 0 {
            cells = cells.iter().flat_map(divided).collect();
        }
        let verdicts = verdicts_of(&cells, kernel, &mut KernelStats::default());
        if verdicts.contains(&Inside::Yes) {
            return true;
        }
        let mut left = verdicts.iter().map(|verdict| *verdict != Inside::No);
        cells.retain(|_| left.next() == Some(true));
        if cells.is_empty() {
            return false;
        }
    }
    true
}

/// Divides a part of a face along both of its axes.
fn divided(cell: &[Interval; 3]) -> Vec<[Interval; 3]> {
    let mut all = vec![*cell];
    for axis in (0..3).filter(|&axis| cell[axis].lo < cell[axis].hi) {
        let Interval { lo, hi } = cell[axis];
        let at = |part: usize| match part {
            0 => lo,
            PARTS => hi,
            _ => lo + (hi - lo) * (part as f64 / PARTS as f64),
        };
        let part = |(mut cell, k): ([Interval; 3], usize)| {
            cell[axis] = Interval { lo: at(k), hi: at(k + 1) };
            cell
        };
        all =
            all.into_iter().flat_map(|cell| (0..PARTS).map(move |k| (cell, k))).map(part).collect();
    }
    all
}

/// Paints the faces where the region cuts the solid f ≤ 0, and updates the proofs. `buffer` holds
/// the solid's boundary. A ray's entry point is where it enters the region; a ray that starts
/// inside has none. If f < 0 is proven there, and the ray certainly meets the region, the entry
/// point is a hit. If it is proven that f > 0 or f is undefined there, nothing changes. Otherwise
/// the pixel is undecided from the entry point on. `only` selects pixels; if empty, all. Returns
/// the number of evaluations.
pub fn cap<T: Real>(
    buffer: &mut GBuffer,
    rays: &RayGrid,
    region: &Region,
    kernel: &dyn Kernel<Enclose, T>,
    only: &[bool],
) -> KernelStats {
    buffer.keep_caps();
    for_each_part(buffer.rows(BAND_ROWS), |mut rows| {
        cap_rows(&mut rows, rays, region, kernel, only)
    })
}

/// As [`cap`], for some rows of a picture that [keeps](crate::Kept) caps and normals. `only` has an
/// element for each pixel of the whole picture.
///
/// # Panics
/// If the picture does not keep caps and normals.
pub fn cap_rows<T: Real>(
    rows: &mut Rows<'_>,
    rays: &RayGrid,
    region: &Region,
    kernel: &dyn Kernel<Enclose, T>,
    only: &[bool],
) -> KernelStats {
    let pixels = rows.pixels();
    let first = pixels.start;
    let entries: Vec<(usize, Entry)> = pixels
        .filter(|&pixel| only.is_empty() || only[pixel])
        .filter_map(|pixel| Some((pixel, region.entry(&rays.ray_of(pixel))?)))
        .collect();
    let mut work = KernelStats::default();
    let mut judged = |batch: &[(usize, Entry)]| judge(batch, rays, region, kernel, &mut work);
    let verdicts: Vec<Inside> = entries.chunks(BATCH).flat_map(&mut judged).collect();
    for ((pixel, entry), inside) in entries.into_iter().zip(verdicts) {
        let ray = rays.ray_of(pixel);
        let (distance, pixel) = (ray.distance(entry.t.0), pixel - first);
        let (from, reason) = match inside {
            Inside::No => continue,
            // A zero that the tracer found at the face may be slightly nearer, by rounding.
            Inside::Unknown(reason) => (rows.distance(pixel).min(distance), reason),
            // The reason counts only if the entry is uncertain: the ray may pass by an edge.
            Inside::Yes => (distance, UndecidedReason::Touching),
        };
        let mut bracket = [f64::NAN; 2];
        if inside == Inside::Yes && entry.certain {
            let found = RayResult { bracket: [entry.t.0, entry.t.1], ..RayResult::MISS };
            bracket = found.scaled(ray.distance(1.0)).bracket;
            rows.status[pixel] = Status::Hit;
        } else {
            (rows.status[pixel], rows.reason[pixel]) = (Status::Undecided, reason);
            rows.open_from[pixel] = from;
        }
        if let Some(place) = rows.bracket.get_mut(pixel) {
            *place = bracket;
        }
        if inside == Inside::Yes {
            rows.drawn[pixel] = distance;
            rows.normal[pixel] = entry.normal.as_vec3().to_array();
            rows.cap[pixel] = true;
        }
    }
    work
}

/// Decides for each entry point whether it lies in the solid. Groups of neighbors are tested
/// together first, then the points of groups that stay undecided.
fn judge<T: Real>(
    batch: &[(usize, Entry)],
    rays: &RayGrid,
    region: &Region,
    kernel: &dyn Kernel<Enclose, T>,
    work: &mut KernelStats,
) -> Vec<Inside> {
    let boxes: Vec<[Interval; 3]> = batch
        .iter()
        .map(|(pixel, entry)| {
            let ray = rays.ray_of(*pixel);
            [0, 1, 2].map(|axis| enclosed(&ray, entry, region, axis))
        })
        .collect();
    let hull = |group: &[[Interval; 3]]| {
        let both = |a: [Interval; 3], b: &[Interval; 3]| [0, 1, 2].map(|k| a[k].hull(b[k]));
        group.iter().skip(1).fold(group[0], both)
    };
    let groups: Vec<[Interval; 3]> = boxes.chunks(LANES).map(hull).collect();
    let mut verdicts = Vec::with_capacity(boxes.len());
    for (group, verdict) in boxes.chunks(LANES).zip(verdicts_of(&groups, kernel, work)) {
        if let Inside::Unknown(_) = verdict {
            verdicts.extend(verdicts_of(group, kernel, work));
        } else {
            verdicts.resize(verdicts.len() + group.len(), verdict);
        }
    }
    verdicts
}

/// Decides for each box whether its points lie in the solid.
fn verdicts_of<T: Real>(
    boxes: &[[Interval; 3]],
    kernel: &dyn Kernel<Enclose, T>,
    work: &mut KernelStats,
) -> Vec<Inside> {
    let batches = Boxes::around(boxes);
    for batch in &batches {
        work.interval.called(batch.count);
    }
    let out = kernel.eval_all(&batches);
    (0..boxes.len())
        .map(|k| {
            let (out, lane) = (&out[k / LANES], k % LANES);
            let (facts, zero) = (out.facts(lane), T::default());
            if facts.has(Facts::NOWHERE) || out.neg_lo[lane] < zero {
                Inside::No
            } else if facts.has(Facts::DEFINED) && out.hi[lane] < zero {
                Inside::Yes
            } else if facts.has(Facts::DEFINED) {
                Inside::Unknown(UndecidedReason::Touching)
            } else {
                Inside::Unknown(UndecidedReason::Undefined)
            }
        })
        .collect()
}

/// Bounds of one coordinate of the ray's entry point, clamped to the region's box.
fn enclosed(ray: &Ray, entry: &Entry, region: &Region, axis: usize) -> Interval {
    let (origin, slope) = (ray.origin[axis], ray.direction[axis]);
    let ends = [slope * entry.t.0, slope * entry.t.1];
    let low = (origin + ends[0].min(ends[1]).next_down()).next_down();
    let high = (origin + ends[0].max(ends[1]).next_up()).next_up();
    // Both ends are clamped on both sides. So they stay in order even if rounding moved the point
    // out of the box. A NaN, which comes from overflow, becomes a bound of the box.
    let (least, most) = (region.low()[axis], region.high()[axis]);
    Interval { lo: low.max(least).min(most), hi: high.min(most).max(least) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use zeroset_eval::Enclosures;
    use zeroset_space::{Camera, HalfSpace, Projection};

    /// The half-space x ≤ 0.25, as the function x − 0.25.
    struct LeftHalf;

    impl Kernel<Enclose> for LeftHalf {
        fn eval(&self, boxes: &Boxes, out: &mut Enclosures) {
            for lane in 0..LANES {
                out.neg_lo[lane] = boxes.neg_lo[0][lane] + 0.25;
                out.hi[lane] = boxes.hi[0][lane] - 0.25;
            }
            (out.defined, out.continuous) = (u16::MAX, u16::MAX);
        }
    }

    fn picture(region: &Region) -> GBuffer {
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let rays = RayGrid::new(&camera.expect("valid"), 8, 8);
        let mut buffer = GBuffer::of_nothing(8, 8);
        cap(&mut buffer, &rays, region, &LeftHalf, &[]);
        buffer
    }

    #[test]
    fn the_front_face_is_painted_where_the_solid_reaches_it() {
        let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0)).expect("valid");
        let buffer = picture(&region);
        // Pixel centers are at x = −7/8, −5/8, … 7/8. The first five are in the solid.
        for pixel in 0..64 {
            let expected = pixel % 8 < 5;
            assert_eq!(buffer.status[pixel] == Status::Hit, expected, "{pixel}");
            assert_eq!(buffer.is_cap(pixel), expected);
        }
        assert_eq!(buffer.normal[0], [0.0, -1.0, 0.0]);
        assert!((buffer.distance(0) - 4.0).abs() < 1e-6);
    }

    /// The function max(|x|, |y|, |z|) − `reach`.
    struct Around {
        reach: f32,
        evaluated: AtomicUsize,
    }

    impl Kernel<Enclose> for Around {
        fn eval(&self, boxes: &Boxes, out: &mut Enclosures) {
            for lane in 0..LANES {
                let [mut near, mut far] = [0.0_f32; 2];
                for axis in 0..3 {
                    let (lo, hi) = (-boxes.neg_lo[axis][lane], boxes.hi[axis][lane]);
                    near = near.max(lo.max(-hi).max(0.0));
                    far = far.max(hi.abs().max(lo.abs()));
                }
                out.neg_lo[lane] = self.reach - near;
                out.hi[lane] = far - self.reach;
            }
            (out.defined, out.continuous) = (u16::MAX, u16::MAX);
            self.evaluated.fetch_add(boxes.count as usize, Ordering::Relaxed);
        }
    }

    /// A cube of half size `reach`, in regions of half size 1.
    #[test]
    fn a_solid_within_the_region_is_not_cut() {
        let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0)).expect("valid");
        for (reach, is_cut) in [(0.5, false), (0.999, false), (1.0, true), (1.5, true)] {
            let kernel = Around { reach, evaluated: AtomicUsize::new(0) };
            assert_eq!(may_cut(&region, &kernel), is_cut, "{reach}");
            assert!(kernel.evaluated.into_inner() <= 6 * (1 + 16 + 256));
        }
        let ball = region.with_ball();
        assert!(may_cut(&ball, &Around { reach: 0.5, evaluated: AtomicUsize::new(0) }));
    }

    #[test]
    fn the_clipping_plane_is_capped_too() {
        let clip = HalfSpace { normal: DVec3::NEG_Y, offset: 0.0 };
        let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0))
            .and_then(|region| region.with_clip(clip))
            .expect("valid");
        let buffer = picture(&region);
        assert!((buffer.distance(0) - 5.0).abs() < 1e-6);
        assert_eq!(buffer.normal[0], [0.0, -1.0, 0.0]);
        assert_eq!(buffer.status[7], Status::Miss);
    }
}
