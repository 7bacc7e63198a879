//! Parametric surfaces: rays are followed through the cells of u and v.
//!
//! Cells that a group of 16 rays may meet are found by one test for all of the group. Each ray then
//! has a few candidates: cells with bounds of t. The candidate that begins first is examined first.
//! It is dropped if it is proven empty, it is the hit if a zero is proven, and else it is narrowed.
//! So nothing lies before a hit, and a ray without candidates is a miss.

mod meeting;
mod search;

use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Segment, Start, Task, Tracer};
use crate::options;
use crate::options::TraceOptions;
use crate::painted::ones;
use crate::ray_result::RayResult;
use fearless_simd::Level;
use meeting::{Beam, BeamLanes, Meetings, main_axis, with_cell};
use search::{Goal, Place, Search};
use zeroset_eval::{KernelError, LANES, Patches, dispatch};
use zeroset_space::{PatchNode, PatchTree, Region};

/// The only method for parametric surfaces. Other methods are for equations and solids.
pub static PATCH: Method = Method {
    name: "patch",
    help: "follows rays through the cells of a parametric surface, for which it is the only method",
    proves: Proves::HitsAndMisses,
    reads: &[options::TOLERANCE],
    prepare: [no_function, no_function],
};

/// This method needs a surface's tree, not a function.
fn no_function(_: Task<'_>) -> Result<Box<dyn Tracer + '_>, KernelError> {
    Err(KernelError::from(Box::<dyn std::error::Error + Send + Sync>::from(
        "only parametric surfaces have cells",
    )))
}

/// Prepares to follow rays to a parametric surface in `region`.
pub fn patch_tracer<'a>(
    tree: &'a PatchTree,
    region: &'a Region,
    options: TraceOptions,
) -> Box<dyn Tracer + 'a> {
    Box::new(PatchTracer { tree, region, options, level: Level::new() })
}

struct PatchTracer<'a> {
    tree: &'a PatchTree,
    region: &'a Region,
    options: TraceOptions,
    level: Level,
}

/// Cells are divided for a group of rays until their error is this share of the longest bracket.
const GROUP_ERROR: f64 = 0.15;
/// Largest number of levels below the root to which cells are divided for a group of rays.
const GROUP_DEPTH: u32 = 5;
/// Beyond this number of cells for a group of rays, none is divided further.
const GROUP_CELLS: usize = 256;

/// A cell that some rays of a group may meet.
#[derive(Clone, Copy)]
struct Found<'a> {
    node: &'a PatchNode,
    lane: usize,
    depth: u32,
}

impl Tracer for PatchTracer<'_> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        for (rays, found) in rays.chunks(LANES).zip(found.chunks_mut(LANES)) {
            self.follow_group(rays, start, found, work);
        }
    }
}

impl<'a> PatchTracer<'a> {
    /// Follows at most [`LANES`] rays.
    fn follow_group(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        let (mut goals, mut beams) = (Vec::with_capacity(LANES), Vec::with_capacity(LANES));
        let mut lanes = Vec::with_capacity(LANES);
        let main = main_axis(rays[0].ray.direction);
        for (lane, segment) in rays.iter().enumerate() {
            let Some(within) = segment.within(self.region) else {
                found[lane] = RayResult::MISS;
                continue;
            };
            let own = main_axis(segment.ray.direction);
            let is_alike =
                2.0 * segment.ray.direction[main].abs() >= segment.ray.direction[own].abs();
            beams.push(Beam::along(&segment.ray, if is_alike { main } else { own }));
            goals.push(Goal::new(segment, within, self.region, start, &self.options, self.level));
            lanes.push(lane);
        }
        if lanes.is_empty() {
            return;
        }
        let lines = BeamLanes::new(&beams);
        let group = lines.as_ref().and_then(|_| Beam::around(&beams));
        let cells = group.map(|group| self.cells(&group, &goals));
        let firsts = match (&lines, &cells) {
            (Some(lines), Some(cells)) => self.firsts(lines, cells, &goals),
            _ => [First::Unknown; LANES],
        };
        let mut candidates = Vec::new();
        for (k, lane) in lanes.into_iter().enumerate() {
            let (beam, goal) = (&beams[k], &goals[k]);
            found[lane] = match firsts[k] {
                First::Nothing => RayResult::MISS,
                First::Proven(t) if let Some(hit) = goal.hit(t) => hit,
                First::Proven(_) | First::Unknown => {
                    candidates.clear();
                    match &cells {
                        Some(cells) => {
                            for &Found { node, lane, depth } in cells {
                                let meeting = with_cell(beam, &node.cells, lane);
                                let place = Place::InTree { node, lane, depth };
                                let new =
                                    goal.candidate(self.tree, &meeting, &node.cells, place, lane);
                                candidates.extend(new);
                            }
                        }
                        None => {
                            goal.add((beam, self.tree), (self.tree.root(), 0), &mut candidates);
                        }
                    }
                    Search { tree: self.tree, beam, goal }.run(&mut candidates, work)
                }
            };
        }
    }

