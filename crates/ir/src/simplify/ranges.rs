//! What is known of a node of the new graph: its range over the domain, and what it depends on.

use crate::rank::Rank;
use zeroset_interval::{Facts, Interval};

/// What is known of a node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    /// Bounds of its value, wherever in the domain it is defined.
    pub(super) range: Interval,
    /// Facts over the whole domain.
    pub(super) facts: Facts,
    pub(super) rank: Rank,
}

impl Known {
    pub(super) fn defined(&self) -> bool {
        self.facts.has(Facts::DEFINED)
    }

    pub(super) fn excludes_zero(&self) -> bool {
        self.range.lo > 0.0 || self.range.hi < 0.0
    }
}
