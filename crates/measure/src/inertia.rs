//! Centroid and moments of inertia, from the integrals over a solid.

use crate::volume::Solid;
use zeroset_interval::Interval;

/// The centroid and the moments of inertia of a solid.
#[derive(Clone, Copy, Debug)]
pub struct Inertia {
    /// The centroid's coordinates.
    pub centroid: [Interval; 3],
    /// The moments of inertia about the axes through the centroid along x, y and z: the diagonal of
    /// the tensor.
    pub moments: [Interval; 3],
    /// The integrals of y·z, z·x and x·y, measured from the centroid: negated, the other entries of
    /// the tensor.
    pub products: [Interval; 3],
}

impl Solid {
    /// The centroid and the moments of inertia, or `None` if the volume or the mass may be 0.
    pub fn inertia(&self) -> Option<Inertia> {
        let volume = self.volume;
        if volume.has_zero() {
            return None;
        }
        // From the origin of the integrals.
        let mean = self.first.map(|first| first.over(volume));
        let about_mean = |integral: Interval, one: usize, other: usize| {
            integral.plus(mean[one].times(self.first[other]).negated())
        };
        let squares = [0, 1, 2].map(|axis| {
            let square = about_mean(self.squares[axis], axis, axis);
            let is_square = self.least_density >= 0.0;
            Interval { lo: if is_square { square.lo.max(0.0) } else { square.lo }, ..square }
        });
        let others = |axis: usize| ((axis + 1) % 3, (axis + 2) % 3);
        Some(Inertia {
            centroid: [0, 1, 2].map(|axis| {
                let origin = Interval { lo: self.origin[axis], hi: self.origin[axis] };
                mean[axis].plus(origin)
            }),
            moments: [0, 1, 2].map(|axis| {
                let (one, other) = others(axis);
                squares[one].plus(squares[other])
            }),
            products: [0, 1, 2].map(|axis| {
                let (one, other) = others(axis);
                about_mean(self.products[axis], one, other)
            }),
        })
    }
}
