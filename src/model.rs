//! Surfaces compiled once, of which pictures can be taken from anywhere.

use crate::picture::{Normals, Picture, Settings, Statistics, Times};
use crate::program::{Program, ProgramError};
use crate::scene;
use crate::work::{Counted, Work};
use crate::zeros::ZeroKernel;
use glam::DVec3;
use rayon::prelude::*;
use std::time::{Duration, Instant};
use zeroset_eval::{GradientKernel, GradientPacket, LANES, PointKernel, PointPacket, ValuePacket};
use zeroset_jit::{NativeGradient, NativePoint};
use zeroset_syntax::{Color, Document, Kind};
use zeroset_trace::{
    Appearance, Camera, Colour, Frame, GBuffer, Knoll, Light, NormalSource, Region, SurfaceColours,
    cap, normals, shade,
};

/// All surfaces of a document over one region, as native code. The code is freed when the model is dropped.
pub struct Model {
    region: Region,
    surfaces: Vec<(Look, Kernels)>,
    /// Nodes of the graph as typed, and after simplification.
    nodes: (usize, usize),
    undefined: bool,
    /// Time to simplify and to compile.
    times: Times,
}

/// What of a surface is not its function.
struct Look {
    kind: Kind,
    color: Option<Color>,
}

/// The kernels of one surface.
struct Kernels {
    zeros: ZeroKernel,
    normals: Option<NormalKernel>,
}

enum NormalKernel {
    Gradient(NativeGradient),
    Central(NativePoint),
}

impl Model {
    /// Compiles all surfaces of `document` in `region`, with what `normals` asks for.
    ///
    /// # Errors
    /// If a formula is constant or defined nowhere, or too large to compile.
    pub fn new(
        document: &Document,
        region: &Region,
        normals: Option<Normals>,
    ) -> Result<Self, ProgramError> {
        let mut watch = Stopwatch::start();
        let mut times = Times::default();
        let program = Program::new(document, scene::bounds(region))?;
        times.simplify = watch.lap();
        let kernels = (0..document.surfaces.len())
            .into_par_iter()
            .map(|surface| compile(&program, surface, normals))
            .collect::<Result<Vec<_>, _>>()?;
        times.compile = watch.lap();
        let looks = document
            .surfaces
            .iter()
            .map(|surface| Look { kind: surface.kind, color: surface.color });
        Ok(Self {
            region: *region,
            undefined: (0..kernels.len()).any(|surface| program.is_undefined(surface)),
            surfaces: looks.zip(kernels).collect(),
            nodes: program.nodes(),
            times,
        })
    }

    /// Where the surfaces are looked for.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// How many surfaces there are.
    pub fn surfaces(&self) -> usize {
        self.surfaces.len()
    }

    /// Value and gradient of a surface's function at a point, rounded to nearest; the gradient is NaN if the model was
    /// compiled without one, and everything is NaN if there is no such surface.
    pub fn sample(&self, surface: usize, point: DVec3) -> (f32, [f32; 3]) {
        let at = PointPacket { at: point.to_array().map(|c| [c as f32; LANES]) };
        match self.surfaces.get(surface).and_then(|(_, kernels)| kernels.normals.as_ref()) {
            Some(NormalKernel::Gradient(kernel)) => {
                let mut out = [GradientPacket::default()];
                kernel.gradient(&[at], &mut out);
                (out[0].value[0], out[0].gradient.map(|lanes| lanes[0]))
            }
            Some(NormalKernel::Central(kernel)) => {
                let mut out = [ValuePacket::default()];
                kernel.sample(&[at], &mut out);
                (out[0].value[0], [f32::NAN; 3])
            }
            None => (f32::NAN, [f32::NAN; 3]),
        }
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
        let region = &self.region;
        let mut watch = Stopwatch::start();
        let mut times = self.times;
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
            suppress_asymptotes: kind == Kind::Equation,
        };
        let mut buffer = GBuffer::new(settings.width, settings.height, 0);
        for (index, (look, kernels)) in self.surfaces.iter().enumerate() {
            let (mut layer, done) = method(settings.max_depth, look.kind).trace(
                &frame,
                region,
                &kernels.zeros,
                advance,
            );
            layer.surface.fill(index as u16);
            work.add_traversal(&done);
            if look.kind == Kind::Solid {
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
            for (look, kernels) in &self.surfaces {
                let zeros = &kernels.zeros;
                let done = method(depth, look.kind).shadows(
                    &mut buffer,
                    &frame,
                    region,
                    zeros,
                    &light,
                    offset,
                );
                work.add_traversal(&done);
                hidden.iter_mut().zip(&buffer.shadow).for_each(|(all, this)| *all |= this);
            }
            buffer.shadow = hidden;
            times.trace += watch.lap();
        }

        let rgb = match settings.normals {
            Some(_) => {
                let looks = self.surfaces.iter().map(|(look, _)| look);
                shade(&buffer, &frame, &appearance(looks, settings, light))
            }
            None => Vec::new(),
        };
        times.shade += watch.lap();
        let statistics = Statistics {
            times,
            pixels: buffer.counts(),
            work,
            code_bytes: self.surfaces.iter().map(|(_, kernels)| kernels.code_bytes()).sum(),
            nodes: self.nodes,
        };
        Picture { buffer, rgb, statistics, undefined: self.undefined }
    }
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

fn appearance<'a>(
    looks: impl Iterator<Item = &'a Look>,
    settings: &Settings,
    light: Light,
) -> Appearance {
    let plain = Appearance::new(light);
    let surfaces = looks.enumerate().map(|(index, look)| {
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
