//! Passes the compiler's version and flags to the program, which records them with every result.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=CARGO_ENCODED_RUSTFLAGS");
    let read = |name: &str| std::env::var(name).unwrap_or_default();
    let version = Command::new(read("RUSTC")).arg("--version").output();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    println!("cargo::rustc-env=CHART_RUSTC={}", version.unwrap_or_default());
    let flags = read("CARGO_ENCODED_RUSTFLAGS").replace('\u{1f}', " ");
    let flags =
        format!("{} opt-level={} {} {flags}", read("PROFILE"), read("OPT_LEVEL"), read("TARGET"));
    println!("cargo::rustc-env=CHART_FLAGS={}", flags.trim());
}
