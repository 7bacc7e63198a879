//! Surfaces compiled once, of which pictures can be taken from anywhere.

use crate::picture::{Normals, Picture, Precision, Settings, Statistics, Times};
use crate::program::{CodeSize, Program, ProgramError};
use crate::scene;
use crate::uniforms::Bound;
use crate::work::{Counted, Work};
use crate::zeros::ZeroKernel;
use glam::DVec3;
use rayon::prelude::*;
use std::time::{Duration, Instant};
use zeroset_eval::{
    BoxPacket, EnclosurePacket, GradientKernel, GradientPacket, IntervalKernel, LANES, PointKernel,
    PointPacket, Real, ValuePacket,
};
use zeroset_interval::{Facts, Interval};
use zeroset_jit::{NativeGradient, NativePoint};
use zeroset_syntax::{Document, SrgbColor, SurfaceKind};
use zeroset_trace::{
    Appearance, Camera, Colour, Frame, GBuffer, Knoll, Light, NormalSource, Region, Scalar,
    SurfaceColours, cap, normals, shade,
};

/// All surfaces of a document over one region, as native code. The code is freed when the model is dropped.
pub struct Model {
    region: Region,
    program: Program,
    looks: Vec<Look>,
    kernels: AllKernels,
    /// Time to simplify and to compile; none if that was done for another model.
    times: Option<Times>,
}

/// What of a surface is not its function.
struct Look {
    kind: SurfaceKind,
    color: Option<SrgbColor>,
}

/// The kernels of all surfaces.
enum AllKernels {
    F32(Vec<Kernels<f32>>),
    F64(Vec<Kernels<f64>>),
}

/// The kernels of one surface.
struct Kernels<T: Real> {
    zeros: ZeroKernel<T>,
    normals: Option<NormalKernel<T>>,
}

enum NormalKernel<T: Real> {
    Gradient(Bound<NativeGradient<T>>),
    Central(Bound<NativePoint<T>>),
}

impl Model {
    /// Compiles all surfaces of `document` in `region`, with what `normals` asks for, in this precision.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere, or too large to compile.
    ///
    /// # Panics
    /// Never: the model is wanted to the end.
    pub fn new(
        document: &Document,
        region: &Region,
        normals: Option<Normals>,
        precision: Precision,
    ) -> Result<Self, ProgramError> {
        let model = Self::new_while(document, region, normals, precision, &|| true)?;
        Ok(model.expect("wanted to the end"))
    }

