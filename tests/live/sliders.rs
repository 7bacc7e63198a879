//! Dragging a value, or running time, changes only the text and compiles nothing.

use super::live_support::{LIMIT, settled, start};
use zeroset_live::{DocumentSource, Live, Rendering, Request, Slider};
use zeroset_render::picture::Settings;

/// The slider of this name in the final picture.
fn slider(live: &Live, name: &str) -> Slider {
    let all = settled(live).sliders();
    all.into_iter().find(|one| one.name == name).unwrap_or_else(|| panic!("no slider {name}"))
}

fn drag(live: &Live, name: &str, value: f64) {
    let slider = slider(live, name);
    live.drag(&slider, value);
}

/// Number of kernels compiled so far for a picture's program.
fn made(seen: &Rendering) -> usize {
    seen.model.program().made().len()
}

/// Number of single-precision kernels compiled so far for a picture's program.
fn singles(seen: &Rendering) -> usize {
    let made = seen.model.program().made();
    made.iter().filter(|one| format!("{one:?}").contains("F32")).count()
}

#[test]
fn dragging_changes_the_picture_and_the_text_and_makes_no_kernel() {
    let live = start("domain 4\nr = 1 in [0, 3]\nx^2+y^2+z^2 = r^2", 32);
    let first = settled(&live);
    let kernels = made(&first);
    for value in [1.25, 2.0, 0.5, 3.0] {
        let before = settled(&live);
        drag(&live, "r", value);
        let after = settled(&live);
        assert!(after.picture.rgb != before.picture.rgb, "{value}");
        assert!(after.model.is_rebound() && made(&after) == kernels, "{value}: code was made");
        assert_eq!(live.text(), format!("domain 4\nr = {value} in [0, 3]\nx^2+y^2+z^2 = r^2"));
        assert_eq!(slider(&live, "r").value, value);
    }
    assert!(live.restore(&slider(&live, "r")));
    assert_eq!(live.text(), "domain 4\nr = 1 in [0, 3]\nx^2+y^2+z^2 = r^2");
    assert!(settled(&live).picture.rgb == first.picture.rgb);
}

#[test]
fn a_value_without_a_range_gets_one_when_it_is_dragged_and_then_needs_no_code() {
    let live = start("domain 4\nr = 2\nx^2+y^2+z^2 = r^2", 32);
    let one = slider(&live, "r");
    assert_eq!((one.low, one.value, one.high), (0.0, 2.0, 4.0));
    drag(&live, "r", 2.5);
    assert_eq!(live.text(), "domain 4\nr = 2.5 in [0, 4]\nx^2+y^2+z^2 = r^2");
    let kernels = made(&settled(&live));
    drag(&live, "r", 3.5);
    let after = settled(&live);
    assert!(after.model.is_rebound() && made(&after) == kernels);
    assert!(live.restore(&slider(&live, "r")));
    assert_eq!(live.text(), "domain 4\nr = 2 in [0, 4]\nx^2+y^2+z^2 = r^2");
}

#[test]
fn a_dragged_value_takes_the_place_of_one_from_the_command_line() {
    let settings = Settings { width: 24, height: 24, ..Settings::default() };
    let text = "domain 2\nr = 1 in [0, 2]\nx^2+y^2 = r + q + t".into();
    let overrides = [("r", "1.5"), ("q", "0.25")].map(|(a, b)| (a.to_owned(), b.to_owned()));
    let overrides = overrides.to_vec();
    let live =
        Live::new(Request { text, overrides, settings, time: Some(0.5), ..Request::default() });
    for (name, was, value) in [("r", 1.5, 1.75), ("q", 0.25, 0.5), ("t", 0.5, 0.75)] {
        assert_eq!(slider(&live, name).value, was);
        drag(&live, name, value);
        assert_eq!(slider(&live, name).value, value);
    }
    live.type_line("x = q");
    assert_eq!(settled(&live).document.surfaces[0].echo, "x = q");
    live.type_line("");
    let Request { overrides, time, .. } = live.request();
    assert!(overrides.is_empty() && time.is_none());
    let added = "q = 0.5 in [0, 0.5]\nt = 0.75 in [0, 2pi]";
    assert_eq!(live.text(), format!("domain 2\nr = 1.75 in [0, 2]\nx^2+y^2 = r + q + t\n{added}"));
    for (name, was) in [("r", 1.5), ("q", 0.25), ("t", 0.5)] {
        assert!(live.restore(&slider(&live, name)));
        assert_eq!(slider(&live, name).value, was);
    }
}

