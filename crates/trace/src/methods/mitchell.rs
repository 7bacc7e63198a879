//! Robust ray intersection with interval arithmetic (Mitchell 1990): the way of a single ray is halved until each part is
//! empty by bounds of f, or holds at most one root by bounds of df/dt.
//!
//! It proves misses, and hits where the values at the ends of such a part have opposite signs for certain.

mod isolated;
mod search;

use super::way::Way;
use crate::gbuffer::{Found, Reason, Status};
use crate::method::{Method, MethodOption, Options, Precision, Proves, Segment, Start, Tracer};
use crate::region::Region;
use crate::scalar::Scalar;
use crate::work::Work;
use search::Searcher;
use std::sync::OnceLock;
use zeroset_eval::{KernelError, LANES, Surface};

pub(crate) const METHOD: Method = Method {
    name: "mitchell",
    help: "single rays halved by bounds of f and of df/dt (Mitchell 1990); proves hits and misses",
    proves: Proves::HitsAndMisses,
    reads: &[MethodOption::Precision, MethodOption::Tolerance],
    prepare,
};

fn prepare<'a>(
    surface: &'a dyn Surface,
    region: &'a Region,
    options: Options,
) -> Result<Box<dyn Tracer + 'a>, KernelError> {
    fn boxed<'a, T: Scalar>(
        surface: &'a dyn Surface,
        region: &'a Region,
        options: Options,
    ) -> Result<Box<dyn Tracer + 'a>, KernelError> {
        let searcher = Searcher::<T>::new(surface, region, &options)?;
        Ok(Box::new(Mitchell { searcher, double: OnceLock::new(), surface, region, options }))
    }
    match options.precision {
        Precision::Auto | Precision::F32 => boxed::<f32>(surface, region, options),
        Precision::F64 => boxed::<f64>(surface, region, options),
    }
}

struct Mitchell<'a, T: Scalar> {
    searcher: Searcher<'a, T>,
    /// Made when `f32` leaves the first ray open.
    double: OnceLock<Option<Searcher<'a, f64>>>,
    surface: &'a dyn Surface,
    region: &'a Region,
    options: Options,
}

/// What became of a ray. Places are values of s.
#[derive(Clone, Copy, Debug, Default)]
struct Outcome {
    /// The bracket of the first zero that is proven.
    hit: Option<[f64; 2]>,
    /// The start of the first part before it of which nothing is proven, and why.
    open: Option<(f64, Reason)>,
    /// The start of the first such part that is likely a zero.
    likely: Option<f64>,
}

impl<T: Scalar> Mitchell<'_, T> {
    /// Looks in `f64` at what stayed open in `f32`, and at all that lies behind it.
    fn follow_in_double(&self, ways: &[Way], outcomes: &mut [Outcome], work: &mut Work) {
        let open: Vec<usize> = (0..ways.len()).filter(|&k| outcomes[k].open.is_some()).collect();
        if open.is_empty() {
            return;
        }
        let make = || Searcher::new(self.surface, self.region, &self.options).ok();
        let Some(double) = self.double.get_or_init(make) else { return };
        let rest = |&k: &usize| {
            let from = outcomes[k].open.map_or(0.0, |(from, _)| from);
            Way { span: [from, ways[k].span[1]], ..ways[k] }
        };
        let rests: Vec<Way> = open.iter().map(rest).collect();
        let refined = double.search(&rests, Start::Anywhere, work);
        for (k, refined) in open.into_iter().zip(refined) {
            outcomes[k] = refined;
        }
    }
}

impl<T: Scalar> Tracer for Mitchell<'_, T> {
    fn follow(&self, rays: &[Segment], start: Start, found: &mut [Found], work: &mut Work) {
        for (rays, found) in rays.chunks(LANES).zip(found.chunks_mut(LANES)) {
            let (mut ways, mut lanes) = (Vec::with_capacity(LANES), Vec::with_capacity(LANES));
            for (lane, segment) in rays.iter().enumerate() {
                found[lane] = Found::MISS;
                if let Some(mut way) = Way::new(segment, self.region) {
                    way.tolerance = self.options.tolerance * segment.footprint(-way.start);
                    ways.push(way);
                    lanes.push(lane);
                }
            }
            let mut outcomes = self.searcher.search(&ways, start, work);
            // Shadows need no more than `f32` tells.
            if self.options.precision == Precision::Auto && start == Start::Anywhere {
                self.follow_in_double(&ways, &mut outcomes, work);
            }
            for ((outcome, way), lane) in outcomes.iter().zip(&ways).zip(lanes) {
                found[lane] = outcome.found(-way.start);
            }
        }
    }
}

impl Outcome {
    /// The same as a finding, for a ray whose t is `start` where s is 0.
    fn found(&self, start: f64) -> Found {
        let place = |s: f64| start + s;
        let middle = self.hit.map(|[near, far]| place(0.5 * (near + far)));
        if let Some((from, reason)) = self.open {
            let drawn = self.likely.map(place).or(middle).unwrap_or(f64::INFINITY);
            let (status, distance) = (Status::Undecided, place(from));
            return Found { status, distance, drawn, reason, ..Found::MISS };
        }
        let (Some([near, far]), Some(distance)) = (self.hit, middle) else { return Found::MISS };
        // Its ends are rounded outward.
        let bracket = [place(near).next_down(), place(far).next_up()];
        let (status, drawn) = (Status::Hit, distance);
        Found { status, distance, drawn, bracket, ..Found::MISS }
    }
}
