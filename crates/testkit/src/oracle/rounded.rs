//! Single operations of `f64`, with a flag that tells whether the result is exact.

/// Products and quotients below this magnitude are not called exact: a remainder might underflow. A
/// remainder is smaller than its result by at most 2 · 53 bits. So above this magnitude, it stays
/// above the smallest subnormal, 2⁻¹⁰⁷⁴.
const REMAINDER_IS_SAFE: f64 = f64::from_bits((1023 - 900) << 52); // 2^-900

/// A result rounded to nearest. Infinite if it overflowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounded {
    value: f64,
    exact: bool,
}

impl Rounded {
    pub(super) fn exact(value: f64) -> Self {
        Self { value, exact: true }
    }

    pub(super) fn inexact(value: f64) -> Self {
        Self { value, exact: false }
    }

    /// A result with this `value`, exact or not. An overflow must not be passed as exact.
    pub(super) fn when(value: f64, exact: bool) -> Self {
        Self { value, exact }
    }

    /// Returns a float at or below the exact result.
    pub(super) fn down(self) -> f64 {
        match self.value {
            v if v.is_nan() => f64::NEG_INFINITY,
            v if self.exact => v,
            v => v.next_down(),
        }
    }

    /// Returns a float at or above the exact result.
    pub(super) fn up(self) -> f64 {
        match self.value {
            v if v.is_nan() => f64::INFINITY,
            v if self.exact => v,
            v => v.next_up(),
        }
    }

    /// Returns the result if it is finite and known to be exact.
    pub(super) fn known(self) -> Option<f64> {
        (self.exact && self.value.is_finite()).then_some(self.value)
    }
}

/// a + b. Source: Knuth's `TwoSum`, whose error term is exact unless something overflows.
pub(super) fn add(a: f64, b: f64) -> Rounded {
    let sum = a + b;
    let b_part = sum - a;
    let error = (a - (sum - b_part)) + (b - b_part);
    // An infinite operand is the end of an unbounded range, and sums with it are exact.
    Rounded::when(sum, error == 0.0 || a.is_infinite() || b.is_infinite())
}

/// a·b, where 0 times an infinite end is 0.
pub(super) fn mul(a: f64, b: f64) -> Rounded {
    if a == 0.0 || b == 0.0 {
        return Rounded::exact(0.0);
    }
    if a.is_infinite() || b.is_infinite() {
        return Rounded::exact(a * b);
    }
    let product = a * b;
    let safe = product.is_finite() && product.abs() >= REMAINDER_IS_SAFE;
    Rounded::when(product, safe && a.mul_add(b, -product) == 0.0)
}

/// a/b. By convention the quotient is 0 for an infinite b, infinite for b = ±0, and 0 for 0/0.
/// Quotients of ranges need this if the divisor has an end at 0 or infinity.
pub(super) fn div(a: f64, b: f64) -> Rounded {
    if a == 0.0 || b.is_infinite() {
        return Rounded::exact(0.0);
    }
    if a.is_infinite() || b == 0.0 {
        return Rounded::exact(a / b);
    }
    let quotient = a / b;
    let safe =
        quotient.is_finite() && quotient.abs() >= f64::MIN_POSITIVE && a.abs() >= REMAINDER_IS_SAFE;
    Rounded::when(quotient, safe && (-quotient).mul_add(b, a) == 0.0)
}

/// n·b + a with one rounding, for integers n.
pub(super) fn mul_add(n: f64, b: f64, a: f64) -> Rounded {
    if n == 0.0 || b == 0.0 {
        return Rounded::exact(a);
    }
    let product = mul(n, b);
    match product.known() {
        Some(product) => add(product, a),
        None => Rounded::inexact(n.mul_add(b, a)),
    }
}

/// √a for a ≥ 0.
pub(super) fn sqrt(a: f64) -> Rounded {
    let root = a.sqrt();
    let exact =
        a == 0.0 || a.is_infinite() || (a >= REMAINDER_IS_SAFE && (-root).mul_add(root, a) == 0.0);
    Rounded::when(root, exact)
}

/// The cube root of a.
pub(super) fn cbrt(a: f64) -> Rounded {
    let root = core_math::cbrt(a);
    let cube = mul(root, root).known().and_then(|s| mul(s, root).known());
    Rounded::when(root, a == 0.0 || a.is_infinite() || cube == Some(a))
}
