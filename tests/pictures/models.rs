//! The models draw without undecided pixels, and their pictures agree with the oracle's values of
//! the functions as typed.

use zeroset_render::framing;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::gallery::models;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_syntax::{Options, SurfaceKind, read};
use zeroset_testkit::{Defined, Oracle};
use zeroset_trace::{RayGrid, Status};

/// Pixels of a picture's side.
const SIDE: usize = 128;
/// Every so manyth pixel is compared with the oracle.
const STRIDE: usize = 211;
/// Points at which a ray that misses is sampled.
const SAMPLES: u32 = 60;

#[test]
fn models_are_decided_and_their_pictures_are_those_of_what_is_typed() {
    let (mut hits, mut misses, mut largest) = (0, 0, 0);
    for example in models() {
        let name = example.slug;
        let document = read(example.text, &Options::default());
        let document =
            document.unwrap_or_else(|e| panic!("{}", e.render(Some(name), example.text, false)));
        assert!(document.notes.is_empty(), "{name}: {:?}", document.notes);
        assert!(document.title.is_some() && document.domain.is_some(), "{name}");
        assert!(document.view.is_some(), "{name}");
        assert!(document.surfaces.iter().all(|s| s.kind == SurfaceKind::Solid), "{name}");
        largest = largest.max(document.graph.len());
        let (region, _) = region(&document, DomainChoice::Document, None).expect(name);
        let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect(name);
        let choice = CameraChoice::default();
        let camera = framing::camera(&model, &choice, &settings, false).expect(name);
        let buffer = model.trace(&camera, &settings, &|_| true).expect("kernels").buffer;
        let counts = buffer.counts();
        assert!(counts.hit > SIDE * SIDE / 8, "{name}: {counts:?}");
        assert!(1000 * counts.undecided <= counts.hit + counts.undecided, "{name}: {counts:?}");
        let roots: Vec<_> = document.surfaces.iter().map(|surface| surface.root).collect();
        let oracle = Oracle::new(&document.graph, &roots);
        let rays = RayGrid::new(&camera, SIDE, SIDE);
        for pixel in (0..SIDE * SIDE).step_by(STRIDE) {
            let ray = rays.ray_of(pixel);
            // Values at a point that lies about at this distance, of which rounding changes little.
            let at = |distance: f64| {
                let point = ray.at(ray.parameter(distance)).to_array();
                let claims = oracle.at(point, &[]);
                let inside = [0, 1, 2].iter().all(|axis| {
                    region.low()[*axis] < point[*axis] && point[*axis] < region.high()[*axis]
                });
                (inside, claims)
            };
            match buffer.status[pixel] {
                Status::Hit => {
                    let drawn = buffer.drawn[pixel];
                    let (inside, _) = at(drawn);
                    // The faces at which the domain or a restriction cuts a solid are no zeros.
                    if !inside || buffer.is_cap(pixel) {
                        continue;
                    }
                    let near = at(drawn).1.iter().map(|c| c.lo.abs()).fold(f64::INFINITY, f64::min);
                    assert!(near < 0.02, "{name}, pixel {pixel}: {near}");
                    hits += 1;
                }
                Status::Miss => {
                    let far = 2.0 * (camera.eye() - region.centre()).length();
                    for sample in 1..SAMPLES {
                        let (inside, claims) = at(far * f64::from(sample) / f64::from(SAMPLES));
                        let outside = claims
                            .iter()
                            .all(|claim| claim.defined != Defined::Yes || claim.hi > 0.0);
                        assert!(!inside || outside, "{name}, pixel {pixel}: {claims:?}");
                    }
                    misses += 1;
                }
                Status::Undecided => {}
            }
        }
    }
    println!("{hits} hits and {misses} misses compared; {largest} nodes at most");
    assert!(hits > 100 && misses > 100, "{hits}, {misses}");
    // One model has more than five hundred parts.
    assert!(largest > 5000, "{largest}");
}
