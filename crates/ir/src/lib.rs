//! The expression graph: hash-consed nodes over exact constants.
//!
//! Nothing here knows text, kernels or pictures. A graph only grows, and a node's operands always come before it,
//! so the order of ids is a topological order and every pass is one loop.

mod constant;
mod graph;

pub use constant::Constant;
pub use graph::{Axis, Graph, Node, NodeId, Operands};
