//! Boxes, points inside them, and rays.

use super::values::{Adversarial, Ends, below, from_exponents, uniform_f64};
use super::{Rng, values::nudge};
use zeroset_interval::Interval;

/// Returns a box: per axis, a lower and an upper end, in order and never NaN. A lower end is below
/// +∞, and an upper end above −∞. If `ends` allows infinite ends, some boxes are unbounded.
///
/// Points, thin boxes, boxes around zero and huge boxes are all likely. One box in four has
/// moderate ends on every axis, so that larger formulas are defined and finite somewhere.
pub fn random_box<T: Adversarial>(rng: &mut Rng, ends: Ends) -> [[T; 2]; 3] {
    let plain = rng.u32(0..4) == 0;
    [(); 3].map(|()| if plain { plain_range(rng) } else { random_range(rng, ends) })
}

fn plain_range<T: Adversarial>(rng: &mut Rng) -> [T; 2] {
    let middle = T::uniform(rng).into() * 8.0 - 4.0;
    let half = from_exponents::<T>(rng, -24, 1).into();
    [middle - half, middle + half].map(T::nearest)
}

fn random_range<T: Adversarial>(rng: &mut Rng, ends: Ends) -> [T; 2] {
    let a = T::adversarial(rng, Ends::Finite);
    let ordered = |a: T, b: T| if b < a { [b, a] } else { [a, b] };
    match rng.u32(0..8) {
        0 => [a, a],
        1 => ordered(a, nudge(rng, a)),
        2 => {
            let magnitude = |x: T| T::nearest(x.into().abs());
            [-magnitude(a), magnitude(T::adversarial(rng, Ends::Finite))]
        }
        3 => [-0.0, 0.0].map(T::nearest),
        4 => plain_range(rng),
        5 if ends == Ends::Infinite => {
            let infinity = T::nearest(f64::INFINITY);
            match rng.u32(0..3) {
                0 => [-infinity, a],
                1 => [a, infinity],
                _ => [-infinity, infinity],
            }
        }
        _ => ordered(a, T::adversarial(rng, Ends::Finite)),
    }
}

/// Returns a domain: all of space, a box as typed (its ends need not be `f32`), or a
/// [`random_box`].
pub fn random_domain(rng: &mut Rng) -> [Interval; 3] {
    match rng.u32(0..4) {
        0 => [Interval::ENTIRE; 3],
        1 => {
            let half = f64::from(rng.u32(1..100)) / 10.0;
            [Interval { lo: -half, hi: half }; 3]
        }
        2 => [(); 3].map(|()| {
            let middle = uniform_f64(rng) * 8.0 - 4.0;
            let half = uniform_f64(rng) * 4.0;
            Interval { lo: middle - half, hi: middle + half }
        }),
        _ => random_box::<f32>(rng, Ends::Infinite)
            .map(|[lo, hi]| Interval { lo: f64::from(lo), hi: f64::from(hi) }),
    }
}

/// Returns a range within `bounds`, rounded outward to `T`: all of `bounds`, a part that may be
/// thin, or the part of `wanted` inside `bounds`. It always contains real numbers within `bounds`.
pub fn range_within<T: Adversarial>(rng: &mut Rng, bounds: Interval, wanted: [T; 2]) -> [T; 2] {
    let down = |value: f64| -T::above(-value);
    let (least, most) = (down(bounds.lo), T::above(bounds.hi));
    let [lo, hi] = match rng.u32(0..8) {
        0 => [least, most],
        1..=4 if bounds.is_bounded() => {
            let length = bounds.width() * from_exponents::<T>(rng, -24, -1).into();
            let start = bounds.lo + (bounds.width() - length) * uniform_f64(rng);
            [start, start + length].map(T::nearest)
        }
        _ => wanted,
    };
    let between = |x: T, least: T, most: T| T::nearest(x.into().clamp(least.into(), most.into()));
    [between(lo, least, down(bounds.hi)), between(hi, T::above(bounds.lo), most)]
}

/// Returns a point of `region`, whose ends are as in [`random_box`]. The coordinates are often ends
/// of the region, zeros, integers, half integers or multiples of π/2. They are always finite. On an
/// unbounded side they do not exceed 1e300, or the magnitude of the other end if that is larger.
pub fn point_in_box<T: Adversarial>(rng: &mut Rng, region: &[[T; 2]; 3]) -> [f64; 3] {
    let corner = rng.u32(0..4) == 0;
    region.map(|[lo, hi]| {
        let (lo, hi) = (lo.into(), hi.into());
        let (least, most) = (bounded(rng, lo), bounded(rng, hi));
        let finite = |end: f64, otherwise: f64| if end.is_finite() { end } else { otherwise };
        let (lo, hi) = (finite(lo, least.min(most)), finite(hi, least.max(most)));
        match rng.u32(0..8) {
            _ if corner => [lo, hi][below(rng, 2)],
            0 | 1 => [lo, hi][below(rng, 2)],
            2 => [lo.next_up(), hi.next_down()][below(rng, 2)].clamp(lo, hi),
            3 => special_between(rng, lo, hi).clamp(lo, hi),
            4 => (lo / 2.0 + hi / 2.0).clamp(lo, hi),
            5 => T::adversarial(rng, Ends::Finite).into().clamp(lo, hi),
            _ => {
                let share = uniform_f64(rng);
                (lo * (1.0 - share) + hi * share).clamp(lo, hi)
            }
        }
    })
}

