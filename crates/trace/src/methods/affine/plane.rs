//! What the form of a tile says of the zeros on its rays: they lie near a plane in screen coordinates and s.

use super::frame::Tile;
use crate::scalar::{Four, Scalar};
use zeroset_eval::{Lanes, Planes, Tiles};

/// A plane, and how far from it a zero may be.
pub(super) struct Plane {
    centre: [f64; 2],
    /// s at the centre, and what it changes by per unit of a screen coordinate.
    s: f64,
    per_screen: [f64; 2],
    reach: f64,
}

impl Plane {
    /// That of the tile in this lane of a batch. One that is not a number bounds nothing.
    pub fn new<T: Scalar>(batch: &Tiles<T>, out: &Planes<T>, lane: usize) -> Self {
        let [value, error, middle, half]: [f64; 4] =
            [out.value[lane], out.error[lane], out.middle[lane], out.half[lane]].map(Into::into);
        let slope: [f64; 3] = out.slope.map(|lanes| lanes[lane].into());
        let per_value = -half / slope[2];
        let size = value.abs() + slope[0].abs() + slope[1].abs() + error;
        // Screen coordinates were rounded, and so are ends; more than what that comes to.
        let error = error + T::PATH_ERROR * size;
        Self {
            centre: batch.centre.map(|lanes| lanes[lane].into()),
            s: middle + per_value * value,
            per_screen: [0, 1].map(|axis| {
                let half: f64 = batch.half[axis][lane].into();
                per_value * slope[axis] / half
            }),
            reach: per_value.abs() * error + T::PATH_ERROR * (middle.abs() + half),
        }
    }

    /// How far to either side of the plane a zero may be.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// What s changes by on the plane, for a way upward in screen coordinates.
    pub fn rise(&self, up: f64) -> f64 {
        self.per_screen[1] * up
    }

    /// s where the plane meets the ray at screen coordinates.
    #[inline]
    pub fn at(&self, [a, b]: [f64; 2]) -> f64 {
        self.s
            + (self.per_screen[0] * (a - self.centre[0])
                + self.per_screen[1] * (b - self.centre[1]))
    }

    /// What is left of a segment on each ray of a tile of 4×4 pixels, given the screen coordinates of its columns and rows;
    /// and a bit for each ray on which anything is.
    #[inline]
    pub fn narrow<T: Scalar>(
        &self,
        columns: &[f64; 4],
        rows: &[f64; 4],
        [near, far]: [f64; 2],
    ) -> (Lanes<T>, Lanes<T>, u16) {
        let along = columns.map(|a| self.per_screen[0] * (a - self.centre[0]));
        let up = rows.map(|b| self.s + self.per_screen[1] * (b - self.centre[1]));
        let most = |four: &[f64; 4]| four[0].abs().max(four[3].abs());
        // More than what the numbers and sums below are rounded by.
        let size = most(&along) + most(&up) + self.reach;
        let reach = T::Four::splat(T::above(self.reach + T::PATH_ERROR * size));
        let (near, far) = (T::Four::splat(T::nearest(near)), T::Four::splat(T::nearest(far)));
        let along = T::Four::from_array(along.map(T::nearest));
        let [mut from, mut to] = [Lanes::splat(T::default()); 2];
        let mut misses = 0;
        let ends = from.as_chunks_mut::<4>().0.iter_mut().zip(to.as_chunks_mut::<4>().0);
        for (row, (first, last)) in ends.enumerate() {
            let s = along + T::Four::splat(T::nearest(up[row]));
            // In this order, what is not a number bounds nothing.
            let (from, to) = ((s - reach).max(near), (s + reach).min(far));
            misses |= T::Four::bits(to.less(from)) << (4 * row);
            (*first, *last) = (from.to_array(), to.to_array());
        }
        (from, to, !misses as u16)
    }

    /// What is left of a segment on the rays of a part of the tile.
    #[inline]
    pub fn narrow_tile(&self, part: &Tile, [near, far]: [f64; 2]) -> Option<[f64; 2]> {
        let s = self.at(part.centre);
        let spread =
            self.per_screen[0].abs() * part.half[0] + self.per_screen[1].abs() * part.half[1];
        let reach = spread + self.reach;
        let (near, far) = ((s - reach).max(near), (s + reach).min(far));
        (near <= far).then_some([near, far])
    }
}
