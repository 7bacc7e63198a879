//! A closed interval of reals with `f64` ends.

/// The reals from `lo` to `hi`. Finite ends belong to the interval.
///
/// Invariants: neither end is NaN, `lo ≤ hi`, `lo < +∞`, `hi > −∞`. There is no empty interval: a
/// [fact](crate::Facts) beside the bounds states that an enclosure is empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
}

impl Interval {
    /// All reals.
    pub const ENTIRE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    /// The number 0.
    pub const ZERO: Self = Self { lo: 0.0, hi: 0.0 };
    /// The number 1.
    pub const ONE: Self = Self { lo: 1.0, hi: 1.0 };

    /// Returns the interval from `lo` to `hi`, or `None` if an invariant does not hold.
    pub fn new(lo: f64, hi: f64) -> Option<Self> {
        (lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY).then_some(Self { lo, hi })
    }

    /// Returns the interval that contains only `value`, or `None` if `value` is not finite.
    pub fn point(value: f64) -> Option<Self> {
        Self::new(value, value).filter(|_| value.is_finite())
    }

    /// Returns whether `value` lies in the interval.
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Returns whether every point of `inner` lies in the interval.
    pub fn encloses(self, inner: Self) -> bool {
        self.lo <= inner.lo && inner.hi <= self.hi
    }

    /// Returns whether both ends are finite.
    pub fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// Returns the only number in the interval, or `None` if there are several.
    pub fn singleton(self) -> Option<f64> {
        (self.lo == self.hi).then_some(self.lo)
    }

    /// Returns the smallest interval that encloses both intervals.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Returns the largest absolute value in the interval.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Returns `hi − lo`, rounded to nearest.
    pub fn width(self) -> f64 {
        self.hi - self.lo
    }
}
