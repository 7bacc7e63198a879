//! Pictures of each surface by each method, with the errors of each pixel.

use super::escaped;
use crate::difference::{difference, png};
use crate::error::ChartError;
use crate::errors::PixelErrors;
use crate::grid::Configuration;
use crate::groups::{distinct, grouped};
use crate::progress::progress;
use crate::reference::{RootReference, Sampling};
use crate::row::Row;
use crate::store::Store;
use crate::surfaces::ChartSurface;
use crate::views::View;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::RgbImage;
use zeroset_testkit::certified::BUDGET;
use zeroset_trace::{METHODS, Method, Precision, RayGrid};

/// Side of a picture in pixels. The certified tracer checks every pixel.
const SIZE: usize = 96;

/// The pictures of every surface in its standard view, as HTML.
pub fn pictures(store: &Store) -> Result<String, ChartError> {
    let mut text = String::new();
    let bar = progress(store.rows.len());
    for (surface, rows) in grouped(&store.rows, |row| &row.surface) {
        bar.set_message(format!("pictures of {surface}"));
        bar.inc(rows.len() as u64);
        text += &of_surface(store, &rows)?;
    }
    bar.finish_and_clear();
    Ok(text)
}

/// The middle configuration of each method. If the method was measured in the precision `auto`,
/// only configurations in `auto` count.
fn middle_configurations(rows: &[&Row]) -> Vec<Configuration> {
    let measured = distinct(rows.iter().filter_map(|row| row.configuration().ok()));
    let middle = |method: &Method| {
        let of_method = measured.iter().filter(|one| one.method == method);
        let (auto, others): (Vec<_>, Vec<_>) = of_method
            .copied()
            .partition(|one: &Configuration| one.precision == Some(Precision::Auto));
        let some = if auto.is_empty() { others } else { auto };
        some.get(some.len() / 2).copied()
    };
    METHODS.iter().filter_map(middle).collect()
}

fn of_surface(store: &Store, rows: &[&Row]) -> Result<String, ChartError> {
    let row = rows[0];
    let surface = ChartSurface::named(&row.surface)?;
    let view = View { name: format!("{}-page", row.view), camera: row.camera()? };
    let sampling = Sampling { size: SIZE, samples: 0, seed: row.seed, budget: BUDGET };
    let reference = RootReference::kept(&store.path("reference"), &surface, &view, sampling)?;
    let rays = RayGrid::new(&view.camera, SIZE, SIZE);
    let name = escaped(&surface.name);
    let mut text = vec![format!("<h3>{name}</h3>\n<div class=\"pictures\">\n")];
    for configuration in middle_configurations(rows) {
        let settings = configuration.settings(SIZE);
        let picture = surface.picture(&view.camera, &settings)?;
        let errors = PixelErrors::new(&reference, &rays, &picture.buffer);
        let wrong = difference(&reference, &picture.buffer);
        let side = SIZE as u32;
        let shown = RgbImage::from_raw(side, side, picture.rgb).unwrap_or_default();
        let [shown, wrong] = [shown, wrong].map(|image| source(&image));
        let (name, command) = (configuration.to_string(), command(row, &configuration));
        text.push(format!(
            "<div title=\"{}\"><img src=\"{}\" alt=\"\"><img class=\"wrong\" src=\"{}\" alt=\"\">{}<br>{} wrong, {} \
             undecided</div>\n",
            escaped(&command),
            shown?,
            wrong?,
            escaped(&name),
            errors.wrong(),
            errors.undecided
        ));
    }
    text.push("</div>\n".to_owned());
    Ok(text.concat())
}

/// The command that draws the picture again. It works for surfaces of the gallery only.
fn command(row: &Row, configuration: &Configuration) -> String {
    format!(
        "zeroset render {} --eye {},{},{} --target {},{},{} --up {},{},{} --fov {} --size {SIZE} {}",
        row.surface,
        row.eye_x,
        row.eye_y,
        row.eye_z,
        row.target_x,
        row.target_y,
        row.target_z,
        row.up_x,
        row.up_y,
        row.up_z,
        row.fov,
        configuration.flags()
    )
}

fn source(image: &RgbImage) -> Result<String, ChartError> {
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(png(image)?)))
}
