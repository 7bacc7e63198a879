//! The list of surfaces in a real window, by mouse and by keys, and the axes.

use crate::scene::Scene;
use crate::terminal_support::until;
use image::RgbImage;

const TWO: &[&str] =
    &["domain 2\ncolor red\nx^2+y^2+z^2 = 1\ncolor blue\nz = 1.2", "--size", "400x320"];

/// Columns of the parts of a row in the list, and two rows.
const SWATCH: i32 = 194;
const FORMULA: i32 = 250;
const TRACK: (i32, i32) = (334, 374);
const DELETE: i32 = 386;
const ROWS: [i32; 2] = [16, 36];

fn click(scene: &Scene, x: i32, y: i32) {
    scene.point(x, y);
    scene.display.tool(&["click", "1"]);
    // Move the pointer away, since a row is brighter under it.
    scene.point(30, 250);
}

/// Number of reddish pixels, and number of bluish pixels.
fn colored(picture: &RgbImage) -> [usize; 2] {
    let picture = image::imageops::crop_imm(picture, 0, 90, 400, 160).to_image();
    let count = |one: usize, other: usize| {
        picture
            .pixels()
            .filter(|pixel| i32::from(pixel.0[one]) - i32::from(pixel.0[other]) > 80)
            .count()
    };
    [count(0, 2), count(2, 0)]
}

fn listed(scene: &mut Scene, expected: &str) {
    scene.terminal.type_in(":list\r");
    scene.terminal.shows(expected);
}

