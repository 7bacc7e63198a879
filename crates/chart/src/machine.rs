//! What this runs on, and what it was made by.

use serde::{Deserialize, Serialize};
use zeroset_testkit::machine::{processor, threads};

/// What times depend on, beside the code.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Of this crate, which has that of the workspace.
    pub version: String,
    /// The compiler.
    pub rustc: String,
    /// Profile, level of optimisation, target and further flags.
    pub flags: String,
    /// The processor.
    pub processor: String,
    /// How many threads it runs at a time.
    pub processor_threads: usize,
}

impl Machine {
    /// That of this process.
    pub fn this() -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            rustc: env!("CHART_RUSTC").to_owned(),
            flags: env!("CHART_FLAGS").to_owned(),
            processor: processor(),
            processor_threads: threads(),
        }
    }
}
