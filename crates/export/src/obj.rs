//! Wavefront OBJ: a text, with each surface as a named object, and a normal for each corner of a
//! triangle. Decimals read back as the same `f64`.
//!
//! Colors would need a second file.

use crate::normals::Corners;
use crate::scene::Object;
use glam::{DVec3, Vec3};
use std::io::{self, Write};

pub fn write(objects: &[&Object], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "# zeroset")?;
    // Vertices and normals are numbered from 1 through the whole file.
    let (mut first, mut first_normal) = (1, 1);
    for Object { name, mesh, .. } in objects {
        writeln!(out, "o {name}")?;
        for DVec3 { x, y, z } in &mesh.vertices {
            writeln!(out, "v {x:?} {y:?} {z:?}")?;
        }
        let corners = Corners::of(mesh);
        for Vec3 { x, y, z } in &corners.normals {
            writeln!(out, "vn {x:?} {y:?} {z:?}")?;
        }
        for (triangle, corners) in mesh.triangles.iter().zip(&corners.triangles) {
            let [a, b, c] = triangle.map(|vertex| vertex as usize + first);
            let [k, l, m] = corners.map(|corner| corner as usize + first_normal);
            writeln!(out, "f {a}//{k} {b}//{l} {c}//{m}")?;
        }
        first += mesh.vertices.len();
        first_normal += corners.normals.len();
    }
    Ok(())
}
