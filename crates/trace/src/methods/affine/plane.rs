//! Planes in the space of screen coordinates and s. A tile's form gives its plane. All zeros on the
//! tile's rays lie near the plane.

use super::screens::ScreenRays;
use crate::scalar::Scalar;
use crate::simd_chunks::parts;
use fearless_simd::{f64x8, prelude::*};
use zeroset_eval::{LANES, Lanes, Planes, Tiles};

/// The planes of a batch of tiles, one per lane.
#[derive(Default)]
pub(super) struct PlaneLanes<T: Scalar> {
    s: Lanes<T>,
    per_screen: [Lanes<T>; 2],
    reach: Lanes<T>,
}

/// A plane, and the distance from it within which zeros lie.
#[derive(Clone, Copy)]
pub(super) struct Plane<T> {
    /// Screen coordinates of the tile's center.
    centre: [T; 2],
    /// s of the plane at the center, then its change per unit of each screen coordinate.
    s: T,
    per_screen: [T; 2],
    /// Maximum distance of a zero from the plane, along s. It covers the rounding of the plane, and
    /// of rays' screen coordinates to `T`.
    pub reach: T,
}

impl<T: Scalar> PlaneLanes<T> {
    /// Computes the planes from the tiles' forms. A plane with a NaN bounds nothing. `aside` has
    /// the largest screen coordinates of the picture's rays.
    #[inline(always)]
    pub fn find<S: Simd>(&mut self, simd: S, batch: &Tiles<T>, out: &Planes<T>, aside: [f64; 2]) {
        let [rounding, few, lost] =
            [T::PATH_ERROR, 4.0 * T::UNIT, 2.0 * T::UNIT * T::LEAST_NORMAL.into()].map(T::nearest);
        // The form is scaled if the slope along the rays is below `least`: the quotient could
        // overflow.
        let least = T::LEAST_NORMAL.into() / (T::UNIT * T::UNIT);
        let [small, larger] = [least, 1.0 / least].map(T::nearest);
        let one = T::nearest(1.0);
        for part in parts::<S, T::Vector<S>>(simd, batch.count as usize) {
            let [middle, half] = [&out.middle, &out.half].map(|lanes| part.load(lanes));
            let [across, upward, along] = out.slope.each_ref().map(|slope| part.load(slope));
            let scale = along.abs().simd_lt(small).select(part.splat(larger), part.splat(one));
            let [value, error] = [&out.value, &out.error].map(|lanes| part.load(lanes) * scale);
            let [across, upward, along] = [across * scale, upward * scale, along * scale];
            let per_value = half / -along;
            let size = value.abs() + across.abs() + upward.abs() + error;
            // The reach covers three errors: the rounding of the plane and of the points where rays
            // meet it, the underflow of the quotient, and the form's error.
            let each = per_value.abs();
            let terms = each.mul_add(size, middle.abs() + half);
            let mut reach = each.mul_add(error, terms.mul_add(rounding, size * lost));
            let mut screen = part.splat(one);
            for (axis, slope) in [across, upward].into_iter().enumerate() {
                let half = part.load(&batch.half[axis]);
                let per_screen = per_value * slope / half;
                // This covers the rounding of rays' screen coordinates to `T`.
                let off = T::UNIT * aside[axis] + T::LEAST_NORMAL.into();
                reach = per_screen.abs().mul_add(T::nearest(off), reach);
                screen += half;
                part.store(per_screen, &mut self.per_screen[axis]);
            }
            // This covers the rounding of the sums above, and underflow of products with screen
            // coordinates.
            reach = reach.mul_add(few, reach) + screen * T::LEAST_NORMAL;
            part.store(per_value.mul_add(value, middle), &mut self.s);
            part.store(reach, &mut self.reach);
        }
    }

    /// Returns the plane of the tile in a lane of `batch`.
    #[inline(always)]
    pub fn of(&self, batch: &Tiles<T>, lane: usize) -> Plane<T> {
        Plane {
            centre: batch.centre.each_ref().map(|lanes| lanes[lane]),
            s: self.s[lane],
            per_screen: self.per_screen.each_ref().map(|lanes| lanes[lane]),
            reach: self.reach[lane],
        }
    }
}

impl<T: Scalar> Plane<T> {
    /// Returns the s at which the plane meets the rays with these screen coordinates.
    #[inline(always)]
    pub fn at<S: Simd>(&self, [mut along, up]: [[f64x8<S>; 2]; 2]) -> [f64x8<S>; 2] {
        let [s, a, b]: [f64; 3] = [self.s, self.per_screen[0], self.per_screen[1]].map(Into::into);
        let centre: [f64; 2] = self.centre.map(Into::into);
        for (along, up) in along.iter_mut().zip(up) {
            let [along_way, up_way] = [*along - centre[0], up - centre[1]];
            *along = up_way.mul_add(b, along_way.mul_add(a, s));
        }
        along
    }

    /// Shortens sixteen segments to the parts that may hold a zero. An empty part has its ends in
    /// the wrong order. Returns the lanes with a non-empty part, as bits.
    #[inline(always)]
    pub fn narrow<S: Simd>(
        &self,
        simd: S,
        (centre, half): ScreenRays<'_, T>,
        [near, far]: [&mut Lanes<T>; 2],
    ) -> u16 {
        let rounding = T::nearest(T::PATH_ERROR);
        let mut any = 0;
        for part in parts::<S, T::Vector<S>>(simd, LANES) {
            let [along, up] = centre.each_ref().map(|lanes| part.load(lanes));
            let s = (along - self.centre[0]).mul_add(self.per_screen[0], self.s);
            let s = (up - self.centre[1]).mul_add(self.per_screen[1], s);
            let mut reach = part.splat(self.reach);
            if let Some(half) = half {
                for (half, per_screen) in half.iter().zip(self.per_screen) {
                    reach = part.load(half).mul_add(part.splat(per_screen).abs(), reach);
                }
            }
            // The added term exceeds the rounding error of these sums. An overflow gives NaN, which
            // bounds nothing.
            let reach = (s.abs() + reach).mul_add(rounding, reach);
            let [start, end] = [part.load(near), part.load(far)];
            let (first, last) = ((s - reach).max_precise(start), (s + reach).min_precise(end));
            any |= part.bits(first.simd_le(last));
            part.store(first, near);
            part.store(last, far);
        }
        any
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_eval::dispatch;
    use zeroset_testkit::simd::levels;

    fn plane(per_screen: f64) -> Plane<f64> {
        Plane { centre: [0.0; 2], s: 0.25, per_screen: [per_screen, 0.0], reach: 0.5 }
    }

    fn narrowed(plane: &Plane<f64>, across: f64) -> Vec<[f64; 2]> {
        let centre = [across, 0.0].map(Lanes::splat);
        let narrow = |level| {
            let mut ends = [-2.0, 2.0].map(Lanes::splat);
            let [near, far] = &mut ends;
            let any = dispatch!(level, simd => plane.narrow(simd, (&centre, None), [near, far]));
            assert_eq!(any == u16::MAX, ends[0][0] <= ends[1][0]);
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
