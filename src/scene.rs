//! Scenes: texts that draw surfaces, and their rendering.

use crate::error::{Diagnostic, Error};
use crate::measure::{MeasureSettings, Measures, measured};
use crate::mesh::{Mesh, MeshSettings};
use crate::picture::{Picture, PictureArrays};
use crate::settings::Settings;
use crate::text::{Parameter, Text};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use zeroset_render::drawing::draw;
use zeroset_render::framing;
use zeroset_render::model::Model;
use zeroset_render::overlay::Overlay;
use zeroset_render::progress::{Listener, Progress};
use zeroset_scene::program::ProgramError;
use zeroset_scene::view::{Clipping, region};
use zeroset_trace::RayGrid;

/// A text that draws one or more surfaces or solids.
///
/// A scene can be shared between threads. Pictures use the threads of the current `rayon` pool.
pub struct Scene {
    text: Text,
    /// The compiled surfaces of the last picture. The next picture may reuse their kernels.
    model: Mutex<Option<Arc<Model>>>,
}

impl Scene {
    /// Reads a text: a formula, or the content of a file. A file may have definitions, surfaces,
    /// and lines on how the surfaces are shown.
    ///
    /// # Errors
    /// If the text is wrong. The error lists up to twenty faults.
    ///
    /// ```
    /// let scene = zeroset::Scene::read("r = 2 in [1, 3]\nz = x*y {x^2+y^2 < r^2}")?;
    /// assert_eq!(scene.parameters()[0].name, "r");
    /// assert_eq!(scene.surfaces().count(), 1);
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn read(text: &str) -> Result<Self, Error> {
        Ok(Self { text: Text::read(text)?, model: Mutex::default() })
    }

    /// Returns notes on how ambiguous parts of the text were read.
    ///
    /// ```
    /// let scene = zeroset::Scene::read("z = 1/2x + y")?;
    /// assert!(scene.notes()[0].message.starts_with("read as `(1/2)*x`"));
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn notes(&self) -> Vec<Diagnostic> {
        self.text.notes()
    }

    /// Returns the formula of each surface as it was read, in the order of the text.
    pub fn surfaces(&self) -> impl Iterator<Item = &str> {
        self.text.document.drawn_surfaces().map(|surface| surface.echo)
    }

    /// Returns the text's parameters, in the order of their definitions.
    pub fn parameters(&self) -> Vec<Parameter> {
        self.text.parameters()
    }

