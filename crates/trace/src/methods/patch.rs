//! Parametric surfaces: rays are followed through the cells of u and v.
//!
//! Cells that some ray of a square may meet are found by one test a cell for the whole square. Of
//! them, those that some ray of a group of 16 may meet, by one test for the group. Then each cell is
//! tested with all rays of the group at once, the nearest cells first. Most rays are decided so: the
//! first cell that a ray may meet proves a zero in a bracket that is short enough, or there is none.
//!
//! Each other ray has a few candidates: cells with bounds of t. The candidate that begins first is
//! examined first. It is dropped if it is proven empty, it is the hit if a zero is proven, and else
//! it is narrowed. So nothing lies before a hit, and a ray without candidates is a miss.

mod meeting;
mod search;

use crate::kernel_stats::KernelStats;
use crate::method::{Method, Proves, Segment, Start, Task, Tracer};
use crate::options;
use crate::options::TraceOptions;
use crate::painted::ones;
use crate::ray_result::RayResult;
use fearless_simd::Level;
use meeting::{Beam, BeamLanes, CellLanes, CellShape, First, Firsts, main_axis, with_cell};
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

/// Cells are divided for a square of rays until their error is this share of the longest bracket.
const ERROR: f64 = 0.15;
/// Largest number of levels below the root to which cells are divided for a square of rays.
const GROUP_DEPTH: u32 = 5;
/// Beyond this number of cells for a square of rays, none is divided further.
const GROUP_CELLS: usize = 256;

/// A ray in the region.
struct Line<'s> {
    /// Its number among the rays that are followed.
    place: usize,
    beam: Beam,
    goal: Goal<'s>,
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

/// Cells that some rays may meet, and their shapes.
#[derive(Default)]
struct FoundCells<'a> {
    cells: Vec<Found<'a>>,
    /// [`LANES`] cells each.
    shapes: Vec<CellLanes>,
}

impl Tracer for PatchTracer<'_> {
    fn follow(
        &self,
        rays: &[Segment],
        start: Start,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        let Some(first) = rays.first() else { return };
        let main = main_axis(first.ray.direction);
        let mut lines = Vec::with_capacity(rays.len());
        for (place, segment) in rays.iter().enumerate() {
            let Some(within) = segment.within(self.region) else {
                found[place] = RayResult::MISS;
                continue;
            };
            let direction = segment.ray.direction;
            let own = main_axis(direction);
            let is_alike = 2.0 * direction[main].abs() >= direction[own].abs();
            let beam = Beam::along(&segment.ray, if is_alike { main } else { own });
            let goal = Goal::new(segment, within, self.region, start, &self.options, self.level);
            lines.push(Line { place, beam, goal });
        }
        let cells = self.cells(&lines);
        let mut near = Vec::new();
        for lines in lines.chunks(LANES) {
            // Rays of a square that go apart may go together in a group.
            let own = if cells.is_none() { self.cells(lines) } else { None };
            match cells.as_ref().or(own.as_ref()) {
                Some(cells) => self.follow_group(lines, cells, &mut near, found, work),
                None => {
                    for line in lines {
                        found[line.place] = self.follow_alone(line, work);
                    }
                }
            }
        }
    }
}

impl<'a> PatchTracer<'a> {
    /// Follows one ray through all cells.
    fn follow_alone(
        &self,
        Line { beam, goal, .. }: &Line<'_>,
        work: &mut KernelStats,
    ) -> RayResult {
        let mut candidates = Vec::new();
        goal.add((beam, self.tree), (self.tree.root(), 0), &mut candidates);
        Search { tree: self.tree, beam, goal }.run(&mut candidates, work)
    }

