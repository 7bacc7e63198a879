//! The compiled surfaces of a document over one region. They can be drawn from any camera.

mod antialias;
mod blur;
mod bounds;
mod ground;
mod layers;
mod locate;
mod outlines;
mod paint;
mod strips;
mod trace;

pub use locate::{Located, true_digits};
pub use strips::Strip;

use crate::picture::{Normals, Picture, Precision, Settings, Times};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};
use zeroset_eval::{Assumptions, Boxes, KernelFloat, Points, SurfaceKernels};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph};
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::curves::{self, TracedCurves};
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::number::nearest;
use zeroset_scene::program::{Program, ProgramError};
use zeroset_scene::{proportions, view};
use zeroset_shade::Light;
use zeroset_space::{Camera, Cell, Region};
use zeroset_style::{Choices, Look, Material};
use zeroset_syntax::{Background, Document, DrawnSurface, PictureLines, PointValue, SurfaceColor};
use zeroset_trace::{RayGrid, TraceOptions};

/// All surfaces of a document over one region. Kernels are compiled when first needed, and freed
/// with the last model that shares them.
pub struct Model {
    region: Region,
    program: Program,
    /// Styles of the surfaces, parametric ones last. Their functions are in `program`.
    styles: Vec<SurfaceStyle>,
    setting: DocumentStyle,
    remarks: Vec<String>,
    /// Curves and points in the region, for the present values of the parameters.
    curves: Arc<TracedCurves>,
    /// Float type of the kernels, unless a picture asks for another.
    precision: Precision,
    /// Times of simplifying and compiling. `None` if the code was reused from another model.
    times: Option<Times>,
    /// For each surface, whether its negative side faces outward. Computed for the first picture
    /// that shows the surface.
    turned: Vec<OnceLock<bool>>,
    /// Height of the ground, once it is known.
    ground: OnceLock<f64>,
    /// For each surface, whether the region may cut it, if it is a solid: found by kernels in
    /// `f32`, and in `f64`.
    cut: Vec<[OnceLock<bool>; 2]>,
    /// For each surface, a box that holds its zeros in the region, and a box that holds all of a
    /// solid there. Computed for the first picture of several surfaces.
    bounds: Vec<[OnceLock<Option<Cell>>; 2]>,
}

/// The style of a surface.
#[derive(Clone, Debug)]
struct SurfaceStyle {
    is_solid: bool,
    color: Option<SurfaceColor>,
    opacity: f64,
    material: &'static Material,
    hidden: bool,
}

impl SurfaceStyle {
    /// The styles of all surfaces of a document, parametric ones last.
    fn all(document: &Document) -> Vec<Self> {
        let style = |one: DrawnSurface<'_>| Self {
            is_solid: one.is_solid,
            color: one.color.cloned(),
            opacity: one.opacity,
            material: one.material,
            hidden: one.hidden,
        };
        document.drawn_surfaces().map(style).collect()
    }
}

/// Picture settings of a document.
struct DocumentStyle {
    look: Option<&'static Look>,
    background: Option<Background>,
    lines: PictureLines,
    /// The document's choice of a camera.
    camera: CameraChoice,
    /// The values x, y and z, for lines whose values the document does not name. `None` without
    /// lines.
    coordinates: Option<[PointValue; 3]>,
    /// The coordinates that are the same along lines of a mesh.
    mesh: &'static [usize],
    /// Values of the parameters, indexed by parameter number.
    parameters: Vec<f64>,
}

impl DocumentStyle {
    fn of(document: &Document) -> Self {
        let lines = &document.picture;
        let coordinate = |(axis, name): (Axis, &str)| {
            let mut graph = Graph::new();
            let root = graph.variable(axis);
            PointValue { graph, root, echo: name.to_owned() }
        };
        let mesh: &[usize] = match lines.mesh {
            Some(true) if proportions::are_graphs(document) => &[0, 1],
            Some(true) => &[0, 1, 2],
            Some(false) | None => &[],
        };
        let values = document.parameters.iter().map(|parameter| nearest(&parameter.value));
        Self {
            look: document.look,
            background: document.background,
            lines: lines.clone(),
            camera: CameraChoice::typed(document),
            coordinates: (lines.contours.is_some() || !mesh.is_empty())
                .then(|| [(Axis::X, "x"), (Axis::Y, "y"), (Axis::Z, "z")].map(coordinate)),
            mesh,
            parameters: values.collect(),
        }
    }
}

impl Model {
    /// Simplifies all surfaces of `document` in `region`, and compiles the kernels that a picture
    /// with these settings needs.
    ///
    /// # Errors
    /// If a formula is constant, undefined everywhere, or too large to compile.
    pub fn new(
        document: &Document,
        region: &Region,
        settings: &Settings,
    ) -> Result<Self, ProgramError> {
        let mut model = Self::simplified(document, region, region, settings)?;
        model.compile(settings, &|| true)?;
        Ok(model)
    }

