//! Coordinates that files hold.

use crate::simplify::change::Change;
use crate::simplify::reduction::Reduction;

/// A place is better if its sum of squared distances is less than this share.
const BETTER: f64 = 0.1;

impl Reduction<'_> {
    /// Moves vertices onto edges of the surface that are near, and to rounded places. Returns the
    /// vertices for which that is not proven, or `None` once `wanted` returns false.
    pub fn round(&mut self, wanted: &(dyn Fn() -> bool + Sync)) -> Option<Vec<u32>> {
        let lattice = self.setting.lattice;
        let mut left = Vec::new();
        for vertex in 0..self.mesh.places.len() as u32 {
            if vertex % 1024 == 0 && !wanted() {
                return None;
            }
            if self.mesh.around(vertex).is_empty() {
                continue;
            }
            let place = self.mesh.place(vertex);
            let quadric = &self.mesh.quadrics[vertex as usize];
            let sum = |place| quadric.at(lattice.relative(place));
            let best = self.best(quadric, lattice.relative(place), self.faces(place));
            let is_better = sum(best) < BETTER * sum(place) && sum(place) > self.floor(quadric);
            let nearest = lattice.rounded(lattice.place(place));
            let places = [best, nearest];
            let mut places = places.into_iter().skip(usize::from(!is_better));
            let may_move = |to: &_| {
                let change = Change::moved(&self.mesh, vertex, *to);
                change.is_some_and(|change| self.is_proven(&change))
            };
            if is_better || !lattice.is_round(place) {
                match places.find(may_move) {
                    Some(to) => self.mesh.apply(vertex, None, to),
                    None => left.extend((!lattice.is_round(place)).then_some(vertex)),
                }
            }
        }
        Some(left)
    }
}
