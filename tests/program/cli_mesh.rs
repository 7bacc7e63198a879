//! The command `mesh`. Its files are read back here by readers of their own.

use crate::cli_support::Sandbox;
use serde_json::Value;
use std::collections::{HashMap, HashSet};
use std::io::Read as _;
use zeroset_testkit::Stl;

/// A mesh as read from a file.
#[derive(Default)]
struct Read {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    names: Vec<String>,
    /// Normals of vertices, or of the corners of triangles.
    normals: Vec<[f64; 3]>,
    /// Colors of objects or of vertices, as hexadecimal digits.
    colors: HashSet<String>,
    /// Values of a color map at the vertices.
    values: Vec<f64>,
}

impl Read {
    /// Vertices at one place become one.
    fn weld(corners: &[[f32; 3]]) -> Self {
        let mut mesh = Self::default();
        let mut numbers = HashMap::new();
        let number = |corner: &[f32; 3]| {
            *numbers.entry(corner.map(f32::to_bits)).or_insert_with(|| {
                mesh.vertices.push(corner.map(f64::from));
                mesh.vertices.len() - 1
            })
        };
        let numbers: Vec<usize> = corners.iter().map(number).collect();
        mesh.triangles = numbers.as_chunks().0.to_vec();
        mesh
    }

    fn stl(bytes: &[u8]) -> Self {
        let mesh = Stl::read(bytes).expect("a mesh");
        assert_eq!(mesh.flaws().normal, 0);
        let triangle = |corners: &[u32; 3]| corners.map(|vertex| vertex as usize);
        let triangles = mesh.triangles.iter().map(triangle).collect();
        Self { vertices: mesh.vertices, triangles, ..Self::default() }
    }

    fn obj(text: &str) -> Self {
        let mut mesh = Self::default();
        for line in text.lines() {
            let (key, rest) = line.split_once(' ').expect("a key");
            let words: Vec<&str> = rest.split(' ').collect();
            match (key, &words[..]) {
                ("v", [x, y, z]) => {
                    mesh.vertices.push([x, y, z].map(|word| word.parse().expect("a number")));
                }
                ("vn", [x, y, z]) => {
                    mesh.normals.push([x, y, z].map(|word| word.parse().expect("a number")));
                }
                ("f", [a, b, c]) => {
                    let number = |word: &str| word.parse::<usize>().expect("a number") - 1;
                    let both = [a, b, c].map(|word| word.split_once("//").expect("a normal"));
                    assert!(both.iter().all(|(_, n)| number(n) < mesh.normals.len()), "{line}");
                    mesh.triangles.push(both.map(|(vertex, _)| number(vertex)));
                }
                ("o", _) => mesh.names.push(rest.to_owned()),
                ("#", _) => {}
                _ => panic!("{line}"),
            }
        }
        mesh
    }

    fn ply(bytes: &[u8]) -> Self {
        let end = b"end_header\n";
        let start = bytes.windows(end.len()).position(|part| part == end).expect("a header");
        let header = std::str::from_utf8(&bytes[..start]).expect("a text");
        let count = |element: &str| -> usize {
            let line = header.lines().find_map(|line| line.strip_prefix(element)).expect(element);
            line.trim().parse().expect("a count")
        };
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"), "{header}");
        let has_values = header.contains("property double value\n");
        let size = if has_values { 48 } else { 40 };
        let (vertices, faces) = bytes[start + end.len()..].split_at(size * count("element vertex"));
        assert_eq!(faces.len(), 13 * count("element face"));
        let mut mesh = Self::default();
        for vertex in vertices.chunks(size) {
            mesh.vertices.push([0, 8, 16].map(|at| f64_at(vertex, at)));
            mesh.normals.push([24, 28, 32].map(|at| f32_at(vertex, at)));
            mesh.colors.insert(hexadecimal(&vertex[36..40]));
            mesh.values.extend(has_values.then(|| f64_at(vertex, 40)));
        }
        let triangle = |face: &[u8; 13]| {
            assert_eq!(face[0], 3);
            [1, 5, 9].map(|at| u32_at(face, at))
        };
        mesh.triangles = faces.as_chunks().0.iter().map(triangle).collect();
        mesh
    }

