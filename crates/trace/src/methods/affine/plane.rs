//! What the form of a tile says of the zeros on its rays: they lie near a plane in screen
//! coordinates and s.

use super::screens::{Ends, Rays};
use crate::scalar::Scalar;
use fearless_simd::{f64x8, prelude::*};
use zeroset_eval::{Lanes, Planes, Tiles};

/// A plane, and how far from it a zero may be.
pub(super) struct Plane {
    centre: [f64; 2],
    /// s at the centre, and what it changes by per unit of a screen coordinate.
    s: f64,
    per_screen: [f64; 2],
    /// How far to either side of the plane a zero may be.
    pub reach: f64,
}

impl Plane {
    /// That of the tile in this lane of a batch. One that is not a number bounds nothing.
    #[inline(always)]
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

    /// s where the plane meets rays at screen coordinates.
    #[inline(always)]
    pub fn at<S: Simd>(&self, simd: S, screens: &[Lanes<f64>; 2]) -> [f64x8<S>; 2] {
        let mut along = f64::wide(simd, &screens[0]);
        let up = f64::wide(simd, &screens[1]);
        for (along, up) in along.iter_mut().zip(up) {
            let [along_way, up_way] = [*along - self.centre[0], up - self.centre[1]];
            let s = along_way.mul_add(self.per_screen[0], self.s);
            *along = up_way.mul_add(self.per_screen[1], s);
        }
        along
    }

    /// Shortens segments to what is left of them; the ends of one of which nothing is come out in
    /// the wrong order.
    #[inline(always)]
    pub fn narrow<S: Simd, T: Scalar>(&self, simd: S, (centre, half): Rays<'_>, ends: &mut Ends) {
        let [across, upward] = self.per_screen.map(f64::abs);
        let mut reach = [f64x8::splat(simd, self.reach); 2];
        if let Some([wide, high]) = half {
            let [wide, high] = [f64::wide(simd, wide), f64::wide(simd, high)];
            for k in 0..2 {
                reach[k] = high[k].mul_add(upward, wide[k].mul_add(across, reach[k]));
            }
        }
        let [mut near, mut far] = [f64::wide(simd, &ends[0]), f64::wide(simd, &ends[1])];
        for (k, s) in self.at(simd, centre).into_iter().enumerate() {
            // More than what these sums are rounded by; and so what overflows is not a number,
            // which bounds nothing.
            let reach = s.abs().mul_add(T::PATH_ERROR, reach[k]);
            near[k] = (s - reach).max_precise(near[k]);
            far[k] = (s + reach).min_precise(far[k]);
        }
        f64::narrow(near, &mut ends[0]);
        f64::narrow(far, &mut ends[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::widths::levels;
    use fearless_simd::dispatch;

    fn plane(per_screen: f64) -> Plane {
        Plane { centre: [0.0; 2], s: 0.25, per_screen: [per_screen, 0.0], reach: 0.5 }
    }

    fn narrowed(plane: &Plane, across: f64) -> Vec<[f64; 2]> {
        let centre = [across, 0.0].map(Lanes::splat);
        let narrow = |level| {
            let mut ends = [-2.0, 2.0].map(Lanes::splat);
            dispatch!(level, simd => plane.narrow::<_, f64>(simd, (&centre, None), &mut ends));
            assert!(ends.iter().all(|end| end.iter().all(|other| *other == end[0])));
            [ends[0][0], ends[1][0]]
        };
        levels().into_iter().map(narrow).collect()
    }

    #[test]
    fn a_plane_bounds_what_it_is_near_to() {
        for [near, far] in narrowed(&plane(1.0), 0.5) {
            assert!((0.25 - 1e-12..=0.25).contains(&near), "{near}");
            assert!((1.25..1.25 + 1e-12).contains(&far), "{far}");
        }
        // Nothing is left.
        assert!(narrowed(&plane(1.0), 9.0).iter().all(|[near, far]| near > far));
    }

    #[test]
    fn a_plane_that_overflows_bounds_nothing() {
        for per_screen in [f64::INFINITY, f64::NEG_INFINITY, 1e308, f64::NAN] {
            for across in [9.0, -9.0] {
                let ends = narrowed(&plane(per_screen), across);
                assert!(ends.iter().all(|ends| *ends == [-2.0, 2.0]), "{per_screen}: {ends:?}");
            }
        }
    }
}
