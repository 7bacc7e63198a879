//! The command `zeroset gallery`.

use super::arguments::GalleryArgs;
use super::notes;
use super::output::{OutputFile, print};
use super::progress::Progress;
use super::render::{in_threads, method_settings, with_effects};
use super::sheet::ContactSheet;
use super::stage::stage;
use anyhow::{Context, Result};
use image::RgbImage;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;
use zeroset_render::overlay::{Overlay, PictureView};
use zeroset_render::picture::Settings;
use zeroset_render::png_file::{PngFormat, write_png};
use zeroset_scene::gallery::{Example, all, surfaces};

const SHEET: &str = "contact-sheet.png";

pub fn run(arguments: &GalleryArgs) -> Result<ExitCode> {
    if arguments.list {
        print(&listed(&all()))?;
        return Ok(ExitCode::SUCCESS);
    }
    let examples = surfaces();
    arguments.size.held_whole()?;
    let directory = arguments.output.as_deref().context("no directory to write to: add -o DIR")?;
    let settings = with_effects(&method_settings(&arguments.tracing, arguments.size)?);
    std::fs::create_dir_all(directory)
        .with_context(|| format!("cannot make the directory '{}'", directory.display()))?;
    in_threads(arguments.tracing.threads, || render_all(&examples, directory, &settings))?;
    notes::note(&format!(
        "{} pictures and {SHEET} are in '{}'",
        examples.len(),
        directory.display()
    ));
    Ok(ExitCode::SUCCESS)
}

/// Returns one line for each example, with its name and summary.
pub fn listed(examples: &[Example]) -> String {
    let widest = examples.iter().map(|example| example.slug.len()).max().unwrap_or(0);
    let mut lines = String::new();
    for example in examples {
        let _ = writeln!(lines, "{:widest$}  {}", example.slug, example.summary());
    }
    lines
}

fn render_all(examples: &[Example], directory: &Path, settings: &Settings) -> Result<()> {
    let sheet_file = OutputFile::create(&directory.join(SHEET))?;
    let mut sheet = ContactSheet::new(examples.len());
    let bar = Progress::new(examples.len() as u64, "gallery");
    for (done, example) in examples.iter().enumerate() {
        let file = OutputFile::create(&directory.join(format!("{}.png", example.slug)))?;
        let picture = render(example, settings).with_context(|| example.slug)?;
        let (width, height) = (settings.width, settings.height);
        file.finish(|out| write_png(out, picture.as_raw(), PngFormat::RGB, [width, height], &[]))?;
        sheet.add(example.title(), &picture);
        bar.reach(done as u64 + 1);
    }
    let sheet = sheet.into_image();
    let (width, height) = (sheet.width() as usize, sheet.height() as usize);
    sheet_file.finish(|out| write_png(out, sheet.as_raw(), PngFormat::RGB, [width, height], &[]))
}

fn render(example: &Example, settings: &Settings) -> Result<RgbImage> {
    let (model, camera) = stage(example, settings, &|| true)?.context("wanted to the end")?;
    let mut picture = model.picture(&camera, settings)?;
    if [settings.choices.axes, settings.choices.legend].contains(&Some(true)) {
        let shown = PictureView::of(&model, &camera, &picture);
        let size = [settings.width, settings.height];
        Overlay::of(settings.choices).marks(shown, size).mix_into_picture(&mut picture, 0);
    }
    RgbImage::from_raw(settings.width as u32, settings.height as u32, picture.opaque_rgb().into())
        .context("a picture of the wrong size")
}
