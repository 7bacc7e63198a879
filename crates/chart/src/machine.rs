//! What this runs on, and what it was made by.

use serde::{Deserialize, Serialize};
use std::fs::read_to_string;

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
            processor_threads: std::thread::available_parallelism().map_or(1, usize::from),
        }
    }
}

/// Its name with family and model, which a name may not tell; "unknown processor" where there is no `/proc/cpuinfo`.
fn processor() -> String {
    let text = read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let mut fields = text.lines().filter_map(|line| line.split_once(':'));
        fields.find(|(key, _)| key.trim() == name).map(|(_, value)| value.trim())
    };
    match (field("model name"), field("cpu family"), field("model")) {
        (Some(name), Some(family), Some(model)) => {
            format!("{name} (family {family}, model {model})")
        }
        (Some(name), _, _) => name.to_owned(),
        (None, _, _) => "unknown processor".to_owned(),
    }
}
