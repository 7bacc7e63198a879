//! Traces given or random rays by methods and by the certified tracer, and writes the results for
//! comparison with other programs.

use crate::arguments::RaysArguments;
use crate::error::ChartError;
use crate::files::write;
use crate::surfaces::ChartSurface;
use crate::truth::{Truth, certify};
use crate::views::{direction, rng};
use glam::DVec3;
use std::fmt::Write as _;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::time::Instant;
use zeroset_scene::program::Program;
use zeroset_scene::view::bounds;
use zeroset_space::{Ray, Region};
use zeroset_testkit::npy;
use zeroset_trace::{KernelStats, Method, RayResult, Segment, Start, Status, TraceOptions};

/// Evaluations of the function per ray by the certified tracer.
const BUDGET: u32 = 20_000;

/// Numbers per ray in a file: origin and direction.
const COLUMNS: usize = 6;

/// Traces the rays and writes the results. Returns a line for each method, with its time and its
/// number of false claims.
///
/// # Errors
/// If the surface is unknown or a solid, the file has no rays, or a result cannot be written.
pub fn rays(arguments: &RaysArguments) -> Result<String, ChartError> {
    let RaysArguments { surface, output, within, .. } = arguments;
    let surface = ChartSurface::named(surface)?;
    if surface.is_solid() {
        let why = "a solid has faces, too; rays are followed to surfaces only";
        return Err(ChartError::of_surface(&surface.name)(why));
    }
    let rays = match &arguments.rays {
        Some(path) => read(path)?,
        None => random(&surface.region, arguments.random, arguments.seed),
    };
    let row = |ray: &Ray| [ray.origin.to_array(), ray.direction.to_array()].concat();
    save(output, "rays", COLUMNS, &rays.iter().flat_map(row).collect::<Vec<_>>())?;
    let ends = surface.bounds();
    save(output, "domain", 2, ends.as_flattened())?;
    let truths = certify(&surface, &rays, BUDGET)?;
    save(output, "certified", 3, &truths.iter().flat_map(certain).collect::<Vec<_>>())?;

    let refuse = ChartError::of_surface(&surface.name);
    let program = Program::new(&surface.document, bounds(&surface.region)).map_err(refuse)?;
    let within = within * (surface.region.high() - surface.region.low()).length();
    let mut said = String::new();
    for method in arguments.methods.chosen() {
        let (found, nanoseconds) = follow(method, &surface, &program, &rays, within)?;
        let rows = found.iter().zip(&rays).flat_map(|(found, ray)| place(found, ray));
        save(output, method.name, 4, &rows.collect::<Vec<_>>())?;
        let count = |status| found.iter().filter(|found| found.status == status).count();
        let [hits, misses, undecided] = [Status::Hit, Status::Miss, Status::Undecided].map(count);
        let is_wrong =
            |((found, ray), truth): &((&RayResult, &Ray), &Truth)| is_false(found, ray, truth);
        let wrong = found.iter().zip(&rays).zip(&truths).filter(is_wrong).count();
        // Writing to a string cannot fail.
        let _ = writeln!(
            said,
            "{:10}{nanoseconds:8.0} ns a ray: {hits} hits, {misses} misses, {undecided} undecided; {wrong} false",
            method.name
        );
    }
    Ok(said)
}

fn read(path: &Path) -> Result<Vec<Ray>, ChartError> {
    let file = File::open(path).map_err(ChartError::of_file(path))?;
    let array = npy::read_f64(BufReader::new(file)).map_err(ChartError::of_content(path))?;
    let refuse = ChartError::of_content(path);
    if array.shape.len() != 2 || array.shape[1] != COLUMNS as u64 {
        let shape = array.shape.iter().map(u64::to_string).collect::<Vec<_>>().join("×");
        return Err(refuse(format!("{shape} numbers, where rays are rows of {COLUMNS}")));
    }
    let rows = array.data.as_chunks::<COLUMNS>().0;
    let ray = |&[x, y, z, u, v, w]: &[f64; COLUMNS]| Ray {
        origin: DVec3::new(x, y, z),
        direction: DVec3::new(u, v, w),
    };
    let rays: Vec<Ray> = rows.iter().map(ray).collect();
    let is_ray = |ray: &Ray| {
        let length = ray.direction.length();
        ray.origin.is_finite() && length.is_finite() && length > 0.0
    };
    match rays.iter().position(|ray| !is_ray(ray)) {
        Some(row) => Err(refuse(format!(
            "row {row} is no ray: its direction is 0, or a number is not finite"
        ))),
        None => Ok(rays),
    }
}

