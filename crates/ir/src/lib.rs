//! The expression graph: its nodes are hash-consed, and its constants are exact where possible.
//!
//! This crate knows nothing of text, kernels or pictures. A graph only grows, and operands always
//! precede the nodes that use them. So ids are in topological order, and every pass is one loop.

mod addition;
mod algebra;
mod angles;
mod blends;
mod cancel;
mod clear;
mod compact;
mod constant;
mod coprime;
mod decimal;
mod derivative;
mod differences;
mod display;
mod error;
mod exponents;
mod graph;
mod hoist;
mod logarithms;
mod polynomial;
mod radical;
mod regular;
mod roots;
mod sign;
mod simplify;
mod thin_zeros;
mod univariate;
mod variability;

#[cfg(test)]
mod proofs;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod towers;

pub use angles::algebraic_angles;
pub use blends::quadratic_blends;
pub use clear::{RationalForm, clear, without_gaps};
pub use compact::{compact, replaced};
pub use constant::{Constant, NamedConstant};
pub use derivative::{derivative, gradient, substitute};
pub use display::{Precedence, TEXT_LIMIT, display};
pub use error::{IrError, NODE_LIMIT};
pub use exponents::fix_exponents;
pub use graph::{Axis, Graph, Node, NodeId, Operands};
pub use hoist::{Hoisted, hoist};
pub use logarithms::bounded_logarithms;
pub use radical::radical;
pub use regular::{Level, levels, multiples, planes, regularize, sheets};
pub use sign::same_sign;
pub use simplify::{rewrite, simplify};
pub use thin_zeros::{ThinZeros, thin_zeros};
pub use variability::{Variability, variabilities};
