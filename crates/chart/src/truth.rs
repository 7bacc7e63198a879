//! The truth about rays, proven by the certified tracer.
//!
//! It is independent of the methods: the tracer shares no code with kernels or methods. Only
//! normals come from a kernel, which evaluates the derivatives at the certified root in `f64`.

use crate::error::ChartError;
use crate::surfaces::ChartSurface;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use zeroset_render::model::Model;
use zeroset_render::picture::{Precision, Settings};
use zeroset_space::Ray;
use zeroset_testkit::certified::{Certificate, Crossing, Function, Line};
use zeroset_trace::TraceOptions;

/// The truth about a ray. Distances are in world units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Truth {
    /// The ray meets no zero.
    Miss,
    /// The ray meets a zero.
    Root(Root),
    /// The ray may touch a zero, or the budget ran out.
    Open,
}

/// The first zero along a ray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Root {
    /// Intervals of distance, one of which holds the zero. No other zero lies before or between
    /// them.
    pub pieces: Vec<[f64; 2]>,
    /// Interval of distance that holds the next zero, if that is certain.
    pub next: Option<[f64; 2]>,
    /// Unit normal at the zero, towards f > 0, if the zero is certainly the first and has a normal.
    pub normal: Option<[f64; 3]>,
}

/// Converts a ray for the certified tracer.
fn line(ray: &Ray) -> Line {
    Line { eye: ray.origin.to_array(), direction: ray.direction.to_array() }
}

/// The truth about these rays, with about `budget` evaluations each.
///
/// # Errors
/// If the function cannot be compiled.
pub fn certify(
    surface: &ChartSurface,
    rays: &[Ray],
    budget: u32,
) -> Result<Vec<Truth>, ChartError> {
    let certifier = Certifier::new(surface, budget)?;
    Ok(rays.par_iter().map(|ray| certifier.truth(ray)).collect())
}

/// The certified tracer, prepared for a surface.
pub struct Certifier<'a> {
    surface: &'a ChartSurface,
    model: Model,
    function: Function,
    bounds: [[f64; 2]; 3],
    budget: u32,
}

impl<'a> Certifier<'a> {
    /// Prepares the tracer, with about `budget` evaluations per ray.
    ///
    /// # Errors
    /// If the function cannot be compiled.
    pub fn new(surface: &'a ChartSurface, budget: u32) -> Result<Self, ChartError> {
        let settings = Settings {
            options: TraceOptions { precision: Precision::F64, ..TraceOptions::default() },
            ..Settings::default()
        };
        let model = surface.model(&settings)?;
        let document = &surface.document;
        let parameters: Vec<_> = document.parameters.iter().map(|p| p.value.clone()).collect();
        let function = Function::new(&document.graph, document.surfaces[0].root, &parameters);
        Ok(Self { surface, model, function, bounds: surface.bounds(), budget })
    }

    /// Proven facts about a ray.
    pub fn trace(&self, ray: &Ray) -> Certificate {
        self.function.trace(&line(ray), &self.bounds, self.budget)
    }

    /// The gradient of the surface's function at a point.
    pub fn gradient(&self, point: DVec3) -> DVec3 {
        DVec3::from_array(self.model.sample(0, point).1)
    }

    /// Finds the first root on a ray, or proves that there is no root.
    fn truth(&self, ray: &Ray) -> Truth {
        let scaled = |piece: [f64; 2]| piece.map(|t| ray.distance(t));
        if self.surface.is_solid() {
            // A solid is visible where the ray enters it through a face of the domain.
            if let Some(entry) = self.function.entry(&line(ray), &self.bounds) {
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
        let certificate = self.trace(ray);
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

    /// The crossing after `first`. To find it, a second ray starts behind `first`. Up to rounding,
    /// it lies on the same line as `ray`.
    fn next(&self, ray: &Ray, first: &Crossing) -> Option<[f64; 2]> {
        let behind = Ray { origin: ray.at(first.far), direction: ray.direction };
        let next = self.trace(&behind).crossing?;
        Some([next.near, next.far].map(|t| ray.distance(first.far + t)))
    }

    fn normal(&self, ray: &Ray, crossing: &Crossing) -> Option<[f64; 3]> {
        let point = ray.at(f64::midpoint(crossing.near, crossing.far));
        Some(self.gradient(point).try_normalize()?.to_array())
    }
}