#[test]
fn a_reload_keeps_a_dragged_value_unless_the_file_gives_it_another() {
    let live = start("domain 2\nr = 1 in [0, 2]\ns = 1\nx^2+y^2 = r+s", 16);
    drag(&live, "r", 0.5);
    drag(&live, "s", 1.5);
    live.load(DocumentSource::Typed, "domain 2\nr = 1 in [0, 2]\ns = 1\nx^2+z^2 = r+s", true);
    let kept = "domain 2\nr = 0.5 in [0, 2]\ns = 1.5 in [0, 2]\nx^2+z^2 = r+s";
    assert_eq!(live.text(), kept);
    live.load(DocumentSource::Typed, "domain 2\nr = 1.25 in [0, 2]\ns = 1\nx^2+z^2 = r+s", true);
    let given = "domain 2\nr = 1.25 in [0, 2]\ns = 1.5 in [0, 2]\nx^2+z^2 = r+s";
    assert_eq!(live.text(), given);
    settled(&live);
    assert!(!live.restore(&slider(&live, "r")) && live.restore(&slider(&live, "s")));
    // A value that is set or loaded becomes the document's own, to which a reset returns.
    drag(&live, "r", 1.5);
    live.enter(":set r = 0.75").expect("valid");
    assert!(!live.restore(&slider(&live, "r")));
    live.load(DocumentSource::Typed, "domain 2\nr = 1 in [0, 2]\nx = r", false);
    assert_eq!(live.text(), "domain 2\nr = 1 in [0, 2]\nx = r");
}

#[test]
fn whatever_is_said_last_of_a_value_counts() {
    let live = start("domain 2\nt = 3 in [0, 10]\nr = 2 in [0, 5]\nx^2+y^2 = r + sin(t)", 16);
    let value = |name: &str| {
        let Slider { value, low, high, .. } = slider(&live, name);
        (value, low, high)
    };
    for (line, expected) in [
        (":time 4", (4.0, 0.0, 10.0)),
        ("t = 0.5", (0.5, 0.0, 10.0)),
        (":time 20", (20.0, 0.0, 20.0)),
        (":set t = -1", (-1.0, -1.0, 20.0)),
    ] {
        live.enter(line).expect(line);
        assert_eq!(value("t"), expected, "{line}");
    }
    for (line, expected) in [(":set r = 9", (9.0, 0.0, 9.0)), ("r = 1", (1.0, 0.0, 9.0))] {
        live.enter(line).expect(line);
        assert_eq!(value("r"), expected, "{line}");
    }
    assert!(live.text().contains("t = -1 in [-1, 20]\nr = 1 in [0, 9]"), "{}", live.text());
}

#[test]
fn values_of_sliders_are_no_typed_work() {
    let live = start("domain 2\nr = 1\nx^2+y^2 = r + sin(t)", 16);
    assert_eq!(live.typed_lines(), None);
    for name in ["r", "t"] {
        drag(&live, name, 1.5);
        assert!(live.is_changed());
        assert_eq!(live.typed_lines(), None, "{name}");
    }
    assert_eq!(live.text().lines().count(), 4, "{}", live.text());
    // A line that dragging added does not count beside typed ones.
    live.enter(":add z = 1").expect("valid");
    assert_eq!(live.typed_lines(), Some(4), "{}", live.text());
    live.undo();
    live.enter("r = 0.5").expect("valid");
    assert_eq!(live.typed_lines(), Some(3));
}

#[test]
fn the_time_has_a_slider_where_it_is_drawn_only() {
    let names = |text: &str| {
        let all = settled(&start(text, 16)).sliders();
        all.into_iter().map(|one| one.name).collect::<Vec<_>>()
    };
    assert_eq!(names("domain 2\na = 1; b = 2 in [0, 3]\nx = a + t"), ["a", "b", "t"]);
    assert_eq!(names("domain 2\nt = 1 in [0, 3]\nx = y"), Vec::<String>::new());
    assert_eq!(names("domain 2\nx = y"), Vec::<String>::new());
}

/// Time runs through its loop with one compilation, and leaves no steps to undo.
#[test]
fn time_passes_without_code_and_without_steps() {
    let live = start("domain 3\nx^2+y^2+z^2 = 2 + sin(t)", 24);
    let time = slider(&live, "t");
    assert_eq!((time.low, time.high), (0.0, std::f64::consts::TAU));
    live.drag(&time, 0.0);
    let kernels = made(&settled(&live));
    let start = live.text();
    for frame in 1..40 {
        live.pass(&time, f64::from(frame) * 0.15);
        let seen = settled(&live);
        assert!(seen.model.is_rebound() && made(&seen) == kernels, "frame {frame}");
    }
    assert!(live.text().ends_with("t = 5.85 in [0, 2pi]"), "{}", live.text());
    assert!(start.ends_with("t = 0 in [0, 2pi]"));
    // A turn of the view while time passes is an undo step, but the passing of time is not.
    live.hold(true);
    for frame in 1..4 {
        live.turn(|orbit| orbit.turn(3.0, 0.0, 100));
        live.pass(&time, f64::from(frame) * 0.2);
    }
    live.hold(false);
    assert!(live.undo() && live.request().orbit.is_none());
    assert!(live.text().ends_with("t = 5.85 in [0, 2pi]"), "{}", live.text());
    assert!(live.undo() && !live.undo());
    assert_eq!(live.text(), "domain 3\nx^2+y^2+z^2 = 2 + sin(t)");
}

