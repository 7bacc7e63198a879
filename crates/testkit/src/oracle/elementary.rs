//! Elementary functions over ranges of operands.
//!
//! For a non-zero rational operand, exp, ln, sin, cos, tan, atan and similar functions have an
//! irrational value (Lindemann), except for ln 1. So the only exact results are those treated
//! below.

use super::rounded::Rounded;
use super::span::Span;

/// A range of angles narrower than this contains at most one zero of the sine, and one of the
/// cosine. The bound is less than π by far more than the rounding error of a width.
const LESS_THAN_HALF_PERIOD: f64 = 3.0;

pub(super) fn exp(a: Span) -> Span {
    a.increasing(|x| Rounded::when(core_math::exp(x), x == 0.0 || x.is_infinite()))
        .within(0.0, f64::INFINITY)
}

/// Natural logarithm of the positive members of `a`.
pub(super) fn ln(a: Span) -> Span {
    logarithm(a, |x| Rounded::when(core_math::log(x), x == 1.0))
}

/// Binary logarithm of the positive members of `a`.
pub(super) fn log2(a: Span) -> Span {
    logarithm(a, |x| {
        let (exponent, fraction) = (x.to_bits() >> 52, x.to_bits() & ((1 << 52) - 1));
        let is_power = if exponent == 0 { fraction.is_power_of_two() } else { fraction == 0 };
        Rounded::when(core_math::log2(x), is_power)
    })
}

/// Decimal logarithm of the positive members of `a`.
pub(super) fn log10(a: Span) -> Span {
    logarithm(a, |x| {
        // No other power of ten is an `f64`. The products up to 10²² are exact.
        let is_power = (0..=22).scan(1.0, |power, _| {
            let this = *power;
            *power *= 10.0;
            Some(this)
        });
        Rounded::when(core_math::log10(x), is_power.into_iter().any(|p| p == x))
    })
}

fn logarithm(a: Span, f: impl Fn(f64) -> Rounded) -> Span {
    a.within(0.0, f64::INFINITY).increasing(|x| match x {
        0.0 => Rounded::exact(f64::NEG_INFINITY),
        f64::INFINITY => Rounded::exact(x),
        _ => f(x),
    })
}

pub(super) fn sin(a: Span) -> Span {
    wave(a, core_math::sin, core_math::cos, 0.0)
}

pub(super) fn cos(a: Span) -> Span {
    wave(a, core_math::cos, |x| -core_math::sin(x), 1.0)
}

/// Range of `f`, a sine or cosine, over `a`. `slope` has its derivative's sign; `at_zero` is f(0).
fn wave(a: Span, f: fn(f64) -> f64, slope: fn(f64) -> f64, at_zero: f64) -> Span {
    if !is_narrow(a) {
        return Span::new(-1.0, 1.0);
    }
    let value = |x: f64| match x {
        0.0 => Rounded::exact(at_zero),
        _ => Rounded::inexact(f(x)),
    };
    let mut range = Span::hull(value(a.lo), value(a.hi));
    // The slope has at most one zero in this range, so a change of its sign means one extremum. The
    // computed slope is rounded correctly, so it has the right sign. If it is 0 at an end, that end
    // is the extremum.
    let (before, after) = (slope(a.lo), slope(a.hi));
    if before > 0.0 && after < 0.0 {
        range.hi = 1.0;
    }
    if before < 0.0 && after > 0.0 {
        range.lo = -1.0;
    }
    range.within(-1.0, 1.0)
}

pub(super) fn erf(a: Span) -> Span {
    a.increasing(|x| Rounded::when(core_math::erf(x), x == 0.0)).within(-1.0, 1.0)
}

