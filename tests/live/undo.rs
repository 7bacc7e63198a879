//! Undo and redo of every edit, removal of surfaces and of the document, and the cut that removes
//! the front of the scene.

use super::live_support::{LIMIT, settled, start};
use glam::DVec3;
use zeroset_live::{DocumentSource, Live, Reply};
use zeroset_scene::view::ClipChoice;
use zeroset_space::HalfSpace;

fn enter(live: &Live, line: &str) {
    live.enter(line).unwrap_or_else(|refusal| panic!("{line}: {refusal}"));
}

#[test]
fn everything_said_is_taken_back_and_said_again() {
    let live = start("domain 2\nr = 1 in [0, 2]\nx^2+y^2+z^2 = r", 16);
    settled(&live);
    let mut said = vec![live.request()];
    for line in [
        "x^2+y^2 = r",
        ":set r = 1.5",
        ":domain 3",
        ":view top",
        ":look night",
        ":shadows on",
        ":clip 1,0,0,0",
        ":add z = 0",
        ":delete 1",
        ":time 2",
        ":load-none",
        ":clear",
    ] {
        if line == ":load-none" {
            live.load(DocumentSource::Typed, "x = y", false);
        } else {
            enter(&live, line);
        }
        assert_ne!(Some(&live.request()), said.last(), "{line}");
        said.push(live.request());
    }
    for back in said.iter().rev().skip(1) {
        assert!(live.undo());
        assert_eq!(&live.request(), back);
    }
    assert!(!live.undo());
    for forth in &said[1..] {
        assert!(live.redo());
        assert_eq!(&live.request(), forth);
    }
    assert!(!live.redo());
    enter(&live, ":undo");
    enter(&live, ":redo");
    assert!(live.enter(":redo").expect_err("nothing").to_string().contains("nothing to redo"));
}

#[test]
fn a_drag_is_one_step_and_neither_looks_nor_sizes_are_any() {
    let live = start("domain 2\nr = 1 in [0, 2]\nx^2+y^2+z^2 = r", 16);
    let slider = settled(&live).sliders().remove(0);
    live.hold(true);
    for value in [1.1, 1.2, 1.3] {
        live.drag(&slider, value);
    }
    live.hold(false);
    live.hold(true);
    for _ in 0..3 {
        live.turn(|orbit| orbit.turn(9.0, 3.0, 100));
    }
    live.hold(false);
    live.resize(20, 20);
    live.refresh();
    let turned = live.request().orbit;
    assert!(live.undo() && live.request().orbit.is_none());
    assert!(live.text().contains("r = 1.3 "));
    assert!(live.undo() && live.text().contains("r = 1 "));
    assert!(!live.undo());
    assert!(live.redo() && live.redo());
    assert_eq!(live.request().orbit, turned);
    assert_eq!(live.settings().width, 20);
}

#[test]
fn surfaces_are_listed_and_taken_away_by_number() {
    let live = start("domain 2\nr = 1\nx = r\ny = r\nz = r", 16);
    settled(&live);
    let list = live.enter(":delete").expect("a list");
    assert_eq!(list, Reply::Say("1  x = r\n2  y = r\n3  z = r".to_owned()));
    assert!(live.enter(":delete 4").expect_err("too many").to_string().contains("1 to 3"));
    enter(&live, ":delete 2");
    assert_eq!(live.text(), "domain 2\nr = 1\nx = r\nz = r");
    assert_eq!(settled(&live).document.surfaces.len(), 2);
    enter(&live, ":delete 1");
    assert!(matches!(live.enter(":delete 1"), Ok(Reply::Say(_))));
    assert_eq!(live.text(), "domain 2\nr = 1");
    assert!(live.snapshot().rendering.is_none(), "it is still seen");
    assert!(live.undo());
    assert_eq!(settled(&live).document.surfaces[0].echo, "z = r");
    enter(&live, ":clear");
    assert!(live.text().is_empty() && live.snapshot().rendering.is_none());
    enter(&live, "x^2+y^2+z^2 = 1");
    assert_eq!(settled(&live).document.surfaces.len(), 1);
}

