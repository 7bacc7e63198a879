//! Constants: the real numbers that were typed, exact where possible.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::hash::{Hash, Hasher};
use zeroset_interval::{Decorated, Exponent, Facts, Interval};

/// Largest number of bits of an exact numerator or denominator. Larger results become enclosures.
pub(crate) const EXACT_BITS: u64 = 512;
/// Largest decimal exponent, up or down, of an exact decimal. Decimals beyond it are far outside
/// the range of floats, and become enclosures.
const EXPONENT_LIMIT: i64 = 2000;
/// Largest number of digits of a decimal that are evaluated; more would cost quadratic time.
/// Further digits move the ends of an `f64` enclosure by at most their last place. The enclosure is
/// widened to cover them.
const KEPT_DIGITS: usize = 1200;

/// A real constant. Rational numbers of moderate size and named numbers are exact. Two floats
/// enclose any other number.
#[derive(Clone, Debug, Eq)]
pub enum Constant {
    /// A rational number.
    Exact(BigRational),
    /// An irrational number with a name.
    Named(NamedConstant),
    /// A real number known only by its bounds: the bits of an [`Interval`], so that they can be
    /// compared and hashed. Two constants with the same bounds need not be the same number.
    Enclosed([u64; 2]),
}

/// Gives the same result as a derived `PartialEq`. Fractions are always reduced, so they are
/// compared by their parts. The equality and the hash of `BigRational` divide, which took half the
/// time of simplifying.
impl PartialEq for Constant {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Exact(a), Self::Exact(b)) => a.numer() == b.numer() && a.denom() == b.denom(),
            (Self::Named(a), Self::Named(b)) => a == b,
            (Self::Enclosed(a), Self::Enclosed(b)) => a == b,
            (Self::Exact(_) | Self::Named(_) | Self::Enclosed(_), _) => false,
        }
    }
}

impl Hash for Constant {
    fn hash<H: Hasher>(&self, state: &mut H) {
        std::mem::discriminant(self).hash(state);
        match self {
            Self::Exact(value) => {
                value.numer().hash(state);
                value.denom().hash(state);
            }
            Self::Named(name) => name.hash(state),
            Self::Enclosed(bounds) => bounds.hash(state),
        }
    }
}

/// An irrational number with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NamedConstant {
    /// The circle constant π.
    Pi,
    /// The circle constant τ = 2π.
    Tau,
    /// Euler's number e.
    E,
    /// The golden ratio φ = (1 + √5)/2.
    Phi,
}

impl NamedConstant {
    /// All named constants.
    pub const ALL: [Self; 4] = [Self::Pi, Self::Tau, Self::E, Self::Phi];

    /// The constant's name in formulas.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pi => "pi",
            Self::Tau => "tau",
            Self::E => "e",
            Self::Phi => "phi",
        }
    }

    /// The two neighboring floats that enclose the constant.
    fn bounds(self) -> Interval {
        // The doubles nearest to π, τ and e are below these numbers (OEIS A000796, A001113). The
        // double nearest to φ is 1.6180339887498949025…, above φ =
        // 1.618033988749894848204586834365638117720309… (A001622).
        let lo = match self {
            Self::Pi => std::f64::consts::PI,
            Self::Tau => std::f64::consts::TAU,
            Self::E => std::f64::consts::E,
            Self::Phi => 1.618_033_988_749_895_f64.next_down(),
        };
        Interval { lo, hi: lo.next_up() }
    }
}

impl Constant {
    /// The integer `value`.
    pub fn integer(value: i64) -> Self {
        Self::Exact(BigRational::from_integer(value.into()))
    }

    /// The quotient `numerator / denominator`, or `None` if the denominator is 0.
    pub fn ratio(numerator: i64, denominator: i64) -> Option<Self> {
        (denominator != 0)
            .then(|| Self::Exact(BigRational::new(numerator.into(), denominator.into())))
    }

    /// The rational number `value`. The constant is an enclosure if the number is too large to be
    /// exact.
    pub fn rational(value: BigRational) -> Self {
        if bits(&value) <= EXACT_BITS {
            Self::Exact(value)
        } else {
            Self::enclosed(enclose(&value))
        }
    }

    /// A number known only to be within `bounds`. The constant is exact if `bounds` contains only
    /// one number, of moderate size.
    pub fn enclosed(bounds: Interval) -> Self {
        match bounds.singleton().and_then(BigRational::from_float) {
            Some(value) if bits(&value) <= EXACT_BITS => Self::Exact(value),
            Some(_) | None => Self::Enclosed([bounds.lo.to_bits(), bounds.hi.to_bits()]),
        }
    }

