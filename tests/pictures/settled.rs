//! A preview whose undecided pixels are refined equals the picture of a single pass.

use glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_render::progress::Done;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_shade::Pattern;
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};

#[test]
fn a_settled_preview_is_the_picture_of_one_pass() {
    let mut open = 0;
    for text in [
        "x^2+y^2+z^2=1",
        "sin(3x)*cos(3y)+sin(3y)*cos(3z)+sin(3z)*cos(3x)=0",
        "(x^2+y^2+z^2-1)*(x^2+y^2+(z-0.01)^2-1)=1e-5",
        "(x^2+y^2+z^2-1)^2=1e-8",
        "x*y*z=0.001",
        "z^3=0.2*y^2*x",
        "x^2*y^2+y^2*z^2+z^2*x^2=0",
        "1/x+y=z",
    ] {
        let document = read(text, &Options::default()).expect(text);
        let bounds = DomainChoice::Bounds([-1.2, 1.2, -1.2, 1.2, -1.2, 1.2]);
        let (region, _) = view::region(&document, bounds, None).expect(text);
        let eye = DVec3::new(2.0, 1.5, 3.0) * 1.2;
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, projection).expect(text);
        let settings = Settings { width: 160, height: 160, brackets: true, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect(text);
        let once = model.trace(&camera, &settings, &|_| true).expect(text);
        let preview = Settings { is_preview: true, ..settings.clone() };
        let preview = model.trace(&camera, &preview, &|_| true).expect(text);
        open += preview.statistics.pixels.undecided - once.statistics.pixels.undecided;
        let twice = model.settle(&preview, &camera, &settings, &|_| true).expect(text);
        let twice = twice.expect("wanted");
        for pixel in 0..160 * 160 {
            let of = |picture: &Picture| {
                let buffer = &picture.buffer;
                let bracket = buffer.bracket[pixel].map(f64::to_bits);
                (buffer.status[pixel], buffer.drawn[pixel], bracket)
            };
            assert_eq!(of(&once), of(&twice), "{text}, pixel {pixel}");
        }
        assert_eq!(once.rgb, twice.rgb, "{text}");
    }
    assert!(open > 0, "no preview left anything open");
}

/// Surfaces whose previews decide all, and one whose preview does not.
const COUNTED: [&str; 3] =
    ["x^2+y^2+z^2=1", "(x+0.6)^2+y^2+z^2=0.1; (x-0.5)^2+y^2+z^2=0.2", "(x^2+y^2+z^2-1)^2=1e-8"];

#[test]
fn the_work_that_is_told_adds_up_to_all_of_it() {
    let (mut settled, mut smoothed) = (0, 0);
    for text in COUNTED {
        let document = read(text, &Options::default()).expect(text);
        let bounds = DomainChoice::Bounds([-1.2, 1.2, -1.2, 1.2, -1.2, 1.2]);
        let (region, _) = view::region(&document, bounds, None).expect(text);
        let projection = Projection::Perspective { fov: 40.0 };
        let eye = DVec3::new(2.0, 1.5, 3.0) * 1.2;
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, projection).expect(text);
        let antialias = Pattern::of(16).expect(text);
        let settings = Settings { width: 150, height: 130, antialias, ..Settings::default() };
        let surfaces = document.surfaces.len();
        let model = Model::new(&document, &region, &settings).expect(text);
        let (pixels, edges, all_edges) =
            (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
        let advance = |done| {
            match done {
                Done::Pixels(now) => _ = pixels.fetch_add(now, Ordering::Relaxed),
                Done::Edges { now, all } => {
                    edges.fetch_add(now, Ordering::Relaxed);
                    all_edges.store(all, Ordering::Relaxed);
                }
            }
            true
        };
        let told = || [&pixels, &edges, &all_edges].map(|count| count.swap(0, Ordering::Relaxed));
        let smooth = model.trace(&camera, &settings, &advance).expect(text);
        let rays = settings.antialias.count();
        let edges = smooth.statistics.edge_rays / rays;
        assert_eq!(told(), [surfaces * 150 * 130, edges, edges], "{text}");
        smoothed += edges;
        let plain = Settings { is_preview: true, ..settings.plain() };
        let preview = model.trace(&camera, &plain, &advance).expect(text);
        assert_eq!(told(), [surfaces * 150 * 130, 0, 0], "{text}, preview");
        let open = preview.left_open();
        let plain = Settings { is_preview: false, ..plain };
        model.settle(&preview, &camera, &plain, &advance).expect(text).expect("wanted");
        assert_eq!(told(), [surfaces * open, 0, 0], "{text}, settled");
        settled += open;
    }
    assert!(settled > 0 && smoothed > 0, "nothing is left open, or there are no edges");
}
