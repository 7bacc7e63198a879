//! Polygons in a tetrahedron where a choice of linear functions is 0.
//!
//! A vertex is known by the corners of the tetrahedron, triangle or edge that it lies in, and by
//! the parts that are 0 there. So tetrahedra that share a face agree on the vertices in it.
//!
//! Polygons are as in exact arithmetic, unless a [`Linear`] is uncertain.

use crate::cells::Side;
use smallvec::{SmallVec, smallvec};
use std::cell::Cell;
use std::cmp::Ordering;
use zeroset_scene::choices::Choice;

/// A vertex: the numbers of the corners it lies between, and the parts that are 0 there, both in
/// order. There is one corner more than there are parts. Unused places hold [`NO_PART`] and
/// [`NO_CORNER`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct VertexKey {
    corners: [u32; 4],
    pub parts: [u16; 3],
}

/// Marks unused places of [`VertexKey::parts`].
pub const NO_PART: u16 = u16::MAX;
/// Marks unused places of a vertex's corners.
const NO_CORNER: u32 = u32::MAX;
/// Largest error of a determinant of up to three rows, or of a sum of four products, relative to
/// the sum of the terms' absolute values. Each takes at most seven roundings.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl VertexKey {
    /// The numbers of the corners.
    pub fn corners(&self) -> &[u32] {
        let count = self.corners.iter().position(|corner| *corner == NO_CORNER);
        &self.corners[..count.unwrap_or(4)]
    }
}

/// A tetrahedron with linear functions.
pub struct Linear {
    /// The corners' numbers, in order.
    pub corners: [u32; 4],
    /// For each part that matters, its number and its values at the corners.
    parts: SmallVec<[(u16, [f64; 4]); 1]>,
    /// True once rounding may have decided on which side of a zero a vertex is.
    is_uncertain: Cell<bool>,
}

/// A line of the tetrahedron that a polygon's edge lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    /// On the face or the edge whose corners have their bits set.
    Side(u8),
    /// On the zeros of this part.
    Part(u16),
}

#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// Corners that the vertex lies between, as bits.
    between: u8,
    parts: [u16; 3],
    /// Weights of the corners.
    weights: [f64; 4],
    /// Largest errors of the weights.
    errors: [f64; 4],
    /// The line of the edge to the next vertex.
    next: Line,
}

/// A polygon, counterclockwise from in front.
#[derive(Clone, Debug)]
pub struct Polygon {
    vertices: SmallVec<[Vertex; 4]>,
    /// The corners that the polygon lies between, as bits.
    between: u8,
    /// The part that is 0 in the polygon, or [`NO_PART`].
    pub part: u16,
    /// Whether it was joined from pieces, so that it may have any shape.
    pub is_joined: bool,
}

impl Polygon {
    /// For each vertex, an identifier that is unique in the tetrahedron.
    pub fn ids(&self) -> impl Iterator<Item = (u8, [u16; 3])> {
        self.vertices.iter().map(|vertex| (vertex.between, vertex.parts))
    }

    /// The same polygon as seen from the back.
    fn turned(self) -> Self {
        let count = self.vertices.len();
        let vertex = |k: usize| {
            let next = self.vertices[(2 * count - k - 2) % count].next;
            Vertex { next, ..self.vertices[count - k - 1] }
        };
        Self { vertices: (0..count).map(vertex).collect(), ..self }
    }
}

/// Signs of parts.
type Signs = Vec<(u16, Ordering)>;

/// All four corners.
const ALL: u8 = 0b1111;

impl Linear {
    /// Creates linear functions from the parts' numbers and their values at the corners.
    pub fn new(corners: [u32; 4], parts: impl Iterator<Item = (u16, [f64; 4])>) -> Self {
        // Products of four values neither overflow nor vanish.
        let scaled = |(part, values): (u16, [f64; 4])| (part, values.map(|v| v * scale(&values)));
        Self { corners, parts: parts.map(scaled).collect(), is_uncertain: Cell::new(false) }
    }

    /// Returns whether rounding may have changed a polygon that was computed.
    pub fn is_uncertain(&self) -> bool {
        self.is_uncertain.get()
    }

    fn values(&self, part: u16) -> Option<&[f64; 4]> {
        self.parts.iter().find(|(number, _)| *number == part).map(|(_, values)| values)
    }

