//! Counts of kernel evaluations.

use std::iter::Sum;
use std::ops::AddAssign;

/// Evaluations of kernels of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// Number of evaluations.
    pub calls: u64,
    /// Number of lanes whose results were needed, summed over the evaluations.
    pub lanes: u64,
}

/// Evaluations by kind of kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KernelStats {
    /// Evaluations over boxes.
    pub interval: Count,
    /// Evaluations that narrow tiles: affine arithmetic over many rays.
    pub tiles: Count,
    /// Evaluations that narrow segments of single rays.
    pub segments: Count,
    /// Evaluations of values at points.
    pub point: Count,
    /// Evaluations of values and gradients at points.
    pub gradient: Count,
    /// Number of rays that were given up because they, or their packet, used up the allowed effort.
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
