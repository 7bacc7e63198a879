//! The baseline methods. Each finds roots within its tolerance, proves what its row in the table of
//! methods says, and fails where its approach must fail.

use glam::DVec3;
use zeroset_render::model::render;
use zeroset_render::picture::{Picture, Settings};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Options, read};
use zeroset_trace::{METHODS, Method, Proves, RayGrid, Status, UndecidedReason};

const SIDE: usize = 48;
const SPHERE: &str = "x^2+y^2+z^2-1";

fn region(half: f64) -> Region {
    Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a cube")
}

/// A formula within ±2, viewed along x by parallel rays from 8 units before the origin.
fn picture(formula: &str, method: &str, change: impl Fn(&mut Settings)) -> (RayGrid, Picture) {
    picture_from(DVec3::NEG_X * 8.0, formula, method, change)
}

fn picture_from(
    eye: DVec3,
    formula: &str,
    method: &str,
    change: impl Fn(&mut Settings),
) -> (RayGrid, Picture) {
    let document = read(formula, &Options::default()).expect("reads");
    let projection = Projection::Orthographic { height: 3.0 };
    let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("a camera");
    let method = Method::named(method).expect("a row");
    let mut settings =
        Settings { width: SIDE, height: SIDE, method, normals: None, ..Settings::default() };
    change(&mut settings);
    let picture = render(&document, &region(2.0), &camera, &settings);
    (RayGrid::new(&camera, SIDE, SIDE), picture.expect("a picture"))
}

fn drawn(picture: &Picture) -> usize {
    (0..SIDE * SIDE).filter(|&pixel| picture.buffer.is_drawn(pixel)).count()
}

#[test]
fn every_method_draws_the_sphere_within_its_tolerance() {
    for (method, double) in METHODS.iter().flat_map(|method| [(method, false), (method, true)]) {
        for tolerance in [0.5, 0.01] {
            let (frame, picture) = picture(SPHERE, method.name, |settings| {
                settings.options.tolerance = tolerance;
                if double {
                    settings.options.precision = zeroset_render::picture::Precision::F64;
                }
            });
            let mut seen = 0;
            for pixel in 0..SIDE * SIDE {
                let foot = frame.ray_of(pixel).at(8.0);
                let square = 1.0 - foot.y * foot.y - foot.z * foot.z;
                let found = picture.buffer.drawn[pixel];
                // Roots near the rim are not compared, since rays run along the surface there.
                if square < -0.02 {
                    assert_eq!(found, f64::INFINITY, "{method:?}, through {foot}");
                } else if square > 0.02 {
                    let off = (found - (8.0 - square.sqrt())).abs();
                    // The constant allows for rounding errors of `f32`.
                    let room = tolerance * frame.footprint(found) + 1e-5;
                    assert!(off <= room, "{method:?}, {tolerance}: off by {off}, through {foot}");
                    seen += 1;
                }
            }
            assert!(seen > 700, "{method:?}: {seen}");
        }
    }
}

#[test]
fn a_method_claims_no_more_than_its_row_says() {
    for method in &METHODS {
        for formula in [SPHERE, "(x^2+y^2+z^2-1)^2", "1/(x-z/3)", "sqrt(x-y)+z", "z < floor(x)"] {
            let (frame, picture) = picture(formula, method.name, |_| {});
            let cut = formula.contains('<');
            for (pixel, status) in picture.buffer.status.iter().enumerate() {
                let meets = region(2.0).span(&frame.ray_of(pixel)).is_some();
                let allowed = match (method.proves, status) {
                    (Proves::Nothing, Status::Miss) => !meets,
                    // The method itself does not prove a hit on the face where the domain cuts a
                    // solid.
                    (Proves::Nothing | Proves::Misses, Status::Hit) => {
                        cut && picture.buffer.is_cap(pixel)
                    }
                    _ => true,
                };
                assert!(allowed, "{method:?}: {status:?} of {formula}");
            }
        }
    }
}

/// Two spheres a thousandth of a unit apart, with negative values between them.
const SHELL: &str = "(x^2+y^2+z^2-1)*(x^2+y^2+z^2-1.002)";

#[test]
fn march_passes_over_what_is_thinner_than_its_steps() {
    let coarse = |steps: u32| drawn(&picture(SHELL, "march", |s| s.options.steps = steps).1);
    let there = drawn(&picture(SHELL, "mitchell", |_| {}).1);
    assert!(there > 700, "{there}");
    assert!(coarse(32) < there / 10, "{} of {there}", coarse(32));
    assert!(coarse(16384) > there * 9 / 10, "{} of {there}", coarse(16384));
    // Rays without samples of different signs are undecided, not misses.
    let (_, picture) = picture(SHELL, "march", |settings| settings.options.steps = 32);
    assert_eq!(picture.buffer.reasons()[UndecidedReason::Unproven as usize], SIDE * SIDE);
    assert!(picture.why_undecided().expect("all").contains("proves nothing"));
}

