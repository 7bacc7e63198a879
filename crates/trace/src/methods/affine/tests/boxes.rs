//! Boxes around tiles contain the exact points of the tiles.

use crate::packet::tests::exact;
use crate::scalar::Scalar;
use num_rational::BigRational;
use zeroset_eval::{LANES, Tiles};
use zeroset_interval::Interval;
use zeroset_testkit::{Adversarial, Effort, Rng};

/// The corners of a tile are its extreme points: each coordinate is linear in the screen's
/// coordinates and in t.
fn check<T: Scalar + Adversarial>(rng: &mut Rng) -> u32 {
    let extreme = [4, 4, 40, 300][rng.u32(0..4) as usize];
    let number = |rng: &mut Rng| -> T {
        let sign = f64::from(rng.i32(-(1 << 20)..=1 << 20)) / 1e6;
        T::nearest(sign * 2_f64.powi(rng.i32(-extreme..=extreme.min(60))))
    };
    let mut tiles = Tiles::<T> { count: LANES as u32, ..Tiles::default() };
    for lane in 0..LANES {
        for part in 0..9 {
            tiles.origin[part][lane] = number(rng);
            tiles.direction[part][lane] = number(rng);
        }
        for k in 0..2 {
            tiles.centre[k][lane] = number(rng);
            tiles.half[k][lane] = T::nearest(number(rng).into().abs());
        }
        let mut ends = [number(rng).into(), number(rng).into()];
        ends.sort_by(f64::total_cmp);
        [tiles.near[lane], tiles.far[lane]] = ends.map(T::nearest);
        for axis in 0..3 {
            let error = if rng.bool() { 0.0 } else { number(rng).into().abs() * 1e-3 };
            tiles.error[axis][lane] = T::nearest(error);
        }
    }
    let everything = Interval { lo: -1e300, hi: 1e300 };
    let (boxes, inside) = tiles.boxes(&[everything; 3]);
    let mut checked = 0;
    for lane in 0..LANES {
        for axis in 0..3 {
            let of = |value: T| exact(value.into());
            for corner in 0..8 {
                let end = if corner & 1 == 0 { tiles.near } else { tiles.far };
                let t = of(end[lane]);
                let screen = [0, 1].map(|k| {
                    let half = of(tiles.half[k][lane]);
                    let half = if corner >> (k + 1) & 1 == 0 { -half } else { half };
                    of(tiles.centre[k][lane]) + half
                });
                let part = |k: usize| {
                    let [start, along] =
                        [&tiles.origin, &tiles.direction].map(|parts| parts[3 * k + axis][lane]);
                    of(start) + &t * of(along)
                };
                let point: BigRational = part(0) + &screen[0] * part(1) + &screen[1] * part(2);
                let error = of(tiles.error[axis][lane]);
                let (neg_lo, hi) = (boxes.neg_lo[axis][lane].into(), boxes.hi[axis][lane].into());
                assert!(inside >> lane & 1 == 1, "some points are in the domain");
                assert!(hi == f64::INFINITY || exact(hi) >= &point + &error, "{tiles:?} {lane}");
                assert!(
                    neg_lo == f64::INFINITY || exact(neg_lo) >= error - point,
                    "{tiles:?} {lane}"
                );
                checked += u32::from(hi.is_finite());
            }
        }
    }
    checked
}

#[test]
fn boxes_contain_the_points_of_their_tiles() {
    let effort = Effort::from_environment(0x5eed_b0c5, 120);
    let mut checked = 0;
    for seed in effort.seed..effort.seed + effort.cases {
        println!("ZEROSET_SEED={seed:#x} ZEROSET_CASES=1");
        let rng = &mut Rng::with_seed(seed);
        checked += check::<f32>(rng) + check::<f64>(rng);
    }
    assert!(checked > 10_000, "{checked}");
}
