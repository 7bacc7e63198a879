//! Surfaces that are looked for in boxes around them look as if looked for everywhere.

use super::super::Model;
use super::super::trace::RenderPass;
use crate::picture::{Picture, Settings};
use fastrand::Rng;
use glam::DVec3;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_shade::Pattern;
use zeroset_space::{Camera, Projection};
use zeroset_style::Choices;
use zeroset_syntax::{Options, read};
use zeroset_trace::{RayGrid, Status};

/// Number of random documents: `ZEROSET_CASES`, or a few.
fn cases() -> u64 {
    std::env::var("ZEROSET_CASES").map_or(12, |text| text.parse().expect("a number"))
}

/// A random equation: small, empty, cut by the domain, or unbounded. Or a solid, if `may_fill` is
/// set: it may fill the domain.
fn surface(may_fill: bool, rng: &mut Rng) -> String {
    let mut number = |low: f64, high: f64| low + (high - low) * rng.f64();
    let [x, y, z] = ["x", "y", "z"].map(|axis| format!("({axis}-({:.3}))", number(-1.1, 1.1)));
    let size = number(0.02, 0.3);
    let function = match rng.u32(0..8) {
        0..3 => format!("{x}^2+{y}^2+{z}^2-{size}^2"),
        3 => format!("abs{x}+abs{y}+abs{z}-{size}"),
        4 => format!("(sqrt({x}^2+{y}^2)-{size})^2+{z}^2-{size}^2/9"),
        5 => format!("{x}^2+{y}^2+{z}^2+{size}/100"),
        6 => format!("max(abs{x},abs{y},floor(4{z}))-{size}"),
        _ => format!("{size}/{x}+{y}-{z}"),
    };
    let sign = ["=", "<=", ">="][if may_fill { rng.usize(..8).saturating_sub(5) } else { 0 }];
    let opacity = ["", "; opacity 40%"][usize::from(rng.u32(..6) == 0)];
    format!("{function} {sign} 0{opacity}")
}

/// A camera near or in the cube from −1 to 1, or far away.
fn camera(rng: &mut Rng) -> Camera {
    let mut place = |size: f64| DVec3::from([(); 3].map(|()| size * (2.0 * rng.f64() - 1.0)));
    let (near, target, up) = (place(1.5), place(0.5), place(1.0));
    let far = near.normalize() * 4.0;
    let (eye, projection) = match rng.u32(..4) {
        0 => (near, Projection::Perspective { fov: 70.0 }),
        1 => (far, Projection::Orthographic { height: 2.0 }),
        2 => (1e5 * far, Projection::Perspective { fov: 3e-4 }),
        _ => (far, Projection::Perspective { fov: 30.0 }),
    };
    Camera::new(eye, target, up, projection).expect("a camera")
}

#[test]
fn surfaces_are_the_same_in_boxes_around_them() {
    let (mut hits, mut fewer, mut several) = (0, 0, 0);
    for seed in 0..cases() {
        let rng = &mut Rng::with_seed(seed);
        let text: Vec<String> =
            (0..rng.usize(2..24)).map(|_| surface(seed % 3 == 0, rng)).collect();
        let text = format!("domain 1\n{}", text.join("\n"));
        let document = read(&text, &Options::default()).expect(&text);
        let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
        let antialias = Pattern::of(if rng.bool() { 4 } else { 16 }).expect("a pattern");
        let shadows = (rng.u32(..3) == 0).then_some(true);
        let choices = Choices { shadows, ..Choices::default() };
        let settings =
            Settings { width: 70, height: 52, antialias, choices, ..Settings::default() };
        let rays = RayGrid::new(&camera(rng), settings.width, settings.height);
        let Ok(model) = Model::new(&document, &region, &settings) else { continue };
        let [bounded, everywhere]: [Picture; 2] = [false, true].map(|whole| {
            let mut pass = RenderPass::<f32>::new(&model, &settings, &|_| true);
            pass.whole = whole;
            pass.draw(&rays).expect("compiled")
        });
        let (own, all) = (&bounded.buffer, &everywhere.buffer);
        let mut is_same = true;
        for pixel in 0..own.status.len() {
            // A ray past a box is a proven miss, even where tracing could not decide it.
            let is_decided =
                own.status[pixel] != Status::Undecided && all.status[pixel] == Status::Undecided;
            fewer += usize::from(is_decided);
            is_same &= !is_decided;
            if !is_decided {
                let result = |buffer: &zeroset_trace::GBuffer| {
                    let surface = buffer.is_drawn(pixel).then(|| buffer.surface[pixel]);
                    (buffer.status[pixel], surface, buffer.drawn[pixel].to_bits())
                };
                assert_eq!(result(own), result(all), "pixel {pixel}, case {seed}\n{text}");
            }
            hits += usize::from(own.status[pixel] == Status::Hit);
        }
        if is_same {
            assert!(bounded.rgb == everywhere.rgb, "colors, case {seed}\n{text}");
        }
        let surfaces = (0..model.surfaces()).filter(|surface| {
            (0..own.status.len()).any(|n| own.is_drawn(n) && own.surface[n] == *surface as u16)
        });
        several += usize::from(surfaces.count() > 2);
    }
    println!("{hits} hits, {fewer} pixels decided by boxes alone, {several} pictures of several");
    assert!(hits > 0 && several * 3 > cases() as usize);
}
