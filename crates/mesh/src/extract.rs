//! The triangles of a mesh: polygons in tetrahedra, with vertices moved onto the surface.
//!
//! The mesh of a solid also covers its part of the domain's boundary.

use crate::cells::Question;
use crate::grid::{Corner, Grid};
use crate::place::Vertices;
use crate::polygon::{Linear, NO_PART};
use crate::refine::{Kind, Leaf, Refined};
use crate::space::Space;
use glam::DVec3;
use smallvec::SmallVec;
use zeroset_eval::KernelError;

/// Vertices and triangles.
#[derive(Default)]
pub struct Extracted {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// For each vertex, whether a part is 0 there that cuts the surface.
    pub is_cut: Vec<bool>,
}

/// The mesh in the leaves of a grid. For an equation, triangles where the function jumps or ends
/// are left out: there is no zero.
pub fn extract(
    refined: &Refined,
    grid: &Grid,
    question: &Question<'_>,
) -> Result<Extracted, KernelError> {
    let &Question { parts: kernels, space, is_solid, first_cut, .. } = question;
    let mut vertices = Vertices::default();
    let mut polygons: Vec<Numbered> = Vec::new();
    for leaf in &refined.leaves {
        add_leaf(leaf, refined, question, &mut vertices, &mut polygons);
    }
    let at = |corner: u32| space.at(grid.corners[corner as usize]);
    let at_zero = vertices.place(refined, kernels, &at)?;
    let cuts = |part: &u16| *part != NO_PART && usize::from(*part) >= first_cut;
    let is_cut = vertices.keys.iter().map(|key| key.parts.iter().any(cuts)).collect();
    let mut mesh = Extracted { vertices: vertices.places, triangles: Vec::new(), is_cut };
    for polygon in polygons {
        if is_solid || polygon.vertices.iter().all(|vertex| at_zero[*vertex as usize]) {
            mesh.add(&polygon);
        }
    }
    mesh.keep_used();
    Ok(mesh)
}

/// From in front, the corners of the face opposite each corner.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// A polygon by the numbers of its vertices.
struct Numbered {
    vertices: SmallVec<[u32; 4]>,
    is_joined: bool,
}

/// Adds the polygons in a leaf, and their vertices.
fn add_leaf(
    leaf: &Leaf,
    refined: &Refined,
    question: &Question<'_>,
    vertices: &mut Vertices,
    polygons: &mut Vec<Numbered>,
) {
    let &Question { space, is_solid, first_cut, .. } = question;
    let mut positive = [0, 1, 2, 3].map(|k| (leaf.cell.numbers[k], leaf.cell.corners[k]));
    if !leaf.cell.is_positive() {
        positive.swap(2, 3);
    }
    let mut corners = positive.map(|(number, _)| number);
    corners.sort_unstable();
    let parts = match &leaf.kind {
        Kind::Open { local, .. } => &local.parts[..],
        Kind::Inside(_) => &[],
    };
    let values = |part: u16| corners.map(|corner| refined.values.at(corner, part));
    let parts = parts.iter().map(|part| (part.part, values(part.part))).collect();
    let (linear, choice) = (Linear { corners, parts }, leaf.choice());
    let mut found = linear.zeros(choice, is_even(positive.map(|(number, _)| number), corners));
    found.retain(|polygon| usize::from(polygon.part) < first_cut);
    if is_solid {
        let faces = FACES.map(|face| face.map(|k| positive[k]));
        let is_outside = |face: &[(u32, Corner); 3]| is_outside(space, face.map(|(_, at)| at));
        for face in faces.into_iter().filter(is_outside) {
            found.extend(linear.face(choice, face.map(|(number, _)| number)));
        }
    }
    for polygon in found {
        let keys = linear.keys(&polygon);
        let number = |(key, weights)| vertices.number(key, weights, choice);
        let is_joined = polygon.is_joined;
        polygons.push(Numbered { vertices: keys.map(number).collect(), is_joined });
    }
}

