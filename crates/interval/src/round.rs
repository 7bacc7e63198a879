//! Arithmetic rounded up, in software: the results of a kernel's lane under rounding mode +∞.
//!
//! The functions neither read nor set the processor's rounding mode. Each computes the result
//! rounded to nearest and corrects it by the sign of its exact error. NaN and infinities behave as
//! in IEEE 754.

/// `f32` results rounded up, by computing in `f64`. Products and remainders of two `f32` are exact
/// in `f64`; the errors of sums are computed too.
pub mod f32_up {
    /// Returns `value + error`, rounded up to `f32`. `error` is at most half an ulp of `value` in
    /// size, or NaN if `value` is not finite. A value below every `f32` gives the lowest finite
    /// `f32`.
    #[inline]
    fn demote(value: f64, error: f64) -> f32 {
        let nearest = value as f32;
        let back = f64::from(nearest);
        let below = back < value || (back == value && error > 0.0);
        if below { nearest.next_up() } else { nearest }
    }

    /// Returns `value` rounded up to `f32`.
    #[inline]
    pub fn from_f64(value: f64) -> f32 {
        demote(value, 0.0)
    }

    /// Returns `a + b`.
    pub fn add(a: f32, b: f32) -> f32 {
        let (a, b) = (f64::from(a), f64::from(b));
        let sum = a + b;
        demote(sum, super::sum_error(a, b, sum))
    }

    /// Returns `a − b`.
    pub fn sub(a: f32, b: f32) -> f32 {
        add(a, -b)
    }

    /// Returns `a · b`. The product of two 24-bit significands is exact in `f64`.
    pub fn mul(a: f32, b: f32) -> f32 {
        demote(f64::from(a) * f64::from(b), 0.0)
    }

    /// Returns `a · b + c`, rounded once.
    pub fn mul_add(a: f32, b: f32, c: f32) -> f32 {
        let (product, c) = (f64::from(a) * f64::from(b), f64::from(c));
        let sum = product + c;
        demote(sum, super::sum_error(product, c, sum))
    }

    /// Returns `a / b`.
    pub fn div(a: f32, b: f32) -> f32 {
        let (a, b) = (f64::from(a), f64::from(b));
        let quotient = a / b;
        // The remainder a − q·b of the quotient q is a float, so `mul_add` computes it exactly.
        let remainder = (-quotient).mul_add(b, a);
        demote(quotient, if b > 0.0 { remainder } else { -remainder })
    }

    /// Returns √a, or NaN for a < 0.
    pub fn sqrt(a: f32) -> f32 {
        let a = f64::from(a);
        let root = a.sqrt();
        demote(root, (-root).mul_add(root, a))
    }
}

/// `f64` results rounded up.
pub mod f64_up {
    /// Exponents by which a product, quotient or root can be scaled exactly.
    const EXACT_ERROR_EXPONENTS: std::ops::RangeInclusive<i32> = -400..=400;

    /// Returns `a + b`.
    pub fn add(a: f64, b: f64) -> f64 {
        let sum = a + b;
        if sum.is_finite() {
            return if super::sum_error(a, b, sum) > 0.0 { sum.next_up() } else { sum };
        }
        // The sum of finite numbers is a finite number, so rounding it up cannot give −∞.
        if a.is_finite() && b.is_finite() { sum.max(-f64::MAX) } else { sum }
    }

    /// Returns `a − b`.
    pub fn sub(a: f64, b: f64) -> f64 {
        add(a, -b)
    }

    /// Returns `a · b`.
    pub fn mul(a: f64, b: f64) -> f64 {
        let special = !a.is_finite() || !b.is_finite() || a == 0.0 || b == 0.0;
        if special {
            return a * b;
        }
        let ((a, i), (b, j)) = (split(a), split(b));
        let product = a * b;
        scale(product, a.mul_add(b, -product), i + j)
    }