    /// Follows at most [`LANES`] rays with the same axis k through `cells`, which hold all points
    /// that they meet. Uses `near` as memory.
    fn follow_group(
        &self,
        lines: &[Line<'_>],
        cells: &FoundCells<'a>,
        near: &mut Vec<(f64, usize)>,
        found: &mut [RayResult],
        work: &mut KernelStats,
    ) {
        let group = Beam::around(lines.iter().map(|line| &line.beam));
        near.clear();
        match &group {
            Some(group) => {
                for (batch, shapes) in cells.shapes.iter().enumerate() {
                    let first = LANES * batch;
                    let (possible, from) =
                        dispatch!(self.level, simd => group.meets(simd, &shapes.view()));
                    let count = cells.cells.len() - first;
                    let new = ones(possible).take_while(|lane| *lane < count);
                    near.extend(new.map(|lane| (from[lane], first + lane)));
                }
                near.sort_unstable_by(|(one, _), (other, _)| one.total_cmp(other));
            }
            None => near.extend((0..cells.cells.len()).map(|cell| (f64::NEG_INFINITY, cell))),
        }
        let rays = BeamLanes::new(lines.iter().map(|line| &line.beam));
        let mut firsts = Firsts::new(lines.iter().map(|line| line.goal.within));
        for &(from, cell) in near.iter() {
            // The cells that are left begin behind the first meetings of all rays.
            if from >= firsts.farthest() {
                break;
            }
            let Found { node, lane, is_whole, .. } = cells.cells[cell];
            let cell = (&node.cells, lane);
            dispatch!(self.level, simd => firsts.meet(simd, &rays, cell, is_whole));
        }
        let mut candidates = Vec::new();
        for (lane, Line { place, beam, goal }) in lines.iter().enumerate() {
            found[*place] = match firsts.of(lane) {
                First::Nothing => RayResult::MISS,
                First::Proven { t, parameters } if let Some(hit) = goal.hit(t, parameters) => hit,
                First::Proven { .. } | First::Unknown => {
                    candidates.clear();
                    for (_, cell) in near.iter() {
                        let Found { node, lane, depth, .. } = cells.cells[*cell];
                        let meeting = with_cell(beam, &node.cells, lane);
                        let place = Place::InTree { node, lane, depth };
                        let new = goal.candidate(self.tree, &meeting, &node.cells, place, lane);
                        candidates.extend(new);
                    }
                    Search { tree: self.tree, beam, goal }.run(&mut candidates, work)
                }
            };
        }
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

    /// The cells that some of `lines` may meet. `None` if the rays do not go together.
    fn cells(&self, lines: &[Line<'_>]) -> Option<FoundCells<'a>> {
        let beam = Beam::around(lines.iter().map(|line| &line.beam))?;
        let longest = lines.iter().map(|line| line.goal.longest_distance);
        let enough = ERROR * longest.fold(f64::INFINITY, f64::min);
        let mut found = FoundCells::default();
        let mut open = vec![(self.tree.root(), 0)];
        while let Some((node, depth)) = open.pop() {
            let cells = CellLanes::of_node(&node.cells, beam.axes);
            let (possible, _) = dispatch!(self.level, simd => beam.meets(simd, &cells));
            for lane in ones(possible & !node.cells.nowhere) {
                let is_room = found.cells.len() + open.len() < GROUP_CELLS;
                if depth < GROUP_DEPTH && is_room && error(&node.cells, lane) > enough {
                    open.push((self.tree.part(node, lane), depth + 1));
                    continue;
                }
                let place = found.cells.len() % LANES;
                if place == 0 {
                    found.shapes.push(CellLanes::default());
                }
                if let Some(shapes) = found.shapes.last_mut() {
                    shapes.set(place, &CellShape::new(&node.cells, beam.axes, lane));
                }
                let is_whole = self.is_whole(&node.cells, lane);
                found.cells.push(Found { node, lane, depth, is_whole });
            }
        }
        Some(found)
    }
}

/// The largest error of a coordinate over a cell.
fn error(cells: &Patches<f64>, lane: usize) -> f64 {
    let (x, y, z) = (cells.error[0][lane], cells.error[1][lane], cells.error[2][lane]);
    // NaN counts as infinite.
    let largest = x.max(y).max(z);
    if (x + y + z).is_finite() { largest } else { f64::INFINITY }
}
