//! Renders a picture from a chosen side, and counts the pixels that are proven.
//!
//! `cargo run --example render [DIRECTORY]` writes `saddle.png`.

use std::path::PathBuf;
use zeroset::{Camera, Error, Scene, Settings};

fn main() -> Result<(), Error> {
    let directory = PathBuf::from(std::env::args().nth(1).unwrap_or(".".to_owned()));
    let scene = Scene::read("color coral\nz = x*y {x^2+y^2 < 4}\ncolor gold\nx^2+y^2+(z-2)^2 = 1")?;
    let settings = Settings::new(640, 480)
        .camera(Camera::new().eye([7.0, -8.0, 5.0]).target([0.0, 0.0, 0.5]).fov(35.0))
        .look("studio".parse()?)
        .shadows(true);
    let picture = scene.render(&settings)?;
    picture.save(directory.join("saddle.png"))?;

    println!("{:?}", picture.counts());
    for (reason, count) in picture.undecided() {
        println!("{count} undecided: {reason}");
    }
    let drawn = picture.depth().iter().filter(|depth| depth.is_finite());
    let nearest = drawn.fold(f64::INFINITY, |nearest, depth| nearest.min(*depth));
    println!("the nearest point is {nearest:.3} away");
    Ok(())
}
