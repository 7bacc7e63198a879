//! The gallery in a real window.

use crate::scene::{CUBE, Scene};
use crate::terminal_support::until;

/// Whether the gallery is open and shows its second picture.
fn has_pictures(scene: &Scene) -> bool {
    scene.picture().get_pixel(3, 150).0 == [0x18, 0x18, 0x20] && colors(scene, SECOND) > 50
}

/// Number of colors in a part of the window.
fn colors(scene: &Scene, [x, y, width, height]: [u32; 4]) -> usize {
    let picture = scene.picture();
    let part = image::imageops::crop_imm(&picture, x, y, width, height).to_image();
    let mut all: Vec<_> = part.pixels().map(|pixel| pixel.0).collect();
    all.sort_unstable();
    all.dedup();
    all.len()
}

/// Place of the second picture, in a window 400 pixels wide. Pictures are 96 pixels wide, and gaps
/// are 8 pixels wide.
const SECOND: [u32; 4] = [152, 28, 96, 96];

pub fn a_surface_is_chosen_by_its_picture() {
    let mut scene = Scene::start(CUBE);
    scene.point(5, 200);
    let start = scene.rest();
    let threads = scene.terminal.threads();
    let title = |scene: &Scene| scene.display.tool(&["getwindowname", &scene.window]);
    scene.key("ctrl+o");
    until("there are pictures", || has_pictures(&scene));
    scene.display.keep(&scene.window, "gallery");
    scene.key("Escape");
    until("it is closed", || scene.middle() == start);
    until("nothing is made any more", || scene.terminal.threads() == threads);
    // The gallery keeps finished pictures.
    scene.key("ctrl+o");
    until("they are there again", || has_pictures(&scene));
    // Choose by typing a name.
    scene.display.tool(&["type", "--delay", "30", "heart"]);
    scene.key("Return");
    until("the heart is there", || title(&scene) == "heart-taubin - zeroset");
    scene.rest();
    // Open the gallery from the prompt, and choose by arrow keys.
    scene.terminal.type_in(":gallery\r");
    until("it is open", || has_pictures(&scene));
    scene.key("Right");
    scene.key("Return");
    until("another is there", || title(&scene) == "barth-decic - zeroset");
    scene.rest();
    // Choose by the mouse; the click does not reach the view.
    scene.key("ctrl+o");
    until("it is open once more", || has_pictures(&scene));
    scene.point(60, 200);
    let known = scene.terminal.shown().matches("| zeroset eval").count();
    scene.press("1");
    let shown = |scene: &Scene| title(scene);
    until("a third is there", || !shown(&scene).starts_with("barth-decic"));
    scene.rest();
    assert_eq!(scene.terminal.shown().matches("| zeroset eval").count(), known);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}

pub fn help_is_read_in_the_window() {
    let scene = Scene::start(CUBE);
    let start = scene.rest();
    let keys = scene.changes("keys", || scene.key("F1"));
    let words = scene.changes("words", || scene.key("F1"));
    assert!(keys != words);
    let below = scene.changes("words below", || scene.key("Down"));
    assert!(scene.changes("words again", || scene.key("Up")) == words && below != words);
    assert!(scene.changes("closed", || scene.key("F1")) == start);
    scene.changes("coming", || {
        scene.display.tool(&["type", "--delay", "30", ":help coming"]);
        scene.key("Return");
    });
    scene.terminal.shows("Mathematica");
    assert!(scene.changes("read", || scene.key("Escape")) == start);
    scene.key("ctrl+q");
    assert_eq!(scene.terminal.ends(), 0);
}
