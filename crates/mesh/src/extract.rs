//! The triangles of a mesh: polygons in tetrahedra, with vertices moved onto the surface.
//!
//! The mesh of a solid also covers its part of the domain's boundary.

use crate::cells::Query;
use crate::embedding::{Triangle, least_distance};
use crate::grid::{Corner, Grid};
use crate::leaf::{Kind, Leaf};
use crate::place::Vertices;
use crate::polygon::{Linear, NO_PART, Polygon};
use crate::refine::{Refined, size};
use crate::space::Space;
use crate::values::keep_order;
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::SmallVec;
use zeroset_eval::KernelError;
use zeroset_scene::choices::Choice;

/// Vertices and triangles.
#[derive(Default)]
pub struct Extracted {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// For each vertex, whether a part that cuts the surface off is 0 there.
    pub is_cut: Vec<bool>,
    /// The leaves, as indices in [`Refined::leaves`], whose triangles are not proven to have the
    /// shape of g's zeros. See [`proof`](crate::proof) for g.
    pub unproven: Vec<usize>,
    /// For each triangle, the index of its leaf.
    pub leaves: Vec<usize>,
}

/// The mesh in the leaves of a grid. For an equation, there is no triangle where the function jumps
/// or ends, since it has no zero there.
pub fn extract(
    refined: &Refined,
    grid: &Grid,
    query: &Query<'_>,
) -> Result<Extracted, KernelError> {
    let &Query { space, is_solid, first_cut, .. } = query;
    let mut vertices = Vertices::default();
    let mut polygons: Vec<Numbered> = Vec::new();
    let (mut unproven, mut fixed) = (FxHashSet::default(), FxHashSet::default());
    for (number, leaf) in refined.leaves.iter().enumerate() {
        let added = add_leaf(number, leaf, refined, query, &mut vertices, &mut polygons);
        unproven.extend(added.is_uncertain.then_some(number));
        fixed.extend((!added.are_disks).then_some(number));
    }
    let at = |corner: u32| space.at(grid.corners[corner as usize]);
    let at_zero = vertices.place(refined, query, &at)?;
    if !is_solid {
        polygons.retain(|polygon| polygon.vertices.iter().all(|one| at_zero[*one as usize]));
    }
    let cuts = |part: &u16| *part != NO_PART && usize::from(*part) >= first_cut;
    let mut mesh = Extracted {
        vertices: std::mem::take(&mut vertices.places),
        is_cut: vertices.keys.iter().map(|key| key.parts.iter().any(cuts)).collect(),
        ..Extracted::default()
    };
    let zero = |vertex: u32| vertices.zero(vertex as usize, &at);
    restore(&mut mesh, &zero, &polygons, &fixed);
    // Leaves whose vertices have moved since the last check; `None` for all leaves.
    let mut changed: Option<FxHashSet<usize>> = None;
    while changed.as_ref().is_none_or(|leaves| !leaves.is_empty()) {
        mesh.set(&polygons, vertices.keys.len());
        let crossed = crossed_leaves(&mesh, &refined.leaves, space, changed.as_ref());
        // If triangles meet or turn over after their vertices were moved, their vertices go back to
        // g's zeros, where triangles rarely meet.
        let mut of_pairs: FxHashSet<usize> = crossed.iter().copied().flatten().collect();
        of_pairs.extend(turned_leaves(&mesh, &zero, &polygons, &refined.leaves));
        let restored = restore(&mut mesh, &zero, &polygons, &of_pairs);
        let is_final = |pair: &[usize; 2]| pair.iter().all(|leaf| !restored.contains(leaf));
        unproven.extend(crossed.into_iter().filter(is_final).flatten());
        changed = Some(restored);
    }
    mesh.unproven = unproven.into_iter().collect();
    mesh.unproven.sort_unstable();
    mesh.keep_used();
    Ok(mesh)
}

/// Moves the vertices in some leaves back to g's zeros. Returns the leaves that have a moved
/// vertex.
fn restore(
    mesh: &mut Extracted,
    zero: &dyn Fn(u32) -> DVec3,
    polygons: &[Numbered],
    leaves: &FxHashSet<usize>,
) -> FxHashSet<usize> {
    let mut moved: FxHashSet<u32> = FxHashSet::default();
    if leaves.is_empty() {
        return FxHashSet::default();
    }
    for polygon in polygons.iter().filter(|polygon| leaves.contains(&polygon.leaf)) {
        for vertex in &polygon.vertices {
            let (place, zero) = (&mut mesh.vertices[*vertex as usize], zero(*vertex));
            if *place != zero {
                *place = zero;
                moved.insert(*vertex);
            }
        }
    }
    let is_moved = |polygon: &&Numbered| polygon.vertices.iter().any(|one| moved.contains(one));
    polygons.iter().filter(is_moved).map(|polygon| polygon.leaf).collect()
}

