//! The pixel counts of a picture equal those of its buffer.

use glam::DVec3;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};
use zeroset_trace::{METHODS, TraceOptions};

const SIZE: usize = 72;

#[test]
fn pixels_are_counted_as_they_are() {
    let sphere = "x^2+y^2+z^2=1";
    let two = "x^2+y^2+z^2=1/2\nx+y+z=1/3";
    let tangents = "tan(3e6*x+y)+tan(5e6*x+2y)=z";
    // A text, the hidden surface, and the calls of `advance` before the work is cancelled.
    for (text, hidden, calls) in [
        (sphere, None, usize::MAX),
        ("x^2+y^2+z^2<=2", None, usize::MAX),
        ("1/x+y=z", None, usize::MAX),
        ("z=x^2+1", None, usize::MAX),
        (two, None, usize::MAX),
        (two, Some(0), usize::MAX),
        (sphere, Some(0), usize::MAX),
        (sphere, None, 3),
        (sphere, None, 0),
        (two, None, 3),
        (two, None, 12),
        (tangents, None, 30),
    ] {
        let mut document = read(text, &Options::default()).expect(text);
        for (number, surface) in document.surfaces.iter_mut().enumerate() {
            surface.hidden = hidden == Some(number);
        }
        let bounds = DomainChoice::Bounds([-1.2, 1.2, -1.2, 1.2, -1.2, 1.2]);
        let (region, _) = view::region(&document, bounds, None).expect(text);
        let projection = Projection::Perspective { fov: 45.0 };
        let camera = Camera::new(DVec3::new(2.0, 1.5, 3.0), DVec3::ZERO, DVec3::Y, projection);
        let camera = camera.expect(text);
        for method in &METHODS {
            let settings = Settings {
                options: TraceOptions { depth: 8, ..TraceOptions::default() },
                width: SIZE,
                height: SIZE,
                method,
                ..Settings::default()
            };
            let model = Model::new(&document, &region, &settings).expect(text);
            let left = std::sync::atomic::AtomicUsize::new(calls);
            let order = std::sync::atomic::Ordering::Relaxed;
            let advance = |_| left.fetch_update(order, order, |left| left.checked_sub(1)).is_ok();
            let picture = model.trace(&camera, &settings, &advance).expect(text);
            let counted = picture.statistics.pixels;
            assert_eq!(counted, picture.buffer.counts(), "{text}, {}", method.name);
            assert_eq!(counted.miss + counted.hit + counted.undecided, SIZE * SIZE);
            let settled = model.settle(&picture, &camera, &settings, &|_| true).expect(text);
            let settled = settled.expect("wanted");
            assert_eq!(settled.statistics.pixels, settled.buffer.counts(), "{text}, settled");
        }
    }
}
