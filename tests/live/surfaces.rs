//! Surfaces are hidden, made translucent, moved and deleted. These edits of the text compile no
//! kernel. A line of a document may also hide a surface.

use super::live_support::{LIMIT, settled, start};
use zeroset_live::{Axes, Live, Rendering};
use zeroset_render::model::{Model, render};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::view::{self, DomainChoice};
use zeroset_syntax::{Document, Options};

const THREE: &str = "domain 2\ncolor red\nx^2+y^2+z^2 = 1\ncolor green\nz = 1.2\ncolor blue\n\
                     x^2+y^2 = 0.1";

fn kernels(seen: &Rendering) -> Vec<String> {
    seen.model.program().made().iter().map(|made| format!("{made:?}")).collect()
}

fn enter(live: &Live, line: &str) {
    live.enter(line).unwrap_or_else(|refusal| panic!("{line}: {refusal}"));
}

#[test]
fn hiding_and_showing_changes_the_picture_and_the_text_and_makes_no_kernel() {
    let live = start(THREE, 48);
    let first = settled(&live);
    enter(&live, ":hide 2");
    let hidden = settled(&live);
    assert!(hidden.picture.rgb != first.picture.rgb && hidden.camera == first.camera);
    assert!(hidden.model.is_rebound() && kernels(&hidden) == kernels(&first));
    assert!(
        live.text().contains("hidden\nz = 1.2\ncolor blue\nhidden off\nx^2"),
        "{}",
        live.text()
    );
    let listed = hidden.surfaces();
    let hid: Vec<bool> = listed.iter().map(|surface| surface.hidden).collect();
    assert_eq!(hid, [false, true, false]);
    assert_eq!(listed[0].colors, [[255, 0, 0]]);
    // The hidden plane is not drawn at any pixel.
    let buffer = &hidden.picture.buffer;
    let is_plane = |pixel: usize| buffer.is_drawn(pixel) && buffer.surface[pixel] == 1;
    assert!(!(0..buffer.status.len()).any(is_plane));
    enter(&live, ":show 2");
    let shown = settled(&live);
    assert!(shown.picture.rgb == first.picture.rgb && kernels(&shown) == kernels(&first));
    assert_eq!(live.text(), THREE);
    assert!(live.undo() && settled(&live).picture.rgb == hidden.picture.rgb);
    for number in [1, 3] {
        live.hide(number, true).expect("there is one");
    }
    let blank = settled(&live);
    let why = blank.why_blank().expect("nothing is seen");
    assert!(why.contains("every surface is hidden"), "{why}");
    assert_eq!(blank.picture.statistics.pixels.undecided, 0);
    enter(&live, ":show");
    assert!(settled(&live).picture.rgb == first.picture.rgb);
}

#[test]
fn code_for_what_is_hidden_is_made_when_it_is_shown_and_no_other() {
    let live = start(&format!("{THREE}\nhidden\nx^4+y^4+z^4 = 3"), 48);
    let first = settled(&live);
    let before = kernels(&first);
    enter(&live, ":show 4");
    let shown = settled(&live);
    let after = kernels(&shown);
    assert!(shown.model.is_rebound(), "everything was compiled again");
    assert!(after.len() > before.len() && after.starts_with(&before), "{after:#?}");
}

#[test]
fn an_opacity_is_dragged_in_one_step() {
    let live = start(THREE, 48);
    let first = settled(&live);
    live.hold(true);
    for share in [0.9, 0.6, 0.3] {
        live.set_opacity(2, share).expect("there is one");
        settled(&live);
    }
    live.hold(false);
    let dragged = settled(&live);
    assert!(dragged.model.is_rebound() && kernels(&dragged) == kernels(&first));
    assert_eq!(dragged.surfaces()[1].opacity, 0.3);
    assert!(dragged.picture.rgb != first.picture.rgb);
    assert!(live.undo());
    assert_eq!(live.text(), THREE);
    enter(&live, ":opacity 3 12.5%");
    assert_eq!(settled(&live).surfaces()[2].opacity, 0.125);
    assert!(live.enter(":opacity 1 150%").is_err() && live.enter(":opacity 9 0.5").is_err());
    assert!(live.enter(":opacity 0 0.5").is_err() && live.enter(":move 0 1").is_err());
}

