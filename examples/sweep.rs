//! Moves a parameter, and renders a picture for each of its values.
//!
//! `cargo run --example sweep [DIRECTORY]` writes `frame-0.png` to `frame-7.png`.

use std::path::PathBuf;
use zeroset::{Camera, Error, Scene, Settings};

/// Number of pictures.
const FRAMES: usize = 8;

fn main() -> Result<(), Error> {
    let directory = PathBuf::from(std::env::args().nth(1).unwrap_or(".".to_owned()));
    // The code is compiled once, for the whole range of `k`.
    let mut scene = Scene::read("k = 1 in [0.5, 2.5]\n(x^2+y^2+z^2-k)^2 = x^4+y^4+z^4 - 0.2")?;
    // All pictures have the same domain and camera, so that nothing jumps.
    let settings = Settings::new(320, 240)
        .domain([-2.0..=2.0, -2.0..=2.0, -2.0..=2.0])
        .camera(Camera::new().eye([5.0, -6.0, 4.0]).target([0.0, 0.0, 0.0]));
    for frame in 0..FRAMES {
        let k = 0.5 + 2.0 * frame as f64 / (FRAMES - 1) as f64;
        scene.set("k", k)?;
        let picture = scene.render(&settings)?;
        picture.save(directory.join(format!("frame-{frame}.png")))?;
        println!("k = {k:.3}: {} hits", picture.counts().hit);
    }
    Ok(())
}
