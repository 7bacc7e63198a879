//! Times of pictures. In each round, every configuration draws once, in a random order.

use crate::error::ChartError;
use crate::grid::Configuration;
use crate::quantile::Quartiles;
use crate::surfaces::ChartSurface;
use crate::views::rng;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::time::{Duration, Instant};
use zeroset_render::picture::Picture;
use zeroset_space::Camera;

/// Times of one configuration in milliseconds, and its picture.
pub struct Measured {
    /// Simplifying and compiling for the first picture, without any reuse.
    pub compile: f64,
    /// The whole first picture, compiling included.
    pub cold: f64,
    /// Times of tracing rays.
    pub trace: Quartiles,
    /// Times of computing normals and colors.
    pub shade: Quartiles,
    /// Times of tracing and shading together.
    pub total: Quartiles,
    /// The first picture.
    pub picture: Picture,
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// A pool of this many threads, separate from the pool that computes references.
///
/// # Panics
/// If the system cannot create the threads.
pub fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("the system gives threads")
}

/// Measures all `configurations` from one view. Each configuration draws a first picture, a picture
/// to warm up, and `repeats` measured pictures. The time of the first picture includes compilation.
/// Calls `advance` after the first pictures and after each round.
///
/// # Errors
/// If a kernel cannot be compiled.
///
/// # Panics
/// If `repeats` is 0.
pub fn measure(
    surface: &ChartSurface,
    camera: &Camera,
    size: usize,
    configurations: &[Configuration],
    repeats: usize,
    seed: u64,
    advance: &dyn Fn(),
) -> Result<Vec<Measured>, ChartError> {
    assert!(repeats > 0, "no repeats, no times");
    let refuse = ChartError::of_surface(&surface.name);
    let mut first = Vec::new();
    for one in configurations {
        let (settings, start) = (one.settings(size), Instant::now());
        let model = surface.model(&settings)?;
        let picture = model.trace(camera, &settings, &|_| true).map_err(&refuse)?;
        let cold = milliseconds(start.elapsed());
        let times = picture.statistics.times;
        first.push((picture, cold, milliseconds(times.simplify + times.compile)));
    }
    advance();
    let shared = configurations.first().map(|one| one.settings(size)).unwrap_or_default();
    let model = surface.model(&shared)?;
    let mut times = vec![Vec::with_capacity(repeats); configurations.len()];
    let mut order: Vec<usize> = (0..configurations.len()).collect();
    let mut rng = rng(&format!("{seed} {} order", surface.name));
    // The extra first round compiles the kernels, and is not measured.
    for round in 0..=repeats {
        rng.shuffle(&mut order);
        for &index in &order {
            let settings = configurations[index].settings(size);
            let picture = model.trace(camera, &settings, &|_| true).map_err(&refuse)?;
            let taken = picture.statistics.times;
            picture.hand_back();
            if round > 0 {
                times[index].push([taken.trace, taken.shade, taken.trace + taken.shade]);
            }
        }
        advance();
    }
    let measured = first.into_iter().zip(times).map(|((picture, cold, compile), times)| {
        let [trace, shade, total] = [0, 1, 2].map(|part| {
            let times: Vec<f64> = times.iter().map(|all| milliseconds(all[part])).collect();
            Quartiles::of(&times).expect("repeats")
        });
        Measured { compile, cold, trace, shade, total, picture }
    });
    Ok(measured.collect())
}
