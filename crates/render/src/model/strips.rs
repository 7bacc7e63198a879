//! Pictures too large for memory, drawn as strips of rows.
//!
//! A strip equals its part of the whole picture bit for bit, except for ambient occlusion, shadows
//! on the ground and color scales. All three depend on distant rows. An overview supplies these
//! rows: a smaller picture of the whole. With an overview of full size, strips do not differ.

use super::Model;
use crate::picture::{Picture, Settings};
use crate::progress::{Count, Done, Listener};
use zeroset_scene::program::ProgramError;
use zeroset_shade::{ColorDepth, Pattern};
use zeroset_space::Camera;
use zeroset_trace::RayGrid;

/// Strips begin at multiples of this many rows, and are drawn with this many extra rows above and
/// below. Methods trace bands of this height. Antialiasing and outlines need fewer extra rows.
const ALIGNED: usize = 16;

/// Approximate number of pixels of a strip, and largest number of pixels of a picture drawn whole.
/// A pixel takes some hundred bytes.
const STRIP: usize = 1 << 21;
const WHOLE: usize = 1 << 22;

/// Largest number of rows and largest number of pixels of an overview.
const OVERVIEW_ROWS: usize = 1024;
const OVERVIEW_PIXELS: usize = 1 << 21;

/// A strip: some rows of a picture.
pub struct Strip<'a> {
    /// First row, counted from the top of the whole picture.
    pub top: usize,
    /// The picture of the strip's rows.
    pub picture: &'a mut Picture,
    /// A smaller picture of the whole. `None` if the strip is the whole, or has no normals.
    pub overview: Option<&'a Picture>,
}

/// A small picture of the whole, which supplies data from distant rows.
pub(super) struct Overview {
    pub picture: Picture,
    pub rays: RayGrid,
}

impl Model {
    /// Draws a picture strip by strip to limit memory, and calls `each` for every strip. A picture
    /// of moderate size is a single strip. Returns a picture without rows, which has the times,
    /// counts and remarks of the whole.
    ///
    /// # Errors
    /// As [`Model::trace`], and errors of `each`.
    pub fn strips<E: From<ProgramError>>(
        &self,
        camera: &Camera,
        settings: &Settings,
        listener: Listener<'_>,
        each: &mut dyn FnMut(Strip<'_>) -> Result<(), E>,
    ) -> Result<Picture, E> {
        let Settings { width, height, .. } = *settings;
        let mut rows = height;
        if width * height > WHOLE {
            rows = (STRIP / width / ALIGNED).max(1) * ALIGNED;
        }
        self.strips_of_height(rows, camera, settings, listener, each)
    }

    /// Like [`Model::strips`], with a given number of rows per strip.
    ///
    /// # Errors
    /// As [`Model::strips`].
    ///
    /// # Panics
    /// If `rows` is less than the picture's height and not a positive multiple of sixteen.
    pub fn strips_of_height<E: From<ProgramError>>(
        &self,
        rows: usize,
        camera: &Camera,
        settings: &Settings,
        listener: Listener<'_>,
        each: &mut dyn FnMut(Strip<'_>) -> Result<(), E>,
    ) -> Result<Picture, E> {
        let Settings { width, height, .. } = *settings;
        let surfaces = self.visible_surfaces().count();
        if rows >= height {
            let count = Count::tracing(width * height * surfaces, listener);
            let advance = |done| {
                count.add(done);
                true
            };
            let mut picture = self.trace(camera, settings, &advance)?;
            each(Strip { top: 0, picture: &mut picture, overview: None })?;
            picture.buffer.crop(0..0);
            return Ok(picture);
        }
        assert!(rows > 0 && rows.is_multiple_of(ALIGNED), "strips of whole bands");
        let wanted = settings.limit.wanted();
        let small = overview_settings(settings);
        let tops = || (0..height).step_by(rows);
        let known = |top: usize| top.saturating_sub(ALIGNED)..(top + rows + ALIGNED).min(height);
        let pixels = tops().map(|top| known(top).len() * width).sum::<usize>();
        let count = Count::tracing((pixels + small.width * small.height) * surfaces, listener);
        let advance = |done: Done| {
            // A strip is smoothed before the next one is traced, so only pixels count.
            if let Done::Pixels(_) = done {
                count.add(done);
            }
            wanted()
        };
        let whole = RayGrid::new(camera, width, height);
        let mut overview = None;
        if settings.normals.is_some() {
            let rays = RayGrid::new(camera, small.width, small.height);
            let picture = self.along(&rays, &small, &advance, None, None)?;
            overview = Some(Overview { picture, rays });
        }
        let mut all: Option<Picture> = None;
        for top in tops() {
            let known = known(top);
            let own = top - known.start..(top + rows).min(height) - known.start;
            let rays = whole.part(0..width, known);
            let known = overview.as_ref();
            let mut picture = self.along(&rays, settings, &advance, known, Some(own))?;
            let overview = known.map(|overview| &overview.picture);
            each(Strip { top, picture: &mut picture, overview })?;
            all = Some(match all {
                None => picture.without_rows(),
                Some(mut all) => {
                    all.add(&picture);
                    picture.hand_back();
                    all
                }
            });
        }
        Ok(all.expect("a strip"))
    }
}

fn overview_settings(settings: &Settings) -> Settings {
    let Settings { width, height, .. } = *settings;
    let by_area = (OVERVIEW_PIXELS as f64 / (width * height) as f64).sqrt();
    let scale = by_area.min(OVERVIEW_ROWS as f64 / height as f64).min(1.0);
    let [width, height] =
        [width, height].map(|size| ((size as f64 * scale).round() as usize).max(1));
    Settings {
        width,
        height,
        choices: settings.unshadowed(),
        brackets: false,
        keeps_normals: true,
        antialias: Pattern::ONE,
        depth: ColorDepth::Bytes,
        ..settings.clone()
    }
}
