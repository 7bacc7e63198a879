//! Compiling and dropping kernels leaks no memory. The test has a process of its own, so that the
//! memory of other tests does not count.

#![cfg(target_os = "linux")]

use std::fs;
use zeroset_eval::Boxes;
use zeroset_interval::Interval;
use zeroset_scene::gallery::examples;
use zeroset_scene::program::Program;
use zeroset_syntax::{Document, Options, read};

const CYCLES: usize = 1000;
const ALLOWED_KILOBYTES: i64 = 512;

fn resident_kilobytes() -> i64 {
    let status = fs::read_to_string("/proc/self/status").expect("readable");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("a size");
    line.trim().trim_end_matches("kB").trim().parse().expect("a number")
}

/// Compiles all kernels of a document, runs one and drops all. Returns the size of their code.
fn cycle(document: &Document) -> usize {
    let program = Program::new(document, [Interval { lo: -2.0, hi: 2.0 }; 3]).expect("simplifies");
    let kernels = program.kernels::<f32>(0);
    kernels.values().expect("compiles");
    kernels.gradients().expect("compiles");
    kernels.gradient_bounds().expect("compiles");
    kernels.cleared().expect("compiles");
    kernels.zeros().expect("compiles");
    kernels.bounds().expect("compiles").eval_all(&Boxes::around(&[[Interval::ONE; 3]]));
    program.made().iter().map(|made| made.bytes).sum()
}

#[test]
fn a_thousand_cycles_leave_resident_memory_within_half_a_megabyte() {
    let read = |text: &str| read(text, &Options::default()).expect("reads");
    let documents: Vec<Document> = examples().iter().map(|example| read(example.text)).collect();
    // A first pass fills tables and the allocator's pools.
    let warm: usize = documents.iter().map(cycle).sum();
    let before = resident_kilobytes();
    let code: usize = (0..CYCLES).map(|n| cycle(&documents[n % documents.len()])).sum();
    let grown = resident_kilobytes() - before;
    println!("{warm} and {code} bytes of code; {before} kB resident, {grown} kB more at the end");
    let seen = 2 * 1024 * ALLOWED_KILOBYTES as usize;
    assert!(code > seen, "a leak of the code would not be seen");
    assert!(grown <= ALLOWED_KILOBYTES, "{grown} kB more than {before} kB");
}
