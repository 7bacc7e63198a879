//! Meshes of parametric surfaces: the rectangle of u and v is divided into cells, and each cell
//! into triangles.
//!
//! Over a cell, the surface S is within an error e of a function L that is linear in u and v. A
//! triangle whose vertices are points of S over the cell interpolates S − L, and so is within e of
//! L, too. So triangle and surface are within 2e of each other at the same u and v. Cells are
//! divided until that is below the tolerance, in the direction that reduces it most.
//!
//! A vertex on an edge of a cell belongs to the polygons of both cells, so nothing is torn. Sides
//! of the rectangle whose points agree are glued: as they are, turned around, or moved along each
//! other. A side that is one point becomes one vertex. Sides are compared at a hundred points, up
//! to rounding, which proves nothing between them.

mod sides;

use crate::orientation::face_out;
use crate::{Crossings, Mesh, Unproven};
use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use sides::Sides;
use std::collections::{BTreeMap, BTreeSet};
use zeroset_eval::{LANES, Patches};
use zeroset_space::{PatchCell, PatchTree};

/// Number of parts of the rectangle along u and along v, as coordinates of vertices count them.
/// Some tubes close after a third of a turn.
const PARTS: u32 = 3 << 22;
/// Number of cells along u and along v at the beginning. Fewer than 3 could not go around a tube.
const FIRST: u32 = 6;
/// A cell in which the surface may have a gap is not divided below this share of the rectangle.
const FINEST: u32 = PARTS / 768;
/// Cells are divided in both directions if neither reduces the error by this factor more than the
/// other.
const CLEARLY: f64 = 1.5;

/// A cell in which the surface may have a gap has triangles if no edge is longer than this many
/// tolerances. Else they could be a wall across a jump.
const GAP: f64 = 4.0;

/// A place in the rectangle, in [`PARTS`] of the ranges of u and v.
type Place = [u32; 2];

/// A cell: its range of u, then of v.
type Ranges = [[u32; 2]; 2];

/// A cell, and what is known of the surface over it.
#[derive(Clone, Copy)]
struct Cell {
    ranges: Ranges,
    /// The surface's distance from a linear function. Infinite if it may have a gap.
    error: f64,
    is_continuous: bool,
    /// True if the surface is proven to have no point there.
    is_nowhere: bool,
}

