//! Software enclosures in `f64` at points must contain the correctly rounded value, and be as tight
//! as each function's row in the table says.
//!
//! The reference values come from `core-math` alone. Operands are drawn from a seed: all exponents,
//! the whole range where a function curves, and places where rules may go wrong. Such places are
//! zeros and poles, ends of domains, and edges of overflow and underflow.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, SQRT_2};
use zeroset_interval::{
    Enclosure, Facts, Format, Interval, Operand, Software, Vector128, enclose, evaluate_sincos,
    fold,
};
use zeroset_ops::Op;
use zeroset_testkit::Rng;

const SEED: u64 = 0x0071_9475;
const POINTS: usize = 30_000;

/// A function, its correctly rounded value, and numbers close to which operands are drawn.
struct TestFunction {
    op: Op,
    truth: fn(f64) -> f64,
    hard: &'static [f64],
}

type ReferenceFunction = (Op, fn(f64) -> f64);
const WAVES: [ReferenceFunction; 2] = [(Op::Sin, core_math::sin), (Op::Cos, core_math::cos)];

/// Returns by how many ulps an enclosure in `f32`, and in `f64`, may exceed the tightest.
fn most(op: Op) -> [u64; 2] {
    op.row().excess.expect("an approximation")
}

/// Multiples of π/2, a tiny angle, and limits of the argument reduction.
const QUARTERS: [f64; 9] = [
    1e-310,
    FRAC_PI_2,
    -PI,
    3.0 * FRAC_PI_2,
    1000.0 * PI,
    66_637.5 * PI,
    1_048_576.0,
    123_456_789.0 * PI,
    ANGLE_LIMIT,
];
const ANGLE_LIMIT: f64 = 8_589_934_592.0; // 2^33

fn cases() -> Vec<TestFunction> {
    let case = |op, truth, hard| TestFunction { op, truth, hard };
    vec![
        case(Op::Cbrt, core_math::cbrt, &[1.0, 8.0, 27.0, 1e-310]),
        case(Op::Exp, core_math::exp, &[0.0, 709.78, -708.4, -745.1, 0.3466, 1.0397]),
        case(Op::Ln, core_math::log, &[1.0, SQRT_2, FRAC_1_SQRT_2, 1e-310]),
        case(Op::Log2, core_math::log2, &[1.0, SQRT_2, 8.0, 0.125, 1e-310]),
        case(Op::Log10, core_math::log10, &[1.0, 1000.0, 0.01, 1e-310]),
        case(Op::Sin, core_math::sin, &QUARTERS),
        case(Op::Cos, core_math::cos, &QUARTERS),
        case(Op::Tan, core_math::tan, &QUARTERS),
        case(Op::Asin, core_math::asin, &[0.0, 0.5, 1.0, 1e-310]),
        case(Op::Acos, core_math::acos, &[0.0, 0.5, 1.0, -0.5, -1.0]),
        case(Op::Atan, core_math::atan, &[0.0, 0.4142, 1.0, 2.4142, 1e300, 1e-310]),
        case(Op::Sinh, core_math::sinh, &[0.0, 0.3466, 1.0397, 710.4, 19.0, 1e-310]),
        case(Op::Cosh, core_math::cosh, &[0.0, 0.3466, 1.0397, 710.4, 19.0, 1e-310]),
        case(Op::Tanh, core_math::tanh, &[0.0, 0.3466, 1.0397, 22.0, 1e-310]),
        case(Op::Asinh, core_math::asinh, &[0.0, 0.4142, 1e9, 1.1e9, 1e300, 1e-310]),
        case(Op::Acosh, core_math::acosh, &[1.0, 1.1, SQRT_2, 1e9, 1.1e9, 1e300]),
        case(Op::Atanh, core_math::atanh, &[0.0, 0.1716, 0.5, 1.0, -1.0, 1e-310]),
        case(Op::Erf, core_math::erf, &[0.0, 0.5, 1.0, 4.24, 4.9, 6.0, 1e-120, 1e-310]),
    ]
}

