//! Solids whose volume, centroid and moments are known.

mod area;
mod density;

use glam::DVec3;
use std::f64::consts::PI;
use std::time::Instant;
use zeroset_eval::{LANES, Points};
use zeroset_interval::Interval;
use zeroset_measure::{Quantity, Request, Solid, SolidKernels, measure, solid};
use zeroset_scene::program::Program;
use zeroset_space::{HalfSpace, Region};
use zeroset_syntax::read;

/// An exact volume, as a function of a wall's thickness.
type Volume<'a> = &'a dyn Fn(f64) -> f64;

/// Measures the solid of a text.
fn measured(text: &str, region: &Region, relative: f64) -> Solid {
    let document = read(text, &zeroset_syntax::Options::default()).expect(text);
    let domain = zeroset_scene::view::bounds(region);
    let program = Program::new(&document, domain).expect(text);
    assert!(program.is_solid(0), "{text}");
    let kernels = SolidKernels::of(&program, 0).expect("kernels");
    solid(&kernels, region, relative, true, &|| true).expect("wanted")
}

fn cube(half: f64) -> Region {
    Region::new(DVec3::splat(-half), DVec3::splat(half)).expect("a region")
}

/// Asserts that a value is in an interval, which is as narrow as wanted.
fn assert_in(value: f64, bounds: Interval, width: f64, of: &str) {
    // The value itself is rounded.
    let near = 1e-14 * value.abs().max(1e-3);
    assert!(bounds.lo - near <= value && value <= bounds.hi + near, "{of}: {value}, {bounds:?}");
    assert!(bounds.hi - bounds.lo <= width, "{of}: {bounds:?} is wider than {width}");
}

#[test]
fn volumes_and_centroids_are_within_narrow_bounds() {
    // Γ(5/4)³ / Γ(7/4), of the superellipsoid of exponent 4.
    let quartic = 8.0 * 0.906_402_477_055_477_f64.powi(3) / 0.919_062_526_848_882_9;
    let lens = PI / 12.0 * (4.0 * 1.0 + 1.0) * (2.0_f64 - 1.0).powi(2);
    for (text, half, volume, centroid) in [
        ("x^2+y^2+z^2 <= 1", 1.1, 4.0 / 3.0 * PI, [0.0; 3]),
        ("(x-0.3)^2+(y+0.2)^2+(z-0.1)^2 <= 1", 1.5, 4.0 / 3.0 * PI, [0.3, -0.2, 0.1]),
        ("(sqrt(x^2+y^2)-1)^2+z^2 <= 0.16", 1.5, 2.0 * PI * PI * 0.16, [0.0; 3]),
        ("x^2+y^2/4+z^2/0.25 <= 1", 2.1, 4.0 / 3.0 * PI, [0.0; 3]),
        ("x^2+y^2 <= 1 and y^2+z^2 <= 1", 1.1, 16.0 / 3.0, [0.0; 3]),
        ("max(x^2+y^2, y^2+z^2, z^2+x^2) <= 1", 1.1, 8.0 * (2.0 - 2.0_f64.sqrt()), [0.0; 3]),
        ("x^2+y^2+z^2 <= 1 and z >= 0", 1.1, 2.0 / 3.0 * PI, [0.0, 0.0, 0.375]),
        ("x^2+y^2+z^2 <= 1 and z >= 0.5", 1.1, 5.0 / 24.0 * PI, [0.0, 0.0, 0.675]),
        ("x^2+y^2 <= (1-z)^2 and 0 <= z and z <= 1", 1.2, PI / 3.0, [0.0, 0.0, 0.25]),
        ("abs(x)+abs(y)+abs(z) <= 1", 1.1, 4.0 / 3.0, [0.0; 3]),
        ("x^4+y^4+z^4 <= 1", 1.1, quartic, [0.0; 3]),
        ("x^2+y^2+z^2 <= 1 and x^2+y^2+z^2 >= 0.25", 1.1, 7.0 / 6.0 * PI, [0.0; 3]),
        ("x^2+y^2+(z-0.5)^2 <= 1 and x^2+y^2+(z+0.5)^2 <= 1", 1.1, lens, [0.0; 3]),
        ("max(abs(x-0.2), abs(y), abs(z)) <= 0.7", 1.0, 2.744, [0.2, 0.0, 0.0]),
        ("x^2+y^2 <= z and z <= 1", 1.2, PI / 2.0, [0.0, 0.0, 2.0 / 3.0]),
    ] {
        let clock = Instant::now();
        let found = measured(text, &cube(half), 1e-3);
        let inertia = found.inertia().expect("a volume");
        println!(
            "{text}: {:?} {:?}, {} boxes, {:?}",
            found.volume,
            inertia.centroid,
            found.boxes,
            clock.elapsed()
        );
        assert_in(volume, found.volume, 1e-3 * volume, text);
        for (mean, bounds) in centroid.into_iter().zip(inertia.centroid) {
            assert_in(mean, bounds, 3e-3 * half, text);
        }
    }
}