/// Random rays from a sphere around the region to points in it.
fn random(region: &Region, count: usize, seed: u64) -> Vec<Ray> {
    let mut rng = rng(&format!("{seed} rays"));
    let (low, extent) = (region.low(), region.high() - region.low());
    let ray = |_| {
        let origin = region.centre() + extent.length() * direction(&mut rng);
        let at = low + extent * DVec3::new(rng.f64(), rng.f64(), rng.f64());
        Ray { origin, direction: at - origin }
    };
    (0..count).map(ray).collect()
}

/// A method's results, and its time per ray in nanoseconds. The time excludes compilation.
fn follow(
    method: &Method,
    surface: &ChartSurface,
    program: &Program,
    rays: &[Ray],
    within: f64,
) -> Result<(Vec<RayResult>, f64), ChartError> {
    // The tolerance is one pixel. Each segment below has a pixel that is `within` wide.
    let options = TraceOptions { tolerance: 1.0, depth: 16, ..TraceOptions::default() };
    let tracer = method
        .prepare(program.surface(0), &surface.region, options)
        .map_err(ChartError::of_surface(&surface.name))?;
    let segment = |ray: &Ray| Segment {
        ray: *ray,
        to: f64::INFINITY,
        pixel: [within / ray.direction.length(), 0.0],
    };
    let segments: Vec<Segment> = rays.iter().map(segment).collect();
    let mut found = vec![RayResult::UNSEEN; rays.len()];
    let mut time = f64::INFINITY;
    // The first pass may still compile code, so the shorter time of two passes counts.
    for _ in 0..2 {
        let start = Instant::now();
        tracer.follow(&segments, Start::Anywhere, &mut found, &mut KernelStats::default());
        time = time.min(start.elapsed().as_secs_f64());
    }
    Ok((found, time * 1e9 / rays.len().max(1) as f64))
}

/// A row of a method's file: status, bracket and drawn distance.
fn place(found: &RayResult, ray: &Ray) -> [f64; 4] {
    let [near, far] = found.bracket.map(|t| ray.distance(t));
    let drawn = if found.drawn.is_finite() { ray.distance(found.drawn) } else { f64::NAN };
    [f64::from(found.status as u8), near, far, drawn]
}

/// A row of the certified tracer's file: kind of truth and bounds of the root.
fn certain(truth: &Truth) -> [f64; 3] {
    match truth {
        Truth::Miss => [0.0, f64::NAN, f64::NAN],
        Truth::Root(root) => {
            let ends = root.pieces.first().zip(root.pieces.last());
            let (near, far) =
                ends.map_or((f64::NAN, f64::NAN), |(first, last)| (first[0], last[1]));
            [1.0, near, far]
        }
        Truth::Open => [2.0, f64::NAN, f64::NAN],
    }
}

/// Whether a claim of the method contradicts the certified tracer.
fn is_false(found: &RayResult, ray: &Ray, truth: &Truth) -> bool {
    match (found.status, truth) {
        (Status::Undecided, _) | (_, Truth::Open) | (Status::Miss, Truth::Miss) => false,
        (Status::Miss, Truth::Root(_)) | (Status::Hit, Truth::Miss) => true,
        (Status::Hit, Truth::Root(root)) => {
            let bracket = found.bracket.map(|t| ray.distance(t));
            // A hit without a bracket claims only that there is a root.
            let meets = |piece: &[f64; 2]| piece[0] <= bracket[1] && bracket[0] <= piece[1];
            bracket[0].is_finite() && !root.pieces.iter().any(meets)
        }
    }
}

fn save(directory: &Path, name: &str, columns: usize, data: &[f64]) -> Result<(), ChartError> {
    let path = directory.join(format!("{name}.npy"));
    let bytes = npy::write_f64(columns, data).map_err(ChartError::of_content(&path))?;
    write(&path, &bytes)
}
