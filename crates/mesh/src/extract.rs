//! The triangles of a mesh, from the signs at the corners of tetrahedra.
//!
//! A tetrahedron whose corners have both signs is cut along a triangle or a quadrilateral, with a
//! vertex on each edge that changes sign. Neighbors share faces, so they share vertices, too. The
//! mesh of a solid also covers its part of the domain's boundary.

use crate::grid::{Corner, CornerMap};
use crate::refine::{Kind, Leaf, Refined, sample};
use crate::space::Space;
use glam::DVec3;
use zeroset_eval::{Kernel, Sample};

/// Number of times that a bracket on an edge is narrowed.
const NARROWINGS: usize = 48;
/// A bracket of this share of its edge is not narrowed further.
const NARROW: f64 = 1e-12;
/// Least share of an edge between a vertex and a corner, so that triangles have an area.
const APART: f64 = 1e-4;
/// The function jumps on an edge if its values on both sides of the narrowed bracket differ by more
/// than this share of those at the corners.
const JUMP: f64 = 1e-3;

/// Vertices and triangles.
#[derive(Default)]
pub struct Triangles {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// For each triangle, the leaf it was made from.
    pub leaves: Vec<u32>,
}

/// Returns whether a corner is inside. Undefined values are outside.
fn is_inside(value: f64) -> bool {
    value < 0.0
}

/// The vertices on edges and at corners, by number.
struct Vertices<'a> {
    values: &'a CornerMap<Corner, f64>,
    edges: CornerMap<(Corner, Corner), u32>,
    corners: CornerMap<Corner, u32>,
    /// The ends of each vertex's edge. Equal for a corner.
    ends: Vec<[Corner; 2]>,
}

impl Vertices<'_> {
    /// The vertex on the edge between two corners.
    fn on_edge(&mut self, a: Corner, b: Corner) -> u32 {
        let ends = [a.min(b), a.max(b)];
        *self.edges.entry(ends.into()).or_insert_with(|| {
            self.ends.push(ends);
            (self.ends.len() - 1) as u32
        })
    }

    /// The vertex at a corner.
    fn at_corner(&mut self, corner: Corner) -> u32 {
        *self.corners.entry(corner).or_insert_with(|| {
            self.ends.push([corner; 2]);
            (self.ends.len() - 1) as u32
        })
    }

    /// The polygons of the surface in a tetrahedron, with the outside in front.
    fn surface(&mut self, leaf: &Leaf, add: &mut impl FnMut(&[u32])) {
        // Even permutations of the corners, which keep the orientation. Each moves another corner
        // or pair of corners to the front.
        const FIRST: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]];
        const PAIRS: [[usize; 4]; 6] =
            [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];
        let mut corners = leaf.cell.corners;
        if !leaf.cell.is_positive() {
            corners.swap(2, 3);
        }
        let inside = corners.map(|corner| is_inside(self.values[&corner]));
        let edge = |this: &mut Self, a: usize, b: usize| this.on_edge(corners[a], corners[b]);
        match inside.iter().filter(|inside| **inside).count() {
            count @ (1 | 3) => {
                let [a, b, c, d] =
                    FIRST[inside.iter().position(|one| *one == (count == 1)).unwrap_or(0)];
                let (b, d) = if count == 1 { (b, d) } else { (d, b) };
                let polygon = [b, c, d].map(|to| edge(self, a, to));
                add(&polygon);
            }
            2 => {
                let is_pair = |pair: &&[usize; 4]| inside[pair[0]] && inside[pair[1]];
                if let Some(&[a, b, c, d]) = PAIRS.iter().find(is_pair) {
                    let polygon = [(a, c), (a, d), (b, d), (b, c)].map(|(a, b)| edge(self, a, b));
                    add(&polygon);
                }
            }
            _ => {}
        }
    }

    /// The solid's parts of those faces of a tetrahedron that are on the boundary of the domain.
    fn caps(&mut self, leaf: &Leaf, space: &Space, add: &mut impl FnMut(&[u32])) {
        const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
        let mut corners = leaf.cell.corners;
        if !leaf.cell.is_positive() {
            corners.swap(2, 3);
        }
        for face in FACES {
            let face = face.map(|k| corners[k]);
            let on = face.map(|corner| space.faces(corner));
            let places = face.map(Corner::coordinates);
            let is_outside = (0..3).any(|axis| {
                on.iter().all(|on| on[axis]) && places.iter().all(|at| at[axis] == places[0][axis])
            });
            if !is_outside {
                continue;
            }
            let mut polygon = Vec::with_capacity(4);
            for k in 0..3 {
                let (corner, next) = (face[k], face[(k + 1) % 3]);
                let [here, there] = [corner, next].map(|corner| is_inside(self.values[&corner]));
                if here {
                    polygon.push(self.at_corner(corner));
                }
                if here != there {
                    polygon.push(self.on_edge(corner, next));
                }
            }
            if !polygon.is_empty() {
                add(&polygon);
            }
        }
    }

    /// Places all vertices. Returns, for each, whether it is at a zero: the function is continuous
    /// there, or the vertex is a corner.
    fn place(&self, samples: &dyn Kernel<Sample, f64>, space: &Space) -> (Vec<DVec3>, Vec<bool>) {
        let ends: Vec<[DVec3; 2]> =
            self.ends.iter().map(|ends| ends.map(|corner| space.at(corner))).collect();
        // For each edge, the bracket from inside to outside as shares of the edge, and the values.
        let mut brackets: Vec<([f64; 2], [f64; 2])> = self
            .ends
            .iter()
            .map(|ends| {
                let values = ends.map(|corner| self.values[&corner]);
                if is_inside(values[0]) {
                    ([0.0, 1.0], values)
                } else {
                    ([1.0, 0.0], [values[1], values[0]])
                }
            })
            .collect();
        let mut open: Vec<usize> =
            (0..ends.len()).filter(|k| self.ends[*k][0] != self.ends[*k][1]).collect();
        let scale: Vec<f64> = brackets.iter().map(|(_, [a, b])| b - a).collect();
        for round in 0..NARROWINGS {
            let next = |k: &usize| {
                let ([from, to], [inside, outside]) = brackets[*k];
                let linear = inside / (inside - outside);
                // The linear guess is moved toward the middle, so that both ends come nearer.
                let pull = if round % 3 == 2 { 0.5 } else { 0.02 };
                let share = if linear.is_finite() { linear + pull * (0.5 - linear) } else { 0.5 };
                from + share * (to - from)
            };
            let places: Vec<f64> = open.iter().map(next).collect();
            let points: Vec<DVec3> =
                open.iter().zip(&places).map(|(k, t)| ends[*k][0].lerp(ends[*k][1], *t)).collect();
            for ((k, t), value) in open.iter().zip(&places).zip(sample(samples, &points)) {
                let side = usize::from(!is_inside(value));
                let (bracket, values) = &mut brackets[*k];
                (bracket[side], values[side]) = (*t, value);
            }
            open.retain(|k| {
                let [from, to] = brackets[*k].0;
                (to - from).abs() > NARROW
            });
            if open.is_empty() {
                break;
            }
        }
        let placed = brackets.iter().zip(&ends).zip(&scale).zip(&self.ends);
        placed
            .map(|((((bracket, [inside, outside]), [a, b]), scale), corners)| {
                if corners[0] == corners[1] {
                    return (*a, true);
                }
                let middle = bracket[0].midpoint(bracket[1]);
                let at = a.lerp(*b, middle.clamp(APART, 1.0 - APART));
                let jumps = !(outside - inside <= JUMP * scale);
                (at, !jumps)
            })
            .unzip()
    }
}

