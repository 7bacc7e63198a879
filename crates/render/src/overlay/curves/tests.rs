use super::*;
use crate::model::Model;
use crate::picture::{Picture, Settings};
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Document, Options, read};

const SIZE: usize = 256;

struct Scene {
    model: Model,
    camera: Camera,
    picture: Picture,
}

impl Scene {
    fn new(text: &str, eye: DVec3, projection: Projection) -> Self {
        let document: Document = read(text, &Options::default()).expect("reads");
        let region = view::region(&document, DomainChoice::Document, None).expect("a region").0;
        let settings = Settings { width: SIZE, height: SIZE, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect("a model");
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("a camera");
        let picture = model.picture(&camera, &settings).expect("a picture");
        Self { model, camera, picture }
    }

    fn shown(&self) -> PictureView<'_> {
        let Self { model, camera, picture } = self;
        PictureView::of(model, camera, picture)
    }

    /// The picture with its curves, as bytes.
    fn drawn(&self) -> Vec<u8> {
        let mut canvas = Canvas::new(SIZE, SIZE, Vec::new(), 1.0);
        draw_curves(&mut canvas, self.shown(), SIZE);
        let mut rgb = self.picture.rgb.clone();
        canvas.mix_into(&mut rgb, &mut [], 0);
        rgb
    }

    /// Returns whether a curve changed the pixel of a point.
    fn shows(&self, rgb: &[u8], at: DVec3) -> Option<bool> {
        let (place, _) = Projector::new(self.shown(), SIZE, SIZE).project(at)?;
        let pixel = place.y as usize * SIZE + place.x as usize;
        let of = |bytes: &[u8]| [0, 1, 2].map(|k| bytes[3 * pixel + k]);
        Some(of(rgb) != of(&self.picture.rgb))
    }
}

/// Points of a circle of radius `r` about a ball of radius 1, in a plane that `turn` turns.
fn circle(r: f64, turn: f64) -> impl Iterator<Item = DVec3> {
    (0..360).map(move |n| {
        let (sin, cos) = f64::from(n).to_radians().sin_cos();
        r * DVec3::new(cos, sin * turn.cos(), sin * turn.sin())
    })
}

/// Circles around a ball: a part is hidden if and only if the ball is between it and the eye.
#[test]
fn a_ball_hides_the_part_of_a_circle_behind_it() {
    let (mut scenes, mut all_hidden) = (0, 0);
    for turn in [0.0, 0.3, 0.8, 1.3, 1.5] {
        for (eye, projection) in [
            (DVec3::new(2.0, -6.0, 3.0), Projection::Perspective { fov: 40.0 }),
            (DVec3::new(-5.0, -1.0, 1.0), Projection::Perspective { fov: 50.0 }),
            (DVec3::new(2.0, -6.0, 3.0), Projection::Orthographic { height: 4.0 }),
            (DVec3::new(0.5, 7.0, -2.0), Projection::Orthographic { height: 4.5 }),
        ] {
            let radius = 1.3;
            let text = format!(
                "domain 2\nx^2+y^2+z^2=1\ncolor black\n\
                 ({radius}cos t, {radius}sin t cos {turn}, {radius}sin t sin {turn}) for t in [0, 2pi]"
            );
            let scene = Scene::new(&text, eye, projection);
            let rgb = scene.drawn();
            let (mut seen, mut hidden) = (0, 0);
            for at in circle(radius, turn) {
                // The distance of the ray from the ball's center, up to the point.
                let way = match projection {
                    Projection::Perspective { .. } => (eye - at).normalize(),
                    Projection::Orthographic { .. } => eye.normalize(),
                };
                let along = (-at).dot(way);
                let off = (at + way * along).length();
                if (off - 1.0).abs() < 0.06 {
                    continue;
                }
                let is_hidden = along > 0.0 && off < 1.0;
                let shows = scene.shows(&rgb, at).expect("in front of the eye");
                // Another part of the circle may be in front of a hidden one.
                if is_hidden && !shows {
                    hidden += 1;
                } else if !is_hidden {
                    assert!(shows, "{at} of {text}");
                    seen += 1;
                } else {
                    let front = circle(radius, turn).any(|other| {
                        let near = |one: DVec3| {
                            let projector = Projector::new(scene.shown(), SIZE, SIZE);
                            projector.project(one).map(|(place, _)| place)
                        };
                        let apart = near(other).zip(near(at)).map(|(a, b)| a.distance(b));
                        other.distance(at) > 0.5 && apart.is_some_and(|apart| apart < 4.0)
                    });
                    assert!(front, "{at} of {text} is hidden, but drawn");
                }
            }
            assert!(seen > 150, "{text}: {seen}");
            all_hidden += hidden;
            scenes += 1;
        }
    }
    assert!(scenes == 20 && all_hidden > 500, "{scenes} {all_hidden}");
}

/// A curve on its surface is seen without gaps on the side of the eye.
#[test]
fn a_curve_on_its_surface_is_not_stippled() {
    for projection in
        [Projection::Perspective { fov: 40.0 }, Projection::Orthographic { height: 4.0 }]
    {
        let text = "domain 1.5\nx^2+y^2+z^2=1\ncolor black\ncurve x^2+y^2+z^2=1, z=0.3x";
        let eye = DVec3::new(2.0, -6.0, 1.5);
        let scene = Scene::new(text, eye, projection);
        let rgb = scene.drawn();
        let toward = match projection {
            Projection::Perspective { .. } => 1.0 / eye.length(),
            Projection::Orthographic { .. } => 0.0,
        };
        let mut count = 0;
        for n in 0..720 {
            let (sin, cos) = f64::from(n).to_radians().sin_cos();
            let at = (cos * DVec3::new(1.0, 0.0, 0.3).normalize()) + sin * DVec3::Y;
            if at.dot(eye.normalize()) > toward + 0.03 {
                assert_eq!(scene.shows(&rgb, at), Some(true), "{at}");
                count += 1;
            } else if at.dot(eye.normalize()) < toward - 0.6 {
                assert_eq!(scene.shows(&rgb, at), Some(false), "{at}");
            }
        }
        assert!(count > 200, "{count}");
    }
}

