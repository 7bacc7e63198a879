//! Meshes of surfaces whose shapes are known.

use glam::DVec3;
use std::collections::HashMap;
use std::time::Instant;
use zeroset_interval::Interval;
use zeroset_mesh::{Mesh, Options, mesh};
use zeroset_scene::program::Program;
use zeroset_syntax::{SurfaceKind, read};

/// The mesh of a text's only surface in a cube around the origin.
fn mesh_of(text: &str, half: f64, tolerance: f64) -> Mesh {
    let document = read(text, &zeroset_syntax::Options::default()).expect(text);
    let program =
        Program::new(&document, [Interval { lo: -half, hi: half }; 3]).expect("a surface");
    let is_solid = document.surfaces[0].kind == SurfaceKind::Solid;
    let (low, high) = (DVec3::splat(-half), DVec3::splat(half));
    let options = Options { low, high, tolerance, is_solid };
    mesh(&program, 0, &options, &|| true).expect("kernels").expect("wanted")
}

/// Euler's number and the number of edges with one triangle. Panics if an edge has more than two
/// triangles, or two that run along it in the same direction.
fn euler(mesh: &Mesh) -> (i64, usize) {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::new();
    for triangle in &mesh.triangles {
        for k in 0..3 {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]];
            let along = &mut edges.entry([a.min(b), a.max(b)]).or_default()[usize::from(a < b)];
            *along += 1;
            assert_eq!(*along, 1, "an edge has two triangles on one side");
        }
    }
    let open = edges.values().filter(|sides| sides[0] + sides[1] == 1).count();
    let count = mesh.vertices.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64;
    (count, open)
}

#[test]
fn shapes_are_right_and_proven() {
    for (text, half, number) in [
        ("x^2+y^2+z^2 = 1", 1.2, 2),
        ("(sqrt(x^2+y^2)-1)^2+z^2 = 0.16", 1.6, 0),
        ("x^4-5x^2+y^4-5y^2+z^4-5z^2+11.8 = 0", 3.0, -8),
        ("2y(y^2-3x^2)(1-z^2)+(x^2+y^2)^2-(9z^2-1)(1-z^2) = 0", 2.0, -2),
        ("x^2+y^2 <= 0.25", 1.0, 2),
        ("max(abs(x), abs(y), abs(z)) <= 0.7", 1.0, 2),
        ("x^2+y^2+z^2 <= 1 and x+y+z >= 0.3", 1.2, 2),
        ("max(x^2+y^2+z^2-1, 0.2-x^2-y^2) <= 0", 1.2, 0),
        ("min(x^2+y^2+z^2-1, (x-1)^2+y^2+z^2-0.5) = 0", 2.2, 2),
        ("(x^2+y^2+z^2)^2-1.21 x^2 <= 0.001", 1.5, 2),
    ] {
        let clock = Instant::now();
        let mesh = mesh_of(text, half, 1e-3 * 2.0 * half * 3.0_f64.sqrt());
        let (count, open) = euler(&mesh);
        println!(
            "{text}: {} triangles, {} cells, {} unproven, {} far, {:?}, Euler {count}",
            mesh.triangles.len(),
            mesh.cells,
            mesh.unproven.len(),
            mesh.far,
            clock.elapsed()
        );
        assert_eq!((count, open), (number, 0), "{text}");
        assert_eq!((mesh.unproven.len(), mesh.far), (0, 0), "{text}");
    }
}
