//! Tests of the rules of one operand, against the standard library and in a few exact cases.

use zeroset_interval::{Decorated, Exponent, Facts, Interval, fold};
use zeroset_ops::Op;

fn of(lo: f64, hi: f64) -> (Interval, Facts) {
    (Interval::new(lo, hi).expect("an interval"), Facts::TOTAL)
}

/// The number `n` as a constant integer exponent.
fn integer(n: i32) -> Decorated {
    Decorated { exponent: Exponent::Integer(n), ..of(f64::from(n), f64::from(n)).into() }
}

fn bounds<V: Copy + Into<Decorated>>(op: Op, operands: &[V]) -> (f64, f64) {
    let (bounds, _) = fold(op, operands);
    (bounds.lo, bounds.hi)
}

type Sample = (Op, fn(f64) -> f64);

/// Functions of one variable and their values from the standard library, correct to a few ulps.
fn samples() -> Vec<Sample> {
    vec![
        (Op::Neg, |a| -a),
        (Op::Abs, f64::abs),
        (Op::Sign, |a| if a == 0.0 { 0.0 } else { a.signum() }),
        (Op::Floor, f64::floor),
        (Op::Ceil, f64::ceil),
        (Op::Round, f64::round_ties_even),
        (Op::Trunc, f64::trunc),
        (Op::Fract, |a| a - a.floor()),
        (Op::Sqr, |a| a * a),
        (Op::Sqrt, f64::sqrt),
        (Op::Cbrt, f64::cbrt),
        (Op::Exp, f64::exp),
        (Op::Ln, f64::ln),
        (Op::Log2, f64::log2),
        (Op::Log10, f64::log10),
        (Op::Sin, f64::sin),
        (Op::Cos, f64::cos),
        (Op::Tan, f64::tan),
        (Op::Asin, f64::asin),
        (Op::Acos, f64::acos),
        (Op::Atan, f64::atan),
        (Op::Sinh, f64::sinh),
        (Op::Cosh, f64::cosh),
        (Op::Tanh, f64::tanh),
        (Op::Asinh, f64::asinh),
        (Op::Acosh, f64::acosh),
        (Op::Erf, libm::erf),
        // The standard library returns ±∞ at ±1, where the function is undefined.
        (Op::Atanh, |a| if a.abs() < 1.0 { a.atanh() } else { f64::NAN }),
    ]
}