/// The leaves with a triangle that is turned over, as against the zeros of g.
fn turned_leaves(
    mesh: &Extracted,
    zero: &dyn Fn(u32) -> DVec3,
    polygons: &[Numbered],
    leaves: &[Leaf],
) -> Vec<usize> {
    let mut turned = Vec::new();
    let mut first = 0;
    for polygon in polygons {
        let triangles = first..first + polygon.triangles();
        first = triangles.end;
        if matches!(**leaves[polygon.leaf].choice(), Choice::Part(_)) {
            continue;
        }
        let zeros: SmallVec<[DVec3; 8]> = polygon.vertices.iter().map(|one| zero(*one)).collect();
        let cross = |k: usize| (zeros[k] - zeros[0]).cross(zeros[(k + 1) % zeros.len()] - zeros[0]);
        let normal: DVec3 = (0..zeros.len()).map(cross).sum();
        let is_turned = |number: usize| {
            let [a, b, c] = mesh.triangle(number).corners;
            (b - a).cross(c - a).dot(normal) <= 0.0
        };
        turned.extend(triangles.into_iter().any(is_turned).then_some(polygon.leaf));
    }
    turned
}

/// The pairs of leaves with two triangles that are not proven to be apart. Only leaves around
/// corners of `changed` leaves are compared; all leaves if it is `None`. A leaf may be paired with
/// itself, also for a triangle without area.
fn crossed_leaves(
    mesh: &Extracted,
    leaves: &[Leaf],
    space: &Space,
    changed: Option<&FxHashSet<usize>>,
) -> Vec<[usize; 2]> {
    let is_checked = |leaf: &usize| is_checked(&leaves[*leaf], space);
    let mut checked: Vec<usize> = (0..leaves.len()).filter(is_checked).collect();
    if let Some(changed) = changed {
        let corners = changed.iter().flat_map(|leaf| leaves[*leaf].cell.numbers);
        let corners: FxHashSet<u32> = corners.collect();
        let touches = |corner: &u32| corners.contains(corner);
        checked.retain(|leaf| leaves[*leaf].cell.numbers.iter().any(touches));
    }
    if checked.is_empty() {
        return Vec::new();
    }
    let least = least_distance(space.largest());
    let mut first = vec![0; leaves.len() + 1];
    mesh.leaves.iter().for_each(|leaf| first[*leaf + 1] += 1);
    (0..leaves.len()).for_each(|leaf| first[leaf + 1] += first[leaf]);
    // Polygons are added leaf by leaf.
    let of = |leaf: usize| (first[leaf]..first[leaf + 1]).map(|number| mesh.triangle(number));
    checked.retain(|leaf| first[*leaf] < first[leaf + 1]);
    // The leaves with triangles around each corner of those.
    let mut around: FxHashMap<u32, Vec<usize>> = FxHashMap::default();
    for leaf in &checked {
        let corners = leaves[*leaf].cell.numbers.into_iter();
        around.extend(corners.map(|corner| (corner, Vec::new())));
    }
    for (number, leaf) in leaves.iter().enumerate() {
        if first[number] < first[number + 1] {
            for corner in leaf.cell.numbers {
                around.entry(corner).and_modify(|all| all.push(number));
            }
        }
    }
    let crossed = |leaf: &usize| -> SmallVec<[[usize; 2]; 2]> {
        let own: SmallVec<[Triangle; 8]> = of(*leaf).collect();
        let corners = leaves[*leaf].cell.numbers;
        let mut near: SmallVec<[usize; 32]> =
            corners.iter().flat_map(|corner| &around[corner]).copied().collect();
        near.sort_unstable();
        near.dedup();
        let is_crossed = |other: &usize| {
            let meets = |k: usize| {
                let others = of(*other).skip(if other == leaf { k + 1 } else { 0 });
                others.into_iter().any(|triangle| !own[k].is_apart(&triangle, least))
            };
            (other == leaf && !own.iter().all(|one| one.has_area(least)))
                || (0..own.len()).any(meets)
        };
        near.into_iter().filter(is_crossed).map(|other| [*leaf, other]).collect()
    };
    checked.par_iter().flat_map_iter(crossed).collect()
}

/// Share of the largest coordinate below which a cell is so small that rounding might matter
/// everywhere.
const SMALL: f64 = 1e-4;

/// Returns whether triangles in a leaf must be compared with those around it. If only one part
/// matters, the leaf has one polygon. Its vertices lie on edges, at least
/// [`APART`](crate::place::APART) from the ends. So it meets other polygons only in shared edges.
fn is_checked(leaf: &Leaf, space: &Space) -> bool {
    !matches!(**leaf.choice(), Choice::Part(_)) || size(space, &leaf.cell) < SMALL * space.largest()
}

