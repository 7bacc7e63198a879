//! The command `mesh`. Its files are read back here by readers of their own.

use crate::cli_support::Sandbox;
use std::collections::{HashMap, HashSet};

/// A mesh as read from a file.
#[derive(Default)]
struct Read {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    names: Vec<String>,
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
        let count = u32::from_le_bytes(bytes[80..84].try_into().expect("four")) as usize;
        assert_eq!(bytes.len(), 84 + 50 * count);
        assert!(!bytes.starts_with(b"solid"));
        let mut corners = Vec::new();
        for record in bytes[84..].as_chunks::<50>().0 {
            let floats: Vec<f32> =
                record[..48].as_chunks().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
            let [normal, a, b, c] = floats.as_chunks::<3>().0 else { panic!("twelve floats") };
            let length = normal.iter().map(|along| along * along).sum::<f32>();
            let toward: f32 = (0..3).map(|k| normal[k] * cross(a, b, c)[k]).sum();
            assert!((length - 1.0).abs() < 1e-5 && toward > 0.0 || length == 0.0, "{normal:?}");
            corners.extend([*a, *b, *c]);
        }
        Self::weld(&corners)
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
                ("f", [a, b, c]) => mesh
                    .triangles
                    .push([a, b, c].map(|word| word.parse::<usize>().expect("a vertex") - 1)),
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
        let (vertices, faces) = bytes[start + end.len()..].split_at(24 * count("element vertex"));
        assert_eq!(faces.len(), 13 * count("element face"));
        let floats: Vec<f64> =
            vertices.as_chunks().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect();
        let triangle = |face: &[u8; 13]| {
            assert_eq!(face[0], 3);
            let (numbers, _) = face[1..].as_chunks::<4>();
            [0, 1, 2].map(|k| i32::from_le_bytes(numbers[k]) as usize)
        };
        Self {
            vertices: floats.as_chunks().0.to_vec(),
            triangles: faces.as_chunks().0.iter().map(triangle).collect(),
            names: Vec::new(),
        }
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

/// Twice a triangle's area, as a vector.
fn cross(a: &[f32; 3], b: &[f32; 3], c: &[f32; 3]) -> [f32; 3] {
    let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| c[k] - a[k]));
    [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3])
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
        _ => Read::obj(std::str::from_utf8(&bytes).expect("a text")),
    };
    (mesh, run.stderr)
}

#[test]
fn each_format_holds_the_same_closed_mesh() {
    let coarse = ["x^2+y^2+z^2 = 1", "--tolerance", "0.02"];
    let mut sizes = HashSet::new();
    for file in ["a.stl", "a.obj", "A.OBJ", "a.ply"] {
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

#[test]
fn several_surfaces_are_several_objects() {
    let two = ["x^2+y^2+z^2 = 1\n(x-3)^2+y^2+z^2 <= r\nhidden\nz = 0", "-D", "r=0.5"];
    let two = [&two[..], &["--tolerance", "0.05"]].concat();
    let (mesh, stderr) = read(&two, "a.obj");
    assert_eq!(mesh.closed_euler(), 4);
    assert_eq!(mesh.names.len(), 2, "{:?}", mesh.names);
    assert!(mesh.names[0].contains("= 1") && mesh.names[1].contains("<="), "{:?}", mesh.names);
    assert!(!stderr.contains("apart"), "{stderr}");
    for (file, format) in [("a.stl", "STL"), ("a.ply", "PLY")] {
        let (mesh, stderr) = read(&two, file);
        assert_eq!(mesh.closed_euler(), 4);
        let told = format!("{format} keeps no surfaces apart: 2 are one object here");
        assert!(stderr.contains(&told), "{stderr}");
    }
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
        assert!(cell[..3].iter().all(|place| place.abs() <= 2.0 * size), "{cell:?}");
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

/// A ball and a clip plane of a file cut its mesh.
#[test]
fn a_region_cuts_a_mesh() {
    let text = "domain ball 1\nclip 0,0,1,0\nx^2+y^2 <= 0.5";
    let (mesh, stderr) = read(&[text, "--tolerance", "0.1"], "a.obj");
    assert!(stderr.contains("closed; the shape is proven"), "{stderr}");
    assert_eq!(mesh.closed_euler(), 2);
    for [x, y, z] in &mesh.vertices {
        assert!(*z < 1e-6 && x * x + y * y + z * z < 1.0 + 1e-6, "{x}, {y}, {z}");
    }
}

#[test]
fn notes_say_where_a_file_is_less_than_the_surface() {
    let far = ["(x-1e6)^2+y^2+z^2 = 1", "--domain", "999998,1000002,-2,2,-2,2"];
    // Rounded so, triangles may face either way.
    let place = Sandbox::new();
    let stderr = place.run(&[&["mesh", "-o", "a.stl"], &far[..]].concat()).ok().stderr;
    assert!(stderr.contains("STL rounds coordinates, by up to 6.0e-2"), "{stderr}");
    let (mesh, stderr) = read(&far, "a.ply");
    assert!(!stderr.contains("rounds"), "{stderr}");
    assert_eq!(mesh.closed_euler(), 2);
}

#[test]
fn mistakes_get_one_message_and_leave_no_file() {
    let sphere = "x^2+y^2+z^2 = 1";
    for (arguments, expected) in [
        (&[sphere][..], "nothing to write: add -o part.stl"),
        (&[sphere, "-o", "a.step"], "a mesh file ends in .stl, .obj, .ply"),
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
