//! Triangles as seen along one of 26 directions, by exact arithmetic.

use glam::{DVec3, I64Vec3};

/// A direction whose components are −1, 0 or 1. Seen along it, points have two coordinates, and a
/// height along it.
#[derive(Clone, Copy, Debug)]
pub struct Direction {
    along: I64Vec3,
    /// The axis with a component of ±1 that the height is measured on, and the two others, in an
    /// order that keeps turns to the left.
    axes: [usize; 3],
}

/// A point as seen along a direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    pub x: i64,
    pub y: i64,
    /// Height, in steps of the direction.
    pub height: i64,
}

impl Direction {
    fn new(along: I64Vec3) -> Self {
        let axis = (0..3).find(|axis| along[*axis] != 0).expect("a direction is not 0");
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let axes = if along[axis] > 0 { [axis, next, last] } else { [axis, last, next] };
        Self { along, axes }
    }

    /// The directions nearest to a vector, the nearest one first.
    pub fn near(vector: DVec3) -> [Self; 4] {
        let [p, q, r] = {
            let mut axes = [0, 1, 2];
            axes.sort_by(|a, b| vector[*b].abs().total_cmp(&vector[*a].abs()));
            axes
        };
        let unit = |axis: usize| {
            let mut unit = I64Vec3::ZERO;
            unit[axis] = if vector[axis] < 0.0 { -1 } else { 1 };
            unit
        };
        let axis = unit(p);
        let mut all = [axis, axis + unit(q), axis + unit(q) + unit(r), axis + unit(r)];
        let cosine = |along: &I64Vec3| along.as_dvec3().normalize().dot(vector);
        all.sort_by(|a, b| cosine(b).total_cmp(&cosine(a)));
        all.map(Self::new)
    }

    /// A point as seen.
    pub fn see(&self, point: I64Vec3) -> Seen {
        let [axis, x, y] = self.axes;
        let height = point[axis] * self.along[axis];
        let flat = point - height * self.along;
        Seen { x: flat[x], y: flat[y], height }
    }
}

/// Twice the area of a triangle as seen: above 0 if it turns to the left.
pub fn area(a: Seen, b: Seen, c: Seen) -> i128 {
    let (ux, uy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let (vx, vy) = (i128::from(c.x - a.x), i128::from(c.y - a.y));
    ux * vy - uy * vx
}

/// Six times the volume of a tetrahedron: above 0 if `d` is above the triangle `abc`, which turns to
/// the left.
pub fn volume(a: Seen, b: Seen, c: Seen, d: Seen) -> i128 {
    let height = |point: Seen| i128::from(point.height - a.height);
    area(a, b, c) * height(d) - area(a, b, d) * height(c) + area(a, c, d) * height(b)
}
