//! Meshes of parametric surfaces: the rectangle of u and v is divided into cells, and each cell
//! into triangles.
//!
//! The vertices are points of the surface S. A triangle is linear in u and v, and its distance from
//! S at the same u and v has a [bound](fine). Cells are divided until that is within the tolerance,
//! in the direction in which the surface bends most.
//!
//! A vertex on an edge of a cell belongs to the polygons of both cells, so nothing is torn. Sides
//! of the rectangle whose points agree are glued: as they are, turned around, or moved along each
//! other. A side that is one point becomes one vertex. Sides are compared at a hundred points, up
//! to rounding, which proves nothing between them.

mod cut;
mod division;
mod fine;
mod sides;
mod triangulation;

use crate::orientation::face_out;
use crate::{Crossings, Edges, Mesh, Unproven};
use cut::Cut;
use division::{Wanted, divided};
use glam::DVec3;
use sides::Sides;
use triangulation::{Face, Triangulation};
use zeroset_eval::Patches;
use zeroset_space::{PatchCell, PatchTree, Region};

/// Number of parts of the rectangle along u and along v, as coordinates of vertices count them. It
/// is a multiple of all numbers of cells with which a division begins. Some tubes close after a
/// third of a turn.
const PARTS: u32 = (3 * 5 * 7) << 18;
/// A cell in which the surface may have a gap is not divided below this share of the rectangle.
const FINEST: u32 = PARTS / 768;

/// A cell in which the surface may have a gap has triangles if no edge is longer than this many
/// tolerances. Else they could be a wall across a jump.
const GAP: f64 = 4.0;

/// A place in the rectangle, in [`PARTS`] of the ranges of u and v.
type Place = [u32; 2];

/// A cell: its range of u, then of v.
type Ranges = [[u32; 2]; 2];

/// A cell, and what is known of the surface over it.
#[derive(Clone, Copy)]
#[allow(clippy::struct_excessive_bools, reason = "each is a fact of its own")]
struct Cell {
    ranges: Ranges,
    /// The surface's distance from a linear function. Infinite if it may have a gap.
    error: f64,
    is_continuous: bool,
    /// True if the surface is proven to have no point there.
    is_nowhere: bool,
    /// True if the surface over the cell is outside of the domain.
    is_outside: bool,
    /// True if the cell is too large to be cut by the domain's ball.
    is_coarse: bool,
    /// Two triangles between the cell's corners that are proven to be near the surface.
    fitting: Option<[[usize; 3]; 2]>,
}

/// The options for the mesh of a parametric surface.
#[derive(Clone, Copy, Debug)]
pub struct ParametricOptions {
    /// The domain, which cuts the mesh.
    pub region: Region,
    /// Largest allowed distance between mesh and surface at the same u and v, in world units.
    pub tolerance: f64,
    /// True if triangles must be small enough for colors of vertices.
    pub is_full: bool,
    /// Above this number, no cell is divided.
    pub most_cells: usize,
}