    /// The polygons in which the choice is 0. On their front side, it is above 0. `is_positive`
    /// tells the orientation of the corners.
    pub fn zeros(&self, choice: &Choice, is_positive: bool) -> SmallVec<[Polygon; 1]> {
        let sections =
            self.parts.iter().filter_map(|(part, values)| self.section(*part, values, is_positive));
        let is_both = |(part, _): &(u16, [f64; 4])| Side::of(*part, choice) == Side::Both;
        let is_two_sided = self.parts.len() > 1 && self.parts.iter().any(is_both);
        // On a section, one part is 0. So is the choice where the other parts leave it at 0.
        let zeros = |section: Polygon| match choice {
            Choice::Part(_) => smallvec![section],
            Choice::Opposite(_) => smallvec![section.turned()],
            several => {
                // On the back of a section, the part is below 0, and the choice may be above 0.
                let part = section.part;
                let is_turned = |(_, signs): &(Polygon, Signs)| {
                    let behind = |(one, sign): &(u16, Ordering)| {
                        (*one, if *one == part { Ordering::Less } else { *sign })
                    };
                    let behind: Signs = signs.iter().map(behind).collect();
                    sign_of(several, &behind) == Some(Ordering::Greater)
                };
                let pieces = self.cut_by_sign(several, section, Ordering::Equal);
                let (turned, others): (Vec<_>, Vec<_>) = pieces.into_iter().partition(is_turned);
                let of = |pieces: Vec<(Polygon, Signs)>| {
                    let pieces = pieces.into_iter().map(|(piece, _)| piece);
                    merged(pieces.collect(), is_two_sided)
                };
                let mut all = of(others);
                all.extend(of(turned).into_iter().map(Polygon::turned));
                all
            }
        };
        sections.flat_map(zeros).collect()
    }

    /// The polygons of a face in which the choice is below 0, or the whole face if no part matters.
    /// `face` has the corners in their order as seen from in front.
    pub fn face(&self, choice: &Choice, face: [u32; 3]) -> SmallVec<[Polygon; 1]> {
        let bit = |corner: u32| -> u8 {
            1 << self.corners.iter().position(|one| *one == corner).expect("a corner")
        };
        let bits = face.map(bit);
        let vertex = |k: usize| {
            let mut weights = [0.0; 4];
            weights[bits[k].trailing_zeros() as usize] = 1.0;
            let next = Line::Side(bits[k] | bits[(k + 1) % 3]);
            Vertex { between: bits[k], parts: [NO_PART; 3], weights, errors: [0.0; 4], next }
        };
        let polygon = Polygon {
            vertices: [0, 1, 2].map(vertex).into_iter().collect(),
            between: bits[0] | bits[1] | bits[2],
            part: NO_PART,
            is_joined: false,
        };
        if self.parts.is_empty() {
            return smallvec![polygon];
        }
        let pieces = self.cut_by_sign(choice, polygon, Ordering::Less);
        merged(pieces.into_iter().map(|(piece, _)| piece).collect(), false)
    }

