//! A proof that two meshes are near each other.
//!
//! Take a triangle of one mesh, and look along its normal. The triangles of the other mesh that
//! overlap it as seen are found one after another, across shared edges. If all of them face the
//! viewer, and no rim is in the way, they cover it: on both sides of an edge there is one. Where
//! one overlaps it, the difference of heights is greatest at a corner of the overlap.
//!
//! Where that fails, as at creases, the corners of a triangle may all be near one triangle of the
//! other mesh, which is convex. Else the triangle is divided into four.

use crate::index::{Bounds, Index};
use crate::simplify::triangulation::Triangulation;
use glam::{DVec3, I64Vec3};
use rayon::prelude::*;
use smallvec::SmallVec;

/// Share of a distance that covers the rounding of its computation.
const ROUNDING: f64 = 1e-6;
/// Share of a distance by which corners of a triangle move inward before its cover is looked for.
/// Then faces beyond a crease at its side do not overlap it. No point of the triangle is farther
/// than that from the smaller one.
const INSET: f64 = 1.0 / 64.0;
/// Number of triangles from which on none is looked for that is near all corners.
const MANY: usize = 24;
/// Number of times that a triangle is divided into four.
const DIVISIONS: u32 = 12;
/// The neighbor across a rim.
const NONE: u32 = u32::MAX;

/// A mesh with an index.
pub struct Cover {
    triangles: Vec<[DVec3; 3]>,
    bounds: Vec<Bounds>,
    /// For each triangle, its neighbor across each edge: the first one is from the first corner to
    /// the second.
    neighbors: Vec<[u32; 3]>,
    index: Index,
}

/// Triangles that were seen in a search.
struct Search {
    /// For each triangle, the last search that came to it.
    seen: Vec<u32>,
    number: u32,
    open: Vec<u32>,
}

impl Cover {
    /// The present triangles. Places are in units.
    pub fn new(mesh: &Triangulation) -> Self {
        let present: Vec<u32> = mesh.present().collect();
        let mut numbers = vec![NONE; mesh.count()];
        for (number, triangle) in present.iter().enumerate() {
            numbers[*triangle as usize] = number as u32;
        }
        let bounds: Vec<Bounds> = present.iter().map(|one| mesh.bounds(*one)).collect();
        let numbered = bounds.iter().enumerate().map(|(k, bounds)| (k as u32, *bounds));
        let index = Index::new(present.len(), &numbered.collect::<Vec<_>>());
        let places = |one: &u32| mesh.corners(*one).map(|corner| mesh.place(corner).as_dvec3());
        let neighbors = |one: &u32| {
            let [a, b, c] = mesh.corners(*one);
            [[a, b], [b, c], [c, a]].map(|[from, to]| {
                let is_across = |&&other: &&u32| other != *one && mesh.corners(other).contains(&to);
                let other = mesh.around(from).iter().find(is_across);
                other.map_or(NONE, |other| numbers[*other as usize])
            })
        };
        let neighbors = present.par_iter().map(neighbors).collect();
        Self { triangles: present.iter().map(places).collect(), bounds, neighbors, index }
    }

    /// Places in this mesh that are not proven to be within a distance of another one, in units:
    /// one of each triangle that has such a place.
    pub fn far_from(&self, other: &Self, distance: f64) -> Vec<DVec3> {
        let distance = distance * (1.0 - ROUNDING);
        let search =
            || Search { seen: vec![0; other.triangles.len()], number: 0, open: Vec::new() };
        let far = |search: &mut Search, (triangle, bounds): (&[DVec3; 3], &Bounds)| {
            let reach = I64Vec3::splat(distance.ceil() as i64 + 1);
            let around = Bounds { low: bounds.low - reach, high: bounds.high + reach };
            let mut near = Vec::new();
            other.index.all_near(&around, &mut |one| {
                near.push(one);
                true
            });
            other.outside(triangle, near, distance, DIVISIONS, search)
        };
        let each = self.triangles.par_iter().zip(&self.bounds);
        each.map_init(search, far).flatten().collect()
    }

    /// A place in a triangle that is not proven to be within a distance of one of the triangles
    /// `near`. `None` if the whole triangle is proven.
    fn outside(
        &self,
        piece: &[DVec3; 3],
        mut near: Vec<u32>,
        distance: f64,
        left: u32,
        search: &mut Search,
    ) -> Option<DVec3> {
        let [low, high] = [
            piece.iter().copied().reduce(DVec3::min).expect("corners") - distance,
            piece.iter().copied().reduce(DVec3::max).expect("corners") + distance,
        ];
        near.retain(|one| {
            let [a, b, c] = self.triangles[*one as usize];
            a.min(b).min(c).cmple(high).all() && a.max(b).max(c).cmpge(low).all()
        });
        let is_small = (high - low).max_element() <= 4.0 * distance;
        if near.len() <= MANY || is_small {
            let mut is_corner_near = [false; 3];
            for one in &near {
                let triangle = &self.triangles[*one as usize];
                let of = piece.map(|corner| distance_to(corner, triangle) <= distance);
                if of == [true; 3] {
                    return None;
                }
                is_corner_near = [0, 1, 2].map(|k| is_corner_near[k] || of[k]);
            }
            if let Some(k) = is_corner_near.iter().position(|is_near| !is_near) {
                return Some(piece[k]);
            }
        }
        if self.covers(piece, &near, distance, search) {
            return None;
        }
        let [a, b, c] = *piece;
        let Some(left) = left.checked_sub(1) else { return Some(a) };
        let [ab, bc, ca] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
        let pieces = [[ab, bc, ca], [a, ab, ca], [ab, b, bc], [ca, bc, c]];
        pieces.iter().find_map(|piece| self.outside(piece, near.clone(), distance, left, search))
    }

