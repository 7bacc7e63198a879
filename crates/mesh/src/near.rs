//! A bound of the distance between mesh and surface, where tetrahedra are too large for the bound of
//! [`proof`](crate::proof): triangle by triangle.
//!
//! `docs/meshes.md` has the argument, in "The distance".

use crate::cells::{Enclosure, PartBounds, PartKernels, Query, Side, enclosures};
use crate::extract::Extracted;
use crate::index::{Bounds, Index};
use crate::leaf::{Kind, Leaf, Nearness};
use crate::proof::{MARGIN, least_slope, middle};
use crate::refine::Refined;
use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use zeroset_eval::LANES;
use zeroset_interval::Interval;

/// The distance that is proven for whole tetrahedra, in allowed distances.
pub const LOOSE: f64 = 4.0;
/// Width of the space around a triangle in which gradients are bounded, in such distances.
const AROUND: f64 = 2.0;
/// Largest distance of a gradient from their middle there, as a share of the middle: two gradients
/// are then at an angle below 45 degrees.
const SPREAD: f64 = 0.38;
/// Largest distance from the surface that a triangle may have, as a share of the allowed distance:
/// where it is large, more of its edges can be removed.
const SHARE: f64 = 0.7;
/// Number of parts into which a triangle's edges are divided.
const PARTS: usize = 4;

/// The part whose zeros are the surface around a place, and the side on which the function is above
/// 0.
type Only = (u16, Side);

/// Returns whether the bounds in a tetrahedron allow it to be [`Nearness::Loose`].
pub fn may_be_loose(query: &Query<'_>, parts: &[PartBounds]) -> bool {
    only(query, parts).is_some()
}

fn only(query: &Query<'_>, parts: &[PartBounds]) -> Option<Only> {
    let [part] = parts else { return None };
    let is_surface = usize::from(part.part) < query.first_cut && query.estimated == 0.0;
    let is_sided = matches!(part.side, Side::Above | Side::Below);
    (is_surface && is_sided && part.gradient.is_some()).then_some((part.part, part.side))
}

/// Loose leaves in which mesh and surface are not proven to be within the allowed distance.
#[derive(Default)]
pub struct Far {
    /// Leaves with such a triangle: it may be near if they are split.
    pub large: Vec<usize>,
    /// Leaves near which something else prevents the proof.
    pub strict: Vec<usize>,
}

/// Finds the [loose](Nearness::Loose) leaves in which mesh and surface are not proven to be within
/// the allowed distance.
pub fn far(refined: &Refined, mesh: &Extracted, query: &Query<'_>, distance: f64) -> Far {
    let leaves = &refined.leaves;
    let is_loose = |leaf: &Leaf| matches!(leaf.kind, Kind::Open { near: Nearness::Loose, .. });
    let loose: Vec<usize> = (0..leaves.len()).filter(|leaf| is_loose(&leaves[*leaf])).collect();
    if loose.is_empty() {
        return Far::default();
    }
    let space = query.space;
    let reach = AROUND * LOOSE * distance;
    let only: Vec<Option<Only>> = leaves
        .iter()
        .map(|leaf| match &leaf.kind {
            Kind::Open { local, .. } => only(query, &local.parts),
            Kind::Inside(_) => None,
        })
        .collect();
    let ends = |leaf: usize| {
        let [x, y, z] = space.between(leaves[leaf].cell.bounds());
        [DVec3::new(x.lo, y.lo, z.lo), DVec3::new(x.hi, y.hi, z.hi)]
    };
    let around = |[low, high]: [DVec3; 2]| [low - reach, high + reach];
    let numbered = |(k, leaf): (usize, &usize)| (k as u32, space.units(around(ends(*leaf))));
    let index =
        Index::new(loose.len(), &loose.iter().enumerate().map(numbered).collect::<Vec<_>>());
    let mut is_far = vec![false; loose.len()];
    // All leaves around a loose one must have the same part.
    let mut mark = |bounds: &Bounds, of: Option<Only>| {
        index.all_near(bounds, &mut |k| {
            is_far[k as usize] |= of.is_none() || of != only[loose[k as usize]];
            true
        });
    };
    let first = only[loose[0]];
    if only.iter().any(|one| *one != first) {
        for (leaf, of) in only.iter().enumerate() {
            mark(&space.units(ends(leaf)), *of);
        }
    }
    let (mut asked, mut large) = (vec![Vec::new(); query.parts.len()], Vec::new());
    for (number, leaf) in mesh.leaves.iter().enumerate() {
        if let Some((part, _)) = only[*leaf] {
            asked[usize::from(part)].push(number);
        }
    }
    let corners = |number: usize| mesh.triangles[number].map(|k| mesh.vertices[k as usize]);
    let units = |number: usize| {
        let [a, b, c] = corners(number);
        space.units([a.min(b).min(c), a.max(b).max(c)])
    };
    let is_beside = |number: &usize| index.all_near(&units(*number), &mut |_| false);
    for (part, asked) in asked.into_iter().enumerate() {
        let kernels = &query.parts[part];
        let asked: Vec<usize> = asked.into_par_iter().filter(|number| !is_beside(number)).collect();
        let far = |some: &[usize]| -> SmallVec<[usize; LANES]> {
            let triangles: SmallVec<[([DVec3; 3], Side); LANES]> = some
                .iter()
                .filter_map(|number| Some((corners(*number), only[mesh.leaves[*number]]?.1)))
                .collect();
            let near = are_near(kernels, query, &triangles, reach, distance);
            let numbered = some.iter().zip(near);
            numbered.filter(|(_, is_near)| !is_near).map(|(number, _)| *number).collect()
        };
        let far: Vec<usize> = asked.par_chunks(LANES / 2).flat_map_iter(far).collect();
        for number in far {
            let leaf = mesh.leaves[number];
            if is_loose(&leaves[leaf]) {
                large.push(leaf);
            } else {
                mark(&units(number), None);
            }
        }
    }
    large.sort_unstable();
    large.dedup();
    let strict = loose.into_iter().zip(is_far).filter(|(_, is_far)| *is_far);
    Far { large, strict: strict.map(|(leaf, _)| leaf).collect() }
}

