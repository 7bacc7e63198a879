//! Errors of passes over a graph.

use thiserror::Error;

/// Largest number of nodes that a pass accepts or creates. Code for a larger graph would take
/// seconds to compile.
pub const NODE_LIMIT: usize = 1 << 18;

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