    /// Sets a parameter to exactly `value`. If the value is within the parameter's range, the next
    /// picture of the same domain compiles nothing.
    ///
    /// # Errors
    /// If there is no such parameter, or the value is not finite. The scene is then unchanged.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), Error> {
        self.text.document = self.text.with(name, value)?;
        Ok(())
    }

    /// Renders a picture. Without a [budget](Settings::budget) of time, it depends only on the
    /// text, the values of parameters and the settings.
    ///
    /// # Errors
    /// If a setting is out of range, or the domain or the camera is impossible. If a formula is
    /// constant, defined nowhere, or too large to compile.
    ///
    /// ```
    /// use zeroset::{Scene, Settings};
    /// let picture = Scene::read("z = x*y {x^2+y^2 < 4}")?.render(&Settings::new(64, 64))?;
    /// assert!(picture.counts().hit > 500);
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn render(&self, settings: &Settings) -> Result<Picture, Error> {
        self.drawn(settings, None)
    }

    /// Renders a picture as [`Scene::render`] does, and tells how much of it is done: calls `tell`
    /// from several threads with the stage, such as "tracing" or "smoothing", and the percent of
    /// the stage's pixels that are done.
    ///
    /// # Errors
    /// As [`Scene::render`].
    ///
    /// ```
    /// use std::sync::atomic::{AtomicUsize, Ordering};
    /// use zeroset::{Scene, Settings};
    /// let most = AtomicUsize::new(0);
    /// let tell = |stage: &str, percent| {
    ///     if stage == "tracing" {
    ///         most.fetch_max(percent, Ordering::Relaxed);
    ///     }
    /// };
    /// Scene::read("z = x*y {x^2+y^2 < 4}")?.render_telling(&Settings::new(64, 64), &tell)?;
    /// assert_eq!(most.into_inner(), 100);
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn render_telling(
        &self,
        settings: &Settings,
        tell: &(dyn Fn(&'static str, usize) + Sync),
    ) -> Result<Picture, Error> {
        self.drawn(settings, Some(&|now: Progress| tell(now.stage, now.percent())))
    }

    fn drawn(&self, settings: &Settings, listener: Listener<'_>) -> Result<Picture, Error> {
        let (document, choice) = (&self.text.document, &settings.camera);
        let domain = settings.domain_choice();
        let around = Overlay::asked(settings.picture.choices, document);
        let around = around.titled(settings.title.as_deref());
        let settings = settings.checked()?;
        let (region, _) = region(document, domain, Clipping::default()).map_err(Error::scene)?;
        // Never hold this lock while compiling: the thread may take up work that needs the lock.
        let last = || self.model.lock().unwrap_or_else(PoisonError::into_inner);
        let before = last().clone().filter(|model| *model.region() == region);
        let again = before.and_then(|model| model.rebound(document, &region)?.ok());
        let anew = || Model::new(document, &region, &settings);
        let model = Arc::new(again.map_or_else(anew, Ok).map_err(Error::formula)?);
        *last() = Some(Arc::clone(&model));
        let camera = framing::camera(&model, choice, &settings, around.axes);
        let camera = camera.map_err(Error::scene)?;
        let mut rows = PictureArrays::default();
        let mut add = |_, picture: &mut _| -> Result<(), ProgramError> {
            rows.add(picture);
            Ok(())
        };
        let whole = draw(&model, &camera, &settings, &around, listener, &mut add);
        let rays = RayGrid::new(&camera, settings.width, settings.height);
        Ok(Picture::new(camera, rays, &region, rows, whole.map_err(Error::formula)?))
    }

    /// Makes triangles of all surfaces that are not hidden, in the domain, as a ball or a clip
    /// plane of the text cuts it.
    ///
    /// # Errors
    /// If a setting is out of range, the domain is impossible, or the time is over. If a formula is
    /// constant, defined nowhere, or too large to compile.
    ///
    /// ```
    /// use zeroset::{MeshSettings, Scene};
    /// let mesh = Scene::read("z = x*y {x^2+y^2 < 4}")?.mesh(&MeshSettings::new().tolerance(0.2))?;
    /// let saddle = &mesh.surfaces()[0];
    /// assert!(!saddle.is_closed());
    /// assert_eq!(saddle.name(), "z = x*y {x^2 + y^2 < 4}");
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn mesh(&self, settings: &MeshSettings) -> Result<Mesh, Error> {
        Mesh::new(&self.text.document, settings)
    }

    /// Measures all surfaces that are not hidden, by default in all ways: volume, centroid and
    /// inertia of solids, extent, area and shape of each. A ball or a clip plane of the text cuts
    /// them. Parametric surfaces are left out.
    ///
    /// # Errors
    /// If a setting is out of range, a surface is not proven bounded and no domain is given, or the
    /// time is over. If a formula is constant, empty, or too large to compile. If all surfaces are
    /// parametric.
    ///
    /// ```
    /// use zeroset::{MeasureSettings, Scene};
    /// let ball = Scene::read("x^2+y^2+z^2 <= 1")?;
    /// let ball = &ball.measure(&MeasureSettings::new().relative(0.01))?[0];
    /// let volume = ball.volume.clone().expect("a solid");
    /// assert!(volume.contains(&4.18879) && volume.end() - volume.start() < 0.042);
    /// assert_eq!((ball.is_shape_proven, &ball.genus), (Some(true), &Some(vec![Some(0)])));
    /// # Ok::<(), zeroset::Error>(())
    /// ```
    pub fn measure(&self, settings: &MeasureSettings) -> Result<Vec<Measures>, Error> {
        measured(&self.text, settings)
    }
}

impl fmt::Debug for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Scene({})", self.surfaces().collect::<Vec<_>>().join("; "))
    }
}
