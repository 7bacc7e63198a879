//! Software enclosures in `f64` at points must contain the exact value. Comparing with the value
//! rounded to nearest would not suffice: bounds that are wrong by nearly half an ulp could still
//! contain the rounded value.
//!
//! The reference values are Taylor series in integer arithmetic. A function like ln is checked by
//! its increasing inverse: a ≤ ln x if exp a ≤ x. Operands lie at the ends of the reduced ranges,
//! where the rules err most.

use num_bigint::BigInt;
use num_traits::Zero;
use std::f64::consts::{FRAC_PI_4, LN_2};
use std::sync::LazyLock;
use zeroset_interval::round::{f32_up, f64_up};
use zeroset_interval::{Facts, Interval, fold};
use zeroset_ops::Op;
use zeroset_testkit::Rng;

const SEED: u64 = 0x00e8_ac70;
const POINTS: usize = 10_000;

/// The reference computes with integers in units of 2⁻²⁰⁰.
const PLACES: i32 = 200;
/// The series below err by less than 2^`ERROR` units, which is 2⁻¹⁵⁰.
const ERROR: i32 = PLACES - 150;

/// Converts a float, which must be a multiple of the unit, to units.
fn exact(x: f64) -> BigInt {
    let bits = x.to_bits();
    let exponent = ((bits >> 52 & 0x7ff) as i32).max(1);
    let implicit = u64::from(bits >> 52 & 0x7ff != 0) << 52;
    let magnitude = BigInt::from(bits & ((1 << 52) - 1) | implicit);
    let shift = exponent - 1075 + PLACES;
    assert!(shift >= 0, "{x:e} is too small");
    let magnitude = magnitude << shift;
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

fn times(a: &BigInt, b: &BigInt) -> BigInt {
    (a * b) >> PLACES
}

fn over(a: &BigInt, b: &BigInt) -> BigInt {
    (a << PLACES) / b
}

/// Returns Σ xⁿ/n!, summed over even n and over odd n. These are (cosh, sinh) of x, or (cos, sin)
/// if `turns`, which alternates the signs.
fn series(x: &BigInt, turns: bool) -> [BigInt; 2] {
    let mut sums = [BigInt::zero(), BigInt::zero()];
    let mut term = BigInt::from(1) << PLACES;
    for n in 0_u32.. {
        // Shifting rounds down, so a negative term ends at −1 and not at 0.
        if term.bits() <= 1 {
            break;
        }
        if turns && n % 4 >= 2 {
            sums[n as usize % 2] -= &term;
        } else {
            sums[n as usize % 2] += &term;
        }
        term = times(&term, x) / (n + 1);
    }
    sums
}

fn exp(x: &BigInt) -> BigInt {
    let [even, odd] = series(x, false);
    even + odd
}
fn sinh(x: &BigInt) -> BigInt {
    series(x, false)[1].clone()
}
fn cosh(x: &BigInt) -> BigInt {
    series(x, false)[0].clone()
}
fn tanh(x: &BigInt) -> BigInt {
    let [cosh, sinh] = series(x, false);
    over(&sinh, &cosh)
}
fn sin(x: &BigInt) -> BigInt {
    series(x, true)[1].clone()
}
fn cos(x: &BigInt) -> BigInt {
    series(x, true)[0].clone()
}
fn minus_cos(x: &BigInt) -> BigInt {
    -cos(x)
}
fn tan(x: &BigInt) -> BigInt {
    let [cos, sin] = series(x, true);
    over(&sin, &cos)
}

/// 1 in units.
fn one() -> BigInt {
    BigInt::from(1) << PLACES
}

/// π by Machin's formula, 16 atan(1/5) − 4 atan(1/239).
fn pi() -> BigInt {
    let atan = |n: i32| {
        let mut power: BigInt = one() / n;
        let mut sum = BigInt::zero();
        for k in 0.. {
            if power.is_zero() {
                return sum;
            }
            let term: BigInt = &power / (2 * k + 1);
            sum += if k % 2 == 0 { term } else { -term };
            power /= n * n;
        }
        sum
    };
    atan(5) * 16 - atan(239) * 4
}

static ROOT_OF_PI: LazyLock<BigInt> = LazyLock::new(|| (pi() << PLACES).sqrt());

/// 2/√π Σ (−1)ᵏ x²ᵏ⁺¹ / (k! (2k + 1)).
fn erf(x: &BigInt) -> BigInt {
    let square = times(x, x);
    let (mut power, mut sum) = (x.clone(), BigInt::zero());
    for k in 0_u32.. {
        if power.bits() <= 1 {
            break;
        }
        sum += &power / (2 * k + 1);
        power = -times(&power, &square) / (k + 1);
    }
    over(&(sum * 2), &ROOT_OF_PI)
}

/// Σ (−1)ᵏ (x/2)²ᵏ⁺ⁿ / (k! (k + n)!) for n = `ORDER`.
fn bessel<const ORDER: u32>(x: &BigInt) -> BigInt {
    let half: BigInt = x / 2;
    let square = times(&half, &half);
    let mut term = (1..=ORDER).fold(one(), |term, n| times(&term, &half) / n);
    let mut sum = BigInt::zero();
    for k in 1_u32.. {
        if term.bits() <= 1 {
            break;
        }
        sum += &term;
        term = -times(&term, &square) / (k * (k + ORDER));
    }
    sum
}

/// A way to compute the reference value of a function.
#[derive(Clone, Copy)]
enum ReferenceMethod {
    /// The function itself.
    Of(fn(&BigInt) -> BigInt),
    /// The inverse function, which increases.
    Inverse(fn(&BigInt) -> BigInt),
    /// Minus the inverse function, if the inverse decreases.
    FallingInverse(fn(&BigInt) -> BigInt),
}

/// Returns a number from −1 to 1.
fn unit(random: &mut Rng) -> f64 {
    2.0 * (random.u64(..) as f64 / u64::MAX as f64) - 1.0
}

/// Returns a number close to `k * half`, for a random odd k below `2 * most` in magnitude.
fn odd_multiple(random: &mut Rng, half: f64, most: i32) -> f64 {
    let odd = 2 * random.i32(-most..most) + 1;
    half * (f64::from(odd) + 0.2 * unit(random))
}

/// Returns a number close to one of `places`, where rules switch to another formula.
fn around(random: &mut Rng, places: &[f64]) -> f64 {
    let place = places[random.u32(0..places.len() as u32) as usize];
    place * (1.0 + 0.1 * unit(random))
}

type Draw = fn(&mut Rng) -> f64;

fn cases() -> Vec<(Op, ReferenceMethod, Draw)> {
    use ReferenceMethod::{FallingInverse, Inverse, Of};
    let turn: Draw = |random| odd_multiple(random, FRAC_PI_4, 4);
    let power: Draw = |random| odd_multiple(random, LN_2 / 2.0, 8);
    let ratio: Draw = |random| {
        let x = around(random, &[0.414, 0.7, 1.0, 1.414, 2.414]);
        if random.bool() { x } else { -x }
    };
    let share: Draw = |random| {
        let x = around(random, &[0.17, 0.3, 0.5, 0.707, 0.88]);
        if random.bool() { x } else { -x }
    };
    let above: Draw = |random| around(random, &[0.3, 0.5, 0.75, 1.4, 3.0, 5.6]);
    let from_one: Draw = |random| around(random, &[1.25, 1.414, 2.0, 3.0]);
    // Around the ends of the ranges of series, and anywhere between.
    let bell: Draw = |random| {
        let ends = around(random, &[4.9, -4.9, 6.0, -6.0, 0.01]);
        if random.bool() { ends } else { 6.5 * unit(random) }
    };
    let drum: Draw = |random| {
        let ends = around(random, &[11.3, -11.3, 22.6, -22.6, 0.01]);
        if random.bool() { ends } else { 40.0 * unit(random) }
    };
    vec![
        (Op::Erf, Of(erf), bell),
        (Op::BesselJ0, Of(bessel::<0>), drum),
        (Op::BesselJ1, Of(bessel::<1>), drum),
        (Op::BesselJ2, Of(bessel::<2>), drum),
        (Op::BesselJ3, Of(bessel::<3>), drum),
        (Op::Exp, Of(exp), power),
        (Op::Sinh, Of(sinh), power),
        (Op::Cosh, Of(cosh), power),
        (Op::Tanh, Of(tanh), power),
        (Op::Sin, Of(sin), turn),
        (Op::Cos, Of(cos), turn),
        (Op::Tan, Of(tan), turn),
        (Op::Ln, Inverse(exp), above),
        (Op::Asin, Inverse(sin), share),
        (Op::Acos, FallingInverse(minus_cos), share),
        (Op::Atan, Inverse(tan), ratio),
        (Op::Asinh, Inverse(sinh), ratio),
        (Op::Acosh, Inverse(cosh), from_one),
        (Op::Atanh, Inverse(tanh), share),
    ]
}

#[test]
fn enclosures_of_points_hold_the_exact_value() {
    let error = BigInt::from(1) << ERROR;
    for (op, truth, draw) in cases() {
        let name = op.row().name;
        let mut random = Rng::with_seed(SEED);
        for _ in 0..POINTS {
            let x = draw(&mut random);
            let point = Interval::point(x).expect("finite");
            let (bounds, facts) = fold(op, &[(point, Facts::TOTAL)]);
            assert_eq!(facts, Facts::TOTAL, "{name}({x:e}), seed {SEED:#x}");
            let (lo, hi) = (exact(bounds.lo), exact(bounds.hi));
            let x_exact = exact(x);
            // The three numbers are in order if the bounds are correct.
            let [low, middle, high] = match truth {
                ReferenceMethod::Of(f) => [lo, f(&x_exact), hi],
                ReferenceMethod::Inverse(f) => [f(&lo), x_exact, f(&hi)],
                ReferenceMethod::FallingInverse(minus_f) => [minus_f(&lo), -x_exact, minus_f(&hi)],
            };
            assert!(
                low <= &middle + &error && middle <= high + &error,
                "{name}({x:e}) is not in {bounds:?}, seed {SEED:#x}"
            );
        }
        println!("{name}: {POINTS} points");
    }
}

/// Enclosures of Bessel functions at points are at most five units in the last place of their
/// amplitude wide. Any enclosure needs one. Relative to values near a zero, they are wider.
#[test]
fn enclosures_of_bessel_functions_are_narrow_beside_their_amplitude() {
    for op in [Op::BesselJ0, Op::BesselJ1, Op::BesselJ2, Op::BesselJ3] {
        let mut random = Rng::with_seed(SEED);
        let mut worst = (0.0, 0.0);
        for _ in 0..2 * POINTS {
            let x = match random.u32(0..3) {
                0 => 40.0 * unit(&mut random),
                1 => 1e6 * unit(&mut random),
                _ => 2f64.powi(-random.i32(0..1000)) * unit(&mut random),
            };
            let point = Interval::point(x).expect("finite");
            let (bounds, _) = fold(op, &[(point, Facts::TOTAL)]);
            // The amplitude is √(2/πx) where the function swings.
            let swing = if x.abs() < 2.0 { 0.0 } else { (0.6 / x.abs()).sqrt() };
            let amplitude = swing.max(bounds.lo.abs()).max(bounds.hi.abs());
            let ulp = amplitude.next_up() - amplitude;
            let width = (bounds.hi - bounds.lo) / ulp;
            if width > worst.0 {
                worst = (width, x);
            }
        }
        println!("{}: {} units at {:e}", op.row().name, worst.0, worst.1);
        assert!(worst.0 <= 5.0, "{op:?}: {worst:?}, seed {SEED:#x}");
    }
}

/// Returns `x` in units of 2⁻²¹⁴⁸. Products of two `f64` are integers in this unit.
fn whole(x: f64) -> BigInt {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    let magnitude = BigInt::from(bits & ((1 << 52) - 1) | u64::from(exponent != 0) << 52);
    let magnitude = magnitude << (exponent.max(1) - 1 + 1074);
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

fn product_and([a, b, c]: [f64; 3]) -> BigInt {
    ((whole(a) * whole(b)) >> 2148) + whole(c)
}

/// Checks infinities, NaN and signs of zero. An exact 0 is +0, except for a sum of two negative
/// zeros. A negative value that underflows becomes −0.
#[test]
fn products_are_added_to_as_ieee_754_has_it() {
    let (infinity, tiny) = (f64::INFINITY, f64::from_bits(1));
    for (a, b, c, expected) in [
        (1.0, -0.0, -0.0, -0.0),
        (1.0, -0.0, 0.0, 0.0),
        (3.0, 5.0, -15.0, 0.0),
        (-tiny, 0.25, 0.0, -0.0),
        (-tiny, 0.25, -0.0, -0.0),
        (infinity, 2.0, 1.0, infinity),
        (f64::MAX, 2.0, -infinity, -infinity),
        (infinity, 2.0, -infinity, f64::NAN),
        (infinity, 0.0, 1.0, f64::NAN),
    ] {
        let result = f64_up::mul_add(a, b, c);
        let is_same = |result: f64| {
            result.to_bits() == expected.to_bits() || result.is_nan() && expected.is_nan()
        };
        assert!(is_same(result), "{a:e} · {b:e} + {c:e}: {result:e}");
        let shrunk =
            |x: f64| if x.abs() == tiny { f32::from_bits(1).copysign(x as f32) } else { x as f32 };
        if a != f64::MAX {
            let result = f32_up::mul_add(shrunk(a), b as f32, c as f32);
            assert!(is_same(result.into()), "{a:e} · {b:e} + {c:e} in f32: {result:e}");
        }
    }
    assert_eq!(f32_up::mul_add(f32::MAX, 2.0, f32::NEG_INFINITY), f32::NEG_INFINITY);
}

/// Checks terms that cancel, that differ much in size, and that are subnormal or overflow.
#[test]
fn products_are_added_to_with_one_rounding_up() {
    println!("seed {SEED:#x}");
    let mut rng = Rng::with_seed(SEED);
    let float = |rng: &mut Rng, spread: u64| {
        let exponent = 1023 + rng.u64(0..=2 * spread) - spread;
        // Few digits, so that some sums are exact.
        let digits = (rng.u64(..) >> 12) & (u64::MAX << rng.u32(0..53));
        f64::from_bits(rng.u64(0..2) << 63 | exponent << 52 | digits)
    };
    let (mut exact, mut infinite, mut tried) = (0, 0, 0);
    for round in 0..100_000 {
        let spread = [2, 60, 540, 1023][round % 4];
        let (a, b) = (float(&mut rng, spread), float(&mut rng, spread));
        let c = match rng.u32(0..4) {
            0 => -(a * b),
            1 => (-(a * b)).next_up(),
            2 => f64::from_bits(rng.u64(0..1 << 54)),
            _ => float(&mut rng, spread),
        };
        let narrow = [a, b, c].map(|x| x as f32);
        if [a, b, c].iter().all(|x| x.is_finite()) {
            let (sum, result) = (product_and([a, b, c]), f64_up::mul_add(a, b, c));
            let below = result.next_down();
            let reaches = result == f64::INFINITY || whole(result) >= sum;
            let is_least = below == f64::NEG_INFINITY || whole(below) < sum;
            assert!(reaches && is_least, "{a:e} · {b:e} + {c:e}: {result:e}");
            tried += 1;
            infinite += usize::from(result == f64::INFINITY);
            exact += usize::from(result.is_finite() && whole(result) == sum);
        }
        if narrow.iter().all(|x| x.is_finite()) {
            let [a, b, c] = narrow;
            let (sum, result) = (product_and(narrow.map(f64::from)), f32_up::mul_add(a, b, c));
            let below = result.next_down();
            let reaches = result == f32::INFINITY || whole(result.into()) >= sum;
            let is_least = below == f32::NEG_INFINITY || whole(below.into()) < sum;
            assert!(reaches && is_least, "{a:e} · {b:e} + {c:e}: {result:e}");
        }
    }
    println!("{tried} sums of f64, {exact} of them exact, {infinite} too large");
    assert!(exact > tried / 20 && infinite > tried / 100);
}