    /// Reads what `zeroset` writes. A vertex is welded to others at its place.
    fn glb(bytes: &[u8]) -> Self {
        let (header, length) = (&bytes[..12], u32_at(bytes, 12));
        assert_eq!(
            (&header[..4], u32_at(header, 4), u32_at(header, 8)),
            (&b"glTF"[..], 2, bytes.len())
        );
        let (text, binary) = bytes[20..].split_at(length);
        assert_eq!((&bytes[16..20], &binary[4..8], length % 4), (&b"JSON"[..], &b"BIN\0"[..], 0));
        let json: Value = serde_json::from_slice(text).expect("JSON");
        let buffer = &binary[8..];
        assert_eq!(json["buffers"][0]["byteLength"], buffer.len());
        assert_eq!(u32_at(binary, 0), buffer.len());
        let list = |number: &Value, size: usize| {
            let number = number.as_u64().expect("a number") as usize;
            let accessor = &json["accessors"][number];
            let view =
                &json["bufferViews"][accessor["bufferView"].as_u64().expect("a number") as usize];
            let [start, length] = ["byteOffset", "byteLength"]
                .map(|key| view[key].as_u64().expect("a number") as usize);
            assert_eq!(accessor["count"], length / size);
            buffer[start..start + length].chunks(size).collect::<Vec<_>>()
        };
        let mut mesh = Self::default();
        let mut corners: Vec<[f32; 3]> = Vec::new();
        let mut scale = 1.0;
        for (number, node) in json["nodes"].as_array().expect("nodes").iter().enumerate() {
            // All nodes of a file have the same scale.
            scale = node["scale"][0].as_f64().unwrap_or(1.0);
            mesh.names.push(node["name"].as_str().expect("a name").to_owned());
            let part = &json["meshes"][number]["primitives"][0];
            let attributes = &part["attributes"];
            let places: Vec<[f32; 3]> = list(&attributes["POSITION"], 12)
                .iter()
                .map(|place| [0, 4, 8].map(|at| f32_at(place, at) as f32))
                .collect();
            let bounds =
                &json["accessors"][attributes["POSITION"].as_u64().expect("a number") as usize];
            for axis in 0..3 {
                let along = places.iter().map(|place| f64::from(place[axis]));
                assert_eq!(bounds["min"][axis], along.clone().fold(f64::INFINITY, f64::min));
                assert_eq!(bounds["max"][axis], along.fold(f64::NEG_INFINITY, f64::max));
            }
            let normals = list(&attributes["NORMAL"], 12);
            assert_eq!(normals.len(), places.len());
            // Up is y.
            let normal = |normal: &&[u8]| [0, 8, 4].map(|at| f32_at(normal, at));
            mesh.normals.extend(normals.iter().map(normal).map(|[x, y, z]| [x, -y, z]));
            let factor = &json["materials"][number]["pbrMetallicRoughness"]["baseColorFactor"];
            let parts = factor.as_array().expect("a color").iter();
            let bytes: Vec<u8> =
                parts.map(|part| encode(part.as_f64().expect("a number"))).collect();
            // Opacity is not light.
            let alpha = (255.0 * factor[3].as_f64().expect("a number")).round() as u8;
            mesh.colors.insert(hexadecimal(&[bytes[0], bytes[1], bytes[2], alpha]));
            if let Some(colors) = attributes.get("COLOR_0") {
                mesh.colors.clear();
                for color in list(colors, 8) {
                    let part = |at: usize| u16::from_le_bytes([color[at], color[at + 1]]);
                    let [red, green, blue] =
                        [0, 2, 4].map(|at| encode(f64::from(part(at)) / 65535.0));
                    mesh.colors.insert(hexadecimal(&[red, green, blue, alpha]));
                }
            }
            let indices = list(&part["indices"], 4);
            corners.extend(indices.iter().map(|index| places[u32_at(index, 0)]));
        }
        let welded = Self::weld(&corners);
        let turned = |[x, y, z]: [f64; 3]| [x, -z, y].map(|along| scale * along);
        mesh.vertices = welded.vertices.into_iter().map(turned).collect();
        mesh.triangles = welded.triangles;
        mesh
    }

