//! Sheets that never meet, nearer to each other than tetrahedra are large.

use crate::mesh_of;
use crate::shapes::euler;

/// Each sheet has its shape, and few cells are needed.
#[test]
fn thin_walls_have_two_sheets() {
    for (text, half, number, rims, most_cells) in [
        ("shell(sphere(1), 0.001) <= 0", 1.2, 4, false, 40_000),
        ("(x^2+y^2+z^2-1)*(x^2+y^2+z^2-1.0002) = 0", 1.2, 4, false, 40_000),
        ("(x^2+y^2+z^2-1)^2 = 0.00000002", 1.2, 4, false, 40_000),
        ("z*(z-0.0001)*(z+0.0001) = 0", 1.0, 3, true, 20_000),
        ("abs(z) <= 0.00005", 1.0, 2, false, 20_000),
        ("abs(sqrt((sqrt(x^2+y^2)-1)^2+z^2)-0.4) <= 0.001", 1.5, 0, false, 100_000),
        ("max(shell(sphere(1), 0.001), z-0.3) <= 0", 1.2, 2, false, 40_000),
        ("max(shell(box(1), 0.0001), x+y+z-0.7) <= 0", 1.2, 2, false, 80_000),
    ] {
        let mesh = mesh_of(text, half, 0.01);
        println!("{text}: {} cells, {} triangles", mesh.cells, mesh.triangles.len());
        let (count, open) = euler(&mesh);
        assert_eq!((mesh.unproven.len(), mesh.far), (0, 0), "{text}");
        assert_eq!((count, open > 0), (number, rims), "{text}");
        assert!(mesh.cells < most_cells, "{text}: {} cells", mesh.cells);
    }
}

/// Levels whose order rounding hides are not proven.
#[test]
fn sheets_that_rounding_cannot_tell_apart_are_unproven() {
    let mesh = mesh_of("(x^2+y^2+z^2-1)*(x^2+y^2+z^2-1.00000000000000001) = 0", 1.2, 0.05);
    assert!(!mesh.is_proven());
}