/// Returns `end`, or a finite substitute if it is infinite.
fn bounded(rng: &mut Rng, end: f64) -> f64 {
    if end.is_finite() {
        return end;
    }
    [1e300, f64::from(f32::MAX).next_up()][below(rng, 2)].copysign(end)
}

/// Draws a number in [lo, hi]. Returns 0, or an integer, half integer or rounded multiple of π/2
/// near that number.
fn special_between(rng: &mut Rng, lo: f64, hi: f64) -> f64 {
    use std::f64::consts::FRAC_PI_2;
    let share = uniform_f64(rng);
    let near = lo * (1.0 - share) + hi * share;
    match rng.u32(0..4) {
        0 => 0.0,
        1 => near.round_ties_even(),
        2 => near.floor() + 0.5,
        _ => (near / FRAC_PI_2).round_ties_even() * FRAC_PI_2,
    }
}

/// A segment of a ray: the points `eye + t·direction` for t between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at t = 0.
    pub eye: [f64; 3],
    /// Direction of any length but 0. Components may be ±0.
    pub direction: [f64; 3],
    /// The least and the greatest t, in order.
    pub span: [f32; 2],
}

/// Returns a ray along or nearly along an axis, along a diagonal, or in any direction. No component
/// of its direction exceeds 1 in magnitude.
pub fn random_ray(rng: &mut Rng) -> Ray {
    let signed = |rng: &mut Rng| uniform_f64(rng) * 2.0 - 1.0;
    let direction = loop {
        let kind = rng.u32(0..4);
        let direction = [(); 3].map(|()| match (kind, rng.u32(0..3)) {
            (0, 0 | 1) => [0.0, -0.0][below(rng, 2)],
            (0 | 1, _) => [1.0, -1.0][below(rng, 2)],
            (2, 0) => signed(rng) * 2f64.powi(-rng.i32(0..200)),
            _ => signed(rng),
        });
        if direction.iter().any(|d| *d != 0.0) {
            break direction;
        }
    };
    let eye = [(); 3].map(|()| signed(rng) * 8.0);
    let start: f32 = from_exponents(rng, -10, 3);
    let length: f32 = from_exponents(rng, -24, 3);
    Ray { eye, direction, span: [start, start + length] }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEED: u64 = 0x5eed_0020;

    #[test]
    fn boxes_are_in_order_and_points_lie_inside() {
        in_order_and_inside::<f32>();
        in_order_and_inside::<f64>();
    }

    fn in_order_and_inside<T: Adversarial>() {
        let mut rng = Rng::with_seed(SEED);
        let (mut unbounded, mut lower, mut upper, mut inside) = (0, 0, 0, 0);
        for round in 0..20_000 {
            let region: [[T; 2]; 3] = random_box(&mut rng, Ends::Infinite);
            let case = format!("{region:?}, seed {SEED:#x}, round {round}");
            let point = point_in_box(&mut rng, &region);
            for (p, range) in point.into_iter().zip(region) {
                let [lo, hi]: [f64; 2] = range.map(Into::into);
                assert!(lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY, "{case}");
                unbounded += u32::from(lo.is_infinite() || hi.is_infinite());
                assert!(p.is_finite() && lo <= p && p <= hi, "{point:?} in {case}");
                lower += u32::from(p == lo && lo < hi);
                upper += u32::from(p == hi && lo < hi);
                inside += u32::from(lo < p && p < hi);
            }
        }
        let counts = [unbounded, lower, upper, inside];
        assert!(counts.iter().all(|count| *count > 5000), "{counts:?}");
        let mut rng = Rng::with_seed(SEED);
        for _ in 0..20_000 {
            let region: [[T; 2]; 3] = random_box(&mut rng, Ends::Finite);
            assert!(region.as_flattened().iter().all(|&end| end.into().is_finite()));
        }
    }

    #[test]
    fn rays_have_a_direction() {
        let mut rng = Rng::with_seed(SEED);
        let mut along_axes = 0;
        for _ in 0..1000 {
            let ray = random_ray(&mut rng);
            let moving = ray.direction.iter().filter(|d| **d != 0.0).count();
            assert!(moving > 0 && ray.span[0] <= ray.span[1], "{ray:?}");
            along_axes += u32::from(moving == 1);
        }
        assert!(along_axes > 50);
    }
}
