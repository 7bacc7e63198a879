//! zeroset beside fidget on models of many parts: time against the number of parts, and ratios on
//! larger solids.

pub mod models;

use crate::measure::{Times, measure_within};
use crate::ours::{ZerosetSide, settings};
use crate::side::Side;
use crate::surfaces::Surface;
use crate::voxels::Voxels;
use anyhow::{Context, Result};
use clap::Args;
use clap::builder::PossibleValuesParser;
use fidget::jit::JitFunction;
use fidget::vm::VmFunction;
use models::{BLENDED, PartsModel, SPHERES, of_file, solids, spheres};
use serde::Serialize;
use std::path::PathBuf;
use zeroset_ir::Node;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_shade::Pattern;
use zeroset_testkit::machine::{processor, threads};
use zeroset_trace::Method;

/// Arguments of `parts`.
#[derive(Args)]
pub struct PartsArguments {
    /// Numbers of spheres, separated by commas, from few to many; 0 for no spheres
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "10,100,1000,10000",
        value_name = "NUMBERS"
    )]
    parts: Vec<usize>,
    /// Omit the solids
    #[arg(long)]
    no_solids: bool,
    /// Further models; the domain must be a cube around the origin
    #[arg(long, value_name = "FILES", num_args = 1..)]
    files: Vec<PathBuf>,
    /// Sides, separated by commas; all if not given
    #[arg(long, value_delimiter = ',',
        value_parser = PossibleValuesParser::new(PARTS_SIDES.iter().map(|side| side.name)))]
    sides: Vec<String>,
    /// Side of the square pictures, in pixels
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=8192))]
    size: u32,
    /// Most rounds per model; every side draws once in each
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Seconds per model, after which no round begins
    #[arg(long, default_value_t = 60.0)]
    budget: f64,
    /// A side that needs more seconds for a picture is left out of larger models of the family
    #[arg(long, default_value_t = 20.0)]
    limit: f64,
    /// File for the rows, as CSV; `zeroset-chart parts` draws it
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// A side of this run.
struct PartsSide {
    name: &'static str,
    prepare: fn(&'static str, &Surface, usize) -> Result<Box<dyn Side + Send>>,
}

/// All sides of this run.
const PARTS_SIDES: [PartsSide; 6] = [
    PartsSide {
        name: "affine",
        prepare: |name, surface, size| traced(name, "affine", 1, surface, size),
    },
    PartsSide {
        name: "smooth",
        prepare: |name, surface, size| traced(name, "affine", SMOOTH, surface, size),
    },
    PartsSide {
        name: "knoll",
        prepare: |name, surface, size| traced(name, "knoll", 1, surface, size),
    },
    PartsSide {
        name: "compile",
        prepare: |name, surface, size| {
            let settings = settings(Method::named("affine").expect("the default"), size);
            let (text, half) = (surface.text.to_string(), surface.half);
            let surface = Surface { name: name.into(), half, text: text.into(), ..*surface };
            Ok(Box::new(Compiled { surface, settings }))
        },
    },
    PartsSide {
        name: "fidget JIT",
        prepare: |name, surface, size| {
            Ok(Box::new(Voxels::<JitFunction>::new(name.into(), surface, None, size, false)?))
        },
    },
    PartsSide {
        name: "fidget VM",
        prepare: |name, surface, size| {
            Ok(Box::new(Voxels::<VmFunction>::new(name.into(), surface, None, size, false)?))
        },
    },
];

/// Rays along edges of the side `smooth`, as of the command line's pictures.
const SMOOTH: usize = 16;

/// Operations from which on a solid counts for the mean of ratios.
const LARGE: usize = 500;

fn traced(
    name: &'static str,
    method: &str,
    rays: usize,
    surface: &Surface,
    size: usize,
) -> Result<Box<dyn Side + Send>> {
    let method = Method::named(method).expect("a method");
    let antialias = Pattern::of(rays).expect("a pattern");
    let settings = Settings { antialias, ..settings(method, size) };
    Ok(Box::new(ZerosetSide::with(name, surface, settings)?))
}

/// From text to everything that a picture needs.
struct Compiled {
    surface: Surface,
    settings: Settings,
}

impl Side for Compiled {
    fn name(&self) -> String {
        self.surface.name.to_string()
    }

    fn size(&self) -> usize {
        self.settings.width
    }

    fn draw(&mut self) -> Result<()> {
        let (document, region) = (self.surface.document()?, self.surface.region()?);
        Model::new(&document, &region, &self.settings)?;
        Ok(())
    }

