//! The search for the first zero of one ray among its candidates.

use super::meeting::{Beam, CellView, Meeting, Meetings, with_cell};
use crate::kernel_stats::KernelStats;
use crate::method::{Segment, Start};
use crate::options::TraceOptions;
use crate::painted::ones;
use crate::ray_result::{RayResult, Status, UndecidedReason};
use fearless_simd::Level;
use zeroset_eval::{LANES, Patches, dispatch};
use zeroset_space::{PatchCell, PatchNode, PatchTree, Region, columns};

/// Largest effort for one ray: a test of the cells of a node counts 1, an evaluation more.
const EFFORT: u32 = 16 * 256;
/// The same for a preview.
const PREVIEW_EFFORT: u32 = 16 * 32;
/// Effort of evaluating the surface over cells that are not in the tree.
const EVALUATION: u32 = 16;
/// Largest depth of the tree. Deeper cells are evaluated for one ray, and forgotten.
const DEPTH: u32 = 6;
/// A cell is narrowed to the bounds of its zeros if they are shorter than this share of it.
const NARROW: f64 = 0.4;
/// A narrowed cell is wider than the bounds of its zeros by this factor, so that the next bounds
/// may lie inside it.
const ROOM: f64 = 1.25;
/// For rays on which the place of a zero does not matter: the length to which brackets are
/// narrowed, as a share of the ray's length in the region.
pub(super) const SHADOW_LENGTH: f64 = 1.0 / 1024.0;
/// A range of u or v is not divided below this share of its numbers' size.
const FINEST: f64 = 8.0 * f64::EPSILON;

/// The part of a ray to search, and the result that is wanted.
pub(super) struct Goal {
    /// Only for t between these may the segment be in the region.
    pub within: [f64; 2],
    /// For all t between these, the segment is in the region.
    pub sure: [f64; 2],
    /// Greatest length of a bracket in t: at t = 0, and its growth per t.
    longest: [f64; 2],
    start: Start,
    effort: u32,
    level: Level,
}

/// A cell that a ray may meet.
#[derive(Clone, Copy)]
#[allow(clippy::struct_excessive_bools, reason = "each is a fact of its own")]
pub(super) struct Candidate<'a> {
    /// Bounds of t at the zeros.
    t: [f64; 2],
    /// Bounds of u and v at the zeros in the cell.
    part: PatchCell,
    /// Whether a zero is proven to exist, with u and v within the bounds.
    is_proven: bool,
    /// Whether the bounds of u and v are much shorter than the cell.
    is_narrow: bool,
    /// Whether the linear equations of the cell have a solution in it.
    is_likely: bool,
    /// Whether the surface is continuous on the cell.
    is_continuous: bool,
    /// Number of columns in which to divide the part.
    columns: usize,
    place: Place<'a>,
}

/// Where a cell is stored.
#[derive(Clone, Copy)]
pub(super) enum Place<'a> {
    /// A lane of a node at a depth.
    InTree { node: &'a PatchNode, lane: usize, depth: u32 },
    /// Nowhere.
    Apart,
}

impl Candidate<'_> {
    /// The u and v in the middle of the part.
    fn middle(&self) -> [f64; 2] {
        self.part.map(|[low, high]| 0.5 * (low + high))
    }

    /// Returns whether the part of the rectangle is too small to be divided.
    fn is_finest(&self) -> bool {
        self.part.iter().all(|[low, high]| high - low <= FINEST * (low.abs() + high.abs()))
    }
}

impl Goal {
    /// The goal for a segment in a region. `None` if the segment is outside of it. Without a
    /// region, the segment's ends alone matter.
    pub fn new(
        segment: &Segment,
        region: Option<&Region>,
        start: Start,
        options: &TraceOptions,
        level: Level,
    ) -> Option<Self> {
        let (mut within, mut sure) = ([0.0, segment.to], [0.0, segment.to]);
        if let Some(region) = region {
            within = segment.within(region)?;
            let [first, last] = region.inner(&segment.ray);
            sure = [first.max(0.0), last.min(segment.to)];
        }

        let [first, growth] = segment.pixel;
        let longest = if first.is_finite() {
            [options.longest() * first, options.longest() * growth]
        } else {
            // The place of a zero does not matter.
            [SHADOW_LENGTH * (within[1] - within[0]), 0.0]
        };
        let effort = if options.least > 0.0 { PREVIEW_EFFORT } else { EFFORT };
        Some(Self { within, sure, longest, start, effort, level })
    }

