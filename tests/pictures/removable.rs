//! Pictures of quotients that can be removed, and of multiples of angles, against the same surfaces
//! by functions that were extended by hand.

use std::f64::consts::{LN_2, PI};
use zeroset_render::framing;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_syntax::{Options, read};
use zeroset_trace::{RayGrid, Status};

/// Pixels of a picture's side.
const SIDE: usize = 256;
/// Every so manyth pixel is compared.
const STRIDE: usize = 7;
/// Number of points on a ray at which the sign is compared.
const SAMPLES: u32 = 300;
/// A value closer to 0 than this may have either sign.
const ROUNDING: f64 = 1e-9;

/// A function without zeros.
fn none(_: f64, _: f64, _: f64) -> f64 {
    1.0
}

fn sinc(a: f64) -> f64 {
    if a == 0.0 { 1.0 } else { a.sin() / a }
}

/// (eᵃ − 1)/a
fn exp_secant(a: f64) -> f64 {
    if a == 0.0 { 1.0 } else { a.exp_m1() / a }
}

fn sinhc(a: f64) -> f64 {
    if a == 0.0 { 1.0 } else { a.sinh() / a }
}

/// (f(a) − f(b))/(a − b), from f and its derivative.
fn secant(f: fn(f64) -> f64, slope: fn(f64) -> f64, a: f64, b: f64) -> f64 {
    // Below this, the slope in the middle is off by less than 1e-10, and above it the quotient.
    const NEAR: f64 = 1e-5;
    if (a - b).abs() < NEAR { slope(a.midpoint(b)) } else { (f(a) - f(b)) / (a - b) }
}

/// Half the sum, and half the difference.
fn halves(x: f64, y: f64) -> [f64; 2] {
    [0.5 * (x + y), 0.5 * (x - y)]
}

