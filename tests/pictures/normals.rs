//! Normals that `f32` cannot compute: far from the origin, or beyond the range of `f32`.

use glam::DVec3;
use zeroset_render::model::render;
use zeroset_render::picture::Settings;
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Options, read};
use zeroset_trace::RayGrid;

const SIDE: usize = 48;

/// The largest angle, in degrees, between a stored normal and the sphere's outward normal.
fn worst(formula: &str, centre: DVec3, radius: f64) -> f64 {
    let document = read(formula, &Options::default()).expect(formula);
    let eye = centre + radius * DVec3::new(2.0, -3.0, 2.0);
    let projection = Projection::Perspective { fov: 40.0 };
    let camera = Camera::new(eye, centre, DVec3::Z, projection).expect(formula);
    let half = DVec3::splat(1.25 * radius);
    let region = Region::new(centre - half, centre + half).expect("a cube");
    let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
    let picture = render(&document, &region, &camera, &settings).expect("a picture");
    let (rays, buffer) = (RayGrid::new(&camera, SIDE, SIDE), &picture.buffer);
    let drawn: Vec<usize> = (0..SIDE * SIDE).filter(|&pixel| buffer.is_drawn(pixel)).collect();
    assert!(drawn.len() > 300, "{formula}: {} drawn", drawn.len());
    let angle = |&pixel: &usize| {
        let ray = rays.ray_of(pixel);
        // Where gradients change within a pixel, the normal is that at the zero itself.
        let painted = ray.at(ray.parameter(buffer.drawn[pixel]));
        let (to, along) = (centre - painted, ray.direction.normalize());
        let aside = (radius * radius - to.cross(along).length_squared()).max(0.0).sqrt();
        let zero = painted + along * (to.dot(along) - aside);
        let outward = (zero - centre).normalize();
        let normal = DVec3::from_array(buffer.normal[pixel].map(f64::from));
        normal.dot(outward).clamp(-1.0, 1.0).acos().to_degrees()
    };
    drawn.iter().map(angle).fold(0.0, f64::max)
}

#[test]
fn normals_of_spheres_are_radii_at_any_place_and_scale() {
    let zero = DVec3::ZERO;
    for (formula, centre, radius) in [
        ("x^2 + y^2 + z^2 = 1", zero, 1.0),
        ("(x - 1e6)^2 + y^2 + z^2 = 1", 1e6 * DVec3::X, 1.0),
        ("(x - 1e7)^2 + y^2 + z^2 = 1", 1e7 * DVec3::X, 1.0),
        ("x^2 + y^2 + z^2 = 1e-90", zero, 1e-45),
        ("x^2 + y^2 + z^2 = 1e-120", zero, 1e-60),
        ("(x^2 + y^2 + z^2)^3 = 1e-60", zero, 1e-10),
        ("(x^2 + y^2 + z^2)^2 = 1e60", zero, 1e15),
        ("1e-200 (x^2 + y^2 + z^2 - 1) = 0", zero, 1.0),
        ("exp(x^2 + y^2 + z^2) = 1e40", zero, (40.0 * 10.0_f64.ln()).sqrt()),
        ("(x^2 + y^2 + z^2)^4 = 1e80", zero, 1e10),
    ] {
        let worst = worst(formula, centre, radius);
        assert!(worst < 0.7, "{formula}: {worst} degrees");
    }
}

/// A heart: A³ − z³·B = 0, where A = x² + 9/4·y² + z² − 1. Its zeros at z = 0 are triple. The
/// function A − z·∛B has the same zeros, all simple.
const HEARTS: [(&str, f64); 2] = [
    ("(x^2+9/4*y^2+z^2-1)^3-x^2*z^3-9/80*y^2*z^3", 9.0 / 80.0),
    ("(x^2+9/4*y^2+z^2-1)^3 = x^2*z^3 + y^2*z^3", 1.0),
];

/// Near multiple zeros, gradients change direction within a pixel. Light is smooth there if the
/// gradient is taken close enough to the zero.
#[test]
fn normals_at_multiple_zeros_are_their_limits() {
    const SIDE: usize = 512;
    for (formula, weight) in HEARTS {
        let simple = |p: DVec3| {
            let [a, b] =
                [p.x * p.x + 2.25 * p.y * p.y + p.z * p.z - 1.0, p.x * p.x + weight * p.y * p.y];
            let root = b.cbrt();
            let inner = DVec3::new(2.0 * p.x, 2.0 * weight * p.y, 0.0) / (3.0 * root * root);
            let gradient = DVec3::new(2.0 * p.x, 4.5 * p.y, 2.0 * p.z) - p.z * inner;
            (a - p.z * root, gradient - root * DVec3::Z)
        };
        let document = read(formula, &Options::default()).expect(formula);
        let (mut counted, mut off) = (0, 0);
        for eye in [[2.0, -3.0, 1.5], [3.0, 1.0, 0.7], [-2.0, -2.5, -1.1], [0.5, -4.0, 0.3]] {
            let eye = 1.5 * DVec3::from_array(eye);
            let projection = Projection::Perspective { fov: 40.0 };
            let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect(formula);
            let region = Region::new(DVec3::splat(-1.5), DVec3::splat(1.5)).expect("a cube");
            let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
            let picture = render(&document, &region, &camera, &settings);
            let (rays, buffer) =
                (RayGrid::new(&camera, SIDE, SIDE), picture.expect("a picture").buffer);
            for pixel in (0..SIDE * SIDE).filter(|&pixel| buffer.is_drawn(pixel)) {
                let ray = rays.ray_of(pixel);
                let mut t = ray.parameter(buffer.drawn[pixel]);
                for _ in 0..8 {
                    let (value, gradient) = simple(ray.at(t));
                    t -= (value / gradient.dot(ray.direction)).clamp(-0.02, 0.02);
                }
                let (value, gradient) = simple(ray.at(t));
                if value.abs().is_nan() || value.abs() >= 1e-9 {
                    continue;
                }
                let normal = DVec3::from_array(buffer.normal[pixel].map(f64::from));
                let cosine = normal.dot(gradient.normalize()).clamp(-1.0, 1.0);
                counted += 1;
                off += usize::from(cosine.acos().to_degrees() > 1.0);
            }
        }
        println!("{formula}: {off} of {counted} normals off by more than 1 degree");
        assert!(counted > 160_000 && off * 1000 <= counted, "{formula}: {off} of {counted}");
    }
}
