//! Affine forms must enclose the values of every operation alone, and of random functions along
//! segments and tiles of rays, in both precisions. Narrowing must lose no zero. Errors of smooth
//! operations must shrink like the square of the operands' spread.
//!
//! A long run: `ZEROSET_CASES=10000000 cargo test --release -p zeroset-testkit --test all forms`.

use zeroset_eval::{Lanes, Real};
use zeroset_interval::{
    Exponent, Form, FormOperand, Format, Interval, Machine, Software, Vector128, linearise,
};
use zeroset_ops::{Domain, Op, TABLE};
use zeroset_testkit::property::{
    ContractionTally, Engine, FormTally, KernelOptions, check_contraction, check_narrowing, linear,
};
use zeroset_testkit::suite::Tally;
use zeroset_testkit::{Adversarial, Case, Effort, GraphOptions, Rng, count_claims};

/// Number of vectors drawn from one seed.
const ROUNDS: usize = 64;

/// Operations whose affine forms are always plain bounds.
const BOUNDS_ONLY: [Op; 6] = [Op::Sign, Op::Floor, Op::Ceil, Op::Round, Op::Trunc, Op::Atan2];

fn operations<T: Adversarial>(seed: u64) {
    let effort = Effort::from_environment(seed, 100_000);
    let cases = effort.cases.div_ceil(TABLE.len() as u64);
    let mut all = FormTally::default();
    for row in TABLE {
        let mut lines = FormTally::default();
        for seed in effort.seed.. {
            if lines.lanes >= cases {
                break;
            }
            let drawn = linear::<T>(row.op, &mut Rng::with_seed(seed), ROUNDS);
            lines.add(drawn.unwrap_or_else(|failure| {
                panic!("{failure}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1")
            }));
        }
        // Some operations have small domains of definition, and random operands often lie outside.
        assert!(lines.finite * 8 > lines.lanes, "{}: {lines:?}", row.name);
        let slanted = lines.slanted * 16 > lines.lanes;
        assert_eq!(slanted, !BOUNDS_ONLY.contains(&row.op), "{}: {lines:?}", row.name);
        all.add(lines);
    }
    println!("{:?}: {all:?}", T::FORMAT);
    count_claims(all.lanes);
}

#[test]
fn forms_of_every_operation_hold_its_values() {
    operations::<f32>(0x5eed_0b00_0000);
    operations::<f64>(0x5eed_0b10_0000);
}

fn contractions<T: Adversarial, const N: usize>(seed: u64) {
    let effort = Effort::from_environment(seed, 20_000);
    let mut tally = Tally::default();
    for seed in effort.seed.. {
        if tally.compared >= effort.cases {
            break;
        }
        let drawn = check_narrowing::<T, N>(&mut Rng::with_seed(seed), ROUNDS);
        tally.add(
            drawn.unwrap_or_else(|failure| {
                panic!("{failure}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1")
            }),
        );
    }
    println!("{:?}, {N}: {tally:?}", T::FORMAT);
    count_claims(tally.compared);
    assert!(tally.defined * 4 > tally.compared, "{tally:?}");
}

#[test]
fn contractions_keep_the_zeros_of_lines() {
    contractions::<f32, 1>(0x5eed_0b20_0000);
    contractions::<f32, 3>(0x5eed_0b21_0000);
    contractions::<f64, 1>(0x5eed_0b22_0000);
    contractions::<f64, 3>(0x5eed_0b23_0000);
}

/// Checks random cases until `cases` values were compared with planes.
fn check<T: Adversarial>(name: &str, seed: u64, options: &GraphOptions) {
    let effort = Effort::from_environment(seed, 100_000);
    let is_long = effort.cases > 1_000_000;
    let mut all = ContractionTally::default();
    for seed in effort.seed.. {
        if all.planes >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let options = GraphOptions { size: rng.u32(1..=options.size), ..options.clone() };
        let case = Case::random(&mut rng, &options);
        // Compiling is slow, so only long runs use native code.
        let engine = if is_long { Engine::Native } else { Engine::Reference };
        let kernel_options = KernelOptions { simple: rng.bool(), engine };
        let batches = if is_long { 32 } else { 2 };
        let drawn = check_contraction::<T>(kernel_options, &case, &mut rng, batches);
        all.add(
            drawn.unwrap_or_else(|failure| {
                panic!("{failure}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1")
            }),
        );
    }
    println!("{name}, {:?}: {all:?}", T::FORMAT);
    count_claims(all.points);
    assert!(all.planes * 4 > all.points, "{all:?}");
    assert!(all.roots > 0 && all.narrowed > 0 && all.crossings > 0, "{all:?}");
}

#[test]
fn planes_of_typical_formulas_hold_their_values() {
    let options = GraphOptions { adversarial: false, ..GraphOptions::default() };
    check::<f32>("typical", 0x5eed_0b30_0000, &options);
    check::<f64>("typical", 0x5eed_0b40_0000, &options);
}

