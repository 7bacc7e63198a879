//! Parametric surfaces: rays are followed through the cells of u and v.
//!
//! One test a cell finds the cells that some ray of a square may meet. One more test a cell finds
//! those for a group of 16 rays. Each of these cells is tested with all rays of the group at once,
//! the nearest first. In the first two cells that a ray may meet, the part that may hold zeros is
//! evaluated anew, for all rays of the group at once, until the bracket of a proven zero is short
//! enough. Most rays are decided so.
//!
//! Each other ray has a few candidates: cells with bounds of t. The candidate that begins first is
//! examined first. It is dropped if it is proven empty, it is the hit if a zero is proven, and else
//! it is narrowed. So nothing lies before a hit, and a ray without candidates is a miss.

mod first_zeros;
mod meeting;
mod search;

use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Segment, Start, Task, Tracer};
use crate::options;
use crate::options::TraceOptions;
use crate::painted::ones;
use crate::ray_result::RayResult;
use fearless_simd::Level;
use meeting::{Beam, BeamLanes, CellView, Firsts, Meetings, axes, main_axis};
use search::{Candidate, Goal, Place, SHADOW_LENGTH, Search};
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
    let holds = |[x, y, z]: [[f64; 2]; 3]| {
        let (low, high) = (region.low(), region.high());
        let is_within =
            |axis: usize, [least, most]: [f64; 2]| low[axis] <= least && most <= high[axis];
        is_within(0, x) && is_within(1, y) && is_within(2, z)
    };
    let is_inside = !region.is_cut() && tree.bounds(BOX_DEPTH).is_some_and(holds);
    Box::new(PatchTracer { tree, region, is_inside, options, level: Level::new() })
}

struct PatchTracer<'a> {
    tree: &'a PatchTree,
    region: &'a Region,
    /// Whether the region is proven to hold all of the surface.
    is_inside: bool,
    options: TraceOptions,
    level: Level,
}

/// Number of levels of cells from whose bounds it is seen whether a region holds the surface.
const BOX_DEPTH: u32 = 1;

/// Cells are divided for a square of rays while their error is above the longest bracket times this
/// factor.
const LARGE: f64 = 1.5;
/// The same if the error is above a [share](ROUGH) of the cell's shorter side.
const SMALL: f64 = 0.5;
/// From cells whose error is above this share of their shorter side, parts that hold zeros are
/// seldom much smaller.
const ROUGH: f64 = 0.2;
/// A square's rays are followed together if they spread at most this many times as far as those of
/// a group.
const APART: f64 = 4.0;
/// Largest number of levels below the root to which cells are divided for a square of rays.
const GROUP_DEPTH: u32 = 5;
/// Beyond this number of cells for a square of rays, none is divided further.
const GROUP_CELLS: usize = 1024;

/// Up to [`LANES`] of the rays to follow.
struct Group {
    /// The number of the first ray, and how many there are.
    first: usize,
    count: usize,
    rays: BeamLanes,
    /// A beam around the rays. `None` if they do not go together.
    beam: Option<Beam>,
}

/// A cell that some rays may meet.
#[derive(Clone, Copy)]
struct Found<'a> {
    node: &'a PatchNode,
    lane: usize,
    depth: u32,
    /// Whether the surface is continuous on the cell, and all of it belongs to the exact rectangle.
    is_whole: bool,
}

/// Cells that some rays may meet.
#[derive(Default)]
struct FoundCells<'a> {
    cells: Vec<Found<'a>>,
    /// The surface over them, [`LANES`] cells each.
    shapes: Vec<Patches<f64>>,
}