/// Returns the mesh of a parametric surface, or `None` once `wanted` returns false. Above
/// `most_cells`, no cell is divided.
///
/// At the same u and v, mesh and surface are within `tolerance` of each other, except in cells that
/// are [far](Mesh::far). In [unproven](Mesh::unproven) cells the surface may have a gap. The mesh
/// is that of the whole rectangle. Triangles are counterclockwise around the cross product of the
/// derivatives with respect to u and v, or from outside if the mesh is closed and has two sides.
pub fn parametric_mesh(
    tree: &PatchTree,
    tolerance: f64,
    most_cells: usize,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<Mesh> {
    let Some(size) = extent(tree) else {
        let crossings = Some(Crossings::default());
        return Some(Mesh { is_parametric: true, crossings, ..Mesh::default() });
    };
    // Rounding to `f32`, and gluing, move vertices.
    let moved = size * (1.0 / 4_194_304.0);
    let is_single = 16.0 * moved <= tolerance;
    let allowed = tolerance - if is_single { moved } else { 0.0 } - Sides::moved(size);
    let cells = divided(tree, 0.5 * allowed, most_cells, wanted)?;
    let sides = Sides::find(tree, size);
    let mut triangles = Triangulation::new(tree, sides, is_single, GAP * tolerance);
    let used: Vec<&Cell> = cells.iter().filter(|cell| !cell.is_nowhere).collect();
    triangles.add_corners(used.iter().map(|cell| cell.ranges));
    for cell in &used {
        triangles.add_cell(cell);
    }
    let mut mesh = triangles.finish();
    mesh.crossings = Some(Crossings::of(&mesh.vertices, &mesh.triangles));
    mesh.cells = used.len();
    mesh.is_single = is_single;
    let is_far = |cell: &&&Cell| cell.is_continuous && 2.0 * cell.error > allowed;
    mesh.far = used.iter().filter(is_far).count();
    let gaps = used.iter().filter(|cell| !cell.is_continuous);
    mesh.unproven = gaps.map(|cell| place(tree, cell)).collect();
    Some(mesh)
}

/// The length of the diagonal of the surface's box. `None` if the surface has no point.
fn extent(tree: &PatchTree) -> Option<f64> {
    /// Number of levels of cells from whose bounds the box is made.
    const DEPTH: u32 = 2;
    let [x, y, z] = tree.finite_bounds(DEPTH)?;
    let largest = [x, y, z].as_flattened().iter().fold(0.0_f64, |most, end| most.max(end.abs()));
    Some(DVec3::new(x[1] - x[0], y[1] - y[0], z[1] - z[0]).length().max(largest))
}

/// The box of the surface over a cell.
fn place(tree: &PatchTree, cell: &Cell) -> Unproven {
    let found = tree.over(&[parameters(tree, &cell.ranges)]);
    let ends = [0, 1, 2].map(|axis| found.coordinate(axis, 0));
    let [low, high] = [0, 1].map(|end| DVec3::from_array(ends.map(|axis| axis[end])));
    Unproven { centre: 0.5 * (low + high), size: high - low }
}

/// The u or v at a place along an axis.
fn parameter(tree: &PatchTree, axis: usize, part: u32) -> f64 {
    let [low, high] = tree.outer()[axis];
    match part {
        0 => low,
        PARTS => high,
        _ => low + (high - low) * (f64::from(part) / f64::from(PARTS)),
    }
}

/// The ranges of u and v of a cell.
fn parameters(tree: &PatchTree, ranges: &Ranges) -> PatchCell {
    [0, 1].map(|axis| ranges[axis].map(|part| parameter(tree, axis, part)))
}

impl Cell {
    fn new(ranges: Ranges, found: &Patches<f64>, lane: usize) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| found.error[axis][lane]);
        let length = DVec3::new(x, y, z).length();
        let is_continuous = found.continuous >> lane & 1 == 1;
        Self {
            ranges,
            error: if is_continuous && length.is_finite() { length } else { f64::INFINITY },
            is_continuous,
            is_nowhere: found.nowhere >> lane & 1 == 1,
        }
    }

    /// Returns whether an axis can be divided.
    fn is_divisible(&self, axis: usize) -> bool {
        let [low, high] = self.ranges[axis];
        high - low > if self.is_continuous { 1 } else { FINEST }
    }
}

/// The halves of a range.
fn halves([low, high]: [u32; 2]) -> [[u32; 2]; 2] {
    let middle = low + (high - low) / 2;
    [[low, middle], [middle, high]]
}

/// Divides the rectangle into cells whose error is `enough`, or that cannot be divided. `None` once
/// `wanted` returns false.
fn divided(
    tree: &PatchTree,
    enough: f64,
    most_cells: usize,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<Vec<Cell>> {
    let step = PARTS / FIRST;
    let range = |k: u32| [k * step, (k + 1) * step];
    let first: Vec<Ranges> =
        (0..FIRST * FIRST).map(|k| [range(k % FIRST), range(k / FIRST)]).collect();
    let mut open = evaluated(tree, &first);
    let mut done = Vec::new();
    while !open.is_empty() {
        if !wanted() {
            return None;
        }
        let is_full = done.len() + open.len() > most_cells;
        let is_done = |cell: &Cell| {
            let is_divisible = cell.is_divisible(0) || cell.is_divisible(1);
            is_full || cell.is_nowhere || cell.error <= enough || !is_divisible
        };
        let (ended, coarse): (Vec<Cell>, Vec<Cell>) = open.into_iter().partition(is_done);
        done.extend(ended);
        open = coarse.par_chunks(LANES / 4).flat_map_iter(|some| parts(tree, some)).collect();
    }
    Some(done)
}

/// Evaluates the surface over cells.
fn evaluated(tree: &PatchTree, ranges: &[Ranges]) -> Vec<Cell> {
    let some = |ranges: &[Ranges]| {
        let cells: Vec<PatchCell> = ranges.iter().map(|one| parameters(tree, one)).collect();
        let found = tree.over(&cells);
        let cell = |(lane, ranges): (usize, &Ranges)| Cell::new(*ranges, &found, lane);
        ranges.iter().enumerate().map(cell).collect::<Vec<_>>()
    };
    ranges.chunks(LANES).flat_map(some).collect()
}

/// The parts of cells, each divided in the direction that reduces its error most.
fn parts(tree: &PatchTree, cells: &[Cell]) -> Vec<Cell> {
    let four = |cell: &Cell| {
        let [u, v] = cell.ranges;
        let ([left, right], [below, above]) = (halves(u), halves(v));
        [[left, v], [right, v], [u, below], [u, above]]
    };
    let ranges: Vec<Ranges> = cells.iter().flat_map(four).collect();
    let halves_of = evaluated(tree, &ranges);
    let mut both: Vec<Ranges> = Vec::new();
    let mut all = Vec::new();
    for (cell, four) in cells.iter().zip(halves_of.chunks(4)) {
        let worst = |two: &[Cell]| two[0].error.max(two[1].error);
        let (by_u, by_v) = (worst(&four[..2]), worst(&four[2..]));
        let [u, v] = [cell.is_divisible(0), cell.is_divisible(1)];
        if u && (!v || CLEARLY * by_u < by_v) {
            all.extend_from_slice(&four[..2]);
        } else if v && (!u || CLEARLY * by_v < by_u) {
            all.extend_from_slice(&four[2..]);
        } else {
            let [us, vs] = cell.ranges.map(halves);
            both.extend(vs.iter().flat_map(|v| us.map(|u| [u, *v])));
        }
    }
    all.extend(evaluated(tree, &both));
    all
}

/// Triangles of cells that are added one after the other.
struct Triangulation<'a> {
    tree: &'a PatchTree,
    sides: Sides,
    is_single: bool,
    /// Per u, the v of all corners with that u; and the same the other way around.
    corners: [BTreeMap<u32, BTreeSet<u32>>; 2],
    /// The vertex at each place.
    numbers: FxHashMap<Place, u32>,
    places: Vec<Place>,
    polygons: Vec<Polygon>,
    /// The longest edge of polygons whose cell may have a gap.
    longest: f64,
}

