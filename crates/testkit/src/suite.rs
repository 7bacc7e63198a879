//! One test suite for every evaluator: each operation over adversarial inputs, and random graphs.
//!
//! An evaluator is given as a function that compiles a graph to a kernel. The suite assumes nothing
//! else about it and checks its results against the [oracle](crate::Oracle).

mod cases;
mod gradient;
mod interval;
mod point;
mod rewrite;
mod slopes;
mod subjects;
mod tightness;

use std::fmt;
use zeroset_eval::Kernel;
use zeroset_ir::{Graph, NodeId};

pub use cases::{CompileCase, check_interval_case, check_interval_cases};
pub use gradient::{check_gradients, check_gradients_of_some_ops};
pub use interval::{check_interval_graphs, check_interval_ops, check_interval_some_ops};
pub use point::{check_points, check_points_of_some_ops, tolerance_of_values};
pub(crate) use rewrite::contradiction;
pub use rewrite::{Rewrite, check_rewrite};
pub use slopes::{check_slopes, check_slopes_of_ops, check_slopes_of_some_ops};
pub use tightness::{Slack, check_tightness};

/// Compiles a graph without parameters to a kernel.
pub type CompileGraph<'a, Q, T = f32> = &'a dyn Fn(&Graph, NodeId) -> Box<dyn Kernel<Q, T>>;

/// Amount of work that a check did. Tests should require a minimum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Number of comparisons of a kernel's result with an oracle's claim.
    pub compared: u64,
    /// Number of comparisons where the function is certainly defined, so that values were compared.
    pub defined: u64,
}

impl Tally {
    /// Adds the counts of `other`.
    pub fn add(&mut self, other: Self) {
        self.compared += other.compared;
        self.defined += other.defined;
    }
}

/// The first contradiction found: a message, and a line that reproduces it.
#[derive(Clone, Debug)]
pub struct Failure(String);

impl Failure {
    /// Creates a failure with this message.
    pub fn new(what: impl Into<String>) -> Self {
        Self(what.into())
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Failure {}

#[cfg(test)]
mod tests;
