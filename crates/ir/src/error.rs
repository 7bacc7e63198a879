//! What can go wrong with a graph.

use thiserror::Error;

/// No pass takes or makes a graph of more nodes than this: code for it would take seconds to
/// compile.
pub const NODE_LIMIT: usize = 1 << 18;

/// Why a graph cannot be simplified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum IrError {
    /// The expression is too large.
    #[error("the expression has more than {limit} operations")]
    TooLarge {
        /// The largest number of nodes allowed.
        limit: usize,
    },
}