impl Tracer for PatchTracer<'_> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        let Some(segment) = rays.first() else { return };
        let extent = self.region.half_extent();
        let axes = axes(main_axis(segment.ray.direction));
        let mut groups: Vec<Group> = Vec::with_capacity(rays.len().div_ceil(LANES));
        let mut whole = None;
        for (number, segments) in rays.chunks(LANES).enumerate() {
            let (rays, beam) = self.beam(segments, axes);
            whole = if number == 0 { beam } else { whole.zip(beam).and_then(Beam::of_both) };
            groups.push(Group { first: LANES * number, count: segments.len(), rays, beam });
        }
        let longest = self.longest(segment);
        // The groups of a square are neighbors, but those of a pixel's own rays may be far apart.
        let is_near = |whole: &Beam| {
            let own = |group: &Group| group.beam.as_ref().map(|beam| beam.spread(extent));
            let widest = groups.iter().filter_map(own).fold(0.0, f64::max);
            whole.spread(extent) <= APART * widest
        };
        let cells = whole.filter(is_near).map(|beam| self.cells(&beam, longest));
        let mut near = Vec::new();
        for group in &groups {
            let numbers = group.first..group.first + group.count;
            let (segments, found) = (&rays[numbers.clone()], &mut found[numbers]);
            // Rays of a square that go apart may go together in a group.
            let own = match (&cells, &group.beam) {
                (None, Some(beam)) => Some(self.cells(beam, longest)),
                _ => None,
            };
            match (cells.as_ref().or(own.as_ref()), &group.beam) {
                (Some(cells), Some(beam)) => {
                    self.nearest(beam, cells, &mut near);
                    self.follow_group(&group.rays, (segments, start), cells, &near, found, work);
                }
                _ => {
                    for (segment, found) in segments.iter().zip(found) {
                        *found = self.follow_alone(segment, start, work);
                    }
                }
            }
        }
    }
}

impl<'a> PatchTracer<'a> {
    /// The rays of at most [`LANES`] segments in lanes, and a beam around them. `None` if some ray
    /// advances too slowly along the axis k, or they spread too far.
    fn beam(&self, segments: &[Segment], axes: [usize; 3]) -> (BeamLanes, Option<Beam>) {
        let rays = BeamLanes::new(segments, axes);
        let beam = dispatch!(self.level, simd => rays.beam(simd));
        (rays, beam)
    }

    /// Greatest length of a bracket in world units, for a ray like this where it passes the
    /// region's middle.
    fn longest(&self, segment: &Segment) -> f64 {
        let Segment { ray, pixel: [first, growth], .. } = segment;
        let extent = self.region.half_extent();
        if !first.is_finite() {
            return SHADOW_LENGTH * extent;
        }
        let away = ray.origin.distance(self.region.centre()).max(extent);
        ray.distance(self.options.longest() * (first + growth * ray.parameter(away)))
    }

    /// The goal of a segment. `None` if it is outside of the region.
    fn goal(&self, segment: &Segment, start: Start) -> Option<Goal> {
        // Where the region holds all of the surface, only the segment's ends matter.
        let is_free = self.is_inside && segment.pixel[0].is_finite();
        let region = (!is_free).then_some(self.region);
        Goal::new(segment, region, start, &self.options, self.level)
    }

    /// Follows one ray through all cells.
    fn follow_alone(&self, segment: &Segment, start: Start, work: &mut KernelStats) -> RayResult {
        let Some(goal) = self.goal(segment, start) else { return RayResult::MISS };
        let beam = Beam::along(&segment.ray, axes(main_axis(segment.ray.direction)));
        let mut candidates = Vec::new();
        goal.add((&beam, self.tree), (self.tree.root(), 0), &mut candidates);
        Search { tree: self.tree, beam: &beam, goal: &goal }.run(&mut candidates, work)
    }