    /// The value of a decimal like `12`, `.5`, `1.` or `2.5e-3`. The constant is an enclosure if
    /// the decimal is too large, too small or too long. `None` if `text` is not a decimal.
    pub fn decimal(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, Some(exponent)),
            None => (text, None),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits = format!("{whole}{fraction}");
        if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
            return None;
        }
        let exponent = match exponent {
            None => 0,
            Some(text) => {
                let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
                if unsigned.is_empty() || !unsigned.bytes().all(|b| b.is_ascii_digit()) {
                    return None;
                }
                // All characters are digits, so parsing fails only if the exponent does not fit
                // `i64`.
                let saturated = if text.starts_with('-') { i64::MIN / 2 } else { i64::MAX / 2 };
                text.parse().unwrap_or(saturated)
            }
        };
        let significant = digits.trim_start_matches('0');
        if significant.is_empty() {
            return Some(Self::integer(0));
        }
        let scale = exponent - fraction.len() as i64;
        // The decimal is in [10^(magnitude − 1), 10^magnitude).
        let magnitude = scale + significant.len() as i64;
        if magnitude > EXPONENT_LIMIT {
            return Some(Self::enclosed(Interval { lo: f64::MAX, hi: f64::INFINITY }));
        }
        if magnitude < -EXPONENT_LIMIT {
            return Some(Self::enclosed(Interval { lo: 0.0, hi: f64::from_bits(1) }));
        }
        let kept = significant.len().min(KEPT_DIGITS);
        let power = |n: i64| num_traits::pow(BigInt::from(10), n.unsigned_abs() as usize);
        let value = |numerator: BigInt, scale: i64| {
            if scale >= 0 {
                BigRational::from_integer(numerator * power(scale))
            } else {
                BigRational::new(numerator, power(scale))
            }
        };
        let numerator: BigInt = significant[..kept].parse().ok()?;
        let scale = scale + (significant.len() - kept) as i64;
        if kept < significant.len() {
            let low = enclose(&value(numerator.clone(), scale));
            let high = enclose(&value(numerator + 1, scale));
            return Some(Self::enclosed(low.hull(high)));
        }
        Some(Self::rational(value(numerator, scale)))
    }

    /// The tightest `f64` bounds of the number.
    pub fn bounds(&self) -> Interval {
        match self {
            Self::Exact(value) => enclose(value),
            Self::Named(name) => name.bounds(),
            Self::Enclosed([lo, hi]) => {
                Interval { lo: f64::from_bits(*lo), hi: f64::from_bits(*hi) }
            }
        }
    }

    /// The rational number, or `None` if the constant is irrational or enclosed.
    pub fn exact(&self) -> Option<&BigRational> {
        match self {
            Self::Exact(value) => Some(value),
            Self::Named(_) | Self::Enclosed(_) => None,
        }
    }

    /// The number as an `i64`, or `None` if it is no integer or does not fit.
    pub fn as_integer(&self) -> Option<i64> {
        self.exact().filter(|value| value.is_integer()).and_then(|value| value.numer().to_i64())
    }

    /// The number's kind as an exponent: a small integer, a large integer or a real number.
    pub fn exponent(&self) -> Exponent {
        match self.exact() {
            Some(value) if value.is_integer() => {
                let odd = value.numer().bit(0);
                value.numer().to_i32().map_or(Exponent::LargeInteger { odd }, Exponent::Integer)
            }
            Some(_) | None => Exponent::Real,
        }
    }

    /// The number's bounds, its facts and its kind as an exponent.
    pub fn value(&self) -> Decorated {
        Decorated { bounds: self.bounds(), facts: Facts::TOTAL, exponent: self.exponent() }
    }

    /// Returns whether the number is exactly 0.
    pub fn is_zero(&self) -> bool {
        self.exact().is_some_and(Zero::is_zero)
    }

    /// Returns whether the number is exactly 1.
    pub fn is_one(&self) -> bool {
        self.exact().is_some_and(One::is_one)
    }
}

/// The larger of the numbers of bits of the numerator and the denominator.
pub(crate) fn bits(value: &BigRational) -> u64 {
    value.numer().bits().max(value.denom().bits())
}

/// The tightest `f64` interval around a rational number.
fn enclose(value: &BigRational) -> Interval {
    match (small(value.numer()), small(value.denom())) {
        (Some(numerator), Some(denominator)) => enclose_quotient(numerator, denominator),
        _ => enclose_large(value),
    }
}

/// `value` as a float, if it has at most 53 bits and so is a float exactly.
fn small(value: &BigInt) -> Option<f64> {
    let is_small = value.bits() <= u64::from(f64::MANTISSA_DIGITS);
    value.to_i64().filter(|_| is_small).map(|value| value as f64)
}