#[test]
fn march_draws_a_pole_as_a_wall() {
    let pole = "1/(x-z/3)";
    assert_eq!(drawn(&picture(pole, "march", |_| {}).1), SIDE * SIDE);
    for method in METHODS.iter().filter(|method| method.name != "march") {
        assert_eq!(drawn(&picture(pole, method.name, |_| {}).1), 0, "{method:?}");
    }
}

#[test]
fn mitchell_proves_a_torus() {
    // Viewed along the torus' plane, a ray has up to four roots.
    let torus = "(x^2+y^2+z^2+0.8^2-0.3^2)^2-4*0.8^2*(x^2+y^2)";
    let (frame, picture) = picture(torus, "mitchell", |settings| settings.brackets = true);
    let counts = picture.buffer.counts();
    assert!(counts.hit > 300 && counts.miss > 400, "{counts:?}");
    assert!(counts.undecided < SIDE * SIDE / 100, "{counts:?}");
    let value = |point: DVec3| {
        let sum = point.length_squared() + 0.64 - 0.09;
        sum * sum - 4.0 * 0.64 * (point.x * point.x + point.y * point.y)
    };
    for pixel in 0..SIDE * SIDE {
        if picture.buffer.status[pixel] == Status::Hit {
            let ray = frame.ray_of(pixel);
            let [a, b] = picture.buffer.bracket[pixel].map(|end| value(ray.at(ray.parameter(end))));
            assert!(a > -1e-12 && b < 1e-12, "{a:e} {b:e}");
        }
    }
}

#[test]
fn mitchell_leaves_open_what_only_touches() {
    // The function is nowhere negative. It cannot be reduced to a simpler one with the same zeros.
    let touching = "sqrt(1 + (x^2+y^2+z^2-1)^2) = 1";
    let (_, picture) = picture(touching, "mitchell", |_| {});
    let (counts, buffer) = (picture.buffer.counts(), &picture.buffer);
    assert!(counts.hit == 0 && counts.undecided > 700 && counts.miss > 400, "{counts:?}");
    let drawn = (0..SIDE * SIDE).filter(|&pixel| buffer.is_drawn(pixel)).count();
    assert_eq!(drawn, counts.undecided);
    assert_eq!(buffer.reasons()[UndecidedReason::Touching as usize], counts.undecided);
}

#[test]
fn sphere_says_where_it_has_no_bound() {
    // At z = 0 the function's slope is infinite, so a ray there stays undecided.
    let (frame, picture) = picture("cbrt(z)+x", "sphere", |_| {});
    let steep = |pixel: usize| picture.buffer.reason(pixel) == UndecidedReason::Steep;
    assert!((0..SIDE * SIDE).all(|pixel| steep(pixel) != picture.buffer.is_drawn(pixel)));
    // At other z the slope has a bound, once a ray's segments are short enough.
    for pixel in (0..SIDE * SIDE).filter(|&pixel| steep(pixel)) {
        assert!(frame.ray_of(pixel).origin.z.abs() < 1e-5);
    }
    let (_, along) = self::picture("cbrt(x)+z", "sphere", |_| {});
    assert!(along.why_undecided().expect("some").contains("no bound of f's slope"));
}

/// The setting `steps` limits the number of sphere tracing steps.
#[test]
fn sphere_takes_no_more_steps_than_it_may() {
    let (_, few) = picture(SPHERE, "sphere", |settings| settings.options.steps = 3);
    assert!(few.buffer.reasons()[UndecidedReason::Budget as usize] > 700);
    assert_eq!(few.buffer.counts().hit, 0);
}

/// On oblique rays, affine forms keep the dependence between coordinates; intervals do not.
#[test]
fn raa_is_tighter_than_knoll_across_the_axes() {
    let by = |method: &str| picture_from(DVec3::new(4.0, 3.0, 6.0), SPHERE, method, |_| {}).1;
    let [forms, boxes] = ["raa", "knoll"].map(by).map(|picture| picture.statistics);
    assert!(forms.pixels.undecided <= boxes.pixels.undecided, "{forms:?}, {boxes:?}");
    let [lanes, others] = [forms.work.segments.lanes, boxes.work.interval.lanes];
    assert!(4 * lanes < 3 * others + others / 2, "{lanes}, {others}");
}
