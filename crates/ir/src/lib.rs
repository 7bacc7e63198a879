//! The expression graph: hash-consed nodes over exact constants.
//!
//! Nothing here knows text, kernels or pictures. A graph only grows, and a node's operands always
//! come before it, so the order of ids is a topological order and every pass is one loop.

mod algebra;
mod clear;
mod compact;
mod constant;
mod derivative;
mod display;
mod error;
mod exponents;
mod graph;
mod hoist;
mod radical;
mod rank;
mod simplify;
mod univariate;

#[cfg(test)]
mod testing;

pub use clear::{RationalForm, clear};
pub use compact::compact;
pub use constant::{Constant, NamedConstant};
pub use derivative::gradient;
pub use display::{TEXT_LIMIT, display};
pub use error::{IrError, NODE_LIMIT};
pub use exponents::fix_exponents;
pub use graph::{Axis, Graph, Node, NodeId, Operands};
pub use hoist::{Hoisted, hoist};
pub use radical::radical;
pub use rank::{Variability, ranks};
pub use simplify::{rewrite, simplify};