#[test]
fn values_lie_inside_and_point_bounds_are_tight() {
    let points = [
        0.0,
        1.0,
        -1.0,
        0.5,
        -0.5,
        1e-300,
        -1e-300,
        5e-324,
        0.1,
        0.7,
        1.5,
        2.0,
        3.0,
        3.15,
        -2.2,
        10.0,
        100.5,
        709.0,
        -745.0,
        1e5,
        12_345_678.9,
        -8.5e9,
        1e300,
        -1e300,
        1e-160,
    ];
    for (op, f) in samples() {
        for &a in &points {
            let value = f(a);
            let (enclosure, facts) = fold(op, &[of(a, a)]);
            if value.is_nan() || (value == f64::NEG_INFINITY && a == 0.0) {
                assert!(facts.has(Facts::NOWHERE), "{op:?}({a}) is undefined: {enclosure:?}");
                continue;
            }
            assert!(!facts.has(Facts::NOWHERE), "{op:?}({a})");
            let slack = value.abs() * 4e-16;
            let finite = value.clamp(-f64::MAX, f64::MAX);
            assert!(
                enclosure.lo <= finite + slack && finite - slack <= enclosure.hi,
                "{op:?}({a}) = {value} outside {enclosure:?}"
            );
            if a.abs() < 1e10 && value.is_finite() {
                let width = 2e-14 * value.abs() + 1e-307;
                assert!(enclosure.width() <= width, "{op:?}({a}) = {value}: {enclosure:?}");
            }
        }
        for &a in &points {
            for &b in &points {
                if a >= b {
                    continue;
                }
                let (enclosure, facts) = fold(op, &[of(a, b)]);
                assert!(enclosure.lo <= enclosure.hi, "{op:?} [{a}, {b}]: {enclosure:?}");
                for step in 0..=64 {
                    let x = a + (b - a) * (f64::from(step) / 64.0);
                    let value = f(x.clamp(a, b)).clamp(-f64::MAX, f64::MAX);
                    if value.is_nan() || (op == Op::Tan && x.abs() > 1e6) {
                        continue;
                    }
                    let slack = value.abs() * 1e-15;
                    assert!(
                        enclosure.lo - slack <= value && value <= enclosure.hi + slack,
                        "{op:?}({x}) = {value} outside {enclosure:?} of [{a}, {b}] {facts:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn arithmetic_is_tightest_on_finite_operands() {
    assert_eq!(bounds(Op::Add, &[of(1.0, 2.0), of(-3.0, 5.0)]), (-2.0, 7.0));
    assert_eq!(bounds(Op::Sub, &[of(1.0, 2.0), of(-3.0, 5.0)]), (-4.0, 5.0));
    assert_eq!(bounds(Op::Mul, &[of(-1.0, 2.0), of(-3.0, 5.0)]), (-6.0, 10.0));
    assert_eq!(bounds(Op::Mul, &[of(1.0, 2.0), of(-3.0, 5.0)]), (-6.0, 10.0));
    assert_eq!(bounds(Op::Mul, &[of(-2.0, -1.0), of(-3.0, 5.0)]), (-10.0, 6.0));
    assert_eq!(bounds(Op::Mul, &[of(-2.0, -1.0), of(3.0, 5.0)]), (-10.0, -3.0));
    assert_eq!(bounds(Op::Div, &[of(-1.0, 2.0), of(4.0, 8.0)]), (-0.25, 0.5));
    assert_eq!(bounds(Op::Div, &[of(1.0, 2.0), of(-8.0, -4.0)]), (-0.5, -0.125));
    assert_eq!(bounds(Op::Div, &[of(1.0, 2.0), of(0.0, 4.0)]), (0.25, f64::INFINITY));
    assert_eq!(
        bounds(Op::Div, &[of(-1.0, 2.0), of(-1.0, 4.0)]),
        (f64::NEG_INFINITY, f64::INFINITY)
    );
    assert_eq!(bounds(Op::Sqr, &[of(-1.0, 2.0)]), (0.0, 4.0));
    assert_eq!(bounds(Op::Pow, &[of(-1.0, 2.0).into(), integer(3)]), (-1.0, 8.0));
    assert_eq!(bounds(Op::Pow, &[of(-2.0, 1.0).into(), integer(4)]), (0.0, 16.0));
    assert_eq!(bounds(Op::Pow, &[of(2.0, 4.0).into(), integer(-1)]), (0.25, 0.5));
    assert_eq!(bounds(Op::Sqrt, &[of(4.0, 9.0)]), (2.0, 3.0));
    assert_eq!(bounds(Op::Mod, &[of(2.5, 2.75), of(1.0, 1.0)]), (0.5, 0.75));
    assert_eq!(bounds(Op::Mod, &[of(2.5, 3.25), of(1.0, 1.0)]), (0.0, 1.0));
    assert_eq!(bounds(Op::Sin, &[of(1.0, 2.0)]).1, 1.0);
    assert_eq!(bounds(Op::Cos, &[of(3.0, 4.0)]).0, -1.0);
    assert_eq!(bounds(Op::Cos, &[of(-1.0, 4.0)]), (-1.0, 1.0));
}

#[test]
fn facts_say_where_a_function_is_defined() {
    let facts = |op, operands: &[(Interval, Facts)]| fold(op, operands).1;
    assert_eq!(facts(Op::Sqrt, &[of(-2.0, -1.0)]), Facts::NOWHERE);
    assert_eq!(facts(Op::Sqrt, &[of(0.0, 1.0)]), Facts::TOTAL);
    assert_eq!(facts(Op::Ln, &[of(0.0, 1.0)]), Facts::NONE);
    assert_eq!(facts(Op::Div, &[of(1.0, 1.0), of(0.0, 0.0)]), Facts::NOWHERE);
    assert_eq!(facts(Op::Div, &[of(1.0, 1.0), of(0.0, 1.0)]), Facts::NONE);
    assert_eq!(facts(Op::Div, &[of(1.0, 1.0), of(1.0, 2.0)]), Facts::TOTAL);
    assert_eq!(facts(Op::Tan, &[of(1.0, 2.0)]), Facts::NONE);
    assert_eq!(facts(Op::Tan, &[of(-1.0, 1.0)]), Facts::TOTAL);
    assert_eq!(facts(Op::Floor, &[of(0.5, 1.5)]), Facts::DEFINED);
    assert_eq!(facts(Op::Floor, &[of(1.0, 1.5)]), Facts::TOTAL);
    assert_eq!(facts(Op::Pow, &[of(-2.0, -1.0), of(0.5, 0.5)]), Facts::NOWHERE);
    assert_eq!(facts(Op::Pow, &[of(0.0, 1.0), of(0.5, 0.5)]), Facts::TOTAL);
    // An exponent that is not a constant counts as real, even if its only value is an integer.
    assert_eq!(facts(Op::Pow, &[of(-2.0, -1.0), of(2.0, 2.0)]), Facts::NOWHERE);
    let with_integer = |n| fold(Op::Pow, &[of(-1.0, 1.0).into(), integer(n)]).1;
    assert_eq!(with_integer(-2), Facts::NONE);
    assert_eq!(with_integer(0), Facts::TOTAL);
    assert_eq!(
        facts(
            Op::SelectNegative,
            &[of(-2.0, -1.0), of(0.0, 1.0), (Interval::ENTIRE, Facts::NOWHERE)]
        ),
        Facts::TOTAL
    );
    assert_eq!(facts(Op::WhereNonneg, &[of(0.0, 1.0), of(-2.0, -1.0)]), Facts::NOWHERE);
    assert_eq!(facts(Op::WherePositive, &[of(0.0, 1.0), of(0.0, 0.0)]), Facts::NOWHERE);
}

#[test]
fn no_bound_is_nan_or_infinite_on_the_wrong_side() {
    let ends = [
        f64::NEG_INFINITY,
        -f64::MAX,
        -1.0,
        -5e-324,
        0.0,
        5e-324,
        0.5,
        1.0,
        2.0,
        f64::MAX,
        f64::INFINITY,
    ];
    let mut boxes = Vec::new();
    for &lo in &ends {
        for &hi in &ends {
            boxes.extend(Interval::new(lo, hi).map(|bounds| (bounds, Facts::TOTAL)));
        }
    }
    let check = |op: Op, operands: &[(Interval, Facts)]| {
        let (bounds, _) = fold(op, operands);
        assert!(Interval::new(bounds.lo, bounds.hi).is_some(), "{op:?} {operands:?}: {bounds:?}");
    };
    for row in zeroset_ops::TABLE {
        for a in &boxes {
            match row.arity {
                1 => check(row.op, &[*a]),
                2 => boxes.iter().for_each(|b| check(row.op, &[*a, *b])),
                _ => boxes.iter().for_each(|b| check(row.op, &[*a, *b, of(1.0, 2.0)])),
            }
        }
    }
}
