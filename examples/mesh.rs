//! Makes triangles of a solid, and says what is proven of them.
//!
//! `cargo run --example mesh [DIRECTORY]` writes `ring.3mf`.

use std::path::PathBuf;
use zeroset::{Error, MeshSettings, Scene};

fn main() -> Result<(), Error> {
    let directory = PathBuf::from(std::env::args().nth(1).unwrap_or(".".to_owned()));
    let scene = Scene::read("color gold\n(sqrt(x^2+y^2)-1)^2 + z^2 <= 0.16")?;
    let mesh = scene.mesh(&MeshSettings::new().tolerance(0.01))?;
    mesh.save(directory.join("ring.3mf"))?;
    for surface in mesh.surfaces() {
        let (vertices, faces) = (surface.vertices().len(), surface.faces().len());
        // A closed surface has three edges for each two triangles.
        let euler = vertices as i64 - faces as i64 / 2;
        println!("{}: {faces} triangles, Euler's number {euler}", surface.name());
        println!("closed: {}, proven: {}", surface.is_closed(), surface.is_proven());
    }
    Ok(())
}
