//! Masses, centroids and moments of solids whose density is a function.

use crate::{assert_in, cube};
use std::f64::consts::{E, PI};
use std::time::Instant;
use zeroset_interval::Interval;
use zeroset_measure::{Density, DensityFault, Solid, SolidKernels, solid};
use zeroset_scene::program::Program;
use zeroset_syntax::{Options, read, read_expression};

const BALL: &str = "x^2+y^2+z^2 <= 1";
/// The box from 0 to 1, 2 and 3, away from the middle of the domain.
const BOX: &str = "max(abs(x-0.5)-0.5, abs(y-1)-1, abs(z-1.5)-1.5) <= 0";

/// Measures the solid of a text with a density in ±`half`.
fn weighed(text: &str, density: &str, half: f64, relative: f64) -> Solid {
    let document = read(text, &Options::default()).expect(text);
    let density = read_expression(text, density, &Options::default()).expect(density);
    let region = cube(half);
    let program = Program::new(&document, zeroset_scene::view::bounds(&region)).expect(text);
    let density = Density::new(&density, program.domain()).expect("small");
    let kernels = SolidKernels::of(&program, 0).expect("kernels").weighted(&density);
    solid(&kernels, &region, relative, false, &|| true).expect("wanted")
}

#[test]
fn masses_and_centroids_are_within_narrow_bounds() {
    // A ball's integral of e^x, and of |x|.
    let exponential = 4.0 * PI / E;
    let wall = "1 <= x^2+y^2+z^2 <= 1.001";
    // The integral of the square of the radius between two spheres.
    let thin = 4.0 / 5.0 * PI * (2.5 * 0.001_f64.ln_1p()).exp_m1();
    for (text, density, half, mass, centroid) in [
        (BALL, "x^2+y^2+z^2", 1.1, 0.8 * PI, [0.0; 3]),
        (BALL, "2", 1.1, 8.0 / 3.0 * PI, [0.0; 3]),
        // The first moment is that of z², and the mass that of 1.
        (BALL, "1+z", 1.1, 4.0 / 3.0 * PI, [0.0, 0.0, 0.2]),
        (BALL, "exp(x)", 1.1, exponential, [(E * E - 7.0) / 2.0, 0.0, 0.0]),
        (BALL, "abs(x)", 1.1, PI / 2.0, [0.0; 3]),
        (BALL, "if(x < 0.5, 1, 3)", 1.1, PI * (4.0 / 3.0 + 5.0 / 12.0), [9.0 / 56.0, 0.0, 0.0]),
        (BALL, "1/(x^2+y^2+z^2+1)", 1.1, 4.0 * PI * (1.0 - PI / 4.0), [0.0; 3]),
        (BALL, "sqrt(1-x^2-y^2-z^2)", 1.1, PI * PI / 4.0, [0.0; 3]),
        (BOX, "1+x", 3.5, 9.0, [5.0 / 9.0, 1.0, 1.5]),
        (BOX, "x*y*z", 3.5, 4.5, [2.0 / 3.0, 4.0 / 3.0, 2.0]),
        (BOX, "-1-x", 3.5, -9.0, [5.0 / 9.0, 1.0, 1.5]),
        (wall, "x^2+y^2+z^2", 1.1, thin, [0.0; 3]),
    ] {
        let is_hard = density.starts_with("if") || density.starts_with("sqrt");
        let relative = if text == wall {
            1e-1
        } else if is_hard {
            2e-2
        } else {
            2e-3
        };
        let clock = Instant::now();
        let found = weighed(text, density, half, relative);
        let inertia = found.inertia().expect("a mass");
        println!(
            "{text}, {density}: {:?} {:?}, {} boxes, {:?}",
            found.volume,
            inertia.centroid,
            found.boxes,
            clock.elapsed()
        );
        assert_eq!((found.limit, found.fault), (None, None), "{density}");
        assert_in(mass, found.volume, 1.01 * relative * mass.abs(), density);
        for (exact, bounds) in centroid.into_iter().zip(inertia.centroid) {
            assert_in(exact, bounds, 3.0 * relative * half, density);
        }
        assert_eq!(found.may_lack_density, density.starts_with("sqrt"), "{density}");
    }
}

