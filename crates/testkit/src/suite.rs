//! One suite for every evaluator: each row of the table over adversarial inputs, and random graphs.
//!
//! An evaluator plugs in as a function that makes a kernel out of a graph. Nothing is assumed of
//! how it works; what it says is held against the [oracle](crate::Oracle).

mod cases;
mod gradient;
mod interval;
mod point;
mod rewrite;
mod slopes;
mod subjects;

use std::fmt;
use zeroset_eval::Kernel;
use zeroset_ir::{Graph, NodeId};

pub use cases::{MakeCase, check_interval_case, check_interval_cases};
pub use gradient::check_gradients;
pub use interval::{check_interval_graphs, check_interval_ops};
pub use point::check_points;
pub(crate) use rewrite::contradiction;
pub use rewrite::{Rewrite, check_rewrite};
pub use slopes::{check_slopes, check_slopes_of_ops};

/// Makes a kernel for a graph without parameters.
pub type Make<'a, Q, T = f32> = &'a dyn Fn(&Graph, NodeId) -> Box<dyn Kernel<Q, T>>;

/// How much a passing check has looked at: a test should ask for a minimum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Pairs of a kernel's answer and an oracle's claim.
    pub compared: u64,
    /// Those where the function is certainly defined, so that values were compared.
    pub defined: u64,
}

impl Tally {
    /// Counts what `other` counts, too.
    pub fn add(&mut self, other: Self) {
        self.compared += other.compared;
        self.defined += other.defined;
    }
}

/// The first contradiction found: what it was, and a line that reproduces it.
#[derive(Clone, Debug)]
pub struct Failure(String);

impl Failure {
    /// A contradiction, told.
    pub(crate) fn new(what: impl Into<String>) -> Self {
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