    /// Reads what `zeroset` writes: an element in each line.
    fn three_mf(bytes: &[u8]) -> Self {
        let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
        for name in ["[Content_Types].xml", "_rels/.rels"] {
            archive.by_name(name).expect(name);
        }
        let mut text = String::new();
        let mut file = archive.by_name("3D/3dmodel.model").expect("a model");
        file.read_to_string(&mut text).expect("a text");
        let mut mesh = Self::default();
        let mut first = 0;
        let mut opened = Vec::new();
        for tag in text.split('<').skip(1).filter(|tag| !tag.starts_with('?')) {
            let (tag, _) = tag.split_once('>').expect("an end");
            let (name, rest) = tag.split_once(' ').unwrap_or((tag, ""));
            if let Some(name) = name.strip_prefix('/') {
                assert_eq!(opened.pop(), Some(name), "{tag}");
                continue;
            }
            if !tag.ends_with('/') {
                opened.push(name);
            }
            let value = |key: &str| {
                let start = rest.find(&format!("{key}=\"")).expect(key) + key.len() + 2;
                rest[start..].split('"').next().expect("an end").to_owned()
            };
            match name {
                "object" => {
                    first = mesh.vertices.len();
                    mesh.names.push(value("name").replace("&lt;", "<"));
                }
                "vertex" => mesh
                    .vertices
                    .push(["x", "y", "z"].map(|key| value(key).parse().expect("a number"))),
                "triangle" => mesh.triangles.push(
                    ["v1", "v2", "v3"]
                        .map(|key| first + value(key).parse::<usize>().expect("a number")),
                ),
                "base" => drop(mesh.colors.insert(value("displaycolor")[1..].to_lowercase())),
                "m:color" => drop(mesh.colors.insert(value("color")[1..].to_lowercase())),
                _ => {}
            }
        }
        assert!(opened.is_empty(), "{opened:?}");
        assert!(text.contains("<model unit=\"millimeter\""));
        let items = text.matches("<item objectid=").count();
        assert_eq!(items, mesh.names.len());
        mesh
    }

    /// Euler's number. Panics if an edge lacks one of its two triangles, or has one too many.
    fn closed_euler(&self) -> i64 {
        let mut edges = HashSet::new();
        for &[a, b, c] in &self.triangles {
            // Rounding to `f32` may join two corners.
            for [from, to] in [[a, b], [b, c], [c, a]].into_iter().filter(|[a, b]| a != b) {
                assert!(edges.insert([from, to]), "two triangles on one side of an edge");
            }
        }
        assert!(edges.iter().all(|&[from, to]| edges.contains(&[to, from])), "a hole");
        let flat = |t: &&[usize; 3]| t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
        let faces = self.triangles.len() - self.triangles.iter().filter(flat).count();
        self.vertices.len() as i64 - edges.len() as i64 / 2 + faces as i64
    }

    /// The volume inside, positive if the triangles face outward.
    fn volume(&self) -> f64 {
        let part = |triangle: &[usize; 3]| {
            let [a, b, c] = triangle.map(|vertex| self.vertices[vertex]);
            (0..3)
                .map(|k| a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3]))
                .sum::<f64>()
                / 6.0
        };
        self.triangles.iter().map(part).sum()
    }
}

fn f64_at(bytes: &[u8], at: usize) -> f64 {
    f64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight"))
}

fn f32_at(bytes: &[u8], at: usize) -> f64 {
    f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().expect("four")))
}

fn u32_at(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four")) as usize
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect::<Vec<_>>().concat()
}

/// The sRGB byte of an amount of light (IEC 61966-2-1).
fn encode(amount: f64) -> u8 {
    let share =
        if amount <= 0.003_130_8 { 12.92 * amount } else { 1.055 * amount.powf(1.0 / 2.4) - 0.055 };
    (255.0 * share).round() as u8
}

/// Meshes `text` into a file and reads it.
fn read(arguments: &[&str], file: &str) -> (Read, String) {
    let place = Sandbox::new();
    let run = place.run(&[&["mesh", "-o", file], arguments].concat()).ok();
    assert!(run.stdout.is_empty());
    assert_eq!(place.files(), [file]);
    let bytes = std::fs::read(place.path(file)).expect("written");
    let mesh = match file.rsplit_once('.').expect("an extension").1 {
        "stl" => Read::stl(&bytes),
        "ply" => Read::ply(&bytes),
        "glb" => Read::glb(&bytes),
        "3mf" => Read::three_mf(&bytes),
        _ => Read::obj(std::str::from_utf8(&bytes).expect("a text")),
    };
    (mesh, run.stderr)
}

