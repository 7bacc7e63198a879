//! Robust ray intersection with interval arithmetic (Mitchell 1990). Each ray is halved until each
//! of its parts is decided. Bounds of f prove a part empty. Bounds of df/dt prove that a part holds
//! at most one root.
//!
//! The method proves misses. It proves a hit if a part with at most one root has proven, opposite
//! signs at its ends.

mod isolated;
mod search;

use super::local_ray::LocalRay;
use super::outcome::{RayOutcome, follow_in_region};
use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Segment, Start, Task, Tracer};
use crate::options;
use crate::options::Precision;
use crate::ray_result::RayResult;
use crate::scalar::Scalar;
use search::Searcher;
use std::sync::OnceLock;
use zeroset_eval::KernelError;

pub(crate) const METHOD: Method = Method {
    name: "mitchell",
    help: "single rays halved by bounds of f and of df/dt (Mitchell 1990); proves hits and misses",
    proves: Proves::HitsAndMisses,
    reads: &[options::PRECISION, options::TOLERANCE],
    prepare: [prepare::<f32>, prepare::<f64>],
};

fn prepare<T: Scalar>(task: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    Ok(Box::new(Mitchell { searcher: Searcher::<T>::new(task)?, double: OnceLock::new(), task }))
}

struct Mitchell<'a, T: Scalar> {
    searcher: Searcher<'a, T>,
    /// Searcher in `f64`, created when `f32` first leaves a ray undecided.
    double: OnceLock<Option<Searcher<'a, f64>>>,
    task: Task<'a>,
}

impl<T: Scalar> Mitchell<'_, T> {
    /// Repeats the search in `f64` for the rays that `f32` left undecided, from the first undecided
    /// part of each ray on.
    fn follow_in_double(
        &self,
        local_rays: &[LocalRay],
        outcomes: &mut [RayOutcome],
        work: &mut KernelStats,
    ) {
        let open: Vec<usize> =
            (0..local_rays.len()).filter(|&k| outcomes[k].open.is_some()).collect();
        if open.is_empty() {
            return;
        }
        let make = || Searcher::new(self.task).ok();
        let Some(double) = self.double.get_or_init(make) else { return };
        let rest = |&k: &usize| {
            let from = outcomes[k].open.map_or(0.0, |(from, _)| from);
            LocalRay { span: [from, local_rays[k].span[1]], ..local_rays[k] }
        };
        let rests: Vec<LocalRay> = open.iter().map(rest).collect();
        let refined = double.search(&rests, Start::Anywhere, work);
        for (k, refined) in open.into_iter().zip(refined) {
            outcomes[k] = refined;
        }
    }
}

impl<T: Scalar> Tracer for Mitchell<'_, T> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        follow_in_region(rays, &self.task, found, |local_rays| {
            let mut outcomes = self.searcher.search(local_rays, start, work);
            // For shadow rays, the precision of `f32` suffices.
            if self.task.options.precision == Precision::Auto && start == Start::Anywhere {
                self.follow_in_double(local_rays, &mut outcomes, work);
            }
            outcomes
        });
    }
}
