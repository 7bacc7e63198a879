//! Compares zeroset with its rivals in one process, with the same surfaces, views, sizes and
//! threads.
//!
//! [README.md](../README.md) explains what is measured.

mod knoll2007;
mod measure;
mod meshes;
mod ours;
mod parts;
mod reference;
mod report;
mod scaling;
mod side;
mod surfaces;
mod traps;
mod voxels;

use anyhow::{Context, Result};
use clap::builder::PossibleValuesParser;
use clap::{Parser, Subcommand};
use fidget::jit::JitFunction;
use knoll2007::{Knoll2007, PACKET_WIDTHS};
use measure::measure;
use meshes::MeshesArguments;
use ours::ZerosetSide;
use parts::PartsArguments;
use reference::{Entries, Reference};
use report::{Report, Row};
use scaling::Pooled;
use side::Side;
use std::collections::{BTreeMap, BTreeSet};
use surfaces::{SURFACES, Surface};
use traps::TrapsArguments;
use voxels::Voxels;
use zeroset_testkit::machine::{processor, threads};
use zeroset_trace::{METHODS, Method};

/// Compare zeroset with its rivals.
#[derive(Parser)]
#[command(args_conflicts_with_subcommands = true)]
struct Arguments {
    #[command(subcommand)]
    run: Option<Run>,
    /// Surfaces, separated by commas; all if not given
    #[arg(long, value_delimiter = ',', value_parser = names(SURFACES.iter().map(|s| &*s.name)))]
    surfaces: Vec<String>,
    /// Methods of zeroset, separated by commas; all if not given
    #[arg(long, value_delimiter = ',', value_parser = names(METHODS.iter().map(|m| m.name)))]
    methods: Vec<String>,
    /// Side of the square pictures, in pixels
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=8192))]
    size: u32,
    /// Number of rounds; every renderer draws once in each
    #[arg(long, default_value_t = 15, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// Number of threads
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// Compare zeroset's methods only: a picture on one thread, a picture on N threads, and N
    /// pictures at once with a thread each
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1024))]
    scaling: Option<u32>,
    /// Number of halvings of the domain along a ray, for the C++ and for methods with a depth
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=20))]
    depth: u32,
    /// Sizes of fidget's pictures in voxels along an edge, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "128,256,512,1024", value_name = "SIZES",
        value_parser = clap::value_parser!(u32).range(16..=4096))]
    fidget: Vec<u32>,
    /// Omit the C++
    #[arg(long)]
    no_cpp: bool,
    /// Omit fidget
    #[arg(long)]
    no_fidget: bool,
    /// Rows and columns of pixels at which errors are measured; 0 for none
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(0..=8192))]
    samples: u32,
}

/// Runs with tables of their own.
#[derive(Subcommand)]
enum Run {
    /// Compare zeroset with fidget on models of many parts, on one thread
    Parts(PartsArguments),
    /// Compare zeroset's meshes with fidget's, on one thread
    Meshes(MeshesArguments),
    /// Compare the shapes of both meshes where samples miss parts of a surface
    Traps(TrapsArguments),
}

fn names(names: impl Iterator<Item = &'static str>) -> PossibleValuesParser {
    PossibleValuesParser::new(names)
}

