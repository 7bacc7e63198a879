//! Points that a click describes, against exact roots: every digit that is printed is true.

use glam::DVec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use zeroset_render::framing;
use zeroset_render::model::{Model, true_digits};
use zeroset_render::picture::Settings;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::gallery::examples;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::Ray;
use zeroset_syntax::{Options, read};
use zeroset_testkit::{Adversarial, Effort, Oracle, Rng};
use zeroset_trace::{RayGrid, Status};

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("finite")
}

/// The first zero on a ray of p(t) = a·t² + 2b·t + c, within 10⁻⁴⁰.
fn first_root([a, b, c]: [BigRational; 3]) -> Option<BigRational> {
    let inner = &b * &b - &a * &c;
    if inner.is_negative() {
        return None;
    }
    let scale = BigInt::from(10).pow(45);
    let scaled = (inner * BigRational::from(&scale * &scale)).to_integer().sqrt();
    Some((-b - BigRational::new(scaled, scale)) / a)
}

/// The decimal text of a number, rounded to nearest.
fn decimals(value: &BigRational, digits: usize) -> String {
    let scale = BigInt::from(10).pow(digits as u32);
    let half = BigRational::new(BigInt::from(1), BigInt::from(2));
    let scaled = (value.abs() * BigRational::from(scale) + half).floor().to_integer();
    let text = format!("{:0>width$}", scaled.to_string(), width = digits + 1);
    let (whole, part) = text.split_at(text.len() - digits);
    let sign = if value.is_negative() && !scaled.is_zero() { "-" } else { "" };
    if digits == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{part}") }
}

#[test]
fn every_digit_of_a_click_is_true() {
    let text = "x^2+2y^2+3z^2 = 1";
    let document = read(text, &Options::default()).expect(text);
    let cube = DomainChoice::Bounds([-1.1, 1.1, -1.1, 1.1, -1.1, 1.1]);
    let (region, _) = view::region(&document, cube, None).expect(text);
    let model = Model::new(&document, &region, &Settings::default()).expect(text);
    let effort = Effort::from_environment(0x5eed_c11c, 1000);
    let (mut clicks, mut digits) = (0_u64, 0);
    for seed in effort.seed..effort.seed + 2 * effort.cases {
        let rng = &mut Rng::with_seed(seed);
        let signed = |rng: &mut Rng| 2.0 * f64::uniform(rng) - 1.0;
        let origin = DVec3::new(signed(rng) * 4.0, -6.0, signed(rng) * 4.0);
        let target = DVec3::new(signed(rng), signed(rng), signed(rng)) * 0.6;
        let ray = Ray { origin, direction: (target - origin).normalize() };
        let weights = [1, 2, 3].map(|weight| BigRational::from(BigInt::from(weight)));
        let sum = |f: &dyn Fn(usize) -> BigRational| {
            (0..3).map(|axis| &weights[axis] * f(axis)).sum::<BigRational>()
        };
        let (o, d) = (origin.to_array().map(exact), ray.direction.to_array().map(exact));
        let polynomial = [
            sum(&|k| &d[k] * &d[k]),
            sum(&|k| &o[k] * &d[k]),
            sum(&|k| &o[k] * &o[k]) - BigRational::from(BigInt::from(1)),
        ];
        let Some(root) = first_root(polynomial) else { continue };
        let near = num_traits::ToPrimitive::to_f64(&root).expect("a number") + signed(rng) * 1e-3;
        let Some(found) = model.locate(0, &ray, near, 2e-3) else { continue };
        assert!(exact(found.t[0]) <= root && root <= exact(found.t[1]), "{root} {:?}", found.t);
        for axis in 0..3 {
            let shown = true_digits(found.at[axis]);
            let places = places(&shown);
            let truth = decimals(&(&o[axis] + &root * &d[axis]), places);
            assert_eq!(shown, truth, "ZEROSET_SEED={seed:#x} ZEROSET_CASES=1");
            digits += places;
        }
        clicks += 1;
    }
    println!(
        "{clicks} clicks, {} digits behind the point on average",
        digits as u64 / (3 * clicks)
    );
    assert!(clicks > effort.cases && digits as u64 > 12 * 3 * clicks, "{clicks} {digits}");
}

