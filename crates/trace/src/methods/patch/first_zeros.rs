//! The first zeros of a group's rays, from the first cells that each ray may meet.
//!
//! All zeros in a cell lie in the part of it that the linear equations leave. That part is
//! evaluated anew, and so on, as in Newton's method. Each round does so for all rays of the group
//! at once.

use super::meeting::{BeamLanes, CellView, Firsts, Meetings, ZeroLanes};
use super::search::{Goal, is_narrow, part, with_room};
use super::{Found, PatchTracer};
use crate::kernel_stats::KernelStats;
use crate::painted::ones;
use zeroset_eval::{LANES, LaneSet, Lanes, Patches, dispatch};
use zeroset_space::PatchCell;

/// Largest number of times that a cell's part is evaluated anew.
const ROUNDS: usize = 3;

/// Bounds of the first zeros of up to [`LANES`] rays.
pub(super) struct FirstZeros {
    /// The t before which a ray is proven to meet no zero: in its first cell, in its second, and in
    /// all others. Infinite if it meets none there.
    near: [Lanes<f64>; 3],
    /// A proven zero of each ray. It need not be the first.
    zero: ZeroLanes,
}

impl FirstZeros {
    /// Bounds of the first zero of a ray in the region: the t before which there is none, and one
    /// before which a zero is proven, or infinity. `None` if the ray meets no zero.
    pub fn of(&self, lane: usize) -> Option<[f64; 2]> {
        let [one, two, rest] = &self.near;
        let near = one.0[lane].min(two.0[lane]).min(rest.0[lane]);
        let far = self.zero.far.0[lane];
        // A zero that is proven is never in a part that holds none.
        debug_assert!(far == f64::INFINITY || near <= far, "{near} {far}");
        (near < f64::INFINITY).then_some([near, far])
    }

    /// Approximate u and v of the proven zero.
    pub fn parameters(&self, lane: usize) -> [f64; 2] {
        [self.zero.parameters[0].0[lane], self.zero.parameters[1].0[lane]]
    }
}

impl PatchTracer<'_> {
    /// The first zeros of rays that meet some of `cells` as `firsts` tells. Lanes without a goal
    /// are not in use.
    pub(super) fn first_zeros(
        &self,
        rays: &BeamLanes,
        goals: &[Option<Goal>; LANES],
        firsts: Firsts,
        cells: &[Found<'_>],
        work: &mut KernelStats,
    ) -> FirstZeros {
        let mut all = FirstZeros { near: firsts.near, zero: firsts.zero };
        for (rank, numbers) in firsts.cell.iter().enumerate() {
            // The rays whose bracket is still too long, and which meet this cell before its end.
            let mut open: LaneSet = 0;
            for (lane, goal) in goals.iter().enumerate() {
                let (Some(goal), Some(t)) = (goal, all.of(lane)) else { continue };
                let near = all.near[rank].0[lane];
                let is_open = near < f64::INFINITY && near <= t[1] && !goal.is_short(t);
                open |= LaneSet::from(is_open) << lane;
            }
            if open != 0 {
                self.narrow(rays, goals, (&mut all, rank), (cells, numbers, open), work);
            }
        }
        all
    }

    /// Narrows the zeros in a cell for each ray of `open`. `numbers` are those of the rays' cells.
    fn narrow(
        &self,
        rays: &BeamLanes,
        goals: &[Option<Goal>; LANES],
        (all, rank): (&mut FirstZeros, usize),
        (cells, numbers, mut open): (&[Found<'_>], &Lanes<f64>, LaneSet),
        work: &mut KernelStats,
    ) {
        let FirstZeros { near, zero: ZeroLanes { far, parameters } } = all;
        let near = &mut near[rank];
        let mut shapes = Patches::default();
        let mut is_whole = [false; LANES];
        for lane in ones(open) {
            let Found { node, lane: own, is_whole: whole, .. } = cells[numbers.0[lane] as usize];
            shapes.copy_lane(lane, &node.cells, own);
            is_whole[lane] = whole;
        }
        for round in 0..=ROUNDS {
            let view = CellView::new(&shapes, rays.axes);
            let meetings = dispatch!(self.level, simd => Meetings::by_lane(simd, rays, &view));
            // Lanes that are not open have the whole rectangle.
            let (mut next, mut parts): (LaneSet, [PatchCell; LANES]) =
                (0, [self.tree.outer(); LANES]);
            for lane in ones(open) {
                let meeting = meetings.lane(lane);
                let is_nowhere = shapes.nowhere >> lane & 1 == 1;
                let goal = goals[lane].as_ref();
                if is_nowhere
                    || !meeting.is_possible
                    || goal.is_some_and(|goal| !goal.reaches(meeting.t) || goal.is_start(meeting.t))
                {
                    near.0[lane] = f64::INFINITY;
                    continue;
                }
                near.0[lane] = near.0[lane].max(meeting.t[0]);
                if round > 0 {
                    is_whole[lane] = self.is_whole(&shapes, lane);
                }
                let is_proven = is_whole[lane]
                    && meeting.is_inside()
                    && goal.is_some_and(|goal| goal.holds(meeting.t));
                if is_proven && meeting.t[1] < far.0[lane] {
                    far.0[lane] = meeting.t[1];
                    for (axis, all) in parameters.iter_mut().enumerate() {
                        let middle = shapes.middle[axis].0[lane];
                        let half = shapes.half[axis].0[lane];
                        all.0[lane] = middle + half * meeting.symbols[axis][0];
                    }
                }
                let is_short = goal.is_none_or(|goal| goal.is_short([near.0[lane], far.0[lane]]));
                if !is_short && round < ROUNDS && is_narrow(&meeting) {
                    parts[lane] = with_room(part(self.tree, &meeting, &shapes, lane), self.tree);
                    next |= 1 << lane;
                }
            }
            if next == 0 {
                break;
            }
            shapes = self.tree.over(&parts);
            work.tiles.called(next.count_ones());
            open = next;
        }
    }
}
