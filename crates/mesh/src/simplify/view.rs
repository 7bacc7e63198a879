//! Old and new triangles of a change, as seen along a direction. All is exact.

use crate::simplify::projection::{Direction, Seen, area, volume};
use smallvec::SmallVec;

/// The corners of a triangle, as seen.
pub type Corners = [Seen; 3];

/// Directed edges, as seen.
pub type Sides = SmallVec<[[Seen; 2]; 16]>;

/// Old and new triangles, which all turn to the left.
#[derive(Default)]
pub struct View {
    pub direction: Direction,
    /// The corner that all new triangles share.
    pub apex: Seen,
    /// The vertices that move, or are dropped.
    pub moving: SmallVec<[Seen; 2]>,
    pub old: SmallVec<[Corners; 16]>,
    pub new: SmallVec<[Corners; 16]>,
    /// The triangles that edges of the moving vertex sweep, if it is on a rim.
    pub sweeps: SmallVec<[Corners; 16]>,
}

impl View {
    /// Triangles that cover all that is swept.
    pub fn all(&self) -> impl Iterator<Item = &Corners> {
        self.old.iter().chain(&self.new).chain(&self.sweeps)
    }

    /// The edges that face the apex and have all new triangles to their left. The apex is to the
    /// left of each edge that faces it.
    pub fn sides(&self) -> Sides {
        let holds_all = |&[a, b]: &[Seen; 2]| {
            self.new.iter().all(|&[_, p, q]| area(a, b, p) >= 0 && area(a, b, q) >= 0)
        };
        self.new.iter().map(|&[_, a, b]| [a, b]).filter(holds_all).collect()
    }

    /// Returns whether old and new triangles are the same set of points: they have the same height
    /// at each vertex, and wherever edges cross.
    pub fn is_same(&self) -> bool {
        let is_flat = |triangles: &[Corners], point: Seen| {
            let holds = |&&[a, b, c]: &&Corners| {
                area(a, b, point) >= 0 && area(b, c, point) >= 0 && area(c, a, point) >= 0
            };
            triangles.iter().find(holds).is_some_and(|&[a, b, c]| volume(a, b, c, point) == 0)
        };
        if !self.moving.iter().all(|point| is_flat(&self.new, *point)) {
            return false;
        }
        let is_corner = self.old.iter().any(|corners| corners.contains(&self.apex));
        if !is_corner && !is_flat(&self.old, self.apex) {
            return false;
        }
        let apex = self.apex;
        let inner = self.old.iter().flat_map(edges).filter(|[from, _]| self.moving.contains(from));
        inner.into_iter().all(|[from, to]| {
            self.new.iter().flat_map(|&[_, a, b]| [a, b]).all(|end| {
                let splits = |from, to, one, other| {
                    area(from, to, one).signum() * area(from, to, other).signum() < 0
                };
                let crosses = splits(from, to, apex, end) && splits(apex, end, from, to);
                !crosses || volume(from, to, apex, end) == 0
            })
        })
    }
}

fn edges(&[a, b, c]: &Corners) -> [[Seen; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Returns whether a triangle turns to the left.
pub fn turns_left(&[a, b, c]: &Corners) -> bool {
    area(a, b, c) > 0
}

/// A triangle that turns to the left. `None` if it has no area.
pub fn turned_left([a, b, c]: Corners) -> Option<Corners> {
    match area(a, b, c) {
        0 => None,
        turn => Some(if turn > 0 { [a, b, c] } else { [a, c, b] }),
    }
}

/// The number of edges that cross the ray from `center` through `ahead`. All edges turn to the left
/// around the center, so this is the number of full turns, if they begin at the ray or are closed.
pub fn turns(center: Seen, ahead: Seen, edges: impl Iterator<Item = [Seen; 2]>) -> usize {
    let side = |end: Seen| area(center, ahead, end);
    edges.filter(|[from, to]| side(*from) < 0 && side(*to) >= 0).count()
}

/// Returns whether the two ends of a rim are never in the same direction from a point that moves
/// along a line between two `centers`.
pub fn ends_stay_apart(ends: [Seen; 2], centers: [Seen; 2]) -> bool {
    let [first, last] = ends;
    let [before, after] = centers.map(|center| area(center, first, last).signum());
    // Seen along the line between the ends.
    let along = |point: Seen| {
        let (x, y) = (i128::from(last.x - first.x), i128::from(last.y - first.y));
        x * i128::from(point.x - first.x) + y * i128::from(point.y - first.y)
    };
    let is_between = |center: &Seen| 0 < along(*center) && along(*center) < along(last);
    before * after > 0 || after == 0 || centers.iter().all(is_between)
}

/// Returns whether a line separates two triangles as seen. Corners of the first one may be on the
/// line if they `may_touch`. The first one may have no area; the other one turns to the left.
pub fn are_beside(one: &Corners, may_touch: [bool; 3], other: &Corners) -> bool {
    let right = |[a, b]: [Seen; 2], all: &Corners, may_touch: [bool; 3]| {
        all.iter().zip(may_touch).all(|(end, may_touch)| area(a, b, *end) < i128::from(may_touch))
    };
    let range = |corners: &Corners, along: fn(&Seen) -> i64| {
        let [a, b, c] = corners.each_ref().map(along);
        [a.min(b).min(c), a.max(b).max(c)]
    };
    let touches = i64::from(may_touch == [true; 3]);
    for along in [|seen: &Seen| seen.x, |seen: &Seen| seen.y] {
        let ([low, high], [from, to]) = (range(one, along), range(other, along));
        if high < from + touches || to < low + touches {
            return true;
        }
    }
    if edges(other).into_iter().any(|edge| right(edge, one, may_touch)) {
        return true;
    }
    // Along a side of the first triangle. Where one of its ends must not be touched, only corners
    // that both share may be on the line.
    let is_shared =
        |corner: &Seen| one.iter().zip(may_touch).any(|(own, may)| may && own == corner);
    let shared = other.each_ref().map(is_shared);
    let [a, b, c] = *one;
    let turn = area(a, b, c);
    [[0, 1], [1, 2], [2, 0]].into_iter().any(|[from, to]| {
        let (here, there) = (one[from], one[to]);
        let has_length = here.x != there.x || here.y != there.y;
        let touching = if may_touch[from] && may_touch[to] { [true; 3] } else { shared };
        has_length
            && ((turn >= 0 && right([here, there], other, touching))
                || (turn <= 0 && right([there, here], other, touching)))
    })
}

/// Returns whether a point is on a side of a triangle as seen.
pub fn is_on_side(corners: &Corners, point: Seen) -> bool {
    edges(corners).into_iter().any(|[from, to]| {
        let is_between = |a: i64, b: i64, c: i64| a.min(b) <= c && c <= a.max(b);
        area(from, to, point) == 0
            && is_between(from.x, to.x, point.x)
            && is_between(from.y, to.y, point.y)
    })
}
