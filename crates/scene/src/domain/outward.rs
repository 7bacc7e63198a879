//! Intervals of `f64`, rounded outward by one ulp, for a few thousand evaluations that are not
//! worth compiling a kernel.
//!
//! An operation rounded to nearest is off by less than the distance to the next float, so that
//! float is a bound.

use zeroset_interval::Interval;

/// Bounds of a real number: never NaN, and `low` ≤ `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    low: f64,
    high: f64,
}

impl From<Interval> for Bounds {
    fn from(interval: Interval) -> Self {
        Self { low: interval.lo, high: interval.hi }
    }
}

impl Bounds {
    /// All reals.
    pub const ENTIRE: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// The number 0.
    pub const ZERO: Self = Self { low: 0.0, high: 0.0 };
    /// The number 1.
    pub const ONE: Self = Self { low: 1.0, high: 1.0 };

    /// The reals from `low` to `high`.
    pub fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Bounds from ends that were rounded to nearest; NaN stands for an unknown end.
    fn outward(low: f64, high: f64) -> Self {
        let low = if low.is_nan() { f64::NEG_INFINITY } else { low.next_down() };
        let high = if high.is_nan() { f64::INFINITY } else { high.next_up() };
        Self { low, high }
    }

    /// Returns whether 0 may be among the values.
    pub fn has_zero(self) -> bool {
        !(self.is_negative() || self.is_positive())
    }

    /// Returns whether all values are below 0.
    pub fn is_negative(self) -> bool {
        self.high < 0.0
    }

    /// Returns whether all values are above 0.
    pub fn is_positive(self) -> bool {
        self.low > 0.0
    }

    /// The distance between the ends, rounded to nearest.
    pub fn width(self) -> f64 {
        self.high - self.low
    }

    /// −a
    pub fn negated(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }

    /// a + b
    pub fn plus(self, other: Self) -> Self {
        if other == Self::ZERO {
            return self;
        }
        if self == Self::ZERO {
            return other;
        }
        Self::outward(self.low + other.low, self.high + other.high)
    }

    /// a·b
    pub fn times(self, other: Self) -> Self {
        if other == Self::ONE {
            return self;
        }
        if self == Self::ZERO || other == Self::ZERO {
            return Self::ZERO;
        }
        // 0 times an infinite bound is 0, since values are finite.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let all = [
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ];
        let low = all.into_iter().fold(f64::INFINITY, f64::min);
        let high = all.into_iter().fold(f64::NEG_INFINITY, f64::max);
        // An exact bound 0 is kept. Otherwise no square would be known to be at least 0.
        let exact = |bound: f64, moved: f64| {
            if bound == 0.0 && self.is_zero_by(other) { bound } else { moved }
        };
        let wide = Self::outward(low, high);
        Self { low: exact(low, wide.low), high: exact(high, wide.high) }
    }

    /// Returns whether a bound 0 of the product comes from a factor that is 0, not from underflow.
    fn is_zero_by(self, other: Self) -> bool {
        let ends = [self.low, self.high, other.low, other.high];
        ends.contains(&0.0) && ends.into_iter().all(|end| end == 0.0 || end.abs() > LEAST_FACTOR)
    }

    /// a/b
    pub fn over(self, other: Self) -> Self {
        if other.has_zero() {
            return Self::ENTIRE;
        }
        let inverse = Self::outward(1.0 / other.high, 1.0 / other.low);
        self.times(inverse)
    }

    /// |a|
    pub fn absolute(self) -> Self {
        if self.low >= 0.0 {
            self
        } else if self.high <= 0.0 {
            self.negated()
        } else {
            Self { low: 0.0, high: self.high.max(-self.low) }
        }
    }

    /// aⁿ
    pub fn power(self, n: u32) -> Self {
        match n {
            0 => Self { low: 1.0, high: 1.0 },
            1 => self,
            _ if n.is_multiple_of(2) => {
                let half = self.absolute().power(n / 2);
                let square = half.times(half);
                Self { low: square.low.max(0.0), ..square }
            }
            // Odd powers are increasing.
            _ => {
                let end = |bound: f64| {
                    let point = Self { low: bound, high: bound };
                    point.times(point.power(n - 1))
                };
                // Each end has one chain of products. Otherwise each odd exponent on the way would
                // double the work.
                let low = end(self.low);
                let high = if self.low == self.high { low } else { end(self.high) };
                Self { low: low.low, high: high.high }
            }
        }
    }

    /// √a, where a ≥ 0.
    pub fn root(self) -> Self {
        let (low, high) = (self.low.max(0.0).sqrt(), self.high.max(0.0).sqrt());
        Self { low: low.next_down().max(0.0), high: high.next_up() }
    }

    /// The smaller of both.
    pub fn least(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    /// The larger of both.
    pub fn most(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.max(other.high) }
    }
}

/// Products of two numbers above this do not underflow.
const LEAST_FACTOR: f64 = 1e-150;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_hold_the_real_ones() {
        let third = Bounds::new(1.0, 1.0).over(Bounds::new(3.0, 3.0));
        assert!(third.low < third.high && third.high - third.low < 1e-15);
        let one = third.times(Bounds::new(3.0, 3.0));
        assert!(one.low < 1.0 && 1.0 < one.high);
        assert_eq!(Bounds::new(-2.0, 1.0).power(2).low, 0.0);
        assert!(Bounds::new(-2.0, 1.0).power(3).low <= -8.0);
        // Fast even if many binary digits of the exponent are 1.
        let power = Bounds::new(1.0, 1.0 + f64::EPSILON).power(u32::MAX);
        assert!(power.low <= 1.0 && 1.0 + 9e-7 < power.high && power.high < 1.00001);
        assert_eq!(Bounds::new(0.0, 1.0).times(Bounds::new(2.0, 3.0)).low, 0.0);
        assert!(Bounds::new(1e-200, 1.0).times(Bounds::new(1e-200, 1.0)).low <= 0.0);
        assert_eq!(Bounds::new(-1.0, 1.0).over(Bounds::new(0.0, 1.0)), Bounds::ENTIRE);
        assert!(Bounds::new(-1.0, 4.0).root().high >= 2.0);
        let huge = Bounds::new(f64::MAX, f64::MAX);
        assert!(huge.plus(huge).low >= f64::MAX && huge.times(huge).high == f64::INFINITY);
        assert_eq!(huge.times(huge).plus(huge.times(huge).negated()), Bounds::ENTIRE);
    }
}