impl Arguments {
    fn surfaces(&self) -> impl Iterator<Item = &'static Surface> {
        SURFACES
            .iter()
            .filter(|s| self.surfaces.is_empty() || self.surfaces.iter().any(|n| *n == s.name))
    }

    fn methods(&self) -> impl Iterator<Item = &'static Method> {
        METHODS
            .iter()
            .filter(|m| self.methods.is_empty() || self.methods.iter().any(|n| n == m.name))
    }

    /// Returns all renderers that can draw the surface, zeroset's methods first.
    fn sides(&self, surface: &Surface) -> Result<Vec<Box<dyn Side + Send>>> {
        let (size, depth) = (self.size as usize, self.depth);
        let mut sides: Vec<Box<dyn Side + Send>> = Vec::new();
        if let Some(threads) = self.scaling {
            let threads = threads as usize;
            for (pictures, threads) in [(1, 1), (1, threads), (threads, 1)] {
                for method in self.methods() {
                    let picture = |_| ZerosetSide::new(surface, method, size, depth);
                    let pictures = (0..pictures).map(picture).collect::<Result<_>>()?;
                    sides.push(Box::new(Pooled::new(pictures, threads)?));
                }
            }
            return Ok(sides);
        }
        for method in self.methods() {
            sides.push(Box::new(ZerosetSide::new(surface, method, size, depth)?));
        }
        for width in PACKET_WIDTHS.iter().filter(|_| !self.no_cpp) {
            if let Some(side) = Knoll2007::new(width, &surface.name, size, depth)? {
                sides.push(Box::new(side));
            }
        }
        if !self.no_fidget {
            let entries = Entries::new(surface, ENTRIES)?;
            for size in &self.fidget {
                let (name, size) = (format!("fidget {size}³"), *size as usize);
                let is_parallel = self.threads > 1;
                let side =
                    Voxels::<JitFunction>::new(name, surface, Some(entries), size, is_parallel)?;
                sides.push(Box::new(side));
            }
        }
        Ok(sides)
    }

    /// Returns certified results for each size of the renderers' pictures.
    fn references(
        &self,
        surface: &Surface,
        sides: &[Box<dyn Side + Send>],
    ) -> Result<BTreeMap<usize, Reference>> {
        let samples = self.samples as usize;
        let sizes = sides.iter().map(|side| side.size()).filter(|_| samples > 0);
        // Renderers that draw pictures of the same size share a reference.
        let sizes: BTreeSet<usize> = sizes.collect();
        let reference = |size| Ok((size, Reference::new(surface, size, samples)?));
        sizes.into_iter().map(reference).collect()
    }
}

/// Rows and columns of rays that sample the sign of f where they enter the domain.
const ENTRIES: usize = 64;

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    match &arguments.run {
        Some(Run::Parts(arguments)) => return parts::run(arguments),
        Some(Run::Meshes(arguments)) => return meshes::run(arguments),
        Some(Run::Traps(arguments)) => return traps::run(arguments),
        None => {}
    }
    let threads = arguments.threads as usize;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    print_head(&arguments);
    let methods: Vec<String> = arguments.methods().map(|method| method.name.to_owned()).collect();
    let mut report = Report::new(methods.clone());
    for surface in arguments.surfaces() {
        let mut sides = arguments.sides(surface).with_context(|| surface.name.to_string())?;
        let rounds = arguments.rounds as usize;
        let times = match arguments.scaling {
            // Each renderer draws with its own thread pool.
            Some(_) => measure(&mut sides, rounds),
            None => pool.install(|| measure(&mut sides, rounds)),
        };
        let times = times.with_context(|| surface.name.to_string())?;
        let ratios = times.iter().map(|own| times[..methods.len()].iter().map(|m| own.ratio(m)));
        let ratios: Vec<Vec<f64>> = ratios.map(Iterator::collect).collect();
        let references =
            arguments.references(surface, &sides).with_context(|| surface.name.to_string())?;
        for ((side, times), ratios) in sides.iter().zip(times).zip(ratios) {
            let reference = references.get(&side.size());
            let errors = reference.map(|reference| reference.errors(&side.distances()));
            let (side, enclosure_calls, remark) =
                (side.name(), side.enclosure_calls(), side.remark());
            report.add(&surface.name, Row { side, times, errors, enclosure_calls, ratios, remark });
        }
        if let Some(reference) = references.get(&(arguments.size as usize)) {
            let [none, roots, open] = reference.counts();
            println!(
                "{:12}of the rays looked at, {roots} have a root, {none} have none, {open} are open",
                ""
            );
        }
        println!();
    }
    report.summarise();
    Ok(())
}

fn print_head(arguments: &Arguments) {
    println!("{}, {} of {} threads", processor(), arguments.threads, threads());
    println!("C++ by {} {}", env!("RIVALS_COMPILER"), env!("RIVALS_FLAGS"));
    if PACKET_WIDTHS.len() < 2 {
        println!("no C++ on 16 lanes: the processor has no AVX-512");
    }
    println!(
        "{0}×{0} pixels, depth {1}, medians of {2} interleaved rounds; ratios are a side's time over a method's\n\
         rootless, missed: of {3}×{3} rays, those drawn without a root, and not drawn with one; off: \
         median distance of what is drawn from the first root, in half extents of the domain; boxes: \
         how many were evaluated\n",
        arguments.size, arguments.depth, arguments.rounds, arguments.samples
    );
}
