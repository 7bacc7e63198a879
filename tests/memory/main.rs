//! Tests of the memory that a process takes. Each runs in a process of its own, so that the memory
//! of others does not count.

mod drags;
#[path = "../edit_support/mod.rs"]
mod edit_support;
mod edits;
#[cfg(target_os = "linux")]
mod kernels;

use std::process::Command;

/// Variable that tells a process that it runs a single test.
const ALONE: &str = "ZEROSET_ALONE";

/// Calls `test`, which is the test of this name, in another process.
fn alone(name: &str, test: impl FnOnce()) {
    if std::env::var_os(ALONE).is_some() {
        return test();
    }
    let program = std::env::current_exe().expect("this program");
    let run = Command::new(program).args(["--exact", name, "--nocapture"]).env(ALONE, "1").output();
    let run = run.expect("it runs");
    let [said, wrong] = [&run.stdout, &run.stderr].map(|text| String::from_utf8_lossy(text));
    print!("{said}");
    assert!(run.status.success(), "{wrong}");
    assert!(said.contains("1 passed"), "there is no test {name}");
}

/// Resident memory of this process in bytes. `None` on systems other than Linux.
fn resident() -> Option<usize> {
    cfg!(target_os = "linux").then(|| {
        let statm = std::fs::read_to_string("/proc/self/statm").expect("readable");
        let pages = statm.split_whitespace().nth(1).expect("a size");
        pages.parse::<usize>().expect("a number") * 4096
    })
}
