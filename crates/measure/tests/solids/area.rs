//! Surfaces whose area is known.

use crate::{cube, random_solid};
use std::f64::consts::PI;
use std::time::Instant;
use zeroset_measure::{Area, Quantity, Request, area, measure};
use zeroset_scene::program::Program;
use zeroset_space::Region;
use zeroset_syntax::{Options, read};

/// Bounds of the area of a text's surface.
fn bounded(text: &str, region: &Region, relative: f64) -> Area {
    let document = read(text, &Options::default()).expect(text);
    let program = Program::new(&document, zeroset_scene::view::bounds(region)).expect(text);
    let found = area(&program, 0, region, None, relative, &|| true).expect(text);
    found.expect("wanted").expect("few parts")
}

#[test]
fn areas_are_within_narrow_bounds() {
    let cone = PI * 2.0_f64.sqrt();
    for (text, half, exact) in [
        ("x^2+y^2+z^2 = 1", 1.3, 4.0 * PI),
        ("x^2+y^2+z^2 <= 1", 1.3, 4.0 * PI),
        ("(sqrt(x^2+y^2)-1)^2+z^2 <= 0.16", 1.5, 1.6 * PI * PI),
        ("max(abs(x), abs(y), abs(z)) <= 1", 1.3, 24.0),
        ("max(abs(x-0.1), abs(y-0.2), abs(z-0.3)) <= 0.5", 1.3, 6.0),
        ("max(x^2+y^2, abs(z)) <= 1", 1.3, 6.0 * PI),
        ("x^2+y^2 = 1", 1.3, 2.0 * PI * 2.6),
        ("x^2+y^2 <= 1", 1.3, 2.0 * PI * 2.6 + 2.0 * PI),
        ("x^2+y^2+z^2 = 1 {z > 0.5}", 1.3, PI),
        ("x^2+y^2+z^2 <= 1 and z >= 0", 1.3, 3.0 * PI),
        ("1 <= x^2+y^2+z^2 <= 1.21", 1.3, 4.0 * PI * 2.21),
        ("z = x + 2y {max(abs(x), abs(y)) < 0.25}", 1.3, 0.25 * 6.0_f64.sqrt()),
        ("x^2+y^2+z^2 >= 1", 1.3, 4.0 * PI + 6.0 * 2.6 * 2.6),
        ("x^2+y^2 <= (1-z)^2 and 0 <= z and z <= 0.9", 1.3, PI + 0.99 * cone + 0.01 * PI),
    ] {
        let clock = Instant::now();
        let found = bounded(text, &cube(half), 3e-3);
        println!("{text}: {exact} {found:?}, {:?}", clock.elapsed());
        assert!(
            found.low <= exact * (1.0 + 1e-14) && exact <= found.high * (1.0 + 1e-14),
            "{text}"
        );
        assert!(found.high - found.low <= 3e-3 * exact, "{text}");
    }
}

/// At a tip, where a surface crosses itself, and at an edge, the number of zeros on a line bounds
/// the area. Nothing bounds it where a function jumps. The lower bound comes near all the same.
#[test]
fn an_area_at_singular_points_has_bounds() {
    for (text, relative, exact, is_bounded) in [
        ("x^2+y^2 = z^2", 1e-2, 2.0 * PI * 2.0_f64.sqrt(), true),
        ("x*y = 0", 1e-2, 8.0, true),
        ("sqrt(x^2+y^2) <= 0.9-abs(z)", 1e-2, 1.62 * PI * 2.0_f64.sqrt(), true),
        ("y = sqrt(x)", 1e-1, 2.0 * 1.478_942_857_544_597_5, true),
        ("z = floor(x + 0.3) + 0.5", 1e-2, 3.4, false),
    ] {
        let clock = Instant::now();
        let found = bounded(text, &cube(1.0), relative);
        println!("{text}: {exact} {found:?}, {:?}", clock.elapsed());
        let Area { low, high, is_limited, .. } = found;
        assert!(low <= exact && exact <= high && low > 0.95 * exact && !is_limited, "{text}");
        assert_eq!(high - low <= relative * exact, is_bounded, "{text}");
    }
}

/// Random unions, intersections and differences have the area that meshes estimate.
#[test]
fn random_solids_have_the_area_that_meshes_estimate() {
    let cases = std::env::var("ZEROSET_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let mut rng = fastrand::Rng::with_seed(4);
    println!("seed 4");
    for case in 0..cases {
        let text = format!("{} <= 0", random_solid(&mut rng, 2));
        let document = read(&text, &Options::default()).expect(&text);
        let region = cube(1.0);
        let program = Program::new(&document, zeroset_scene::view::bounds(&region)).expect(&text);
        let request = Request {
            quantities: &[Quantity::Area],
            relative: 2e-2,
            has_area_bounds: true,
            ..Request::ALL
        };
        let found = measure(&program, 0, &region, None, &request, &|| true).expect("small");
        let found = found.expect("wanted");
        let Area { low, high, boxes, .. } = found.area_bounds.expect("few parts");
        println!(
            "case {case}: {low}..{high}, {} ± {} {boxes} {text}",
            found.area, found.area_change
        );
        let near = 2.0 * found.area_change + 1e-2;
        assert!(low <= found.area + near && found.area - near <= high, "{text}");
        assert!(high - low <= 2.1e-2 * low.max(1e-3), "{text}");
    }
}

#[test]
fn widths_are_as_asked() {
    let mut before = f64::INFINITY;
    for relative in [0.5, 0.1, 1e-2, 1e-3] {
        let Area { low, high, boxes, .. } = bounded("x^2+2y^2+z^4 <= 1", &cube(1.3), relative);
        println!("{relative}: {low}..{high}, {boxes} boxes");
        assert!(high - low <= relative * low && high - low < before);
        before = high - low;
    }
}
