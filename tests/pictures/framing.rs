//! With the automatic camera, the visible part fills most of the picture. This is checked for the
//! gallery and the hundred typed equations.
//!
//! All rows: `cargo test --release --test all framing -- --nocapture`.

use super::domains::rows;
use glam::DVec3;
use std::fmt::Write as _;
use std::time::Instant;
use zeroset_render::framing;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::gallery::examples;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};
use zeroset_trace::RayGrid;

/// Pixels of the picture's shorter side.
const SIDE: usize = 96;

/// Wanted range of the visible part's share of the picture.
const SHARES: [f64; 2] = [0.55, 0.95];

/// Least share of the pictures whose visible part is within [`SHARES`].
const LEAST: f64 = 0.95;

/// The larger extent of the painted part, as a share of the picture's shorter side, and whether the
/// part touches the border.
fn share(model: &Model, camera: &Camera, width: usize, height: usize) -> (f64, bool) {
    let settings = Settings { width, height, normals: None, ..Settings::default() };
    let buffer = model.trace(camera, &settings, &|_| true).expect("kernels").buffer;
    let painted: Vec<(usize, usize)> = (0..width * height)
        .filter(|pixel| buffer.is_drawn(*pixel))
        .map(|pixel| (pixel % width, pixel / width))
        .collect();
    let extent = |place: &dyn Fn(&(usize, usize)) -> usize| {
        let (low, high) = (painted.iter().map(place).min(), painted.iter().map(place).max());
        low.zip(high).map_or(0, |(low, high)| high + 1 - low)
    };
    let largest = extent(&|place| place.0).max(extent(&|place| place.1));
    let border =
        |(x, y): &(usize, usize)| *x == 0 || *y == 0 || *x + 1 == width || *y + 1 == height;
    (largest as f64 / width.min(height) as f64, painted.iter().any(border))
}

#[test]
fn what_is_visible_fills_the_picture_and_nothing_bounded_is_cut() {
    let typed = rows().into_iter().map(|row| (row.text, row.bounded));
    let all = examples().into_iter().map(|example| (example.text.to_owned(), false)).chain(typed);
    let (mut good, mut count, mut report, mut times) = (0, 0, String::new(), Vec::new());
    for (text, bounded) in all {
        let document = read(&text, &Options::default()).expect(&text);
        let (region, _) = region(&document, DomainChoice::Document, None).expect(&text);
        let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect(&text);
        let started = Instant::now();
        let camera = framing::camera(&model, &CameraChoice::default(), &settings, false);
        let camera = camera.expect(&text);
        times.push(started.elapsed().as_secs_f64() * 1e3);
        let (share, touches) = share(&model, &camera, SIDE, SIDE);
        count += 1;
        let fits = (SHARES[0]..=SHARES[1]).contains(&share);
        good += usize::from(fits);
        let name = text.lines().find(|line| !line.starts_with("r = ")).unwrap_or_default();
        if !fits || touches {
            let _ = writeln!(report, "{share:.2} {} {name}", if touches { "cut" } else { "   " });
        }
        assert!(!(bounded && touches), "cut: {text}");
    }
    times.sort_unstable_by(f64::total_cmp);
    let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
    println!("{report}{good} of {count} fill the picture");
    println!("median {median:.2} ms, worst {worst:.2} ms");
    assert!(good as f64 >= LEAST * f64::from(count), "{report}");
}

/// Graphs from textbooks on functions of two variables, of every kind that has a chapter.
const GRAPHS: &str = include_str!("../data/graphs.txt");

