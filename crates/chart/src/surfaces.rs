//! Surfaces by name: the ten of this crate, which `benches/frame.rs` draws too, and the gallery.

use crate::error::ChartError;
use crate::groups::distinct;
use include_dir::{Dir, include_dir};
use zeroset_render::model::Model;
use zeroset_render::picture::{Picture, Settings};
use zeroset_scene::gallery::example;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{Camera, Region};
use zeroset_syntax::{Document, Options, SurfaceKind, read};

/// Function files of Knoll et al. 2007's surfaces, and of the gyroid.
static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/data");

/// A document with its domain.
#[derive(Clone, Debug)]
pub struct ChartSurface {
    /// Name of the surface.
    pub name: String,
    /// Text of the function file.
    pub text: String,
    /// Document read from the text. It has one surface; only [`ChartSurface::read`] allows several.
    pub document: Document,
    /// The domain: the given one, the document's, or one found by intervals.
    pub region: Region,
}

/// Names of the ten surfaces, which are measured by default.
pub fn names() -> Vec<&'static str> {
    FILES.files().filter_map(|file| file.path().file_stem()?.to_str()).collect()
}

/// The distinct surfaces of these names. If there are no names, the ten that are measured by
/// default.
///
/// # Errors
/// If a name is unknown, or its document has several surfaces.
pub fn chosen(given: &[String]) -> Result<Vec<ChartSurface>, ChartError> {
    let given = distinct(given.iter().map(String::as_str));
    let names = if given.is_empty() { names() } else { given };
    names.into_iter().map(ChartSurface::named).collect()
}

impl ChartSurface {
    /// The surface called `name`: one of the ten of this crate, or else of the gallery.
    ///
    /// # Errors
    /// If the name is unknown, or its document has several surfaces.
    pub fn named(name: &str) -> Result<Self, ChartError> {
        let own = FILES.get_file(format!("{name}.zset")).and_then(|file| file.contents_utf8());
        let unknown =
            || ChartError::UnknownSurface { name: name.to_owned(), ten: names().join(", ") };
        let text = own.or_else(|| example(name).map(|example| example.text));
        Self::of(name, text.ok_or_else(unknown)?, None)
    }

    /// The surface of a text, within `region` if that is given.
    ///
    /// # Errors
    /// If the text cannot be read, or has several surfaces.
    pub fn of(name: &str, text: &str, region: Option<Region>) -> Result<Self, ChartError> {
        let surface = Self::read(name, text, region)?;
        if surface.document.surfaces.len() != 1 {
            let why = "only a text that draws one surface can be judged";
            return Err(ChartError::of_surface(name)(why));
        }
        Ok(surface)
    }

    /// Like [`ChartSurface::of`], for a text that may have several surfaces.
    ///
    /// # Errors
    /// If the text cannot be read, or has no domain.
    pub fn read(name: &str, text: &str, region: Option<Region>) -> Result<Self, ChartError> {
        let document = read(text, &Options::default()).map_err(ChartError::of_surface(name))?;
        let found = || view::region(&document, DomainChoice::Document, None);
        let region = region.map_or_else(|| found().map(|(region, _)| region), Ok);
        let region = region.map_err(ChartError::of_surface(name))?;
        // The certified tracer, which judges pictures, knows boxes only.
        let region = Region::new(region.low(), region.high());
        let region = region.map_err(ChartError::of_surface(name))?;
        Ok(Self { name: name.to_owned(), text: text.to_owned(), document, region })
    }

    /// Compiles the surface's kernels.
    ///
    /// # Errors
    /// If a kernel cannot be compiled.
    pub fn model(&self, settings: &Settings) -> Result<Model, ChartError> {
        Model::new(&self.document, &self.region, settings)
            .map_err(ChartError::of_surface(&self.name))
    }

    /// Compiles the surface's kernels and draws a picture.
    ///
    /// # Errors
    /// If a kernel cannot be compiled.
    pub fn picture(&self, camera: &Camera, settings: &Settings) -> Result<Picture, ChartError> {
        let picture = self.model(settings)?.trace(camera, settings, &|_| true);
        picture.map_err(ChartError::of_surface(&self.name))
    }

    /// Whether the surface is a solid, which may have faces where its domain cuts it.
    pub fn is_solid(&self) -> bool {
        self.document.surfaces[0].kind == SurfaceKind::Solid
    }

    /// Ends of the domain, per axis.
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        view::bounds(&self.region).map(|range| [range.lo, range.hi])
    }
}