    /// As [`Model::new`], but asks between kernels whether the model is still wanted; `None` if not.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere, or too large to compile.
    pub fn new_while(
        document: &Document,
        region: &Region,
        normals: Option<Normals>,
        precision: Precision,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Self>, ProgramError> {
        let mut watch = Stopwatch::start();
        let mut times = Times::default();
        let program = Program::new(document, scene::bounds(region))?;
        times.simplify = watch.lap();
        let surfaces = document.surfaces.len();
        let kernels = match precision {
            Precision::F32 => {
                compile_all(&program, surfaces, normals, wanted)?.map(AllKernels::F32)
            }
            Precision::F64 => {
                compile_all(&program, surfaces, normals, wanted)?.map(AllKernels::F64)
            }
        };
        let Some(kernels) = kernels else { return Ok(None) };
        times.compile = watch.lap();
        Ok(Some(Self {
            region: *region,
            looks: looks(document).collect(),
            kernels,
            program,
            times: Some(times),
        }))
    }

    /// The same code for the parameter values of another document, or `None` if that differs in more than values and
    /// colours, or if the values are beyond what the code was made for; a slider may be set to anything in its range.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere.
    pub fn rebound(&self, document: &Document) -> Option<Result<Self, ProgramError>> {
        let program = match self.program.rebound(document)? {
            Ok(program) => program,
            Err(error) => return Some(Err(error)),
        };
        let kernels = match &self.kernels {
            AllKernels::F32(kernels) => AllKernels::F32(with(kernels, program.values())?),
            AllKernels::F64(kernels) => AllKernels::F64(with(kernels, program.values())?),
        };
        let looks = looks(document).collect();
        Some(Ok(Self { region: self.region, program, looks, kernels, times: None }))
    }

    /// Whether both run the same code, all of it compiled once.
    pub fn shares_code(&self, other: &Self) -> bool {
        match (&self.kernels, &other.kernels) {
            (AllKernels::F32(one), AllKernels::F32(other)) => all_share_code(one, other),
            (AllKernels::F64(one), AllKernels::F64(other)) => all_share_code(one, other),
            (AllKernels::F32(_), AllKernels::F64(_)) | (AllKernels::F64(_), AllKernels::F32(_)) => {
                false
            }
        }
    }

    /// Whether the code was made for another model.
    pub fn is_rebound(&self) -> bool {
        self.times.is_none()
    }

    /// Where the surfaces are looked for.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// How many surfaces there are.
    pub fn surfaces(&self) -> usize {
        self.looks.len()
    }

    /// The floats that its code computes in.
    pub fn precision(&self) -> Precision {
        match self.kernels {
            AllKernels::F32(_) => Precision::F32,
            AllKernels::F64(_) => Precision::F64,
        }
    }

    /// Value and gradient of a surface's function at a point, which is rounded to the model's precision; the gradient is
    /// NaN if the model was compiled without one, and everything is NaN if there is no such surface.
    pub fn sample(&self, surface: usize, point: DVec3) -> (f64, [f64; 3]) {
        let values = match &self.kernels {
            AllKernels::F32(kernels) => kernels.get(surface).and_then(|k| k.sample(point)),
            AllKernels::F64(kernels) => kernels.get(surface).and_then(|k| k.sample(point)),
        };
        values.unwrap_or((f64::NAN, [f64::NAN; 3]))
    }

    /// Whether the function of some surface cannot be told from 0 at any of some points strewn over the region: then either
    /// it is 0 everywhere, or far too small for its own rounding.
    fn is_flat<T: Real>(&self, all: &[Kernels<T>]) -> bool {
        let (low, high) = (self.region.low(), self.region.high());
        let points = (1..=FLAT_POINTS).map(|n| {
            let place = (FLAT_STEPS * n as f64).fract();
            (low + (high - low) * place).to_array().map(T::nearest)
        });
        let boxes: Vec<BoxPacket<T>> = points
            .map(|at| BoxPacket { neg_lo: at.map(|c| [-c; LANES]), hi: at.map(|c| [c; LANES]) })
            .collect();
        all.iter().any(|kernels| {
            let mut out = vec![EnclosurePacket::default(); boxes.len()];
            kernels.zeros.function().enclose(&boxes, &mut out);
            out.iter().all(|packet| {
                let (defined, zero) = (packet.facts(0).has(Facts::DEFINED), T::default());
                defined && packet.neg_lo[0] >= zero && packet.hi[0] >= zero
            })
        })
    }

    /// Takes a picture. `advance` is told how many pixels of how many surfaces were finished since it was last called,
    /// and ends the work early by returning `false`: the picture then is incomplete and of no use.
    ///
    /// `settings.normals` counts only in so far as the model was compiled for them.
    pub fn trace(
        &self,
        camera: &Camera,
        settings: &Settings,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> Picture {
        match &self.kernels {
            AllKernels::F32(kernels) => self.trace_with(kernels, camera, settings, advance),
            AllKernels::F64(kernels) => self.trace_with(kernels, camera, settings, advance),
        }
    }

    fn trace_with<T: Scalar>(
        &self,
        all: &[Kernels<T>],
        camera: &Camera,
        settings: &Settings,
        advance: &(dyn Fn(usize) -> bool + Sync),
    ) -> Picture {
        let region = &self.region;
        let mut watch = Stopwatch::start();
        let mut times = self.times.unwrap_or_default();
        let frame = camera.frame(settings.width, settings.height);
        let light = match settings.light {
            Some(place) => Light::Positional(place),
            None => Light::above_left(&frame),
        };
        let mut work = Work::default();
        // At a pole a surface has no point, but a solid may have a face.
        let method = |depth, kind| Knoll {
            depth,
            width: settings.packet,
            suppress_asymptotes: kind == SurfaceKind::Equation,
        };
        let mut buffer = GBuffer::new(settings.width, settings.height, 0);
        for (index, (look, kernels)) in self.looks.iter().zip(all).enumerate() {
            let (mut layer, done) = method(settings.max_depth, look.kind).trace(
                &frame,
                region,
                &kernels.zeros,
                advance,
            );
            layer.surface.fill(index as u16);
            work.add_traversal(&done);
            if look.kind == SurfaceKind::Solid {
                let counted = Counted::new(kernels.zeros.function());
                cap(&mut layer, &frame, region, &counted);
                work.interval += counted.count();
            }
            times.trace += watch.lap();
            fill_normals(&mut layer, &frame, region, kernels, &mut work);
            // One layer at a time, so that many surfaces take no more memory than one.
            if index == 0 {
                buffer = layer;
            } else {
                buffer.merge(&layer);
            }
            times.shade += watch.lap();
            if !advance(0) {
                break;
            }
        }

        if let Some(depth) = settings.shadow_depth {
            // A slab of the last depth may lie on either side of the surface that it holds.
            let offset =
                2.0 * region.half_extent() * SHADOW_OFFSET_SLABS * 0.5_f64.powi(depth as i32);
            let mut hidden = vec![false; settings.width * settings.height];
            for (look, kernels) in self.looks.iter().zip(all) {
                let zeros = &kernels.zeros;
                let done = method(depth, look.kind).shadows(
                    &mut buffer,
                    &frame,
                    region,
                    zeros,
                    &light,
                    offset,
                    &|| advance(0),
                );
                work.add_traversal(&done);
                hidden.iter_mut().zip(&buffer.shadow).for_each(|(all, this)| *all |= this);
                if !advance(0) {
                    break;
                }
            }
            buffer.shadow = hidden;
            times.trace += watch.lap();
        }

        let rgb = match settings.normals {
            Some(_) => shade(&buffer, &frame, &appearance(&self.looks, settings, light)),
            None => Vec::new(),
        };
        times.shade += watch.lap();
        let statistics = Statistics {
            times,
            pixels: buffer.counts(),
            work,
            code_bytes: all.iter().map(Kernels::code_bytes).sum(),
            nodes: self.program.nodes(),
        };
        let undefined = (0..self.looks.len()).any(|surface| self.program.is_undefined(surface));
        let (precision, flat) = (self.precision(), self.is_flat(all));
        Picture { buffer, rgb, precision, statistics, undefined, flat }
    }
}

/// The kernels of all surfaces, or `None` if they are no longer wanted before all are there.
fn compile_all<T: Real>(
    program: &Program,
    surfaces: usize,
    normals: Option<Normals>,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Vec<Kernels<T>>>, ProgramError> {
    let spent = CodeSize::default();
    let compile = |surface| {
        // Another surface may have used up what there is.
        spent.add(0)?;
        if !wanted() {
            return Ok(None);
        }
        let kernels = compile(program, surface, normals, wanted)?;
        spent.add(kernels.as_ref().map_or(0, Kernels::code_bytes))?;
        Ok(kernels)
    };
    (0..surfaces).into_par_iter().map(compile).collect()
}

/// The same code for other parameter values, or `None` if it does not hold for them.
fn with<T: Real>(kernels: &[Kernels<T>], parameters: &[Interval]) -> Option<Vec<Kernels<T>>> {
    kernels.iter().map(|kernels| kernels.with(parameters)).collect()
}

fn all_share_code<T: Real>(one: &[Kernels<T>], other: &[Kernels<T>]) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| one.shares_code(other))
}

/// The kernels of one surface, or `None` if they are no longer wanted before all are there.
fn compile<T: Real>(
    program: &Program,
    surface: usize,
    normals: Option<Normals>,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Kernels<T>>, ProgramError> {
    let (zeros, normals) = rayon::join(
        || program.zero_kernel(surface),
        || match normals {
            None => Ok(None),
            Some(_) if !wanted() => Ok(None),
            Some(Normals::Gradient) => {
                program.bound_gradient(surface).map(|k| Some(NormalKernel::Gradient(k)))
            }
            Some(Normals::Central) => {
                program.bound_point(surface).map(|k| Some(NormalKernel::Central(k)))
            }
        },
    );
    let kernels = Kernels { zeros: zeros?, normals: normals? };
    Ok(wanted().then_some(kernels))
}

fn looks(document: &Document) -> impl Iterator<Item = Look> {
    document.surfaces.iter().map(|surface| Look { kind: surface.kind, color: surface.color })
}

impl<T: Real> Kernels<T> {
    /// Whether both run the same code, compiled once.
    fn shares_code(&self, other: &Self) -> bool {
        let normals = match (&self.normals, &other.normals) {
            (Some(NormalKernel::Gradient(one)), Some(NormalKernel::Gradient(other))) => {
                one.shares_code(other)
            }
            (Some(NormalKernel::Central(one)), Some(NormalKernel::Central(other))) => {
                one.shares_code(other)
            }
            (None, None) => true,
            _ => false,
        };
        normals && self.zeros.shares_code(&other.zeros)
    }

    /// Value and gradient at a point; `None` if there is no code for either, NaN for a gradient alone.
    fn sample(&self, point: DVec3) -> Option<(f64, [f64; 3])> {
        let at = PointPacket { at: point.to_array().map(|c| [T::nearest(c); LANES]) };
        Some(match self.normals.as_ref()? {
            NormalKernel::Gradient(bound) => {
                let mut out = [GradientPacket::default()];
                bound.kernel.gradient(&[at], &mut out);
                (out[0].value[0].into(), out[0].gradient.map(|lanes| lanes[0].into()))
            }
            NormalKernel::Central(bound) => {
                let mut out = [ValuePacket::default()];
                bound.kernel.sample(&[at], &mut out);
                (out[0].value[0].into(), [f64::NAN; 3])
            }
        })
    }

    /// The same code for other parameter values, or `None` if it does not hold for them.
    fn with(&self, parameters: &[Interval]) -> Option<Self> {
        let normals = match &self.normals {
            Some(NormalKernel::Gradient(bound)) => {
                Some(NormalKernel::Gradient(bound.with(parameters)?))
            }
            Some(NormalKernel::Central(bound)) => {
                Some(NormalKernel::Central(bound.with(parameters)?))
            }
            None => None,
        };
        Some(Self { zeros: self.zeros.with(parameters)?, normals })
    }

    fn code_bytes(&self) -> usize {
        let normals = match &self.normals {
            Some(NormalKernel::Gradient(bound)) => bound.kernel.code_bytes(),
            Some(NormalKernel::Central(bound)) => bound.kernel.code_bytes(),
            None => 0,
        };
        self.zeros.code_bytes() + normals
    }
}

/// At so many points a function is looked at to see whether it is 0 everywhere.
const FLAT_POINTS: usize = 64;
/// Multiples of these fractions fill a cube evenly (Roberts 2018, generalised golden ratios).
const FLAT_STEPS: DVec3 = DVec3::new(0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9);

/// Shadow rays start this many of their own slabs away from the surface, so that it does not shade itself.
const SHADOW_OFFSET_SLABS: f64 = 2.0;

/// Reach of central differences, as a share of the domain's largest extent.
const STEP: f64 = 1e-3;

fn fill_normals<T: Real>(
    layer: &mut GBuffer,
    frame: &Frame,
    region: &Region,
    kernels: &Kernels<T>,
    work: &mut Work,
) {
    let step = 2.0 * region.half_extent() * STEP;
    match &kernels.normals {
        Some(NormalKernel::Gradient(bound)) => {
            let counted = Counted::new(&bound.kernel);
            normals(layer, frame, NormalSource::Gradient(&counted), step);
            work.gradient += counted.count();
        }
        Some(NormalKernel::Central(bound)) => {
            let counted = Counted::new(&bound.kernel);
            normals(layer, frame, NormalSource::Central(&counted), step);
            work.point += counted.count();
        }
        None => {}
    }
}

fn appearance(looks: &[Look], settings: &Settings, light: Light) -> Appearance {
    let plain = Appearance::new(light);
    let surfaces = looks.iter().enumerate().map(|(index, look)| {
        match look.color {
            // One colour typed serves both sides; the side where f < 0 is darker.
            Some(color) => {
                let positive = Colour::from_srgb(color.rgb);
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
