//! What is certain of some pixels of a picture, by the certified tracer.
//!
//! It knows no methods: the tracer shares no code with kernels or traversers. Normals are the exception: they are exact
//! derivatives, taken by a kernel of 64 bits at the certified root.

use crate::error::ChartError;
use crate::files::write;
use crate::surfaces::Surface;
use crate::views::{View, rng};
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use zeroset::model::Model;
use zeroset::picture::{Precision, Settings};
use zeroset_testkit::certified::{Crossing, Function, Line};
use zeroset_trace::{Ray, RayGrid};

/// What is certain of a ray. Distances are in world units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Truth {
    /// It meets no zero.
    Miss,
    /// It meets one.
    Root(Root),
    /// It comes near one, and perhaps touches it; or effort ran out.
    Open,
}

/// The first zero of a ray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Root {
    /// It lies in one of these pieces, and there is no other before or between them.
    pub pieces: Vec<[f64; 2]>,
    /// Where the next one lies, if there is one and it is certain.
    pub next: Option<[f64; 2]>,
    /// The unit normal at the zero, towards f > 0, if that is certainly the first and has one.
    pub normal: Option<[f64; 3]>,
}

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

/// The ray, as the certified tracer takes it.
pub fn line(ray: &Ray) -> Line {
    Line { eye: ray.origin.to_array(), direction: ray.direction.to_array() }
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
        let rays = view.camera.rays(size, size);
        let pixels = trace(surface, &rays, &sampled(sampling), sampling.budget)?;
        let reference = Self { origin, pixels };
        let bytes = serde_json::to_vec(&reference).map_err(ChartError::of_content(&path))?;
        write(&path, &bytes)?;
        Ok(reference)
    }

    /// How many pixels have no root, one, and are open.
    pub fn counts(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for (_, truth) in &self.pixels {
            counts[match truth {
                Truth::Miss => 0,
                Truth::Root(_) => 1,
                Truth::Open => 2,
            }] += 1;
        }
        counts
    }
}

/// Changes with what is kept.
const FORMAT: u32 = 1;

/// What is certain of these pixels, by about `budget` evaluations each.
///
/// # Errors
/// If the function has no code.
pub fn trace(
    surface: &Surface,
    rays: &RayGrid,
    pixels: &[usize],
    budget: u32,
) -> Result<Vec<(usize, Truth)>, ChartError> {
    let rays: Vec<Ray> = pixels.iter().map(|&pixel| rays.ray_of(pixel)).collect();
    Ok(pixels.iter().copied().zip(certify(surface, &rays, budget)?).collect())
}

/// What is certain of these rays, by about `budget` evaluations each.
///
/// # Errors
/// If the function has no code.
pub fn certify(surface: &Surface, rays: &[Ray], budget: u32) -> Result<Vec<Truth>, ChartError> {
    let settings = Settings { precision: Precision::F64, ..Settings::default() };
    let model = Model::new(&surface.document, &surface.region, &settings)
        .map_err(ChartError::of_surface(&surface.name))?;
    let tracer = Certifier {
        surface,
        model,
        function: surface.function(),
        bounds: surface.bounds(),
        budget,
    };
    Ok(rays.par_iter().map(|ray| tracer.truth(ray)).collect())
}

struct Certifier<'a> {
    surface: &'a Surface,
    model: Model,
    function: Function,
    bounds: [[f64; 2]; 3],
    budget: u32,
}

impl Certifier<'_> {
    fn truth(&self, ray: &Ray) -> Truth {
        let line = line(ray);
        let scaled = |piece: [f64; 2]| piece.map(|t| ray.distance(t));
        if self.surface.is_solid() {
            // A solid that a face cuts is seen where the ray comes in.
            if let Some(entry) = self.function.entry(&line, &self.bounds) {
                match entry.below {
                    Some(true) => {
                        let (near, far) = entry.distance;
                        let pieces = vec![scaled([near, far])];
                        return Truth::Root(Root { pieces, next: None, normal: None });
                    }
                    Some(false) => {}
                    None => return Truth::Open,
                }
            }
        }
        let certificate = self.function.trace(&line, &self.bounds, self.budget);
        if certificate.is_miss() {
            return Truth::Miss;
        }
        let Some(crossing) = certificate.crossing else { return Truth::Open };
        let unresolved = certificate.unresolved.iter().map(|piece| [piece.near, piece.far]);
        let pieces = unresolved.chain([[crossing.near, crossing.far]]).map(scaled).collect();
        let is_certain = certificate.unresolved.is_empty() && crossing.simple;
        let normal = if is_certain { self.normal(ray, &crossing) } else { None };
        Truth::Root(Root { pieces, next: self.next(ray, &crossing), normal })
    }

    /// The next crossing, on a ray that starts behind the first: within rounding it is the same ray.
    fn next(&self, ray: &Ray, first: &Crossing) -> Option<[f64; 2]> {
        let behind = Ray { origin: ray.at(first.far), direction: ray.direction };
        let certificate = self.function.trace(&line(&behind), &self.bounds, self.budget);
        let next = certificate.crossing?;
        Some([next.near, next.far].map(|t| ray.distance(first.far + t)))
    }

    fn normal(&self, ray: &Ray, crossing: &Crossing) -> Option<[f64; 3]> {
        let point = ray.at(f64::midpoint(crossing.near, crossing.far));
        let gradient = DVec3::from_array(self.model.sample(0, point).1);
        Some(gradient.try_normalize()?.to_array())
    }
}