#[test]
fn each_format_holds_the_same_closed_mesh() {
    let coarse = ["x^2+y^2+z^2 = 1", "--tolerance", "0.02"];
    let mut sizes = HashSet::new();
    for file in ["a.stl", "a.obj", "A.OBJ", "a.ply", "a.3mf", "a.glb"] {
        let (mesh, stderr) = read(&coarse, file);
        assert_eq!(mesh.closed_euler(), 2, "{file}");
        for vertex in &mesh.vertices {
            let radius = vertex.iter().map(|along| along * along).sum::<f64>().sqrt();
            assert!((radius - 1.0).abs() < 0.02, "{file}: {radius}");
        }
        let ball = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((mesh.volume() / ball - 1.0).abs() < 0.06, "{file}: {}", mesh.volume());
        let line = format!("{} triangles, closed; the shape is proven", mesh.triangles.len());
        assert!(stderr.contains(&line), "{stderr}");
        if !mesh.normals.is_empty() {
            assert_eq!(mesh.normals.len(), mesh.vertices.len(), "{file}");
        }
        sizes.insert((mesh.vertices.len(), mesh.triangles.len()));
    }
    assert_eq!(sizes.len(), 1, "{sizes:?}");
}

#[test]
fn a_solid_is_closed_by_its_domain() {
    let (mesh, _) = read(&["x^2+y^2 <= 0.25", "--domain", "1", "--tolerance", "0.01"], "a.ply");
    assert_eq!(mesh.closed_euler(), 2);
    let volume = std::f64::consts::FRAC_PI_2;
    assert!((mesh.volume() / volume - 1.0).abs() < 0.05, "{}", mesh.volume());
    let ends = mesh.vertices.iter().filter(|[_, _, z]| z.abs() == 1.0).count();
    assert!(ends > 10, "{ends}");
    let (_, stderr) = read(&["x^2+y^2 = 0.25", "--domain", "1", "--tolerance", "0.1"], "a.ply");
    assert!(stderr.contains("with an open rim; the shape is proven"), "{stderr}");
}

/// A solid may fill the domain around its surface. Then its mesh is closed at the domain's faces,
/// which have not moved.
#[test]
fn a_hollow_solid_is_closed_by_the_domain_around_its_surface() {
    let (mesh, log) = read(&["x^2+y^2+z^2 >= 1"], "hollow.stl");
    assert!(log.contains("bounded: proven; domain x, y, z in -1.12..1.12"), "{log}");
    let largest = mesh.vertices.iter().flatten().fold(0.0_f64, |all, one| all.max(one.abs()));
    assert!((largest - 1.12).abs() < 1e-3, "{largest}");
    assert_eq!(mesh.closed_euler(), 4);
}

/// A ball that is smaller than the tolerance keeps four triangles.
#[test]
fn a_tiny_ball_encloses_a_volume() {
    let ball = "x^2+y^2+(z-0.01)^2 <= 1e-7";
    let (mesh, _) = read(&[ball, "--domain", "1", "--tolerance", "0.1"], "tiny.stl");
    assert_eq!(mesh.closed_euler(), 2);
    assert!(mesh.triangles.len() >= 4 && mesh.volume() > 0.0, "{}", mesh.triangles.len());
}

/// The space between a flat surface and its domain is narrow. Tetrahedra may be larger.
#[test]
fn a_flat_part_has_few_triangles_before_edges_are_removed() {
    for text in ["box(2, 2, 0.2) <= 0", "subtract(box(2, 2, 0.2), cylinder(1, 1)) <= 0"] {
        let (mesh, _) = read(&[text, "--detail", "full"], "flat.ply");
        let count = mesh.triangles.len();
        assert!((1_000..60_000).contains(&count), "{text}: {count}");
    }
}

#[test]
fn an_equation_that_is_above_0_inside_faces_out() {
    let told = "its function is below 0 outside; the triangles face outside all the same";
    for (text, is_told) in [("1 = x^2+y^2+z^2", true), ("x^2+y^2+z^2 = 1", false)] {
        let (mesh, stderr) = read(&[text, "--tolerance", "0.05"], "a.ply");
        assert!(mesh.volume() > 4.0, "{text}: {}", mesh.volume());
        assert_eq!(stderr.contains(told), is_told, "{text}: {stderr}");
    }
}

