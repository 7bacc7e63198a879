//! The default method on the formulas of `stability`: no proof is false, and no more pixels are
//! undecided than wanted.

use super::property_support::claims;
use super::stability::{Case, cases, check_zero_throughout, document, picture_with, region};
use super::truth_support::{Pixel, SIDE, read};
use zeroset_render::model::render;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_space::{Camera, Projection};
use zeroset_testkit::property::{Formula, Scene, picture as check_claims};
use zeroset_trace::{RayGrid, Status, TraceOptions, UndecidedReason};

/// Settings with a tolerance near the reference's accuracy.
fn settings() -> Settings {
    let (width, height) = (SIDE, SIDE);
    Settings {
        options: TraceOptions { tolerance: 5e-4, ..TraceOptions::default() },
        width,
        height,
        brackets: true,
        ..Settings::default()
    }
}

/// Describes a claim about a ray, if the ray's roots contradict it.
fn contradiction(pixel: &Pixel, picture: &Picture, index: usize) -> Option<String> {
    let buffer = &picture.buffer;
    let (status, distance, drawn) =
        (buffer.status[index], buffer.distance(index), buffer.drawn[index]);
    // Tolerance for the rounding of the reference's rays.
    let room = 1e-9 * (1.0 + pixel.zero.min(1e9));
    let is_false = match status {
        Status::Miss => pixel.zero.is_finite(),
        Status::Undecided => distance > pixel.zero + room,
        Status::Hit => {
            let [near, far] = buffer.bracket[index];
            !(near - room <= pixel.zero && pixel.zero <= far + room)
        }
    };
    let bracket = buffer.bracket[index];
    let place = (index % SIDE, index / SIDE);
    is_false.then(|| {
        format!("{place:?}: {status:?} at {distance} in {bracket:?}, painted at {drawn}: {pixel:?}")
    })
}

/// Cases with more undecided pixels than they should have, each with the reason.
const TOO_MUCH: [(&str, &str); 1] =
    [("steps", "surfaces lie in faces of the domain: no sign is known beyond")];

#[test]
fn proofs_are_true_and_little_is_undecided() {
    let mut failures = Vec::new();
    for (case, truth) in cases("stability/index.json").iter().zip(read("stability")) {
        let Case { slug, max_undecided, .. } = case;
        let picture = picture_with(case, &truth, &settings());
        let decided = truth.pixels.iter().enumerate().filter(|(_, pixel)| !pixel.open);
        let claims: Vec<String> =
            decided.filter_map(|(index, pixel)| contradiction(pixel, &picture, index)).collect();
        let counts = picture.buffer.counts();
        let phantoms = truth.pixels.iter().enumerate().filter(|(index, pixel)| {
            picture.buffer.is_drawn(*index) && !pixel.open && pixel.zero == f64::INFINITY
        });
        let phantoms = phantoms.count();
        let share = counts.undecided as f64 / (SIDE * SIDE) as f64;
        println!(
            "{slug:18} miss {:4} hit {:4} undecided {:4} {:6.2} % of {:6.2} {:?} phantoms {phantoms}",
            counts.miss,
            counts.hit,
            counts.undecided,
            100.0 * share,
            100.0 * max_undecided,
            UndecidedReason::ALL
                .map(UndecidedReason::name)
                .iter()
                .zip(picture.buffer.reasons())
                .filter(|(_, n)| *n > 0)
                .collect::<Vec<_>>(),
        );
        let reason = TOO_MUCH.iter().find(|(known, _)| known == slug).map(|(_, why)| why);
        if (share <= *max_undecided) != reason.is_none() {
            failures.push(format!("{slug}: {:.2} % undecided, {reason:?}", 100.0 * share));
        }
        failures.extend(claims.iter().take(5).map(|claim| format!("{slug}, {claim}")));
        let normals = &picture.buffer.normal;
        assert!(normals.iter().flatten().all(|part| part.is_finite()), "{slug}");
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Compares claims of a picture with the certified tracer.
fn check_against_certified(case: &Case, camera: &Camera, picture: &Picture) {
    let [x0, x1, y0, y1, z0, z1] = case.domain;
    let formula = Formula::from_text(&case.formula, [[x0, x1], [y0, y1], [z0, z1]]).expect("reads");
    let Projection::Perspective { fov } = camera.projection() else { panic!("the default") };
    let scene = Scene {
        formula,
        eye: camera.eye().to_array(),
        target: camera.target().to_array(),
        up: camera.up().to_array(),
        fov: Ok(fov),
        size: [SIDE; 2],
        depth: 10,
        tolerance: 0.5,
        precision: "auto",
    };
    let some: Vec<_> = claims(&scene, camera, picture).into_iter().step_by(37).collect();
    let tally =
        check_claims(&scene, &|_| Some(some.clone())).unwrap_or_else(|failure| panic!("{failure}"));
    println!("{}: {tally:?}", case.slug);
    assert!(tally.compared > 100);
}

#[test]
fn what_has_no_single_roots_is_refused_or_undecided() {
    for case in cases("stability/others.json") {
        let (region, document) = (region(&case), document(&case));
        let camera = camera::camera(&CameraChoice::typed(&document), &region).expect("a camera");
        let picture = match render(&document, &region, &camera, &settings()) {
            Ok(picture) => picture,
            Err(error) => {
                assert_eq!(case.expect, "refused-or-undecided", "{}: {error}", case.slug);
                continue;
            }
        };
        let counts = picture.buffer.counts();
        println!("{}: {counts:?} {:?}", case.slug, picture.why_undecided());
        match case.expect.as_str() {
            "undecided-from-entry" => {
                check_zero_throughout(&case, &RayGrid::new(&camera, SIDE, SIDE), &picture);
            }
            "refused-or-undecided" => {
                assert!(counts.hit + counts.undecided > 0, "{}", case.slug);
                check_against_certified(&case, &camera, &picture);
            }
            other => panic!("{}: {other}?", case.slug),
        }
        assert!(picture.buffer.normal.iter().flatten().all(|part| part.is_finite()));
    }
}