    /// Like [`Model::new`], but in a hurry: kernels are compiled in half the time, but run up to
    /// 1.7 times as long, until [`Model::optimize`] replaces them. Pictures are the same. The work
    /// can be cancelled: it checks `wanted` between kernels, and returns `None` once `wanted`
    /// returns false. The code serves all regions within `reach`, which must contain `region`.
    ///
    /// # Errors
    /// As [`Model::new`].
    pub fn new_while(
        document: &Document,
        region: &Region,
        reach: &Region,
        settings: &Settings,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Self>, ProgramError> {
        let mut model = Self::simplified(document, region, reach, settings)?;
        model.program.hurry();
        Ok(model.compile(settings, wanted)?.then_some(model))
    }

    /// Simplifies all surfaces of `document` in `region`. The code serves all regions within
    /// `reach`, as for [`Model::new_while`]. Kernels are compiled when first needed, or by
    /// [`Model::compile`].
    ///
    /// # Errors
    /// If a formula is constant or undefined everywhere.
    pub fn simplified(
        document: &Document,
        region: &Region,
        reach: &Region,
        settings: &Settings,
    ) -> Result<Self, ProgramError> {
        let watch = Instant::now();
        let program = Program::new(document, view::bounds(reach))?.with_patches(document)?;
        let times = Some(Times { simplify: watch.elapsed(), ..Times::default() });
        let curves = curves::trace(document, region);
        let precision = settings.options.precision;
        Ok(Self::of(program, document, region, curves.into(), precision, times))
    }

    /// Optimizes the kernels of [`Model::new_while`], in parallel. It checks `wanted` between
    /// kernels, and returns whether all are optimized. The model may draw at the same time.
    pub fn optimize(&self, wanted: &(dyn Fn() -> bool + Sync)) -> bool {
        self.program.optimize(wanted)
    }

    /// Compiles the kernels that a picture with these settings needs. It checks `wanted` between
    /// kernels, and returns whether all are compiled.
    ///
    /// # Errors
    /// If a formula is too large to compile.
    pub fn compile(
        &mut self,
        settings: &Settings,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<bool, ProgramError> {
        let watch = Instant::now();
        let make = match self.precision {
            Precision::Auto | Precision::F32 => make_kernels::<f32>,
            Precision::F64 => make_kernels::<f64>,
        };
        let surfaces = self.styles.par_iter().enumerate();
        // The kernels of a hidden surface are compiled when it is first shown.
        let visible_surfaces = surfaces.filter(|(_, surface)| !surface.hidden);
        visible_surfaces.try_for_each(|(n, surface)| {
            make(&self.program, n, surface.is_solid, &self.region, settings, wanted)
        })?;
        if let Some(times) = &mut self.times {
            times.compile = watch.elapsed();
        }
        Ok(wanted())
    }

    /// The same model of `document`, whose functions are interpreted. Results are equal bit for
    /// bit, but take some hundred times longer. Nothing is compiled.
    #[must_use]
    pub fn interpreted(&self, document: &Document) -> Self {
        let program = self.program.on(Evaluator::Reference);
        let curves = Arc::clone(&self.curves);
        Self::of(program, document, &self.region, curves, self.precision, self.times)
    }

    fn of(
        program: Program,
        document: &Document,
        region: &Region,
        curves: Arc<TracedCurves>,
        precision: Precision,
        times: Option<Times>,
    ) -> Self {
        let styles = SurfaceStyle::all(document);
        let mut remarks = program.remarks(document);
        remarks.extend(curves.remarks.iter().cloned());
        let mut setting = DocumentStyle::of(document);
        if styles.is_empty() {
            setting.camera.flat = curves.flat();
        }
        Self {
            region: *region,
            setting,
            remarks,
            curves,
            program,
            precision,
            times,
            turned: vec![OnceLock::new(); styles.len()],
            ground: OnceLock::new(),
            cut: vec![[const { OnceLock::new() }; 2]; styles.len()],
            bounds: vec![[const { OnceLock::new() }; 2]; styles.len()],
            styles,
        }
    }

    /// The same code with the parameter values of another document, in another region. Returns
    /// `None` if the documents differ in more than values and colors, or if the code does not serve
    /// the values or the region. For a slider, the code serves its whole range.
    ///
    /// # Errors
    /// If a formula is constant or undefined everywhere.
    pub fn rebound(
        &self,
        document: &Document,
        region: &Region,
    ) -> Option<Result<Self, ProgramError>> {
        let within =
            |(wanted, made): (Interval, Interval)| made.lo <= wanted.lo && wanted.hi <= made.hi;
        if !view::bounds(region).into_iter().zip(self.program.domain()).all(within) {
            return None;
        }
        let program = self.program.rebound(document)?;
        Some(program.map(|program| {
            let curves = curves::trace(document, region);
            Self::of(program, document, region, curves.into(), self.precision, None)
        }))
    }

    /// The same model for a further picture, for which nothing is simplified or compiled.
    #[must_use]
    pub fn again(self) -> Self {
        Self { times: None, ..self }
    }

    /// Returns whether the code was compiled for another model.
    pub fn is_rebound(&self) -> bool {
        self.times.is_none()
    }

    /// The region that is searched for surfaces.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// Curves and points in the region.
    pub fn curves(&self) -> &TracedCurves {
        &self.curves
    }

    /// The surfaces' functions and their kernels.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The look of pictures with these settings.
    pub fn look(&self, settings: &Settings) -> &'static Look {
        settings.look.or(self.setting.look).unwrap_or_default()
    }

    /// The camera that the document chooses.
    pub(crate) fn camera(&self) -> CameraChoice {
        self.setting.camera
    }

    /// Returns whether a picture with these settings has a ground.
    pub(crate) fn has_ground(&self, settings: &Settings) -> bool {
        self.choices(settings).ground == Some(true) && settings.normals.is_some()
    }

    /// The choices of pictures with these settings.
    pub(crate) fn choices(&self, settings: &Settings) -> Choices {
        settings.choices.or(self.setting.lines.choices)
    }

    /// The light that casts shadows, in the displayed space.
    pub(crate) fn key_light(&self, settings: &Settings, rays: &RayGrid) -> Light {
        let typed = self.setting.lines.light.as_ref();
        let typed = typed.map(|place| place.each_ref().map(nearest).into());
        match settings.light.or(typed) {
            Some(place) => Light::Positional(place * rays.stretch()),
            None => Light::above_left(rays),
        }
    }

    /// Returns whether a picture with these settings has a transparent background.
    pub fn is_transparent(&self, settings: &Settings) -> bool {
        settings.is_transparent(self.setting.background)
    }

    /// Number of surfaces.
    pub fn surfaces(&self) -> usize {
        self.styles.len()
    }

    /// Indices of the visible surfaces.
    pub fn visible_surfaces(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.surfaces()).filter(|surface| !self.styles[*surface].hidden)
    }