#[test]
fn several_surfaces_are_several_objects() {
    let two = ["x^2+y^2+z^2 = 1\n(x-3)^2+y^2+z^2 <= r\nhidden\nz = 0", "-D", "r=0.5"];
    let two = [&two[..], &["--tolerance", "0.05"]].concat();
    for file in ["a.obj", "a.3mf", "a.glb"] {
        let (mesh, stderr) = read(&two, file);
        assert_eq!(mesh.closed_euler(), 4);
        assert_eq!(mesh.names.len(), 2, "{:?}", mesh.names);
        assert!(mesh.names[0].contains("= 1") && mesh.names[1].contains("<="), "{:?}", mesh.names);
        assert!(!stderr.contains("apart"), "{stderr}");
    }
    for (file, format) in [("a.stl", "STL"), ("a.ply", "PLY")] {
        let (mesh, stderr) = read(&two, file);
        assert_eq!(mesh.closed_euler(), 4);
        let told = format!("{format} keeps no surfaces apart: 2 are one object here");
        assert!(stderr.contains(&told), "{stderr}");
    }
}

#[test]
fn normals_are_of_the_surface_and_edges_have_two() {
    for file in ["a.obj", "a.ply", "a.glb"] {
        let ball = ["x^2+y^2+z^2 = 1", "--tolerance", "0.02", "--detail", "full"];
        let (mesh, _) = read(&ball, file);
        // Each vertex has one normal, in the order of the vertices except in GLB.
        if file != "a.glb" {
            for (place, normal) in mesh.vertices.iter().zip(&mesh.normals) {
                let along: f64 = (0..3).map(|k| place[k] * normal[k]).sum();
                assert!((along - 1.0).abs() < 1e-6, "{file}: {place:?} {normal:?}");
            }
        }
    }
    // A can: flat at its ends, which are its only faces that look up or down.
    for file in ["a.obj", "a.glb"] {
        let can = ["x^2+y^2 <= 0.25", "--domain=1", "--tolerance=0.02", "--detail", "full"];
        let (mesh, _) = read(&can, file);
        assert_eq!(mesh.closed_euler(), 2);
        assert!(mesh.normals.len() > mesh.vertices.len() + 10, "{file}");
        let (mut ends, mut sides) = (0, 0);
        for [x, y, z] in &mesh.normals {
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-6, "{file}");
            ends += usize::from(z.abs() > 0.999_999);
            sides += usize::from(z.abs() < 1e-3);
        }
        // A few slivers at the edges have other normals.
        let others = mesh.normals.len() - ends - sides;
        assert!(100 * others <= mesh.normals.len(), "{file}: {others}");
        assert!(ends > 10 && sides > 10, "{file}: {ends} {sides}");
    }
}

#[test]
fn colors_are_those_of_pictures() {
    let plain = ["color gold 50%\nx^2+y^2+z^2 = 1\ncolor auto\n(x-3)^2+y^2+z^2 = 1"];
    let plain = [&plain[..], &["--tolerance", "0.1"]].concat();
    for file in ["a.ply", "a.3mf", "a.glb"] {
        let colors = read(&plain, file).0.colors;
        assert_eq!(colors, ["ffd70080", "008769ff"].map(str::to_owned).into(), "{file}");
    }
    let mapped = ["color viridis(nz, -1, 1)\nx^2+y^2+z^2 <= 1", "--tolerance", "0.02"];
    for file in ["a.ply", "a.3mf", "a.glb"] {
        let mesh = read(&mapped, file).0;
        assert!(mesh.colors.len() > 100, "{file}: {}", mesh.colors.len());
        // The yellow end of the map is at a pole.
        assert!(mesh.colors.iter().any(|color| color.starts_with('f')), "{file}");
        for (place, value) in mesh.vertices.iter().zip(&mesh.values) {
            assert!((place[2] - value).abs() < 1e-6, "{place:?} {value}");
        }
        assert_eq!(mesh.values.is_empty(), file != "a.ply");
    }
    // Without a range, the map's ends are the least and the greatest value of the mesh.
    let mesh = read(&["color viridis(5*z)\nx^2+y^2+z^2 <= 1", "--tolerance", "0.02"], "a.ply").0;
    assert!(mesh.colors.contains("440154ff") && mesh.colors.contains("fde725ff"));
    assert!(mesh.values.iter().all(|value| value.abs() <= 5.0 + 1e-9));
}