    /// Returns `a · b + c`, rounded once.
    pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
        if c.is_infinite() && a.is_finite() && b.is_finite() {
            return c; // a·b alone may overflow
        }
        if !(a.is_finite() && b.is_finite() && c.is_finite()) || a == 0.0 || b == 0.0 {
            return add(a * b, c);
        }
        if c == 0.0 {
            return mul(a, b);
        }
        // The product becomes an integer of 105 or 106 bits, c one of 53 bits, each with an
        // exponent.
        let integer = |a: f64| {
            let (a, exponent) = split(a);
            ((a * power(52)) as i128, exponent - 52)
        };
        let ((a, i), (b, j), (c, k)) = (integer(a), integer(b), integer(c));
        let (product, places) = (a * b, k - (i + j));
        match places {
            // Bits of c below the product's last place only show that the result is inexact.
            ..0 => {
                let below = places.unsigned_abs().min(64);
                round_up(product + (c >> below), c % (1 << below) != 0, i + j)
            }
            0..=73 => round_up(product + (c << places), false, i + j),
            _ => {
                let below = (places - 60).min(127);
                round_up((c << 60) + (product >> below), product % (1 << below) != 0, k - 60)
            }
        }
    }

    /// Returns (`integer` + δ) · 2^`exponent` rounded up, where 0 < δ < 1 if `more`, else δ = 0. If
    /// `more`, `integer` must have more than 54 bits.
    fn round_up(integer: i128, more: bool, exponent: i32) -> f64 {
        // If the number is negative, rounding up and δ both reduce its magnitude.
        let down = integer < 0;
        let size = integer.unsigned_abs() - u128::from(down && more);
        let bits = 128 - size.leading_zeros() as i32;
        // Number of bits below the result's last place, which is at least 2^−1074.
        let cut = (bits - 53).max(-1074 - exponent).max(0);
        let (kept, rest) = if cut < 128 { (size >> cut, size % (1 << cut)) } else { (0, size) };
        let up = !down && (more || rest != 0);
        let value = (kept + u128::from(up)) as f64;
        let last = exponent + cut;
        let value = value * power(last / 2) * power(last - last / 2);
        match (down, value.is_finite()) {
            (false, _) => value,
            (true, true) => -value,
            (true, false) => -f64::MAX,
        }
    }

    /// Returns `a / b`.
    pub fn div(a: f64, b: f64) -> f64 {
        let special = !a.is_finite() || !b.is_finite() || a == 0.0 || b == 0.0;
        if special {
            return a / b;
        }
        let ((a, i), (b, j)) = (split(a), split(b));
        let quotient = a / b;
        let remainder = (-quotient).mul_add(b, a);
        scale(quotient, if b > 0.0 { remainder } else { -remainder }, i - j)
    }

    /// Returns √a, or NaN for a < 0.
    pub fn sqrt(a: f64) -> f64 {
        if a.is_nan() || a <= 0.0 || a == f64::INFINITY {
            return a.sqrt();
        }
        let (a, i) = split(a);
        let (a, i) = if i % 2 == 0 { (a, i) } else { (2.0 * a, i - 1) };
        let root = a.sqrt();
        scale(root, (-root).mul_add(root, a), i / 2)
    }

    /// Returns m and e with `a = m · 2^e` exactly and 1 ≤ |m| < 2. `a` must be finite and not 0.
    fn split(a: f64) -> (f64, i32) {
        let exponent = |a: f64| ((a.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        let unit = |a: f64| f64::from_bits((a.to_bits() & !(0x7ff << 52)) | (1023 << 52));
        if exponent(a) == -1023 {
            let scaled = a * power(64); // subnormal
            (unit(scaled), exponent(scaled) - 64)
        } else {
            (unit(a), exponent(a))
        }
    }

    /// Returns 2^n, which must be a normal float.
    fn power(n: i32) -> f64 {
        f64::from_bits(((n + 1023) as u64) << 52)
    }

    /// Returns `(value + error) · 2^n` rounded up, for 1/4 < |value| < 4 and |error| at most half
    /// an ulp. Only the sign of `error` is used.
    fn scale(value: f64, error: f64, n: i32) -> f64 {
        if EXACT_ERROR_EXPONENTS.contains(&n) {
            let nearest = value * power(n); // exact: no underflow
            return if error > 0.0 { nearest.next_up() } else { nearest };
        }
        // Of the two multiplications, only the second may round. Undoing both shows in which
        // direction.
        let clamped = n.clamp(-1200, 1200); // for other n the result is 0 or ∞
        let half = clamped / 2;
        let nearest = value * power(half) * power(clamped - half);
        let back = nearest * power(-half) * power(half - clamped);
        let below = back < value || (back == value && error > 0.0);
        if below { nearest.next_up() } else { nearest }
    }
}

/// Returns the exact error of `sum = a + b` rounded to nearest, or 0 if the sum is not finite.
///
/// This is Dekker's fast two-sum. Subtracting the larger operand first is exact and cannot
/// overflow. Knuth's two-sum needs no order, but overflows for sums like −MAX/2 + MAX.
fn sum_error(a: f64, b: f64, sum: f64) -> f64 {
    if !sum.is_finite() {
        return 0.0;
    }
    let (large, small) = if a.abs() >= b.abs() { (a, b) } else { (b, a) };
    small - (sum - large)
}

#[cfg(test)]
mod tests {
    use super::{f32_up, f64_up};

    #[test]
    fn exact_results_stay() {
        assert_eq!(f32_up::add(1.0, 2.0), 3.0);
        assert_eq!(f32_up::mul(3.0, 5.0), 15.0);
        assert_eq!(f32_up::div(1.0, 4.0), 0.25);
        assert_eq!(f32_up::sqrt(9.0), 3.0);
        assert_eq!(f64_up::add(1.0, 2.0), 3.0);
        assert_eq!(f64_up::mul(3.0, 5.0), 15.0);
        assert_eq!(f64_up::div(1.0, 4.0), 0.25);
        assert_eq!(f64_up::sqrt(9.0), 3.0);
    }

    #[test]
    fn inexact_results_go_up() {
        assert_eq!(f32_up::add(1.0, 1e-30), 1.0_f32.next_up());
        assert_eq!(f32_up::add(-1.0, -1e-30), -1.0);
        assert_eq!(f32_up::add(-1.0, 1e-30), (-1.0_f32).next_up());
        assert_eq!(f64_up::add(1.0, 1e-300), 1.0_f64.next_up());
        let third = f64_up::div(1.0, 3.0);
        assert_eq!(third, (1.0_f64 / 3.0).next_up());
        assert_eq!(f64_up::div(-1.0, 3.0), -(1.0_f64 / 3.0));
    }

    #[test]
    fn overflow_and_underflow_round_up() {
        assert_eq!(f32_up::add(f32::MAX, 1.0), f32::INFINITY);
        assert_eq!(f32_up::add(-f32::MAX, -1.0), -f32::MAX);
        assert_eq!(f32_up::mul(-f32::MAX, 2.0), -f32::MAX);
        assert_eq!(f32_up::mul(1e-40, 1e-40), f32::from_bits(1));
        assert_eq!(f32_up::mul(-1e-40, 1e-40), 0.0);
        let near_overflow = [-7.217_819_377_978_075e307, f64::MAX];
        for (a, b) in [(near_overflow[0], near_overflow[1]), (near_overflow[1], near_overflow[0])] {
            let (sum, opposite) = (f64_up::add(a, b), -f64_up::add(-a, -b));
            assert_eq!(sum, opposite.next_up(), "inexact, so its bounds are neighbours");
        }
        assert_eq!(f64_up::mul(-f64::MAX, 2.0), -f64::MAX);
        assert_eq!(f64_up::mul_add(f64::MAX, 2.0, f64::NEG_INFINITY), f64::NEG_INFINITY);
        assert_eq!(f64_up::mul_add(-f64::MAX, 2.0, f64::MAX), -f64::MAX);
        assert_eq!(f64_up::mul_add(-1e-200, 1e-200, 0.0), 0.0);
        assert_eq!(f64_up::mul(1e-200, 1e-200), f64::from_bits(1));
        assert_eq!(f64_up::mul(-1e-200, 1e-200), 0.0);
        assert_eq!(f64_up::div(f64::from_bits(1), 2.0), f64::from_bits(1));
        assert_eq!(f64_up::div(1.0, f64::from_bits(1)), f64::INFINITY);
        assert_eq!(f64_up::sqrt(f64::from_bits(4)), f64_up::sqrt(f64::from_bits(1)) * 2.0);
    }
}
