//! Checks the parametric surfaces of the gallery: each file is read without a note, and each
//! surface is what its name promises. Curvatures are computed from differences of positions.

use crate::words::value_in;
use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use zeroset_interval::Interval;
use zeroset_ir::{Constant, NodeId};
use zeroset_syntax::{Document, Options, read};

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/parametric");

/// Step of the differences. Its fourth power is below the tolerance.
const STEP: f64 = 1.0 / 1024.0;
const TOLERANCE: f64 = 1e-6;

/// The parameters at these shares of their ranges, where the surfaces are smooth.
const SHARES: [[f64; 2]; 5] =
    [[0.137, 0.381], [0.291, 0.713], [0.423, 0.219], [0.617, 0.839], [0.871, 0.577]];

type Pair = fn(f64, f64) -> (f64, f64);

/// A property that a surface's name promises.
enum Promise {
    /// The mean curvature is 0.
    Minimal,
    /// The Gauss curvature.
    Curvature(f64),
    /// One principal curvature is that of a circle of this radius.
    Tube(f64),
    /// This function is 0.
    Zero(fn(f64, f64, f64) -> f64),
    /// These parameters give the same point.
    Same(Pair),
}

use Promise::{Curvature, Minimal, Same, Tube, Zero};

#[rustfmt::skip] // one promise a line
const PROMISES: &[(&str, Promise)] = &[
    ("astroidal-ellipsoid", Zero(|x, y, z| x.cbrt().powi(2) + y.cbrt().powi(2) + z.cbrt().powi(2) - 1.0)),
    ("bohemian-dome", Zero(|x, y, z| {
        let (a, b) = (1.0 - z * z, 0.36 - x * x);
        (y * y - a - b).powi(2) - 4.0 * a * b
    })),
    ("bour-surface", Minimal),
    ("boy-surface", Same(|u, v| (u + PI, PI - v))),
    ("catalan-surface", Minimal),
    ("catenoid", Minimal),
    ("cross-cap", Zero(|x, y, z| {
        let square = x * x + z * z;
        (y * y + 2.0 * square - 2.0 * z).powi(2) - 4.0 * square * (1.0 - z).powi(2)
    })),
    ("dini-surface", Curvature(-1.0 / 1.04)),
    ("eight-surface", Zero(|x, y, z| x * x + y * y - z * z * (1.0 - z * z))),
    ("enneper-surface", Minimal),
    ("enneper-surface-of-order-3", Minimal),
    ("helicoid-to-catenoid", Minimal),
    ("henneberg-surface", Minimal),
    ("henneberg-surface", Same(|u, v| (-u, v + PI))),
    ("hyperboloid-of-lines", Zero(|x, y, z| x * x + y * y - z * z - 1.0)),
    ("klein-bottle-of-figure-8", Same(|u, v| (u + TAU, -v))),
    ("klein-bottle-with-a-neck", Same(|u, v| (u + PI, PI - v))),
    ("kuen-surface", Curvature(-1.0)),
    ("lissajous-tube", Tube(0.08)),
    ("moebius-strip", Same(|u, v| (u + TAU, -v))),
    ("monkey-saddle", Zero(|x, y, z| z - x * (x * x - 3.0 * y * y))),
    ("pluecker-conoid", Zero(|x, y, z| z * (x * x + y * y) - 1.2 * x * y)),
    ("pseudosphere", Curvature(-1.0)),
    ("richmond-surface", Minimal),
    ("roman-surface-by-angles", Zero(|x, y, z| (x * y).powi(2) + (y * z).powi(2) + (z * x).powi(2) - x * y * z)),
    ("sievert-surface", Curvature(1.0)),
    ("torus-knot-tube", Tube(0.32)),
    ("trefoil-tube", Tube(0.5)),
    ("twisted-torus", Same(|u, v| (u + TAU, v + PI))),
    ("umbilic-torus", Same(|u, v| (u + TAU, v - TAU / 3.0))),
    ("whitney-umbrella-by-lines", Zero(|x, y, z| x * x - y * y * z)),
];

fn document(slug: &str) -> Document {
    let path = format!("{FOLDER}/{slug}.zset");
    let text = std::fs::read_to_string(&path).expect("a text");
    read(&text, &Options::default())
        .unwrap_or_else(|errors| panic!("{}", errors.render(Some(&path), &text, false)))
}

/// Some values of a document's parametric surface at (u, v).
fn evaluated(document: &Document, roots: &[NodeId], u: f64, v: f64) -> Vec<f64> {
    let point =
        [u, v, 0.0].map(|value| Constant::enclosed(Interval::point(value).expect("finite")));
    let parameters: Vec<Constant> =
        document.parameters.iter().map(|parameter| parameter.value.clone()).collect();
    let value = |root: &NodeId| {
        let graph = &document.patches.graph;
        let bounds = value_in(graph, &parameters, *root, &point).expect("a value").bounds();
        f64::midpoint(bounds.lo, bounds.hi)
    };
    roots.iter().map(value).collect()
}

