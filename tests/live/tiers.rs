//! The first picture of a formula is drawn by kernels that were compiled in a hurry. They are then
//! compiled again. Pictures do not tell which kernels drew them.

use super::live_support::{LIMIT, settled, start};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::gallery::examples;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::Camera;
use zeroset_syntax::{Document, Options, read};
use zeroset_trace::GBuffer;

/// Formulas beside the gallery: a solid, a pole, jumps, choices, and a union of many parts.
const MORE: [&str; 5] = [
    "domain 2\nx^2+y^2+z^2 <= 1 + 0.1*sin(9*x)",
    "domain 2\n1/(x^2+y^2) = z + tan(x)",
    "domain 2\nfloor(2*x)/2 + mod(y, 1) = z",
    "domain 2\nif x > 0 then max(abs(y), z) - 1 else atan2(y, x) + ln(z + 3) - asin(y/3)",
    "domain 2\nmin(x^2+y^2-1/4, abs(z) - exp(x)/4, x^(2/3) + y^2 - 1) = 0",
];

fn document(text: &str) -> Document {
    read(text, &Options::default()).expect("reads")
}

fn traced(model: &Model, camera: &Camera, settings: &Settings) -> Picture {
    model.trace(camera, settings, &|_| true).expect("compiled")
}

fn assert_same(one: &GBuffer, other: &GBuffer, what: &str) {
    assert!(one.status == other.status, "{what}: statuses");
    let bits = |all: &[f64]| all.iter().map(|one| one.to_bits()).collect::<Vec<_>>();
    assert!(bits(&one.drawn) == bits(&other.drawn), "{what}: distances");
    let brackets = |buffer: &GBuffer| bits(buffer.bracket.as_flattened());
    assert!(brackets(one) == brackets(other), "{what}: brackets");
}

/// While another thread compiles kernels again, pictures stay the same.
#[test]
fn a_picture_does_not_tell_which_kernels_drew_it() {
    let gallery = examples();
    let texts = gallery.iter().map(|example| example.text).chain(MORE);
    for text in texts {
        let document = document(text);
        let settings = Settings { width: 24, height: 24, brackets: true, ..Settings::default() };
        let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
        let camera = camera::camera(&CameraChoice::typed(&document), &region).expect("valid");
        let patient = Model::new(&document, &region, &settings).expect("compiles");
        let expected = traced(&patient, &camera, &settings);
        let hurried = Model::new_while(&document, &region, &region, &settings, &|| true);
        let hurried = hurried.expect("compiles").expect("wanted");
        let first = traced(&hurried, &camera, &settings);
        assert_same(&first.buffer, &expected.buffer, text);
        std::thread::scope(|scope| {
            let again = scope.spawn(|| hurried.optimize(&|| true));
            assert_same(&traced(&hurried, &camera, &settings).buffer, &expected.buffer, text);
            assert!(again.join().expect("no panic"), "{text}");
        });
        let last = traced(&hurried, &camera, &settings);
        assert_same(&last.buffer, &expected.buffer, text);
        assert!(first.rgb == expected.rgb && last.rgb == expected.rgb, "{text}: colors");
    }
}

#[test]
fn compiling_again_ends_between_kernels_and_goes_on_later() {
    let document = document("domain 2\nx^4+y^4+z^4 = 1\nsin(3*x)*y = z");
    let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
    let settings = Settings::default();
    let model = Model::new_while(&document, &region, &region, &settings, &|| true);
    let model = model.expect("compiles").expect("wanted");
    let sizes = || model.program().made().iter().map(|made| made.bytes).collect::<Vec<_>>();
    let quick = sizes();
    for _ in 0..quick.len() {
        let (before, asked) = (sizes(), AtomicUsize::new(0));
        model.optimize(&|| asked.fetch_add(1, Ordering::Relaxed) == 0);
        let changed = before.iter().zip(sizes()).filter(|(one, other)| *one != other).count();
        assert!(changed <= 1, "{changed} kernels although one was wanted");
    }
    assert!(model.optimize(&|| false), "something is left");
    assert!(sizes().iter().zip(&quick).all(|(one, other)| one != other));
}

/// Edits and drags come while kernels are compiled again. In the end, all of the last formula's
/// kernels are, and nothing of earlier formulas is left.
#[test]
fn edits_and_drags_do_not_wait_for_kernels() {
    let live = start("", 24);
    let mut earlier = Vec::new();
    let formula = |n: u32| format!("r = 1 in [0, 2]\nx^2+y^2+z^2 = r + sin({n}*x)*cos(y)/9");
    for n in 1..20 {
        live.enter(&formula(n)).expect("valid");
        if n % 3 == 0 {
            assert!(live.wait_for_full(LIMIT));
        }
        if let Some(seen) = live.snapshot().rendering {
            earlier.push(Arc::downgrade(&seen.model));
            for value in [1.1, 1.5, 1.9] {
                let slider = seen.sliders().into_iter().find(|slider| slider.name == "r");
                live.drag(&slider.expect("a slider"), value);
            }
        }
    }
    live.enter(&formula(20)).expect("valid");
    let seen = settled(&live);
    assert!(seen.model.optimize(&|| false), "something is left to compile");
    let reference = seen.model.interpreted(&seen.document);
    let expected = traced(&reference, &seen.camera, &seen.request.settings);
    assert_same(&seen.picture.buffer, &expected.buffer, "the last picture");
    let (start, last) = (Instant::now(), Arc::downgrade(&seen.model));
    let is_alive = || earlier.iter().any(|model| !model.ptr_eq(&last) && model.strong_count() > 0);
    while is_alive() {
        assert!(start.elapsed() < LIMIT, "an earlier model is still alive");
        std::thread::yield_now();
    }
}
