//! Search for the first root on each of up to sixteen rays, by halving parts of rays.

use super::isolated::{Isolated, refine, sign};
use crate::kernel_stats::KernelStats;
use crate::method::{Start, Task};
use crate::methods::bracket_gap::RayFunction;
use crate::methods::local_ray::{CUT, LocalRay, MAX_OPEN_PARTS, bounds};
use crate::methods::outcome::{RayOutcome, reason};
use crate::methods::slope::{Cuboid, SlopeKernels};
use crate::scalar::Scalar;
use zeroset_eval::{FindZeros, Kernel, KernelError, LANES, Zeros};
use zeroset_interval::Interval;
use zeroset_space::Region;

/// Searches rays for roots, in floats of type `T`.
pub(super) struct Searcher<'a, T: Scalar> {
    slopes: SlopeKernels<'a, T>,
    zeros: &'a dyn Kernel<FindZeros, T>,
    region: &'a Region,
    is_solid: bool,
}

/// Number of parts examined on a ray before the minimum length of its parts grows.
const PARTS_BEFORE_GROWTH: u32 = 256;
/// Factor by which the minimum length then grows with each part.
const GRAIN_GROWTH: f64 = 1.5;

/// State of the search along one ray.
struct RaySearch<'a> {
    local_ray: &'a LocalRay,
    /// Parts that still have to be examined. The nearest is last.
    parts: Vec<[f64; 2]>,
    /// A part of at most this length is not cut.
    grain: f64,
    examined: u32,
    open_parts: u32,
    /// Whether the ray has not yet left the surface that it started on.
    leaving: bool,
    outcome: RayOutcome,
    /// A part that holds one root, if one is found.
    isolated: Option<Isolated>,
}

/// A part of a ray to examine.
#[derive(Clone, Copy)]
struct RayPart {
    /// Index of the part's ray.
    ray: usize,
    ends: [f64; 2],
    cuboid: Cuboid,
    /// Whether the function has no known finite bounds on the part.
    unbounded: bool,
}

impl<'a, T: Scalar> Searcher<'a, T> {
    pub fn new(task: Task<'a>) -> Result<Self, KernelError> {
        let is_solid = task.options.is_solid;
        let zeros = T::kernels(task.surface).zeros()?;
        Ok(Self { slopes: SlopeKernels::new(&task)?, zeros, region: task.region, is_solid })
    }

    /// Returns the outcomes of up to [`LANES`] rays.
    pub fn search(
        &self,
        local_rays: &[LocalRay],
        start: Start,
        work: &mut KernelStats,
    ) -> Vec<RayOutcome> {
        let mut rays: Vec<RaySearch> =
            local_rays.iter().map(|local_ray| RaySearch::new::<T>(local_ray, start)).collect();
        loop {
            let parts = self.possible(&mut rays, work);
            if parts.is_empty() && rays.iter().all(|ray| ray.parts.is_empty()) {
                break;
            }
            self.classify(&mut rays, &parts, work);
        }
        let mut isolated: Vec<_> = rays
            .iter_mut()
            .filter_map(|ray| Some((ray.local_ray, ray.isolated.as_mut()?)))
            .collect();
        refine(&mut isolated, &self.slopes, self.region, work);
        let outcome = |ray: RaySearch| match ray.isolated {
            Some(isolated) => RayOutcome { hit: Some(isolated.ends()), ..ray.outcome },
            // Each part was proven empty, or cut in two parts, or left undecided.
            None => RayOutcome { is_followed: ray.parts.is_empty(), ..ray.outcome },
        };
        rays.into_iter().map(outcome).collect()
    }

    /// Takes the next part of each ray. Returns the parts that may hold a zero.
    fn possible(&self, rays: &mut [RaySearch], work: &mut KernelStats) -> Vec<RayPart> {
        let mut parts = Vec::with_capacity(LANES);
        for (number, ray) in rays.iter_mut().enumerate() {
            if let Some(ends) = ray.parts.pop() {
                let cuboid = bounds(ray.local_ray, ends, self.region);
                parts.push(RayPart { ray: number, ends, cuboid, unbounded: false });
            }
        }
        if parts.is_empty() {
            return parts;
        }
        let mut zeros = Zeros::default();
        self.zeros.eval_clipped(&self.slopes.batch(&cuboids(&parts)), &mut zeros);
        work.interval.called(parts.len() as u32);
        let mut lane = 0;
        parts.retain_mut(|part| {
            let possible = zeros.possible >> lane & 1 == 1;
            part.unbounded = zeros.unbounded >> lane & 1 == 1;
            rays[part.ray].leaving &= possible;
            lane += 1;
            possible
        });
        parts
    }