    /// Follows a group's rays through `cells`, which hold all points that they meet. `near` lists
    /// those that the group may meet, as [`Self::nearest`] does.
    fn follow_group(
        &self,
        rays: &BeamLanes,
        (segments, start): (&[Segment], Start),
        cells: &FoundCells<'a>,
        near: &[(f64, usize)],
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        if near.is_empty() {
            found.fill(RayResult::MISS);
            return;
        }
        let mut goals: [Option<Goal>; LANES] = [const { None }; LANES];
        let mut firsts = Firsts::default();
        for (lane, segment) in segments.iter().enumerate() {
            goals[lane] = self.goal(segment, start);
            if let Some(goal) = &goals[lane] {
                firsts.add(lane, goal.within, goal.sure);
            }
        }
        for &(from, number) in near {
            // In the cells that are left, no ray has its first zero.
            if from >= firsts.end() {
                break;
            }
            let Found { node, lane, is_whole, .. } = cells.cells[number];
            let cell = (&node.cells, lane);
            dispatch!(self.level, simd => firsts.meet(simd, rays, cell, number, is_whole));
        }
        let zeros = self.first_zeros(rays, &goals, firsts, &cells.cells, work);
        let mut candidates = Vec::new();
        for (lane, (segment, found)) in segments.iter().zip(found).enumerate() {
            *found = RayResult::MISS;
            let Some(goal) = goals[lane].as_ref() else { continue };
            let Some(t) = zeros.of(lane) else { continue };
            *found = goal.hit(t, zeros.parameters(lane)).unwrap_or_else(|| {
                let beam = Beam::along(&segment.ray, rays.axes);
                self.candidates(&beam, goal, cells, &mut candidates);
                Search { tree: self.tree, beam: &beam, goal }.run(&mut candidates, work)
            });
        }
    }

    /// Sets `candidates` to those of a ray among `cells`, which hold all points that it meets.
    fn candidates(
        &self,
        beam: &Beam,
        goal: &Goal,
        cells: &FoundCells<'a>,
        candidates: &mut Vec<Candidate<'a>>,
    ) {
        candidates.clear();
        for (shapes, cells) in cells.shapes.iter().zip(cells.cells.chunks(LANES)) {
            let shapes = CellView::new(shapes, beam.axes);
            let meetings = dispatch!(self.level, simd => Meetings::with_cells(simd, beam, &shapes));
            for place in ones(meetings.possible()).take_while(|place| *place < cells.len()) {
                let Found { node, lane, depth, .. } = cells[place];
                let (meeting, place) = (meetings.lane(place), Place::InTree { node, lane, depth });
                candidates.extend(goal.candidate(self.tree, &meeting, &node.cells, place, lane));
            }
        }
    }

    /// Writes to `near` the cells that a beam may meet, and the lowest t at which it does, in the
    /// order of these t.
    fn nearest(&self, beam: &Beam, cells: &FoundCells<'a>, near: &mut Vec<(f64, usize)>) {
        near.clear();
        for (batch, shapes) in cells.shapes.iter().enumerate() {
            let first = LANES * batch;
            let shapes = CellView::new(shapes, beam.axes);
            let (possible, from) = dispatch!(self.level, simd => beam.meets(simd, &shapes));
            let count = cells.cells.len() - first;
            for lane in ones(possible) {
                if lane < count {
                    near.push((from.0[lane], first + lane));
                }
            }
        }
        near.sort_unstable_by(|(one, _), (other, _)| one.total_cmp(other));
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

    /// The cells that some rays of a beam may meet. `longest` is the greatest length of a bracket.
    fn cells(&self, beam: &Beam, longest: f64) -> FoundCells<'a> {
        let mut found = FoundCells::default();
        let mut open = vec![(self.tree.root(), 0)];
        while let Some((node, depth)) = open.pop() {
            let cells = CellView::new(&node.cells, beam.axes);
            let (possible, _) = dispatch!(self.level, simd => beam.meets(simd, &cells));
            for lane in ones(possible & !node.cells.nowhere) {
                let is_room = found.cells.len() + open.len() < GROUP_CELLS;
                if depth < GROUP_DEPTH && is_room && is_coarse(&node.cells, lane, longest) {
                    open.push((self.tree.part(node, lane), depth + 1));
                    continue;
                }
                let place = found.cells.len() % LANES;
                if place == 0 {
                    found.shapes.push(Patches::default());
                }
                if let Some(shapes) = found.shapes.last_mut() {
                    shapes.copy_lane(place, &node.cells, lane);
                }
                let is_whole = self.is_whole(&node.cells, lane);
                found.cells.push(Found { node, lane, depth, is_whole });
            }
        }
        found
    }
}

/// Returns whether a cell is divided for a square of rays.
fn is_coarse(cells: &Patches<f64>, lane: usize, longest: f64) -> bool {
    let error = cells.largest_error(lane);
    if error <= SMALL * longest {
        return false;
    }
    let [u, v] = cells.sides(lane);
    error > LARGE * longest || error > ROUGH * u.min(v)
}