/// An unentered line stays while a value is dragged.
#[test]
fn a_line_that_is_typed_stays_while_a_value_is_dragged() {
    let live = start("domain 2\nr = 1 in [0, 2]\nx = r", 16);
    settled(&live);
    live.type_line("x^2 + y^2 = r");
    drag(&live, "r", 0.5);
    let seen = settled(&live);
    assert_eq!(seen.document.surfaces[0].echo, "x^2 + y^2 = r");
    assert_eq!(slider(&live, "r").value, 0.5);
    assert_eq!(live.text(), "domain 2\nr = 0.5 in [0, 2]\nx = r");
}

#[test]
fn a_letter_that_lacks_a_value_is_named() {
    let live = start("x^2+y^2+z^2 = 1", 16);
    settled(&live);
    for (line, letter) in [
        ("x^2+y^2 = r", Some('r')),
        ("x^2+a*y^2 = a^2", Some('a')),
        ("x^2+y^2 = foo", None),
        ("x^2+y^2 = a + b", Some('a')),
        ("x^2+y^2 = r + (", None),
    ] {
        live.type_line(line);
        assert!(live.wait(LIMIT));
        let fault = live.snapshot().fault.unwrap_or_else(|| panic!("{line} is read"));
        assert_eq!(fault.missing_letter(), letter, "{line}: {}", fault.message());
        let refusal = live.enter(line).expect_err(line);
        assert_eq!(refusal.missing_letter(), letter, "{line}");
    }
    // An error in a typed line must not name the file, since the file has no error.
    live.type_line("x^2+y^2 = r");
    assert!(live.wait(LIMIT));
    let said = live.snapshot().fault.expect("wrong").render(false);
    assert!(said.contains("formula:") && !said.contains("test:"), "{said}");
}

/// However many values are dragged, the text's length and the number of kernels stay the same.
#[test]
fn thousands_of_values_leave_nothing_behind() {
    let live = start("domain 4\nr = 1 in [0, 3]\nx^2+y^2+z^2 = r^2", 16);
    let slider = slider(&live, "r");
    let kernels = singles(&settled(&live));
    let started = std::time::Instant::now();
    live.hold(true);
    for number in 1..=2000 {
        live.drag(&slider, slider.rounded(f64::from(number) * 0.0015, 0.0015));
    }
    live.hold(false);
    println!("a value takes {:?}", started.elapsed() / 2000);
    let seen = settled(&live);
    assert!(seen.model.is_rebound(), "it was compiled again");
    // Only single-precision kernels count: a small sphere may need further kernels in doubles.
    assert_eq!(singles(&seen), kernels);
    assert_eq!(live.text(), "domain 4\nr = 3 in [0, 3]\nx^2+y^2+z^2 = r^2");
    assert!(live.undo() && !live.undo());
    assert_eq!(live.text(), "domain 4\nr = 1 in [0, 3]\nx^2+y^2+z^2 = r^2");
}

/// A slider accepts any float, and the value stays within its range.
#[test]
fn a_drag_beyond_everything_stays_within_the_range() {
    let live = start("domain 4\nr = 1 in [0.5, 3]\nx^2+y^2+z^2 = r^2", 16);
    let slider = slider(&live, "r");
    for (value, expected) in [(f64::NAN, "1"), (f64::INFINITY, "3"), (-9.0, "0.5")] {
        live.drag(&slider, value);
        settled(&live);
        assert!(live.text().contains(&format!("r = {expected} in")), "{value}: {}", live.text());
    }
}

#[test]
fn a_value_from_beyond_its_range_is_dragged_there_too() {
    let settings = Settings { width: 16, height: 16, ..Settings::default() };
    let text = "domain 4\nr = 1 in [0, 2]\nx^2+y^2+z^2 = r^2".into();
    let overrides = vec![("r".to_owned(), "3".to_owned())];
    let live = Live::new(Request { text, overrides, settings, ..Request::default() });
    for (value, expected) in [(2.5, "r = 2.5 in [0, 2.5]"), (1.5, "r = 1.5 in [0, 2.5]")] {
        drag(&live, "r", value);
        settled(&live);
        assert!(live.text().contains(expected), "{}", live.text());
    }
    assert!(live.restore(&slider(&live, "r")));
    assert_eq!(slider(&live, "r").value, 3.0);
}

#[test]
fn a_view_that_was_turned_stays_while_a_surface_outgrows_its_domain() {
    let live = start("r = 1 in [0.2, 5]; x^2+y^2+z^2 = r^2", 48);
    settled(&live);
    live.turn(|orbit| orbit.turn(10.0, 5.0, 48));
    let before = settled(&live);
    let slider = before.sliders().remove(0);
    live.drag(&slider, 4.0);
    let grown = settled(&live);
    assert!(grown.model.region().half_extent() > 2.0 * before.model.region().half_extent());
    assert_eq!(grown.camera, before.camera);
    // On request the camera shows the whole region. Later drags leave it there.
    live.fit();
    let far = settled(&live).camera;
    assert!((far.eye() - far.target()).length() > 8.0, "{far:?}");
    live.drag(&slider, 0.5);
    assert_eq!(settled(&live).camera, far);
}