/// Returns a number from 0 to 1.
fn unit(random: &mut Rng) -> f64 {
    random.u64(..) as f64 / u64::MAX as f64
}

/// Returns an operand near one of `hard`, a small operand, or any number.
fn draw(random: &mut Rng, hard: &[f64]) -> f64 {
    match random.u32(0..8) {
        0 => f64::from_bits(random.u64(..)),
        1 => 40.0 * unit(random) - 20.0,
        2 => 1600.0 * unit(random) - 800.0,
        3 => 2.0 * unit(random) - 1.0,
        4 => {
            // The exponent is uniform, from the smallest subnormals to 1.
            let size = (unit(random) * 1074.0).floor() as i32;
            (1.0 + unit(random)) * 2_f64.powi(-size / 2) * 2_f64.powi(-(size - size / 2))
        }
        _ => {
            let near = hard[random.u64(0..hard.len() as u64) as usize];
            let scale = 2_f64.powi(-random.i32(0..54));
            near * (1.0 + (2.0 * unit(random) - 1.0) * scale)
        }
    }
}

/// Checks the rule of sine and cosine for operands near 0, which gives enclosures and values. Hard
/// operands are multiples of π/2, where results are near 0 or ±1, and odd multiples of π/4, where
/// the reduced angle is greatest.
#[test]
fn waves_of_points_near_zero_are_as_tight_as_stated() {
    const LIMIT: f64 = 2048.0;
    let range = Interval { lo: -LIMIT, hi: LIMIT };
    let lanes = |x: f64| Vector128::from_f64([x; 2]);
    let mut random = Rng::with_seed(SEED);
    for (op, truth) in WAVES {
        let (mut worst, mut worst_at, mut farthest) = (0, 0.0, 0.0_f64);
        for _ in 0..4 * POINTS {
            let eighths = f64::from(random.i32(-2600..=2600));
            let hard = [eighths * FRAC_PI_2 / 2.0, LIMIT];
            let x = draw(&mut random, &hard);
            let x = if x.abs() <= LIMIT { x } else { LIMIT.copysign(x) };
            let value = truth(x);
            let operand = Operand::new(Enclosure::total(lanes(-x), lanes(x)), range);
            for mut machine in Software::BOTH {
                let enclosure = enclose(&mut machine, Format::F64, op, &[operand]);
                let bounds = Interval { lo: -enclosure.neg_lo.f64()[0], hi: enclosure.hi.f64()[0] };
                assert!(
                    bounds.lo <= value && value <= bounds.hi,
                    "{op:?} of {x:e} = {value:e} is not in {bounds:?}, {machine:?}, seed {SEED:#x}"
                );
                let ulps = excess(bounds, value);
                if ulps > worst {
                    (worst, worst_at) = (ulps, x);
                }
                let both = evaluate_sincos(&mut machine, Format::F64, op, lanes(x), range);
                let sampled = both.expect("twins")[0].f64()[0];
                let off = (sampled - value).abs() / value.abs().max(f64::MIN_POSITIVE);
                farthest = farthest.max(off);
            }
        }
        println!("{op:?} near 0: worst {worst} at {worst_at:e}, values off by {farthest:e}");
        assert!(worst <= most(op)[0], "seed {SEED:#x}: {worst} ulp at {worst_at:e}");
        // Affine forms allow for 1.75 units; rounding `value` adds up to half an ulp.
        assert!(farthest <= 2.25 * f64::EPSILON, "seed {SEED:#x}: {farthest:e}");
    }
}

