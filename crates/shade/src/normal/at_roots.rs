//! Gradients at zeros near painted points.
//!
//! A painted point is near a zero, but seldom at it. At a multiple zero, the gradient is 0, and
//! close by its direction changes quickly. So the zero is found by Newton's method along the ray.
//! At a multiple zero itself, the gradients at simple zeros beside it are averaged.

use super::unit;
use glam::DVec3;
use zeroset_eval::{Gradients, Kernel, LANES, Points, SampleGradient};
use zeroset_space::Ray;
use zeroset_trace::KernelStats;

/// Greatest number of steps of Newton's method. At a triple zero, each is two thirds as long as the
/// one before.
const STEPS: usize = 24;
/// Greatest distance of the zero from the start, in pixels.
pub(super) const REACH: f64 = 4.0;
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
    /// Width of a pixel at the painted point, in units of the ray's t.
    pub pixel: f64,
}

/// Returns the gradient at the zero near each start. `None` if no simple zero is found.
pub(super) fn gradients_at_roots(
    kernel: &dyn Kernel<SampleGradient, f64>,
    starts: &[Start],
    work: &mut KernelStats,
) -> Vec<Option<DVec3>> {
    let mut found = vec![None; starts.len()];
    // The number of a start, the ray's t of the next sample, and the length of the last step.
    let mut open: Vec<(usize, f64, f64)> = (0..starts.len()).map(|k| (k, 0.0, f64::MAX)).collect();
    let (mut points, mut samples) = (Points::default(), Gradients::default());
    for _ in 0..STEPS {
        let mut left = 0;
        for first in (0..open.len()).step_by(LANES) {
            let lanes = first..open.len().min(first + LANES);
            points.set_near(open[lanes.clone()].iter().map(|&(k, t, _)| starts[k].ray.at(t)));
            work.gradient.called(points.count);
            kernel.eval(&points, &mut samples);
            for (lane, number) in lanes.enumerate() {
                let (k, t, last) = open[number];
                let Start { ray, pixel } = &starts[k];
                let gradient =
                    DVec3::from_array(samples.gradient.each_ref().map(|axis| axis[lane]));
                let step = -samples.value[lane] / gradient.dot(ray.direction);
                let length = step.abs() / pixel;
                let simple = length <= SHRINKING * last || length <= ROUNDING;
                if length <= CLOSE && simple {
                    found[k] = Some(gradient);
                } else if (t + step).abs() <= REACH * pixel {
                    open[left] = (k, t + step, length);
                    left += 1;
                }
            }
        }
        open.truncate(left);
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
