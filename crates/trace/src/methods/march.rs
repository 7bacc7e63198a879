//! Uniform samples along each ray. A change of sign between adjacent samples is taken for a root.
//!
//! The method proves nothing. It misses features that are thinner than the distance between two
//! samples. It draws a wall at a pole if the function changes sign there.

use super::refine::{RayParts, Refiner};
use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Segment, Start, Task, Tracer};
use crate::options;
use crate::packet::RayLanes;
use crate::painted::ones;
use crate::ray_result::{RayResult, Status, UndecidedReason};
use crate::scalar::Scalar;
use zeroset_eval::{KernelError, LANES, Points, Values};
use zeroset_space::Region;

pub(crate) const METHOD: Method = Method {
    name: "march",
    help: "changes of sign between uniform samples; proves nothing",
    proves: Proves::Nothing,
    reads: &[options::PRECISION, options::STEPS, options::TOLERANCE],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    let Task { surface, region, options } = task;
    let refiner = Refiner::new(T::kernels(surface).values()?, &options);
    Ok(Box::new(March { refiner, region, samples: options.steps.max(2) }))
}

struct March<'a, T: Scalar> {
    refiner: Refiner<'a, T>,
    region: &'a Region,
    /// Number of samples along a ray's part in the region.
    samples: u32,
}

impl<T: Scalar> March<'_, T> {
    /// Returns the t of the first two adjacent samples between which the function changes sign.
    fn cell(
        &self,
        segment: &Segment,
        [near, far]: [f64; 2],
        start: Start,
        work: &mut KernelStats,
    ) -> Option<[f64; 2]> {
        let step = (far - near) / f64::from(self.samples - 1);
        let at = |sample: u32| near + f64::from(sample) * step;
        let (mut points, mut values) = (Points::default(), Values::default());
        let mut before = f64::NAN;
        for first in (0..self.samples).step_by(LANES) {
            points.count = (self.samples - first).min(LANES as u32);
            for (lane, sample) in (first..first + points.count).enumerate() {
                let point = segment.ray.at(at(sample));
                for axis in 0..3 {
                    points.at[axis][lane] = T::nearest(point[axis]);
                }
            }
            self.refiner.kernel.eval(&points, &mut values);
            work.point.called(points.count);
            for (lane, sample) in (first..first + points.count).enumerate() {
                let value: f64 = values.value[lane].into();
                // If a ray starts on a surface, that surface lies between the first two samples.
                let counts = sample > u32::from(start == Start::OnSurface);
                if counts && self.refiner.is_crossing([before, value]) {
                    return Some([at(sample - 1), at(sample)]);
                }
                before = value;
            }
        }
        None
    }
}

impl<T: Scalar> Tracer for March<'_, T> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        for (rays, found) in rays.chunks(LANES).zip(found.chunks_mut(LANES)) {
            let mut cells = RayParts::default();
            for (lane, (segment, found)) in rays.iter().zip(&mut *found).enumerate() {
                let Some([near, far]) = segment.within(self.region) else {
                    *found = RayResult::MISS;
                    continue;
                };
                // A miss would claim a proof. So the ray is undecided from its entry into the
                // region.
                let (status, reason) = (Status::Undecided, UndecidedReason::Unproven);
                *found = RayResult { status, reason, distance: near, ..RayResult::MISS };
                if far.is_finite()
                    && let Some(cell) = self.cell(segment, [near, far], start, work)
                {
                    cells.set(lane, cell);
                }
            }
            let places = self.refiner.places(&RayLanes::new(rays), &cells, work);
            for lane in ones(cells.rays) {
                found[lane].drawn = places[lane].max(found[lane].distance);
            }
        }
    }
}