    /// Returns whether a triangle is proven to be covered, within a distance, by triangles that
    /// face the same way. One of those `near` is the first.
    fn covers(&self, piece: &[DVec3; 3], near: &[u32], distance: f64, search: &mut Search) -> bool {
        let [a, b, c] = *piece;
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return false };
        let across = normal.any_orthonormal_vector();
        let up = normal.cross(across);
        let flat = |point: DVec3| {
            let from = point - a;
            DVec3::new(from.dot(across), from.dot(up), from.dot(normal))
        };
        let seen = |one: u32| self.triangles[one as usize].map(flat);
        let own = piece.map(flat);
        let middle = (own[0] + own[1] + own[2]) / 3.0;
        let farthest = own.iter().map(|corner| corner.distance(middle)).fold(0.0, f64::max);
        let inward = (INSET * distance / farthest).min(0.5);
        let own = own.map(|corner| corner.lerp(middle, inward));
        let distance = (1.0 - INSET) * distance;
        let holds_middle = |one: &&u32| {
            let corners = seen(**one);
            (0..3).all(|k| side(corners[k], corners[(k + 1) % 3], middle) >= 0.0)
                && overlap(&own, &corners).iter().all(|point| point.z.abs() <= distance)
        };
        let Some(first) = near.iter().find(holds_middle) else { return false };
        search.number += 1;
        search.open.clear();
        search.open.push(*first);
        search.seen[*first as usize] = search.number;
        while let Some(one) = search.open.pop() {
            let corners = seen(one);
            if side(corners[0], corners[1], corners[2]) <= 0.0 {
                return false;
            }
            if !overlap(&own, &corners).iter().all(|point| point.z.abs() <= distance) {
                return false;
            }
            for k in 0..3 {
                if !crosses(&own, corners[k], corners[(k + 1) % 3]) {
                    continue;
                }
                let next = self.neighbors[one as usize][k];
                if next == NONE {
                    return false;
                }
                if std::mem::replace(&mut search.seen[next as usize], search.number)
                    != search.number
                {
                    search.open.push(next);
                }
            }
        }
        true
    }
}

/// Twice the area of a triangle as seen from above: above 0 if it turns to the left.
fn side(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// The corners of the overlap of two triangles as seen from above, with the heights of the second.
/// Both turn to the left.
fn overlap(own: &[DVec3; 3], other: &[DVec3; 3]) -> SmallVec<[DVec3; 8]> {
    let mut left: SmallVec<[DVec3; 8]> = other.iter().copied().collect();
    for k in 0..3 {
        let (from, to) = (own[k], own[(k + 1) % 3]);
        let all = std::mem::take(&mut left);
        for (j, point) in all.iter().enumerate() {
            let next = all[(j + 1) % all.len()];
            let (here, there) = (side(from, to, *point), side(from, to, next));
            if here >= 0.0 {
                left.push(*point);
            }
            if (here < 0.0) != (there < 0.0) {
                left.push(point.lerp(next, here / (here - there)));
            }
        }
    }
    left
}

/// Returns whether an edge may cross a triangle as seen from above, which turns to the left.
fn crosses(triangle: &[DVec3; 3], from: DVec3, to: DVec3) -> bool {
    let outside = |k: usize| {
        let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
        side(a, b, from) < 0.0 && side(a, b, to) < 0.0
    };
    let sides = triangle.map(|corner| side(from, to, corner));
    let is_beside = sides.iter().all(|side| *side < 0.0) || sides.iter().all(|side| *side > 0.0);
    !is_beside && !(0..3).any(outside)
}

/// The distance of a point from a triangle, or from a segment whose end is given twice.
pub fn distance_to(point: DVec3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let across = (*b - *a).cross(*c - *a);
    let is_inside = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(across) >= 0.0;
    if is_inside(*a, *b) && is_inside(*b, *c) && is_inside(*c, *a) {
        let area = across.length();
        if area > 0.0 {
            return ((point - *a).dot(across) / area).abs();
        }
    }
    let to_side = |from: DVec3, to: DVec3| {
        let along = to - from;
        let share = (point - from).dot(along) / along.length_squared();
        // NaN for a segment without length, which `min` ignores.
        (from + share.clamp(0.0, 1.0) * along - point).length()
    };
    to_side(*a, *b).min(to_side(*b, *c)).min(to_side(*c, *a))
}
