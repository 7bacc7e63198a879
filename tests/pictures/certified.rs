//! Comparison of the certified tracer with the exact first roots of the gallery and of difficult
//! formulas. The exact roots were found by different methods, without this project's kernels.
//!
//! All rays: `ZEROSET_STRIDE=1 cargo test --release --test all certified -- --nocapture`.

use super::truth_support::{Pixel, SIDE, Truth, View, path, read};
use rayon::prelude::*;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs::File;
use zeroset_scene::gallery::example;
use zeroset_syntax::{Options, read as read_document};
use zeroset_testkit::certified::{BUDGET, Certificate, Function, Line, UnresolvedReason};

/// Tolerance of distances, relative to 1 + distance. The reference rounded its rays differently. On
/// a grazing ray, this moves the root by more than the rounding error.
const ROUNDING: f64 = 1e-9;

fn stride() -> usize {
    let text = std::env::var("ZEROSET_STRIDE").unwrap_or_else(|_| "61".to_owned());
    text.parse().expect("ZEROSET_STRIDE is a number")
}

/// The function of a text with a single surface.
fn function(slug: &str, text: &str) -> Function {
    let document = read_document(text, &Options::default())
        .unwrap_or_else(|errors| panic!("{slug}: {errors}"));
    assert_eq!(document.surfaces.len(), 1, "{slug}");
    let parameters: Vec<_> = document.parameters.iter().map(|p| p.value.clone()).collect();
    Function::new(&document.graph, document.surfaces[0].root, &parameters)
}

fn from_gallery(slug: &str) -> Function {
    let example = example(slug).unwrap_or_else(|| panic!("no example {slug}"));
    function(slug, example.text)
}

type Vector = [f64; 3];

fn normalised(v: Vector) -> Vector {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The ray of a pixel, by the formula that the reference states.
fn line(view: &View, index: usize) -> Line {
    let (i, j) = ((index % SIDE) as f64, (index / SIDE) as f64);
    let forward = normalised([0, 1, 2].map(|k| view.target[k] - view.eye[k]));
    let right = normalised(cross(forward, view.up));
    let up = cross(right, forward);
    let scale = (view.fov.to_radians() / 2.0).tan();
    let across = (2.0 * (i + 0.5) / SIDE as f64 - 1.0) * scale;
    let upward = (1.0 - 2.0 * (j + 0.5) / SIDE as f64) * scale;
    let direction = [0, 1, 2].map(|k| forward[k] + across * right[k] + upward * up[k]);
    Line { eye: view.eye, direction: normalised(direction) }
}

/// Result of comparing a certificate with the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Outcome {
    /// The reference does not decide the ray.
    Open,
    /// Certificate and reference have the same first root, or none.
    Agrees,
    /// The certificate leaves parts of the ray unresolved. Holds the reason of the first such part.
    CannotKnow(UnresolvedReason),
    /// Certificate and reference contradict each other.
    Differs,
}

/// Compares every claim of the certificate with the reference, including claims about the ray
/// behind an unresolved piece.
fn judge(certificate: &Certificate, pixel: &Pixel) -> Outcome {
    if pixel.open {
        return Outcome::Open;
    }
    let within = |near: f64, far: f64, distance: f64| {
        let room = ROUNDING * (1.0 + distance);
        near - room <= distance && distance <= far + room
    };
    let open = |d: f64| certificate.unresolved.iter().any(|piece| within(piece.near, piece.far, d));
    let crosses = |d: f64| certificate.crossing.is_some_and(|c| within(c.near, c.far, d));
    let known = |d: f64| d.is_infinite() || open(d) || crosses(d);
    let crossing = match certificate.crossing {
        // The reference has this crossing, too, or an earlier one.
        Some(crossing) => pixel.crossing <= crossing.far + ROUNDING * (1.0 + crossing.far),
        None => true,
    };
    if !(known(pixel.zero) && known(pixel.crossing) && crossing) {
        return Outcome::Differs;
    }
    certificate
        .unresolved
        .first()
        .map_or(Outcome::Agrees, |piece| Outcome::CannotKnow(piece.reason))
}

