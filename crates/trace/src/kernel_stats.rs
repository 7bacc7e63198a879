//! How much a picture asked of kernels.

use std::iter::Sum;
use std::ops::AddAssign;

/// Calls of one kind of kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    /// How often it was called.
    pub calls: u64,
    /// How many of the lanes it computed were wanted.
    pub lanes: u64,
}

/// Calls of kernels by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KernelStats {
    /// Questions about boxes.
    pub interval: Count,
    /// Tiles narrowed.
    pub tiles: Count,
    /// Segments of single rays narrowed.
    pub segments: Count,
    /// Values at points.
    pub point: Count,
    /// Values and gradients at points.
    pub gradient: Count,
    /// Rays that were given up: their packet had used up its steps.
    pub given_up: u64,
}

impl Count {
    /// Counts one call with so many lanes that were wanted.
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
