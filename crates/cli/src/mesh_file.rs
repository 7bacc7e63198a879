//! Mesh files: a table of each format's extension and writer.
//!
//! Each format is a header and two lists, so a crate that writes it would be longer than its row.

use glam::{DVec3, Vec3};
use std::io::{self, Write};
use std::path::Path;
use zeroset_mesh::Mesh;

/// The mesh of one surface.
pub struct Object {
    /// The surface's statement, in one line.
    pub name: String,
    /// Its mesh.
    pub mesh: Mesh,
}

/// A format of mesh files.
#[derive(Debug)]
pub struct Format {
    /// Name of the format, and its extension in capitals.
    pub name: &'static str,
    /// True if several surfaces stay apart.
    pub has_objects: bool,
    /// True if coordinates are `f32`.
    pub is_single: bool,
    /// Writes all triangles.
    pub write: fn(&[Object], &mut dyn Write) -> io::Result<()>,
}

/// Every format.
pub const FORMATS: [Format; 3] = [
    Format { name: "STL", has_objects: false, is_single: true, write: stl },
    Format { name: "OBJ", has_objects: true, is_single: false, write: obj },
    Format { name: "PLY", has_objects: false, is_single: false, write: ply },
];

impl Format {
    /// The format that a file's extension names.
    pub fn of(path: &Path) -> Option<&'static Self> {
        let extension = path.extension()?;
        FORMATS.iter().find(|format| extension.eq_ignore_ascii_case(format.name))
    }
}

/// Binary STL: triangles with their normals, in `f32`, little endian.
fn stl(objects: &[Object], out: &mut dyn Write) -> io::Result<()> {
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
                write_floats(out, place.as_vec3())?;
            }
            out.write_all(&[0; 2])?;
        }
    }
    Ok(())
}

fn write_floats(out: &mut dyn Write, place: Vec3) -> io::Result<()> {
    place.to_array().iter().try_for_each(|along| out.write_all(&along.to_le_bytes()))
}

/// Wavefront OBJ: a text, with each surface as a named object. Decimals read back as the same
/// `f64`.
fn obj(objects: &[Object], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "# zeroset")?;
    // Vertices are numbered from 1 through the whole file.
    let mut first = 1;
    for Object { name, mesh } in objects {
        writeln!(out, "o {name}")?;
        for DVec3 { x, y, z } in &mesh.vertices {
            writeln!(out, "v {x:?} {y:?} {z:?}")?;
        }
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| vertex as usize + first);
            writeln!(out, "f {a} {b} {c}")?;
        }
        first += mesh.vertices.len();
    }
    Ok(())
}

/// Binary PLY: vertices in `f64`, then faces, little endian.
fn ply(objects: &[Object], out: &mut dyn Write) -> io::Result<()> {
    let vertices: usize = objects.iter().map(|object| object.mesh.vertices.len()).sum();
    let faces = triangles(objects);
    // Readers number vertices by `int`.
    length(vertices)?;
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment zeroset\n\
         element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )?;
    for vertex in objects.iter().flat_map(|object| &object.mesh.vertices) {
        for along in vertex.to_array() {
            out.write_all(&along.to_le_bytes())?;
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

fn triangles(objects: &[Object]) -> usize {
    objects.iter().map(|object| object.mesh.triangles.len()).sum()
}

/// A length of a list, if the format can hold it.
fn length(count: usize) -> io::Result<u32> {
    let fits = i32::try_from(count).ok().and_then(|count| u32::try_from(count).ok());
    fits.ok_or_else(|| io::Error::other("the format holds no more than 2147483647 parts"))
}