/// A part of a cell.
struct Polygon {
    vertices: Vec<u32>,
    /// True if the surface is continuous on the cell.
    is_continuous: bool,
}

impl<'a> Triangulation<'a> {
    fn new(tree: &'a PatchTree, sides: Sides, is_single: bool, longest: f64) -> Self {
        let (corners, numbers) = (Default::default(), FxHashMap::default());
        let (places, polygons) = (Vec::new(), Vec::new());
        Self { tree, sides, is_single, corners, numbers, places, polygons, longest }
    }

    /// Adds the corners of all cells, which are vertices.
    fn add_corners(&mut self, cells: impl Iterator<Item = Ranges>) {
        for [us, vs] in cells {
            for u in us {
                for v in vs {
                    for [u, v] in self.sides.copies([u, v]) {
                        self.corners[0].entry(u).or_default().insert(v);
                        self.corners[1].entry(v).or_default().insert(u);
                    }
                }
            }
        }
    }

    /// The vertex at a place.
    fn vertex(&mut self, place: Place) -> u32 {
        let place = self.sides.first(place);
        let next = self.places.len() as u32;
        let number = *self.numbers.entry(place).or_insert(next);
        if number == next {
            self.places.push(place);
        }
        number
    }

    /// Adds the polygon of a cell: all vertices on its edges, counterclockwise.
    fn add_cell(&mut self, &Cell { ranges: [us, vs], is_continuous, .. }: &Cell) {
        let along = |axis: usize, at: u32, [low, high]: [u32; 2]| -> Vec<u32> {
            let line = self.corners[axis].get(&at);
            line.into_iter().flat_map(|line| line.range(low..high)).copied().collect()
        };
        let backward = |axis: usize, at: u32, [low, high]: [u32; 2]| -> Vec<u32> {
            let line = self.corners[axis].get(&at);
            let inner = line.into_iter().flat_map(|line| line.range(low + 1..=high));
            inner.rev().copied().collect()
        };
        let [[left, right], [below, above]] = [us, vs];
        let mut round: Vec<Place> = Vec::new();
        round.extend(along(1, below, us).into_iter().map(|u| [u, below]));
        round.extend(along(0, right, vs).into_iter().map(|v| [right, v]));
        round.extend(backward(1, above, us).into_iter().map(|u| [u, above]));
        round.extend(backward(0, left, vs).into_iter().map(|v| [left, v]));
        let mut polygon: Vec<u32> = round.into_iter().map(|place| self.vertex(place)).collect();
        polygon.dedup();
        while polygon.len() > 1 && polygon.first() == polygon.last() {
            polygon.pop();
        }
        if polygon.len() > 4 {
            // All triangles meet in the middle.
            let middle = self.vertex([left + (right - left) / 2, below + (above - below) / 2]);
            for (k, vertex) in polygon.iter().enumerate() {
                let next = polygon[(k + 1) % polygon.len()];
                let vertices = vec![middle, *vertex, next];
                self.polygons.push(Polygon { vertices, is_continuous });
            }
        } else if polygon.len() > 2 {
            self.polygons.push(Polygon { vertices: polygon, is_continuous });
        }
    }