pub fn a_surface_is_colored_in_the_list_and_an_added_one_has_the_usual_color() {
    let mut scene = Scene::start(TWO);
    scene.point(SWATCH, ROWS[1]);
    scene.turn();
    scene.press("3");
    scene.turn();
    scene.type_text("red");
    scene.changes("red", || scene.key("Return"));
    scene.point(30, 250);
    scene.rest();
    assert_eq!(colored(&scene.picture())[1], 0, "some of it is still blue");
    listed(&mut scene, "color red\r\nx^2+y^2+z^2 = 1\r\nz = 1.2");
    scene.type_text("x = 0");
    scene.changes("added", || scene.key("ctrl+Return"));
    listed(&mut scene, "z = 1.2\r\ncolor auto\r\nx = 0");
    scene.terminal.type_in(":quit\r");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn surfaces_are_hidden_seen_through_moved_and_taken_away() {
    let mut scene = Scene::start(TWO);
    scene.point(30, 250);
    let start = scene.rest();
    let seen = colored(&scene.picture());
    assert!(seen[0] > 500 && seen[1] > 500, "{seen:?}");
    let hidden = scene.changes("hidden", || click(&scene, SWATCH, ROWS[1]));
    assert_eq!(colored(&scene.picture())[1], 0, "it is still there");
    listed(&mut scene, "hidden\r\nz = 1.2");
    scene.terminal.type_in(":status\r");
    scene.terminal.shows("not compiled again");
    assert!(scene.changes("shown", || click(&scene, SWATCH, ROWS[1])) == start);
    // Ctrl-2 hides the second surface, like a click on its swatch. Undo shows it again.
    assert!(scene.changes("by key", || scene.key("ctrl+2")) == hidden);
    assert!(scene.changes("undo hiding", || scene.key("ctrl+z")) == start);
    // Drag to the middle of the track. The drag is one undo step.
    scene.changes("half", || {
        scene.drag("1", (TRACK.1, ROWS[1]), (i32::midpoint(TRACK.0, TRACK.1), ROWS[1]));
        scene.point(30, 250);
    });
    listed(&mut scene, "opacity 50%\r\nz = 1.2");
    assert!(scene.changes("undo opacity", || scene.key("ctrl+z")) == start);
    scene.changes("arrow opacity", || {
        scene.point(FORMULA, ROWS[1]);
        scene.turn();
        scene.key("Left");
    });
    listed(&mut scene, "opacity 95%\r\nz = 1.2");
    scene.point(30, 250);
    assert!(scene.changes("undo arrow", || scene.key("ctrl+z")) == start);
    scene.changes("moved", || {
        scene.drag("1", (FORMULA, ROWS[0]), (FORMULA, ROWS[1]));
        scene.point(30, 250);
    });
    listed(&mut scene, "z = 1.2\r\ncolor red\r\nx^2+y^2+z^2 = 1");
    // The surfaces keep their colors when their lines change places.
    assert_eq!(colored(&scene.picture()), seen);
    assert!(scene.changes("undo move", || scene.key("ctrl+z")) == start);
    scene.changes("deleted", || click(&scene, DELETE, ROWS[0]));
    assert_eq!(colored(&scene.picture())[0], 0);
    assert!(scene.changes("undo deletion", || scene.key("ctrl+z")) == start);
    // Without the list, a drag at the same place turns the view.
    let without = scene.changes("no list", || scene.key("F4"));
    scene.changes("turned", || scene.drag("1", (FORMULA, ROWS[0]), (FORMULA + 40, ROWS[0])));
    scene.point(30, 250);
    assert!(scene.changes("reset", || scene.key("ctrl+0")) == without);
    assert!(scene.changes("list", || scene.key("F4")) == start);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// The second row of the list is a curve's.
pub fn a_curve_is_hidden_and_shown_by_a_click() {
    let text = "domain 2\nx^2+y^2+z^2 = 1\n(1.5 cos(t), 1.5 sin(t), 0) for t in [0, 2pi]";
    let mut scene = Scene::start(&[text, "--size", "400x320"]);
    scene.point(30, 250);
    let start = scene.rest();
    scene.changes("hidden curve", || click(&scene, SWATCH, ROWS[1]));
    listed(&mut scene, "hidden\r\n(1.5 cos(t), 1.5 sin(t), 0) for t in [0, 2pi]");
    assert!(scene.changes("shown curve", || click(&scene, SWATCH, ROWS[1])) == start);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

/// The first formula is edited, and one more is added, by clicks on the list.
pub fn formulas_are_edited_and_added_in_the_list() {
    let mut scene = Scene::start(TWO);
    click(&scene, FORMULA, ROWS[0]);
    scene.display.keep(&scene.window, "editing");
    scene.changes("larger", || scene.type_text("+x^2"));
    scene.key("Return");
    scene.rest();
    listed(&mut scene, "color red\r\nx^2+y^2+z^2 = 1+x^2\r\ncolor blue\r\nz = 1.2");
    click(&scene, FORMULA, ROWS[1] + 20);
    scene.type_text("z = -1");
    scene.key("Return");
    scene.rest();
    listed(&mut scene, "z = 1.2\r\ncolor auto\r\nz = -1");
    // Ctrl-Enter adds, too. Enter replaces all, and undo brings them back.
    scene.type_text("y = 1");
    scene.key("ctrl+Return");
    scene.rest();
    listed(&mut scene, "z = -1\r\ny = 1");
    scene.display.keep(&scene.window, "four");
    scene.type_text("x = 1");
    scene.key("Return");
    scene.rest();
    scene.key("ctrl+z");
    scene.rest();
    scene.quits_after_a_question();
    let kept = scene.terminal.place().join("data/zeroset/last.zset");
    until("the window has ended", || {
        std::fs::read_to_string(&kept).is_ok_and(|text| text.contains("y = 1"))
    });
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn axes_are_there_unless_somebody_wants_none() {
    let mut scene = Scene::start(&["domain 2\nx^2+y^2+z^2 = 1", "--size", "400x320"]);
    scene.point(30, 250);
    // Below the list only lines and letters are dark.
    let dark = |picture: &RgbImage| {
        let below = image::imageops::crop_imm(picture, 0, 40, 400, 180).to_image();
        below.pixels().filter(|pixel| pixel.0.iter().all(|c| (30..120).contains(c))).count()
    };
    let start = scene.rest();
    assert!(dark(&start) > 300, "{}", dark(&start));
    let without = scene.changes("without axes", || scene.key("F3"));
    assert!(8 * dark(&without) < dark(&start), "{} of {}", dark(&without), dark(&start));
    assert!(scene.changes("with axes", || scene.key("F3")) == start);
    scene.terminal.type_in("axes off\r");
    until("there are none", || scene.middle() == without);
    assert!(scene.changes("axes all the same", || scene.key("F3")) == start);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}