/// Bessel functions of the first kind. No correctly rounded ones are at hand. Those of `libm` are
/// wrong by a few units in the last place of 1; more is allowed here.
pub(super) fn bessel(order: i32, a: Span) -> Span {
    const ERROR: f64 = 16.0 * f64::EPSILON;
    const LARGEST: f64 = 1e6;
    if a.lo == 0.0 && a.hi == 0.0 {
        return Span::point(if order == 0 { 1.0 } else { 0.0 });
    }
    if !(a.lo >= -LARGEST && a.hi <= LARGEST) {
        return Span::new(-1.0, 1.0);
    }
    // The slope is at most 1.
    let middle = libm::jn(order, f64::midpoint(a.lo, a.hi));
    let reach = (a.hi - a.lo) / 2.0 + ERROR * (1.0 + a.hi.abs().max(a.lo.abs()));
    Span::new(middle - reach, middle + reach).within(-1.0, 1.0)
}

/// Whether `a` certainly contains no pole of the tangent.
pub(super) fn has_no_pole(a: Span) -> bool {
    is_narrow(a) && (core_math::cos(a.lo) > 0.0) == (core_math::cos(a.hi) > 0.0)
}

/// Tangents of the members of `a`, or all reals if there may be a pole.
pub(super) fn tan(a: Span) -> Span {
    if has_no_pole(a) {
        a.increasing(|x| Rounded::when(core_math::tan(x), x == 0.0))
    } else {
        Span::ENTIRE
    }
}

pub(super) fn atan(a: Span) -> Span {
    a.increasing(|x| Rounded::when(core_math::atan(x), x == 0.0))
}

/// Arc sine of the members of `a` from −1 to 1.
pub(super) fn asin(a: Span) -> Span {
    a.within(-1.0, 1.0).increasing(|x| Rounded::when(core_math::asin(x), x == 0.0))
}

/// Arc cosine of the members of `a` from −1 to 1.
pub(super) fn acos(a: Span) -> Span {
    let a = a.within(-1.0, 1.0);
    let value = |x: f64| Rounded::when(core_math::acos(x), x == 1.0);
    Span::hull(value(a.hi), value(a.lo)).within(0.0, f64::INFINITY)
}

pub(super) fn sinh(a: Span) -> Span {
    a.increasing(|x| Rounded::when(core_math::sinh(x), x == 0.0 || x.is_infinite()))
}

pub(super) fn cosh(a: Span) -> Span {
    let a = a.abs();
    a.increasing(|x| Rounded::when(core_math::cosh(x), x == 0.0 || x.is_infinite()))
        .within(1.0, f64::INFINITY)
}

pub(super) fn tanh(a: Span) -> Span {
    a.increasing(|x| Rounded::when(core_math::tanh(x), x == 0.0)).within(-1.0, 1.0)
}

pub(super) fn asinh(a: Span) -> Span {
    a.increasing(|x| Rounded::when(core_math::asinh(x), x == 0.0 || x.is_infinite()))
}

/// Inverse hyperbolic cosine of the members of `a` that are at least 1.
pub(super) fn acosh(a: Span) -> Span {
    a.within(1.0, f64::INFINITY)
        .increasing(|x| Rounded::when(core_math::acosh(x), x == 1.0 || x.is_infinite()))
}

/// Inverse hyperbolic tangent of the members of `a` between −1 and 1.
pub(super) fn atanh(a: Span) -> Span {
    // The infinite results at ±1 are exact.
    a.within(-1.0, 1.0)
        .increasing(|x| Rounded::when(core_math::atanh(x), x == 0.0 || x.abs() == 1.0))
}

/// Angles of the points (x, y). Returns every angle if the rectangle of points contains the origin,
/// or has points both on the branch cut and below it.
pub(super) fn atan2(y: Span, x: Span) -> Span {
    let everything = Span::new(-core::f64::consts::PI.next_up(), core::f64::consts::PI.next_up());
    if x.has_zero() && y.has_zero() || x.lo < 0.0 && y.lo < 0.0 && y.hi >= 0.0 {
        return everything;
    }
    // No corner is the origin, and the angle is monotonic on each edge: extremes are at corners.
    let value = |y: f64, x: f64| {
        let (y, x) = (y + 0.0, x + 0.0);
        Rounded::when(core_math::atan2(y, x), y == 0.0 && x > 0.0)
    };
    Span::of(&y.corners(x, value)).within(everything.lo, everything.hi)
}

fn is_narrow(a: Span) -> bool {
    a.hi - a.lo < LESS_THAN_HALF_PERIOD
}