#[test]
fn units_are_those_of_the_format() {
    let sphere = ["mesh", "x^2+y^2+z^2 = 1", "--tolerance", "0.1", "--unit", "inch"];
    let place = Sandbox::new();
    for file in ["a.3mf", "a.glb", "a.stl"] {
        let run = place.run(&[&sphere[..], &["-o", file]].concat()).ok();
        let told = run.stderr.contains("--unit changes nothing: only 3MF and GLB have units");
        assert_eq!(told, file == "a.stl", "{}", run.stderr);
    }
    let bytes = std::fs::read(place.path("a.3mf")).expect("written");
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("an archive");
    let mut text = String::new();
    archive.by_name("3D/3dmodel.model").expect("a model").read_to_string(&mut text).expect("text");
    assert!(text.contains("<model unit=\"inch\""));
    let mesh = Read::glb(&std::fs::read(place.path("a.glb")).expect("written"));
    let largest = mesh.vertices.iter().flatten().fold(0.0, |most: f64, along| most.max(*along));
    assert!((largest / 0.0254 - 1.0).abs() < 0.1, "{largest}");
}

#[test]
fn cells_that_are_not_proven_are_told_of() {
    let place = Sandbox::new();
    let cone = ["mesh", "x^2+y^2 = z^2", "--domain=-1,1,-1,1,-0.7,0.7", "--tolerance", "0.1"];
    let files = ["--json", "--strict", "--cells-unproven", "cells.npy", "-ocone.stl"];
    let run = place.run(&[&cone[..], &files].concat());
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    let report = run.json();
    let unproven = report["unproven"].as_u64().expect("a number");
    assert!(unproven > 0 && report["closed"] == false, "{report}");
    assert_eq!(report["domain"][5], 0.7);
    assert_eq!(report["surfaces"][0]["triangles"], report["triangles"]);
    let bytes = std::fs::read(place.path("cells.npy")).expect("written");
    let array = npyz::NpyFile::new(&bytes[..]).expect("an array");
    assert_eq!(array.shape(), [unproven, 6]);
    // The tip is the only singular point.
    let cells = array.into_vec::<f64>().expect("f64");
    for cell in cells.as_chunks::<6>().0 {
        let size = cell[3..].iter().copied().fold(0.0, f64::max);
        assert!(cell[3..].iter().all(|size| *size > 0.0), "{cell:?}");
        // Vertices around the tip that cannot be rounded are near, too.
        let near = (2.0 * size).max(0.01);
        assert!(cell[..3].iter().all(|place| place.abs() <= near), "{cell:?}");
    }
    assert!(place.path("cone.stl").exists());
    let run = place.run(&cone).code;
    assert_eq!(run, Some(2));
    let run = place.run(&[&cone[..], &["-o", "cone.obj"]].concat()).ok();
    let told = format!(
        "the shape is not proven in {unproven} of {} cells, one of them at (0.00",
        report["cells"]
    );
    assert!(run.stderr.contains(&told), "{}", run.stderr);
}

/// How a parametric surface crosses itself is told, and it is cut by the domain.
#[test]
fn a_parametric_mesh_tells_how_it_meets_itself() {
    let torus = "((2 + cos v) cos u, (2 + cos v) sin u, sin v) for u in [0, 2pi], v in [0, 2pi]";
    let (mesh, told) = read(&[torus], "a.ply");
    assert_eq!(mesh.closed_euler(), 0);
    assert!(told.contains("proven; no two triangles cross or touch: proven"), "{told}");
    let (mesh, told) = read(&[torus, "--domain=-4,0,-4,4,-4,4"], "a.ply");
    assert!(told.contains("with an open rim; at the same parameters"), "{told}");
    assert!(mesh.vertices.iter().all(|[x, ..]| *x <= 0.0) && mesh.vertices.len() > 100);
    let (_, told) = read(&["boy-surface"], "a.ply");
    assert!(told.contains("; it crosses itself: "), "{told}");
    assert!(told.contains(" pairs of triangles meet, one of them at ("), "{told}");
}

/// Claims are of one surface in a PLY file.
#[test]
fn claims_of_a_mesh_are_written() {
    let place = Sandbox::new();
    let ball = ["mesh", "x^2+y^2+z^2 = 1", "--tolerance", "0.05", "--json"];
    let files = ["-o", "a.ply", "--claims", "a.json"];
    let report = place.run(&[&ball[..], &files].concat()).ok().json();
    let claims = std::fs::read_to_string(place.path("a.json")).expect("claims");
    let claims: Value = serde_json::from_str(&claims).expect("an object");
    for (key, expected) in [("file", "a.ply"), ("text", "x^2+y^2+z^2 = 1")] {
        assert_eq!(claims[key], expected, "{claims}");
    }
    for key in ["closed", "oriented", "embedded"] {
        assert_eq!(claims[key], true, "{claims}");
    }
    for (key, expected) in [("euler", 2), ("crossing", 0)] {
        assert_eq!(claims[key], expected, "{claims}");
    }
    assert_eq!(claims["distance"], 0.05);
    assert_eq!(claims["triangles"], report["triangles"]);
    for wrong in [&["-o", "a.stl", "--claims", "a.json"][..], &["--claims", "a.json"]] {
        assert_eq!(place.run(&[&ball[..], wrong].concat()).code, Some(2));
    }
    let two = ["mesh", "x = 0; y = 0", "--domain", "1"];
    let run = place.run(&[&two[..], &files].concat());
    assert!(run.code == Some(2) && run.stderr.contains("of one surface"), "{}", run.stderr);
}