#[test]
fn nearer_curves_are_over_farther_ones() {
    let text = "domain 1\ncolor red\n(t, 0.5, 0) for t in [-1, 1]\ncolor blue\n\
                (0, -0.5, t) for t in [-1, 1]";
    let eye = DVec3::new(0.0, -5.0, 0.0);
    let scene = Scene::new(text, eye, Projection::Perspective { fov: 30.0 });
    let rgb = scene.drawn();
    let middle = 3 * (SIZE / 2 * SIZE + SIZE / 2);
    assert!(rgb[middle + 2] > 150 && rgb[middle] < 100, "{:?}", &rgb[middle..middle + 3]);
    assert!(scene.picture.statistics.pixels.hit == 0);
}

/// A curve through the eye, and one around it, end at the eye's plane.
#[test]
fn curves_behind_the_eye_are_not_drawn() {
    let text = "domain 9\n(0, t, 0) for t in [-9, 9]\n(9cos t, 9sin t, 0) for t in [0, 2pi]";
    let eye = DVec3::new(0.0, -3.0, 0.1);
    for fov in [20.0, 120.0] {
        let scene = Scene::new(text, eye, Projection::Perspective { fov });
        let rgb = scene.drawn();
        let both = rgb.as_chunks::<3>().0.iter().zip(scene.picture.rgb.as_chunks::<3>().0);
        let changed = both.filter(|(one, other)| one != other).count();
        assert!((100..SIZE * SIZE / 4).contains(&changed), "{changed}");
    }
}

#[test]
fn points_have_labels_beside_them() {
    let text = "domain 2\n(0, 0, 0) \"O\"\n(1, 0, 0)";
    let eye = DVec3::new(0.0, -6.0, 0.0);
    let scene = Scene::new(text, eye, Projection::Perspective { fov: 40.0 });
    let labels: Vec<&str> =
        scene.model.curves().points.iter().map(|point| point.label.as_str()).collect();
    assert_eq!(labels, ["O", "(1, 0, 0)"]);
    let rgb = scene.drawn();
    assert_eq!(scene.shows(&rgb, DVec3::ZERO), Some(true));
    let changed = |x: std::ops::Range<usize>, y: usize| {
        x.filter(|x| {
            let pixel = 3 * (y * SIZE + x);
            rgb[pixel..pixel + 3] != scene.picture.rgb[pixel..pixel + 3]
        })
        .count()
    };
    // The letter O stands to the right of the ball.
    assert!(changed(SIZE / 2 + 6..SIZE / 2 + 20, SIZE / 2) >= 2);
    let hidden = Scene::new(
        "domain 2\nx^2+y^2+z^2=1\n(0, 1.5, 0)",
        eye,
        Projection::Perspective { fov: 40.0 },
    );
    assert_eq!(hidden.drawn(), hidden.picture.rgb);
}

#[test]
fn the_label_of_the_nearer_point_is_seen() {
    let eye = DVec3::new(0.0, -6.0, 0.0);
    let drawn = |points: &str| {
        let text = format!("domain 2\n{points}");
        let rgb = Scene::new(&text, eye, Projection::Orthographic { height: 4.0 }).drawn();
        // The label is to the right of the ball.
        let rows = rgb.chunks_exact(3 * SIZE);
        rows.flat_map(|row| row[3 * (SIZE / 2 + 8)..].to_vec()).collect::<Vec<u8>>()
    };
    let (near, far) = ("(0, -1, 0) \"NEAR\"", "(0, 1, 0) \"FAR\"");
    let alone = drawn(near);
    assert!(alone != drawn(far));
    assert!(drawn(&format!("{near}\n{far}")) == alone, "the nearer one first");
    assert!(drawn(&format!("{far}\n{near}")) == alone, "the nearer one last");
}

/// A small picture of the same view hides as well as one of full size.
#[test]
fn a_picture_may_be_smaller_than_the_canvas() {
    let text = "domain 2\nx^2+y^2+z^2=1\n(1.3cos t, 1.3sin t, 0) for t in [0, 2pi]";
    let scene = Scene::new(text, DVec3::new(0.0, -6.0, 1.0), Projection::Perspective { fov: 40.0 });
    let large = 3 * SIZE;
    let mut canvas = Canvas::new(large, large, vec![0x00ff_ffff; large * large], 1.0);
    draw_curves(&mut canvas, scene.shown(), large);
    let projector = Projector::new(scene.shown(), large, large);
    let shows = |at: DVec3| {
        let (place, _) = projector.project(at).expect("in front of the eye");
        canvas.pixels[place.y as usize * large + place.x as usize] != 0x00ff_ffff
    };
    assert!(shows(DVec3::new(0.0, -1.3, 0.0)) && shows(DVec3::new(1.3, 0.0, 0.0)));
    assert!(!shows(DVec3::new(0.0, 1.3, 0.0)) && !shows(DVec3::new(0.3, 1.265, 0.0)));
}