/// For each of some triangles, returns whether it is proven to be near the zeros of a part, as far
/// as these are within `reach`.
fn are_near(
    kernels: &PartKernels<'_>,
    query: &Query<'_>,
    triangles: &[([DVec3; 3], Side)],
    reach: f64,
    distance: f64,
) -> SmallVec<[bool; LANES]> {
    let boxes = triangles.iter().flat_map(|([a, b, c], _)| {
        let (low, high) = (a.min(*b).min(*c), a.max(*b).max(*c));
        let [own, around] = [[low, high], [low - reach, high + reach]].map(interval_box);
        // Nothing is bounded outside of the domain.
        [own, if query.space.holds(&around) { around } else { own }]
    });
    let boxes: SmallVec<[[Interval; 3]; LANES]> = boxes.collect();
    let gradients: SmallVec<[Option<[Interval; 3]>; LANES]> =
        enclosures(kernels, &boxes).map(|Enclosure { gradient, .. }| gradient).collect();
    let of = |((corners, side), k): (&([DVec3; 3], Side), usize)| {
        let [own, around] = [gradients[2 * k]?, gradients[2 * k + 1]?];
        if boxes[2 * k] == boxes[2 * k + 1] {
            return None;
        }
        let slope = slope_along(&around)?;
        let [a, b, c] = *corners;
        let normal = (b - a).cross(c - a);
        let out = if *side == Side::Below { -normal } else { normal };
        if least_slope(&around, out).0 <= 0.0 {
            return None;
        }
        let most = most_off(kernels, corners, &own);
        (most <= SHARE * distance * slope).then_some(())
    };
    triangles.iter().zip(0..).map(|one| of(one).is_some()).collect()
}

/// The least slope of a function along each vector that its gradient may be, if the gradient is
/// within bounds. `None` if it is not positive, or two gradients may be at an angle of 45 degrees.
fn slope_along(gradient: &[Interval; 3]) -> Option<f64> {
    let length = middle(gradient).length();
    let spread = 0.5 * DVec3::from_array(gradient.map(|along| along.hi - along.lo)).length();
    let spread = spread * (1.0 + MARGIN);
    // A gradient is at most `spread` from the middle. So is the component of another one along it.
    let slope = (length * length - spread * spread).sqrt() - spread - MARGIN * length;
    // False for NaN.
    (spread <= SPREAD * length && slope > 0.0).then_some(slope)
}

/// A bound of |f| in a triangle: the largest value at some points, and half of the difference that
/// the gradient allows between neighbors.
fn most_off(kernels: &PartKernels<'_>, [a, b, c]: &[DVec3; 3], gradient: &[Interval; 3]) -> f64 {
    let points = (0..=PARTS).flat_map(|i| (0..=PARTS - i).map(move |j| (i, j)));
    let at = |(i, j): (usize, usize)| {
        let [i, j] = [i, j].map(|count| count as f64 / PARTS as f64);
        let point = a + i * (b - a) + j * (c - a);
        interval_box([point, point])
    };
    let points: SmallVec<[[Interval; 3]; LANES]> = points.map(at).collect();
    let largest = |Enclosure { value, .. }: Enclosure| value.hi.max(-value.lo);
    let most = enclosures(kernels, &points).map(largest).fold(0.0, f64::max);
    let span = a.max(*b).max(*c) - a.min(*b).min(*c);
    let width = DVec3::from_array(gradient.map(|along| along.hi - along.lo));
    // A mean of distances from a mean is at most half the span, and a gradient differs by at most
    // half of the width from the middle.
    most + 0.25 * width.dot(span) / PARTS as f64 * (1.0 + MARGIN)
}

fn interval_box([low, high]: [DVec3; 2]) -> [Interval; 3] {
    [0, 1, 2].map(|axis| Interval { lo: low[axis], hi: high[axis] })
}