/// Returns the mesh of a parametric surface, or `None` once `wanted` returns false.
///
/// At the same u and v, mesh and surface are within the tolerance of each other, except in cells
/// that are [far](Mesh::far). In [unproven](Mesh::unproven) cells the surface may have a gap. The
/// mesh is cut at the boundary of the domain: a piece of the surface that is within the tolerance
/// of it may have no triangle. Triangles are counterclockwise around the cross product of the
/// derivatives with respect to u and v, or from outside if the mesh of the whole rectangle is
/// closed and has two sides.
pub fn parametric_mesh(
    tree: &PatchTree,
    options: &ParametricOptions,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Option<Mesh> {
    let &ParametricOptions { region, tolerance, is_full, most_cells } = options;
    let Some(size) = extent(tree) else {
        let crossings = Some(Crossings::default());
        return Some(Mesh { is_parametric: true, crossings, ..Mesh::default() });
    };
    // Gluing moves vertices, by more than bounds are rounded. Rounding to `f32` moves them by less
    // than 0.45 of `moved`, and where they are cut, once more. Cutting moves those near a side.
    let moved = size * (1.0 / 4_194_304.0);
    let is_single = 16.0 * moved <= tolerance;
    let slack = if is_single { 0.25 * moved } else { Sides::moved(size) };
    let rounded = if is_single { moved } else { 0.0 };
    let distance = tolerance - rounded - slack - Sides::moved(size);
    let cut = Cut::new(&region, slack, tolerance);
    let wanted = Wanted { distance, is_linear: is_full, most_cells, cut: &cut, goes_on: wanted };
    let mut cells = divided(tree, &wanted)?;
    cells.retain(|cell| !cell.is_nowhere);
    let mut triangles = Triangulation::new(tree, Sides::find(tree, size), is_single);
    let faces = triangles.faces(cells, &wanted)?;
    let is_used =
        |face: &&Face| face.cell.is_continuous || triangles.longest_edge(face) <= GAP * tolerance;
    let used = faces.iter().filter(is_used).flat_map(|face| face.triangles.iter().copied());
    let mut mesh = finished(triangles.points.clone(), used.collect(), &cut, is_single);
    mesh.crossings = Some(Crossings::of(&mesh.vertices, &mesh.triangles));
    mesh.is_single = is_single;
    let inside = || faces.iter().filter(|face| !face.cell.is_outside);
    mesh.cells = inside().count();
    mesh.far = inside().filter(|face| face.cell.is_continuous && !face.is_near).count();
    let gaps = inside().filter(|face| !face.cell.is_continuous);
    mesh.unproven = gaps.map(|face| place(tree, &face.cell)).collect();
    Some(mesh)
}

/// Makes a mesh of triangles: turns them out, and then cuts them.
fn finished(
    mut vertices: Vec<DVec3>,
    mut triangles: Vec<[u32; 3]>,
    cut: &Cut,
    is_single: bool,
) -> Mesh {
    let is_proper = |[a, b, c]: &[u32; 3]| {
        let is_finite = |vertex: u32| vertices[vertex as usize].is_finite();
        a != b && b != c && c != a && [*a, *b, *c].into_iter().all(is_finite)
    };
    triangles.retain(is_proper);
    let Edges { mut is_closed, has_sides, .. } = Edges::of(&triangles);
    if is_closed && has_sides {
        face_out(&vertices, &mut triangles, &[]);
    }
    if cut.apply(&mut vertices, &mut triangles, is_single) {
        is_closed = Edges::of(&triangles).is_closed;
    }
    let mut mesh = Mesh { vertices, triangles, is_parametric: true, is_closed, ..Mesh::default() };
    drop_unused(&mut mesh);
    mesh
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
    fn new(ranges: Ranges, found: &Patches<f64>, lane: usize, cut: &Cut) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| found.error[axis][lane]);
        let length = DVec3::new(x, y, z).length();
        let is_continuous = found.continuous >> lane & 1 == 1;
        let bounds = [0, 1, 2].map(|axis| found.coordinate(axis, lane));
        Self {
            ranges,
            error: if is_continuous && length.is_finite() { length } else { f64::INFINITY },
            is_continuous,
            is_nowhere: found.nowhere >> lane & 1 == 1,
            is_outside: cut.is_outside(&bounds),
            is_coarse: cut.is_coarse(&bounds),
            fitting: None,
        }
    }

    /// Returns whether an axis can be divided.
    fn is_divisible(&self, axis: usize) -> bool {
        let [low, high] = self.ranges[axis];
        high - low > if self.is_continuous { 1 } else { FINEST }
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

/// The program of a text's parametric surfaces.
#[cfg(test)]
fn program(text: &str) -> zeroset_scene::program::Program {
    let document = zeroset_syntax::read(text, &zeroset_syntax::Options::default());
    let document = document.expect(text);
    let whole = [zeroset_interval::Interval { lo: -1.0, hi: 1.0 }; 3];
    let program = zeroset_scene::program::Program::new(&document, whole).expect(text);
    program.with_patches(&document).expect(text)
}