    /// Indices of the visible equations and solids.
    fn visible_functions(&self) -> impl Iterator<Item = usize> + '_ {
        self.visible_surfaces().filter(|surface| self.program.patch(*surface).is_none())
    }

    /// Precision of the kernels, unless a picture asks for another.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Returns the value and the gradient of a surface's function at a point. The function is the
    /// typed one or a [simpler one](Program::is_reduced) with the same zeros. The point is rounded
    /// to the model's precision, or to `f64` for [`Precision::Auto`]. All results are NaN if there
    /// is no such surface, or its code fails to compile.
    pub fn sample(&self, surface: usize, point: DVec3) -> (f64, [f64; 3]) {
        self.sample_of(&self.program, surface, point)
    }

    /// Like [`Model::sample`], but always for the typed function. `document` is the model's
    /// document.
    pub fn sample_typed(
        &self,
        document: &Document,
        surface: usize,
        point: DVec3,
    ) -> (f64, [f64; 3]) {
        let has_function = surface < self.surfaces() && self.program.patch(surface).is_none();
        let is_other = has_function && self.program.is_reduced(surface);
        if !is_other {
            return self.sample(surface, point);
        }
        let typed = Program::unchecked(document, view::bounds(&self.region));
        typed.map_or(UNKNOWN, |typed| self.sample_of(&typed, surface, point))
    }

    fn sample_of(&self, program: &Program, surface: usize, point: DVec3) -> (f64, [f64; 3]) {
        let sample = match self.precision {
            Precision::F32 => sample::<f32>,
            Precision::Auto | Precision::F64 => sample::<f64>,
        };
        let values = (surface < self.surfaces()).then(|| sample(program.surface(surface), point));
        values.flatten().unwrap_or(UNKNOWN)
    }

    /// Returns whether an eye in the region is on a visible surface, as far as bounds of functions
    /// tell.
    fn meets_eye(&self, eye: DVec3) -> bool {
        let (low, high) = (self.region.low(), self.region.high());
        if !(low.cmple(eye).all() && eye.cmple(high).all()) {
            return false;
        }
        let domain = eye.to_array().map(|along| Interval { lo: along, hi: along });
        let assumptions = Assumptions { domain, parameters: self.program.values().to_vec() };
        let (graph, roots) = (self.program.graph(), self.program.roots());
        let bounds = zeroset_eval::enclose_all(graph, roots, &assumptions);
        self.visible_functions().any(|surface| bounds[surface].0.contains(0.0))
    }

    /// Returns whether some visible surface's function cannot be distinguished from 0 at each of
    /// [`FLAT_POINTS`] points of the region. Such a function is 0 everywhere, or smaller than its
    /// rounding errors.
    fn is_flat<T: KernelFloat>(&self) -> Result<bool, ProgramError> {
        let (low, high) = (self.region.low(), self.region.high());
        let points = (1..=FLAT_POINTS).map(|n| {
            let place = (FLAT_STEPS * n as f64).fract();
            let at = low + (high - low) * place;
            at.to_array().map(|c| T::nearest(c).into()).map(|c| Interval { lo: c, hi: c })
        });
        let boxes = Boxes::<T>::around(&points.collect::<Vec<_>>());
        // For so few points, interpreting is faster than compiling.
        let program = self.program.on(Evaluator::Reference);
        for surface in self.visible_functions() {
            let zeros = program.kernels::<T>(surface).zeros()?;
            let flat = zeros.eval_all(&boxes).iter().zip(&boxes).all(|(zeros, boxes)| {
                let all = u16::MAX >> (u16::BITS - boxes.count);
                zeros.possible & !zeros.jumping & all == all
            });
            if flat {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Draws a picture, to the end or until the settings' budget is used up.
    ///
    /// # Errors
    /// As [`Model::trace`].
    pub fn picture(&self, camera: &Camera, settings: &Settings) -> Result<Picture, ProgramError> {
        self.trace(camera, settings, &|_| true)
    }
}

/// A segment shorter than this share of the longest bracket may stay undecided in a preview, and on
/// rays that only affect colors.
const PREVIEWED: f64 = 1.0 / 32.0;

/// Method options for the rays of a picture, for a solid or another surface.
fn options(settings: &Settings, is_solid: bool) -> TraceOptions {
    TraceOptions {
        least: if settings.is_preview { PREVIEWED } else { 0.0 },
        is_solid,
        ..settings.options
    }
}

/// Compiles the kernels that pictures of a surface need, in parallel, while `wanted` returns true.
///
/// # Errors
/// If a kernel fails to compile.
///
/// # Panics
/// If there is no such surface.
pub fn make_kernels<T: KernelFloat>(
    program: &Program,
    surface: usize,
    is_solid: bool,
    region: &Region,
    settings: &Settings,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<(), ProgramError> {
    if let Some(patch) = program.patch(surface) {
        let normals = || match settings.normals {
            Some(_) if wanted() => patch.normals().map(drop),
            Some(_) | None => Ok(()),
        };
        return Ok(patch.tree().map(drop).and_then(|()| normals())?);
    }
    let kernels = program.kernels::<T>(surface);
    let traced = || {
        if !wanted() {
            return Ok(());
        }
        let options = options(settings, is_solid);
        settings.method.prepare(program.surface(surface), region, options).map(drop)
    };
    let other = || match settings.normals {
        _ if !wanted() => Ok(()),
        None => Ok(()),
        Some(Normals::Gradient) => kernels.gradients().map(|_| ()),
        Some(Normals::Central) => kernels.values().map(|_| ()),
    };
    let bounds = || {
        if is_solid && wanted() {
            return kernels.bounds().map(|_| ());
        }
        Ok(())
    };
    let (traced, (other, bounds)) = rayon::join(traced, || rayon::join(other, bounds));
    Ok(traced.and(other).and(bounds)?)
}

/// Result for a value and gradient that cannot be computed.
const UNKNOWN: (f64, [f64; 3]) = (f64::NAN, [f64::NAN; 3]);

fn sample<T: KernelFloat>(surface: &dyn SurfaceKernels, point: DVec3) -> Option<(f64, [f64; 3])> {
    let out = T::kernels(surface).gradients().ok()?.eval_all(&Points::near(&[point.to_array()]));
    Some((out[0].value[0].into(), out[0].gradient.map(|lanes| lanes[0].into())))
}

/// Draws all surfaces of `document` in `region` from `camera`.
///
/// # Errors
/// As [`Model::new`].
pub fn render(
    document: &Document,
    region: &Region,
    camera: &Camera,
    settings: &Settings,
) -> Result<Picture, ProgramError> {
    Model::new(document, region, settings)?.picture(camera, settings)
}

/// Number of points at which a function is tested for being 0 everywhere.
const FLAT_POINTS: usize = 64;
/// Multiples of these numbers, modulo 1, fill a cube evenly (Roberts 2018, generalized golden
/// ratios).
const FLAT_STEPS: DVec3 = DVec3::new(0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9);

/// Measures the times of consecutive stages.
struct Stopwatch(Instant);

impl Stopwatch {
    fn start() -> Self {
        Self(Instant::now())
    }

    fn lap(&mut self) -> Duration {
        let now = Instant::now();
        let lap = now - self.0;
        self.0 = now;
        lap
    }
}
