//! How far a triangle is from the surface over a cell, from linear approximations over 16 parts of
//! the cell.
//!
//! Over a part, the surface is within an error of a linear function. A triangle is linear, too. So
//! their distance at the same u and v is largest at a corner of what the part and the triangle have
//! in common. The errors of parts are far smaller than that of the whole cell.

use super::{Ranges, parameters};
use glam::{DVec2, DVec3};
use smallvec::SmallVec;
use zeroset_eval::{LANES, Patches};
use zeroset_space::PatchTree;

/// Number of parts along u, and along v.
const SIDE: usize = 4;
/// Parts are longer than they are by this share of half their length, so that rounding leaves no
/// gap between them.
const WIDER: f64 = 1e-9;

/// The surface over the parts of a cell.
pub(super) struct Fine([Part; LANES]);

/// The surface over a part, as [`Patches`] have it.
#[derive(Clone, Copy)]
struct Part {
    middle: DVec2,
    half: DVec2,
    centre: DVec3,
    along: [DVec3; 2],
    /// Infinite if the surface may have a gap.
    error: f64,
}

/// A corner of a triangle: u, v and the place in space.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub at: [f64; 2],
    pub place: DVec3,
}

/// A point of a triangle, as U and V of a part's approximation, and its place in space.
#[derive(Clone, Copy)]
struct Point {
    local: DVec2,
    place: DVec3,
}

impl Part {
    fn new(all: &Patches<f64>, lane: usize) -> Self {
        let space =
            |of: &[zeroset_eval::Lanes<f64>; 3]| DVec3::new(of[0][lane], of[1][lane], of[2][lane]);
        let length = space(&all.error).length();
        let is_bounded = all.continuous >> lane & 1 == 1 && length.is_finite();
        Self {
            middle: DVec2::new(all.middle[0][lane], all.middle[1][lane]),
            half: DVec2::new(all.half[0][lane], all.half[1][lane]),
            centre: space(&all.centre),
            along: [space(&all.along_u), space(&all.along_v)],
            error: if is_bounded { length } else { f64::INFINITY },
        }
    }

    /// The approximation of the surface.
    fn place(&self, local: DVec2) -> DVec3 {
        self.centre + local.x * self.along[0] + local.y * self.along[1]
    }

    /// A bound of the distance between a triangle and the surface over this part: 0 if the two do
    /// not meet.
    fn distance(&self, triangle: &[Corner; 3]) -> f64 {
        let point = |corner: &Corner| {
            let from = DVec2::from_array(corner.at) - self.middle;
            Point { local: from / self.half, place: corner.place }
        };
        let corners = triangle.each_ref().map(point);
        let [a, b, c] = corners.map(|corner| corner.local);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // False for NaN.
        if low.max_element() > 1.0 + WIDER || high.min_element() < -1.0 - WIDER {
            return 0.0;
        }
        let mut points = SmallVec::from(corners.as_slice());
        for axis in [0, 1] {
            for side in [1.0, -1.0] {
                points = cut(&points, axis, side);
            }
        }
        let mut farthest: Option<f64> = None;
        for point in &points {
            let far = self.place(point.local).distance_squared(point.place);
            let far = if far.is_nan() { f64::INFINITY } else { far };
            farthest = Some(farthest.map_or(far, |most| most.max(far)));
        }
        farthest.map_or(0.0, |farthest| farthest.sqrt() + self.error)
    }
}

impl Fine {
    pub fn new(tree: &PatchTree, ranges: &Ranges) -> Self {
        let all = tree.divide(parameters(tree, ranges), SIDE).cells;
        Self(std::array::from_fn(|lane| Part::new(&all, lane)))
    }

    /// The largest error of a part: infinite if the surface may have a gap.
    pub fn error(&self) -> f64 {
        self.0.iter().map(|part| part.error).fold(0.0, f64::max)
    }

    /// By how much the surface bends along u and along v: about the distance of the cell's middle
    /// lines from straight ones.
    pub fn bends(&self) -> [f64; 2] {
        // Of the line of parts from one, with steps between their numbers.
        let bend = |from: usize, step: usize| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.0[from + k * step].centre);
            (a - b - c + d).length()
        };
        let lines = 0..SIDE;
        [
            lines.clone().map(|row| bend(SIDE * row, 1)).fold(0.0, f64::max),
            lines.map(|column| bend(column, SIDE)).fold(0.0, f64::max),
        ]
    }

    /// The terms U², UV and V² of the surface over the cell, approximately. U and V are −1 and 1 at
    /// the ends of the cell.
    pub fn quadric(&self) -> [DVec3; 3] {
        let at = |row: usize, column: usize| self.0[SIDE * row + column].centre;
        let along = |line: usize| {
            let [u, v] = [[0, 1, 2, 3].map(|k| at(line, k)), [0, 1, 2, 3].map(|k| at(k, line))];
            [u, v].map(|[a, b, c, d]| a - b - c + d)
        };
        let [[u, v], [other_u, other_v]] = [along(1), along(2)];
        // The outermost middles are at ±3/4.
        let turn = (at(0, 0) - at(0, 3) - at(3, 0) + at(3, 3)) * (4.0 / 9.0);
        [u.midpoint(other_u), turn, v.midpoint(other_v)]
    }

    /// The lengths of the cell in space, along u and along v.
    pub fn sides(&self) -> [f64; 2] {
        let [a, b, c, d] = self.corners();
        [a.distance(b).max(c.distance(d)), b.distance(c).max(d.distance(a))]
    }

    /// The corners of the cell, approximately, counterclockwise.
    pub fn corners(&self) -> [DVec3; 4] {
        let at = |part: usize, u: f64, v: f64| self.0[part].place(DVec2::new(u, v));
        [
            at(0, -1.0, -1.0),
            at(SIDE - 1, 1.0, -1.0),
            at(LANES - 1, 1.0, 1.0),
            at(LANES - SIDE, -1.0, 1.0),
        ]
    }

    /// Returns whether a triangle is proven to be within a distance of the surface, at the same u
    /// and v in the cell. The rounding of the computation is left out.
    pub fn is_near(&self, triangle: &[Corner; 3], distance: f64) -> bool {
        self.0.iter().all(|part| part.distance(triangle) <= distance)
    }
}

/// The part of a convex polygon whose coordinate along an axis, times `side`, is at most about 1.
fn cut(points: &[Point], axis: usize, side: f64) -> SmallVec<[Point; 8]> {
    // NaN counts as inside.
    let beyond = |point: &Point| side * point.local[axis] - (1.0 + WIDER);
    let mut left = SmallVec::new();
    for (k, point) in points.iter().enumerate() {
        let next = &points[(k + 1) % points.len()];
        let (here, there) = (beyond(point), beyond(next));
        let is_out = here > 0.0;
        if !is_out {
            left.push(*point);
        }
        if is_out != (there > 0.0) {
            let share = here / (here - there);
            left.push(Point {
                local: point.local.lerp(next.local, share),
                place: point.place.lerp(next.place, share),
            });
        }
    }
    left
}