fn place(document: &Document, u: f64, v: f64) -> DVec3 {
    DVec3::from_slice(&evaluated(document, &document.patches.all[0].at, u, v))
}

/// The mean curvature, up to its sign, and the Gauss curvature.
fn curvatures(document: &Document, u: f64, v: f64) -> (f64, f64) {
    let at = |i: i32, j: i32| place(document, u + f64::from(i) * STEP, v + f64::from(j) * STEP);
    // Differences of the fourth order.
    let slope = |[a, b, c, d]: [DVec3; 4]| (a - 8.0 * b + 8.0 * c - d) / (12.0 * STEP);
    let bend = |[a, b, c, d]: [DVec3; 4]| {
        (16.0 * (b + c) - a - d - 30.0 * at(0, 0)) / (12.0 * STEP * STEP)
    };
    let along_u = |j: i32| [-2, -1, 1, 2].map(|i| at(i, j));
    let along_v = [-2, -1, 1, 2].map(|j| at(0, j));
    let (su, sv) = (slope(along_u(0)), slope(along_v));
    let (suu, svv) = (bend(along_u(0)), bend(along_v));
    let suv = slope([-2, -1, 1, 2].map(|j| slope(along_u(j))));
    let normal = su.cross(sv).normalize();
    let (first, mixed, last) = (su.dot(su), su.dot(sv), sv.dot(sv));
    let (e, f, g) = (suu.dot(normal), suv.dot(normal), svv.dot(normal));
    let area = first * last - mixed * mixed;
    ((e * last - 2.0 * f * mixed + g * first) / (2.0 * area), (e * g - f * f) / area)
}

/// How far a surface is from its promise at (u, v).
fn error(document: &Document, promise: &Promise, u: f64, v: f64) -> f64 {
    let at = place(document, u, v);
    match promise {
        Zero(function) => function(at.x, at.y, at.z).abs(),
        Same(other) => {
            let (u, v) = other(u, v);
            (place(document, u, v) - at).length()
        }
        Minimal => {
            let (mean, gauss) = curvatures(document, u, v);
            mean.abs() / (1.0 + gauss.abs().sqrt())
        }
        Curvature(curvature) => (curvatures(document, u, v).1 - curvature).abs(),
        Tube(radius) => {
            let (mean, gauss) = curvatures(document, u, v);
            (1.0 - 2.0 * mean.abs() * radius + gauss * radius * radius).abs()
        }
    }
}

fn slugs() -> Vec<String> {
    let files = std::fs::read_dir(FOLDER).expect("the files are there");
    let names = files.map(|file| file.expect("a file").file_name().into_string().expect("UTF-8"));
    names.filter_map(|name| name.strip_suffix(".zset").map(str::to_owned)).collect()
}

#[test]
fn every_parametric_example_reads_without_a_note() {
    let slugs = slugs();
    for slug in &slugs {
        let document = document(slug);
        assert_eq!((document.patches.all.len(), document.surfaces.len()), (1, 0), "{slug}");
        assert!(document.title.is_some(), "{slug}");
        let notes: Vec<String> = document.notes.iter().map(zeroset_parser::Note::message).collect();
        assert!(notes.is_empty(), "{slug}: {notes:?}");
    }
    assert!(slugs.len() >= 30, "{}", slugs.len());
}

#[test]
fn parametric_surfaces_are_what_their_names_promise() {
    let mut report = String::new();
    for (slug, promise) in PROMISES {
        let document = document(slug);
        let ends = &document.patches.all[0].ends;
        for [at_u, at_v] in SHARES {
            let ends = evaluated(&document, ends.as_flattened(), 0.0, 0.0);
            let u = ends[0] + at_u * (ends[1] - ends[0]);
            let v = ends[2] + at_v * (ends[3] - ends[2]);
            let error = error(&document, promise, u, v);
            if error.is_nan() || error > TOLERANCE {
                writeln!(report, "{slug} at ({u}, {v}): {error}").unwrap();
            }
        }
    }
    assert!(report.is_empty(), "{report}");
}

#[test]
fn other_surfaces_break_these_promises() {
    // A sphere is neither minimal nor a tube of radius 2, and its curvature is not −1.
    let text = "(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-1, 1]";
    let sphere = read(text, &Options::default()).expect("reads");
    for promise in [Minimal, Tube(2.0), Curvature(-1.0), Zero(|x, y, _| x - y)] {
        assert!(error(&sphere, &promise, 0.3, 0.4) > 0.1);
    }
    assert!(error(&sphere, &Curvature(1.0), 0.3, 0.4) < TOLERANCE);
    assert!(error(&sphere, &Tube(1.0), 0.3, 0.4) < TOLERANCE);
}
