//! A preview whose undecided pixels are refined equals the picture of a single pass.

use glam::DVec3;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::view::{self, DomainChoice};
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
            let of = |picture: &zeroset_render::picture::Picture| {
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
