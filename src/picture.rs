//! From a document to a picture: simplify, compile, trace, shade, and account for all of it.

use crate::program::{Program, ProgramError};
use crate::scene;
use crate::work::{Counted, Work};
use crate::zeros::ZeroKernel;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use zeroset_jit::{NativeGradient, NativePoint};
use zeroset_syntax::{Document, Kind};
use zeroset_trace::{
    Appearance, Camera, Colour, Frame, GBuffer, Knoll, Light, NormalSource, PacketWidth,
    PixelCounts, Region, SurfaceColours, UndecidedStyle, cap, normals, shade,
};

/// How a picture is made.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Pixels in a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// How often a ray's way through the domain is halved.
    pub max_depth: u32,
    /// How many rays advance together.
    pub packet: PacketWidth,
    /// The same depth for shadow rays; `None` for no shadows.
    pub shadow_depth: Option<u32>,
    /// Where normals come from; `None` if neither colours nor normals are wanted.
    pub normals: Option<Normals>,
    /// How undecided pixels are drawn.
    pub undecided: UndecidedStyle,
    /// The light's place; `None` for far above and left of the camera.
    pub light: Option<DVec3>,
    /// Share of the light that comes from everywhere, within [0, 1].
    pub ambient: f32,
    /// Shown where there is nothing; `None` for the default.
    pub background: Option<Colour>,
}

/// Where normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normals {
    /// The exact derivative.
    Gradient,
    /// Differences of values, as in Knoll et al. 2007.
    Central,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            max_depth: 10,
            packet: PacketWidth::Four,
            shadow_depth: None,
            normals: Some(Normals::Gradient),
            undecided: UndecidedStyle::Shade,
            light: None,
            ambient: 0.3,
            background: None,
        }
    }
}

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Picture {
    /// What is known of each pixel.
    pub buffer: GBuffer,
    /// Red, green and blue bytes (sRGB) of each pixel; empty if colours were not asked for.
    pub rgb: Vec<u8>,
    /// What it took.
    pub statistics: Statistics,
    /// Whether some surface is proven to have no value anywhere in the domain.
    pub undefined: bool,
}

/// What a picture took to make.
#[derive(Clone, Debug, Default)]
pub struct Statistics {
    /// Time to simplify, compile, trace and shade.
    pub times: Times,
    /// Pixels by what is proven.
    pub pixels: PixelCounts,
    /// Calls of kernels and lanes they computed.
    pub work: Work,
    /// Size of all machine code, in bytes.
    pub code_bytes: usize,
    /// Nodes of the graph as typed, and after simplification.
    pub nodes: (usize, usize),
}

/// Wall-clock times of the stages.
#[derive(Clone, Copy, Debug, Default)]
pub struct Times {
    /// Graph to simplified graph.
    pub simplify: Duration,
    /// Graph to native code.
    pub compile: Duration,
    /// Rays to distances.
    pub trace: Duration,
    /// Distances to normals and colours.
    pub shade: Duration,
}

/// Told how many of how many pixels are done, from several threads.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// The kernels of one surface.
struct Kernels {
    zeros: ZeroKernel,
    normals: Option<NormalKernel>,
}

