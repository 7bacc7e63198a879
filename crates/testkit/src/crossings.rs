//! Triangles of a mesh that meet where they must not, decided in exact arithmetic.
//!
//! Coordinates are taken as the real numbers that the floats stand for. The signs of all
//! determinants are exact, so there is no tolerance.

use crate::bounds::{Bounds, for_each_pair};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// The pairs of triangles that meet in more than the corners that they share, and the triangles
/// without area.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Crossings {
    /// Pairs of triangles, by their numbers.
    pub pairs: Vec<[usize; 2]>,
    /// Numbers of triangles whose corners are on one line.
    pub flat: Vec<usize>,
}

/// Finds the [`Crossings`] of all triangles of a mesh. Triangles without area count only as such.
///
/// # Panics
/// If a triangle has the number of a missing vertex.
pub fn crossings(vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Crossings {
    let at = |number: usize| triangles[number].map(|vertex| vertices[vertex as usize]);
    let (flat, used): (Vec<usize>, Vec<usize>) =
        (0..triangles.len()).partition(|number| is_flat(at(*number)));
    let boxes: Vec<Bounds> = used.iter().map(|number| Bounds::of(at(*number))).collect();
    let mut pairs = Vec::new();
    for_each_pair(&boxes, &mut |one, other| {
        let mut pair = [used[one], used[other]];
        pair.sort_unstable();
        let [first, second] = pair.map(|number| triangles[number]);
        if meet(vertices, first, second) {
            pairs.push(pair);
        }
    });
    pairs.sort_unstable();
    Crossings { pairs, flat }
}

/// Returns whether two triangles with an area meet in more than the corners that they share.
fn meet(vertices: &[[f64; 3]], one: [u32; 3], other: [u32; 3]) -> bool {
    let at = |vertex: u32| vertices[vertex as usize];
    let places = [one, other].map(|triangle| triangle.map(at));
    let shared: Vec<u32> = one.into_iter().filter(|vertex| other.contains(vertex)).collect();
    let rest = |triangle: [u32; 3]| -> Vec<[f64; 3]> {
        triangle.into_iter().filter(|vertex| !shared.contains(vertex)).map(at).collect()
    };
    let (left, right) = (rest(one), rest(other));
    match shared.len() {
        0 if are_apart(places[0], places[1]) => false,
        0 => {
            let edges = |[a, b, c]: [[f64; 3]; 3]| [[a, b], [b, c], [c, a]];
            edges(places[0]).into_iter().any(|edge| meets(edge, places[1]))
                || edges(places[1]).into_iter().any(|edge| meets(edge, places[0]))
        }
        // If two triangles meet along a segment that begins at their shared corner, the segment
        // ends on the edge opposite to that corner in one of them.
        1 => meets([left[0], left[1]], places[1]) || meets([right[0], right[1]], places[0]),
        2 => {
            let [a, b] = [at(shared[0]), at(shared[1])];
            let (c, d) = (left[0], right[0]);
            sign3(a, b, c, d) == 0 && {
                let axis = axis_across([a, b, c]);
                sign2(axis, a, b, c) == sign2(axis, a, b, d)
            }
        }
        _ => true,
    }
}

/// Returns whether the plane of one triangle has the other on one side. In one plane, the line of
/// an edge must separate both. Most pairs are apart.
fn are_apart(one: [[f64; 3]; 3], other: [[f64; 3]; 3]) -> bool {
    let sides = |[a, b, c]: [[f64; 3]; 3], far: [[f64; 3]; 3]| far.map(|d| sign3(a, b, c, d));
    let is_beside = |sides: [i8; 3]| sides == [1; 3] || sides == [-1; 3];
    if sides(one, other) == [0; 3] {
        let axis = axis_across(one);
        let separates = |[a, b, c]: [[f64; 3]; 3], far: [[f64; 3]; 3]| {
            let inside = sign2(axis, a, b, c);
            far.into_iter().all(|d| sign2(axis, a, b, d) * inside < 0)
        };
        let edges = |[a, b, c]: [[f64; 3]; 3]| [[a, b, c], [b, c, a], [c, a, b]];
        return edges(one).into_iter().any(|edge| separates(edge, other))
            || edges(other).into_iter().any(|edge| separates(edge, one));
    }
    is_beside(sides(one, other)) || is_beside(sides(other, one))
}

/// Returns whether a closed segment meets a closed triangle with an area.
fn meets([from, to]: [[f64; 3]; 2], [a, b, c]: [[f64; 3]; 3]) -> bool {
    let (first, last) = (sign3(a, b, c, from), sign3(a, b, c, to));
    if first * last > 0 {
        return false;
    }
    if first == 0 && last == 0 {
        let axis = axis_across([a, b, c]);
        let crosses = |p: [f64; 3], q: [f64; 3]| {
            let sides = [sign2(axis, p, q, from), sign2(axis, p, q, to)];
            let ends = [sign2(axis, from, to, p), sign2(axis, from, to, q)];
            let is_line = sides == [0, 0];
            if is_line { overlap([from, to], [p, q]) } else { differ(sides) && differ(ends) }
        };
        return crosses(a, b) || crosses(b, c) || crosses(c, a) || {
            let around = [(a, b), (b, c), (c, a)].map(|(p, q)| sign2(axis, p, q, from));
            around.iter().all(|side| *side >= 0) || around.iter().all(|side| *side <= 0)
        };
    }
    let around = [(a, b), (b, c), (c, a)].map(|(p, q)| sign3(from, to, p, q));
    around.iter().all(|side| *side >= 0) || around.iter().all(|side| *side <= 0)
}

/// Returns whether two signs are not both positive and not both negative.
fn differ([one, other]: [i8; 2]) -> bool {
    one * other <= 0
}

/// Returns whether two closed segments of one line meet.
fn overlap(one: [[f64; 3]; 2], other: [[f64; 3]; 2]) -> bool {
    (0..3).all(|axis| {
        let ends = |[p, q]: [[f64; 3]; 2]| [p[axis].min(q[axis]), p[axis].max(q[axis])];
        let ([lo, hi], [low, high]) = (ends(one), ends(other));
        lo <= high && low <= hi
    })
}

/// Returns whether three points are on one line.
fn is_flat([a, b, c]: [[f64; 3]; 3]) -> bool {
    (0..3).all(|axis| sign2(axis, a, b, c) == 0)
}

/// An axis along which the projection of a triangle with an area has an area, too.
fn axis_across([a, b, c]: [[f64; 3]; 3]) -> usize {
    (0..3).find(|axis| sign2(*axis, a, b, c) != 0).expect("an area")
}

/// The exact sign of the area of three points, seen along an axis.
fn sign2(axis: usize, a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> i8 {
    if share_plane(&[a, b, c], [(axis + 1) % 3, (axis + 2) % 3]) {
        return 0;
    }
    let [a, b, c] =
        [a, b, c].map(|point| Coord { x: point[(axis + 1) % 3], y: point[(axis + 2) % 3] });
    sign(orient2d(a, b, c))
}

/// The exact sign of the volume of four points.
fn sign3(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> i8 {
    if share_plane(&[a, b, c, d], [0, 1, 2]) {
        return 0;
    }
    let [a, b, c, d] = [a, b, c, d].map(|[x, y, z]| Coord3D { x, y, z });
    sign(orient3d(a, b, c, d))
}

/// Returns whether a plane across one of these axes holds all points. Many faces are so, and exact
/// determinants take longest where they are 0.
fn share_plane<const N: usize>(points: &[[f64; 3]], axes: [usize; N]) -> bool {
    axes.iter().any(|axis| points.iter().all(|point| point[*axis] == points[0][*axis]))
}

fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The crossings of triangles that share the vertices they have in common.
    fn of(triangles: &[[[f64; 3]; 3]]) -> Crossings {
        let mut vertices: Vec<[f64; 3]> = Vec::new();
        let mut number = |place: [f64; 3]| {
            let known = vertices.iter().position(|one| *one == place);
            known.unwrap_or_else(|| {
                vertices.push(place);
                vertices.len() - 1
            }) as u32
        };
        let triangles: Vec<[u32; 3]> =
            triangles.iter().map(|corners| corners.map(&mut number)).collect();
        crossings(&vertices, &triangles)
    }

    const FLOOR: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];

    #[test]
    fn triangles_that_meet_in_more_than_shared_corners_are_found() {
        for (name, other, cross) in [
            ("through", [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 1.0]], true),
            ("above", [[1.0, 1.0, 1e-300], [2.0, 1.0, 1.0], [9.0, 9.0, 1.0]], false),
            ("touching", [[1.0, 1.0, 0.0], [2.0, 1.0, 1.0], [9.0, 9.0, 1.0]], true),
            ("in the plane, inside", [[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]], true),
            ("in the plane, beside", [[5.0, 5.0, 0.0], [6.0, 5.0, 0.0], [5.0, 6.0, 0.0]], false),
            ("at a corner", [[0.0, 0.0, 0.0], [-1.0, 0.0, 1.0], [-1.0, -1.0, 1.0]], false),
            ("at a corner, through", [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [1.0, 1.5, -1.0]], true),
            ("at an edge", [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 1e-300]], false),
            ("folded", [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 9.0, 0.0]], true),
            ("opposite", [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, -9.0, 0.0]], false),
            ("half an edge", [[1.0, 0.0, 0.0], [9.0, 0.0, 0.0], [1.0, -9.0, 0.0]], true),
        ] {
            assert_eq!(!of(&[FLOOR, other]).pairs.is_empty(), cross, "{name}");
            assert_eq!(!of(&[other, FLOOR]).pairs.is_empty(), cross, "{name}, exchanged");
        }
    }

    /// On a small grid, many corners and edges are in one plane or on one line.
    #[test]
    fn triangles_that_are_apart_have_no_edge_that_meets_the_other() {
        let mut random = fastrand::Rng::with_seed(65);
        let (mut apart, mut meeting) = (0, 0);
        for _ in 0..20_000 {
            let [one, other] =
                [0; 2].map(|_| [0; 3].map(|_| [0; 3].map(|_| random.u8(..4).into())));
            if is_flat(one) || is_flat(other) {
                continue;
            }
            let edges = |[a, b, c]: [[f64; 3]; 3]| [[a, b], [b, c], [c, a]];
            let is_meeting = edges(one).into_iter().any(|edge| meets(edge, other))
                || edges(other).into_iter().any(|edge| meets(edge, one));
            assert!(!(is_meeting && are_apart(one, other)), "{one:?} {other:?}");
            meeting += usize::from(is_meeting);
            apart += usize::from(are_apart(one, other));
        }
        assert!(apart > 5000 && meeting > 5000, "{apart} apart, {meeting} meeting");
    }

    #[test]
    fn triangles_without_area_are_found() {
        let thin = [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.4, 0.4, 0.4]];
        assert_eq!(of(&[thin, FLOOR]).flat, [0]);
    }
}
