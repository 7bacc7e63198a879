//! The last step of a picture: a model seen by a camera, with curves, axes, legends and a title.

use crate::model::{Model, Strip};
use crate::overlay::{Overlay, PictureView};
use crate::picture::{Picture, Settings};
use crate::progress::Listener;
use zeroset_scene::program::ProgramError;
use zeroset_space::Camera;

/// Draws a picture strip by strip, as [`Model::strips`] does. Calls `each` for every strip, with
/// its first row and its picture, over which curves, axes, legends and title are drawn.
///
/// # Errors
/// As [`Model::trace`], and errors of `each`.
pub fn draw<E: From<ProgramError>>(
    model: &Model,
    camera: &Camera,
    settings: &Settings,
    around: &Overlay,
    listener: Listener<'_>,
    each: &mut dyn FnMut(usize, &mut Picture) -> Result<(), E>,
) -> Result<Picture, E> {
    let (size, mut marks) = ([settings.width, settings.height], None);
    let mut mark = |Strip { top, picture, overview }: Strip<'_>| {
        let seen = overview.unwrap_or(&*picture);
        let marks =
            marks.get_or_insert_with(|| around.marks(PictureView::of(model, camera, seen), size));
        marks.mix_into_picture(picture, top);
        each(top, picture)
    };
    model.strips(camera, settings, listener, &mut mark)
}
