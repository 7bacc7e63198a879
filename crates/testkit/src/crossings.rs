//! Triangles of a mesh that meet where they must not, decided in exact arithmetic.
//!
//! Coordinates are taken as the real numbers that the floats stand for. The signs of all
//! determinants are exact, so there is no tolerance.

use robust::{Coord, Coord3D, orient2d, orient3d};
use std::collections::{HashMap, HashSet};

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
    let at = |triangle: [u32; 3]| triangle.map(|vertex| vertices[vertex as usize]);
    let is_flat = |number: &usize| is_flat(at(triangles[*number]));
    let (flat, used): (Vec<usize>, Vec<usize>) = (0..triangles.len()).partition(is_flat);
    let mut found = Crossings { flat, ..Crossings::default() };
    let mut seen = HashSet::new();
    for near in neighborhoods(vertices, triangles, &used) {
        for (k, one) in near.iter().enumerate() {
            for other in &near[..k] {
                let pair = [*other, *one];
                let [first, second] = pair.map(|number| triangles[number]);
                if are_boxes_apart(at(first), at(second)) || !seen.insert(pair) {
                    continue;
                }
                if meet(vertices, first, second) {
                    found.pairs.push(pair);
                }
            }
        }
    }
    found.pairs.sort_unstable();
    found
}

/// Groups of triangles such that any two whose bounding boxes meet are together in one.
fn neighborhoods(
    vertices: &[[f64; 3]],
    triangles: &[[u32; 3]],
    used: &[usize],
) -> impl Iterator<Item = Vec<usize>> {
    let ends = |number: usize, axis: usize| {
        let along = triangles[number].map(|vertex| vertices[vertex as usize][axis]);
        [along.iter().copied().fold(f64::MAX, f64::min), along.into_iter().fold(f64::MIN, f64::max)]
    };
    // Cells of a grid, a little larger than a typical triangle.
    let mut sizes: Vec<f64> = used
        .iter()
        .map(|number| (0..3).map(|k| ends(*number, k)).map(|[lo, hi]| hi - lo).fold(0.0, f64::max))
        .collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let size = sizes.get(9 * sizes.len() / 10).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    for number in used {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let [lo, hi] = ends(*number, axis).map(|end| (end / size).floor() as i64);
            lo..=hi
        });
        for i in x {
            for j in y.clone() {
                for k in z.clone() {
                    cells.entry([i, j, k]).or_default().push(*number);
                }
            }
        }
    }
    cells.into_values()
}

fn are_boxes_apart(one: [[f64; 3]; 3], other: [[f64; 3]; 3]) -> bool {
    let below = |a: [[f64; 3]; 3], b: [[f64; 3]; 3], axis: usize| {
        a.iter().all(|p| b.iter().all(|q| p[axis] < q[axis]))
    };
    (0..3).any(|axis| below(one, other, axis) || below(other, one, axis))
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
    let [a, b, c] =
        [a, b, c].map(|point| Coord { x: point[(axis + 1) % 3], y: point[(axis + 2) % 3] });
    sign(orient2d(a, b, c))
}

/// The exact sign of the volume of four points.
fn sign3(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> i8 {
    let [a, b, c, d] = [a, b, c, d].map(|[x, y, z]| Coord3D { x, y, z });
    sign(orient3d(a, b, c, d))
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

    #[test]
    fn triangles_without_area_are_found() {
        let thin = [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.4, 0.4, 0.4]];
        assert_eq!(of(&[thin, FLOOR]).flat, [0]);
    }
}
