//! Certified results for some pixels of a picture, and the errors of renderers at these pixels.
//!
//! The certified tracer shares no code with kernels, methods or rivals.

use crate::surfaces::{Surface, line};
use anyhow::Result;
use rayon::prelude::*;
use zeroset_testkit::certified::{BUDGET, Certificate, Function};
use zeroset_trace::RayGrid;

/// The certified result of a ray. Distances are in world units.
enum Truth {
    /// The ray meets no zero.
    Miss,
    /// The ray meets a zero. The distance of the first zero lies in one of these intervals.
    Root(Vec<[f64; 2]>),
    /// It is not certain whether the ray meets a zero.
    Open,
}

/// Certified results for some pixels of a picture of one size.
pub struct Reference {
    half: f64,
    pixels: Vec<(usize, Truth)>,
}

/// Errors of a picture against the reference.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Number of pixels that are drawn but have no root.
    pub rootless: usize,
    /// Number of pixels that have a root but are not drawn.
    pub missed: usize,
    /// Median distance of drawn points from the first root, in half extents of the domain. `None`
    /// if no drawn pixel has a root.
    pub distance: Option<f64>,
}

/// Numbers of rays that enter the domain where f is below 0, and where it is above.
#[derive(Clone, Copy, Debug)]
pub struct Entries {
    below: usize,
    above: usize,
}

/// Divides a picture into `samples`² equal parts and returns the middle pixel of each. If the
/// picture has fewer pixels, returns all of them.
fn sampled(size: usize, samples: usize) -> Vec<usize> {
    let samples = samples.min(size);
    let place = |n: usize| (2 * n + 1) * size / (2 * samples);
    (0..samples * samples).map(|n| place(n / samples) * size + place(n % samples)).collect()
}

fn function(surface: &Surface) -> Result<Function> {
    let document = surface.document()?;
    Ok(Function::new(&document.graph, document.surfaces[0].root, &[]))
}

impl Truth {
    /// Converts a certificate to world units, given the length of the ray's direction.
    fn new(certificate: &Certificate, length: f64) -> Self {
        let crossing = certificate.crossing.map(|crossing| [crossing.near, crossing.far]);
        if certificate.is_miss() {
            return Self::Miss;
        }
        let Some(crossing) = crossing else { return Self::Open };
        let before = certificate.unresolved.iter().map(|piece| [piece.near, piece.far]);
        Self::Root(before.chain([crossing]).map(|piece| piece.map(|t| t * length)).collect())
    }
}

impl Reference {
    /// Traces `samples`² rays of a picture with `size` rows.
    ///
    /// # Errors
    /// If the surface has no valid document, domain or camera.
    pub fn new(surface: &Surface, size: usize, samples: usize) -> Result<Self> {
        let (function, bounds) = (function(surface)?, surface.bounds());
        let rays = RayGrid::new(&surface.camera()?, size, size);
        let truth = |pixel: usize| {
            let certificate = function.trace(&line(&rays, pixel), &bounds, BUDGET);
            (pixel, Truth::new(&certificate, rays.ray_of(pixel).direction.length()))
        };
        let pixels = sampled(size, samples).into_par_iter().map(truth).collect();
        Ok(Self { half: surface.half, pixels })
    }

    /// Numbers of rays that certainly miss, that certainly hit, and that are not decided.
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

    /// Returns the errors of a picture, given its
    /// [`Side::distances`](crate::side::Side::distances).
    pub fn errors(&self, distances: &[f64]) -> Errors {
        let (mut rootless, mut missed, mut off) = (0, 0, Vec::new());
        for (pixel, truth) in &self.pixels {
            let drawn = distances[*pixel];
            match truth {
                Truth::Miss => rootless += usize::from(drawn.is_finite()),
                Truth::Root(_) if drawn.is_infinite() => missed += 1,
                Truth::Root(pieces) => {
                    let outside = |[near, far]: &[f64; 2]| (near - drawn).max(drawn - far).max(0.0);
                    let least = pieces.iter().map(outside).fold(f64::INFINITY, f64::min);
                    off.push(least / self.half);
                }
                Truth::Open => {}
            }
        }
        off.sort_by(f64::total_cmp);
        Errors { rootless, missed, distance: off.get(off.len() / 2).copied() }
    }
}

impl Entries {
    /// Evaluates the function's sign where `samples`² rays enter the domain.
    ///
    /// # Errors
    /// If the surface has no valid document, domain or camera.
    pub fn new(surface: &Surface, samples: usize) -> Result<Self> {
        let (function, bounds) = (function(surface)?, surface.bounds());
        let rays = RayGrid::new(&surface.camera()?, samples, samples);
        let below = (0..samples * samples).into_par_iter().filter_map(|pixel| {
            function.entry(&line(&rays, pixel), &bounds).and_then(|entry| entry.below)
        });
        let below: Vec<bool> = below.collect();
        let count = |side: bool| below.iter().filter(|below| **below == side).count();
        Ok(Self { below: count(true), above: count(false) })
    }

    /// Whether the function is below 0 where most rays enter the domain.
    pub fn are_mostly_below(self) -> bool {
        self.below > self.above
    }

    /// Share of rays that enter the domain where f has its rarer sign. `None` if all signs agree.
    pub fn minority(self) -> Option<f64> {
        let (less, more) = (self.below.min(self.above), self.below.max(self.above));
        (less > 0).then(|| less as f64 / (less + more) as f64)
    }
}
