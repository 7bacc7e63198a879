//! Counts of kernel evaluations.

use std::iter::Sum;
use std::ops::AddAssign;

/// Evaluations of one kind of kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Number of evaluations.
    pub calls: u64,
    /// Number of lanes in them that were needed.
    pub lanes: u64,
}

/// Evaluations by kind of kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KernelStats {
    /// Evaluations over boxes.
    pub interval: Count,
    /// Evaluations that narrow tiles.
    pub tiles: Count,
    /// Evaluations that narrow segments of single rays.
    pub segments: Count,
    /// Values at points.
    pub point: Count,
    /// Values and gradients at points.
    pub gradient: Count,
    /// Rays that were given up because their packet had used up its steps.
    pub given_up: u64,
}

impl Count {
    /// Counts one evaluation, in which `lanes` lanes were needed.
    #[inline]
    pub fn called(&mut self, lanes: u32) {
        self.calls += 1;
        self.lanes += u64::from(lanes);
    }
}

impl AddAssign for Count {
    fn add_assign(&mut self, other: Self) {
        self.calls += other.calls;
        self.lanes += other.lanes;
    }
}

impl AddAssign for KernelStats {
    fn add_assign(&mut self, other: Self) {
        self.interval += other.interval;
        self.tiles += other.tiles;
        self.segments += other.segments;
        self.point += other.point;
        self.gradient += other.gradient;
        self.given_up += other.given_up;
    }
}

impl Sum for KernelStats {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |mut sum, part| {
            sum += part;
            sum
        })
    }
}