    /// Finds the first meeting of each ray with `cells`, which hold all points that it meets.
    fn firsts(&self, lines: &BeamLanes, cells: &[Found<'_>], goals: &[Goal<'_>]) -> [First; LANES] {
        let mut firsts = [First::Nothing; LANES];
        let mut nearest = [f64::INFINITY; LANES];
        for &Found { node, lane, .. } in cells {
            let meetings =
                dispatch!(self.level, simd => Meetings::with_rays(simd, lines, &node.cells, lane));
            let is_whole = self.is_whole(&node.cells, lane);
            for (k, goal) in goals.iter().enumerate() {
                let meeting = meetings.lane(k);
                if !meeting.is_possible || !goal.reaches(meeting.t) || meeting.t[0] >= nearest[k] {
                    continue;
                }
                nearest[k] = meeting.t[0];
                firsts[k] = if is_whole && meeting.is_inside() {
                    First::Proven(meeting.t)
                } else {
                    First::Unknown
                };
            }
        }
        firsts
    }

    /// Returns whether the surface is continuous on a cell, and all of it belongs to the exact
    /// rectangle.
    fn is_whole(&self, cells: &Patches<f64>, lane: usize) -> bool {
        let is_within = |axis: usize| {
            let ([low, high], slack) = (self.tree.inner()[axis], 4.0 * f64::EPSILON);
            let (middle, half) = (cells.middle[axis][lane], cells.half[axis][lane]);
            let slack = slack * (middle.abs() + half);
            low <= middle - half - slack && middle + half + slack <= high
        };
        cells.continuous >> lane & 1 == 1 && is_within(0) && is_within(1)
    }

    /// The cells that rays of a beam may meet.
    fn cells(&self, beam: &Beam, goals: &[Goal<'_>]) -> Vec<Found<'a>> {
        let enough = goals.iter().map(|goal| goal.longest_distance).fold(f64::INFINITY, f64::min);
        let enough = GROUP_ERROR * enough;
        let mut found = Vec::new();
        let mut open = vec![(self.tree.root(), 0)];
        while let Some((node, depth)) = open.pop() {
            let meetings =
                dispatch!(self.level, simd => Meetings::with_cells(simd, beam, &node.cells));
            for lane in ones(meetings.possible() & !node.cells.nowhere) {
                let is_room = found.len() + open.len() < GROUP_CELLS;
                if depth < GROUP_DEPTH && is_room && error(&node.cells, lane) > enough {
                    open.push((self.tree.part(node, lane), depth + 1));
                } else {
                    found.push(Found { node, lane, depth });
                }
            }
        }
        found
    }
}

/// The first meeting of a ray with cells.
#[derive(Clone, Copy, Debug)]
enum First {
    /// It is proven to meet no zero.
    Nothing,
    /// A zero is proven between these t. Before them, it is proven to meet no zero.
    Proven([f64; 2]),
    /// Neither is proven.
    Unknown,
}

/// The largest error of a coordinate over a cell.
fn error(cells: &Patches<f64>, lane: usize) -> f64 {
    let [x, y, z] = cells.error.each_ref().map(|error| error[lane]);
    // NaN counts as infinite.
    let largest = x.max(y).max(z);
    if (x + y + z).is_finite() { largest } else { f64::INFINITY }
}