/// The tightest `f64` interval around a quotient of integers of at most 53 bits, for a
/// `denominator` above 0.
fn enclose_quotient(numerator: f64, denominator: f64) -> Interval {
    let near = numerator / denominator;
    // `rest` is exact: the remainder of a division rounded to nearest is a float unless something
    // underflows. Nothing does, since quotients are within 2^±53.
    let rest = near.mul_add(-denominator, numerator);
    Interval {
        lo: if rest < 0.0 { near.next_down() } else { near },
        hi: if rest > 0.0 { near.next_up() } else { near },
    }
}

/// The tightest `f64` interval around any rational number.
fn enclose_large(value: &BigRational) -> Interval {
    if value.is_negative() {
        let positive = enclose_large(&-value);
        return Interval { lo: -positive.hi, hi: -positive.lo };
    }
    // The guess may be too large or too small, which the exact comparisons below correct.
    let mut lo = value.to_f64().filter(|guess| !guess.is_nan()).unwrap_or(f64::MAX).min(f64::MAX);
    let exact = |x: f64| BigRational::from_float(x).unwrap_or_else(BigRational::zero);
    while exact(lo) > *value {
        lo = lo.next_down();
    }
    while lo < f64::MAX && exact(lo.next_up()) <= *value {
        lo = lo.next_up();
    }
    let hi = if exact(lo) == *value { lo } else { lo.next_up() };
    Interval { lo, hi }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(text: &str) -> (f64, f64) {
        let bounds = Constant::decimal(text).expect("a decimal").bounds();
        (bounds.lo, bounds.hi)
    }

    #[test]
    fn decimals_are_enclosed_tightly() {
        assert_eq!(bounds("0.5"), (0.5, 0.5));
        assert_eq!(bounds("1."), (1.0, 1.0));
        assert_eq!(bounds("1e8"), (1e8, 1e8));
        // The double nearest to 0.1 is above one tenth.
        assert_eq!(bounds("0.1"), (0.1_f64.next_down(), 0.1));
        assert_eq!(bounds("1e400"), (f64::MAX, f64::INFINITY));
        assert_eq!(bounds("1e99999999999999999999"), (f64::MAX, f64::INFINITY));
        assert_eq!(bounds("1e-400"), (0.0, f64::from_bits(1)));
        assert_eq!(bounds("1e-99999999999999999999"), (0.0, f64::from_bits(1)));
        let long = format!("0.{}", "1".repeat(100_000));
        let (lo, hi) = bounds(&long);
        assert!(lo <= 1.0 / 9.0 && 1.0 / 9.0 <= hi && hi <= lo.next_up().next_up());
    }

    #[test]
    fn quotients_of_small_integers_are_enclosed_as_large_ones_are() {
        let most = (1_i64 << 53) - 1;
        let numbers = [1, 2, 3, 7, 10, 1000, 1001, 65_537, most / 3, most - 1, most];
        for numerator in numbers.into_iter().flat_map(|n| [n, -n]).chain([0]) {
            for denominator in numbers {
                let value = BigRational::new(numerator.into(), denominator.into());
                let [found, expected] = [enclose(&value), enclose_large(&value)];
                assert_eq!(found, expected, "{value}");
                assert_eq!(found.lo.is_sign_negative(), numerator < 0, "{value}");
            }
        }
    }

    #[test]
    fn text_that_is_no_decimal_is_refused() {
        for text in ["", ".", "e5", "1e", "1e+", "-1", "1_000", "0x10", "1.2.3"] {
            assert_eq!(Constant::decimal(text), None, "{text}");
        }
    }

    #[test]
    fn known_constants_lie_inside_their_bounds() {
        // Published digits are read as integers, so the test does not rely on how floats are
        // parsed.
        let digits =
            |text: &str| Constant::decimal(text).and_then(|c| c.exact().cloned()).expect("exact");
        for (constant, text) in [
            (
                Constant::Named(NamedConstant::Pi),
                "3.14159265358979323846264338327950288419716939937510",
            ),
            (
                Constant::Named(NamedConstant::Tau),
                "6.28318530717958647692528676655900576839433879875021",
            ),
            (
                Constant::Named(NamedConstant::E),
                "2.71828182845904523536028747135266249775724709369995",
            ),
            (
                Constant::Named(NamedConstant::Phi),
                "1.61803398874989484820458683436563811772030917980576",
            ),
        ] {
            let bounds = constant.bounds();
            let exact = |x: f64| BigRational::from_float(x).expect("finite");
            let value = digits(text);
            assert!(exact(bounds.lo) < value && value < exact(bounds.hi), "{text}");
            assert_eq!(bounds.lo.next_up(), bounds.hi, "{text}");
        }
    }
}
