//! What is certain of some pixels of a picture, found once and kept.

use crate::error::ChartError;
use crate::files::write;
use crate::surfaces::Surface;
use crate::truth::{Truth, certify};
use crate::views::{View, rng};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use zeroset_trace::Ray;

/// Which pixels are looked at, and how long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Pixels in a row, and rows.
    pub size: usize,
    /// About how many pixels; 0 for all.
    pub samples: usize,
    /// Draws them.
    pub seed: u64,
    /// Evaluations of the function a ray.
    pub budget: u32,
}

/// Some pixels of pictures from one view, and what is certain of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reference {
    /// A hash of all that it depends on.
    origin: String,
    /// Index of each pixel, row by row from the top, and what is certain of it.
    pub pixels: Vec<(usize, Truth)>,
}

/// One pixel at a random place in each of about so many equal squares of a picture.
fn sampled(Sampling { size, samples, seed, .. }: Sampling) -> Vec<usize> {
    let side = samples.isqrt();
    if side == 0 || side >= size {
        return (0..size * size).collect();
    }
    let mut rng = rng(&format!("{seed} pixels"));
    let mut place = |n: usize| rng.usize(n * size / side..(n + 1) * size / side);
    (0..side * side).map(|n| place(n / side) * size + place(n % side)).collect()
}

impl Reference {
    /// Of these pixels, kept nowhere.
    pub fn of(pixels: Vec<(usize, Truth)>) -> Self {
        Self { origin: String::new(), pixels }
    }

    /// What is certain of a view, kept in `directory` from one run to the next.
    ///
    /// # Errors
    /// If the directory cannot be written, or the function has no code.
    pub fn kept(
        directory: &Path,
        surface: &Surface,
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
        let (rays, pixels) = (view.camera.rays(size, size), sampled(sampling));
        let own: Vec<Ray> = pixels.iter().map(|&pixel| rays.ray_of(pixel)).collect();
        let truths = certify(surface, &own, sampling.budget)?;
        let reference = Self { origin, pixels: pixels.into_iter().zip(truths).collect() };
        let bytes = serde_json::to_vec(&reference).map_err(ChartError::of_content(&path))?;
        write(&path, &bytes)?;
        Ok(reference)
    }
}

/// Changes with what is kept.
const FORMAT: u32 = 1;
