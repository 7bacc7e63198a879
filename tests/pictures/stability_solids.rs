//! Solids with undefined parts, jumps and poles have faces at the right places.

use glam::DVec3;
use zeroset_render::model::render;
use zeroset_render::picture::{Picture, Settings};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Options, read};
use zeroset_trace::{METHODS, Method, RayGrid, TraceOptions, UndecidedReason};

const SIDE: usize = 41;

/// A picture of the cube ±2 by parallel rays in the direction `along`.
fn picture(formula: &str, along: DVec3, method: &'static Method) -> (RayGrid, Picture) {
    let document = read(formula, &Options::default()).expect("reads");
    let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a cube");
    let up = if along.z == 0.0 { DVec3::Z } else { DVec3::Y };
    let projection = Projection::Orthographic { height: 3.9 };
    let camera = Camera::new(along * -8.0, DVec3::ZERO, up, projection).expect("a camera");
    let (max_depth, tolerance) = (12, 0.01);
    let plain = Settings { width: SIDE, height: SIDE, ..Settings::default() };
    let settings = Settings {
        options: TraceOptions { depth: max_depth, tolerance, ..plain.options },
        method,
        ..plain
    };
    let picture = render(&document, &region, &camera, &settings).expect("a picture");
    (RayGrid::new(&camera, SIDE, SIDE), picture)
}

/// Checks the first face on each ray in the direction `along`, by all methods. `expected` takes the
/// ray's point in the plane through the origin, and returns the face's coordinate along the ray.
/// `None` means no face, and NaN accepts any result.
fn check(formula: &str, along: DVec3, expected: impl Fn(DVec3) -> Option<f64>) {
    for method in &METHODS {
        check_with(method, formula, along, &expected);
    }
}

fn check_with(
    method: &'static Method,
    formula: &str,
    along: DVec3,
    expected: &impl Fn(DVec3) -> Option<f64>,
) {
    let (frame, picture) = picture(formula, along, method);
    let formula = format!("{method:?}: {formula}");
    let (mut seen, mut steep) = (0, 0);
    for pixel in 0..SIDE * SIDE {
        // At a jump the slope has no bound, so a method that needs one leaves the ray undecided.
        if picture.buffer.reason(pixel) == UndecidedReason::Steep {
            assert!(method.name == "sphere" && !picture.buffer.is_drawn(pixel), "{formula}");
            steep += 1;
            continue;
        }
        let ray = frame.ray_of(pixel);
        let foot = ray.at(8.0);
        let drawn = picture.buffer.drawn[pixel];
        let found = drawn.is_finite().then_some(drawn - 8.0);
        let agrees = match (expected(foot), found) {
            (None, None) => true,
            (Some(face), _) if face.is_nan() => true,
            (Some(face), Some(found)) => (face - found).abs() < 2e-3,
            (None, Some(_)) | (Some(_), None) => false,
        };
        assert!(agrees, "{formula}, through {foot}: {found:?}, not {:?}", expected(foot));
        if found.is_some() {
            seen += 1;
            let normal = DVec3::from_array(picture.buffer.normal[pixel].map(f64::from));
            assert!((normal.length() - 1.0).abs() < 1e-5, "{formula}, through {foot}: {normal}");
        }
    }
    let is_seen = (50..SIDE * SIDE - 50).contains(&seen);
    assert!(is_seen || steep > 0, "{formula}: {seen} faces seen");
}

/// Coordinate x at which a ray along x enters the unit ball. Near the rim it is NaN.
fn ball(foot: DVec3) -> Option<f64> {
    let square = 1.0 - foot.y * foot.y - foot.z * foot.z;
    if square.abs() < 0.02 { Some(f64::NAN) } else { (square > 0.0).then(|| -square.sqrt()) }
}

#[test]
fn a_part_without_a_value_hides_no_other() {
    check("sqrt(x-1) > y+1/8 or x^2+y^2+z^2 < 1", DVec3::X, |foot| {
        // For y ≥ −1/8 the square root equals y + 1/8 at x = (y + 1/8)² + 1. For smaller y the face
        // is the edge of the root's domain of definition.
        let height = (foot.y + 0.125).max(0.0);
        let root = 1.0 + height * height;
        ball(foot).or((root < 2.0).then_some(root))
    });
    // The face is where the ray leaves the ball. Beside the ball, it is the edge of the logarithm's
    // domain of definition.
    check("ln(x) < 8 and not (x^2+y^2+z^2 < 1) and y > -1", DVec3::X, |foot| {
        (foot.y > -1.0).then(|| ball(foot).map_or(0.0, |enters| -enters))
    });
}

#[test]
fn neither_a_comparison_nor_its_opposite_holds_where_there_is_no_value() {
    let strip = |foot: DVec3| (foot.y.abs() < 1.0).then_some(0.0);
    check("not (sqrt(x) > 1) and -1 < y < 1", DVec3::X, strip);
    check("sqrt(x) <= 1 and -1 < y < 1", DVec3::X, strip);
}

#[test]
fn a_solid_has_faces_where_it_jumps() {
    check("floor(x) > 1/2 and y < 1/3", DVec3::X, |foot| (foot.y < 1.0 / 3.0).then_some(1.0));
    check("z < floor(x) and y < 1/3", DVec3::X, |foot| {
        // The solid is a staircase, with a riser at each integer x. Any result is accepted for a
        // ray along a tread, and for a ray that meets no riser before the last face of the box.
        let height = foot.z.ceil();
        let riser = if height < 2.0 && height > foot.z { height } else { f64::NAN };
        (foot.y < 1.0 / 3.0).then_some(riser)
    });
    check("1/x > y and z < 1/3", DVec3::X, |foot| {
        // For y < −1/2 the solid begins at x = −2, otherwise at the pole.
        let face = if foot.y < -0.5 { -2.0 } else { 0.0 };
        (foot.z < 1.0 / 3.0).then_some(face)
    });
}

#[test]
fn an_equation_may_be_restricted_by_what_has_no_value_everywhere() {
    check("x {sqrt(y) > 1/2 or z > 1/3}", DVec3::X, |foot| {
        (foot.y > 0.25 || foot.z > 1.0 / 3.0).then_some(0.0)
    });
    check("x {not (sqrt(y) > 1/2 or z > 1/3)}", DVec3::X, |foot| {
        (foot.y >= 0.0 && foot.y < 0.25 && foot.z < 1.0 / 3.0).then_some(0.0)
    });
}
