//! Sums of squared distances from planes (Garland and Heckbert, "Surface simplification using
//! quadric error metrics", 1997).

use glam::{DMat3, DVec3};
use std::ops::AddAssign;

/// Share of the largest slope that draws a best point toward the middle, where planes leave it
/// free.
const PULL: f64 = 1e-7;

/// The sum of squared distances from planes, with weights: xᵀAx + 2bx + c.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quadric {
    /// xx, yy, zz, xy, xz, yz of A.
    squares: [f64; 6],
    linear: DVec3,
    constant: f64,
}

impl Quadric {
    /// The squared distance from the plane through `point` across the unit vector `normal`.
    pub fn of_plane(normal: DVec3, point: DVec3, weight: f64) -> Self {
        let DVec3 { x, y, z } = normal;
        let away = -normal.dot(point);
        Self {
            squares: [x * x, y * y, z * z, x * y, x * z, y * z].map(|product| weight * product),
            linear: weight * away * normal,
            constant: weight * away * away,
        }
    }

    fn matrix(&self) -> DMat3 {
        let [xx, yy, zz, xy, xz, yz] = self.squares;
        DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
    }

    /// The sum of all weights.
    pub fn weight(&self) -> f64 {
        let [xx, yy, zz, ..] = self.squares;
        xx + yy + zz
    }

    /// The share of pairs of planes that are across each other: 0 if all are parallel, and a
    /// quarter of the squared sine of the angle between two planes of the same weight.
    pub fn bend(&self) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = self.squares;
        let minors = (xx * yy - xy * xy) + (xx * zz - xz * xz) + (yy * zz - yz * yz);
        minors / self.weight().powi(2)
    }

    /// The sum at a point, at least 0.
    pub fn at(&self, point: DVec3) -> f64 {
        let slope = self.matrix() * point + 2.0 * self.linear;
        (slope.dot(point) + self.constant).max(0.0)
    }

    /// The point with the least sum, near `middle` where planes leave it free.
    pub fn best(&self, middle: DVec3) -> Option<DVec3> {
        let matrix = self.matrix();
        let [xx, yy, zz, ..] = self.squares;
        let pull = PULL * xx.max(yy).max(zz);
        let slope = matrix * middle + self.linear;
        let step = (matrix + DMat3::from_diagonal(DVec3::splat(pull))).inverse() * slope;
        step.is_finite().then_some(middle - step)
    }
}

impl AddAssign for Quadric {
    fn add_assign(&mut self, other: Self) {
        for (own, added) in self.squares.iter_mut().zip(other.squares) {
            *own += added;
        }
        self.linear += other.linear;
        self.constant += other.constant;
    }
}