enum NormalKernel {
    Gradient(NativeGradient),
    Central(NativePoint),
}

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
    let mut watch = Stopwatch::start();
    let mut times = Times::default();

    let program = Program::new(document, scene::bounds(region))?;
    times.simplify = watch.lap();

    let surfaces = document.surfaces.len();
    let kernels = (0..surfaces)
        .into_par_iter()
        .map(|surface| compile(&program, surface, settings.normals))
        .collect::<Result<Vec<_>, _>>()?;
    let code_bytes = kernels.iter().map(Kernels::code_bytes).sum();
    times.compile = watch.lap();

    let frame = camera.frame(settings.width, settings.height);
    let light = match settings.light {
        Some(place) => Light::Positional(place),
        None => Light::above_left(&frame),
    };
    let mut work = Work::default();
    let pixels = settings.width * settings.height;
    let done = AtomicUsize::new(0);
    let advance = |pixels_done: usize| {
        let done = done.fetch_add(pixels_done, Ordering::Relaxed) + pixels_done;
        progress(done, pixels * surfaces);
        true
    };
    let method = |depth| Knoll { depth, width: settings.packet, ..Knoll::default() };
    let mut buffer = GBuffer::new(settings.width, settings.height, 0);
    for (index, (surface, kernels)) in document.surfaces.iter().zip(&kernels).enumerate() {
        let (mut layer, done) =
            method(settings.max_depth).trace(&frame, region, &kernels.zeros, &advance);
        layer.surface.fill(index as u16);
        work.add_traversal(&done);
        if surface.kind == Kind::Solid {
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
    }

    if let Some(depth) = settings.shadow_depth {
        // A slab of the last depth may lie on either side of the surface that it holds.
        let offset = 2.0 * region.half_extent() * SHADOW_OFFSET_SLABS * 0.5_f64.powi(depth as i32);
        let mut hidden = vec![false; pixels];
        for kernels in &kernels {
            let done =
                method(depth).shadows(&mut buffer, &frame, region, &kernels.zeros, &light, offset);
            work.add_traversal(&done);
            hidden.iter_mut().zip(&buffer.shadow).for_each(|(all, this)| *all |= this);
        }
        buffer.shadow = hidden;
        times.trace += watch.lap();
    }

    let rgb = match settings.normals {
        Some(_) => shade(&buffer, &frame, &appearance(document, settings, light)),
        None => Vec::new(),
    };
    times.shade += watch.lap();
    let statistics =
        Statistics { times, pixels: buffer.counts(), work, code_bytes, nodes: program.nodes() };
    let undefined = (0..surfaces).any(|surface| program.is_undefined(surface));
    Ok(Picture { buffer, rgb, statistics, undefined })
}

fn compile(
    program: &Program,
    surface: usize,
    normals: Option<Normals>,
) -> Result<Kernels, ProgramError> {
    let (zeros, normals) = rayon::join(
        || program.zero_kernel(surface),
        || match normals {
            None => Ok(None),
            Some(Normals::Gradient) => {
                program.gradient_kernel(surface).map(|k| Some(NormalKernel::Gradient(k)))
            }
            Some(Normals::Central) => {
                program.point_kernel(surface).map(|k| Some(NormalKernel::Central(k)))
            }
        },
    );
    Ok(Kernels { zeros: zeros?, normals: normals? })
}

impl Kernels {
    fn code_bytes(&self) -> usize {
        let normals = match &self.normals {
            Some(NormalKernel::Gradient(kernel)) => kernel.code_bytes(),
            Some(NormalKernel::Central(kernel)) => kernel.code_bytes(),
            None => 0,
        };
        self.zeros.code_bytes() + normals
    }
}

/// Shadow rays start this many of their own slabs away from the surface, so that it does not shade itself.
const SHADOW_OFFSET_SLABS: f64 = 2.0;

/// Reach of central differences, as a share of the domain's largest extent.
const STEP: f64 = 1e-3;

fn fill_normals(
    layer: &mut GBuffer,
    frame: &Frame,
    region: &Region,
    kernels: &Kernels,
    work: &mut Work,
) {
    let step = 2.0 * region.half_extent() * STEP;
    match &kernels.normals {
        Some(NormalKernel::Gradient(kernel)) => {
            let counted = Counted::new(kernel);
            normals(layer, frame, NormalSource::Gradient(&counted), step);
            work.gradient += counted.count();
        }
        Some(NormalKernel::Central(kernel)) => {
            let counted = Counted::new(kernel);
            normals(layer, frame, NormalSource::Central(&counted), step);
            work.point += counted.count();
        }
        None => {}
    }
}

fn appearance(document: &Document, settings: &Settings, light: Light) -> Appearance {
    let plain = Appearance::new(light);
    let surfaces = document.surfaces.iter().enumerate().map(|(index, surface)| {
        match surface.color {
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