/// The number of rays by outcome, a description of each ray that differs, and evaluations per ray.
fn survey(function: &Function, truth: &Truth) -> (BTreeMap<Outcome, usize>, Vec<String>, f64) {
    let stride = stride();
    let [x0, x1, y0, y1, z0, z1] = truth.view.domain;
    let region = [[x0, x1], [y0, y1], [z0, z1]];
    let rays: Vec<usize> = (0..truth.pixels.len()).step_by(stride).collect();
    let outcomes: Vec<(usize, Outcome, Certificate)> = rays
        .into_par_iter()
        .map(|index| {
            let certificate = function.trace(&line(&truth.view, index), &region, BUDGET);
            (index, judge(&certificate, &truth.pixels[index]), certificate)
        })
        .collect();
    let mut counts = BTreeMap::new();
    let mut differ = Vec::new();
    let mut evaluations = 0.0;
    for (index, outcome, certificate) in &outcomes {
        *counts.entry(*outcome).or_insert(0) += 1;
        evaluations += f64::from(certificate.evaluations);
        if *outcome == Outcome::Differs {
            let (slug, i, j) = (&truth.view.slug, index % SIDE, index / SIDE);
            let pixel = truth.pixels[*index];
            differ.push(format!("{slug}, column {i}, row {j}: {certificate:?} but {pixel:?}"));
        }
    }
    (counts, differ, evaluations / outcomes.len() as f64)
}

/// Compares functions with their references. No ray may differ, and `share` percent must agree.
fn expect_agreement(suite: impl Iterator<Item = (Function, Truth)>, share: usize) {
    println!("ZEROSET_STRIDE={}", stride());
    let mut differ = Vec::new();
    let mut total: BTreeMap<Outcome, usize> = BTreeMap::new();
    for (function, truth) in suite {
        let (counts, found, evaluations) = survey(&function, &truth);
        println!("{}: {counts:?}, {evaluations:.0} evaluations a ray", truth.view.slug);
        for (outcome, count) in counts {
            *total.entry(outcome).or_default() += count;
        }
        differ.extend(found);
    }
    println!("all: {total:?}");
    assert!(differ.is_empty(), "{} differ:\n{}", differ.len(), differ.join("\n"));
    let agree = total.get(&Outcome::Agrees).copied().unwrap_or(0);
    let rays: usize = total.values().sum();
    assert!(agree * 100 > rays * share, "{total:?}");
}

#[test]
fn the_certified_tracer_agrees_with_the_exact_roots_of_the_gallery() {
    let truths = read("truth").into_iter();
    expect_agreement(truths.map(|truth| (from_gallery(&truth.view.slug), truth)), 90);
}

#[derive(Deserialize)]
struct Case {
    slug: String,
    formula: String,
}

#[test]
fn the_certified_tracer_agrees_with_the_exact_roots_of_difficult_formulas() {
    let file = File::open(path("stability/index.json")).expect("a list");
    let cases: Vec<Case> = serde_json::from_reader(file).expect("a valid list");
    let truths = read("stability");
    assert!(cases.iter().map(|case| &case.slug).eq(truths.iter().map(|truth| &truth.view.slug)));
    let functions = cases.into_iter().map(|case| function(&case.slug, &case.formula));
    expect_agreement(functions.zip(truths), 50);
}

#[test]
fn a_wrong_certificate_is_noticed() {
    let truths = read("truth");
    let sphere = truths.iter().find(|truth| truth.view.slug == "sphere").expect("a sphere");
    let region = [[sphere.view.domain[0], sphere.view.domain[1]]; 3];
    let middle = SIDE * SIDE / 2 + SIDE / 2;
    let pixel = sphere.pixels[middle];
    let function = from_gallery("sphere");
    let right = function.trace(&line(&sphere.view, middle), &region, BUDGET);
    assert_eq!(judge(&right, &pixel), Outcome::Agrees);
    let miss = Certificate { crossing: None, ..right.clone() };
    assert_eq!(judge(&miss, &pixel), Outcome::Differs);
    let moved = |by: f64| {
        let mut certificate = right.clone();
        let crossing = certificate.crossing.as_mut().expect("a crossing");
        (crossing.near, crossing.far) = (crossing.near + by, crossing.far + by);
        judge(&certificate, &pixel)
    };
    assert_eq!([moved(1e-6), moved(-1e-6)], [Outcome::Differs; 2]);
    let none = Pixel { crossing: f64::INFINITY, zero: f64::INFINITY, open: false };
    assert_eq!(judge(&right, &none), Outcome::Differs);
}
