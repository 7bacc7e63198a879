//! Compiles the C++ rival for this machine's processor: for 4 lanes and, with AVX-512, for 16.

use std::process::Command;

const SOURCE: &str = "cpp/knoll2007.cpp";

/// The flags that the authors of Knoll et al. 2007 would have used.
const FLAGS: [&str; 3] = ["-march=native", "-ffast-math", "-std=c++17"];

fn main() {
    println!("cargo::rerun-if-changed={SOURCE}");
    println!("cargo::rustc-check-cfg=cfg(sixteen_lanes)");
    let compiler = rival("4").get_compiler();
    let said = |arguments: &[&str]| {
        let output = Command::new(compiler.path()).args(arguments).output();
        let output = output.expect("a C++ compiler");
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let version = said(&["--version"]);
    let version = version.lines().next().unwrap_or("unknown");
    println!("cargo::rustc-env=RIVALS_COMPILER={version}");
    println!("cargo::rustc-env=RIVALS_FLAGS=-O3 {}", FLAGS.join(" "));

    rival("4").compile("knoll2007_w4");
    let macros = said(&["-march=native", "-dM", "-E", "-x", "c++", "/dev/null"]);
    if macros.contains("__AVX512F__") {
        println!("cargo::rustc-cfg=sixteen_lanes");
        rival("16").compile("knoll2007_w16");
    }
}

/// Returns a build of the rival for this number of lanes.
fn rival(lanes: &str) -> cc::Build {
    let mut build = cc::Build::new();
    // With this model of thread-local storage, access to the counter is a plain memory operand.
    build.cpp(true).opt_level(3).flag("-ftls-model=local-exec");
    build.flags(FLAGS).define("W", lanes).file(SOURCE);
    build
}
