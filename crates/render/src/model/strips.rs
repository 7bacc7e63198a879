//! Pictures too large to be held whole: strips of rows, one after another.
//!
//! A strip shows what the whole picture would, bit for bit, but for what surrounds each point at a
//! distance: what is near to what, and which values colors stand for, is taken from an overview, a
//! smaller picture of the whole. Where that is no smaller, nothing differs.

use super::{Model, Progress};
use crate::picture::{Picture, Settings};
use std::sync::atomic::{AtomicUsize, Ordering};
use zeroset_scene::program::ProgramError;
use zeroset_shade::Pattern;
use zeroset_trace::{Camera, RayGrid};

/// Strips begin at multiples of so many rows, and know as many beyond either end: what methods look
/// at together, and more than smoothing reaches.
const ALIGNED: usize = 16;

/// Pixels of a strip, about, and of a picture that is held whole: some hundred bytes each.
const STRIP: usize = 1 << 21;
const WHOLE: usize = 1 << 22;

/// Rows of an overview, and pixels, at most.
const OVERVIEW_ROWS: usize = 1024;
const OVERVIEW_PIXELS: usize = 1 << 21;

/// Some rows of a picture.
pub struct Strip<'a> {
    /// The first row, counted from the whole picture's top.
    pub top: usize,
    /// What is known of these rows alone.
    pub picture: &'a mut Picture,
    /// A picture of the whole, perhaps smaller; `None` if `picture` is the whole.
    pub overview: Option<&'a Picture>,
}

/// A picture of the whole that tells what strips cannot know.
pub(super) struct Overview {
    pub picture: Picture,
    pub rays: RayGrid,
}

impl Model {
    /// Takes a picture strip by strip, of as many rows as take little memory; one of a moderate
    /// size is a single strip. Returns a picture without rows that tells of all of them: times,
    /// counts and remarks.
    ///
    /// # Errors
    /// As [`Model::trace`], and those of `each`.
    pub fn strips<E: From<ProgramError>>(
        &self,
        camera: &Camera,
        settings: &Settings,
        progress: Progress<'_>,
        each: &mut dyn FnMut(Strip<'_>) -> Result<(), E>,
    ) -> Result<Picture, E> {
        let Settings { width, height, .. } = *settings;
        let mut rows = height;
        if width * height > WHOLE {
            rows = (STRIP / width / ALIGNED).max(1) * ALIGNED;
        }
        self.strips_of(rows, camera, settings, progress, each)
    }

    /// As [`Model::strips`], of so many rows each, which are a multiple of sixteen unless they are
    /// all.
    ///
    /// # Errors
    /// As [`Model::strips`].
    ///
    /// # Panics
    /// If there are so few rows.
    pub fn strips_of<E: From<ProgramError>>(
        &self,
        rows: usize,
        camera: &Camera,
        settings: &Settings,
        progress: Progress<'_>,
        each: &mut dyn FnMut(Strip<'_>) -> Result<(), E>,
    ) -> Result<Picture, E> {
        let Settings { width, height, .. } = *settings;
        if rows >= height {
            let mut picture = self.picture(camera, settings, progress)?;
            each(Strip { top: 0, picture: &mut picture, overview: None })?;
            picture.buffer.crop(0..0);
            return Ok(picture);
        }
        assert!(rows > 0 && rows.is_multiple_of(ALIGNED), "strips of whole bands");
        let has_time = settings.has_time();
        let small = overview_settings(settings);
        let tops = || (0..height).step_by(rows);
        let known = |top: usize| top.saturating_sub(ALIGNED)..(top + rows + ALIGNED).min(height);
        let pixels = tops().map(|top| known(top).len() * width).sum::<usize>();
        let pixels = (pixels + small.width * small.height) * self.seen().count();
        let done = AtomicUsize::new(0);
        let advance = |now: usize| {
            progress(done.fetch_add(now, Ordering::Relaxed) + now, pixels);
            has_time()
        };
        let whole = camera.rays(width, height);
        let mut overview = None;
        if settings.normals.is_some() {
            let rays = camera.rays(small.width, small.height);
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

/// Of a picture of the whole that is small enough.
fn overview_settings(settings: &Settings) -> Settings {
    let Settings { width, height, .. } = *settings;
    let by_area = (OVERVIEW_PIXELS as f64 / (width * height) as f64).sqrt();
    let scale = by_area.min(OVERVIEW_ROWS as f64 / height as f64).min(1.0);
    let [width, height] =
        [width, height].map(|size| ((size as f64 * scale).round() as usize).max(1));
    Settings {
        width,
        height,
        shadow_depth: None,
        brackets: false,
        keeps_normals: true,
        antialias: Pattern::ONE,
        ..settings.clone()
    }
}
