//! Prepares a gallery surface for pictures, in the contact sheet and the window's gallery.

use anyhow::{Result, anyhow};
use zeroset_render::framing;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::gallery::Example;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::Camera;
use zeroset_syntax::Options;

/// Returns the example's model and a camera, for pictures with these settings. Returns `None` if
/// `wanted` returns false before both are ready.
///
/// # Errors
/// If the example cannot be read, compiled or framed.
pub fn stage(
    example: &Example,
    settings: &Settings,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<(Model, Camera)>> {
    let document = zeroset_syntax::read(example.text, &Options::default())
        .map_err(|errors| anyhow!("{errors}"))?;
    let found = view::region_while(&mut None, &document, DomainChoice::Document, None, wanted)?;
    let Some((region, _)) = found else { return Ok(None) };
    let Some(model) = Model::new_while(&document, &region, &region, settings, wanted)? else {
        return Ok(None);
    };
    let choice = CameraChoice::default();
    let axes = settings.choices.axes == Some(true);
    let camera = framing::camera_while(&model, &choice, settings, axes, wanted)?;
    Ok(camera.map(|camera| (model, camera)))
}
