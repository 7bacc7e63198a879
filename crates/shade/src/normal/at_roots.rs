//! Gradients at zeros near painted points.
//!
//! A painted point is near a zero, but seldom at it. At a multiple zero, the gradient is 0, and
//! close by its direction changes quickly. So the zero is found by Newton's method along the ray.
//! At a multiple zero itself, the gradients at simple zeros beside it are averaged.

use super::{gradients_and_values, unit};
use glam::DVec3;
use zeroset_eval::{Kernel, SampleGradient};
use zeroset_space::Ray;
use zeroset_trace::KernelStats;

/// Greatest number of steps of Newton's method. At a triple zero, each is two thirds as long as the
/// one before.
const STEPS: usize = 24;
/// Greatest distance of the zero from the start, in pixels.
const REACH: f64 = 4.0;
/// A zero is found if a step is shorter than this, in pixels. It is a simple zero if the step is
/// also much shorter than the one before, or below rounding errors.
const CLOSE: f64 = 1.0 / 4096.0;
const SHRINKING: f64 = 0.25;
const ROUNDING: f64 = 1e-6;

/// The part of a ray around a painted point.
#[derive(Clone, Copy)]
pub(super) struct Start {
    /// The ray, whose origin is the painted point.
    pub ray: Ray,
    /// Width of a pixel there, in units of the ray's t.
    pub pixel: f64,
}

/// Returns the gradient at the zero near each start. `None` if no simple zero is found.
pub(super) fn gradients_at_roots(
    kernel: &dyn Kernel<SampleGradient, f64>,
    starts: &[Start],
    work: &mut KernelStats,
) -> Vec<Option<DVec3>> {
    let mut found = vec![None; starts.len()];
    let mut open: Vec<(usize, f64, f64)> = (0..starts.len()).map(|k| (k, 0.0, f64::MAX)).collect();
    for _ in 0..STEPS {
        if open.is_empty() {
            break;
        }
        let points = open.iter().map(|&(k, t, _)| starts[k].ray.at(t));
        let samples = gradients_and_values(kernel, points, work);
        let mut left = Vec::with_capacity(open.len());
        for ((k, t, last), (value, gradient)) in open.into_iter().zip(samples) {
            let Start { ray, pixel } = &starts[k];
            let step = -value / gradient.dot(ray.direction);
            let length = step.abs() / pixel;
            let simple = length <= SHRINKING * last || length <= ROUNDING;
            if length <= CLOSE && simple {
                found[k] = Some(gradient);
            } else if (t + step).abs() <= REACH * pixel {
                left.push((k, t + step, length));
            }
        }
        open = left;
    }
    found
}

/// Returns the mean of the normals at the simple zeros near the starts. `None` without a simple
/// zero.
pub(super) fn mean_normal(
    kernel: &dyn Kernel<SampleGradient, f64>,
    starts: &[Start],
    work: &mut KernelStats,
) -> Option<[f32; 3]> {
    let found = gradients_at_roots(kernel, starts, work);
    let units = found.into_iter().flatten().filter_map(unit);
    unit(units.map(|unit| DVec3::from_array(unit.map(f64::from))).sum())
}
