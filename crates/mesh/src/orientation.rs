//! Turns the triangles of an equation so that its closed pieces face out.
//!
//! Triangles face where f > 0. That is outside of a solid, but an equation f = 0 may have either
//! sign outside: −f = 0 is the same surface. Closed pieces form nests: a piece that is inside of no
//! other one, and all pieces inside of it. If the outermost piece faces in, its nest is turned as a
//! whole. So between the pieces of a nest, orientation goes on alternating with the sign of f.
//!
//! A piece is inside of another one if a ray from one of its points crosses the other one an odd
//! number of times. All rays point up. Each is moved sideways by an infinitely small amount, so
//! that it crosses no edge, and all decisions are exact.

use crate::connected::Connected;
use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};
use rustc_hash::FxHashSet;

/// A connected piece of a mesh.
struct Piece {
    /// The piece's first vertex, from which its ray starts.
    from: DVec3,
    is_closed: bool,
    /// Six times the volume that the piece encloses, below 0 if its triangles face in.
    volume: f64,
}

/// Turns all nests of closed pieces whose outermost piece faces in. `rims` has the ends of all
/// edges that do not lie between two triangles. Returns the number of nests that were turned.
pub fn face_out(vertices: &[DVec3], triangles: &mut [[u32; 3]], rims: &[[u32; 2]]) -> usize {
    let mut connected = Connected::new(vertices.len(), triangles);
    let mut numbers = vec![u32::MAX; vertices.len()];
    let mut pieces: Vec<Piece> = Vec::new();
    for vertex in 0..vertices.len() as u32 {
        let first = connected.first(vertex) as usize;
        if numbers[first] == u32::MAX {
            numbers[first] = pieces.len() as u32;
            pieces.push(Piece { from: vertices[first], is_closed: true, volume: 0.0 });
        }
        numbers[vertex as usize] = numbers[first];
    }
    for [vertex, _] in rims {
        pieces[numbers[*vertex as usize] as usize].is_closed = false;
    }
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| vertices[vertex as usize]);
    for triangle in &*triangles {
        let piece = &mut pieces[numbers[triangle[0] as usize] as usize];
        let [a, b, c] = corners(triangle).map(|corner| corner - piece.from);
        piece.volume += a.dot(b.cross(c));
    }
    let outermost = outermost(&pieces, triangles, &numbers, &corners);
    let is_turned: Vec<bool> = (0..pieces.len())
        .map(|piece| pieces[piece].is_closed && pieces[outermost[piece] as usize].volume < 0.0)
        .collect();
    for triangle in triangles {
        if is_turned[numbers[triangle[0] as usize] as usize] {
            triangle.swap(1, 2);
        }
    }
    (0..pieces.len())
        .filter(|piece| is_turned[*piece] && outermost[*piece] == *piece as u32)
        .count()
}

/// The outermost piece of each closed piece's nest. `numbers` has the number of each vertex's
/// piece.
fn outermost(
    pieces: &[Piece],
    triangles: &[[u32; 3]],
    numbers: &[u32],
    corners: &dyn Fn(&[u32; 3]) -> [DVec3; 3],
) -> Vec<u32> {
    let mut closed: Vec<u32> = (0..pieces.len() as u32).collect();
    closed.retain(|piece| pieces[*piece as usize].is_closed);
    let mut outermost: Vec<u32> = (0..pieces.len() as u32).collect();
    if closed.len() < 2 {
        return outermost;
    }
    // A triangle is small, so few rays are between its least and its greatest x.
    let from = |piece: &u32| pieces[*piece as usize].from;
    closed.sort_by(|a, b| from(a).x.total_cmp(&from(b).x));
    // Pairs of pieces, where the ray of the first one crosses the second one an odd number of
    // times.
    let mut inside: FxHashSet<[u32; 2]> = FxHashSet::default();
    for triangle in triangles {
        let own = numbers[triangle[0] as usize];
        if !pieces[own as usize].is_closed {
            continue;
        }
        let corners = corners(triangle);
        let [low, high] = [DVec3::min, DVec3::max]
            .map(|pick: fn(DVec3, DVec3) -> DVec3| corners.into_iter().fold(corners[0], pick));
        let start = closed.partition_point(|piece| from(piece).x < low.x);
        for piece in &closed[start..] {
            let from = from(piece);
            if from.x > high.x {
                break;
            }
            let is_near = low.y <= from.y && from.y <= high.y && from.z <= high.z;
            if is_near && *piece != own && is_above(&corners, from) && !inside.insert([*piece, own])
            {
                inside.remove(&[*piece, own]);
            }
        }
    }
    let inner: FxHashSet<u32> = inside.iter().map(|[inner, _]| *inner).collect();
    let mut pairs: Vec<[u32; 2]> = inside.into_iter().collect();
    pairs.retain(|[_, outer]| !inner.contains(outer));
    for [inner, outer] in pairs {
        outermost[inner as usize] = outer;
    }
    outermost
}

