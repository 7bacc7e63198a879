//! How much a traversal asked of kernels.

use std::ops::AddAssign;

/// Counts of kernel calls and of the lanes in them that were wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Calls of the interval kernel.
    pub interval_calls: u64,
    /// Lanes of those calls whose ray was still looking for a root there.
    pub interval_lanes: u64,
    /// Rays that were given up: their packet had used up its steps.
    pub given_up: u64,
}

impl AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.interval_calls += other.interval_calls;
        self.interval_lanes += other.interval_lanes;
        self.given_up += other.given_up;
    }
}