/// The mesh in the leaves of a grid. For an equation, triangles where the function jumps or ends are
/// left out: there is no zero.
pub fn extract(
    refined: &Refined,
    samples: &dyn Kernel<Sample, f64>,
    space: &Space,
    is_solid: bool,
) -> Triangles {
    let mut vertices = Vertices {
        values: &refined.values,
        edges: CornerMap::default(),
        corners: CornerMap::default(),
        ends: Vec::new(),
    };
    let mut polygons: Vec<(u32, Vec<u32>)> = Vec::new();
    for (number, leaf) in refined.leaves.iter().enumerate() {
        let mut add = |polygon: &[u32]| polygons.push((number as u32, polygon.to_vec()));
        if let Kind::Open { .. } = leaf.kind {
            vertices.surface(leaf, &mut add);
        }
        if is_solid {
            vertices.caps(leaf, space, &mut add);
        }
    }
    let (places, at_zero) = vertices.place(samples, space);
    let mut mesh = Triangles { vertices: places, ..Triangles::default() };
    for (leaf, polygon) in polygons {
        if !is_solid && !polygon.iter().all(|vertex| at_zero[*vertex as usize]) {
            continue;
        }
        mesh.add(&polygon, leaf);
    }
    mesh.keep_used();
    mesh
}

impl Triangles {
    /// Adds a triangle, or a quadrilateral as two triangles along its shorter diagonal.
    fn add(&mut self, polygon: &[u32], leaf: u32) {
        let at = |k: usize| self.vertices[polygon[k] as usize];
        let parts: &[[usize; 3]] = if polygon.len() < 4 {
            &[[0, 1, 2]]
        } else if at(0).distance_squared(at(2)) <= at(1).distance_squared(at(3)) {
            &[[0, 1, 2], [0, 2, 3]]
        } else {
            &[[0, 1, 3], [1, 2, 3]]
        };
        for part in parts {
            self.triangles.push(part.map(|k| polygon[k]));
            self.leaves.push(leaf);
        }
    }

    /// Removes vertices without a triangle.
    fn keep_used(&mut self) {
        let mut numbers = vec![u32::MAX; self.vertices.len()];
        let mut kept = Vec::new();
        for vertex in self.triangles.as_flattened_mut() {
            let number = &mut numbers[*vertex as usize];
            if *number == u32::MAX {
                *number = kept.len() as u32;
                kept.push(self.vertices[*vertex as usize]);
            }
            *vertex = *number;
        }
        self.vertices = kept;
    }
}
