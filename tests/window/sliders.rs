//! Sliders, time, undo, cuts and short clicks in a real window.

use crate::scene::{CUBE, Scene};
use crate::terminal_support::until;

const BALL: &[&str] =
    &["domain 3\nr = 1 in [0, 2]\nx^2+y^2+z^2 = r^2 + 0.3*sin(5*t)", "--size", "640x320"];

/// Columns at the ends of the first slider's track, and rows of the first two sliders.
const TRACK: (i32, i32) = (30, 190);
/// Columns of the first slider's button and of its number.
const PLAY: i32 = 7;
const NUMBER: i32 = 215;
const ROWS: [i32; 2] = [16, 36];

/// Asserts that `:list` shows `expected` in the terminal.
fn listed(scene: &mut Scene, expected: &str) {
    scene.terminal.type_in(":list\r");
    scene.terminal.shows(expected);
}

pub fn a_slider_that_is_dragged_changes_picture_and_document_and_is_taken_back() {
    let mut scene = Scene::start(BALL);
    let start = scene.rest();
    let middle = i32::midpoint(TRACK.0, TRACK.1);
    scene.changes("slider", || {
        scene.drag("1", (middle, ROWS[0]), (middle + 40, ROWS[0]));
    });
    // Move the pointer away, since a slider is brighter under it.
    scene.point(300, 250);
    let dragged = scene.rest();
    listed(&mut scene, "r = 1.5 in [0, 2]");
    scene.terminal.type_in(":status\r");
    scene.terminal.shows("not compiled again");
    // The drag is one undo step. It did not turn the view.
    assert!(scene.changes("undo", || scene.key("ctrl+z")) == start, "not as at the start");
    listed(&mut scene, "r = 1 in [0, 2]");
    assert!(scene.changes("redo", || scene.key("ctrl+y")) == dragged, "not as it was dragged");
    // A double click resets the value.
    scene.point(middle + 40, ROWS[0]);
    scene.turn();
    scene.changes("double click", || {
        // Time is what makes a double click, so one call of xdotool waits between the presses.
        scene.display.tool(&["click", "--repeat", "2", "--delay", "100", "1"]);
    });
    scene.point(300, 250);
    assert!(scene.rest() == start, "not as at the start");
    // While the pointer is over the slider, an arrow key moves it by a hundredth of the range.
    scene.changes("arrow", || {
        scene.point(middle, ROWS[0]);
        scene.turn();
        scene.key("Right");
    });
    listed(&mut scene, "r = 1.02 in [0, 2]");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn a_slider_that_is_held_while_the_gallery_opens_is_let_go() {
    let mut scene = Scene::start(BALL);
    let middle = i32::midpoint(TRACK.0, TRACK.1);
    scene.point(middle, ROWS[0]);
    scene.turn();
    let start = scene.rest();
    scene.display.tool(&["mousedown", "1"]);
    scene.turn();
    scene.key("ctrl+o");
    until("the gallery is open", || scene.middle() != start);
    scene.display.tool(&["mouseup", "1"]);
    scene.turn();
    scene.key("Escape");
    until("the gallery is closed", || scene.middle() == start);
    // Away from the slider, an arrow key turns the view.
    scene.point(300, 250);
    scene.changes("turned", || scene.key("Right"));
    listed(&mut scene, "r = 1 in [0, 2]");
    assert!(!scene.terminal.shown().contains("r = 1.02"), "the slider was moved");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// While a slider is dragged, the surface grows in the view. Then the view fits it again.
pub fn a_surface_that_outgrows_the_view_is_fitted_when_the_slider_is_let_go() {
    let ball = ["r = 1 in [0.5, 8]\nx^2+y^2+z^2 = r^2", "--size", "640x320"];
    let scene = Scene::start(&ball);
    // Number of columns with orange pixels below the slider.
    let width = || {
        let picture = scene.picture();
        let is_orange = |x: u32, y: u32| {
            let [r, _, b] = picture.get_pixel(x, y).0.map(i32::from);
            r - b > 60
        };
        (0..640).filter(|x| (60..270).any(|y| is_orange(*x, y))).count()
    };
    let before = width();
    scene.point(TRACK.0 + 11, ROWS[0]);
    scene.display.tool(&["mousedown", "1"]);
    for x in [40, 50, 60, 75, 90] {
        scene.point(TRACK.0 + x, ROWS[0]);
        scene.turn();
    }
    until("it outgrows the view", || width() > 2 * before);
    scene.display.keep(&scene.window, "outgrown");
    scene.display.tool(&["mouseup", "1"]);
    // The fitted surface may look smaller than before, since the domain has spare room.
    let fits = |width: usize| 2 * width > before && width <= before;
    until("it is fitted", || fits(width()));
    scene.rest();
    assert!(fits(width()), "{} columns, and {before} before", width());
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn time_is_played_paused_and_scrubbed() {
    let mut scene = Scene::start(BALL);
    let start = scene.rest();
    scene.key("F5");
    let mut last = scene.middle();
    for _ in 0..3 {
        until("time goes on", || scene.middle() != last);
        last = scene.middle();
    }
    scene.key("F5");
    let paused = scene.rest();
    assert!(paused != start, "time stands still");
    listed(&mut scene, " in [0, 2pi]");
    assert!(scene.changes("back to the start", || scene.key("ctrl+z")) == start);
    scene.changes("scrubbing", || {
        scene.drag("1", (TRACK.0, ROWS[1]), (TRACK.0 + 20, ROWS[1]));
    });
    listed(&mut scene, "t = 0.79 in [0, 2pi]");
    // Values of sliders are no typed work.
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn a_value_runs_by_its_button_and_its_range_is_edited_in_place() {
    let mut scene = Scene::start(BALL);
    let click = |scene: &Scene, x: i32| {
        scene.point(x, ROWS[0]);
        scene.turn();
        scene.press("1");
    };
    click(&scene, PLAY);
    let mut last = scene.middle();
    for _ in 0..3 {
        until("the ball grows", || scene.middle() != last);
        last = scene.middle();
    }
    click(&scene, PLAY);
    let stopped = scene.rest();
    assert!(scene.still() == stopped, "it runs on");
    scene.key("ctrl+z");
    scene.rest();
    listed(&mut scene, "r = 1 in [0, 2]");
    // The definition opens in the line, with the cursor at its end.
    click(&scene, NUMBER);
    scene.turn();
    scene.key("BackSpace");
    scene.key("BackSpace");
    scene.type_text("5]");
    scene.key("Return");
    scene.rest();
    listed(&mut scene, "r = 1 in [0, 5]");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn what_faces_the_eye_is_cut_open_and_the_cut_is_moved() {
    let scene = Scene::start(CUBE);
    let whole = scene.rest();
    let cut = scene.changes("cut", || scene.key("F7"));
    let moved = scene.changes("moved cut", || {
        scene.display.tool(&["keydown", "ctrl", "click", "5", "click", "5", "keyup", "ctrl"]);
    });
    assert!(whole != cut && cut != moved);
    assert!(scene.changes("whole again", || scene.key("F7")) == whole);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// `xdotool` presses the button for some microseconds.
pub fn clicks_however_short_are_seen_and_each_once() {
    let scene = Scene::start(CUBE);
    let said = || scene.terminal.shown().matches("| zeroset eval").count();
    for number in 1..=10 {
        scene.display.tool(&["click", "1"]);
        until("the click is seen", || said() >= number);
        scene.turn();
    }
    // A click as long as that of a finger counts once, too.
    scene.press("1");
    until("the long click is seen", || said() >= 11);
    scene.turn();
    assert_eq!(said(), 11);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn what_is_typed_in_the_window_prints_nothing_in_the_terminal() {
    let mut scene = Scene::start(CUBE);
    let before = scene.terminal.shown();
    for part in ["x^2+", "y^2 = (", "q*z", ")"] {
        scene.display.tool(&["type", "--delay", "30", part]);
        until("the fault is marked", || scene.is_faulty());
        // The prompt finds the fault, too, and leaves it to the window.
        let polls = || scene.terminal.pulse().map_or(u64::MAX, |pulse| pulse.reporter);
        let before = polls();
        until("the prompt looks for faults", || polls() >= before.saturating_add(2));
    }
    assert_eq!(scene.terminal.shown(), before);
    // F2 gives a value to `q`, which lacks one.
    scene.changes("a value for q", || scene.key("F2"));
    scene.key("Return");
    scene.rest();
    listed(&mut scene, "q = 1");
    let shown = scene.terminal.shown();
    assert!(!shown.contains("error") && !shown.contains("never used"), "{shown}");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn the_title_names_the_document_and_whether_it_was_changed() {
    let mut scene = Scene::start(CUBE);
    let title = |scene: &Scene| scene.display.tool(&["getwindowname", &scene.window]);
    assert_eq!(title(&scene), "formula - zeroset");
    scene.terminal.type_in(":load gyroid\r");
    until("it has another title", || title(&scene) == "gyroid - zeroset");
    scene.terminal.type_in("domain 4\r");
    until("it was changed", || title(&scene) == "gyroid* - zeroset");
    scene.terminal.type_in(":save mine.zset\r");
    until("it is a file", || title(&scene) == "mine.zset - zeroset");
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}