#[test]
fn planes_of_adversarial_formulas_with_parameters_hold_their_values() {
    let options = GraphOptions { size: 6, parameters: 2, ..GraphOptions::default() };
    check::<f32>("adversarial", 0x5eed_0b50_0000, &options);
    check::<f64>("adversarial", 0x5eed_0b60_0000, &options);
}

#[test]
fn planes_of_polynomials_hold_their_values() {
    let ops = vec![Op::Add, Op::Sub, Op::Mul, Op::Sqr, Op::Pow, Op::Neg];
    let options = GraphOptions { size: 12, ops, parameters: 1, adversarial: false };
    check::<f32>("polynomials", 0x5eed_0b70_0000, &options);
    check::<f64>("polynomials", 0x5eed_0b80_0000, &options);
}

/// Checks operations that choose between operands or restrict them, and partial functions.
#[test]
fn planes_of_choices_hold_their_values() {
    let ops = vec![
        Op::Otherwise,
        Op::SelectNegative,
        Op::WhereNonneg,
        Op::WherePositive,
        Op::WhereNonzero,
        Op::WhereDefined,
        Op::Ln,
        Op::Sqrt,
        Op::Div,
        Op::Asin,
        Op::Sign,
        Op::Mod,
        Op::Sub,
        Op::Min,
        Op::Max,
    ];
    let options = GraphOptions { size: 8, ops, parameters: 0, adversarial: false };
    check::<f32>("choices", 0x5eed_0b90_0000, &options);
    check::<f64>("choices", 0x5eed_0ba0_0000, &options);
}

/// Returns the error of the form of `op` in `f64`, for operands that spread around `centres`.
fn error_of(op: Op, centres: [f64; 3], spread: f64) -> f64 {
    let lanes = |x: f64| Vector128::from_f64([x; 2]);
    let operands = [(1.0, 0.5), (-0.25, 1.0), (0.5, -0.25)].into_iter().zip(centres);
    let operands = operands.take(op.arity()).map(|((a, b), centre)| {
        let slopes = [lanes(a * spread), lanes(b * spread)];
        let value = Form::coordinate(lanes(centre), slopes, lanes(0.0));
        FormOperand { value, range: Interval::ENTIRE, exponent: Exponent::Real }
    });
    let operands: Vec<_> = operands.collect();
    let mut m = Software::new();
    let form = linearise(&mut m, Format::F64, op, &operands);
    let mut errors = Lanes::<f64>::default();
    f64::store(form.error(&mut m, Format::F64).expect("an error"), 0, &mut errors);
    errors[0]
}

/// Returns the error of the affine form of x·x, where x reaches `steep` and the product overflows.
/// An error of −∞ would exclude all values of the product.
fn error_of_steep_product<const N: usize>(format: Format, steep: f64, mut m: Software) -> f64 {
    let lanes = |m: &mut Software, x: f64| m.number(format, x);
    let slopes: [_; N] =
        std::array::from_fn(|k| lanes(&mut m, if k + 1 == N { steep } else { 0.0 }));
    let zero = lanes(&mut m, 0.0);
    let value = Form::coordinate(zero, slopes, zero);
    let operand = FormOperand { value, range: Interval::ENTIRE, exponent: Exponent::Real };
    let form = linearise(&mut m, format, Op::Mul, &[operand; 2]);
    let error = form.error(&mut m, format).expect("an error");
    match format {
        Format::F32 => error.f32()[0].into(),
        Format::F64 => error.f64()[0],
    }
}

#[test]
fn products_beyond_all_floats_claim_nothing() {
    for machine in Software::BOTH {
        for (format, steep) in [(Format::F32, 1e20_f32.into()), (Format::F64, 1e200)] {
            let errors = [
                error_of_steep_product::<1>(format, steep, machine),
                error_of_steep_product::<2>(format, steep, machine),
                error_of_steep_product::<3>(format, steep, machine),
            ];
            let claims = |error: &f64| error.is_finite() || *error < 0.0;
            assert!(!errors.iter().any(claims), "{machine:?} {format:?}: {errors:?}");
        }
    }
}

/// Checks that errors shrink like the square of the spread, down to rounding errors.
#[test]
fn errors_of_smooth_operations_shrink_quadratically() {
    for row in TABLE.iter().filter(|row| !BOUNDS_ONLY.contains(&row.op)) {
        let centres = match row.domain {
            Domain::Unit | Domain::UnitInside | Domain::CosineNonzero => [0.6, 0.0, 0.0],
            // These operands are away from the remainder's jumps.
            _ if row.op == Op::Mod => [1.2, 0.9, 0.0],
            _ => [1.7, 0.9, 1.3],
        };
        let errors = [1e-1, 1e-2, 1e-3, 1e-4].map(|spread| error_of(row.op, centres, spread));
        println!("{}: {errors:?}", row.name);
        assert!(errors[0] < 0.1, "{}: {errors:?}", row.name);
        for pair in errors.windows(2) {
            assert!(pair[1] <= pair[0] / 50.0 + 1e-14, "{}: {errors:?}", row.name);
        }
    }
}
