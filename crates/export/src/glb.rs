//! GLB: glTF 2.0 in one binary file, each surface a node with a mesh and a material of its own.
//!
//! Up is y in glTF, and z in the picture of a text. So (x, y, z) is written as (x, z, −y), and
//! readers in which z is up turn it back. Lengths are meters.

use crate::color::linear;
use crate::format::{Unit, write_floats};
use crate::normals::Corners;
use crate::scene::Object;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::io::{self, Write};

/// Sizes of the header of a file and of the header of a chunk, in bytes.
const HEADER: usize = 12;
const PART_HEADER: usize = 8;
/// glTF's numbers for the types `FLOAT`, `UNSIGNED_SHORT` and `UNSIGNED_INT`.
const FLOAT: u32 = 5126;
const SHORT: u32 = 5123;
const INT: u32 = 5125;
/// glTF's numbers for the uses `ARRAY_BUFFER` and `ELEMENT_ARRAY_BUFFER`.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
/// How a surface scatters light, from 0 for a mirror to 1 for chalk.
const ROUGHNESS: f64 = 0.5;

pub fn write(objects: &[&Object], unit: Option<&Unit>, out: &mut dyn Write) -> io::Result<()> {
    let scale = unit.map_or(1.0, |unit| unit.meters);
    let parts: Vec<Part<'_>> = objects.iter().map(|object| Part::new(object)).collect();
    let (json, bytes) = describe(&parts, scale);
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let whole = HEADER + 2 * PART_HEADER + json.len() + bytes;
    let length = |length: usize| {
        u32::try_from(length)
            .map_err(|_| io::Error::other("GLB holds no more than 4294967295 bytes"))
    };
    out.write_all(b"glTF")?;
    for number in [2, length(whole)?, length(json.len())?] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&json)?;
    out.write_all(&length(bytes)?.to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    parts.iter().try_for_each(|part| part.write(out))
}

/// An object with the lists that are written.
struct Part<'a> {
    object: &'a Object,
    corners: Corners,
    places: Vec<Vec3>,
}

impl<'a> Part<'a> {
    fn new(object: &'a Object) -> Self {
        let corners = Corners::of(&object.mesh);
        let place = |vertex: &u32| turned(object.mesh.vertices[*vertex as usize]).as_vec3();
        let places = corners.vertices.iter().map(place).collect();
        Self { object, corners, places }
    }

    /// Writes the lists that [`describe`] lists.
    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { object, corners, places } = self;
        for place in places {
            write_floats(out, &place.to_array())?;
        }
        for normal in &corners.normals {
            write_floats(out, &turned(normal.as_dvec3()).as_vec3().to_array())?;
        }
        if object.color.points.is_some() {
            for vertex in &corners.vertices {
                let [red, green, blue] = linear(object.color.at(*vertex as usize));
                for part in [red, green, blue, 1.0] {
                    let part = (part * f32::from(u16::MAX)).round() as u16;
                    out.write_all(&part.to_le_bytes())?;
                }
            }
        }
        for corner in corners.triangles.iter().flatten() {
            out.write_all(&corner.to_le_bytes())?;
        }
        Ok(())
    }
}

/// The description of a file's lists, and the number of their bytes. `scale` is the length of 1 in
/// meters. Readers multiply by it, so that coordinates in the file stay exact.
fn describe(parts: &[Part<'_>], scale: f64) -> (Value, usize) {
    let (mut views, mut accessors, mut bytes) = (Vec::new(), Vec::new(), 0);
    let mut add = |size: usize, target: u32, mut accessor: Value| {
        views.push(json!({
            "buffer": 0, "byteOffset": bytes, "byteLength": size, "target": target,
        }));
        bytes += size;
        accessor["bufferView"] = accessors.len().into();
        accessors.push(accessor);
        accessors.len() - 1
    };
    let (mut nodes, mut meshes, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    for (number, Part { object, corners, places }) in parts.iter().enumerate() {
        let count = places.len();
        let low = places.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = places.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let vectors = json!({ "componentType": FLOAT, "count": count, "type": "VEC3" });
        let mut bounded = vectors.clone();
        bounded["min"] = json!(low.to_array());
        bounded["max"] = json!(high.to_array());
        let mut attributes = json!({
            "POSITION": add(12 * count, VERTICES, bounded),
            "NORMAL": add(12 * count, VERTICES, vectors),
        });
        let color = &object.color;
        if color.points.is_some() {
            let colors = json!({
                "componentType": SHORT, "normalized": true, "count": count, "type": "VEC4",
            });
            attributes["COLOR_0"] = add(8 * count, VERTICES, colors).into();
        }
        let corners = 3 * corners.triangles.len();
        let numbers = json!({ "componentType": INT, "count": corners, "type": "SCALAR" });
        let indices = add(4 * corners, INDICES, numbers);
        // Colors of vertices are multiplied by the material's.
        let [red, green, blue] = if color.points.is_some() { [1.0; 3] } else { linear(color.rgb) };
        materials.push(json!({
            "name": object.name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [red, green, blue, color.opacity as f32],
                "metallicFactor": 0.0,
                "roughnessFactor": ROUGHNESS,
            },
            "alphaMode": if color.opacity < 1.0 { "BLEND" } else { "OPAQUE" },
            "doubleSided": !object.mesh.is_closed,
        }));
        meshes.push(json!({
            "name": object.name,
            "primitives": [
                { "attributes": attributes, "indices": indices, "material": number, "mode": 4 },
            ],
        }));
        let mut node = json!({ "name": object.name, "mesh": number });
        if scale != 1.0 {
            node["scale"] = json!([scale, scale, scale]);
        }
        nodes.push(node);
    }
    let scene: Vec<usize> = (0..nodes.len()).collect();
    let json = json!({
        "asset": { "version": "2.0", "generator": "zeroset" },
        "scene": 0,
        "scenes": [{ "nodes": scene }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes }],
    });
    (json, bytes)
}

/// A direction or a place with y up instead of z.
fn turned(DVec3 { x, y, z }: DVec3) -> DVec3 {
    DVec3::new(x, z, -y)
}
