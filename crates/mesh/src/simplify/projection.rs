//! Triangles as seen along directions with small whole components, by exact arithmetic.

use glam::{DVec3, I64Vec3};

/// A direction with small whole components. Seen along it, points have two coordinates, and a
/// height along it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Direction {
    along: I64Vec3,
    /// The axis that heights are measured on, and the two others, in an order that keeps turns to
    /// the left.
    axes: [usize; 3],
}

/// A point as seen along a direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    pub x: i64,
    pub y: i64,
    /// Height, which grows along the direction.
    pub height: i64,
}

/// The largest components of directions near a vector.
const LARGEST: [f64; 3] = [1.0, 2.0, 3.0];

impl Direction {
    /// Directions near a vector that is not 0.
    pub fn near(vector: DVec3) -> impl Iterator<Item = Self> {
        let most = vector.abs().max_element();
        let directions = LARGEST.map(|largest| (vector * (largest / most)).round().as_i64vec3());
        directions.into_iter().map(|along| {
            let axis = (0..3).max_by_key(|axis| along[*axis].abs()).unwrap_or(0);
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let axes = if along[axis] > 0 { [axis, next, last] } else { [axis, last, next] };
            Self { along, axes }
        })
    }

    /// A point as seen.
    pub fn see(&self, point: I64Vec3) -> Seen {
        let [axis, x, y] = self.axes;
        let from = self.along[axis].abs();
        let height = point[axis] * self.along[axis].signum();
        let flat = |along: usize| point[along] * from - height * self.along[along];
        Seen { x: flat(x), y: flat(y), height }
    }
}

/// Twice the area of a triangle as seen: above 0 if it turns to the left.
pub fn area(a: Seen, b: Seen, c: Seen) -> i128 {
    let (ux, uy) = (i128::from(b.x - a.x), i128::from(b.y - a.y));
    let (vx, vy) = (i128::from(c.x - a.x), i128::from(c.y - a.y));
    ux * vy - uy * vx
}

/// Six times the volume of a tetrahedron: above 0 if `d` is above the triangle `abc`, which turns
/// to the left.
pub fn volume(a: Seen, b: Seen, c: Seen, d: Seen) -> i128 {
    let height = |point: Seen| i128::from(point.height - a.height);
    area(a, b, c) * height(d) - area(a, b, d) * height(c) + area(a, c, d) * height(b)
}