#[test]
fn graphs_fill_the_picture_and_show_their_upper_side() {
    let (mut filled, mut upper, mut count, mut report) = (0, 0, 0, String::new());
    for text in GRAPHS.lines().filter(|line| line.starts_with('z')) {
        let document = read(text, &Options::default()).expect(text);
        let (region, _) = region(&document, DomainChoice::Document, None).expect(text);
        let settings =
            Settings { width: SIDE, height: SIDE, keeps_normals: true, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect(text);
        let camera = framing::camera(&model, &CameraChoice::default(), &settings, false);
        let camera = camera.expect(text);
        let (share, _) = share(&model, &camera, SIDE, SIDE);
        let buffer = model.trace(&camera, &settings, &|_| true).expect(text).buffer;
        let rays = RayGrid::new(&camera, SIDE, SIDE);
        let drawn: Vec<usize> = (0..SIDE * SIDE).filter(|n| buffer.is_drawn(*n)).collect();
        let shows_upper = |pixel: &&usize| {
            let normal = glam::DVec3::from_array(buffer.normal[**pixel].map(f64::from));
            let toward_eye = normal * -normal.dot(rays.ray_of(**pixel).direction).signum();
            toward_eye.z > 0.0
        };
        let above = drawn.iter().filter(shows_upper).count() as f64 / drawn.len() as f64;
        count += 1;
        filled += usize::from((SHARES[0]..=SHARES[1]).contains(&share));
        upper += usize::from(above > 0.5);
        let _ = writeln!(report, "{share:.2} {above:.2} {text}");
    }
    println!("{report}{filled} of {count} fill the picture, {upper} show mostly their upper side");
    assert!(count >= 60, "{count}");
    assert!(filled as f64 >= LEAST * f64::from(count), "{report}");
    assert!(upper as f64 >= LEAST * f64::from(count), "{report}");
}

#[test]
fn a_tall_picture_and_a_wide_one_hold_it_all() {
    let document = read("x^2/9+y^2+z^2/4=1", &Options::default()).expect("reads");
    let (region, _) = region(&document, DomainChoice::Document, None).expect("bounded");
    for (width, height) in [(60, 150), (150, 60), (90, 90)] {
        let settings = Settings { width, height, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect("compiles");
        let camera = framing::camera(&model, &CameraChoice::default(), &settings, false);
        let (share, touches) = share(&model, &camera.expect("a camera"), width, height);
        assert!(!touches && (SHARES[0]..SHARES[1]).contains(&share), "{width}x{height}: {share}");
    }
}

#[test]
fn what_was_chosen_stays() {
    let perspective = |fov| Some(Projection::Perspective { fov });
    let height = Some(Projection::Orthographic { height: 3.0 });
    let usual = CameraChoice::default();
    let eye = Some(glam::DVec3::new(4.0, 3.0, 6.0));
    for (line, choice) in [
        ("view eye (4, 3, 6)", usual),
        ("view front", usual),
        ("view fov 20", usual),
        ("", CameraChoice { projection: height, ..usual }),
        ("", CameraChoice { projection: perspective(10.0), ..usual }),
        ("", CameraChoice { view: zeroset_style::StandardView::named("front"), ..usual }),
        ("", CameraChoice { eye, ..usual }),
        ("", CameraChoice { target: eye, ..usual }),
    ] {
        let text = format!("{line}\ndomain 2\nx^2+y^2+z^2=1");
        let document = read(&text, &Options::default()).expect("reads");
        let (region, _) = region(&document, DomainChoice::Document, None).expect("given");
        let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect("compiles");
        let framed = framing::camera(&model, &choice, &settings, false).expect("valid");
        let given =
            zeroset_scene::camera::camera(&choice.or(CameraChoice::typed(&document)), &region)
                .expect("valid");
        assert_eq!(framed, given, "{text} {choice:?}");
    }
}

#[test]
fn flat_things_are_not_seen_edge_on() {
    for text in ["x+2y+3z=4", "z=5", "2x+3y=0.1z", "x=-1.5y"] {
        let document = read(text, &Options::default()).expect("reads");
        let (region, _) = region(&document, DomainChoice::Document, None).expect("a plane");
        let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect("compiles");
        let camera = framing::camera(&model, &CameraChoice::default(), &settings, false);
        let camera = camera.expect("a camera");
        let settings = Settings { normals: None, ..settings };
        let buffer = model.trace(&camera, &settings, &|_| true).expect("kernels").buffer;
        let painted = (0..SIDE * SIDE).filter(|pixel| buffer.is_drawn(*pixel)).count();
        assert!(painted > SIDE * SIDE / 5, "{text}: {painted} pixels, {camera:?}");
    }
}

#[test]
fn flat_curves_and_floors_of_shaders_are_seen_from_above_with_and_without_axes() {
    let floor = "float map(vec3 p) { return min(p.y, length(p - vec3(0, 0.5, 0)) - 0.5); }";
    let ring = "curve x^2 + y^2 = 1, z = x";
    let (y, slanted) = (DVec3::Y, DVec3::new(-1.0, 0.0, 1.0).normalize());
    for (text, upper) in [(ring, slanted), ("z = x", slanted), (floor, y), ("p.y - 0.0", y)] {
        let document = read(text, &Options::default()).expect("reads");
        let (region, _) = region(&document, DomainChoice::Document, None).expect("a region");
        let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect("compiles");
        for axes in [false, true] {
            let camera = framing::camera(&model, &CameraChoice::default(), &settings, axes);
            let camera = camera.expect("a camera");
            let back = (camera.eye() - camera.target()).normalize();
            assert!(back.dot(upper) > 0.4, "{text} with axes {axes}: {back}");
        }
    }
}

/// The camera that is chosen for a text, with or without axes.
fn chosen(text: &str, axes: bool) -> Camera {
    let document = read(text, &Options::default()).expect(text);
    let (region, _) = region(&document, DomainChoice::Document, None).expect(text);
    let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect(text);
    framing::camera(&model, &CameraChoice::default(), &settings, axes).expect(text)
}

#[test]
fn axes_do_not_change_the_side_from_which_a_surface_is_seen() {
    for text in [
        "x + 2y + 3z = 6",
        "x + y + z = 1",
        "x + 2y + 3z = 6 {x>=0}{y>=0}{z>=0}",
        "x^2+y^2+z^2=9; x+y+z=1; curve x^2+y^2+z^2=9, x+y+z=1",
        "z = x^2 - y^2",
        "x^2+y^2+z^2 = 1",
    ] {
        let [back, other] = [false, true].map(|axes| {
            let camera = chosen(text, axes).displayed();
            (camera.eye() - camera.target()).normalize()
        });
        assert!(back.dot(other) > 0.999, "{text}: {back} without axes, {other} with axes");
    }
}

#[test]
fn the_side_is_chosen_from_which_points_are_seen() {
    let bowl = "z = x^2 + y^2; z = 2x + 2y - 2; (1, 1, 2) \"P\"";
    let column = |at: &str| format!("x^2 + y^2 <= 1 and abs(z) <= 3; point {at}");
    for (text, towards) in [
        (bowl.to_owned(), DVec3::new(1.0, 1.0, 0.0)),
        (column("(-1.01, 0, 0)"), DVec3::NEG_X),
        (column("(1.01, 0, 0)"), DVec3::X),
        (column("(0, 1.01, 0)"), DVec3::Y),
        (column("(0, -1.01, 0)"), DVec3::NEG_Y),
    ] {
        for axes in [false, true] {
            let camera = chosen(&text, axes);
            let back = (camera.eye() - camera.target()).normalize();
            assert!(back.dot(towards) > 0.2, "{text} with axes {axes}: {back}");
        }
    }
}

#[test]
fn flat_drawings_seen_along_their_axis_have_parallel_rays() {
    let is_parallel = |text: &str| {
        [false, true]
            .map(|axes| matches!(chosen(text, axes).projection(), Projection::Orthographic { .. }))
    };
    for text in [
        "curve y = 1/x, z = 0; view top",
        "curve r = 2 sin(3 theta), z = 0; view top",
        "(cos(s), 2, sin(s)) for s in [0, 5]; view front",
        "point (1, 2, 3); point (1, 0, 0); view left",
    ] {
        assert_eq!(is_parallel(text), [true; 2], "{text}");
    }
    for text in [
        "curve y = 1/x, z = 0",
        "curve x^2 + y^2 = 1, z = x; view top",
        "curve y = x^2, z = 0; x^2 + y^2 + z^2 = 1; view top",
        "curve y = x^2, z = 0; view front",
        "curve y = x^2, z = 0; view eye (0, 0, 9)",
    ] {
        assert_eq!(is_parallel(text), [false; 2], "{text}");
    }
}
