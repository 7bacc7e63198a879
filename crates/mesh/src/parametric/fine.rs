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
        // The line of parts begins at number `from`, and their numbers differ by `step`.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parametric::PARTS;
    use crate::parametric::program;

    /// Triangles in random cells, with corners on the surface and beside it, are compared with the
    /// surface at random places.
    #[test]
    fn bounds_of_distances_hold_and_are_tight() {
        let mut random = fastrand::Rng::with_seed(68);
        for text in [
            "(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]",
            "(u, v, exp(-3 u^2) sin(4v)) for u in [-1, 2], v in [0, 1]",
            "(u v, u^2 - v, v^3 + u v) for u in [-1, 1], v in [-1, 2]",
        ] {
            let program = program(text);
            let tree = program.patch(0).expect(text).tree().expect("a kernel");
            let surface = |[u, v]: [f64; 2]| {
                let found = tree.over(&[[[u, u], [v, v]]]);
                DVec3::from_array([0, 1, 2].map(|axis| found.centre[axis][0]))
            };
            let mut tight = 0;
            for case in 0..200 {
                let ranges = [0; 2].map(|_| {
                    let low = PARTS / 32 * random.u32(..30);
                    [low, low + PARTS / 32]
                });
                let fine = Fine::new(tree, &ranges);
                let cell = parameters(tree, &ranges);
                let moved = if case % 2 == 0 { 0.0 } else { 0.02 };
                let triangle = [0; 3].map(|_| {
                    let share =
                        |random: &mut fastrand::Rng| (random.f64() * 1.5 - 0.25).clamp(0.0, 1.0);
                    let at = cell.map(|[low, high]| low + (high - low) * share(&mut random));
                    let beside = DVec3::from_array([0; 3].map(|_| random.f64() - 0.5));
                    Corner { at, place: surface(at) + moved * beside }
                });
                let mut farthest = 0.0_f64;
                for _ in 0..100 {
                    let [a, b] = [random.f64(), random.f64()];
                    let [a, b] = if a + b > 1.0 { [1.0 - a, 1.0 - b] } else { [a, b] };
                    let shares = [a, b, 1.0 - a - b];
                    let at = [0, 1]
                        .map(|axis| (0..3).map(|k| shares[k] * triangle[k].at[axis]).sum::<f64>());
                    let place: DVec3 = (0..3).map(|k| shares[k] * triangle[k].place).sum();
                    farthest = farthest.max(surface(at).distance(place));
                }
                assert!(!fine.is_near(&triangle, 0.999 * farthest - 1e-12), "{text}, {case}");
                tight += u32::from(fine.is_near(&triangle, 1.5 * farthest + 1e-4));
            }
            println!("{text}: {tight} of 200 bounds are tight");
            assert!(tight > 180, "{text}: {tight}");
        }
    }
}