    /// The polygon in which a part is 0.
    fn section(&self, part: u16, values: &[f64; 4], is_positive: bool) -> Option<Polygon> {
        // Even permutations of the corners, which keep the orientation.
        const FIRST: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]];
        const PAIRS: [[usize; 4]; 6] =
            [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];
        let inside = values.map(|value| value < 0.0);
        let mut edges: SmallVec<[[usize; 2]; 4]> = match inside.iter().filter(|one| **one).count() {
            count @ (1 | 3) => {
                let lone = inside.iter().position(|one| *one == (count == 1))?;
                let [a, b, c, d] = FIRST[lone];
                let edges = [[a, b], [a, c], [a, d]];
                if count == 1 {
                    edges.into_iter().collect()
                } else {
                    edges.into_iter().rev().collect()
                }
            }
            2 => {
                let [a, b, c, d] = *PAIRS.iter().find(|pair| inside[pair[0]] && inside[pair[1]])?;
                smallvec![[a, c], [a, d], [b, d], [b, c]]
            }
            _ => return None,
        };
        if !is_positive {
            edges.reverse();
        }
        let vertices = (0..edges.len())
            .map(|k| {
                let bits = |[a, b]: [usize; 2]| 1 << a | 1 << b;
                let (here, next) = (bits(edges[k]), bits(edges[(k + 1) % edges.len()]));
                self.vertex(here, &[part], Line::Side(here | next))
            })
            .collect();
        Some(Polygon { vertices, between: ALL, part, is_joined: false })
    }

    /// The vertex at which the given parts are 0. It lies in the simplex of the corners in the bit
    /// set `between`. The edge that follows it lies on the line `next`.
    fn vertex(&self, between: u8, parts: &[u16], next: Line) -> Vertex {
        let count = parts.len();
        let mut key = [NO_PART; 3];
        key[..count].copy_from_slice(parts);
        key[..count].sort_unstable();
        // The values of each part at the corners in use.
        let mut rows = [[0.0; 4]; 3];
        for (row, part) in rows.iter_mut().zip(&key[..count]) {
            let values = self.values(*part).unwrap_or(&[f64::NAN; 4]);
            for (to, from) in row.iter_mut().zip(bits_of(between)) {
                *to = values[from];
            }
        }
        // Each part's values, weighted by the cofactors, add up to 0.
        let mut cofactors = [(0.0, 0.0); 4];
        for (k, cofactor) in cofactors[..=count].iter_mut().enumerate() {
            let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            let value = sign * minor(&rows, count, k, |a, b| a - b);
            let terms = match count {
                0 | 1 => value.abs(),
                _ => minor(&rows, count, k, |a, b| a.abs() + b.abs()),
            };
            *cofactor = (value, ROUNDING * terms);
        }
        let sum: f64 = cofactors.iter().map(|(cofactor, _)| cofactor).sum();
        let error: f64 =
            cofactors.iter().map(|(cofactor, error)| error + ROUNDING * cofactor.abs()).sum();
        let (mut weights, mut errors) = ([0.0; 4], [0.0; 4]);
        for (to, (cofactor, own)) in bits_of(between).zip(cofactors) {
            let weight = cofactor / sum;
            weights[to] = weight;
            errors[to] = if 2.0 * error < sum.abs() {
                2.0 * (own + weight.abs() * error) / sum.abs() + ROUNDING * weight.abs()
            } else {
                f64::INFINITY
            };
        }
        Vertex { between, parts: key, weights, errors, next }
    }

    /// The vertex's key, and the weights of its corners.
    fn key(&self, vertex: &Vertex) -> (VertexKey, [f64; 4]) {
        let (mut corners, mut weights) = ([NO_CORNER; 4], [0.0; 4]);
        for (to, from) in bits_of(vertex.between).enumerate() {
            (corners[to], weights[to]) = (self.corners[from], vertex.weights[from]);
        }
        (VertexKey { corners, parts: vertex.parts }, weights)
    }

    /// The keys of a polygon's vertices.
    pub fn keys(&self, polygon: &Polygon) -> impl Iterator<Item = (VertexKey, [f64; 4])> {
        polygon.vertices.iter().map(|vertex| self.key(vertex))
    }

    /// Cuts a polygon along the zeros of all parts. Returns the pieces in which the choice has this
    /// sign, with the signs of the parts.
    fn cut_by_sign(
        &self,
        choice: &Choice,
        polygon: Polygon,
        sign: Ordering,
    ) -> Vec<(Polygon, Signs)> {
        let mut pieces = vec![(polygon, Signs::new())];
        for (part, values) in &self.parts {
            let whole = std::mem::take(&mut pieces);
            for (polygon, signs) in whole {
                let with = |sign: Ordering| {
                    let mut signs: Signs = signs.clone();
                    signs.push((*part, sign));
                    signs
                };
                if *part == polygon.part {
                    let signs = with(Ordering::Equal);
                    pieces.push((polygon, signs));
                    continue;
                }
                for sign in [Ordering::Less, Ordering::Greater] {
                    let piece = self.cut(&polygon, *part, values, sign == Ordering::Less);
                    pieces.extend(piece.map(|piece| (piece, with(sign))));
                }
            }
        }
        let has_sign = |signs: &[(u16, Ordering)]| sign_of(choice, signs) == Some(sign);
        pieces.retain(|(_, signs)| has_sign(signs));
        pieces
    }

    /// The piece of a polygon where a part is below 0, or is not if `is_below` is false.
    fn cut(
        &self,
        polygon: &Polygon,
        part: u16,
        values: &[f64; 4],
        is_below: bool,
    ) -> Option<Polygon> {
        let is_kept = |vertex: &Vertex| {
            let sum = |of: &dyn Fn(usize) -> f64| -> f64 { (0..4).map(of).sum() };
            let value = sum(&|k| vertex.weights[k] * values[k]);
            let error =
                sum(&|k| (vertex.errors[k] + ROUNDING * vertex.weights[k].abs()) * values[k].abs());
            // NaN is not above.
            let is_certain = value.abs() > error;
            self.is_uncertain.set(self.is_uncertain.get() || !is_certain);
            (value < 0.0) == is_below
        };
        let kept: Vec<bool> = polygon.vertices.iter().map(is_kept).collect();
        if kept.iter().all(|kept| *kept) {
            return Some(polygon.clone());
        }
        let mut left = SmallVec::new();
        for (k, vertex) in polygon.vertices.iter().enumerate() {
            let next = (k + 1) % kept.len();
            let crossing = |line: Line| {
                let (between, mut parts) = match vertex.next {
                    Line::Side(side) => (side, vec![part]),
                    Line::Part(other) => (polygon.between, vec![part, other]),
                };
                if polygon.part != NO_PART {
                    parts.push(polygon.part);
                }
                self.vertex(between, &parts, line)
            };
            match (kept[k], kept[next]) {
                (true, true) => left.push(*vertex),
                (true, false) => left.extend([*vertex, crossing(Line::Part(part))]),
                (false, true) => left.push(crossing(vertex.next)),
                (false, false) => {}
            }
        }
        (left.len() >= 3).then_some(Polygon { vertices: left, ..*polygon })
    }
}

