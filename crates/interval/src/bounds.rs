//! A closed interval of reals with `f64` ends.

/// The reals from `lo` to `hi`; finite ends are included.
///
/// Invariants: neither end is NaN, `lo ≤ hi`, `lo < +∞`, `hi > −∞`. There is no empty interval:
/// emptiness is a [fact](crate::Facts) that accompanies the bounds.
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

    /// Returns the interval from `lo` to `hi`, or `None` if the invariants do not hold.
    pub fn new(lo: f64, hi: f64) -> Option<Self> {
        (lo <= hi && lo < f64::INFINITY && hi > f64::NEG_INFINITY).then_some(Self { lo, hi })
    }

    /// Returns the interval that contains only `value`, or `None` if that is not finite.
    pub fn point(value: f64) -> Option<Self> {
        Self::new(value, value).filter(|_| value.is_finite())
    }

    /// Whether the number `value` lies inside.
    pub fn contains(self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether every point of `inner` lies inside.
    pub fn encloses(self, inner: Self) -> bool {
        self.lo <= inner.lo && inner.hi <= self.hi
    }

    /// Whether both ends are finite.
    pub fn is_bounded(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    /// Returns the only number inside, or `None` if there are several.
    pub fn singleton(self) -> Option<f64> {
        (self.lo == self.hi).then_some(self.lo)
    }

    /// Returns the smallest interval that encloses both.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Returns the largest absolute value inside.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// `hi − lo`, rounded to nearest.
    pub fn width(self) -> f64 {
        self.hi - self.lo
    }
}