/// Returns whether one order of four corners is an even permutation of another.
fn is_even(from: [u32; 4], to: [u32; 4]) -> bool {
    let place = from.map(|corner| to.iter().position(|one| *one == corner));
    let swaps = (0..4).flat_map(|k| (0..k).map(move |j| (j, k)));
    swaps.filter(|(j, k)| place[*j] > place[*k]).count() % 2 == 0
}

/// Returns whether a face is on the boundary of the domain.
fn is_outside(space: &Space, face: [Corner; 3]) -> bool {
    let on = face.map(|corner| space.faces(corner));
    let at = face.map(Corner::coordinates);
    (0..3).any(|axis| on.iter().all(|on| on[axis]) && at.iter().all(|one| one[axis] == at[0][axis]))
}

/// A point inside a polygon from which all of it is seen, if there is one.
fn middle(polygon: &[DVec3]) -> DVec3 {
    let next = |k: usize| polygon[(k + 1) % polygon.len()];
    let normal: DVec3 = (0..polygon.len()).map(|k| polygon[k].cross(next(k))).sum();
    let mean = |points: &[DVec3]| points.iter().sum::<DVec3>() / points.len() as f64;
    // All of it is seen from the points that are on the inner side of each edge's line.
    let mut seen = polygon.to_vec();
    for (k, from) in polygon.iter().enumerate() {
        let inward = normal.cross(next(k) - from);
        let depth = |point: DVec3| (point - from).dot(inward);
        let mut left = Vec::with_capacity(seen.len() + 1);
        for (j, point) in seen.iter().enumerate() {
            let after = seen[(j + 1) % seen.len()];
            let (here, there) = (depth(*point), depth(after));
            if here >= 0.0 {
                left.push(*point);
            }
            if (here > 0.0 && there < 0.0) || (here < 0.0 && there > 0.0) {
                left.push(point.lerp(after, here / (here - there)));
            }
        }
        seen = left;
    }
    if seen.len() < 3 { mean(polygon) } else { mean(&seen) }
}

impl Extracted {
    /// Adds the triangles of a polygon.
    fn add(&mut self, polygon: &Numbered) {
        let Numbered { vertices: polygon, is_joined } = polygon;
        if *is_joined && polygon.len() > 3 {
            // Two of its vertices may be on one face of the tetrahedron, where a neighbor may have
            // an edge between them. So all triangles meet in the middle.
            let places = polygon.iter().map(|vertex| self.vertices[*vertex as usize]);
            let place = middle(&places.collect::<Vec<DVec3>>());
            let middle = self.vertices.len() as u32;
            self.vertices.push(place);
            self.is_cut.push(false);
            for (k, vertex) in polygon.iter().enumerate() {
                self.triangles.push([middle, *vertex, polygon[(k + 1) % polygon.len()]]);
            }
            return;
        }
        let at = |k: usize| self.vertices[polygon[k % polygon.len()] as usize];
        let count = polygon.len();
        // The fan whose least triangle is largest: a negative one would be turned over.
        let normal: DVec3 = (0..count).map(|k| at(k).cross(at(k + 1))).sum();
        let worst = |first: usize| {
            let area = |k: usize| {
                let (a, b, c) = (at(first), at(first + k), at(first + k + 1));
                (b - a).cross(c - a).dot(normal)
            };
            (1..count - 1).map(area).fold(f64::INFINITY, f64::min)
        };
        let first = (0..count).max_by(|a, b| worst(*a).total_cmp(&worst(*b))).unwrap_or(0);
        for k in 1..count - 1 {
            let [b, c] = [k, k + 1].map(|k| polygon[(first + k) % count]);
            self.triangles.push([polygon[first], b, c]);
        }
    }

    /// Removes vertices without a triangle.
    fn keep_used(&mut self) {
        let mut numbers = vec![u32::MAX; self.vertices.len()];
        let (mut kept, mut is_cut) = (Vec::new(), Vec::new());
        for vertex in self.triangles.as_flattened_mut() {
            let number = &mut numbers[*vertex as usize];
            if *number == u32::MAX {
                *number = kept.len() as u32;
                kept.push(self.vertices[*vertex as usize]);
                is_cut.push(self.is_cut[*vertex as usize]);
            }
            *vertex = *number;
        }
        (self.vertices, self.is_cut) = (kept, is_cut);
    }
}