/// From in front, the corners of the face opposite each corner.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// A polygon by the numbers of its vertices.
struct Numbered {
    leaf: usize,
    vertices: SmallVec<[u32; 4]>,
    is_joined: bool,
}

impl Numbered {
    /// The number of its triangles.
    fn triangles(&self) -> usize {
        let is_fan = !self.is_joined || self.vertices.len() == 3;
        self.vertices.len() - if is_fan { 2 } else { 0 }
    }
}

/// Properties of a leaf's polygons.
struct Added {
    /// True if rounding may have changed them.
    is_uncertain: bool,
    /// True if each connected component is a disk. Polygons of parts that cut the surface off
    /// count, too.
    are_disks: bool,
}

/// Adds the polygons in a leaf, and their vertices.
fn add_leaf(
    number: usize,
    leaf: &Leaf,
    refined: &Refined,
    query: &Query<'_>,
    vertices: &mut Vertices,
    polygons: &mut Vec<Numbered>,
) -> Added {
    let &Query { space, is_solid, levels, first_cut, .. } = query;
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
    let parts: SmallVec<[(u16, [f64; 4]); 1]> =
        parts.iter().map(|part| (part.part, values(part.part))).collect();
    let is_ordered = keep_order(&parts, levels);
    let (linear, choice) = (Linear::new(corners, parts.into_iter()), leaf.choice());
    let mut found = linear.zeros(choice, is_even(positive.map(|(number, _)| number), corners));
    if is_solid {
        let faces = FACES.map(|face| face.map(|k| positive[k]));
        let is_outside = |face: &[(u32, Corner); 3]| is_outside(space, face.map(|(_, at)| at));
        for face in faces.into_iter().filter(is_outside) {
            found.extend(linear.face(choice, face.map(|(number, _)| number)));
        }
    }
    let are_disks = are_disks(&found);
    found.retain(|polygon| usize::from(polygon.part) < first_cut || polygon.part == NO_PART);
    for polygon in found {
        let keys = linear.keys(&polygon);
        let keyed = |(key, weights)| vertices.number(key, weights, choice);
        let (vertices, is_joined) = (keys.map(keyed).collect(), polygon.is_joined);
        polygons.push(Numbered { leaf: number, vertices, is_joined });
    }
    let is_uncertain = linear.is_uncertain() || !is_ordered;
    Added { is_uncertain, are_disks }
}

/// Returns whether each connected component of some polygons is a disk: its Euler characteristic is
/// 1.
fn are_disks(polygons: &[Polygon]) -> bool {
    if polygons.len() < 2 {
        return true;
    }
    let (mut vertices, mut edges) = (Vec::new(), Vec::new());
    // For each vertex, another vertex of its part. The first one of a part is its own.
    let mut part: Vec<usize> = Vec::new();
    let first = |part: &[usize], mut vertex: usize| {
        while part[vertex] != vertex {
            vertex = part[vertex];
        }
        vertex
    };
    for polygon in polygons {
        let numbers: SmallVec<[usize; 8]> = polygon
            .ids()
            .map(|id| {
                vertices.iter().position(|one| *one == id).unwrap_or_else(|| {
                    vertices.push(id);
                    part.push(part.len());
                    vertices.len() - 1
                })
            })
            .collect();
        for (k, from) in numbers.iter().enumerate() {
            let to = numbers[(k + 1) % numbers.len()];
            let edge = [*from.min(&to), *from.max(&to)];
            if !edges.contains(&edge) {
                edges.push(edge);
            }
            let (from, to) = (first(&part, *from), first(&part, to));
            part[from] = to;
        }
    }
    let parts = (0..part.len()).filter(|vertex| part[*vertex] == *vertex).count();
    vertices.len() + polygons.len() == edges.len() + parts
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
    fn triangle(&self, number: usize) -> Triangle {
        let numbers = self.triangles[number];
        Triangle { numbers, corners: numbers.map(|vertex| self.vertices[vertex as usize]) }
    }

    /// Replaces all triangles by those of `polygons`. The polygons' vertices are the first `count`.
    fn set(&mut self, polygons: &[Numbered], count: usize) {
        self.vertices.truncate(count);
        self.is_cut.truncate(count);
        self.triangles.clear();
        self.leaves.clear();
        for polygon in polygons {
            self.add(polygon);
        }
    }

    /// Adds the triangles of a polygon.
    fn add(&mut self, polygon: &Numbered) {
        let Numbered { leaf, vertices: polygon, is_joined } = polygon;
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
                self.leaves.push(*leaf);
            }
            return;
        }
        let at = |k: usize| self.vertices[polygon[k % polygon.len()] as usize];
        let count = polygon.len();
        // Chooses the fan whose smallest triangle is largest, since a triangle of negative area
        // would be turned over.
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
            self.leaves.push(*leaf);
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
