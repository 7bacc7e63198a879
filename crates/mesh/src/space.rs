//! Corners of the grid as points of space.

use crate::grid::{Corner, Grid, Tetrahedron};
use crate::index::Bounds;
use glam::{DVec3, I64Vec3};
use zeroset_interval::Interval;

/// Greatest number of cubes along an axis before any split, as a power of two.
const MOST_CUBES: u32 = 4;

/// The largest differences of steps along each axis from their mean, as shares of it. So creases
/// and faces of symmetric surfaces do not go through corners and edges of the grid.
const UNEVEN: [f64; 3] = [0.021, 0.034, 0.055];

/// The grid over a box of space. Coordinates are mapped separately along each axis.
pub struct Space {
    low: DVec3,
    high: DVec3,
    extent: [u32; 3],
}

impl Space {
    /// A grid of cubes, or of boxes close to cubes, that fills the box from `low` to `high`.
    pub fn new(low: DVec3, high: DVec3) -> (Self, Grid) {
        let size = high - low;
        let cubes = size.to_array().map(|along| {
            let times = (along / size.min_element()).log2().round();
            (times.max(0.0) as u32).min(MOST_CUBES)
        });
        let grid = Grid::new(cubes);
        (Self { low, high, extent: grid.extent }, grid)
    }

    /// The largest magnitude of a coordinate in the box.
    pub fn largest(&self) -> f64 {
        self.low.abs().max(self.high.abs()).max_element()
    }

    /// The box around a box of space, in units of 2⁻³⁹ of the space's longest edge.
    pub fn units(&self, [low, high]: [DVec3; 2]) -> Bounds {
        let unit = (self.high - self.low).max_element() / (1_u64 << 39) as f64;
        let units = |point: DVec3| ((point - self.low) / unit).round().as_i64vec3();
        Bounds { low: units(low) - I64Vec3::ONE, high: units(high) + I64Vec3::ONE }
    }

    /// Returns whether a box is in the space.
    pub fn holds(&self, bounds: &[Interval; 3]) -> bool {
        (0..3).all(|axis| self.low[axis] <= bounds[axis].lo && bounds[axis].hi <= self.high[axis])
    }

    /// The point at a corner.
    pub fn at(&self, corner: Corner) -> DVec3 {
        let along = corner.coordinates();
        DVec3::from_array([0, 1, 2].map(|axis| {
            // The ends are exact, so no point lies outside.
            let (low, high) = (self.low[axis], self.high[axis]);
            if along[axis] == self.extent[axis] {
                return high;
            }
            let share = f64::from(along[axis]) / f64::from(self.extent[axis]);
            let share = share + UNEVEN[axis] * share * (1.0 - share);
            (low + share * (high - low)).clamp(low, high)
        }))
    }

    /// The corners of a tetrahedron.
    pub fn corners(&self, tetrahedron: &Tetrahedron) -> [DVec3; 4] {
        tetrahedron.corners.map(|corner| self.at(corner))
    }

    /// The box between two corners. It contains the points of all corners between.
    pub fn between(&self, [low, high]: [Corner; 2]) -> [Interval; 3] {
        let (low, high) = (self.at(low), self.at(high));
        [0, 1, 2].map(|axis| Interval { lo: low[axis], hi: high[axis] })
    }

    /// For each axis, whether the corner is on a face of the box across the axis.
    pub fn faces(&self, corner: Corner) -> [bool; 3] {
        let at = corner.coordinates();
        [0, 1, 2].map(|axis| at[axis] == 0 || at[axis] == self.extent[axis])
    }
}
