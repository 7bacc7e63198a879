//! Surfaces over one region, of which pictures can be taken from anywhere.

mod antialias;
mod layers;
mod paint;
mod strips;
mod trace;

pub use strips::Strip;

use crate::picture::{Normals, Picture, Precision, Settings, Times};
use glam::DVec3;
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use zeroset_eval::{Boxes, KernelFloat, Points, SurfaceKernels};
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Graph};
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::{Program, ProgramError};
use zeroset_scene::view;
use zeroset_space::Region;
use zeroset_style::Look;
use zeroset_syntax::{Document, PictureLines, PointValue, SrgbColor, SurfaceKind};
use zeroset_trace::{Camera, TraceOptions};

/// All surfaces of a document over one region. Kernels are made as pictures ask for them, and freed
/// with the last model that shares them.
pub struct Model {
    region: Region,
    program: Program,
    /// Of these what is not their function.
    styles: Vec<zeroset_syntax::Surface>,
    setting: Setting,
    remarks: Vec<String>,
    /// What kernels compute in, unless a picture asks for something else.
    precision: Precision,
    /// Time to simplify and to compile; none if that was done for another model.
    times: Option<Times>,
    /// Per surface, whether its negative side is the one seen from far away; found for the first
    /// picture that shows it.
    turned: Vec<OnceLock<bool>>,
}

/// What a document says of the picture.
struct Setting {
    look: Option<&'static Look>,
    background: Option<SrgbColor>,
    lines: PictureLines,
    /// What is the same along contour lines, if there are any, unless something else is said: z.
    height: Option<PointValue>,
    /// Values by number.
    parameters: Vec<f64>,
}

impl Setting {
    fn of(document: &Document) -> Self {
        let lines = &document.picture;
        let height = || {
            let mut graph = Graph::new();
            let root = graph.variable(Axis::Z);
            PointValue { graph, root, echo: "z".to_owned() }
        };
        let values = document.parameters.iter().map(|parameter| view::nearest(&parameter.value));
        Self {
            look: document.look.and_then(Look::named),
            background: document.background,
            lines: lines.clone(),
            height: lines.contours.is_some().then(height),
            parameters: values.collect(),
        }
    }
}

impl Model {
    /// Simplifies all surfaces of `document` in `region`, and compiles what a picture by the
    /// default method needs with these normals in this precision.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere, or too large to compile.
    ///
    /// # Panics
    /// Never: the model is wanted to the end.
    pub fn new(
        document: &Document,
        region: &Region,
        settings: &Settings,
    ) -> Result<Self, ProgramError> {
        let model = Self::new_while(document, region, region, settings, &|| true)?;
        Ok(model.expect("wanted to the end"))
    }

    /// As [`Model::new`], but asks between kernels whether the model is still wanted; `None` if
    /// not. The code is made for all of `reach`, which holds `region`.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere, or too large to compile.
    pub fn new_while(
        document: &Document,
        region: &Region,
        reach: &Region,
        settings: &Settings,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Self>, ProgramError> {
        let precision = settings.options.precision;
        let mut watch = Stopwatch::start();
        let mut times = Times::default();
        let program = Program::new(document, view::bounds(reach))?;
        times.simplify = watch.lap();
        let make = match precision {
            Precision::Auto | Precision::F32 => make_kernels::<f32>,
            Precision::F64 => make_kernels::<f64>,
        };
        let surfaces = document.surfaces.par_iter().enumerate();
        // Those of a hidden surface are made when it is first shown.
        let seen = surfaces.filter(|(_, surface)| !surface.hidden);
        seen.try_for_each(|(n, surface)| {
            make(&program, n, surface.kind, region, settings, wanted)
        })?;
        if !wanted() {
            return Ok(None);
        }
        times.compile = watch.lap();
        Ok(Some(Self::of(program, document, region, precision, Some(times))))
    }

    fn of(
        program: Program,
        document: &Document,
        region: &Region,
        precision: Precision,
        times: Option<Times>,
    ) -> Self {
        let styles = document.surfaces.clone();
        Self {
            region: *region,
            setting: Setting::of(document),
            remarks: program.remarks(document),
            program,
            precision,
            times,
            turned: vec![OnceLock::new(); styles.len()],
            styles,
        }
    }

    /// The same code for the parameter values of another document and in another region, or `None`
    /// if the document differs in more than values and colors, or if values or region are beyond
    /// what the code was made for; a slider may be set to anything in its range.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere.
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
        Some(program.map(|program| Self::of(program, document, region, self.precision, None)))
    }

    /// Whether the code was made for another model.
    pub fn is_rebound(&self) -> bool {
        self.times.is_none()
    }

