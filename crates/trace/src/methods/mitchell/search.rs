//! Search for the first root on up to sixteen rays, whose parts are halved.

use super::isolated::{Isolated, refine, sign};
use crate::kernel_stats::KernelStats;
use crate::method::{Start, Task};
use crate::methods::bracket_gap::Bridge;
use crate::methods::local_ray::{CUT, LocalRay, OPEN_PARTS, bounds};
use crate::methods::outcome::{Outcome, reason};
use crate::methods::slope::{Cuboid, Slopes};
use crate::scalar::Scalar;
use zeroset_eval::{FindZeros, Kernel, KernelError, LANES, Zeros};
use zeroset_interval::Interval;
use zeroset_space::Region;

/// Searches for roots in `T`.
pub(super) struct Searcher<'a, T: Scalar> {
    slopes: Slopes<'a, T>,
    zeros: &'a dyn Kernel<FindZeros, T>,
    region: &'a Region,
    suppress_asymptotes: bool,
}

/// Number of parts examined on a ray before the minimum length of its parts grows.
const PATIENCE: u32 = 256;
/// Factor by which the minimum length grows with each further part.
const HASTE: f64 = 1.5;

/// State of the search along one ray.
struct Search<'a> {
    way: &'a LocalRay,
    /// Parts that remain to be examined, the nearest last.
    parts: Vec<[f64; 2]>,
    /// Minimum length of the parts that are cut.
    grain: f64,
    looked: u32,
    opened: u32,
    /// True while the ray is on the surface that it started from.
    leaving: bool,
    outcome: Outcome,
    /// A part that holds one root, once it is found.
    isolated: Option<Isolated>,
}

/// A part of a ray that is examined.
#[derive(Clone, Copy)]
struct Candidate {
    /// Index of the ray.
    ray: usize,
    ends: [f64; 2],
    cuboid: Cuboid,
    /// True if the function has no known finite bounds there.
    unbounded: bool,
}

impl<'a, T: Scalar> Searcher<'a, T> {
    pub fn new(task: Task<'a>) -> Result<Self, KernelError> {
        let suppress_asymptotes = task.options.suppress_asymptotes;
        let zeros = T::kernels(task.surface).zeros()?;
        Ok(Self { slopes: Slopes::new(&task)?, zeros, region: task.region, suppress_asymptotes })
    }

    /// Returns the outcomes of up to [`LANES`] rays.
    pub fn search(&self, ways: &[LocalRay], start: Start, work: &mut KernelStats) -> Vec<Outcome> {
        let mut rays: Vec<Search> = ways.iter().map(|way| Search::new::<T>(way, start)).collect();
        loop {
            let parts = self.possible(&mut rays, work);
            if parts.is_empty() && rays.iter().all(|ray| ray.parts.is_empty()) {
                break;
            }
            self.look(&mut rays, &parts, work);
        }
        let mut isolated: Vec<_> =
            rays.iter_mut().filter_map(|ray| Some((ray.way, ray.isolated.as_mut()?))).collect();
        refine(&mut isolated, &self.slopes, self.region, work);
        let outcome = |ray: Search| match ray.isolated {
            Some(isolated) => Outcome { hit: Some(isolated.ends()), ..ray.outcome },
            None => ray.outcome,
        };
        rays.into_iter().map(outcome).collect()
    }