    /// Adds the cells of a node that the ray may meet.
    pub fn add<'a>(
        &self,
        (beam, tree): (&Beam, &PatchTree),
        (node, depth): (&'a PatchNode, u32),
        candidates: &mut Vec<Candidate<'a>>,
    ) {
        let cells = CellView::new(&node.cells, beam.axes);
        let meetings = dispatch!(self.level, simd => Meetings::with_cells(simd, beam, &cells));
        for lane in ones(meetings.possible()) {
            let (meeting, place) = (meetings.lane(lane), Place::InTree { node, lane, depth });
            candidates.extend(self.candidate(tree, &meeting, &node.cells, place, lane));
        }
    }

    /// The candidate of a cell. `None` if the ray meets no zero in it within the region.
    pub fn candidate<'a>(
        &self,
        tree: &PatchTree,
        meeting: &Meeting,
        cells: &Patches<f64>,
        place: Place<'a>,
        lane: usize,
    ) -> Option<Candidate<'a>> {
        let is_nowhere = cells.nowhere >> lane & 1 == 1;
        if !meeting.is_possible || is_nowhere || !self.reaches(meeting.t) {
            return None;
        }
        let is_continuous = cells.continuous >> lane & 1 == 1;
        let part = part(tree, meeting, cells, lane);
        let is_within = |axis: usize| {
            let ([low, high], inner) = (part[axis], tree.inner()[axis]);
            inner[0] <= low && high <= inner[1]
        };
        let is_proven = is_continuous && meeting.is_inside() && is_within(0) && is_within(1);
        let is_narrow = is_narrow(meeting);
        let is_likely =
            meeting.is_solved && meeting.symbols.iter().all(|part| part[0].abs() <= 1.0);
        let shares = [meeting.symbols[0][1].min(1.0), meeting.symbols[1][1].min(1.0)];
        let columns = columns(shares, cells, lane);
        Some(Candidate {
            columns,
            t: meeting.t,
            part,
            is_proven,
            is_narrow,
            is_likely,
            is_continuous,
            place,
        })
    }

    /// Returns whether a ray may have a zero at a t between these.
    pub fn reaches(&self, [near, far]: [f64; 2]) -> bool {
        !(near > self.within[1] || far < self.within[0])
    }

    /// The result for a proven zero between these t and near these u and v, before which there is
    /// none. `None` if it is not short enough, may lie outside of the region, or may be that of the
    /// ray's start.
    pub fn hit(&self, t: [f64; 2], parameters: [f64; 2]) -> Option<RayResult> {
        let is_hit = !self.holds_start(t) && self.is_short(t) && self.holds(t);
        let middle = 0.5 * (t[0] + t[1]);
        is_hit.then_some(RayResult {
            status: Status::Hit,
            distance: middle,
            drawn: middle,
            bracket: t,
            parameters: [parameters[0] as f32, parameters[1] as f32],
            ..RayResult::MISS
        })
    }

    /// Returns whether a zero between these t may be the point of the surface at which the ray
    /// starts. A zero counts only behind an empty part.
    fn holds_start(&self, t: [f64; 2]) -> bool {
        self.start == Start::OnSurface && t[0] <= self.within[0].max(0.0)
    }

    /// Returns whether zeros between these t are the ray's start.
    pub fn is_start(&self, t: [f64; 2]) -> bool {
        self.holds_start(t) && self.is_short(t)
    }

    /// Returns whether a bracket is short enough.
    pub fn is_short(&self, [near, far]: [f64; 2]) -> bool {
        far - near <= self.longest[0] + self.longest[1] * near.max(0.0)
    }

    /// Returns whether all of a bracket is proven to be in the region and on the segment.
    pub fn holds(&self, [near, far]: [f64; 2]) -> bool {
        self.sure[0] <= near && far <= self.sure[1]
    }
}

/// The search along one ray.
pub(super) struct Search<'s, 'a> {
    pub tree: &'a PatchTree,
    pub beam: &'s Beam,
    pub goal: &'s Goal,
}