/// The sign of a choice, computed from the signs of its parts. `None` if none of the parts matters.
fn sign_of(choice: &Choice, signs: &[(u16, Ordering)]) -> Option<Ordering> {
    let each = |all: &[Choice]| -> Vec<Ordering> {
        all.iter().filter_map(|one| sign_of(one, signs)).collect()
    };
    match choice {
        Choice::Part(part) => {
            signs.iter().find(|(one, _)| usize::from(*one) == *part).map(|(_, sign)| *sign)
        }
        Choice::Opposite(part) => sign_of(&Choice::Part(*part), signs).map(Ordering::reverse),
        Choice::Min(all) => each(all).into_iter().min(),
        Choice::Max(all) => each(all).into_iter().max(),
    }
}

/// The positions of the set bits.
fn bits_of(bits: u8) -> impl Iterator<Item = usize> {
    (0..4).filter(move |k| bits >> k & 1 == 1)
}

/// A power of two by which the largest of some values becomes about 1. 1 if it is not normal.
fn scale(values: &[f64; 4]) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    let largest = values.iter().fold(0.0_f64, |all, value| all.max(value.abs()));
    if !largest.is_normal() || largest > 1e300 {
        return 1.0;
    }
    1.0 / f64::from_bits(largest.to_bits() & EXPONENT)
}

/// If `minus` subtracts, the determinant of the first `count` rows and as many columns, without
/// column `left_out`. If `minus` adds absolute values, the sum of the terms' absolute values.
fn minor(
    rows: &[[f64; 4]; 3],
    count: usize,
    left_out: usize,
    minus: impl Fn(f64, f64) -> f64,
) -> f64 {
    let at = |row: usize, column: usize| rows[row][column + usize::from(column >= left_out)];
    let pair = |i: usize, j: usize| minus(at(1, i) * at(2, j), at(1, j) * at(2, i));
    match count {
        0 => 1.0,
        1 => at(0, 0),
        2 => minus(at(0, 0) * at(1, 1), at(0, 1) * at(1, 0)),
        _ => {
            let first = minus(at(0, 0) * pair(1, 2), at(0, 1) * pair(0, 2));
            minus(first, -(at(0, 2) * pair(0, 1)))
        }
    }
}

/// Pieces of one polygon, joined along the edges that they share. A vertex in the middle of a line
/// is left out, since neighbors do not have it. Where the choice has a part and its opposite,
/// neighbors may have it if three parts are 0 there.
fn merged(pieces: SmallVec<[Polygon; 1]>, is_two_sided: bool) -> SmallVec<[Polygon; 1]> {
    if pieces.len() < 2 {
        return pieces;
    }
    let id = |vertex: &Vertex| (vertex.between, vertex.parts);
    // Each edge with the number of its piece.
    let mut edges: Vec<(Vertex, Vertex, usize)> = Vec::new();
    for (number, piece) in pieces.iter().enumerate() {
        for (k, vertex) in piece.vertices.iter().enumerate() {
            let next = piece.vertices[(k + 1) % piece.vertices.len()];
            let back =
                |(a, b, _): &(Vertex, Vertex, usize)| id(a) == id(&next) && id(b) == id(vertex);
            match edges.iter().position(back) {
                Some(position) => drop(edges.swap_remove(position)),
                None => edges.push((*vertex, next, number)),
            }
        }
    }
    let mut loops = SmallVec::new();
    while let Some((first, mut end, mut piece)) = edges.pop() {
        let mut vertices = vec![first];
        while id(&end) != id(&first) {
            // Two pieces may meet in a vertex alone. Then each goes on with its own edge.
            let follows = |(from, _, _): &(Vertex, Vertex, usize)| id(from) == id(&end);
            let is_own = |edge: &(Vertex, Vertex, usize)| follows(edge) && edge.2 == piece;
            let own = edges.iter().position(is_own);
            let Some(position) = own.or_else(|| edges.iter().position(follows)) else {
                return pieces;
            };
            let from;
            (from, end, piece) = edges.swap_remove(position);
            vertices.push(from);
        }
        let is_bend = |k: &usize| {
            let before = vertices[(k + vertices.len() - 1) % vertices.len()];
            let is_corner = is_two_sided && !vertices[*k].parts.contains(&NO_PART);
            before.next != vertices[*k].next || is_corner
        };
        let vertices: SmallVec<[Vertex; 4]> =
            (0..vertices.len()).filter(is_bend).map(|k| vertices[k]).collect();
        if vertices.len() >= 3 {
            loops.push(Polygon { vertices, is_joined: true, ..pieces[0] });
        }
    }
    loops
}
