//! zeroset's methods, called through the library.

use crate::side::{EnclosureCalls, Side};
use crate::surfaces::Surface;
use anyhow::Result;
use zeroset_render::model::Model;
use zeroset_render::picture::{Normals, Picture, Settings};
use zeroset_space::Camera;
use zeroset_trace::{Method, PixelCounts, TraceOptions};

/// A compiled surface, with its last picture.
pub struct ZerosetSide {
    name: String,
    model: Model,
    camera: Camera,
    settings: Settings,
    picture: Option<Picture>,
}

impl ZerosetSide {
    /// Compiles the surface.
    ///
    /// # Errors
    /// If the surface is invalid or cannot be compiled.
    pub fn new(
        surface: &Surface,
        method: &'static Method,
        size: usize,
        depth: u32,
    ) -> Result<Self> {
        let options = TraceOptions { depth, ..TraceOptions::default() };
        let settings = Settings { options, ..settings(method, size) };
        Self::with(method.name, surface, settings)
    }

    /// Compiles the surface for these settings. The side has its own name.
    ///
    /// # Errors
    /// As [`ZerosetSide::new`].
    pub fn with(name: &str, surface: &Surface, settings: Settings) -> Result<Self> {
        let (document, region) = (surface.document()?, surface.region()?);
        let model = Model::new(&document, &region, &settings)?;
        let (name, camera) = (name.to_owned(), surface.camera()?);
        Ok(Self { name, model, camera, settings, picture: None })
    }
}

/// Settings of a square picture with normals and colors, without shadows.
pub fn settings(method: &'static Method, size: usize) -> Settings {
    Settings {
        width: size,
        height: size,
        method,
        shadow_depth: None,
        normals: Some(Normals::Gradient),
        keeps_normals: false,
        ..Settings::default()
    }
}

impl Side for ZerosetSide {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn size(&self) -> usize {
        self.settings.width
    }

    fn draw(&mut self) -> Result<()> {
        // Reuses the last picture's memory, as the window does. The other renderers overwrite their
        // pictures, too.
        if let Some(shown) = self.picture.take() {
            shown.hand_back();
        }
        let picture = self.model.trace(&self.camera, &self.settings, &|_| true);
        self.picture = Some(picture?);
        Ok(())
    }

    fn distances(&self) -> Vec<f64> {
        self.picture.as_ref().map_or_else(Vec::new, |picture| picture.buffer.drawn.clone())
    }

    fn enclosure_calls(&self) -> Option<EnclosureCalls> {
        let work = &self.picture.as_ref()?.statistics.work.interval;
        // Some methods evaluate no intervals.
        (work.calls > 0).then(|| EnclosureCalls {
            calls: work.calls,
            lanes: work.lanes as f64 / work.calls as f64,
        })
    }

    fn pixels(&self) -> Option<PixelCounts> {
        self.picture.as_ref().map(|picture| picture.statistics.pixels)
    }

    fn note(&self) -> Option<String> {
        let notes = self.picture.as_ref()?.fallback_notes(self.settings.method);
        (!notes.is_empty()).then(|| notes.join("; "))
    }
}
