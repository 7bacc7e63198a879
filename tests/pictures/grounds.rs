//! Materials, the ground, haze and outlines change colors only.

use zeroset_render::framing;
use zeroset_render::model::{Model, Strip};
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::program::ProgramError;
use zeroset_scene::view::{DomainChoice, region};
use zeroset_space::Camera;
use zeroset_style::MATERIALS;
use zeroset_syntax::{Options, read};

/// Columns and rows of the pictures.
const SIDE: usize = 96;

fn drawn(text: &str) -> (Camera, Picture) {
    drawn_from(None, text)
}

/// The picture of a text from a camera, or else from the automatic one, which is returned.
fn drawn_from(camera: Option<Camera>, text: &str) -> (Camera, Picture) {
    let document = read(text, &Options::default()).expect(text);
    let (region, _) = region(&document, DomainChoice::Document, None).expect(text);
    let settings = Settings { width: SIDE, height: SIDE, brackets: true, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect(text);
    let choice = CameraChoice::default();
    let fitted = || framing::camera(&model, &choice, &settings, false).expect(text);
    let camera = camera.unwrap_or_else(fitted);
    let picture = model.trace(&camera, &settings, &|_| true).expect(text);
    (camera, picture)
}

const TORUS: &str = "(sqrt(x^2+y^2)-1)^2+z^2=0.16";

/// Sum of a pixel's red, green and blue.
fn brightness(picture: &Picture, [column, row]: [usize; 2]) -> u32 {
    let color = picture.rgb.as_chunks::<3>().0[row * SIDE + column];
    color.iter().map(|part| u32::from(*part)).sum()
}

#[test]
fn statuses_and_brackets_know_no_ground_and_no_material() {
    let (camera, plain) = drawn(TORUS);
    let materials = MATERIALS.iter().map(|row| format!("material {}", row.name));
    let mut seen = vec![plain.rgb.clone()];
    for head in materials.chain(["ground", "haze", "outlines"].map(str::to_owned)) {
        let (_, picture) = drawn_from(Some(camera), &format!("{head}\n{TORUS}"));
        assert_eq!(picture.buffer.status, plain.buffer.status, "{head}");
        let brackets = |picture: &Picture| format!("{:?}", picture.buffer.bracket);
        assert!(brackets(&picture) == brackets(&plain), "{head}");
        let is_usual = head == "material satin";
        assert_eq!(seen.contains(&picture.rgb), is_usual, "{head} looks like another");
        seen.push(picture.rgb);
    }
}

#[test]
fn the_ground_is_dark_below_a_surface_and_fades_into_the_background() {
    let (_, picture) = drawn(&format!("ground\n{TORUS}"));
    let (_, plain) = drawn(TORUS);
    let background = brightness(&plain, [0, 0]);
    // Inside the ring, and just below it.
    let hole = (30..60)
        .map(|row| [48, row])
        .filter(|[column, row]| !plain.buffer.is_drawn(row * SIDE + column) && *row < 56);
    let darkest = hole.map(|at| brightness(&picture, at)).min().expect("a hole");
    assert!(darkest * 4 < background * 3, "{darkest} of {background}");
    for corner in [[0, 0], [SIDE - 1, 0]] {
        assert!(brightness(&picture, corner).abs_diff(background) <= 24, "{corner:?}");
    }
    // From below, the ground is not seen.
    let below = "ground\nview eye (0.1, 0.2, -6)\n";
    let above = "view eye (0.1, 0.2, -6)\n";
    assert_eq!(drawn(&format!("{below}{TORUS}")).1.rgb, drawn(&format!("{above}{TORUS}")).1.rgb);
}

#[test]
fn shadows_fit_into_the_picture() {
    for text in [TORUS, "x^2+y^2+z^2 = 1", "z = x^2+y^2 {z < 2}", "(y^2+z^2)^2 = 0.01 + x^2 - x^4"]
    {
        let (automatic, usual) = (drawn(&format!("ground\n{text}")), drawn(text));
        let (_, cropped) = drawn_from(Some(usual.0), &format!("ground\n{text}"));
        // The ground fades into the background toward the border, so only shadows are dark there.
        let darkest = |picture: &Picture| {
            (0..SIDE).map(|column| brightness(picture, [column, SIDE - 1])).min().expect("a row")
        };
        let [all, part] = [&automatic.1, &cropped].map(darkest);
        assert!(all > 600 && all >= part, "{text}: {all}, {part}");
    }
}

/// The lowest point of a solid is found as closely as that of a surface.
#[test]
fn solids_stand_on_the_ground() {
    let [surface, solid] =
        ["=", "<="].map(|sign| drawn(&format!("domain 2\nground\nx^2+y^2+z^2{sign}1")).1);
    let differ = surface.rgb.iter().zip(&solid.rgb).filter(|(a, b)| a.abs_diff(**b) > 8).count();
    assert!(differ * 100 < surface.rgb.len(), "{differ} bytes differ");
}

#[test]
fn glass_is_denser_toward_its_outline_and_shows_the_ground() {
    let text = "color black\nmaterial glass\nx^2+y^2+z^2=1";
    let (_, picture) = drawn(text);
    let row = SIDE / 2;
    let is_drawn = |column: &usize| picture.buffer.is_drawn(row * SIDE + column);
    let left = (0..SIDE).find(is_drawn).expect("a sphere");
    let [edge, middle] = [left + 3, SIDE / 2].map(|column| brightness(&picture, [column, row]));
    assert!(edge < middle, "{edge} at the outline, {middle} in the middle");
    let (_, on_ground) = drawn(&format!("ground\n{text}"));
    let differ = (0..SIDE * SIDE).filter(|pixel| {
        let place = [pixel % SIDE, pixel / SIDE];
        picture.buffer.is_drawn(*pixel)
            && brightness(&picture, place) > brightness(&on_ground, place) + 6
    });
    assert!(differ.count() > 50, "the shadow is not seen through the glass");
}

#[test]
fn strips_have_the_shadows_of_the_whole() {
    let text = format!("ground\n{TORUS}");
    let (camera, whole) = drawn(&text);
    let document = read(&text, &Options::default()).expect("a torus");
    let (region, _) = region(&document, DomainChoice::Document, None).expect("a domain");
    let settings = Settings { width: SIDE, height: SIDE, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect("a model");
    let mut rgb = Vec::new();
    let mut keep = |strip: Strip<'_>| -> Result<(), ProgramError> {
        rgb.extend_from_slice(&strip.picture.rgb);
        Ok(())
    };
    model.strips_of_height(32, &camera, &settings, None, &mut keep).expect("strips");
    assert_eq!(rgb.len(), whole.rgb.len());
    let differ = rgb.iter().zip(&whole.rgb).filter(|(a, b)| a.abs_diff(**b) > 4).count();
    assert!(differ * 500 < rgb.len(), "{differ} bytes differ");
}