    /// Decides each part: isolates its root, cuts the part in two, or drops it as empty.
    fn classify(&self, rays: &mut [RaySearch], parts: &[RayPart], work: &mut KernelStats) {
        let slopes = self.slopes.along(
            &cuboids(parts),
            |lane| rays[parts[lane].ray].local_ray.direction,
            work,
        );
        let is_steady = |slope: Option<Interval>| slope.is_some_and(|s| s.lo > 0.0 || s.hi < 0.0);
        let mut steady = Vec::with_capacity(LANES);
        for (part, slope) in parts.iter().zip(slopes) {
            let ray = &mut rays[part.ray];
            ray.examined += 1;
            if ray.examined > PARTS_BEFORE_GROWTH {
                ray.grain *= GRAIN_GROWTH;
            }
            let [first, last] = ray.local_ray.inside;
            let within = first <= part.ends[0] && part.ends[1] <= last;
            if within && is_steady(slope) {
                steady.push(*part);
            } else {
                self.cut(ray, part, work);
            }
        }
        // If df/dt has a constant sign on a part, the part holds one root if the function's signs
        // at its ends differ, and none otherwise.
        let values = [0, 1].map(|end| {
            let place =
                |part: &RayPart| bounds(rays[part.ray].local_ray, [part.ends[end]; 2], self.region);
            self.slopes.values(&steady.iter().map(place).collect::<Vec<_>>(), work)
        });
        for (lane, part) in steady.iter().enumerate() {
            let ray = &mut rays[part.ray];
            let ends = [0, 1].map(|end| values[end][lane]);
            match ends.map(sign) {
                [Some(a), Some(b)] if a == b => ray.leaving = false,
                // The part's only root is on the surface that the ray starts on.
                [Some(_), Some(_)] if ray.leaving => ray.leaving = false,
                [Some(_), Some(_)] => {
                    let enough = ray.local_ray.longest.max(ray.grain);
                    ray.isolated = Some(Isolated::new(part.ends, ends, enough));
                    ray.parts.clear();
                }
                _ => self.cut(ray, part, work),
            }
        }
    }

    /// Cuts a part in two. A part too short to cut becomes a hit or undecided, or is dropped while
    /// the ray leaves the surface that it starts on.
    fn cut(&self, ray: &mut RaySearch, part: &RayPart, work: &mut KernelStats) {
        let [near, far] = part.ends;
        let cut = near + CUT * (far - near);
        if far - near > ray.grain && near < cut && cut < far {
            ray.parts.push([cut, far]);
            ray.parts.push([near, cut]);
            return;
        }
        if ray.leaving {
            return;
        }
        let spent = ray.examined > PARTS_BEFORE_GROWTH;
        let ray_function = RayFunction {
            kernel: self.slopes.kernel(),
            local_ray: ray.local_ray,
            region: self.region,
            is_solid: self.is_solid,
        };
        if ray.outcome.open.is_none()
            && let Some(bracket) = ray_function.bracket(part.ends)
        {
            ray.outcome.hit = Some(bracket);
            ray.parts.clear();
            return;
        }
        let facts = self.slopes.facts(&part.cuboid, work);
        let reason = reason(facts, spent);
        ray.outcome.open.get_or_insert((near, reason));
        ray.open_parts += 1;
        if self.is_solid || !part.unbounded {
            ray.outcome.likely = Some(near);
            ray.parts.clear();
        } else if ray.open_parts == MAX_OPEN_PARTS {
            work.given_up += 1;
            ray.parts.clear();
        }
    }
}

impl<'a> RaySearch<'a> {
    fn new<T: Scalar>(local_ray: &'a LocalRay, start: Start) -> Self {
        let [near, far] = local_ray.span;
        let [first, last] = [local_ray.inside[0].max(near), local_ray.inside[1].min(far)];
        // At the region's faces, rounding makes the sign uncertain. The parts around the faces stay
        // undecided, so they are examined separately.
        let mut parts = Vec::with_capacity(16);
        if first < last {
            parts.extend([[last, far], [first, last], [near, first]]);
            parts.retain(|[near, far]| near < far);
        } else {
            parts.push([near, far]);
        }
        let size = (local_ray.origin.abs() + far.abs() * local_ray.direction.abs()).max_element();
        let rounding = 4.0 * T::UNIT * size / local_ray.direction.abs().max_element();
        let grain = (T::GRAIN * far.abs()).max(rounding);
        Self {
            local_ray,
            parts,
            grain,
            examined: 0,
            open_parts: 0,
            leaving: start == Start::OnSurface,
            outcome: RayOutcome::default(),
            isolated: None,
        }
    }
}

fn cuboids(parts: &[RayPart]) -> Vec<Cuboid> {
    parts.iter().map(|part| part.cuboid).collect()
}
