//! Normals that `f32` cannot compute: far from the origin, or beyond the range of `f32`.

use glam::DVec3;
use zeroset_render::model::render;
use zeroset_render::picture::Settings;
use zeroset_space::Region;
use zeroset_syntax::{Options, read};
use zeroset_trace::{Camera, Projection};

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
    let picture = render(&document, &region, &camera, &settings, &|_, _| {}).expect("a picture");
    let (rays, buffer) = (camera.rays(SIDE, SIDE), &picture.buffer);
    let drawn: Vec<usize> = (0..SIDE * SIDE).filter(|&pixel| buffer.is_drawn(pixel)).collect();
    assert!(drawn.len() > 300, "{formula}: {} drawn", drawn.len());
    let angle = |&pixel: &usize| {
        let ray = rays.ray_of(pixel);
        let outward = (ray.at(ray.parameter(buffer.drawn[pixel])) - centre).normalize();
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
        assert!(worst < 0.6, "{formula}: {worst} degrees");
    }
}
