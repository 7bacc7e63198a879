//! Certified results for some pixels of a view, computed once and stored.

use crate::error::ChartError;
use crate::files::write;
use crate::surfaces::ChartSurface;
use crate::truth::{Truth, certify};
use crate::views::{View, rng};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use zeroset_space::Ray;
use zeroset_trace::RayGrid;

/// The pixels that are checked, and the effort for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Side of the square picture, in pixels.
    pub size: usize,
    /// Approximate number of pixels; 0 for all.
    pub samples: usize,
    /// Seed of the random pixels.
    pub seed: u64,
    /// Evaluations of the function per ray.
    pub budget: u32,
}

/// Certified results for some pixels of pictures from one view.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RootReference {
    /// Hash of everything that the results depend on.
    origin: String,
    /// Index of each pixel, row by row from the top, and the truth about its ray.
    pub pixels: Vec<(usize, Truth)>,
}

/// Pixels to check: about `samples`, one at a random place in each square of a regular grid.
fn sampled(Sampling { size, samples, seed, .. }: Sampling) -> Vec<usize> {
    let side = samples.isqrt();
    if side == 0 || side >= size {
        return (0..size * size).collect();
    }
    let mut rng = rng(&format!("{seed} pixels"));
    let mut place = |n: usize| rng.usize(n * size / side..(n + 1) * size / side);
    (0..side * side).map(|n| place(n / side) * size + place(n % side)).collect()
}

impl RootReference {
    /// A reference with these results. It is not stored.
    pub fn of(pixels: Vec<(usize, Truth)>) -> Self {
        Self { origin: String::new(), pixels }
    }

    /// The reference of a view, read from `directory` or computed and stored there.
    ///
    /// # Errors
    /// If the directory cannot be written, or the function cannot be compiled.
    pub fn kept(
        directory: &Path,
        surface: &ChartSurface,
        view: &View,
        sampling: Sampling,
    ) -> Result<Self, ChartError> {
        let size = sampling.size;
        let facts = (&surface.text, surface.bounds(), view, sampling, FORMAT);
        let origin = blake3::hash(format!("{facts:?}").as_bytes()).to_hex().to_string();
        fs::create_dir_all(directory).map_err(ChartError::of_file(directory))?;
        let name = format!("{}-{}-{size}-{}.json", surface.name, view.name, &origin[..8]);
        let path = directory.join(name);
        let kept =
            fs::read(&path).ok().and_then(|bytes| serde_json::from_slice::<Self>(&bytes).ok());
        if let Some(kept) = kept.filter(|kept| kept.origin == origin) {
            return Ok(kept);
        }
        let (rays, pixels) = (RayGrid::new(&view.camera, size, size), sampled(sampling));
        let own: Vec<Ray> = pixels.iter().map(|&pixel| rays.ray_of(pixel)).collect();
        let truths = certify(surface, &own, sampling.budget)?;
        let reference = Self { origin, pixels: pixels.into_iter().zip(truths).collect() };
        let bytes = serde_json::to_vec(&reference).map_err(ChartError::of_content(&path))?;
        write(&path, &bytes)?;
        Ok(reference)
    }
}

/// Version of the stored format.
const FORMAT: u32 = 1;