/// Checks values of sine and cosine near 0 in `f32`. Their error must be within what affine forms
/// allow for. `f64` is precise enough to measure this error.
#[test]
fn values_of_waves_near_zero_are_off_by_what_forms_allow_for() {
    const LIMIT: f64 = 192.0;
    let range = Interval { lo: -LIMIT, hi: LIMIT };
    let mut random = Rng::with_seed(SEED);
    for (op, truth) in WAVES {
        let (mut farthest, mut least) = (0.0_f64, 0.0_f64);
        for _ in 0..4 * POINTS {
            let hard = [f64::from(random.i32(-244..=244)) * FRAC_PI_2 / 2.0, LIMIT];
            let x = draw(&mut random, &hard).clamp(-LIMIT, LIMIT) as f32;
            if !x.is_normal() {
                continue;
            }
            let lanes = Vector128::from_f32([x; 4]);
            let value = truth(f64::from(x));
            for mut machine in Software::BOTH {
                let both = evaluate_sincos(&mut machine, Format::F32, op, lanes, range);
                let sampled = f64::from(both.expect("twins")[0].f32()[0]);
                let off = (sampled - value) / value.abs() / f64::from(f32::EPSILON);
                (farthest, least) = (farthest.max(off), least.min(off));
            }
        }
        println!("{op:?} near 0 in f32: values off by {least} to {farthest} units");
        assert!(farthest.max(-least) <= 1.75, "seed {SEED:#x}: {least} to {farthest}");
        assert!(farthest > 1.0, "rounding alone makes that, seed {SEED:#x}");
    }
}

