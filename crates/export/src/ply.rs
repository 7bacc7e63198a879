//! Binary PLY: vertices in `f64` with normals and colors, then faces, little endian.

use crate::format::{length, triangles};
use crate::normals::means;
use crate::scene::Object;
use std::io::{self, Write};

pub fn write(objects: &[&Object], out: &mut dyn Write) -> io::Result<()> {
    let vertices: usize = objects.iter().map(|object| object.mesh.vertices.len()).sum();
    let faces = triangles(objects);
    // Readers number vertices by `int`.
    length(vertices)?;
    let has_values = objects.iter().any(|object| object.color.points.is_some());
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment zeroset\n\
         element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         property float nx\nproperty float ny\nproperty float nz\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n\
         {}element face {faces}\nproperty list uchar int vertex_indices\nend_header\n",
        if has_values { "property double value\n" } else { "" }
    )?;
    for Object { mesh, color, .. } in objects {
        for (vertex, normal) in means(mesh).iter().enumerate() {
            for along in mesh.vertices[vertex].to_array() {
                out.write_all(&along.to_le_bytes())?;
            }
            for along in normal.to_array() {
                out.write_all(&along.to_le_bytes())?;
            }
            out.write_all(&color.at(vertex))?;
            out.write_all(&[color.alpha()])?;
            if has_values {
                let value = color.points.as_ref().map_or(f64::NAN, |points| points.values[vertex]);
                out.write_all(&value.to_le_bytes())?;
            }
        }
    }
    let mut first = 0;
    for Object { mesh, .. } in objects {
        for triangle in &mesh.triangles {
            out.write_all(&[3])?;
            for vertex in triangle {
                out.write_all(&(vertex + first).to_le_bytes())?;
            }
        }
        first += mesh.vertices.len() as u32;
    }
    Ok(())
}