impl<'a> Search<'_, 'a> {
    /// Finds the first zero. `candidates` holds all cells in which the ray may have one.
    pub fn run(&self, candidates: &mut Vec<Candidate<'a>>, work: &mut KernelStats) -> RayResult {
        let goal = self.goal;
        // The first part that stays undecided, and why.
        let mut open: Option<(f64, UndecidedReason)> = None;
        let (mut drawn, mut parameters) = (f64::INFINITY, [0.0; 2]);
        let mut effort = goal.effort;
        while let Some(first) = take_first(candidates) {
            if goal.is_start(first.t) {
                continue;
            }
            if first.is_proven
                && let Some(hit) = goal.hit(first.t, first.middle())
            {
                if open.is_none() {
                    return hit;
                }
                (drawn, parameters) = (hit.drawn, hit.parameters);
                break;
            }
            if effort > 0 && !first.is_finest() {
                effort = effort.saturating_sub(self.narrow(&first, candidates, work));
                continue;
            }
            let reason = if !first.is_continuous {
                UndecidedReason::Discontinuous
            } else if effort == 0 {
                UndecidedReason::Budget
            } else {
                UndecidedReason::Touching
            };
            let from = first.t[0].max(goal.within[0]);
            open.get_or_insert((from, reason));
            let middle = 0.5 * (first.t[0] + first.t[1]);
            if first.is_likely && middle.is_finite() {
                drawn = middle.max(from);
                parameters = first.middle().map(|parameter| parameter as f32);
            }
            if drawn.is_finite() || effort == 0 {
                // Whatever lies behind is not drawn.
                break;
            }
        }
        let Some((distance, reason)) = open else { return RayResult::MISS };
        RayResult {
            status: Status::Undecided,
            distance,
            drawn,
            parameters,
            reason,
            ..RayResult::MISS
        }
    }

    /// Replaces a candidate by smaller ones that hold all its zeros. Returns the effort.
    fn narrow(
        &self,
        candidate: &Candidate<'a>,
        candidates: &mut Vec<Candidate<'a>>,
        work: &mut KernelStats,
    ) -> u32 {
        if let Place::InTree { node, lane, depth } = candidate.place
            && depth < DEPTH
            && !candidate.is_narrow
        {
            let part = self.tree.part(node, lane);
            self.goal.add((self.beam, self.tree), (part, depth + 1), candidates);
            return 1;
        }
        if candidate.is_narrow {
            let cells = self.tree.over(&[with_room(candidate.part, self.tree)]);
            work.tiles.called(1);
            let meeting = with_cell(self.beam, &cells, 0);
            candidates.extend(self.goal.candidate(self.tree, &meeting, &cells, Place::Apart, 0));
            return EVALUATION;
        }
        let node = self.tree.divide(candidate.part, candidate.columns);
        work.tiles.called(LANES as u32);
        let level = self.goal.level;
        let cells = CellView::new(&node.cells, self.beam.axes);
        let meetings = dispatch!(level, simd => Meetings::with_cells(simd, self.beam, &cells));
        for lane in ones(meetings.possible()) {
            let (meeting, place) = (meetings.lane(lane), Place::Apart);
            candidates.extend(self.goal.candidate(self.tree, &meeting, &node.cells, place, lane));
        }
        EVALUATION
    }
}

/// Returns whether the zeros in a cell lie in a much smaller part of it.
pub(super) fn is_narrow(meeting: &Meeting) -> bool {
    let [[_, u], [_, v]] = meeting.symbols;
    meeting.is_solved && u <= NARROW && v <= NARROW
}

/// The part of a lane's cell that holds all zeros.
pub(super) fn part(
    tree: &PatchTree,
    meeting: &Meeting,
    cells: &Patches<f64>,
    lane: usize,
) -> PatchCell {
    let mut part = tree.outer();
    for (axis, range) in part.iter_mut().enumerate() {
        let (middle, half) = (cells.middle[axis].0[lane], cells.half[axis].0[lane]);
        let [symbol, reach] = meeting.symbols[axis];
        let [low, high] = [(symbol - reach).max(-1.0), (symbol + reach).min(1.0)];
        let slack = 4.0 * f64::EPSILON * (middle.abs() + half);
        let [low, high] = [middle + half * low - slack, middle + half * high + slack];
        *range = [low.max(range[0]), high.min(range[1])];
    }
    part
}

/// A cell around a part, with so much room that the next bounds of the zeros may lie inside it.
pub(super) fn with_room(part: PatchCell, tree: &PatchTree) -> PatchCell {
    let mut cell = tree.outer();
    for (range, [low, high]) in cell.iter_mut().zip(part) {
        let (middle, half) = (0.5 * (low + high), 0.5 * ROOM * (high - low));
        let slack = FINEST * middle.abs();
        *range = [(middle - half - slack).max(range[0]), (middle + half + slack).min(range[1])];
    }
    cell
}

/// Removes the candidate that begins first.
fn take_first<'a>(candidates: &mut Vec<Candidate<'a>>) -> Option<Candidate<'a>> {
    let places = candidates.iter().enumerate();
    let first = places.min_by(|(_, one), (_, other)| one.t[0].total_cmp(&other.t[0]))?.0;
    Some(candidates.swap_remove(first))
}
