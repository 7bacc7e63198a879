//! Powers. Their domain of definition depends on what kind of expression the exponent is.

use super::rounded::{self, Rounded};
use super::span::Span;
use super::{Claim, Defined, around};
use num_integer::Integer;
use num_traits::Signed;
use zeroset_ir::Constant;

/// Kind of an exponent, as far as the graph alone determines it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Exponent {
    /// An integer constant. If it is negative, the base must not be 0; otherwise any base is
    /// allowed.
    Integer {
        /// Bounds of the integer, which may be too large for a float to represent exactly.
        value: Span,
        /// Whether the integer is odd.
        odd: bool,
        /// Whether the integer is below 0.
        negative: bool,
    },
    /// A constant that is not an integer.
    Fraction,
    /// An expression without coordinates and parameters. Constant folding may turn it into an
    /// integer constant or not, so claims allow for both cases.
    PerhapsInteger,
    /// An expression that depends on coordinates or parameters.
    Varying,
}

impl Exponent {
    pub(super) fn of(value: &Constant) -> Self {
        match value.exact() {
            Some(value) if value.is_integer() => Self::Integer {
                value: around(value.numer()),
                odd: value.numer().is_odd(),
                negative: value.is_negative(),
            },
            Some(_) => Self::Fraction,
            None => Self::PerhapsInteger,
        }
    }
}

/// Bounds of `base` to the power `power`, and whether the power is defined. The kind of the
/// exponent decides which bases are allowed.
pub(super) fn pow(base: Claim, power: Claim, exponent: Exponent) -> (Span, Defined) {
    let (a, b) = (base.span(), power.span());
    match exponent {
        Exponent::Integer { value, odd, negative } => {
            let defined = Defined::decide(!negative || !a.has_zero(), !negative || !a.is_zero());
            (integer_power(a, value, odd), defined)
        }
        Exponent::Fraction | Exponent::Varying => real_power(a, b),
        Exponent::PerhapsInteger => {
            let (value, defined) = real_power(a, b);
            let holds_integer = b.lo.ceil() <= b.hi;
            let pole = a.is_zero() && b.hi < 0.0;
            if defined == Defined::Yes || !holds_integer || pole {
                return (value, defined);
            }
            let magnitude = magnitudes(a.abs(), b);
            (magnitude.union(magnitude.neg()), Defined::Unknown)
        }
    }
}

/// Powers of the members of `a` with an integer exponent. Leaves out 0⁻ⁿ, which has no value.
fn integer_power(a: Span, n: Span, odd: bool) -> Span {
    if !odd || a.lo >= 0.0 {
        return magnitudes(a.abs(), n);
    }
    let negative = magnitudes(Span::new(-a.hi.min(0.0), -a.lo), n).neg();
    if a.hi <= 0.0 { negative } else { negative.union(magnitudes(Span::new(0.0, a.hi), n)) }
}

/// Powers with a real exponent. The base is positive, or 0 if the exponent is positive.
fn real_power(a: Span, b: Span) -> (Span, Defined) {
    let defined = Defined::decide(
        a.lo > 0.0 || (a.lo >= 0.0 && b.lo > 0.0),
        a.hi > 0.0 || (a.hi >= 0.0 && b.hi > 0.0),
    );
    (magnitudes(a.within(0.0, f64::INFINITY), b), defined)
}

/// Powers xʸ for x ≥ 0. They are monotonic in x and in y, so extremes are at corners. The limits at
/// 0 and ∞ are those of `pow` in IEEE 754.
fn magnitudes(x: Span, y: Span) -> Span {
    Span::of(&x.corners(y, corner)).within(0.0, f64::INFINITY)
}

/// xʸ for x ≥ 0. Both numbers may be infinite.
fn corner(x: f64, y: f64) -> Rounded {
    if x == 0.0 || x == 1.0 || y == 0.0 || x.is_infinite() || y.is_infinite() {
        return Rounded::exact(core_math::pow(x.abs(), y));
    }
    exact_power(x, y).map_or_else(|| Rounded::inexact(core_math::pow(x, y)), Rounded::exact)
}

/// xʸ by multiplication, if y is a small integer and no step rounds.
fn exact_power(x: f64, y: f64) -> Option<f64> {
    // With more factors, only powers of two have exact products, which soon overflow.
    const MOST_FACTORS: f64 = 64.0;
    if y.fract() != 0.0 || y.abs() > MOST_FACTORS {
        return None;
    }
    let mut product = 1.0;
    for _ in 0..y.abs() as u32 {
        product = rounded::mul(product, x).known()?;
    }
    if y < 0.0 { rounded::div(1.0, product).known() } else { Some(product) }
}
