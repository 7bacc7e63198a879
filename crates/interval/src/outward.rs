//! Intervals of `f64`, rounded outward by one ulp. They serve a few thousand evaluations, for which
//! a kernel is not worth compiling.
//!
//! An operation rounded to nearest errs by less than the distance to the next float. So that float
//! is a bound.

use crate::Interval;

impl Interval {
    /// Bounds from ends that were rounded to nearest. NaN stands for an unknown end.
    fn outward(lo: f64, hi: f64) -> Self {
        let lo = if lo.is_nan() { f64::NEG_INFINITY } else { lo.next_down() };
        let hi = if hi.is_nan() { f64::INFINITY } else { hi.next_up() };
        Self { lo, hi }
    }

    /// Returns whether the interval contains 0.
    pub fn has_zero(self) -> bool {
        !(self.is_negative() || self.is_positive())
    }

    /// Returns whether the whole interval is below 0.
    pub fn is_negative(self) -> bool {
        self.hi < 0.0
    }

    /// Returns whether the whole interval is above 0.
    pub fn is_positive(self) -> bool {
        self.lo > 0.0
    }

    /// Encloses −a.
    #[must_use]
    pub fn negated(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }

    /// Encloses a + b.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        if other == Self::ZERO {
            return self;
        }
        if self == Self::ZERO {
            return other;
        }
        Self::outward(self.lo + other.lo, self.hi + other.hi)
    }

    /// Encloses a·b.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        if other == Self::ONE {
            return self;
        }
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        // The product of 0 and an infinite bound is 0, since values are finite.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let all = [
            product(self.lo, other.lo),
            product(self.lo, other.hi),
            product(self.hi, other.lo),
            product(self.hi, other.hi),
        ];
        let lo = all.into_iter().fold(f64::INFINITY, f64::min);
        let hi = all.into_iter().fold(f64::NEG_INFINITY, f64::max);
        // A bound that is exactly 0 stays 0. Else no square would be known to be at least 0.
        let exact = |bound: f64, moved: f64| {
            if bound == 0.0 && self.is_zero_by(other) { bound } else { moved }
        };
        let wide = Self::outward(lo, hi);
        Self { lo: exact(lo, wide.lo), hi: exact(hi, wide.hi) }
    }

    /// Returns whether a bound 0 of the product comes from a factor that is 0, not from underflow.
    fn is_zero_by(self, other: Self) -> bool {
        let ends = [self.lo, self.hi, other.lo, other.hi];
        ends.contains(&0.0) && ends.into_iter().all(|end| end == 0.0 || end.abs() > LEAST_FACTOR)
    }

    /// Encloses a/b. The result is all reals if b contains 0.
    #[must_use]
    pub fn over(self, other: Self) -> Self {
        if other.has_zero() {
            return Self::ENTIRE;
        }
        let inverse = Self::outward(1.0 / other.hi, 1.0 / other.lo);
        self.times(inverse)
    }

    /// Encloses |a|.
    #[must_use]
    pub fn absolute(self) -> Self {
        if self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            self.negated()
        } else {
            Self { lo: 0.0, hi: self.hi.max(-self.lo) }
        }
    }

    /// Encloses aⁿ.
    #[must_use]
    pub fn power(self, n: u32) -> Self {
        match n {
            0 => Self { lo: 1.0, hi: 1.0 },
            1 => self,
            _ if n.is_multiple_of(2) => {
                let half = self.absolute().power(n / 2);
                let square = half.times(half);
                Self { lo: square.lo.max(0.0), ..square }
            }
            // Odd powers are increasing functions of the base.
            _ => {
                let end = |bound: f64| {
                    let point = Self { lo: bound, hi: bound };
                    point.times(point.power(n - 1))
                };
                // If both ends are equal, one power is enough. Two powers would double the work at
                // each odd exponent of the recursion.
                let lo = end(self.lo);
                let hi = if self.lo == self.hi { lo } else { end(self.hi) };
                Self { lo: lo.lo, hi: hi.hi }
            }
        }
    }

    /// Encloses √a over the part of a that is not negative.
    #[must_use]
    pub fn root(self) -> Self {
        let (lo, hi) = (self.lo.max(0.0).sqrt(), self.hi.max(0.0).sqrt());
        Self { lo: lo.next_down().max(0.0), hi: hi.next_up() }
    }

    /// Encloses the smaller of a and b.
    #[must_use]
    pub fn least(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi) }
    }

    /// Encloses the larger of a and b.
    #[must_use]
    pub fn most(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi) }
    }
}

/// The product of two numbers above this limit does not underflow.
const LEAST_FACTOR: f64 = 1e-150;

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(lo: f64, hi: f64) -> Interval {
        Interval { lo, hi }
    }

    #[test]
    fn results_hold_the_real_ones() {
        let third = bounds(1.0, 1.0).over(bounds(3.0, 3.0));
        assert!(third.lo < third.hi && third.hi - third.lo < 1e-15);
        let one = third.times(bounds(3.0, 3.0));
        assert!(one.lo < 1.0 && 1.0 < one.hi);
        assert_eq!(bounds(-2.0, 1.0).power(2).lo, 0.0);
        assert!(bounds(-2.0, 1.0).power(3).lo <= -8.0);
        // The power takes few products, although many binary digits of its exponent are 1.
        let power = bounds(1.0, 1.0 + f64::EPSILON).power(u32::MAX);
        assert!(power.lo <= 1.0 && 1.0 + 9e-7 < power.hi && power.hi < 1.00001);
        assert_eq!(bounds(0.0, 1.0).times(bounds(2.0, 3.0)).lo, 0.0);
        assert!(bounds(1e-200, 1.0).times(bounds(1e-200, 1.0)).lo <= 0.0);
        assert_eq!(bounds(-1.0, 1.0).over(bounds(0.0, 1.0)), Interval::ENTIRE);
        assert!(bounds(-1.0, 4.0).root().hi >= 2.0);
        let huge = bounds(f64::MAX, f64::MAX);
        assert!(huge.plus(huge).lo >= f64::MAX && huge.times(huge).hi == f64::INFINITY);
        assert_eq!(huge.times(huge).plus(huge.times(huge).negated()), Interval::ENTIRE);
    }
}
