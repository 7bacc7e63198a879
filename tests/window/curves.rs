//! Curves in the window.

use crate::scene::Scene;
use image::RgbImage;

const TEXT: &str =
    "color lightgray\nx^2+y^2+z^2=1\ncolor red\n(1.3cos t, 1.3sin t, t/8) for t in [-8, 8]";

fn red(picture: &RgbImage) -> usize {
    let is_red = |[red, green, blue]: [u8; 3]| red > 120 && green < 90 && blue < 90;
    picture.pixels().filter(|pixel| is_red(pixel.0)).count()
}

pub fn curves_are_there_while_the_view_turns() {
    let scene = Scene::start(&[TEXT, "--size", "400x320"]);
    assert!(red(&scene.rest()) > 300);
    let turned = scene.changes("turning", || scene.key("Right"));
    assert!(red(&turned) > 300);
    // Without axes, the picture is fitted to the surface and the curve.
    assert!(red(&scene.changes("no axes", || scene.key("F3"))) > 300);
}
