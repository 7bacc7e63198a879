//! Without arguments, lists the gallery. With a word, renders the surfaces whose name contains the
//! word.
//!
//! `cargo run --example gallery [WORD [DIRECTORY]]` writes `NAME.png` for each surface.

use std::path::PathBuf;
use zeroset::{Error, Scene, Settings, gallery};

fn main() -> Result<(), Error> {
    let mut arguments = std::env::args().skip(1);
    let Some(word) = arguments.next() else {
        gallery().for_each(|example| println!("{:32}{}", example.name, example.summary));
        return Ok(());
    };
    let directory = PathBuf::from(arguments.next().unwrap_or(".".to_owned()));
    for example in gallery().filter(|example| example.name.contains(&word)) {
        let picture = Scene::read(example.text)?.render(&Settings::new(256, 256))?;
        picture.save(directory.join(example.name).with_extension("png"))?;
        println!("{}: {} pixels undecided", example.title, picture.counts().undecided);
    }
    Ok(())
}