    fn distances(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// A line of the table.
#[derive(Serialize)]
struct PartsRow<'a> {
    family: &'a str,
    parts: Option<usize>,
    operations: usize,
    side: String,
    /// Median of the processor times of a picture.
    milliseconds: f64,
    /// Half the interquartile range, as a share of the median.
    spread: f64,
    rounds: usize,
    /// Median of the rounds' ratios to the time of the first side.
    ratio: f64,
    /// Number of drawn pixels.
    drawn: usize,
    /// Number of undecided pixels, for a side that decides.
    undecided: Option<usize>,
    /// Number of pixels that only this side draws, or only the first.
    differing: usize,
    processor: String,
}

/// Measures all models, and prints a table.
///
/// # Errors
/// If a model is not valid, a side cannot draw, or the rows cannot be written.
pub fn run(arguments: &PartsArguments) -> Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!("{}, 1 of {} threads", processor(), threads());
    println!(
        "{0}×{0} pixels and {0}³ voxels, processor time, medians of interleaved rounds; smooth: {SMOOTH} rays \
         along edges;\ncompile: from text to a model; /: time over that of the first side; differ: pixels that one \
         of both draws\n",
        arguments.size
    );
    println!(
        "{:16}{:>7}{:>8} {:12}{:>11}{:>6}{:>7}{:>8}{:>9}{:>10}{:>8}",
        "model", "parts", "ops", "side", "ms", "± %", "rounds", "/", "drawn", "undecided", "differ"
    );
    let mut csv = arguments.output.as_deref().map(csv::Writer::from_path).transpose()?;
    let (mut ratios, mut slow) = (Vec::new(), Vec::new());
    for model in arguments.models()? {
        let rows = pool.install(|| arguments.rows(&model, &mut slow));
        let rows = rows.with_context(|| model.family.clone())?;
        for row in rows {
            if ![SPHERES, BLENDED].contains(&row.family) && row.operations >= LARGE {
                ratios.push((row.side.clone(), row.ratio));
            }
            if let Some(csv) = &mut csv {
                csv.serialize(row)?;
                csv.flush()?;
            }
        }
        println!();
    }
    println!("Geometric means of / over solids of at least {LARGE} operations:");
    for PartsSide { name, .. } in &PARTS_SIDES {
        let own = ratios.iter().filter(|(side, _)| side == name);
        let logarithms: Vec<f64> = own.map(|(_, ratio)| ratio.ln()).collect();
        if !logarithms.is_empty() {
            let mean = logarithms.iter().sum::<f64>() / logarithms.len() as f64;
            println!("{name:12}{:8.2} over {}", mean.exp(), logarithms.len());
        }
    }
    Ok(())
}

impl PartsArguments {
    fn models(&self) -> Result<Vec<PartsModel>> {
        let mut models = Vec::new();
        for family in [SPHERES, BLENDED] {
            let parts = self.parts.iter().filter(|parts| **parts > 0);
            models.extend(parts.map(|parts| spheres(*parts, family)));
        }
        if !self.no_solids {
            models.extend(solids());
        }
        for file in &self.files {
            models.push(of_file(file)?);
        }
        Ok(models)
    }

    /// Measures and prints a model. `slow` has the families and sides that are not measured any
    /// more.
    fn rows<'a>(
        &self,
        model: &'a PartsModel,
        slow: &mut Vec<(String, String)>,
    ) -> Result<Vec<PartsRow<'a>>> {
        let PartsModel { family, parts, surface } = model;
        let document = surface.document()?;
        let needed = document.graph.reachable(&[document.surfaces[0].root]);
        let is_operation = |(id, node): &(zeroset_ir::NodeId, &Node)| {
            needed[id.index()] && matches!(node, Node::Apply(..))
        };
        let operations = document.graph.iter().filter(is_operation).count();
        drop(document);
        let mut sides = Vec::new();
        for PartsSide { name, prepare } in &PARTS_SIDES {
            let is_wanted = self.sides.is_empty() || self.sides.iter().any(|side| side == name);
            if !is_wanted || slow.iter().any(|(of, side)| of == family && side == name) {
                continue;
            }
            match prepare(*name, surface, self.size as usize) {
                Ok(side) => sides.push(side),
                Err(error) => println!("{family:16}{:15} {name}: {error:#}", ""),
            }
        }
        if sides.is_empty() {
            return Ok(Vec::new());
        }
        let times = measure_within(&mut sides, self.rounds as usize, self.budget)?;
        let first: Vec<bool> = drawn(&*sides[0]);
        let mut rows = Vec::new();
        for (side, own) in sides.iter().zip(&times) {
            let row = PartsRow {
                family,
                parts: *parts,
                operations,
                side: side.name(),
                milliseconds: own.median() * 1e3,
                spread: own.spread(),
                rounds: own.rounds(),
                ratio: own.ratio(&times[0]),
                drawn: drawn(&**side).iter().filter(|drawn| **drawn).count(),
                undecided: side.pixels().map(|pixels| pixels.undecided),
                differing: drawn(&**side).iter().zip(&first).filter(|(a, b)| a != b).count(),
                processor: processor(),
            };
            row.print(own);
            if let Some(note) = side.note() {
                println!("{:32}{note}", "");
            }
            if own.median() > self.limit {
                slow.push((family.clone(), row.side.clone()));
            }
            rows.push(row);
        }
        Ok(rows)
    }
}

/// Returns which pixels of the last picture show something. Empty if the side draws nothing.
fn drawn(side: &dyn Side) -> Vec<bool> {
    side.distances().into_iter().map(f64::is_finite).collect()
}

impl PartsRow<'_> {
    fn print(&self, times: &Times) {
        let parts = self.parts.map_or("-".to_owned(), |parts| parts.to_string());
        let undecided = self.undecided.map_or("-".to_owned(), |count| count.to_string());
        println!(
            "{:16}{parts:>7}{:>8} {:12}{:>11.1}{:>6.1}{:>7}{:>8.2}{:>9}{undecided:>10}{:>8}",
            self.family,
            self.operations,
            self.side,
            self.milliseconds,
            times.spread() * 100.0,
            self.rounds,
            self.ratio,
            self.drawn,
            self.differing,
        );
    }
}
