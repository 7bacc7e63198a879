//! Close views of parts that are far smaller than their distance from the origin.

use super::property_support::{claims, picture as picture_of};
use glam::DVec3;
use std::cell::Cell;
use zeroset_render::model::{Model, render};
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::view::{DomainChoice, region};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Document, Options, read};
use zeroset_testkit::property::{Formula, Scene, picture as check_claims};
use zeroset_trace::{METHODS, Precision, RayGrid, Status, TraceOptions};

const SURFACES: [&str; 5] = [
    "domain 2\nx^2+y^2+z^2 = 1",
    "domain 2\n(x^2+y^2+z^2+0.84)^2 = 4*(x^2+y^2)",
    "domain 3\n4*(x^4+(y^2+z^2)^2)+17*x^2*(y^2+z^2)-20*(x^2+y^2+z^2)+17",
    "domain 6\nsin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)",
    "domain 3\nx^4-5*x^2+y^4-5*y^2+z^4-5*z^2+11.8",
];

/// Greatest number of segments evaluated for a close view, relative to those for the whole view.
const MOST: u64 = 4;

fn picture(document: &Document, region: &Region) -> (Model, Picture) {
    let settings = Settings { width: 96, height: 96, ..Settings::default() };
    let eye = region.centre() + DVec3::new(2.0, 1.5, 3.0) * region.half_extent();
    let projection = Projection::Perspective { fov: 40.0 };
    let camera = Camera::new(eye, region.centre(), DVec3::Y, projection).expect("a camera");
    let model = Model::new(document, region, &settings).expect("a model");
    let picture = model.trace(&camera, &settings, &|_| true).expect("a picture");
    (model, picture)
}

fn segments(picture: &Picture) -> u64 {
    picture.statistics.work.tiles.lanes + picture.statistics.work.segments.lanes
}

/// A zero of the first surface, to the accuracy of doubles.
fn zero(model: &Model) -> DVec3 {
    let half = model.region().half_extent();
    let at =
        |share: f64| (DVec3::new(0.9, 0.53, 0.77) - share * DVec3::new(1.0, 0.49, 0.61)) * half;
    let value = |share: f64| model.sample(0, at(share)).0;
    let parts = 1 << 12;
    let share = |part: i32| 2.0 * f64::from(part) / f64::from(parts);
    let part = (0..parts).find(|&part| value(share(part)) * value(share(part + 1)) < 0.0);
    let [mut low, mut high] = part.map(|part| [share(part), share(part + 1)]).expect("a zero");
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if value(low) * value(middle) > 0.0 { low = middle } else { high = middle }
    }
    at(low)
}

#[test]
fn close_views_are_decided_and_cost_no_more_than_whole_ones() {
    for text in SURFACES {
        let document = read(text, &Options::default()).expect(text);
        let (whole, _) = region(&document, DomainChoice::Document, None).expect(text);
        let (model, whole) = picture(&document, &whole);
        let place = zero(&model);
        for half in [1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
            let part = Region::new(place - half, place + half).expect("a region");
            let (_, close) = picture(&document, &part);
            let pixels = close.statistics.pixels;
            println!("{text:?} {half:e}: {pixels:?}, {} of {}", segments(&close), segments(&whole));
            // In the smallest region, rays are too inaccurate: a pixel is 2^-45 of the coordinates.
            if half > 1e-11 {
                assert!(segments(&close) <= MOST * segments(&whole), "{text:?} {half:e}");
                assert!(pixels.hit > 1000, "{text:?} {half:e}: {pixels:?}");
            }
            if half > 1e-9 {
                assert_eq!(pixels.undecided, 0, "{text:?} {half:e}");
            }
        }
    }
}

/// A tile may be a billion times as deep as wide. It must not be cut into parts as deep as wide.
#[test]
fn pixels_far_smaller_than_the_domain_take_no_longer() {
    for (formula, extent) in [("asinh(y) > 0", 1e14), ("y^10 < ceil(y)", 1e18), ("z^x = y", 1e6)] {
        let document = read(formula, &Options::default()).expect(formula);
        let region = Region::new(DVec3::splat(-extent), DVec3::splat(extent)).expect("a cube");
        let projection = Projection::Orthographic { height: (extent / 1e6).min(1e6) };
        let eye = DVec3::new(5.0, 0.0, 0.0);
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("a camera");
        let settings = Settings { width: 8, height: 8, normals: None, ..Settings::default() };
        let picture = render(&document, &region, &camera, &settings).expect("a picture");
        let work = picture.statistics.work;
        let calls = work.tiles.calls + work.segments.calls;
        println!("{formula}: {calls} calls");
        assert!(calls < 20_000, "{formula}: {calls} calls");
    }
}

/// The function must be drawn although the reciprocal of its derivative is too large for a float.
#[test]
fn a_function_of_subnormal_numbers_is_drawn_where_it_is() {
    let text = "1e-39*(x^2 + y^2 + z^2 - 1)";
    let document = read(text, &Options::default()).expect(text);
    let region = Region::new(DVec3::splat(-1.5), DVec3::splat(1.5)).expect("a cube");
    let eye = DVec3::new(1.8, -2.7, 1.3);
    let projection = Projection::Perspective { fov: 40.0 };
    let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, projection).expect("a camera");
    for precision in [Precision::F32, Precision::Auto] {
        let settings = Settings {
            options: TraceOptions { precision, ..TraceOptions::default() },
            width: 128,
            height: 128,
            ..Settings::default()
        };
        let picture = render(&document, &region, &camera, &settings).expect("a picture");
        let (rays, buffer) = (RayGrid::new(&camera, 128, 128), &picture.buffer);
        let hits: Vec<usize> =
            (0..buffer.status.len()).filter(|&pixel| buffer.status[pixel] == Status::Hit).collect();
        println!("{precision:?}: {} hits", hits.len());
        assert!(hits.len() > 4000, "{precision:?}: {}", hits.len());
        for pixel in hits {
            let ray = rays.ray_of(pixel);
            let off = ray.at(ray.parameter(buffer.drawn[pixel])).length() - 1.0;
            assert!(off.abs() < 0.05, "{precision:?}: off by {off} at {pixel}");
        }
    }
}

#[test]
fn no_zero_behind_the_eye_is_hit() {
    // The eye is between two sheets of the surface, whose distance `f32` hardly resolves.
    for text in ["sin(1e8*x)", "sin(3e7*x)-y/8", "tan(1e8*x)=y", "sin(1e8*x)<=0"] {
        for fov in [Ok(60.0), Err(1.0)] {
            let formula = Formula::from_text(text, [[-2.0, 2.0]; 3]).expect(text);
            let scene = Scene {
                eye: [-0.8, -0.01, -0.88],
                target: [0.1, 0.2, 0.05],
                up: [0.0, 1.0, 0.0],
                fov,
                size: [16, 16],
                depth: 10,
                tolerance: 0.5,
                precision: "auto",
                formula,
            };
            let hits = Cell::new(0);
            let tally = check_claims(&scene, &|scene| {
                let (camera, picture) = picture_of(scene, &METHODS[0])?;
                let brackets = &picture.buffer.bracket;
                assert!(brackets.iter().all(|[near, _]| near.is_nan() || *near >= 0.0), "{scene}");
                hits.set(picture.buffer.counts().hit);
                Some(claims(scene, &camera, &picture))
            });
            assert!(tally.unwrap_or_else(|failure| panic!("{failure}")).defined > 0, "{text}");
            assert!(hits.get() > 128, "{text}, {fov:?}: {} hits", hits.get());
        }
    }
}
