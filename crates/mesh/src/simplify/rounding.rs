//! Coordinates that files hold.

use crate::simplify::change::Change;
use crate::simplify::reduction::Reduction;
use glam::I64Vec3;
use std::ops::Range;

/// A place is better if its sum of squared distances is less than this share.
const BETTER: f64 = 0.1;
/// [Bends](crate::simplify::quadric::Quadric::bend) of a smooth surface: above those in a flat
/// face, and below that of an edge with an angle of 11 degrees. Vertices of a smooth surface are on
/// it.
const SMOOTH: Range<f64> = 1e-6..0.01;
/// Where a vertex cannot move, triangles may turn whose height is less than this share of the
/// allowed distance.
const THIN: f64 = 0.25;
/// Number of rounds. Vertices that cannot move may do so once their neighbors have moved.
const ROUNDS: usize = 3;

impl Reduction<'_> {
    /// Moves vertices onto edges of the surface that are near, and to rounded places. Returns the
    /// vertices for which that is not proven, or `None` once `wanted` returns false.
    pub fn round(&mut self, wanted: &(dyn Fn() -> bool + Sync)) -> Option<Vec<u32>> {
        let mut left: Vec<u32> = (0..self.mesh.places.len() as u32).collect();
        for _ in 0..ROUNDS {
            let mut kept = Vec::new();
            for (count, vertex) in left.into_iter().enumerate() {
                if count % 1024 == 0 && !wanted() {
                    return None;
                }
                if !self.mesh.around(vertex).is_empty() && !self.round_one(vertex) {
                    kept.push(vertex);
                }
            }
            left = kept;
        }
        left.retain(|vertex| !self.remove_one(*vertex));
        Some(left)
    }

    /// Replaces a vertex that cannot move by a neighbor. Thin triangles may turn. Returns whether
    /// that is done.
    fn remove_one(&mut self, vertex: u32) -> bool {
        let may_replace = |neighbor: &u32| {
            let change = Change::into_other(&self.mesh, vertex, *neighbor);
            self.setting.lattice.is_round(self.mesh.place(*neighbor))
                && change.is_some_and(|change| self.is_proven(&change, THIN))
        };
        let found = self.mesh.neighbors(vertex).into_iter().find(may_replace);
        if let Some(neighbor) = found {
            self.mesh.apply(neighbor, Some(vertex), self.mesh.place(neighbor));
        }
        found.is_some()
    }

    /// Moves vertices onto edges and corners of the surface that are near.
    pub fn straighten(&mut self) {
        for _ in 0..ROUNDS {
            for vertex in 0..self.mesh.places.len() as u32 {
                if let Some(better) = self.better(vertex) {
                    self.move_to(vertex, [better]);
                }
            }
        }
    }

    /// Moves a vertex to a rounded place. Returns whether it is at one.
    fn round_one(&mut self, vertex: u32) -> bool {
        let lattice = self.setting.lattice;
        if let Some(better) = self.better(vertex) {
            self.move_to(vertex, [better]);
        }
        let place = self.mesh.place(vertex);
        if lattice.is_round(place) {
            return true;
        }
        let may_move = |to: &I64Vec3| {
            Change::moved(&self.mesh, vertex, *to).is_some_and(|change| self.keeps_shape(&change))
        };
        let found = lattice.around(place).into_iter().find(may_move);
        if let Some(to) = found {
            self.mesh.apply(vertex, None, to);
        }
        found.is_some()
    }

    /// A rounded place that is much nearer to the planes around a vertex, if there is one.
    fn better(&self, vertex: u32) -> Option<I64Vec3> {
        let lattice = self.setting.lattice;
        let (place, quadric) = (self.mesh.place(vertex), &self.mesh.quadrics[vertex as usize]);
        let sum = |place| quadric.at(lattice.relative(place));
        let now = sum(place);
        if now <= self.floor(quadric) || SMOOTH.contains(&quadric.bend()) {
            return None;
        }
        let best = self.best(quadric, lattice.relative(place), self.faces(place));
        (sum(best) < BETTER * now).then_some(best)
    }

    /// Moves a vertex to the first of some places for which that is proven.
    fn move_to(&mut self, vertex: u32, places: impl IntoIterator<Item = I64Vec3>) {
        let may_move = |to: &I64Vec3| {
            let change = Change::moved(&self.mesh, vertex, *to);
            change.is_some_and(|change| self.is_proven(&change, 0.0))
        };
        if let Some(to) = places.into_iter().find(may_move) {
            self.mesh.apply(vertex, None, to);
        }
    }
}
