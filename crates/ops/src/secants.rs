//! Quotients that are undefined at one operand only, such as sin(a)/a.
//!
//! Near that operand, an enclosure of the plain quotient is unbounded. So each formula clamps the
//! quotient between two functions that bound it for every operand. Both bounds equal the limit at
//! `b` = 0. Elsewhere they differ by O(b⁴) or O(b⁶). Clamping changes no exact value. The formulas
//! for square and cube root divide by a sum of roots instead.
//!
//! The bounds come from the Taylor series. The comments below give the proofs.

use crate::op::Secant;

const fn secant(at: i32, value: i32, formula: &'static str) -> Secant {
    Secant { at, value, order: 1, formula, limit: [1, 1] }
}

/// 1 − a²/6 ≤ sin(a)/a ≤ 1 − a²/6 + a⁴/120, by repeatedly integrating cos ≤ 1 from 0.
pub(crate) const SIN: Secant =
    secant(0, 0, "min(max(sin(a)/a, 1-sqr(a)/6), 1-sqr(a)/6+sqr(sqr(a))/120)");

/// cos(a) − 1 = −2 sin²(a/2), with the bounds of the sine.
pub(crate) const COS: Secant = Secant {
    order: 2,
    limit: [-1, 2],
    ..secant(0, 1, "-sqr(min(max(2*sin(a/2)/a, 1-sqr(a)/24), 1-sqr(a)/24+sqr(sqr(a))/1920))/2")
};

/// 1 + a²/6 ≤ sinh(a)/a ≤ 1 + a²/6·cosh(a): the coefficient of a²ᵏ⁺² on the right is 1/(6 (2k)!),
/// and that of the quotient is 1/(2k + 3)!, which is no larger.
pub(crate) const SINH: Secant = secant(0, 0, "min(max(sinh(a)/a, 1+sqr(a)/6), 1+sqr(a)/6*cosh(a))");

/// cosh(a) − 1 = 2 sinh²(a/2), with the bounds of the hyperbolic sine.
pub(crate) const COSH: Secant = Secant {
    order: 2,
    limit: [1, 2],
    ..secant(0, 1, "sqr(min(max(2*sinh(a/2)/a, 1+sqr(a)/24), 1+sqr(a)/24*cosh(a/2)))/2")
};

/// exp(a) − 1 = 2 exp(a/2) sinh(a/2), with the bounds of the hyperbolic sine.
pub(crate) const EXP: Secant =
    secant(0, 1, "exp(a/2)*min(max(2*sinh(a/2)/a, 1+sqr(a)/24), 1+sqr(a)/24*cosh(a/2))");

/// With v = b/(2 + b), ln(a) = 2 atanh(v) and b = v·(2 + b). The bounds are those of atanh(v)/v,
/// where v²/(1 − v²) = b²/(4a).
pub(crate) const LN: Secant =
    secant(1, 0, "2/(2+b)*min(max(ln(a)*(2+b)/(2*b), 1+sqr(b/(2+b))/3), 1+sqr(b)/(12*a))");

/// All coefficients of the series are above 0. From a⁴ on, its sum is at most a⁴ times its value at
/// 1, which is π/2 − 7/6 < 5/12.
pub(crate) const ASIN: Secant =
    secant(0, 0, "min(max(asin(a)/a, 1+sqr(a)/6), 1+sqr(a)/6+5*sqr(sqr(a))/12)");

/// By integrating 1 − t² ≤ 1/(1 + t²) ≤ 1 − t² + t⁴ from 0.
pub(crate) const ATAN: Secant =
    secant(0, 0, "min(max(atan(a)/a, 1-sqr(a)/3), 1-sqr(a)/3+sqr(sqr(a))/5)");

/// By integrating 1 − tanh² with tanh(t) ≤ t, and then with t − t³/3 ≤ tanh(t), which holds for all
/// t ≥ 0. The square of that bound may be used where the bound is ≥ 0: up to t = √3.
pub(crate) const TANH: Secant =
    secant(0, 0, "min(max(tanh(a)/a, 1-sqr(a)/3), 1-sqr(a)/3+2*sqr(sqr(a))/15)");

/// By integrating 1 − t²/2 ≤ 1/√(1 + t²) ≤ 1 − t²/2 + 3t⁴/8 from 0.
pub(crate) const ASINH: Secant =
    secant(0, 0, "min(max(asinh(a)/a, 1-sqr(a)/6), 1-sqr(a)/6+3*sqr(sqr(a))/40)");

/// The series of atanh(a)/a is Σ a²ᵏ/(2k + 1), and a²/3·Σ a²ᵏ = a²/(3(1 − a²)).
pub(crate) const ATANH: Secant =
    secant(0, 0, "min(max(atanh(a)/a, 1+sqr(a)/3), 1+sqr(a)/(3*(1-a)*(1+a)))");

/// a − 1 = (√a − 1)(√a + 1).
pub(crate) const SQRT: Secant = Secant { limit: [1, 2], ..secant(1, 1, "1/(sqrt(a)+1)") };

/// a − 1 = (∛a − 1)(∛a² + ∛a + 1), and the last factor is at least 3/4.
pub(crate) const CBRT: Secant =
    Secant { limit: [1, 3], ..secant(1, 1, "1/(sqr(cbrt(a))+cbrt(a)+1)") };

/// Jₙ(a)·n!/(a/2)ⁿ is a mean of cos(at) over t from −1 to 1. So partial sums of the cosine's
/// series, which bound the cosine, also give bounds here.
pub(crate) const BESSEL_J0: Secant = Secant {
    order: 2,
    limit: [-1, 4],
    ..secant(0, 1, "min(max((besselj0(a)-1)/sqr(a), -1/4), sqr(a)/64-1/4)")
};

pub(crate) const BESSEL_J1: Secant = Secant {
    limit: [1, 2],
    ..secant(0, 0, "min(max(besselj1(a)/a, (8-sqr(a))/16), (8-sqr(a))/16+sqr(sqr(a))/384)")
};

pub(crate) const BESSEL_J2: Secant = Secant {
    order: 2,
    limit: [1, 8],
    ..secant(0, 0, "min(max(besselj2(a)/sqr(a), (12-sqr(a))/96), (12-sqr(a))/96+sqr(sqr(a))/3072)")
};

pub(crate) const BESSEL_J3: Secant = Secant {
    order: 3,
    limit: [1, 48],
    ..secant(
        0,
        0,
        "min(max(besselj3(a)/(a*sqr(a)), (16-sqr(a))/768), (16-sqr(a))/768+sqr(sqr(a))/30720)",
    )
};
