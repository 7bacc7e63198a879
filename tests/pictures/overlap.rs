//! Hidden parts of surfaces are not traced. The picture equals the merged pictures of each surface.

use glam::DVec3;
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};
use zeroset_trace::{GBuffer, Status};

const SIZE: usize = 128;

/// A picture of all surfaces, or of one of them.
fn picture(text: &str, only: Option<usize>, eye: DVec3, projection: Projection) -> Picture {
    let mut document = read(text, &Options::default()).expect(text);
    for (number, surface) in document.surfaces.iter_mut().enumerate() {
        surface.hidden = only.is_some_and(|only| only != number);
    }
    let bounds = DomainChoice::Bounds([-1.5, 1.5, -1.5, 1.5, -1.5, 1.5]);
    let (region, _) = view::region(&document, bounds, None).expect(text);
    let camera = Camera::new(eye, DVec3::ZERO, DVec3::Y, projection).expect(text);
    let settings = Settings { width: SIZE, height: SIZE, brackets: true, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect(text);
    model.trace(&camera, &settings, &|_| true).expect(text)
}

/// Status, painted distance and bracket of a pixel.
fn of(buffer: &GBuffer, pixel: usize) -> (Status, u64, [u64; 2]) {
    let bracket = buffer.bracket[pixel].map(f64::to_bits);
    (buffer.status[pixel], buffer.drawn[pixel].to_bits(), bracket)
}

#[test]
fn surfaces_together_are_those_alone_and_hidden_ones_are_not_looked_for() {
    for (text, surfaces) in [
        ("x^2+y^2+z^2=1\nx^2+y^2+z^2=1/2", 2),
        ("x^2+y^2+z^2=1/2\nx^2+y^2+z^2=1\nx*y*z=0.01", 3),
        ("x=0.3\nsin(5x)+sin(5y)+sin(5z)=0\ny<0.1", 3),
        ("(x^2+y^2+z^2+0.3)^2=1.6*(x^2+y^2)\n1/x+y=z\nz=x^2-y^2", 3),
    ] {
        let (mut together, mut alone) = (0, 0);
        for (eye, projection) in [
            (DVec3::new(2.0, 1.5, 3.0), Projection::Perspective { fov: 50.0 }),
            (DVec3::new(-4.0, 1.0, 0.5), Projection::Orthographic { height: 3.0 }),
            (DVec3::new(0.1, 0.2, 1.4), Projection::Perspective { fov: 90.0 }),
        ] {
            let all = picture(text, None, eye, projection);
            let one = |surface| picture(text, Some(surface), eye, projection);
            let each: Vec<Picture> = (0..surfaces).map(one).collect();
            let tiles = |picture: &Picture| picture.statistics.work.tiles.lanes;
            together += tiles(&all);
            alone += each.iter().map(tiles).sum::<u64>();
            let mut merged = each[0].buffer.clone();
            for other in &each[1..] {
                merged.merge(&other.buffer);
            }
            for pixel in 0..SIZE * SIZE {
                assert_eq!(of(&all.buffer, pixel), of(&merged, pixel), "{text}, pixel {pixel}");
            }
        }
        assert!(together < alone, "{text}: {together} tiles, alone {alone}");
    }
}