/// Number of decimals of a text such as `-1.250`.
fn places(text: &str) -> usize {
    text.split('.').nth(1).map_or(0, str::len)
}

/// The ends of the range of numbers that are printed as `text`.
fn rounded_to(text: &str) -> (f64, f64) {
    let half = 0.5 * 10_f64.powi(-(places(text) as i32));
    let value = text.parse::<f64>().expect(text);
    // Rounding of the ends themselves.
    let slack = 2.0 * f64::EPSILON * value.abs();
    (value - half - slack, value + half + slack)
}

/// Surfaces on which the function as typed is 0 without a change of its sign.
const TOUCHING: [&str; 3] =
    ["double-root-sphere", "double-sphere-before-a-plane", "two-shells-one-touching"];

#[test]
fn every_digit_of_a_click_on_the_gallery_is_true() {
    const SIDE: usize = 48;
    let (mut hits, mut located, mut digits) = (0, 0, 0);
    for example in examples() {
        let name = example.slug;
        let document = read(example.text, &Options::default()).expect(name);
        let (region, _) = view::region(&document, DomainChoice::Document, None).expect(name);
        let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect(name);
        let choice = CameraChoice::default();
        let camera = framing::camera(&model, &choice, &settings, false).expect(name);
        let picture = model.picture(&camera, &settings).expect(name);
        let oracle = Oracle::new(&document.graph, &[document.surfaces[0].root]);
        let values = document.parameters.iter().map(|parameter| parameter.value.bounds());
        let values: Vec<_> = values.map(|value| (value.lo, value.hi)).collect();
        let rays = RayGrid::new(&camera, SIDE, SIDE);
        let (hits_before, located_before) = (hits, located);
        for pixel in (0..SIDE * SIDE).filter(|n| picture.buffer.status[*n] == Status::Hit) {
            hits += 1;
            let Some(found) = model.locate_pixel(&picture, &rays, &settings, pixel) else {
                continue;
            };
            located += 1;
            let ray = rays.ray_of(pixel);
            let shown = found.at.map(true_digits);
            digits += shown.iter().map(|text| places(text)).sum::<usize>();
            let printed = [0, 1, 2].map(|axis| rounded_to(&shown[axis]));
            let ends = found.t.map(|t| ray.at(t).to_array());
            let is_printed =
                |end: &[f64; 3]| (0..3).all(|n| printed[n].0 <= end[n] && end[n] <= printed[n].1);
            assert!(ends.iter().all(is_printed), "{name}: {ends:?} are printed as {shown:?}");
            let signs = ends.map(|end| {
                let value = oracle.at(end, &values)[0];
                i32::from(value.lo > 0.0) - i32::from(value.hi < 0.0)
            });
            let changes = signs[0] * signs[1] < 0 || TOUCHING.contains(&name);
            assert!(changes, "{name}: signs {signs:?} at {ends:?}");
            let claim = oracle.over(printed, &values)[0];
            assert!(claim.values.lo <= 0.0 && claim.values.hi >= 0.0, "{name}: {shown:?}");
            // A change of sign at a pole or at a jump is no zero.
            assert!(claim.continuous, "{name}: {shown:?}");
        }
        let (hits, located) = (hits - hits_before, located - located_before);
        assert!(10 * located >= 9 * hits, "{name}: {located} of {hits}");
    }
    println!("{located} of {hits} hits located, {digits} digits in all");
    assert!(hits > 50_000 && 99 * hits < 100 * located, "{located} of {hits}");
    assert!(digits > 12 * 3 * located, "{digits} digits");
}