/// Moments of inertia, and ends, of a box away from the middle of the domain.
#[test]
fn inertia_and_ends_are_within_bounds() {
    let text = "max(abs(x-0.3)-0.5, abs(y+0.1)-0.25, abs(z-0.4)-0.3) <= 0";
    let found = measured(text, &cube(1.0), 1e-3);
    let inertia = found.inertia().expect("a volume");
    let (sides, mass) = ([1.0, 0.5, 0.6], 0.3);
    for axis in 0..3 {
        let (one, other): (f64, f64) = (sides[(axis + 1) % 3], sides[(axis + 2) % 3]);
        let exact = mass * (one * one + other * other) / 12.0;
        assert_in(exact, inertia.moments[axis], 2e-3, "moment");
        assert_in(0.0, inertia.products[axis], 2e-3, "product");
        let middle = [0.3, -0.1, 0.4][axis];
        let half = 0.5 * sides[axis];
        assert_in(middle - half, found.low.expect("a point")[axis], 1e-2, "low end");
        assert_in(middle + half, found.high.expect("a point")[axis], 1e-2, "high end");
    }
    // An ellipsoid that is turned has products.
    let text = "(x+y)^2/2 + 4*(x-y)^2/2 + 4*z^2 <= 1";
    let inertia = measured(text, &cube(1.1), 1e-3).inertia().expect("a volume");
    let mass = 4.0 / 3.0 * PI / 4.0;
    assert_in(mass / 5.0 * 0.375, inertia.products[2], 2e-3, "xy");
    assert_in(mass / 5.0 * (1.0 + 0.25), inertia.moments[2], 2e-3, "zz");
}

#[test]
fn a_ball_and_a_plane_cut_solids() {
    let region = cube(1.0).with_ball();
    let ball = measured("x <= 5", &region, 1e-3);
    assert_in(4.0 / 3.0 * PI, ball.volume, 5e-3, "ball");
    let plane = HalfSpace { normal: DVec3::new(0.0, 0.0, -2.0), offset: -1.0 };
    let cap = measured("x <= 5", &region.with_clip(plane).expect("a plane"), 1e-3);
    assert_in(5.0 / 24.0 * PI, cap.volume, 1e-3, "cap");
    let low = cap.low.expect("a point")[2];
    assert_in(0.5, low, 1e-3, "the plane");
}

/// Where a function is undefined, there is no solid. Where it jumps, the solid ends.
#[test]
fn what_is_undefined_has_no_volume() {
    for (text, volume) in [
        ("sqrt(x) <= 0.5", 1.0),
        ("1/x <= 0", 4.0),
        ("floor(2x) <= 0", 6.0),
        ("ln(x) + 1 >= 0", 4.0 * (1.0 - (-1.0_f64).exp())),
    ] {
        let found = measured(text, &cube(1.0), 2e-2);
        println!("{text}: {:?}, {} boxes", found.volume, found.boxes);
        assert_in(volume, found.volume, 2e-2 * volume, text);
    }
    let nothing = measured("x^2+y^2+z^2 <= -1", &cube(1.0), 1e-3);
    assert!(nothing.volume.hi < 1e-9 && nothing.inertia().is_none() && nothing.low.is_none());
}

/// A function may be 0 in whole boxes. Whether the solid holds these is for its condition to say.
#[test]
fn a_function_that_is_zero_in_boxes_proves_no_more_than_its_condition() {
    for (text, volume, width) in [
        ("floor(x) < 0", 4.0, 0.2),
        ("floor(x) <= 0", 8.0, 0.4),
        ("max(x, 0) <= 0", 4.0, 0.2),
        ("max(x, 0) < 0", 0.0, 0.2),
        ("x*0 + floor(y/4) >= 0", 4.0, 0.2),
        ("x*0 + floor(y/4) > 0", 0.0, 0.2),
        // Its zeros belong to one half of the condition only, so those boxes stay undecided.
        ("floor(x) < 0 or floor(y) <= 0 and x > 2", 4.0, 4.1),
    ] {
        let found = measured(text, &cube(1.0), 5e-2);
        println!("{text}: {:?}, {} boxes", found.volume, found.boxes);
        assert_in(volume, found.volume, width, text);
    }
}