/// An estimated mesh is as near to the surface, and claims nothing.
#[test]
fn an_estimated_mesh_claims_nothing() {
    let ball = ["x^2+y^2+z^2 = 1", "--tolerance", "0.01", "--estimate"];
    let (mesh, told) = read(&ball, "a.ply");
    assert_eq!(mesh.closed_euler(), 2);
    for [x, y, z] in &mesh.vertices {
        let distance = (x * x + y * y + z * z).sqrt() - 1.0;
        assert!(distance.abs() < 0.01, "{distance}");
    }
    assert!(told.contains("nothing is proven"), "{told}");
    let place = Sandbox::new();
    let run = place.run(&[&["mesh"], &ball[..], &["--json", "--strict"]].concat());
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    let report = run.json();
    assert!(report["cells"].as_u64() > Some(0), "{report}");
    for count in ["unproven", "far"] {
        assert_eq!(report[count], report["cells"], "{report}");
    }
    // The solid fills the domain, so that no cell holds its surface.
    let full = ["mesh", "x^2+y^2+z^2 <= 100", "--domain", "1", "--estimate", "-oa.ply", "--strict"];
    let run = place.run(&full);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    assert!(run.stderr.contains("nothing is proven"), "{}", run.stderr);
    let empty = ["mesh", "x^2+y^2+z^2 = 100", "--domain", "1", "--estimate", "-ob.ply"];
    let run = place.run(&empty);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
}

/// A ball and a clip plane of a file cut its mesh.
#[test]
fn a_region_cuts_a_mesh() {
    let text = "domain ball 1\nclip 0,0,1,0\nx^2+y^2 <= 0.5";
    let (mesh, stderr) = read(&[text, "--tolerance", "0.1"], "a.obj");
    assert!(stderr.contains("closed; the shape is proven"), "{stderr}");
    assert_eq!(mesh.closed_euler(), 2);
    for [x, y, z] in &mesh.vertices {
        // The ball's surface is within the tolerance, and the plane is exact.
        assert!(*z <= 0.0 && (x * x + y * y + z * z).sqrt() < 1.1, "{x}, {y}, {z}");
    }
}

#[test]
fn notes_say_where_a_file_is_less_than_the_surface() {
    let far = ["(x-1e6)^2+y^2+z^2 = 1", "--domain", "999998,1000002,-2,2,-2,2"];
    // Rounded so, triangles may face either way.
    let place = Sandbox::new();
    let stderr = place.run(&[&["mesh", "-o", "a.stl"], &far[..]].concat()).ok().stderr;
    assert!(stderr.contains("STL rounds coordinates, by up to 6.0e-2"), "{stderr}");
    // The advice of the note is enough.
    assert!(stderr.contains("moved by (-1000000, 0, 0), about the origin, it is; with --tol"));
    let least = stderr.split("--tolerance ").nth(1).and_then(|rest| rest.split(' ').next());
    let near = ["x^2+y^2+z^2 = 1", "--domain", "-2,2,-2,2,-2,2"];
    for advised in [&near[..], &[&far[..], &["--tolerance", least.expect("a number")]].concat()] {
        let stderr = place.run(&[&["mesh", "-o", "a.stl"], advised].concat()).ok().stderr;
        assert!(stderr.contains("the shape is proven") && !stderr.contains("rounds"), "{stderr}");
    }
    // Two sheets that are nearer than the digits of a place near the origin.
    let wall = ["shell(sphere(1), 2e-7) <= 0", "--domain", "1.1", "--tolerance", "0.01"];
    let stderr = place.run(&[&["mesh", "-o", "a.stl"], &wall[..]].concat()).ok().stderr;
    assert!(stderr.contains("keep the shape: OBJ, PLY and 3MF have more digits"), "{stderr}");
    let (mesh, stderr) = read(&far, "a.ply");
    assert!(!stderr.contains("rounds"), "{stderr}");
    assert_eq!(mesh.closed_euler(), 2);
}