/// Returns whether the ray upward from a point goes through a triangle, after an infinitely small
/// move of the point along x, and one along y that is infinitely smaller.
fn is_above(corners: &[DVec3; 3], from: DVec3) -> bool {
    let [a, b, c] = *corners;
    let sides = [[a, b], [b, c], [c, a]].map(|[one, other]| side(one, other, from));
    if sides[0] == 0 || sides != [sides[0]; 3] {
        return false;
    }
    let [a, b, c, from] = [a, b, c, from].map(|DVec3 { x, y, z }| Coord3D { x, y, z });
    orient3d(a, b, c, from) * f64::from(sides[0]) > 0.0
}

/// As seen from above: 1 if a point that is moved so is on the left of a line, −1 if it is on the
/// right, and 0 if the line is vertical.
fn side(one: DVec3, other: DVec3, point: DVec3) -> i8 {
    let [a, b, p] = [one, other, point].map(|DVec3 { x, y, .. }| Coord { x, y });
    let turn = orient2d(a, b, p);
    let by_moves = [turn, one.y - other.y, other.x - one.x];
    let sign = by_moves.into_iter().find(|sign| *sign != 0.0).unwrap_or(0.0);
    i8::from(sign > 0.0) - i8::from(sign < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with integer corners, its depth among boxes, and the number of the outermost one.
    struct Nested {
        low: [i32; 3],
        high: [i32; 3],
        depth: usize,
        outermost: usize,
    }

    /// Adds a box and, in some of the eight parts of its inside, further boxes. Many corners are
    /// above corners and edges of others.
    fn nest(random: &mut fastrand::Rng, boxes: &mut Vec<Nested>, low: [i32; 3], size: i32) {
        let outermost = boxes.len();
        let mut rest = vec![(low, size, 0)];
        while let Some((low, size, depth)) = rest.pop() {
            boxes.push(Nested { low, high: low.map(|at| at + size), depth, outermost });
            let half = size / 2;
            if half < 4 {
                continue;
            }
            for octant in 0..8 {
                if random.u8(..3) == 0 {
                    let corner = [0, 1, 2].map(|k| low[k] + 1 + (octant >> k & 1) * half);
                    rest.push((corner, half - 2, depth + 1));
                }
            }
        }
    }

    /// The triangles of a box, from its corners in a random order.
    fn add_box(
        random: &mut fastrand::Rng,
        vertices: &mut Vec<DVec3>,
        triangles: &mut Vec<[u32; 3]>,
        Nested { low, high, .. }: &Nested,
        faces_in: bool,
    ) {
        let first = vertices.len() as u32;
        let mut order: Vec<u32> = (0..8).collect();
        random.shuffle(&mut order);
        let mut places = [DVec3::ZERO; 8];
        for (corner, place) in order.iter().enumerate() {
            let at = [0, 1, 2].map(|k| if corner >> k & 1 == 1 { high[k] } else { low[k] });
            places[*place as usize] = DVec3::from_array(at.map(f64::from));
        }
        vertices.extend(places);
        for [a, b, c, d] in
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
        {
            for mut triangle in [[a, b, c], [a, c, d]] {
                if faces_in {
                    triangle.swap(0, 1);
                }
                triangles.push(triangle.map(|corner: usize| first + order[corner]));
            }
        }
    }

    #[test]
    fn nests_of_boxes_face_out() {
        let (mut turned, mut inner) = (0, 0);
        for seed in 0..200 {
            let random = &mut fastrand::Rng::with_seed(seed);
            let mut boxes = Vec::new();
            for place in 0..8 {
                let low = [0, 1, 2].map(|k| 40 * (place >> k & 1));
                nest(random, &mut boxes, low, 32);
            }
            let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
            let faces_in: Vec<bool> = (0..boxes.len()).map(|_| random.bool()).collect();
            for (nested, faces_in) in boxes.iter().zip(&faces_in) {
                add_box(random, &mut vertices, &mut triangles, nested, *faces_in);
            }
            let rims = Vec::new();
            let found = face_out(&vertices, &mut triangles, &rims);
            let expected = boxes.iter().zip(&faces_in).filter(|(b, f)| b.depth == 0 && **f).count();
            assert_eq!(found, expected, "seed {seed}");
            for (number, nested) in boxes.iter().enumerate() {
                let is_turned = faces_in[nested.outermost];
                let own = &triangles[12 * number..12 * number + 12];
                let at = |vertex: &u32| vertices[*vertex as usize];
                let volume: f64 =
                    own.iter().map(|[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum();
                let size = f64::from(nested.high[0] - nested.low[0]).powi(3);
                let size = if faces_in[number] == is_turned { size } else { -size };
                assert!((volume - size).abs() < 1e-6 * size.abs(), "seed {seed}: box {number}");
                inner += usize::from(nested.depth > 1);
            }
            turned += found;
        }
        println!("{turned} nests turned, {inner} boxes within others that are within others");
        assert!(turned > 500 && inner > 500, "{turned} {inner}");
    }

    #[test]
    fn open_pieces_stay() {
        let vertices = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        // A tetrahedron that faces in, whole and without one face.
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let (mut whole, mut open) = (faces, faces);
        assert_eq!(face_out(&vertices, &mut whole, &[]), 1);
        assert_eq!(face_out(&vertices, &mut open[..3], &[[1, 2], [2, 3], [1, 3]]), 0);
        assert_eq!((whole[0], open), ([0, 2, 1], faces));
    }
}
