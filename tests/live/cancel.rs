//! Cancelled work stops soon: between kernels, between tiles, and between tiles of shadows.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use zeroset_render::limit::Limit;
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::Region;
use zeroset_style::Choices;
use zeroset_syntax::{Document, Options};
use zeroset_trace::{METHODS, Status, TraceOptions, UndecidedReason};

/// Two surfaces, one of which casts a shadow on the other.
const TEXT: &str = "domain 2\nz = -1\nx^2+y^2+z^2 = 1/2";

fn document() -> (Document, Region) {
    let document = zeroset_syntax::read(TEXT, &Options::default()).expect("reads");
    let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
    (document, region)
}

#[test]
fn a_compile_ends_between_kernels() {
    let (document, region) = document();
    let compile = |last: usize| {
        let asked = AtomicUsize::new(0);
        let wanted = || asked.fetch_add(1, Ordering::Relaxed) < last;
        let model = Model::new_while(&document, &region, &region, &Settings::default(), &wanted);
        (model.expect("compiles").is_some(), asked.into_inner())
    };
    let (made, asked) = compile(usize::MAX);
    assert!(made && asked >= 4, "asked {asked} times for the kernels of two surfaces");
    for last in 0..asked {
        assert!(!compile(last).0, "made although it was not wanted after {last} of {asked}");
    }
}

/// Traces a picture that is cancelled after `last` calls of `advance`. Returns the picture and the
/// number of calls.
fn picture(model: &Model, settings: &Settings, last: usize) -> (Picture, usize) {
    let (document, region) = document();
    let camera = camera::camera(&CameraChoice::typed(&document), &region).expect("valid");
    let asked = AtomicUsize::new(0);
    let advance = |_| asked.fetch_add(1, Ordering::Relaxed) < last;
    let picture = model.trace(&camera, settings, &advance);
    (picture.expect("compiled"), asked.into_inner())
}

#[test]
fn shadows_end_between_tiles() {
    let (document, region) = document();
    let model = Model::new(&document, &region, &Settings::default());
    let model = model.expect("compiles");
    let plain = Settings {
        options: TraceOptions { depth: 8, ..TraceOptions::default() },
        width: 256,
        height: 256,
        ..Settings::default()
    };
    let shadowed = Settings {
        choices: Choices { shadows: Some(true), ..plain.choices },
        shadow_depth: Some(7),
        ..plain.clone()
    };
    let dark = |picture: &Picture| picture.buffer.shadow.iter().filter(|dark| **dark > 0).count();
    let (_, before) = picture(&model, &plain, usize::MAX);
    let (whole, all) = picture(&model, &shadowed, usize::MAX);
    assert!(dark(&whole) > 100 && all > before + 16, "{} dark, {before} of {all}", dark(&whole));
    // Cancel after a quarter of the shadow tiles.
    let (some, _) = picture(&model, &shadowed, before + (all - before) / 4);
    assert_eq!(some.buffer.status, whole.buffer.status);
    assert!(dark(&some) < dark(&whole), "{} of {} are dark", dark(&some), dark(&whole));
    // Cancelling before the shadows leaves pixels undrawn.
    let (part, _) = picture(&model, &plain, before / 4);
    let drawn =
        |picture: &Picture| (0..256 * 256).filter(|pixel| picture.buffer.is_drawn(*pixel)).count();
    assert!(drawn(&part) < drawn(&whole), "{} of {}", drawn(&part), drawn(&whole));
}

/// A pixel that a cancelled picture did not reach is neither a miss nor a hit, even if one of the
/// surfaces is painted in it.
#[test]
fn what_is_left_off_claims_nothing() {
    let (document, region) = document();
    for method in &METHODS {
        let plain =
            Settings { width: 256, height: 64, method, brackets: true, ..Settings::default() };
        let model = Model::new(&document, &region, &plain).expect("compiles");
        let (whole, all) = picture(&model, &plain, usize::MAX);
        let mut unreached = Vec::new();
        for quarter in 0..=4 {
            let (part, _) = picture(&model, &plain, all * quarter / 4);
            let (part, whole) = (&part.buffer, &whole.buffer);
            let mut count = 0;
            for pixel in 0..256 * 64 {
                if part.status[pixel] == Status::Undecided
                    && part.reason(pixel) == UndecidedReason::Budget
                {
                    assert!(part.distance(pixel) == 0.0 && part.bracket[pixel][0].is_nan());
                    count += 1;
                } else {
                    assert_eq!(part.status[pixel], whole.status[pixel], "{pixel}");
                }
                // If the nearer surface was not traced, the farther one may be painted.
                assert!(part.drawn[pixel] >= whole.drawn[pixel]);
            }
            unreached.push(count);
        }
        // A pixel is decided when both surfaces are traced. Early quarters may decide few pixels.
        assert_eq!((unreached[0], unreached[4]), (256 * 64, 0), "{method:?}: {unreached:?}");
        assert!(unreached.is_sorted_by(|a, b| a >= b), "{method:?}: {unreached:?}");
        assert!(0 < unreached[3] && unreached[3] < 256 * 64, "{method:?}: {unreached:?}");
    }
}

#[test]
fn a_budget_of_time_ends_a_picture() {
    let (document, region) = document();
    let limit = |time| Limit { budget: Some(time), ..Limit::default() };
    let settings = Settings { limit: limit(Duration::ZERO), ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect("compiles");
    let (none, _) = picture(&model, &settings, usize::MAX);
    assert_eq!(none.buffer.reasons()[UndecidedReason::Budget as usize], 512 * 512);
    assert!(none.buffer.drawn.iter().all(|drawn| drawn.is_infinite()));
    let settings = Settings { limit: limit(Duration::MAX), ..settings };
    let (whole, _) = picture(&model, &settings, usize::MAX);
    assert_eq!(whole.statistics.pixels.undecided, 0);
}
