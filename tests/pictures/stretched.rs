//! Graphs whose axes are stretched for display. Rays, statuses and distances are those of space.

use glam::DVec3;
use zeroset_render::framing;
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_space::{Camera, Region};
use zeroset_syntax::{Document, Options, read};
use zeroset_trace::{RayGrid, Status};

/// Columns and rows of the pictures.
const SIDE: usize = 128;

fn settings() -> Settings {
    let (width, height) = (SIDE, SIDE);
    Settings { width, height, keeps_normals: true, brackets: true, ..Settings::default() }
}

fn read_in(text: &str) -> (Document, Region) {
    let document = read(text, &Options::default()).expect(text);
    let (region, _) = region(&document, DomainChoice::Document, None).expect(text);
    (document, region)
}

fn drawn(text: &str) -> (Region, Camera, Picture) {
    let ((document, region), settings) = (read_in(text), settings());
    let model = Model::new(&document, &region, &settings).expect(text);
    let camera = framing::camera(&model, &CameraChoice::default(), &settings, false);
    let camera = camera.expect(text);
    let picture = model.trace(&camera, &settings, &|_| true).expect(text);
    (region, camera, picture)
}

#[test]
fn a_stretched_graph_looks_like_the_graph_of_stretched_heights() {
    for (tall, short, domain, by) in [
        ("1000 sin x", "0.9765625 sin x", "-6, 6", 1024.0),
        ("512 x*y", "x*y/4", "-2, 2", 2048.0),
        ("2048 cos(x)*cos(y)", "2cos(x)*cos(y)", "-5, 5", 1024.0),
    ] {
        let heights = |by: f64| 2048.0 / by;
        let text = |formula: &str, high: f64| {
            format!(
                "domain x in [{domain}], y in [{domain}], z in [{}, {high}]\nz = {formula}",
                -high
            )
        };
        let (region, camera, stretched) = drawn(&text(tall, heights(1.0)));
        assert_eq!(region.stretch(), DVec3::new(1.0, 1.0, 1.0 / by), "{tall}");
        let (document, plain_region) = read_in(&text(short, heights(by)));
        assert_eq!(plain_region.stretch(), DVec3::ONE, "{short}");
        let model = Model::new(&document, &plain_region, &settings()).expect(short);
        let plain = model.trace(&camera.displayed(), &settings(), &|_| true).expect(short);
        assert_eq!(stretched.buffer.status, plain.buffer.status, "{tall}");
        // Only rounding errors of normals, in `f32`, may change a color by a step.
        let pairs = stretched.rgb.iter().zip(&plain.rgb);
        let differ = pairs.filter(|(one, other)| one.abs_diff(**other) > 2).count();
        assert!(differ * 200 < stretched.rgb.len(), "{tall}: {differ} colors differ");
    }
}

#[test]
fn distances_and_brackets_are_those_of_space() {
    let (region, camera, picture) = drawn("z = 1000 sin(x)*cos(y)");
    assert!(region.stretch().z < 0.1, "{region:?}");
    let rays = RayGrid::new(&camera, SIDE, SIDE);
    let displayed = rays.displayed();
    let mut hits = 0;
    for pixel in 0..SIDE * SIDE {
        if picture.buffer.status[pixel] != Status::Hit {
            continue;
        }
        hits += 1;
        let ray = rays.ray_of(pixel);
        let off = |distance: f64| {
            let DVec3 { x, y, z } = ray.at(ray.parameter(distance));
            z - 1000.0 * x.sin() * y.cos()
        };
        let [near, far] = picture.buffer.bracket[pixel].map(off);
        assert!(near * far <= 0.0, "pixel {pixel}: {near} and {far} have one sign");
        let at = ray.at(ray.parameter(picture.buffer.drawn[pixel]));
        let shown = displayed.ray_of(pixel).at(ray.parameter(picture.buffer.drawn[pixel]));
        assert!((shown - at * region.stretch()).length() < 1e-9, "pixel {pixel}: {shown}");
        let normal = DVec3::from_array(picture.buffer.normal[pixel].map(f64::from));
        let gradient = |at: DVec3| {
            let [x, y] = [at.x, at.y].map(f64::sin_cos);
            DVec3::new(-1000.0 * x.1 * y.1, 1000.0 * x.0 * y.0, 1.0).normalize()
        };
        // Near an extremum, the gradient turns within a bracket.
        let ends = picture.buffer.bracket[pixel].map(|end| gradient(ray.at(ray.parameter(end))));
        let turn = ends[0].cross(ends[1]).length();
        let off = normal.cross(gradient(at)).length();
        assert!(off < turn + 0.01, "pixel {pixel}: {normal}, off by {off}, {turn} in the bracket");
    }
    assert!(hits > SIDE * SIDE / 5, "{hits} hits");
}