#[test]
fn what_faces_the_eye_is_cut_off_moved_and_given_back() {
    let live = start("domain 2\nx^2+y^2+z^2 = 1\nview eye (6, 0, 0)", 48);
    let whole = settled(&live);
    assert!(live.toggle_cut());
    let plane = |live: &Live| live.request().clip.or(None).expect("a plane");
    let HalfSpace { normal, offset } = plane(&live);
    assert!((normal - DVec3::X).length() < 1e-12 && offset.abs() < 1e-12);
    let cut = settled(&live);
    assert!(cut.picture.rgb != whole.picture.rgb, "the same picture");
    // The front is cut off: no painted point is on the eye's side of the plane.
    let nearest = cut.picture.buffer.drawn.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(nearest >= 6.0 - 1e-6, "{nearest}");
    live.move_cut(5.0);
    assert!((plane(&live).offset - 0.2).abs() < 1e-9, "{:?}", plane(&live));
    settled(&live);
    live.move_cut(-1.0);
    assert!((plane(&live).offset - 0.16).abs() < 1e-9, "{:?}", plane(&live));
    // Several moves of the plane are one undo step.
    assert!(live.undo());
    assert_eq!(plane(&live).offset, offset);
    assert!(!live.toggle_cut() && settled(&live).picture.rgb == whole.picture.rgb);
    enter(&live, ":clip 0, 1,0,0.5");
    assert_eq!(plane(&live), HalfSpace { normal: DVec3::Y, offset: 0.5 });
    let Ok(Reply::Say(said)) = live.enter(":clip") else { panic!("nothing is said") };
    assert_eq!(said, "kept is 0*x + 1*y + 0*z <= 0.5");
    assert!(live.enter(":clip 0,0,0,1").is_err());
    enter(&live, ":clip off");
    assert_eq!(live.request().clip, ClipChoice::Document);
}

#[test]
fn a_plane_of_the_document_is_told_taken_away_and_given_back() {
    let live = start("domain 2\nx^2+y^2+z^2 = 1\nclip 1, 0, 0, 0", 24);
    let kept = || {
        settled(&live);
        let Ok(Reply::Say(said)) = live.enter(":clip") else { panic!("nothing is said") };
        said
    };
    assert_eq!(kept(), "kept is 1*x + 0*y + 0*z <= 0");
    let cut = settled(&live);
    enter(&live, ":clip off");
    assert_eq!(kept(), "nothing is cut away");
    assert!(settled(&live).picture.rgb != cut.picture.rgb, "the same picture");
    assert!(settled(&live).command("a.png", false, zeroset_live::quote).contains(" --clip off"));
    // With a clip plane of the document, toggling the cut removes this plane.
    assert!(live.undo());
    settled(&live);
    assert!(!live.toggle_cut());
    assert_eq!(kept(), "nothing is cut away");
}

#[test]
fn what_replaces_a_surface_of_the_gallery_is_not_seen_through_its_window() {
    let example = zeroset_scene::gallery::example("gyroid").expect("there");
    let text = example.text;
    let live = start("", 16);
    live.load(DocumentSource::Gallery(example), text, false);
    assert!(settled(&live).document.domain.is_some() && !live.is_changed());
    live.type_line("x^2+y^2+z^2 = 400");
    assert!(settled(&live).document.domain.is_none());
    enter(&live, ":set q = 3");
    enter(&live, "x^2+y^2+z^2 = 400");
    assert_eq!(live.text().trim(), "q = 3\nx^2+y^2+z^2 = 400");
    assert!(live.request().source == DocumentSource::Typed && live.is_changed());
    // A value may be entered before the formula that needs it.
    live.load(DocumentSource::Gallery(example), text, false);
    enter(&live, "q = 4");
    enter(&live, "x^2+y^2+z^2 = q");
    assert_eq!(live.text().trim(), "q = 4\nx^2+y^2+z^2 = q");
    // Lines that the user entered stay. The example's lines stay only after `:add`.
    live.load(DocumentSource::Gallery(example), text, false);
    enter(&live, "domain 4");
    enter(&live, "x = y");
    assert_eq!(live.text().trim(), "domain 4\nx = y");
    live.load(DocumentSource::Gallery(example), text, false);
    enter(&live, ":add x = y");
    assert!(live.text().starts_with('#') && live.text().contains("domain"));
}

#[test]
fn a_file_called_like_a_surface_of_the_gallery_stays_that_file() {
    let live = start("", 16);
    let source = DocumentSource::File("gyroid".into());
    live.load(source.clone(), "domain 4\nx = y", false);
    enter(&live, "x = z");
    assert_eq!(live.text().trim(), "domain 4\nx = z");
    assert_eq!(live.request().source, source);
}

#[test]
fn what_was_taken_away_does_not_come_back() {
    let live = start("x^2+y^2+z^2 = 1", 16);
    settled(&live);
    enter(&live, ":clear");
    let Ok(Reply::Say(_)) = live.enter("a = 3") else { panic!("there is something to draw") };
    assert!(live.wait(LIMIT));
    assert!(live.snapshot().rendering.is_none() && live.snapshot().fault.is_none());
    live.type_line("b = ");
    live.type_line("");
    assert!(live.wait(LIMIT) && live.snapshot().rendering.is_none());
    for line in [":undo", ":undo", ":redo"] {
        enter(&live, line);
    }
    assert!(live.text().is_empty());
    assert!(live.enter("axes").is_err() && live.text().is_empty());
}

#[test]
fn a_value_that_a_formula_lacks_completes_it() {
    let live = start("x + q = z", 16);
    assert!(live.wait(LIMIT) && live.snapshot().fault.is_some());
    enter(&live, "q = 1");
    assert_eq!(live.text(), "x + q = z\nq = 1");
    assert_eq!(settled(&live).document.surfaces.len(), 1);
}
