//! The triangles of a mesh: polygons in tetrahedra, with vertices moved onto the surface.
//!
//! The mesh of a solid also covers its part of the domain's boundary.

use crate::cells::{PartKernels, Question};
use crate::grid::{Corner, Grid};
use crate::polygon::{Linear, NO_PART, VertexKey};
use crate::refine::{Kind, Leaf, Refined, sample};
use crate::space::Space;
use glam::{DMat3, DVec3};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use zeroset_eval::{Gradients, KernelError, Points};

/// Number of times that a bracket on an edge is narrowed.
const NARROWINGS: usize = 48;
/// A bracket of this share of its edge is not narrowed further.
const NARROW: f64 = 1e-12;
/// Least weight of a corner in a vertex, so that triangles have an area.
const APART: f64 = 1e-4;
/// The function jumps on an edge if its values on both sides of the narrowed bracket differ by more
/// than this share of those at the corners.
const JUMP: f64 = 1e-3;
/// Number of steps of Newton's method for a vertex where several parts are 0.
const STEPS: usize = 6;

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
    let &Question { parts: kernels, space, is_solid, first_cut } = question;
    let mut vertices = Vertices::default();
    let mut polygons: Vec<Numbered> = Vec::new();
    for leaf in &refined.leaves {
        vertices.add_leaf(leaf, refined, question, &mut polygons);
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

#[derive(Default)]
struct Vertices {
    numbers: FxHashMap<VertexKey, u32>,
    keys: Vec<VertexKey>,
    weights: Vec<[f64; 4]>,
    places: Vec<DVec3>,
}

impl Vertices {
    fn add_leaf(
        &mut self,
        leaf: &Leaf,
        refined: &Refined,
        question: &Question<'_>,
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
            let number = |(key, weights)| self.number(key, weights);
            let vertices = keys.map(number).collect();
            polygons.push(Numbered { vertices, is_joined: polygon.is_joined });
        }
    }

    fn number(&mut self, key: VertexKey, weights: [f64; 4]) -> u32 {
        *self.numbers.entry(key).or_insert_with(|| {
            self.keys.push(key);
            self.weights.push(weights);
            (self.keys.len() - 1) as u32
        })
    }

    /// Places all vertices. Returns, for each, whether it is at a zero: no part jumps there.
    fn place(
        &mut self,
        refined: &Refined,
        kernels: &[PartKernels<'_>],
        at: &dyn Fn(u32) -> DVec3,
    ) -> Result<Vec<bool>, KernelError> {
        let place = |(key, weights): (&VertexKey, &[f64; 4])| {
            let corners = key.corners();
            let weights = apart(weights, corners.len());
            corners.iter().zip(weights).map(|(corner, weight)| at(*corner) * weight).sum()
        };
        self.places = self.keys.iter().zip(&self.weights).map(place).collect();
        let mut at_zero = vec![true; self.keys.len()];
        let mut sorted: Vec<usize> = (0..self.keys.len()).collect();
        sorted.sort_by_key(|k| self.keys[*k].parts);
        let groups = sorted.chunk_by(|a, b| self.keys[*a].parts == self.keys[*b].parts);
        let groups: Vec<&[usize]> = groups.collect();
        for some in groups {
            let parts = self.keys[some[0]].parts;
            let vanishing = parts.iter().filter(|part| **part != NO_PART);
            let vanishing: Vec<&PartKernels<'_>> =
                vanishing.map(|part| &kernels[usize::from(*part)]).collect();
            match &vanishing[..] {
                // A corner of the grid stays in its place.
                [] => {}
                [only] => self.place_on_edges(some, refined, only, at, &mut at_zero),
                several => {
                    for vertex in some {
                        let corners = self.keys[*vertex].corners().iter();
                        let corners: SmallVec<[DVec3; 4]> = corners.map(|c| at(*c)).collect();
                        let start = self.places[*vertex];
                        self.places[*vertex] = common_zero(several, &corners, start)?;
                    }
                }
            }
        }
        Ok(at_zero)
    }

    /// Moves vertices on edges to the zeros of a part.
    fn place_on_edges(
        &mut self,
        vertices: &[usize],
        refined: &Refined,
        kernels: &PartKernels<'_>,
        at: &dyn Fn(u32) -> DVec3,
        at_zero: &mut [bool],
    ) {
        struct Bracket {
            ends: [DVec3; 2],
            /// From below 0 to above, as shares of the edge, and the values there.
            shares: [f64; 2],
            values: [f64; 2],
            scale: f64,
        }
        let mut brackets: Vec<Bracket> = vertices
            .iter()
            .map(|k| {
                let VertexKey { parts: [part, ..], .. } = self.keys[*k];
                let corners = [0, 1].map(|end| self.keys[*k].corners()[end]);
                let mut values = corners.map(|corner| refined.values.at(corner, part));
                let mut shares = [0.0, 1.0];
                if !is_below(values[0]) {
                    values.reverse();
                    shares.reverse();
                }
                let ends = corners.map(at);
                Bracket { ends, shares, values, scale: values[1] - values[0] }
            })
            .collect();
        let mut open: Vec<usize> = (0..brackets.len()).collect();
        for round in 0..NARROWINGS {
            let next = |k: &usize| {
                let Bracket { shares: [from, to], values: [below, above], .. } = brackets[*k];
                let linear = below / (below - above);
                // The linear guess is moved toward the middle, so that both ends come nearer.
                let pull = if round % 3 == 2 { 0.5 } else { 0.02 };
                let share = if linear.is_finite() { linear + pull * (0.5 - linear) } else { 0.5 };
                from + share * (to - from)
            };
            let shares: Vec<f64> = open.iter().map(next).collect();
            let point =
                |(k, t): (&usize, &f64)| brackets[*k].ends[0].lerp(brackets[*k].ends[1], *t);
            let points: Vec<DVec3> = open.iter().zip(&shares).map(point).collect();
            let values = sample(kernels.samples, &points);
            for ((k, share), value) in open.iter().zip(&shares).zip(values) {
                let side = usize::from(!is_below(value));
                (brackets[*k].shares[side], brackets[*k].values[side]) = (*share, value);
            }
            open.retain(|k| {
                let [from, to] = brackets[*k].shares;
                (to - from).abs() > NARROW
            });
            if open.is_empty() {
                break;
            }
        }
        for (vertex, bracket) in vertices.iter().zip(brackets) {
            let share = bracket.shares[0].midpoint(bracket.shares[1]).clamp(APART, 1.0 - APART);
            self.places[*vertex] = bracket.ends[0].lerp(bracket.ends[1], share);
            // False for NaN, beyond which the part is undefined.
            at_zero[*vertex] = bracket.values[1] - bracket.values[0] <= JUMP * bracket.scale;
        }
    }
}

/// Returns whether a value is below 0. An undefined one is not.
fn is_below(value: f64) -> bool {
    value < 0.0
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

/// Weights of the first `count` corners, each kept away from 0 and 1.
fn apart(weights: &[f64; 4], count: usize) -> [f64; 4] {
    if count < 2 {
        return *weights;
    }
    let mut moved = [0.0; 4];
    let share = |weight: f64| if weight.is_finite() { weight.clamp(APART, 1.0) } else { 1.0 };
    let sum: f64 = weights[..count].iter().map(|weight| share(*weight)).sum();
    for k in 0..count {
        moved[k] = share(weights[k]) / sum;
    }
    moved
}

/// The point of a triangle or tetrahedron where two or three parts are 0, by Newton's method from
/// `start`. If it leaves the corners' hull, the last point inside.
fn common_zero(
    parts: &[&PartKernels<'_>],
    corners: &[DVec3],
    start: DVec3,
) -> Result<DVec3, KernelError> {
    let edges: Vec<DVec3> = corners[1..].iter().map(|corner| *corner - corners[0]).collect();
    let mut at = start;
    for _ in 0..STEPS {
        let points = &Points::near(&[at])[0];
        let mut rows = [DVec3::Z; 3];
        let mut rest = DVec3::ZERO;
        for (k, part) in parts.iter().enumerate() {
            let mut found = Gradients::<f64>::default();
            part.all.gradients()?.eval(points, &mut found);
            rest[k] = found.value[0];
            rows[k] = DVec3::from_array(found.gradient.each_ref().map(|axis| axis[0]));
        }
        if parts.len() == 2 {
            // In a triangle, the step is along its plane.
            rows[2] = edges[0].cross(edges[1]);
        }
        let step = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose().inverse() * rest;
        let next = at - step;
        if !next.is_finite() || !is_between(next, corners) {
            break;
        }
        at = next;
    }
    Ok(at)
}

/// Returns whether a point of a triangle's plane, or of space, is well inside the corners' hull.
fn is_between(point: DVec3, corners: &[DVec3]) -> bool {
    let side = |k: usize| corners[k] - corners[0];
    let third = if corners.len() == 4 { side(3) } else { side(1).cross(side(2)) };
    let basis = DMat3::from_cols(side(1), side(2), third).inverse();
    let weights = basis * (point - corners[0]);
    let used = &weights.to_array()[..corners.len() - 1];
    used.iter().all(|weight| *weight >= APART) && used.iter().sum::<f64>() <= 1.0 - APART
}

impl Extracted {
    /// Adds the triangles of a polygon.
    fn add(&mut self, polygon: &Numbered) {
        let Numbered { vertices: polygon, is_joined } = polygon;
        if *is_joined && polygon.len() > 3 {
            // Two of its vertices may be on one face of the tetrahedron, where a neighbor may have
            // an edge between them. So all triangles meet in the middle.
            let places = polygon.iter().map(|vertex| self.vertices[*vertex as usize]);
            let middle = self.vertices.len() as u32;
            self.vertices.push(places.sum::<DVec3>() / polygon.len() as f64);
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
