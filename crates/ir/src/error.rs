//! Errors of passes over a graph.

use thiserror::Error;

/// Largest number of nodes that a pass accepts or creates. A union of 100,000 blended spheres has
/// 2.1 million. A pass over this many nodes takes seconds and about a gigabyte.
pub const NODE_LIMIT: usize = 3_000_000;

/// The reason why a graph cannot be simplified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum IrError {
    /// The expression is too large.
    #[error("the expression has more than {limit} operations")]
    TooLarge {
        /// The largest number of nodes allowed.
        limit: usize,
    },
}
