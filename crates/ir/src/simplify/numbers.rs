//! Exact arithmetic on rational numbers of moderate size.

use crate::constant::{EXACT_BITS, bits};
use num_bigint::BigInt;
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use zeroset_ops::{Law, Op, Rounding};

/// `value`, or `None` if it is too large to stay exact.
pub(super) fn moderate(value: BigRational) -> Option<BigRational> {
    (bits(&value) <= EXACT_BITS).then_some(value)
}

/// `value^exponent`, or `None` if the power does not exist or is too large to stay exact.
pub(super) fn power(value: &BigRational, exponent: i64) -> Option<BigRational> {
    if value.is_one() || exponent == 0 {
        return Some(BigRational::one());
    }
    if value.is_zero() {
        return (exponent > 0).then(BigRational::zero);
    }
    let size = bits(value);
    let magnitude = exponent.unsigned_abs();
    // Powers of ±1 have one bit. Powers of other numbers grow with the exponent.
    if magnitude.saturating_mul(size.max(2) - 1) > EXACT_BITS && size > 1 {
        return None;
    }
    let magnitude = if size > 1 { magnitude } else { magnitude % 2 };
    let result = num_traits::pow(value.clone(), usize::try_from(magnitude).ok()?);
    moderate(if exponent < 0 { result.recip() } else { result })
}

/// The `degree`-th root of `value`, for a degree of 2 or 3. `None` if the root is not rational.
pub(super) fn root(value: &BigRational, degree: u32) -> Option<BigRational> {
    if degree == 2 && value.is_negative() {
        return None;
    }
    let exact = |whole: &BigInt| {
        let root = whole.nth_root(degree);
        (root.pow(degree) == *whole).then_some(root)
    };
    Some(BigRational::new(exact(value.numer())?, exact(value.denom())?))
}

/// The value of a function at the number `a`, if the value is known to be rational.
pub(super) fn function(op: Op, law: Law, a: &BigRational) -> Option<BigRational> {
    match law {
        Law::Magnitude => Some(a.abs()),
        Law::Sign => Some(a.signum()),
        Law::Rounding(Rounding::Down) => Some(a.floor()),
        Law::Rounding(Rounding::Up) => Some(a.ceil()),
        Law::Rounding(Rounding::Nearest) => Some(round_half_even(a)),
        Law::Rounding(Rounding::TowardZero) => Some(a.trunc()),
        Law::Fraction => Some(a - a.floor()),
        Law::SquareRoot => root(a, 2),
        Law::CubeRoot => root(a, 3),
        Law::Plain | Law::Undoes(_) => {
            let integer = |n: i32| BigRational::from_integer(n.into());
            let known = op.row().values.iter().find(|(argument, _)| integer(*argument) == *a);
            known.map(|(_, value)| integer(*value))
        }
    }
}

/// Twice the sine of each twelfth of a turn, where it is whole.
const SINES: [Option<i64>; 12] = [
    Some(0),
    Some(1),
    None,
    Some(2),
    None,
    Some(1),
    Some(0),
    Some(-1),
    None,
    Some(-2),
    None,
    Some(-1),
];

/// The sine or cosine of an angle in turns, if the value is known to be rational.
pub(super) fn of_turns(op: Op, turns: &BigRational) -> Option<BigRational> {
    let twelfths = turns * BigRational::from_integer(12.into());
    let twelfths = twelfths.is_integer().then(|| twelfths.to_integer().mod_floor(&12.into()))?;
    let twelfths = usize::try_from(twelfths).ok()?;
    let twice = if op == Op::Sin {
        SINES[twelfths]
    } else if op == Op::Cos {
        SINES[(twelfths + 3) % 12]
    } else {
        None
    };
    Some(BigRational::new(twice?.into(), 2.into()))
}

fn round_half_even(a: &BigRational) -> BigRational {
    let half = BigRational::new(1.into(), 2.into());
    let below = a.floor();
    let rest = a - &below;
    let even = (below.numer() % BigInt::from(2)).is_zero();
    if rest < half || (rest == half && even) { below } else { below + BigRational::one() }
}