    /// Where the surfaces are looked for.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// The surfaces' functions, and the kernels made of them.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The look of pictures with these settings.
    pub fn look(&self, settings: &Settings) -> &'static Look {
        settings.look.or(self.setting.look).unwrap_or_default()
    }

    /// How many surfaces there are.
    pub fn surfaces(&self) -> usize {
        self.styles.len()
    }

    /// Those that pictures show, by number.
    fn seen(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.surfaces()).filter(|surface| !self.styles[*surface].hidden)
    }

    /// The floats that its kernels compute in unless a picture asks for others.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Value and gradient at a point of the function whose zeros are drawn as a surface: the one
    /// typed or a [simpler one](Program::is_reduced). The point is rounded to the model's
    /// precision, to `f64` if that is [`Precision::Auto`]; everything is NaN if there is no such
    /// surface, or no code for it.
    pub fn sample(&self, surface: usize, point: DVec3) -> (f64, [f64; 3]) {
        self.sample_of(&self.program, surface, point)
    }

    /// The same of the function as typed. `document` is what the model was made of.
    pub fn sample_typed(
        &self,
        document: &Document,
        surface: usize,
        point: DVec3,
    ) -> (f64, [f64; 3]) {
        let is_other = surface < self.surfaces() && self.program.is_reduced(surface);
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

    /// Whether the function of some surface cannot be told from 0 at any of some points strewn over
    /// the region: then either it is 0 everywhere, or far too small for its own rounding.
    fn is_flat<T: KernelFloat>(&self) -> Result<bool, ProgramError> {
        let (low, high) = (self.region.low(), self.region.high());
        let points = (1..=FLAT_POINTS).map(|n| {
            let place = (FLAT_STEPS * n as f64).fract();
            let at = low + (high - low) * place;
            at.to_array().map(|c| T::nearest(c).into()).map(|c| Interval { lo: c, hi: c })
        });
        let boxes = Boxes::<T>::around(&points.collect::<Vec<_>>());
        // So few points take less time than compiling would.
        let program = self.program.on(Evaluator::Reference);
        for surface in self.seen() {
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

    /// Takes a picture, to the end or to that of the settings' budget.
    ///
    /// # Errors
    /// As [`Model::trace`].
    pub fn picture(
        &self,
        camera: &Camera,
        settings: &Settings,
        progress: Progress<'_>,
    ) -> Result<Picture, ProgramError> {
        let pixels = settings.width * settings.height * self.seen().count();
        let done = AtomicUsize::new(0);
        let advance = |pixels_done: usize| {
            let done = done.fetch_add(pixels_done, Ordering::Relaxed) + pixels_done;
            progress(done, pixels);
            true
        };
        self.trace(camera, settings, &advance)
    }
}

/// What stays open in a picture that another one follows, and on rays that are only for looks, as a
/// share of the longest bracket.
const PREVIEWED: f64 = 1.0 / 32.0;

/// The options of the method for a picture's own rays to a surface of this kind.
fn options(settings: &Settings, kind: SurfaceKind) -> TraceOptions {
    TraceOptions {
        least: if settings.is_preview { PREVIEWED } else { 0.0 },
        // At a pole a surface has no point, but a solid may have a face.
        suppress_asymptotes: kind == SurfaceKind::Equation,
        ..settings.options
    }
}

/// Makes the kernels that pictures of a surface need, all at once, as long as they are `wanted`.
///
/// # Errors
/// If one cannot be made.
///
/// # Panics
/// If there is no such surface.
pub fn make_kernels<T: KernelFloat>(
    program: &Program,
    surface: usize,
    kind: SurfaceKind,
    region: &Region,
    settings: &Settings,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<(), ProgramError> {
    let kernels = program.kernels::<T>(surface);
    let traced = || {
        if !wanted() {
            return Ok(());
        }
        let options = options(settings, kind);
        settings.method.prepare(program.surface(surface), region, options).map(drop)
    };
    let other = || match settings.normals {
        _ if !wanted() => Ok(()),
        None => Ok(()),
        Some(Normals::Gradient) => kernels.gradients().map(|_| ()),
        Some(Normals::Central) => kernels.values().map(|_| ()),
    };
    let bounds = || match kind {
        SurfaceKind::Solid if wanted() => kernels.bounds().map(|_| ()),
        SurfaceKind::Solid | SurfaceKind::Equation => Ok(()),
    };
    let (traced, (other, bounds)) = rayon::join(traced, || rayon::join(other, bounds));
    Ok(traced.and(other).and(bounds)?)
}

/// Value and gradient where nothing answers.
const UNKNOWN: (f64, [f64; 3]) = (f64::NAN, [f64::NAN; 3]);

fn sample<T: KernelFloat>(surface: &dyn SurfaceKernels, point: DVec3) -> Option<(f64, [f64; 3])> {
    let out = T::kernels(surface).gradients().ok()?.eval_all(&Points::near(&[point.to_array()]));
    Some((out[0].value[0].into(), out[0].gradient.map(|lanes| lanes[0].into())))
}

/// Told every now and then how many of how many pixels are done, from several threads.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// Renders all surfaces of `document` in `region` as seen by `camera`.
///
/// # Errors
/// If a formula is constant or defined nowhere, or too large to compile.
pub fn render(
    document: &Document,
    region: &Region,
    camera: &Camera,
    settings: &Settings,
    progress: Progress<'_>,
) -> Result<Picture, ProgramError> {
    Model::new(document, region, settings)?.picture(camera, settings, progress)
}

/// At so many points a function is looked at to see whether it is 0 everywhere.
const FLAT_POINTS: usize = 64;
/// Multiples of these fractions fill a cube evenly (Roberts 2018, generalised golden ratios).
const FLAT_STEPS: DVec3 = DVec3::new(0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9);

/// Measures one stage after another.
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