#[test]
fn a_surface_gets_its_own_color_and_an_added_one_has_the_usual_look() {
    let usual = settled(&start("domain 2\nx^2+y^2+z^2 = 1\nz = 0", 48)).surfaces();
    let live = start("domain 2\ncolor tomato 50%\nx^2+y^2+z^2 = 1", 48);
    enter(&live, ":add z = 0");
    let added = settled(&live).surfaces();
    assert_eq!((added[0].opacity, added[1].opacity), (0.5, 1.0));
    assert_eq!(added[1].colors, usual[1].colors);
    enter(&live, ":color 2 #102030 25%");
    let colored = settled(&live).surfaces();
    assert_eq!((&*colored[1].colors, colored[1].opacity), (&[[16, 32, 48]][..], 0.25));
    assert_eq!(colored[0], added[0]);
    enter(&live, ":color 1 viridis(z)");
    let mapped = settled(&live).surfaces();
    assert_eq!((mapped[0].colors.len(), mapped[0].opacity), (6, 0.5));
    assert_eq!(mapped[1], colored[1]);
    enter(&live, ":color 2 auto");
    assert_eq!(settled(&live).surfaces()[1].colors, usual[1].colors);
    for (line, why) in [
        (":color 3 red", "there is no surface 3"),
        (":color 0 red", "there is no surface 0"),
        (":color 1 redd", "this is not a color"),
    ] {
        let refusal = live.enter(line).expect_err(line).to_string();
        assert!(refusal.contains(why), "{line}: {refusal}");
    }
}

#[test]
fn what_is_moved_or_left_looks_as_it_did() {
    let live = start(THREE, 48);
    let first = settled(&live);
    let echoes = |seen: &Rendering| -> Vec<(String, Vec<[u8; 3]>)> {
        seen.surfaces().into_iter().map(|one| (one.echo, one.colors)).collect()
    };
    let all = echoes(&first);
    enter(&live, ":move 1 3");
    let moved = settled(&live);
    let mut expected = all.clone();
    expected.rotate_left(1);
    assert_eq!(echoes(&moved), expected);
    assert!(moved.picture.rgb == first.picture.rgb, "it looks otherwise");
    enter(&live, ":delete 3");
    assert_eq!(echoes(&settled(&live)), expected[..2]);
    let refusal = live.enter(":move 1 3").expect_err("there are two").to_string();
    assert_eq!(refusal, "there is no surface 3; they are numbered 1 to 2");
}

fn document(text: &str) -> Document {
    zeroset_syntax::read(text, &Options::default()).expect("reads")
}

/// A file's `hidden` surface is not drawn, but is a surface of the model.
#[test]
fn a_picture_of_a_file_lacks_what_is_hidden() {
    let settings = start(THREE, 64).settings();
    for extra in ["", "shadows\n", "opacity 40%\n", "color viridis(z)\n"] {
        let hidden = format!("domain 2\n{extra}x^2+y^2+z^2 = 1\nhidden\nz = 1.2");
        let (hidden, alone) =
            (document(&hidden), document(&format!("domain 2\n{extra}x^2+y^2+z^2 = 1")));
        let (region, _) = view::region(&alone, DomainChoice::Document, None).expect("a region");
        let camera = camera::camera(&CameraChoice::typed(&alone), &region).expect("a camera");
        let picture =
            |document: &Document| render(document, &region, &camera, &settings).expect("renders");
        let (one, other) = (picture(&hidden), picture(&alone));
        assert!(one.rgb == other.rgb, "{extra:?}");
        assert!(one.buffer.status == other.buffer.status && one.legends == other.legends);
        let model = Model::new(&hidden, &region, &settings).expect("a model");
        assert_eq!(model.surfaces(), 2);
    }
}

#[test]
fn axes_have_room_unless_the_document_wants_none() {
    let live = start("x^2+y^2+z^2 = 1", 64);
    let plain = settled(&live);
    live.set_axes(Axes::Usual);
    let around = settled(&live);
    assert!(around.camera != plain.camera);
    enter(&live, "axes off");
    assert!(settled(&live).camera == plain.camera);
    live.set_axes(Axes::On);
    assert!(settled(&live).camera == around.camera);
    // Axes are not part of the document, so showing them is no undo step.
    assert!(live.undo());
    assert_eq!(live.text(), "x^2+y^2+z^2 = 1");
}

