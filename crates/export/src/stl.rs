//! Binary STL: triangles with their normals, in `f32`, little endian.

use crate::format::{length, triangles, write_floats};
use crate::scene::Object;
use std::io::{self, Write};

pub fn write(objects: &[&Object], out: &mut dyn Write) -> io::Result<()> {
    let mut header = [b' '; 80];
    // A header that begins with `solid` would announce a text.
    let title = b"zeroset";
    header[..title.len()].copy_from_slice(title);
    out.write_all(&header)?;
    out.write_all(&length(triangles(objects))?.to_le_bytes())?;
    for Object { mesh, .. } in objects {
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| mesh.vertices[vertex as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for place in [normal, a, b, c] {
                write_floats(out, &place.as_vec3().to_array())?;
            }
            out.write_all(&[0; 2])?;
        }
    }
    Ok(())
}