/// A text, and its function extended by hand.
type Row = (&'static str, fn(f64, f64, f64) -> f64);

/// Quotients whose numerator and denominator have a common factor, half of the domain's side first.
const QUOTIENTS: [(&str, Row); 31] = [
    ("6", ("z = sin(x)/x", |x, _, z| z - sinc(x))),
    ("2", ("z = (x^2-y^2)/(x-y)", |x, y, z| z - x - y)),
    ("2", ("z = (x^2-1)/(x-1)", |x, _, z| z - x - 1.0)),
    ("2", ("z = (exp(x)-1)/x", |x, _, z| z - exp_secant(x))),
    ("3", ("z = sin(x*y)/(x*y)", |x, y, z| z - sinc(x * y))),
    ("1.5", ("z = tan(x)/x", |x, _, z| z - sinc(x) / x.cos())),
    ("4", ("z = (1-cos(x))/x^2", |x, _, z| z - sinc(x / 2.0).powi(2) / 2.0)),
    ("2", ("z = ln(1+x)/x", |x, _, z| z - if x == 0.0 { 1.0 } else { x.ln_1p() / x })),
    ("2", ("z = asin(x)/x", |x, _, z| z - if x == 0.0 { 1.0 } else { x.asin() / x })),
    ("2", ("z = x ln(x)", |x, _, z| z - x * x.ln())),
    ("2", ("z = (x^3+y^3)/(x+y)", |x, y, z| z - x * x + x * y - y * y)),
    ("3", ("z = 2 sin(3x)/x", |x, _, z| z - 6.0 * sinc(3.0 * x))),
    ("2", ("z = sin(x*y)/x", |x, y, z| z - y * sinc(x * y))),
    ("3", ("z = x/(exp(x)-1)", |x, _, z| z - 1.0 / exp_secant(x))),
    ("6", ("z = sin(hypot(x,y))/hypot(x,y)", |x, y, z| z - sinc(x.hypot(y)))),
    ("2", ("z = (sqrt(1+x)-1)/x", |x, _, z| z - 1.0 / ((1.0 + x).sqrt() + 1.0))),
    ("5", ("z = sin(x) sin(y)/(x y)", |x, y, z| z - sinc(x) * sinc(y))),
    ("2", ("z = x/(x-y) - y/(x-y) + x y", |x, y, z| z - 1.0 - x * y)),
    ("2", ("z = (x^4-1)/(x^2-1) sin(y)/y", |x, y, z| z - (x * x + 1.0) * sinc(y))),
    (
        "2",
        ("z = (cosh(x)-1)/(x sinh(x))", |x, _, z| {
            z - if x == 0.0 { 0.5 } else { (x / 2.0).tanh() / x }
        }),
    ),
    ("2", ("z = (exp(x)-exp(y))/(x-y)", |x, y, z| z - y.exp() * exp_secant(x - y))),
    ("3", ("z = (sin(x)-sin(y))/(x-y)", |x, y, z| z - x.midpoint(y).cos() * sinc((x - y) / 2.0))),
    ("3", ("z = (cos(x)-cos(y))/(x-y)", |x, y, z| z + x.midpoint(y).sin() * sinc((x - y) / 2.0))),
    ("3", ("z = (sqrt(x)-sqrt(y))/(x-y)", |x, y, z| z - 1.0 / (x.sqrt() + y.sqrt()))),
    ("3", ("z = (sqrt(4+x)-2)/x", |x, _, z| z - 1.0 / ((4.0 + x).sqrt() + 2.0))),
    ("3", ("z = sin(pi x)/(x-1)", |x, _, z| z + PI * sinc(PI * (x - 1.0)))),
    ("3", ("z = (2^x-1)/x", |x, _, z| z - LN_2 * exp_secant(x * LN_2))),
    (
        "3",
        ("z = (ln(x)-ln(y))/(x-y)", |x, y, z| {
            let v = (x - y) / (x + y);
            let secant = if v == 0.0 { 1.0 } else { v.atanh() / v };
            z - if x > 0.0 && y > 0.0 { 2.0 / (x + y) * secant } else { f64::NAN }
        }),
    ),
    // All zeros of the numerator are where the function is undefined.
    ("2", ("x^2/x = 0", none)),
    ("2", ("(x^2-1)/(x-1) = 2", none)),
    ("2", ("(x-y)^2 (x^2+1)/(y-x) = 0", none)),
];

/// Quotients by several factors or in two variables. Each numerator is 0 where a factor is.
const BY_FACTORS: [(&str, Row); 21] = [
    (
        "2",
        ("z = (y^2 cosh(x) - x^2 cosh(y))/(x^2-y^2)", |x, y, z| {
            let [p, q] = halves(x, y);
            z - 0.5 * (p * p + q * q) * sinhc(p) * sinhc(q) + p.cosh() * q.cosh()
        }),
    ),
    (
        "2",
        ("z = (y^2 cosh(x) - x^2 cosh(y))/((x-y) (x+y))", |x, y, z| {
            let [p, q] = halves(x, y);
            z - 0.5 * (p * p + q * q) * sinhc(p) * sinhc(q) + p.cosh() * q.cosh()
        }),
    ),
    (
        "3",
        ("z = (x sin(y) - y sin(x))/(x-y)", |x, y, z| {
            let d = x - y;
            let cosine = d / 2.0 * sinc(d / 2.0).powi(2);
            z - y.sin() * (1.0 + y * cosine) + y * y.cos() * sinc(d)
        }),
    ),
    (
        "3",
        ("z = (x sin(y) - y sin(x))/(x^2-y^2)", |x, y, z| {
            let [p, q] = halves(x, y);
            z - (sinc(p) * q.cos() - p.cos() * sinc(q)) / 2.0
        }),
    ),
    ("2", ("(x^3-y^3)/(x-y) = z+1", |x, y, z| x * x + x * y + y * y - z - 1.0)),
    ("2", ("z = (x^4-y^4)/(x^2-y^2)", |x, y, z| z - x * x - y * y)),
    (
        "3",
        ("z = (cos(x)-cos(y))/(x^2-y^2)", |x, y, z| {
            let [p, q] = halves(x, y);
            z + sinc(p) * sinc(q) / 2.0
        }),
    ),
    (
        "2",
        ("z = (x^2-y^2)/(cosh(x)-cosh(y))", |x, y, z| {
            let [p, q] = halves(x, y);
            z - 2.0 / (sinhc(p) * sinhc(q))
        }),
    ),
    (
        "2",
        ("z = (x exp(y) - y exp(x))/(x-y)", |x, y, z| z - y.exp() * (1.0 - y * exp_secant(x - y))),
    ),
    (
        "3",
        ("z = (atan(x)-atan(y))/(x-y)", |x, y, z| {
            z - secant(f64::atan, |m| 1.0 / (1.0 + m * m), x, y)
        }),
    ),
    (
        "3",
        ("z = (tanh(x)-tanh(y))/(x-y)", |x, y, z| {
            z - secant(f64::tanh, |m| m.cosh().powi(-2), x, y)
        }),
    ),
    (
        "3",
        ("z = (asinh(x)-asinh(y))/(x-y)", |x, y, z| {
            z - secant(f64::asinh, |m| 1.0 / m.hypot(1.0), x, y)
        }),
    ),
    (
        "0.9",
        ("z = (atanh(x)+atanh(y))/(x+y) - 1.5", |x, y, z| {
            z + 1.5 - secant(f64::atanh, |m| 1.0 / (1.0 - m * m), x, -y)
        }),
    ),
    (
        "3",
        ("z = (exp(sin(x))-exp(sin(y)))/(x-y)", |x, y, z| {
            z - secant(|a| a.sin().exp(), |m| m.cos() * m.sin().exp(), x, y)
        }),
    ),
    (
        "2",
        ("z = (sin(x^2)-sin(y^2))/(x^2-y^2)", |x, y, z| {
            z - secant(f64::sin, f64::cos, x * x, y * y)
        }),
    ),
    (
        "2",
        ("z = (sqrt(1+x^2)-sqrt(1+y^2))/(x-y)", |x, y, z| {
            z - secant(|a| a.hypot(1.0), |m| m / m.hypot(1.0), x, y)
        }),
    ),
    (
        "2",
        ("z = (x ln(y) - y ln(x))/(x-y)", |x, y, z| {
            if x > 0.0 && y > 0.0 {
                z - y.ln() + y * secant(f64::ln, f64::recip, x, y)
            } else {
                f64::NAN
            }
        }),
    ),
    (
        "2",
        ("z = sin(pi x)/(x^2-1)", |x, _, z| {
            z + PI / 2.0 * (sinc(PI * (x - 1.0)) - sinc(PI * (x + 1.0)))
        }),
    ),
    ("2", ("z = sin(pi x)/(x (1-x))", |x, _, z| z - PI * (sinc(PI * x) + sinc(PI * (x - 1.0))))),
    (
        "3",
        ("z = (cos(x)-cos(2y))/(x-2y) + (x^2-1)/(x-1)", |x, y, z| {
            z - secant(f64::cos, |m| -m.sin(), x, 2.0 * y) - x - 1.0
        }),
    ),
    (
        "3",
        ("z = (sin(x)-sin(2y))/(x-2y) + x/3", |x, y, z| {
            z - secant(f64::sin, f64::cos, x, 2.0 * y) - x / 3.0
        }),
    ),
];

const SOLIDS: [(&str, Row); 4] = [
    ("6", ("z <= sin(x)/x", |x, _, z| z - sinc(x))),
    ("2", ("z <= (x^2-y^2)/(x-y)", |x, y, z| z - x - y)),
    ("3", ("z <= sin(x*y)/(x*y)", |x, y, z| z - sinc(x * y))),
    ("2", ("z <= (exp(x)-1)/x and z >= x^2/x-1", |x, _, z| (z - exp_secant(x)).max(x - 1.0 - z))),
];

const ANGLES: [(&str, Row); 8] = [
    (
        "2",
        ("hypot(x,y) = 1+0.3cos(5atan2(y,x))", |x, y, _| {
            x.hypot(y) - 1.0 - 0.3 * (5.0 * y.atan2(x)).cos()
        }),
    ),
    (
        "2",
        ("hypot(x,y) = 1+0.3sin(4atan2(y,x)+3z)", |x, y, z| {
            x.hypot(y) - 1.0 - 0.3 * (4.0 * y.atan2(x) + 3.0 * z).sin()
        }),
    ),
    (
        "2",
        ("hypot(x,y) <= 1+0.3cos(5atan2(y,x)-pi/2)", |x, y, _| {
            x.hypot(y) - 1.0 - 0.3 * (5.0 * y.atan2(x) - PI / 2.0).cos()
        }),
    ),
    ("2", ("z = cos(7acos(x/2))", |x, _, z| z - (7.0 * (x / 2.0).acos()).cos())),
    ("2", ("z = sin(3acos(x/2)/2)", |x, _, z| z - (1.5 * (x / 2.0).acos()).sin())),
    (
        "2",
        ("z = sin(6acos(x))/sqrt(1-x^2)", |x, _, z| {
            if x.abs() > 1.0 { f64::NAN } else { z - 6.0 * x + 32.0 * x.powi(3) - 32.0 * x.powi(5) }
        }),
    ),
    (
        "2",
        ("z = sin(2atan(x)) + cos(3asin(y/2))", |x, y, z| {
            z - (2.0 * x.atan()).sin() - (3.0 * (y / 2.0).asin()).cos()
        }),
    ),
    (
        "1.2",
        (
            "r = hypot(x,y,z)\na = acos(z/r)\np = atan2(y,x)\n\
      hypot(r^8*sin(8a)*cos(8p)+x, r^8*sin(8a)*sin(8p)+y, r^8*cos(8a)+z) - 1.5 = 0",
            |x, y, z| {
                let (r, p) = (x.hypot(y).hypot(z), y.atan2(x));
                let (t, r8) = ((z / r).acos(), r.powi(8));
                let a = r8 * (8.0 * t).sin() * (8.0 * p).cos() + x;
                let b = r8 * (8.0 * t).sin() * (8.0 * p).sin() + y;
                a.hypot(b).hypot(r8 * (8.0 * t).cos() + z) - 1.5
            },
        ),
    ),
];

/// Compares claims with signs of the function by hand at points on the ray.
fn compare((side, (text, function)): (&str, Row)) {
    let text = format!("domain {side}\n{text}");
    let document = read(&text, &Options::default());
    let document = document.unwrap_or_else(|e| panic!("{}", e.render(None, &text, false)));
    let (region, _) = region(&document, DomainChoice::Document, None).expect("a domain");
    let settings = Settings { width: SIDE, height: SIDE, brackets: true, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect("kernels");
    let choice = CameraChoice::default();
    let camera = framing::camera(&model, &choice, &settings, false).expect("kernels");
    let buffer = model.trace(&camera, &settings, &|_| true).expect("kernels").buffer;
    let counts = buffer.counts();
    assert!(counts.undecided <= SIDE * SIDE / 500, "{text}: {counts:?}");
    let rays = RayGrid::new(&camera, SIDE, SIDE);
    let (low, high) = (region.low(), region.high());
    let (mut hits, mut misses) = (0, 0);
    for pixel in (0..SIDE * SIDE).step_by(STRIDE) {
        let ray = rays.ray_of(pixel);
        let value = |distance: f64| {
            let at = ray.at(ray.parameter(distance));
            let is_inside = (0..3).all(|axis| low[axis] < at[axis] && at[axis] < high[axis]);
            let value = function(at.x, at.y, at.z);
            (is_inside && value.abs() > ROUNDING).then_some(value)
        };
        let (from, to) = {
            let center = (low + high) / 2.0;
            let reach = (high - low).length() / 2.0;
            let away = (center - ray.at(ray.parameter(0.0))).length();
            ((away - reach).max(0.0), away + reach)
        };
        let is_hit = buffer.status[pixel] == Status::Hit;
        let [first, second] = buffer.bracket[pixel];
        let end = if is_hit { first } else { to };
        let mut last: Option<f64> = None;
        for k in 0..=SAMPLES {
            let sample = value(from + (end - from) * f64::from(k) / f64::from(SAMPLES));
            if buffer.status[pixel] != Status::Undecided
                && let (Some(a), Some(b)) = (last, sample)
                && a.is_finite()
                && b.is_finite()
            {
                assert!(a * b > 0.0, "{text}: pixel {pixel}, sign changes before {end}");
            }
            last = sample;
        }
        match buffer.status[pixel] {
            Status::Hit => {
                // The faces at which the domain cuts a solid are no zeros.
                if let ([Some(a), Some(b)], false) =
                    ([first, second].map(value), buffer.is_cap(pixel))
                {
                    hits += 1;
                    assert!(a * b < 0.0, "{text}: pixel {pixel} in [{first}, {second}]: {a} {b}");
                }
            }
            Status::Miss => misses += 1,
            Status::Undecided => {}
        }
    }
    let has_zeros = function(0.3, 0.4, 0.5) != 1.0;
    assert_eq!(hits > 200, has_zeros, "{text}: {hits}");
    assert!(misses > 100, "{text}: {misses}");
}

#[test]
fn removable_quotients_are_drawn_as_their_extensions() {
    QUOTIENTS.into_iter().for_each(compare);
}

#[test]
fn quotients_by_factors_are_drawn_as_their_extensions() {
    BY_FACTORS.into_iter().for_each(compare);
}

#[test]
fn removable_quotients_leave_no_gap_in_a_solid() {
    SOLIDS.into_iter().for_each(compare);
}

#[test]
fn multiples_of_angles_are_drawn_as_typed() {
    ANGLES.into_iter().for_each(compare);
}