    /// The places of the vertices in space.
    fn points(&self) -> Vec<DVec3> {
        let some = |places: &[Place]| {
            let cell = |&[u, v]: &Place| {
                let [u, v] = [parameter(self.tree, 0, u), parameter(self.tree, 1, v)];
                [[u, u], [v, v]]
            };
            let found = self.tree.over(&places.iter().map(cell).collect::<Vec<_>>());
            let point = |lane: usize| {
                let at = DVec3::from_array([0, 1, 2].map(|axis| found.centre[axis][lane]));
                if self.is_single { at.as_vec3().as_dvec3() } else { at }
            };
            (0..places.len()).map(point).collect::<Vec<_>>()
        };
        self.places.par_chunks(LANES).flat_map_iter(some).collect()
    }

    /// The mesh of all cells.
    fn finish(self) -> Mesh {
        let vertices = self.points();
        let mut triangles = Vec::with_capacity(2 * self.polygons.len());
        let is_short = |polygon: &Polygon| {
            let ends = polygon.vertices.iter().zip(polygon.vertices.iter().cycle().skip(1));
            let length = |(one, other): (&u32, &u32)| {
                vertices[*one as usize].distance(vertices[*other as usize])
            };
            ends.map(length).all(|length| length <= self.longest)
        };
        for polygon in self.polygons.iter().filter(|one| one.is_continuous || is_short(one)) {
            match polygon.vertices[..] {
                [a, b, c] => triangles.push([a, b, c]),
                [a, b, c, d] => {
                    let length = |one: u32, other: u32| {
                        vertices[one as usize].distance_squared(vertices[other as usize])
                    };
                    // The shorter diagonal.
                    if length(a, c) <= length(b, d) {
                        triangles.extend([[a, b, c], [a, c, d]]);
                    } else {
                        triangles.extend([[a, b, d], [b, c, d]]);
                    }
                }
                _ => {}
            }
        }
        let is_proper = |[a, b, c]: &[u32; 3]| {
            let is_finite = |vertex: u32| vertices[vertex as usize].is_finite();
            a != b && b != c && c != a && [*a, *b, *c].into_iter().all(is_finite)
        };
        triangles.retain(is_proper);
        let mut mesh = Mesh { vertices, triangles, is_parametric: true, ..Mesh::default() };
        let Edges { is_closed, has_sides } = Edges::of(&mesh.triangles);
        mesh.is_closed = is_closed;
        drop_unused(&mut mesh);
        if is_closed && has_sides {
            face_out(&mesh.vertices, &mut mesh.triangles, &[]);
        }
        mesh
    }
}

/// Removes vertices that belong to no triangle.
fn drop_unused(mesh: &mut Mesh) {
    let mut numbers = vec![u32::MAX; mesh.vertices.len()];
    let mut kept = Vec::with_capacity(mesh.vertices.len());
    for vertex in mesh.triangles.iter_mut().flatten() {
        let number = &mut numbers[*vertex as usize];
        if *number == u32::MAX {
            *number = kept.len() as u32;
            kept.push(mesh.vertices[*vertex as usize]);
        }
        *vertex = *number;
    }
    mesh.vertices = kept;
}

/// The way in which triangles meet.
struct Edges {
    /// True if each edge belongs to two triangles.
    is_closed: bool,
    /// True if the two run along it in opposite directions.
    has_sides: bool,
}

impl Edges {
    fn of(triangles: &[[u32; 3]]) -> Self {
        let mut counts: FxHashMap<[u32; 2], [u32; 2]> = FxHashMap::default();
        for &[a, b, c] in triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let count = counts.entry([from.min(to), from.max(to)]).or_default();
                count[usize::from(from > to)] += 1;
            }
        }
        Self {
            is_closed: !counts.is_empty() && counts.values().all(|[one, other]| one + other == 2),
            has_sides: counts.values().all(|count| count.iter().all(|count| *count <= 1)),
        }
    }
}
