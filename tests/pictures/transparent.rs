//! Pictures without a background: opacities change neither proofs nor, before a background, colors.

use zeroset_render::framing;
use zeroset_render::model::{Model, Strip};
use zeroset_render::picture::{Picture, Settings};
use zeroset_render::pixels::flattened;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::program::ProgramError;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_shade::{LinearRgb, Pattern};
use zeroset_syntax::{Background, Options, SrgbColor, read};

/// Columns and rows of the pictures.
const SIDE: usize = 96;

const TEXTS: [&str; 3] = [
    "(sqrt(x^2+y^2)-1)^2+z^2=0.16",
    "color gold 40%\nx^2+y^2+z^2=1\ncolor navy\nx^2+y^2+z^2=0.1",
    "look night\nx*y*z=0.1 {x^2+y^2+z^2<1}\ncontours z",
];

/// The picture of a text before a background, drawn in strips of this many rows.
fn drawn(text: &str, background: Background, rows: usize) -> Picture {
    let document = read(text, &Options::default()).expect(text);
    let (region, _) = region(&document, DomainChoice::Document, None).expect(text);
    let antialias = Pattern::of(16).expect("a pattern");
    let (width, height, background) = (SIDE, SIDE, Some(background));
    let settings =
        Settings { width, height, brackets: true, antialias, background, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect(text);
    let camera = framing::camera(&model, &CameraChoice::default(), &settings, false);
    let camera = camera.expect(text);
    let mut all: Option<Picture> = None;
    let mut add = |Strip { picture, .. }: Strip<'_>| -> Result<(), ProgramError> {
        match &mut all {
            None => all = Some(picture.clone()),
            Some(all) => {
                all.rgb.extend(&picture.rgb);
                all.alpha.extend(&picture.alpha);
            }
        }
        Ok(())
    };
    model.strips_of_height(rows, &camera, &settings, None, &mut add).expect(text);
    all.expect("a strip")
}

fn plain(rgb: [u8; 3]) -> Background {
    Background::Color(SrgbColor { rgb })
}

/// The picture's light before a background, as sRGB bytes.
fn before(picture: &Picture, background: [u8; 3]) -> Vec<u8> {
    let back = LinearRgb::from_srgb(background).0;
    let mixed = |(own, alpha): (&[u8; 3], &u8)| {
        let (own, share) = (LinearRgb::from_srgb(*own).0, f32::from(*alpha) / 255.0);
        LinearRgb([0, 1, 2].map(|n| share * own[n] + (1.0 - share) * back[n])).to_srgb()
    };
    picture.rgb.as_chunks::<3>().0.iter().zip(&picture.alpha).flat_map(mixed).collect()
}

#[test]
fn opacities_give_the_picture_before_any_background() {
    for text in TEXTS {
        let clear = drawn(text, Background::Transparent, SIDE);
        for background in [[255; 3], [0; 3], [0, 160, 40]] {
            let opaque = drawn(text, plain(background), SIDE);
            assert!(opaque.alpha.is_empty(), "{text}");
            assert_eq!(clear.buffer.status, opaque.buffer.status, "{text}");
            let brackets = |picture: &Picture| format!("{:?}", picture.buffer.bracket);
            assert!(brackets(&clear) == brackets(&opaque), "{text}");
            let shown = before(&clear, background);
            let most = shown.iter().zip(&opaque.rgb).map(|(one, other)| one.abs_diff(*other));
            // Half a byte of opacity is up to six bytes of a dark color.
            assert!(most.max() <= Some(6), "{text} before {background:?}");
        }
    }
}

#[test]
fn pixels_are_opaque_on_surfaces_clear_beside_them_and_between_at_edges() {
    let [ring, ball, _] = TEXTS.map(|text| drawn(text, Background::Transparent, SIDE));
    let partly = |picture: &Picture| picture.alpha.iter().filter(|a| (1..255).contains(*a)).count();
    assert!((100..800).contains(&partly(&ring)), "{}", partly(&ring));
    // The corner, the hole, and the ring's front.
    let at = |picture: &Picture, row: usize| picture.alpha[row * SIDE + SIDE / 2];
    assert_eq!([ring.alpha[0], at(&ring, 41), at(&ring, 62)], [0, 0, 255]);
    // The translucent ball is partly transparent, except before the opaque ball inside.
    assert!(partly(&ball) > 2000, "{}", partly(&ball));
    assert_eq!(at(&ball, SIDE / 2), 255);
    // Programs that ignore opacities see the look's background.
    assert_eq!(ring.rgb[..3], ring.look.background);
    assert_eq!(ring.opaque_rgb()[..3], ring.look.background);
}

#[test]
fn a_shadow_on_the_ground_is_black_and_partly_transparent() {
    let text = format!("ground\n{}", TEXTS[0]);
    let clear = drawn(&text, Background::Transparent, SIDE);
    let white = drawn(&text, plain([255; 3]), SIDE);
    let shown = flattened(&clear.rgb, &clear.alpha, [255; 3]);
    let mut shadowed = 0;
    for pixel in (0..SIDE * SIDE).filter(|pixel| !clear.buffer.is_drawn(*pixel)) {
        let bytes = 3 * pixel..3 * pixel + 3;
        let beside = [pixel.wrapping_sub(1), pixel + 1, pixel.wrapping_sub(SIDE), pixel + SIDE];
        let mut beside = beside.into_iter().filter(|beside| *beside < SIDE * SIDE);
        let is_edge = beside.any(|beside| clear.buffer.is_drawn(beside));
        if clear.alpha[pixel] == 0 || is_edge {
            continue;
        }
        shadowed += usize::from(clear.alpha[pixel] > 30);
        assert_eq!(clear.rgb[bytes.clone()], [0; 3], "{pixel}");
        let [one, other] = [&*shown, &white.rgb].map(|rgb| rgb[bytes.start]);
        assert!(one.abs_diff(other) <= 1, "{pixel}: {one} {other}");
    }
    assert!(shadowed > 200, "{shadowed}");
}

#[test]
fn strips_have_the_opacities_of_the_whole() {
    for text in TEXTS {
        let [whole, strips] = [SIDE, 32].map(|rows| drawn(text, Background::Transparent, rows));
        assert_eq!(strips.alpha, whole.alpha, "{text}");
        assert_eq!(strips.rgb, whole.rgb, "{text}");
    }
}