/// Random unions, intersections and differences. Points at random estimate the volume.
#[test]
fn random_solids_have_the_volume_that_samples_estimate() {
    const POINTS: usize = 40_000;
    let cases = std::env::var("ZEROSET_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(12);
    let mut rng = fastrand::Rng::with_seed(1);
    for case in 0..cases {
        let text = format!("{} <= 0", random_solid(&mut rng, 3));
        let region = cube(1.0);
        let found = measured(&text, &region, 1e-2);
        let document = read(&text, &zeroset_syntax::Options::default()).expect("reads");
        let program = Program::new(&document, zeroset_scene::view::bounds(&region)).expect("small");
        let kernel = program.kernels::<f64>(0).values().expect("a kernel");
        let mut inside = 0;
        for _ in 0..POINTS / LANES {
            let points: Vec<DVec3> = (0..LANES)
                .map(|_| DVec3::from_array([(); 3].map(|()| 2.0 * rng.f64() - 1.0)))
                .collect();
            let values = kernel.eval_all(&Points::near(&points));
            for (value, point) in values[0].value.iter().zip(&points) {
                if *value < -1e-9 {
                    inside += 1;
                    let (low, high) = (found.low.expect("a point"), found.high.expect("a point"));
                    let is_between =
                        (0..3).all(|k| low[k].lo <= point[k] && point[k] <= high[k].hi);
                    assert!(is_between, "{text}: {point:?} is beyond {low:?} {high:?}");
                }
            }
        }
        let share = f64::from(inside) / POINTS as f64;
        // Five standard deviations.
        let noise = 8.0 * 5.0 * (share * (1.0 - share) / POINTS as f64).sqrt() + 1e-3;
        let (volume, bounds) = (8.0 * share, found.volume);
        println!("case {case}: {volume} {bounds:?} {text}");
        assert!(bounds.lo - noise <= volume && volume <= bounds.hi + noise, "{text}");
    }
}

fn random_solid(rng: &mut fastrand::Rng, depth: u32) -> String {
    if depth == 0 {
        let [a, b, c] = [(); 3].map(|()| 1.4 * rng.f64() - 0.7);
        let r = 0.2 + 0.5 * rng.f64();
        return match rng.u32(0..4) {
            0 => format!("((x-({a:.3}))^2+(y-({b:.3}))^2+(z-({c:.3}))^2-{:.3})", r * r),
            1 => format!("(max(abs(x-({a:.3})),abs(y-({b:.3})),abs(z-({c:.3})))-{r:.3})"),
            2 => format!("({a:.3}*x+({b:.3})*y+({c:.3})*z-0.1)"),
            _ => format!("(sqrt((x-({a:.3}))^2+(z-({c:.3}))^2)+abs(y-({b:.3}))-{r:.3})"),
        };
    }
    let (one, other) = (random_solid(rng, depth - 1), random_solid(rng, depth - 1));
    match rng.u32(0..3) {
        0 => format!("min({one},{other})"),
        1 => format!("max({one},{other})"),
        _ => format!("max({one},-{other})"),
    }
}

/// Without a mesh there are no pieces, and without boxes no volume.
#[test]
fn nothing_is_computed_but_what_a_measure_needs() {
    for (quantities, has_mesh) in [
        (&[Quantity::Volume, Quantity::Centroid, Quantity::Inertia, Quantity::Ends][..], false),
        (&[Quantity::Volume][..], false),
        (&[][..], false),
        (&[Quantity::Shape][..], true),
        (&[Quantity::Area][..], true),
    ] {
        let text = "x^2+y^2+z^2 <= 1";
        let document = read(text, &zeroset_syntax::Options::default()).expect(text);
        let region = cube(1.1);
        let program = Program::new(&document, zeroset_scene::view::bounds(&region)).expect(text);
        let request = Request { quantities, relative: 0.1, ..Request::ALL };
        let found = measure(&program, 0, &region, None, &request, &|| true).expect("small");
        let found = found.expect("wanted");
        assert_eq!(found.shape.pieces.len(), usize::from(has_mesh), "{quantities:?}");
        let has_volume = quantities.contains(&Quantity::Volume);
        assert_eq!(found.solid.is_some(), has_volume, "{quantities:?}");
    }
}

/// A wall's volume is the difference of two volumes. Its bounds are narrow with few boxes: those of
/// the whole function would be many times the volume, with a million boxes.
#[test]
fn thin_walls_have_narrow_bounds() {
    // All are written so that no digits cancel.
    let outside = |t: f64| 4.0 / 3.0 * PI * t * (3.0 + 3.0 * t + t * t);
    let inside = |t: f64| 4.0 / 3.0 * PI * t * (3.0 - 3.0 * t + t * t);
    let torus = |t: f64| 2.0 * PI * PI * t * (0.8 - t);
    let cube = |t: f64| 8.0 * t * (3.0 - 3.0 * t + t * t);
    let slab = |t: f64| 9.0 * t;
    // The balls' caps above a plane.
    let cut = |t: f64| 2.0 / 3.0 * PI * t * (3.0 - 3.0 * t + t * t) + PI * 0.3 * t * (2.0 - t);
    for (text, t, volume) in [
        ("shell(sphere(1), T) <= 0", 1e-6, &inside as Volume),
        ("shell(sphere(1), T) <= 0", 1e-3, &inside),
        ("shell(sphere(1), T) <= 0", 1e-2, &inside),
        ("1 <= x^2+y^2+z^2 <= (1+T)^2", 1e-3, &outside),
        ("(x^2+y^2+z^2-1)*(x^2+y^2+z^2-(1+T)^2) <= 0", 1e-3, &outside),
        ("shell(torus(1, 0.4), T) <= 0", 1e-4, &torus),
        ("shell(box(1, 1, 1), T) <= 0", 1e-3, &cube),
        ("(x+2y+3z)*(x+2y+3z-3*T) <= 0 and abs(x) < 1.5 and abs(y) < 1.5", 1e-5, &slab),
        ("shell(sphere(1), T) <= 0 and z <= 0.3", 1e-3, &cut),
    ] {
        let clock = Instant::now();
        let (text, exact) = (text.replace('T', &t.to_string()), volume(t));
        let found = measured(&text, &self::cube(3.0), 2e-2);
        println!(
            "{text}: {:?} {exact}, {} boxes, {:?}",
            found.volume,
            found.boxes,
            clock.elapsed()
        );
        let Interval { lo, hi } = found.volume;
        assert!(lo <= exact && exact <= hi && hi - lo <= 2e-2 * exact, "{text}: {lo} {hi}");
        assert_eq!(found.limit, None, "{text}");
        assert!(found.boxes < 100_000, "{text}: {} boxes", found.boxes);
    }
}

/// Random walls between two ellipsoids or two tori, away from the middle of the domain.
#[test]
fn random_walls_have_their_exact_measures() {
    let cases = std::env::var("ZEROSET_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(8);
    let mut rng = fastrand::Rng::with_seed(2);
    println!("seed 2");
    for case in 0..cases {
        let mut within = |low: f64, high: f64| low + (high - low) * rng.f64();
        let middle = [(); 3].map(|()| within(-0.4, 0.4));
        let [x, y, z] = [0, 1, 2].map(|k| format!("({}-({}))", ["x", "y", "z"][k], middle[k]));
        let half = [(); 3].map(|()| within(0.5, 1.0));
        let t = 10.0_f64.powf(within(-5.0, -2.0));
        let (text, volume, zz, ends) = if case % 2 == 0 {
            let [a, b, c] = half;
            let inner = format!("({x}/{a})^2+({y}/{b})^2+({z}/{c})^2");
            // The measures of a unit ball, whose difference is that of powers of 1 + t.
            let ball = 4.0 / 3.0 * PI * a * b * c;
            let second = ball / 5.0 * (a * a + b * b);
            let power = |n: f64| (n * t.ln_1p()).exp_m1();
            (
                format!("1 <= sqrt({inner}) <= 1+{t}"),
                ball * power(3.0),
                second * power(5.0),
                half.map(|half| half * (1.0 + t)),
            )
        } else {
            let (large, small) = (1.0, 0.5 * half[0]);
            let inner = format!("(sqrt({x}^2+{y}^2)-{large})^2+{z}^2");
            // 2π²Rr², and m(R² + 3/4 r²).
            let square = t * (2.0 * small + t);
            let fourth = square * (2.0 * small * small + square);
            let volume = 2.0 * PI * PI * large * square;
            let second = 2.0 * PI * PI * large * (large * large * square + 0.75 * fourth);
            (
                format!("{small} <= sqrt({inner}) <= {small}+{t}"),
                volume,
                second,
                [large + small + t, large + small + t, small + t],
            )
        };
        let found = measured(&text, &cube(2.5), 5e-2);
        println!("case {case}: {volume} {:?} {} boxes {text}", found.volume, found.boxes);
        let inertia = found.inertia().expect("a volume");
        assert_in(volume, found.volume, 5.1e-2 * volume, &text);
        assert_eq!(found.limit, None, "{text}");
        for axis in 0..3 {
            // The integral over the coordinate, from the middle of the domain.
            assert_in(volume * middle[axis], found.first[axis], 0.2 * volume, &text);
            let (low, high) = (found.low.expect("a point"), found.high.expect("a point"));
            assert_in(middle[axis] - ends[axis], low[axis], 0.2, &text);
            assert_in(middle[axis] + ends[axis], high[axis], 0.2, &text);
        }
        assert_in(zz, inertia.moments[2], 0.8 * volume, &text);
    }
}
