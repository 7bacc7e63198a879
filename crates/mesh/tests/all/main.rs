//! Tests of meshes.

mod crossings;
mod flat;
mod flush;
mod orientation;
mod parametric;
mod shapes;
mod sheets;

use glam::DVec3;
use zeroset_mesh::{MOST_CELLS, Mesh, Options, Simplification, mesh, simplify};
use zeroset_scene::program::Program;
use zeroset_space::Region;
use zeroset_syntax::{SurfaceKind, read};

/// The mesh of a text's only surface in a cube around the origin.
fn mesh_of(text: &str, half: f64, tolerance: f64) -> Mesh {
    let region = Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a region");
    mesh_in(text, region, tolerance)
}

/// The mesh of a text's only surface in a region.
fn mesh_in(text: &str, region: Region, tolerance: f64) -> Mesh {
    mesh_with(text, region, tolerance, MOST_CELLS)
}

/// The same with a limit for the number of cells.
fn mesh_with(text: &str, region: Region, tolerance: f64, most_cells: usize) -> Mesh {
    mesh_by(text, region, tolerance, most_cells, false)
}

fn mesh_by(
    text: &str,
    region: Region,
    tolerance: f64,
    most_cells: usize,
    has_large_faces: bool,
) -> Mesh {
    let document = read(text, &zeroset_syntax::Options::default()).expect(text);
    let program = Program::new(&document, zeroset_mesh::domain(&region)).expect("a surface");
    let is_solid = document.surfaces[0].kind == SurfaceKind::Solid;
    let options = Options {
        region,
        larger: None,
        tolerance,
        is_solid,
        is_estimated: false,
        has_large_faces,
        most_cells,
    };
    mesh(&program, 0, &options, &|| true).expect("kernels").expect("wanted")
}

/// The exact mesh of a text's only surface, whose parts are planes.
fn flat_mesh_in(text: &str, region: Region, tolerance: f64) -> Mesh {
    mesh_by(text, region, tolerance, MOST_CELLS, true)
}

/// Replaces the triangles of the mesh that [`mesh_with`] returned by fewer ones.
fn reduce(mesh: &mut Mesh, text: &str, region: Region, tolerance: f64) {
    let document = read(text, &zeroset_syntax::Options::default()).expect(text);
    let program = Program::new(&document, zeroset_mesh::domain(&region)).expect("a surface");
    let options = Simplification { region, tolerance, distance: 0.5 * tolerance };
    simplify(&program, 0, mesh, &options, &|| true).expect("kernels").expect("wanted");
}