    /// Takes the next part of each ray, and returns the parts that may hold a zero.
    fn possible(&self, rays: &mut [Search], work: &mut KernelStats) -> Vec<Candidate> {
        let mut parts = Vec::with_capacity(LANES);
        for (number, ray) in rays.iter_mut().enumerate() {
            if let Some(ends) = ray.parts.pop() {
                let cuboid = bounds(ray.way, ends, self.region);
                parts.push(Candidate { ray: number, ends, cuboid, unbounded: false });
            }
        }
        if parts.is_empty() {
            return parts;
        }
        let mut zeros = Zeros::default();
        self.zeros.eval(&self.slopes.batch(&cuboids(&parts)), &mut zeros);
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

    /// Isolates the root of each part, cuts it in two, or finds it empty.
    fn look(&self, rays: &mut [Search], parts: &[Candidate], work: &mut KernelStats) {
        let slopes =
            self.slopes.along(&cuboids(parts), |lane| rays[parts[lane].ray].way.direction, work);
        let is_steady = |slope: Option<Interval>| slope.is_some_and(|s| s.lo > 0.0 || s.hi < 0.0);
        let mut steady = Vec::with_capacity(LANES);
        for (part, slope) in parts.iter().zip(slopes) {
            let ray = &mut rays[part.ray];
            ray.looked += 1;
            if ray.looked > PATIENCE {
                ray.grain *= HASTE;
            }
            let [first, last] = ray.way.inside;
            let within = first <= part.ends[0] && part.ends[1] <= last;
            if within && is_steady(slope) {
                steady.push(*part);
            } else {
                self.cut(ray, part, work);
            }
        }
        // If df/dt has one sign, there is one root if the signs at the ends differ, and none
        // otherwise.
        let values = [0, 1].map(|end| {
            let place =
                |part: &Candidate| bounds(rays[part.ray].way, [part.ends[end]; 2], self.region);
            self.slopes.values(&steady.iter().map(place).collect::<Vec<_>>(), work)
        });
        for (lane, part) in steady.iter().enumerate() {
            let ray = &mut rays[part.ray];
            let ends = [0, 1].map(|end| values[end][lane]);
            match ends.map(sign) {
                [Some(a), Some(b)] if a == b => ray.leaving = false,
                // The only root in this part is the one that the ray starts on.
                [Some(_), Some(_)] if ray.leaving => ray.leaving = false,
                [Some(_), Some(_)] => {
                    let enough = ray.way.longest.max(ray.grain);
                    ray.isolated = Some(Isolated::new(part.ends, ends, enough));
                    ray.parts.clear();
                }
                _ => self.cut(ray, part, work),
            }
        }
    }

    /// Cuts a part in two, or leaves it open if it is as short as precision allows.
    fn cut(&self, ray: &mut Search, part: &Candidate, work: &mut KernelStats) {
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
        let spent = ray.looked > PATIENCE;
        let bridge = Bridge { kernel: self.slopes.kernel(), way: ray.way, region: self.region };
        if ray.outcome.open.is_none()
            && let Some(bracket) = bridge.bracket(part.ends)
        {
            ray.outcome.hit = Some(bracket);
            ray.parts.clear();
            return;
        }
        let facts = self.slopes.facts(&part.cuboid, work);
        let reason = reason(facts, spent);
        ray.outcome.open.get_or_insert((near, reason));
        ray.opened += 1;
        if !(self.suppress_asymptotes && part.unbounded) {
            ray.outcome.likely = Some(near);
            ray.parts.clear();
        } else if ray.opened == OPEN_PARTS {
            work.given_up += 1;
            ray.parts.clear();
        }
    }
}

impl<'a> Search<'a> {
    fn new<T: Scalar>(way: &'a LocalRay, start: Start) -> Self {
        let [near, far] = way.span;
        let [first, last] = [way.inside[0].max(near), way.inside[1].min(far)];
        // No sign is known where the ray crosses the region's faces. Rounding leaves the ends there
        // open, so they are separate parts.
        let mut parts = Vec::with_capacity(16);
        if first < last {
            parts.extend([[last, far], [first, last], [near, first]]);
            parts.retain(|[near, far]| near < far);
        } else {
            parts.push([near, far]);
        }
        let size = (way.origin.abs() + far.abs() * way.direction.abs()).max_element();
        let rounding = 4.0 * T::UNIT * size / way.direction.abs().max_element();
        let grain = (T::GRAIN * far.abs()).max(rounding);
        Self {
            way,
            parts,
            grain,
            looked: 0,
            opened: 0,
            leaving: start == Start::OnSurface,
            outcome: Outcome::default(),
            isolated: None,
        }
    }
}

fn cuboids(parts: &[Candidate]) -> Vec<Cuboid> {
    parts.iter().map(|part| part.cuboid).collect()
}