/// Returns the number of floats between 0 and `x`, with the sign of `x`.
fn place(x: f64) -> i64 {
    let magnitude = (x.to_bits() & (u64::MAX >> 1)) as i64;
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

/// Returns by how many floats an enclosure of `value` is wider than the tightest.
fn excess(bounds: Interval, value: f64) -> u64 {
    let exact = bounds.lo == bounds.hi;
    (place(bounds.hi) - place(bounds.lo)).unsigned_abs() - u64::from(!exact && value.is_finite())
}

/// Checks powers of positive numbers, many of them near 1. Three of four exponents are drawn so
/// that the power lies between e⁻⁷⁵⁰ and e⁷⁵⁰: in the range of floats, or slightly beyond it.
#[test]
fn powers_of_points_are_as_tight_as_stated() {
    let mut random = Rng::with_seed(SEED);
    let (mut worst, mut worst_at, mut count) = (0, [0.0; 2], 0);
    for _ in 0..POINTS {
        let x = draw(&mut random, &[1.0, SQRT_2, FRAC_1_SQRT_2, 2.0, 1e-310]).abs();
        let most = 750.0 / core_math::log(x).abs();
        let y = match random.u32(0..4) {
            0 => draw(&mut random, &[0.5, 1.0, -2.0]),
            _ => most * (2.0 * unit(&mut random) - 1.0),
        };
        let (Some(base), Some(exponent)) = (Interval::point(x), Interval::point(y)) else {
            continue;
        };
        if x == 0.0 {
            continue;
        }
        let value = core_math::pow(x, y);
        let (bounds, facts) = fold(Op::Pow, &[(base, Facts::TOTAL), (exponent, Facts::TOTAL)]);
        assert_eq!(facts, Facts::TOTAL, "{x:e}^{y:e}, seed {SEED:#x}");
        assert!(
            bounds.lo <= value && value <= bounds.hi,
            "{x:e}^{y:e} = {value:e} is not in {bounds:?}, seed {SEED:#x}"
        );
        let ulps = excess(bounds, value);
        count += 1;
        if ulps > worst {
            (worst, worst_at) = (ulps, [x, y]);
        }
    }
    println!("pow      worst {worst} at {worst_at:?} of {count}");
    assert!(worst <= most(Op::Pow)[1], "seed {SEED:#x}: {worst} ulp at {worst_at:?}");
}

/// Checks angles of points at any distance, also on and next to the axes and the diagonals.
#[test]
fn angles_of_points_are_as_tight_as_stated() {
    let mut random = Rng::with_seed(SEED);
    let (mut worst, mut worst_at, mut count) = ([0; 2], [[0.0; 2]; 2], 0);
    for _ in 0..POINTS {
        let hard = [0.0, 1.0, -1.0, 1e-310, 1e300, 2f64.powi(900), 2f64.powi(-100)];
        let x = draw(&mut random, &hard);
        let ratio = [1.0, -1.0, 0.414_213_56, 2.414_213_56, 1e-300, 2f64.powi(-800)];
        let y = match random.u32(0..2) {
            0 => x * draw(&mut random, &ratio),
            _ => draw(&mut random, &hard),
        };
        let (Some(a), Some(b)) = (Interval::point(y), Interval::point(x)) else { continue };
        let (bounds, facts) = fold(Op::Atan2, &[(a, Facts::TOTAL), (b, Facts::TOTAL)]);
        if x == 0.0 && y == 0.0 {
            assert_eq!(facts, Facts::NOWHERE, "seed {SEED:#x}");
            continue;
        }
        // Zeros of either sign count as +0.
        let value = core_math::atan2(y + 0.0, x + 0.0);
        assert_eq!(facts, Facts::TOTAL, "atan2({y:e}, {x:e}), seed {SEED:#x}");
        assert!(
            bounds.lo <= value && value <= bounds.hi,
            "atan2({y:e}, {x:e}) = {value:e} is not in {bounds:?}, seed {SEED:#x}"
        );
        let ulps = excess(bounds, value);
        count += 1;
        let tiny = usize::from(value.abs() < 2f64.powi(-799));
        if ulps > worst[tiny] {
            (worst[tiny], worst_at[tiny]) = (ulps, [y, x]);
        }
    }
    println!("atan2    worst {worst:?} (below 2^-799) at {worst_at:?} of {count}");
    let [_, most] = most(Op::Atan2);
    assert!(worst[0] <= 4 && worst[1] <= most, "seed {SEED:#x}: {worst:?} ulp at {worst_at:?}");
}

/// Returns by how many floats the enclosure of an operation on two `f32` is wider than the
/// tightest, or `None` if it misses `value`.
fn excess_in_f32(op: Op, operands: [f32; 2], value: f64) -> Option<u64> {
    let operand = |x: f32| {
        let lanes = |x| Vector128::from_f32([x; 4]);
        Operand::new(Enclosure::total(lanes(-x), lanes(x)), Interval::ENTIRE)
    };
    let place = |x: f32| {
        let magnitude = i64::from(x.to_bits() & (u32::MAX >> 1));
        if x.is_sign_negative() { -magnitude } else { magnitude }
    };
    let tightest = u64::from(f64::from(value as f32) != value);
    let excess = Software::BOTH.map(|mut machine| {
        let enclosure = enclose(&mut machine, Format::F32, op, &operands.map(operand));
        let (lo, hi) = (-enclosure.neg_lo.f32()[0], enclosure.hi.f32()[0]);
        let holds = f64::from(lo) <= value && value <= f64::from(hi);
        holds.then(|| place(hi).abs_diff(place(lo)) - tightest)
    });
    Some(excess[0]?.max(excess[1]?))
}

/// Checks an operation on two `f32` with many pairs of operands. A sweep would take too long.
fn search_in_f32(op: Op, truth: fn(f64, f64) -> f64, draw: impl Fn(&mut Rng) -> Option<[f32; 2]>) {
    let mut random = Rng::with_seed(SEED);
    let (mut worst, mut worst_at, mut count) = (0, [0.0; 2], 0);
    for operands in (0..4 * POINTS).filter_map(|_| draw(&mut random)) {
        let value = truth(f64::from(operands[0]), f64::from(operands[1]));
        let ulps = excess_in_f32(op, operands, value);
        let ulps = ulps.unwrap_or_else(|| panic!("{op:?} of {operands:?}, seed {SEED:#x}"));
        count += 1;
        if ulps > worst {
            (worst, worst_at) = (ulps, operands);
        }
    }
    println!("{:8} worst {worst} in f32 at {worst_at:?} of {count}", op.row().name);
    assert!(count > POINTS, "{count}");
    assert!(worst <= most(op)[0], "seed {SEED:#x}: {worst} ulp at {worst_at:?}");
}

/// Checks operands of any exponents, and ratios at which the rule switches to another formula.
#[test]
fn angles_of_f32_points_are_as_tight_as_stated() {
    let truth = |y: f64, x: f64| core_math::atan2(y + 0.0, x + 0.0);
    search_in_f32(Op::Atan2, truth, |random| {
        let x = f32::from_bits(random.u32(..));
        let ratio = [1.0, -1.0, 0.414_213_57, 2.414_213_7, 1e-7, 1e7][random.u64(0..6) as usize];
        let near = 1.0 + (2.0 * unit(random) - 1.0) * 2_f64.powi(-random.i32(0..24));
        let y = match random.u32(0..2) {
            0 => f32::from_bits(random.u32(..)),
            _ => (f64::from(x) * ratio * near) as f32,
        };
        (x.is_finite() && y.is_finite() && (x != 0.0 || y != 0.0)).then_some([y, x])
    });
}

/// Checks bases of any exponents and near 1, with exponents that avoid overflow.
#[test]
fn powers_of_f32_points_are_as_tight_as_stated() {
    search_in_f32(Op::Pow, core_math::pow, |random| {
        let x = match random.u32(0..2) {
            0 => f32::from_bits(random.u32(..)).abs(),
            _ => (1.0 + (2.0 * unit(random) - 1.0) * 2_f64.powi(-random.i32(0..24))) as f32,
        };
        let most = 103.0 / core_math::log(f64::from(x)).abs();
        let y = match random.u32(0..4) {
            0 => [0.5, -0.5, 2.5, 1.0 / 3.0][random.u64(0..4) as usize],
            _ => (most * (2.0 * unit(random) - 1.0)) as f32,
        };
        let value = core_math::pow(f64::from(x), f64::from(y));
        let fits = x.is_finite() && x > 0.0 && y.is_finite() && value <= f64::from(f32::MAX);
        fits.then_some([x, y])
    });
}

#[test]
fn enclosures_of_points_are_as_tight_as_stated() {
    let mut wide = Vec::new();
    for TestFunction { op, truth, hard } in cases() {
        let (name, [_, most]) = (op.row().name, most(op));
        let (mut worst, mut worst_at, mut sum, mut count) = (0, 0.0, 0, 0);
        let mut random = Rng::with_seed(SEED);
        for _ in 0..POINTS {
            let x = draw(&mut random, hard);
            let Some(point) = Interval::point(x) else { continue };
            let is_wave = matches!(op, Op::Sin | Op::Cos | Op::Tan);
            if is_wave && x.abs() > ANGLE_LIMIT {
                continue; // enclosed by the function's range
            }
            let value = truth(x);
            let (bounds, facts) = fold(op, &[(point, Facts::TOTAL)]);
            let has_pole = matches!(op, Op::Ln | Op::Log2 | Op::Log10 | Op::Atanh);
            if value.is_nan() || (value.is_infinite() && has_pole) {
                assert_eq!(facts, Facts::NOWHERE, "{name}({x:e}), seed {SEED:#x}");
                continue;
            }
            assert_eq!(facts, Facts::TOTAL, "{name}({x:e}), seed {SEED:#x}");
            assert!(
                bounds.lo <= value && value <= bounds.hi,
                "{name}({x:e}) = {value:e} is not in {bounds:?}, seed {SEED:#x}"
            );
            let ulps = excess(bounds, value);
            count += 1;
            sum += ulps;
            if ulps > worst {
                (worst, worst_at) = (ulps, x);
            }
        }
        let mean = sum as f64 / f64::from(count);
        println!("{name:8} worst {worst} at {worst_at:e}, mean {mean:.3} of {count}");
        if worst > most {
            wide.push(format!("{name}: {worst} ulp at {worst_at:e}, not {most}"));
        }
    }
    assert!(wide.is_empty(), "seed {SEED:#x}: {wide:#?}");
}