/// A cube of density 1 + x + y² has moments about its centroid that are known.
#[test]
fn moments_are_weighted() {
    let found = weighed("max(abs(x), abs(y), abs(z)) <= 1", "1+x/2+y^2", 1.5, 1e-3);
    let inertia = found.inertia().expect("a mass");
    // The integrals of 1 + y², x, x², y² and z² over the cube, weighted.
    let mass = 8.0 * (1.0 + 1.0 / 3.0);
    let first = 8.0 / 6.0;
    let [xx, yy, zz] = [mass / 3.0, 8.0 * (1.0 / 3.0 + 1.0 / 5.0), mass / 3.0];
    let xx = xx - first * first / mass;
    for (axis, exact) in [yy + zz, zz + xx, xx + yy].into_iter().enumerate() {
        assert_in(exact, inertia.moments[axis], 2e-2, "moment");
        assert_in(0.0, inertia.products[axis], 2e-2, "product");
    }
    // The integral of xy·xy. The box's corner is the origin.
    let found =
        weighed("0 <= x and x <= 1 and 0 <= y and y <= 1 and abs(z) <= 1", "x*y", 1.5, 1e-3);
    let [x, y] = [found.first[0], found.first[1]].map(|first| first.plus(Interval::ZERO));
    assert_in(1.0 / 3.0, x, 1e-3, "x");
    assert_in(1.0 / 3.0, y, 1e-3, "y");
    assert_in(2.0 / 9.0, found.products[2], 1e-3, "xy");
    assert_in(1.0 / 4.0, found.squares[0], 1e-3, "xx");
}

/// Bounds contain the mass at each width, and narrower ones take no more than their share of boxes.
#[test]
fn bounds_narrow_as_asked() {
    let mut before = f64::INFINITY;
    for relative in [0.3, 1e-1, 1e-2, 1e-3] {
        let found = weighed("x^2+y^2+4z^2 <= 1", "exp(x)*cos(y)", 1.1, relative);
        // For an ellipsoid, the integral of a harmonic function that depends on x and y alone.
        let Interval { lo, hi } = found.volume;
        println!("{relative}: {:?}, {} boxes", found.volume, found.boxes);
        assert!(hi - lo <= relative * lo && hi - lo < before, "{relative}: {lo} {hi}");
        assert!(lo <= 2.0 / 3.0 * PI && 2.0 / 3.0 * PI <= hi, "{relative}: {lo} {hi}");
        before = hi - lo;
    }
}

#[test]
fn a_density_without_values_or_bounds_is_at_fault() {
    for (density, is_undefined) in [
        ("1/x", false),
        ("1/(x^2+y^2+z^2)", false),
        ("1/(x-0.3)^2", false),
        ("tan(2x)", false),
        ("ln(x)", true),
        ("sqrt(x-0.9)", true),
        ("sqrt(x)", true),
        ("sqrt(0.96-x^2-y^2-z^2)", true),
        ("0/0*x", true),
    ] {
        let clock = Instant::now();
        let found = weighed(BALL, density, 1.1, 1e-2);
        println!("{density}: {:?} {:?}, {:?}", found.fault, found.limit, clock.elapsed());
        match found.fault.expect(density) {
            DensityFault::Undefined(_) => assert!(is_undefined, "{density}"),
            DensityFault::Unbounded(_) => assert!(!is_undefined, "{density}"),
        }
    }
    // Poles outside of the solid do no harm.
    let found = weighed(BALL, "1/(x-1.05)", 1.1, 1e-2);
    assert!(found.fault.is_none() && found.volume.is_negative(), "{found:?}");
}
