//! Description of the computer that measurements are taken on.

use std::fs::read_to_string;

/// Returns the processor's name with its family and model, since several models may share a name.
/// Returns "unknown processor" if there is no `/proc/cpuinfo`.
pub fn processor() -> String {
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

/// Number of threads that run in parallel.
pub fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
