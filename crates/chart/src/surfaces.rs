//! Surfaces by name: ten of this crate's own, which `benches/frame.rs` draws too, and the gallery.

use crate::error::ChartError;
use crate::groups::distinct;
use include_dir::{Dir, include_dir};
use zeroset::gallery::example;
use zeroset::model::Model;
use zeroset::picture::{Picture, Settings};
use zeroset::scene::{self, DomainChoice};
use zeroset_syntax::{Document, Options, SurfaceKind, read};
use zeroset_trace::{Camera, Region};

/// Those of Knoll et al. 2007, and the gyroid.
static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/data");

/// A function and its domain.
#[derive(Clone, Debug)]
pub struct Surface {
    /// What it is called.
    pub name: String,
    /// The function file.
    pub text: String,
    /// The same, read: it draws one surface, or several if only [`Surface::read`] has read it.
    pub document: Document,
    /// Its domain: the document's, else where intervals find the surface.
    pub region: Region,
}

/// The names of the ten surfaces, which are measured unless others are named.
pub fn names() -> Vec<&'static str> {
    FILES.files().filter_map(|file| file.path().file_stem()?.to_str()).collect()
}

/// The surfaces of these names, each once; the ten if there are none.
///
/// # Errors
/// If there is no such surface, or it draws several at once.
pub fn chosen(given: &[String]) -> Result<Vec<Surface>, ChartError> {
    let given = distinct(given.iter().map(String::as_str));
    let names = if given.is_empty() { names() } else { given };
    names.into_iter().map(Surface::named).collect()
}

impl Surface {
    /// The surface called `name`: one of the ten, else of the gallery.
    ///
    /// # Errors
    /// If there is none, or it draws several at once.
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
    /// If the text cannot be read, or draws several surfaces at once.
    pub fn of(name: &str, text: &str, region: Option<Region>) -> Result<Self, ChartError> {
        let surface = Self::read(name, text, region)?;
        if surface.document.surfaces.len() != 1 {
            let why = "only a text that draws one surface can be judged";
            return Err(ChartError::of_surface(name)(why));
        }
        Ok(surface)
    }

    /// The same of a text that may draw several surfaces.
    ///
    /// # Errors
    /// If the text cannot be read, or has no domain.
    pub fn read(name: &str, text: &str, region: Option<Region>) -> Result<Self, ChartError> {
        let document = read(text, &Options::default()).map_err(ChartError::of_surface(name))?;
        let found = || scene::region(&document, DomainChoice::Document, None);
        let region = region.map_or_else(|| found().map(|(region, _)| region), Ok);
        let region = region.map_err(ChartError::of_surface(name))?;
        Ok(Self { name: name.to_owned(), text: text.to_owned(), document, region })
    }

    /// Its kernels.
    ///
    /// # Errors
    /// If they cannot be made.
    pub fn model(&self, settings: &Settings) -> Result<Model, ChartError> {
        Model::new(&self.document, &self.region, settings)
            .map_err(ChartError::of_surface(&self.name))
    }

    /// A picture, for which kernels are made.
    ///
    /// # Errors
    /// If they cannot be made.
    pub fn picture(&self, camera: &Camera, settings: &Settings) -> Result<Picture, ChartError> {
        let picture = self.model(settings)?.trace(camera, settings, &|_| true);
        picture.map_err(ChartError::of_surface(&self.name))
    }

    /// Whether it is a solid, which the faces of its domain may cut.
    pub fn is_solid(&self) -> bool {
        self.document.surfaces[0].kind == SurfaceKind::Solid
    }

    /// Its domain axis by axis.
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        scene::bounds(&self.region).map(|range| [range.lo, range.hi])
    }
}