/// The region of a slider that runs holds the surfaces of its whole range, and the view fits that
/// region once.
#[test]
fn a_view_fits_the_whole_movement_of_a_slider_that_runs() {
    let live = start("r = 1 in [0.5, 8]\nx^2+y^2+z^2 = r^2", 64);
    live.set_axes(Axes::On);
    let first = settled(&live);
    let slider = first.sliders().remove(0);
    live.set_played(Some("r"));
    live.set_moving(true);
    live.pass(&slider, 1.01);
    let begun = settled(&live);
    assert!(begun.camera != first.camera, "the view is that of the first value");
    let half = begun.model.region().high().min_element();
    assert!((8.0..10.0).contains(&half), "{half}");
    for value in [1.5, 3.0, 8.0, 0.5] {
        live.pass(&slider, value);
        let seen = settled(&live);
        assert!(seen.camera == begun.camera, "the view jumped at {value}");
        assert!(seen.model.region() == begun.model.region(), "the region changed at {value}");
    }
}

/// The beginning of a line that shows nothing, or that cannot be read, leaves the picture before.
#[test]
fn the_beginning_of_a_line_leaves_the_last_picture_that_shows_something() {
    let live = start("z = x", 32);
    settled(&live);
    let shown = || {
        assert!(live.wait(LIMIT), "the picture does not settle");
        let seen = live.snapshot().rendering.expect("a picture");
        seen.document.surfaces[0].echo.clone()
    };
    for (line, expected) in [
        ("x^2 + y^2", "z = x"),
        ("x^2 + y^2 - b z^2", "z = x"),
        ("x^2 + y^2 = 1", "x^2 + y^2 = 1"),
        ("x^2 + y^2 = 1 + ", "x^2 + y^2 = 1"),
        ("x^2 + y^2 = 1 + z^2 + 9", "x^2 + y^2 = 1 + z^2 + 9"),
    ] {
        live.type_line(line);
        assert_eq!(shown(), expected, "{line}");
    }
    // A beginning that could be read is drawn, even if no picture of it was ever finished.
    live.type_line("x^2 + z^2 = 1");
    live.type_line("x^2 + z^2 = 1 and");
    assert_eq!(shown(), "x^2 + z^2 = 1");
    // A line that is entered is drawn whatever it shows.
    enter(&live, "x^2 + y^2");
    assert_eq!(shown(), "x^2 + y^2 = 0");
}

/// An automatic view stays while a value is dragged. Afterwards it glides until the surface fits.
#[test]
fn a_view_does_not_jump_while_a_value_moves() {
    let live = start("r = 1 in [0.5, 8]\nx^2+y^2+z^2 = r^2", 64);
    let first = settled(&live);
    let slider = first.sliders().remove(0);
    live.set_moving(true);
    for value in [1.5, 3.0, 7.0] {
        live.drag(&slider, value);
        let seen = settled(&live);
        assert!(seen.camera == first.camera, "the view jumped at {value}");
        assert!(value < 3.0 || seen.model.region() != first.model.region());
    }
    let far = |seen: &Rendering| (seen.camera.eye() - seen.camera.target()).length();
    live.set_moving(false);
    let mut way = vec![far(&first)];
    while !live.is_settled() {
        let seen = live.snapshot().rendering.expect("a picture");
        if Some(&far(&seen)) != way.last() {
            way.push(far(&seen));
        }
        // Shorter than a picture takes, so that no step of the way is missed.
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let last = settled(&live);
    assert!(far(&last) > 3.0 * far(&first), "{} is not farther away", far(&last));
    assert!(way.len() > 4 && way.is_sorted(), "it jumped: {way:?}");
    // In the final view the surface is as large as after a fresh start with this text.
    let fresh = settled(&start(&live.text(), 64));
    let share = |seen: &Rendering| {
        seen.picture.statistics.pixels.hit as f64 / seen.picture.buffer.drawn.len() as f64
    };
    let larger = (share(&last) / share(&fresh)).sqrt();
    assert!((0.95..1.05).contains(&larger), "{larger} times as large");
    // The view also glides after a value is set directly.
    live.enter(":set r = 1").expect("a value");
    let near = settled(&live);
    assert!(far(&near) < 0.5 * far(&last));
}
