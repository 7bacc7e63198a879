//! Outlines and haze: lines where edges are, and the background in what is far.

use glam::DVec3;
use zeroset_render::model::{Model, Strip};
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::program::ProgramError;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};

/// Columns and rows of the pictures.
const SIDE: usize = 96;

/// A picture seen against the y axis, in strips of this many rows. A unit is 24 pixels.
fn drawn(text: &str, rows: usize) -> Picture {
    let document = read(text, &Options::default()).expect(text);
    let (region, _) = region(&document, DomainChoice::Document, None).expect(text);
    let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect(text);
    let projection = Projection::Orthographic { height: 4.0 };
    let camera = Camera::new(-6.0 * DVec3::Y, DVec3::ZERO, DVec3::Z, projection).expect("a camera");
    let mut all: Option<Picture> = None;
    let mut add = |Strip { picture, .. }: Strip<'_>| -> Result<(), ProgramError> {
        match &mut all {
            None => all = Some(picture.clone()),
            Some(all) => all.rgb.extend(&picture.rgb),
        }
        Ok(())
    };
    model.strips_of_height(rows, &camera, &settings, None, &mut add).expect(text);
    all.expect("a strip")
}

fn color(picture: &Picture, [column, row]: [usize; 2]) -> [u8; 3] {
    picture.rgb.as_chunks::<3>().0[row * SIDE + column]
}

/// A roof whose ridge is in the middle of the picture, and a small ball in front of it.
const ROOF: &str = "look flat\ncolor gold\ndomain 1.5\ny=abs(x)\nx^2+(y+1)^2+(z-0.8)^2=0.09";

#[test]
fn outlines_are_dark_at_creases_and_ends_and_nowhere_else() {
    let (plain, lined) = (drawn(ROOF, SIDE), drawn(&format!("outlines\n{ROOF}"), SIDE));
    let change = |place| {
        let [before, after] = [&plain, &lined].map(|picture| color(picture, place)[0]);
        i32::from(before) - i32::from(after)
    };
    // The ridge, the left end of the roof, and the outline of the ball before the roof.
    for (place, what) in [([48_usize, 70], "ridge"), ([12, 70], "end"), ([55, 29], "ball")] {
        let darkest = (-2..=2).map(|step| change([place[0].saturating_add_signed(step), place[1]]));
        assert!(darkest.max() > Some(100), "{what}");
    }
    for place in [[30, 70], [70, 70], [48, 29], [4, 4], [90, 50]] {
        assert_eq!(change(place), 0, "{place:?}");
    }
    assert_eq!(plain.buffer.status, lined.buffer.status);
}

#[test]
fn outlines_are_light_before_a_dark_background() {
    let night = ROOF.replace("look flat", "look night");
    let (plain, lined) = (drawn(&night, SIDE), drawn(&format!("outlines\n{night}"), SIDE));
    let brightness = |picture, place| color(picture, place).into_iter().map(u32::from).sum::<u32>();
    // The left end of the roof, beside the background.
    let change = (10..15).map(|column| {
        let [before, after] = [&plain, &lined].map(|picture| brightness(picture, [column, 70]));
        i64::from(after) - i64::from(before)
    });
    assert!(change.max() > Some(200));
}

/// Most pictures keep no normals beyond their colors.
#[test]
fn outlines_need_no_kept_normals() {
    let text = format!("outlines\n{ROOF}");
    let document = read(&text, &Options::default()).expect("a roof");
    let (region, _) = region(&document, DomainChoice::Document, None).expect("a domain");
    let picture = |keeps_normals: bool| {
        let settings = Settings { width: SIDE, height: SIDE, keeps_normals, ..Settings::default() };
        let model = Model::new(&document, &region, &settings).expect("a model");
        let projection = Projection::Orthographic { height: 4.0 };
        let camera = Camera::new(-6.0 * DVec3::Y, DVec3::ZERO, DVec3::Z, projection);
        model.trace(&camera.expect("a camera"), &settings, &|_| true).expect("a picture").rgb
    };
    assert!(picture(false) == picture(true));
}

#[test]
fn outlines_do_not_depend_on_strips() {
    let text = format!("outlines\nhaze\n{ROOF}");
    assert!(drawn(&text, SIDE).rgb == drawn(&text, 32).rgb);
}

#[test]
fn haze_grows_with_the_distance_up_to_its_strength() {
    // A plane that leads away from the eye, before a red background.
    let text = "look flat\nbackground red\ncolor white\ndomain 1.5\nz=y";
    let (plain, hazed) = (drawn(text, SIDE), drawn(&format!("haze 50%\n{text}"), SIDE));
    let green = |picture: &Picture, row| f64::from(color(picture, [48, row])[1]) / 255.0;
    let light = |byte: f64| ((byte + 0.055) / 1.055).powf(2.4);
    let share = |row| 1.0 - light(green(&hazed, row)) / light(green(&plain, row));
    // From the near edge to the far one, green falls to half of its light.
    for (row, expected) in [(82, 0.02), (65, 0.14), (48, 0.25), (31, 0.37), (14, 0.49)] {
        assert!((share(row) - expected).abs() < 0.03, "{row}: {}", share(row));
    }
    assert_eq!(plain.buffer.status, hazed.buffer.status);
    assert_eq!(color(&hazed, [0, 0]), [255, 0, 0]);
}
