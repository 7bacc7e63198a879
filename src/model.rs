//! Surfaces over one region, of which pictures can be taken from anywhere.

use crate::picture::{Normals, Picture, Precision, Settings, Statistics, Times};
use crate::program::{Program, ProgramError};
use crate::scene;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use zeroset_eval::{Boxes, KernelFloat, Points, Surface};
use zeroset_interval::Interval;
use zeroset_syntax::{Document, SrgbColor, SurfaceKind};
use zeroset_trace::{
    Appearance, Camera, Driver, GBuffer, Light, LinearRgb, NormalSource, Options, Region,
    SurfaceColours, Work, cap, normals, shade,
};

/// All surfaces of a document over one region. Kernels are made as pictures ask for them, and freed with the last model
/// that shares them.
pub struct Model {
    region: Region,
    program: Program,
    styles: Vec<Style>,
    remarks: Vec<String>,
    /// What kernels compute in, unless a picture asks for something else.
    precision: Precision,
    /// Time to simplify and to compile; none if that was done for another model.
    times: Option<Times>,
}

/// What of a surface is not its function.
struct Style {
    kind: SurfaceKind,
    color: Option<SrgbColor>,
}

impl Model {
    /// Simplifies all surfaces of `document` in `region`, and compiles what a picture by the default method needs with
    /// these normals in this precision.
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
        let model = Self::new_while(document, region, settings, &|| true)?;
        Ok(model.expect("wanted to the end"))
    }

    /// As [`Model::new`], but asks between kernels whether the model is still wanted; `None` if not.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere, or too large to compile.
    pub fn new_while(
        document: &Document,
        region: &Region,
        settings: &Settings,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Self>, ProgramError> {
        let precision = settings.precision;
        let mut watch = Stopwatch::start();
        let mut times = Times::default();
        let program = Program::new(document, scene::bounds(region))?;
        times.simplify = watch.lap();
        let made = match precision {
            Precision::Auto | Precision::F32 => {
                make_kernels::<f32>(&program, document, region, settings, wanted)?
            }
            Precision::F64 => make_kernels::<f64>(&program, document, region, settings, wanted)?,
        };
        if !made {
            return Ok(None);
        }
        times.compile = watch.lap();
        let (region, styles) = (*region, styles(document));
        let (remarks, times) = (program.remarks(document), Some(times));
        Ok(Some(Self { region, program, styles, remarks, precision, times }))
    }

    /// The same code for the parameter values of another document, or `None` if that differs in more than values and
    /// colours, or if the values are beyond what the code was made for; a slider may be set to anything in its range.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere.
    pub fn rebound(&self, document: &Document) -> Option<Result<Self, ProgramError>> {
        let (region, precision) = (self.region, self.precision);
        let program = self.program.rebound(document)?;
        let styles = styles(document);
        Some(program.map(|program| {
            let remarks = program.remarks(document);
            Self { region, program, styles, remarks, precision, times: None }
        }))
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

    /// How many surfaces there are.
    pub fn surfaces(&self) -> usize {
        self.styles.len()
    }

    /// The floats that its kernels compute in unless a picture asks for others.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// Value and gradient of a surface's function at a point, which is rounded to the model's precision, to `f64` if that is
    /// [`Precision::Auto`]; everything is NaN if there is no such surface, or no code for it.
    pub fn sample(&self, surface: usize, point: DVec3) -> (f64, [f64; 3]) {
        let values = (surface < self.surfaces()).then(|| self.program.surface(surface));
        let values = values.and_then(|surface| match self.precision {
            Precision::F32 => sample::<f32>(surface, point),
            Precision::Auto | Precision::F64 => sample::<f64>(surface, point),
        });
        values.unwrap_or((f64::NAN, [f64::NAN; 3]))
    }

    /// Whether the function of some surface cannot be told from 0 at any of some points strewn over the region: then either
    /// it is 0 everywhere, or far too small for its own rounding.
    fn is_flat<T: KernelFloat>(&self) -> Result<bool, ProgramError> {
        let (low, high) = (self.region.low(), self.region.high());
        let points = (1..=FLAT_POINTS).map(|n| {
            let place = (FLAT_STEPS * n as f64).fract();
            let at = low + (high - low) * place;
            at.to_array().map(|c| T::nearest(c).into()).map(|c| Interval { lo: c, hi: c })
        });
        let boxes = Boxes::<T>::around(&points.collect::<Vec<_>>());
        for surface in 0..self.surfaces() {
            let zeros = self.program.kernels::<T>(surface).zeros()?;
            let flat = zeros.ask_all(&boxes).iter().zip(&boxes).all(|(zeros, boxes)| {
                let all = u16::MAX >> (u16::BITS - boxes.count);
                zeros.possible & !zeros.jumping & all == all
            });
            if flat {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Takes a picture. `advance` is told how many pixels of how many surfaces were finished since it was last called,
    /// and ends the work early by returning `false`, as the end of the settings' budget does: what was not reached then is
    /// undecided, and not painted.
    ///
    /// # Errors
    /// If a kernel is needed that cannot be made. What [`Model::new`] compiled is there already.
    pub fn trace(
        &self,
        camera: &Camera,
        settings: &Settings,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<Picture, ProgramError> {
        let end = settings.budget.and_then(|budget| Instant::now().checked_add(budget));
        let advance = |done| advance(done) && end.is_none_or(|end| Instant::now() < end);
        match settings.precision {
            Precision::Auto | Precision::F32 => self.trace_in::<f32>(camera, settings, &advance),
            Precision::F64 => self.trace_in::<f64>(camera, settings, &advance),
        }
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
        let pixels = settings.width * settings.height * self.surfaces();
        let done = AtomicUsize::new(0);
        let advance = |pixels_done: usize| {
            if pixels_done > 0 {
                let done = done.fetch_add(pixels_done, Ordering::Relaxed) + pixels_done;
                progress(done, pixels);
            }
            true
        };
        self.trace(camera, settings, &advance)
    }

    fn trace_in<T: KernelFloat>(
        &self,
        camera: &Camera,
        settings: &Settings,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<Picture, ProgramError> {
        let region = &self.region;
        let mut watch = Stopwatch::start();
        let mut times = self.times.unwrap_or_default();
        let rays = camera.rays(settings.width, settings.height);
        let light = match settings.light {
            Some(place) => Light::Positional(place),
            None => Light::above_left(&rays),
        };
        let mut work = Work::default();
        let tracer = |surface: usize, depth| {
            let options = options(settings, self.styles[surface].kind, depth);
            settings.method.prepare(self.program.surface(surface), region, options)
        };
        let mut picture: Option<GBuffer> = None;
        for (index, style) in self.styles.iter().enumerate() {
            let kernels = self.program.kernels::<T>(index);
            let tracer = tracer(index, settings.max_depth)?;
            let mut layer = GBuffer::new(settings.width, settings.height, 0);
            if settings.brackets {
                layer = layer.with_brackets();
            }
            work += Driver { rays: &rays, tracer: &*tracer, advance }.picture(&mut layer);
            layer.surface.fill(index as u16);
            if style.kind == SurfaceKind::Solid {
                work += cap(&mut layer, &rays, region, kernels.bounds()?);
            }
            times.trace += watch.lap();
            if let Some(kind) = settings.normals {
                let source = match kind {
                    Normals::Gradient => NormalSource::Gradient(kernels.gradients()?),
                    Normals::Central => NormalSource::Central(kernels.values()?),
                };
                let step = 2.0 * region.half_extent() * STEP;
                work += normals(&mut layer, &rays, source, step);
            }
            // One layer at a time, so that many surfaces take no more memory than one.
            match &mut picture {
                None => picture = Some(layer),
                Some(picture) => {
                    picture.merge(&layer);
                    layer.hand_back();
                }
            }
            times.shade += watch.lap();
            if !advance(0) {
                if let Some(picture) = picture.as_mut().filter(|_| index + 1 < self.surfaces()) {
                    picture.give_up();
                }
                break;
            }
        }

        let mut buffer =
            picture.unwrap_or_else(|| GBuffer::new(settings.width, settings.height, 0));
        if let Some(depth) = settings.shadow_depth {
            // A slab of the last depth may lie on either side of the surface that it holds.
            let offset =
                2.0 * region.half_extent() * SHADOW_OFFSET_SLABS * 0.5_f64.powi(depth as i32);
            let mut hidden = vec![false; settings.width * settings.height];
            // Shadows are no pixels finished.
            let wanted = |_| advance(0);
            for index in 0..self.surfaces() {
                let tracer = tracer(index, depth)?;
                let driver = Driver { rays: &rays, tracer: &*tracer, advance: &wanted };
                work += driver.shadows(&mut buffer, &light, offset);
                hidden.iter_mut().zip(&buffer.shadow).for_each(|(all, this)| *all |= this);
                if !advance(0) {
                    break;
                }
            }
            buffer.shadow = hidden;
            times.trace += watch.lap();
        }

        let rgb = match settings.normals {
            Some(_) => shade(&buffer, &rays, &appearance(&self.styles, settings, light)),
            None => Vec::new(),
        };
        times.shade += watch.lap();
        let made = self.program.made();
        let statistics = Statistics {
            times,
            pixels: buffer.counts(),
            work,
            code_bytes: made.iter().map(|made| made.bytes).sum(),
            kernels: made,
            nodes: self.program.nodes(),
        };
        let undefined = (0..self.surfaces()).any(|surface| self.program.is_undefined(surface));
        let (method, precision) = (settings.method, settings.precision);
        // Where it is 0 everywhere no ray through the region is decided.
        let flat = statistics.pixels.undecided > 0 && self.is_flat::<T>()?;
        let remarks = self.remarks.clone();
        Ok(Picture { buffer, rgb, method, precision, statistics, undefined, remarks, flat })
    }
}

fn options(settings: &Settings, kind: SurfaceKind, depth: u32) -> Options {
    let Settings { precision, tolerance, steps, ideas, .. } = *settings;
    // At a pole a surface has no point, but a solid may have a face.
    let suppress_asymptotes = kind == SurfaceKind::Equation;
    Options { precision, depth, tolerance, steps, suppress_asymptotes, ideas }
}

/// Makes the kernels that a picture needs, all at once; returns whether they were wanted to the end.
fn make_kernels<T: KernelFloat>(
    program: &Program,
    document: &Document,
    region: &Region,
    settings: &Settings,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<bool, ProgramError> {
    let one = |surface: usize| {
        let kernels = program.kernels::<T>(surface);
        let kind = document.surfaces[surface].kind;
        let traced = || {
            if !wanted() {
                return Ok(());
            }
            let options = options(settings, kind, settings.max_depth);
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
        traced.and(other).and(bounds)
    };
    (0..document.surfaces.len()).into_par_iter().map(one).collect::<Result<(), _>>()?;
    Ok(wanted())
}

fn sample<T: KernelFloat>(surface: &dyn Surface, point: DVec3) -> Option<(f64, [f64; 3])> {
    let out = T::kernels(surface).gradients().ok()?.ask_all(&Points::near(&[point.to_array()]));
    Some((out[0].value[0].into(), out[0].gradient.map(|lanes| lanes[0].into())))
}

fn styles(document: &Document) -> Vec<Style> {
    let style =
        |surface: &zeroset_syntax::Surface| Style { kind: surface.kind, color: surface.color };
    document.surfaces.iter().map(style).collect()
}

/// Told how many of how many pixels are done, from several threads.
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

/// Shadow rays start this many of their own slabs away from the surface, so that it does not shade itself.
const SHADOW_OFFSET_SLABS: f64 = 2.0;

/// Reach of central differences, as a share of the domain's largest extent.
const STEP: f64 = 1e-3;

fn appearance(styles: &[Style], settings: &Settings, light: Light) -> Appearance {
    let plain = Appearance::new(light);
    let surfaces = styles.iter().enumerate().map(|(index, style)| {
        match style.color {
            // One colour typed serves both sides; the side where f < 0 is darker.
            Some(color) => {
                let positive = LinearRgb::from_srgb(color.rgb);
                SurfaceColours { positive, negative: positive.lit(0.45, 0.0) }
            }
            None => SurfaceColours::default_for(index),
        }
    });
    Appearance {
        surfaces: surfaces.collect(),
        background: settings.background.unwrap_or(plain.background),
        ambient: settings.ambient,
        undecided: settings.undecided,
        ..plain
    }
}

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