/// A solid of 1e-6 that no sample hits.
const SPECK: &str = "abs(x-0.0003)^1.5 + abs(y-0.0007)^1.5 + abs(z-0.0015)^1.5 <= 1e-9";

#[test]
fn mistakes_get_one_message_and_leave_no_file() {
    let sphere = "x^2+y^2+z^2 = 1";
    for (arguments, expected) in [
        (&[sphere][..], "nothing to write: add -o part.stl"),
        (&[sphere, "-o", "a.step"], "a mesh file ends in .stl, .obj, .ply, .3mf, .glb"),
        (&[sphere, "-o", "-"], "a mesh file ends in"),
        (&[sphere, "-o", "none/a.stl"], "there is no directory 'none'"),
        (&[sphere, "-o", "a.stl", "--cells-unproven", "a.stl"], "given for two outputs"),
        (&[sphere, "--json", "--cells-unproven", "-"], "only one thing"),
        (&[sphere, "-o", "a.stl", "--tolerance", "0"], "--tolerance needs a finite number above 0"),
        (&[sphere, "-o", "a.stl", "--tolerance", "-1"], "--tolerance needs"),
        (&[sphere, "-o", "a.stl", "--tolerance", "nan"], "--tolerance needs"),
        (&[sphere, "-o", "a.stl", "--threads", "0"], "--threads must be between"),
        (&[sphere, "-o", "a.stl", "--budget", "0"], "--budget 0: without time"),
        (&[sphere, "-o", "a.stl", "--budget", "1e-9"], "not done within 0.000000001 s"),
        (&["x^2+y^2+", "-o", "a.stl"], "missing"),
        (&["x-x", "-o", "a.stl", "--domain", "1"], "every point is a zero"),
        (&["a = 2", "-o", "a.stl"], "nothing to draw"),
        (&["x^2+y^2+z^2 = -1", "-o", "a.stl"], "proven empty"),
        (&[sphere, "-o", "a.stl", "--domain", "5,6,5,6,5,6"], "lies elsewhere: try --domain"),
        (
            &[SPECK, "-o", "a.stl", "--domain", "1", "--tolerance", "0.1"],
            "may still hold a point of the surface, which may be thinner than 1.00e-1 there: try a \
             smaller --tolerance, or --domain ",
        ),
        (
            &["z = 5", "-o", "a.stl", "--domain", "2"],
            "the surface is proven to have no point in the domain; try --domain ",
        ),
        (&["hidden\nz = 1", "-o", "a.stl", "--domain", "2"], "every surface is hidden"),
        (&["sqrt(x-9) = y", "-o", "a.stl", "--domain", "2"], "no value anywhere in the domain"),
    ] {
        let place = Sandbox::new();
        let run = place.run(&[&["mesh"], arguments].concat());
        assert_eq!(run.code, Some(2), "{arguments:?}: {}", run.stderr);
        assert!(run.stderr.contains(expected), "{arguments:?}: {}", run.stderr);
        assert_eq!(run.stderr.matches("error: ").count(), 1, "{arguments:?}: {}", run.stderr);
        assert!(run.stdout.is_empty() && place.files().is_empty(), "{arguments:?}");
    }
}

/// At the prompt, what the picture shows is written and measured.
#[test]
fn the_prompt_writes_and_measures_surfaces() {
    let place = Sandbox::new();
    let lines =
        b"x^2+y^2+z^2 <= 1\n:clip 0,0,1,0\n:mesh my part.ply 0.1\n:measure\n:mesh part.dxf\n";
    let run = place.run_with(&["--preview"], lines);
    let shown = String::from_utf8_lossy(&run.stdout).into_owned() + &run.stderr;
    assert!(shown.contains("saved 'my part.ply'"), "{shown}");
    assert!(shown.contains("closed; the shape is proven"), "{shown}");
    // Half of a ball.
    assert!(shown.contains("volume      2.09"), "{shown}");
    assert!(shown.contains("part.dxf"), "{shown}");
    let mesh = Read::ply(&std::fs::read(place.path("my part.ply")).expect("a file"));
    assert_eq!(mesh.closed_euler(), 2);
    assert!(mesh.vertices.iter().all(|vertex| vertex[2] < 1e-6));
    assert!(!place.path("part.dxf").exists());
}
