//! The machine and the build that results depend on.

use serde::{Deserialize, Serialize};
use zeroset_testkit::machine::{processor, threads};

/// Everything that times depend on, besides the code.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Environment {
    /// Version of this crate. All crates of the workspace have the same version.
    pub version: String,
    /// Version of the compiler.
    pub rustc: String,
    /// Profile, optimization level, target and further flags.
    pub flags: String,
    /// Name of the processor.
    pub processor: String,
    /// Number of threads that the processor runs at a time.
    pub processor_threads: usize,
}

impl Environment {
    /// The machine and build of this process.
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
