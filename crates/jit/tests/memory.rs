//! Compiling and dropping kernels leaks no memory. This test is alone in its file and its process.
//!
//! A long run:
//! `ZEROSET_CYCLES=200000 cargo test --release -p zeroset-jit --test memory -- --nocapture`.

#![cfg(target_os = "linux")]

use zeroset_eval::{Assumptions, Binding, Boxes, Enclose, Kernel, Tape};
use zeroset_ir::{Axis, Graph};
use zeroset_jit::Native;
use zeroset_ops::Op;

/// Cycles of a short run: a hundredth of the long run.
const CYCLES: usize = 2000;
const ALLOWED_KILOBYTES: i64 = 2048;

fn resident_kilobytes() -> i64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("readable");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("a size");
    line.trim().trim_end_matches("kB").trim().parse().expect("a number")
}

/// Compiles, runs and drops the kernel of one of a few formulas. Returns the size of its code in
/// bytes.
fn cycle(n: usize) -> usize {
    let mut graph = Graph::new();
    let [x, y, _] = Axis::ALL.map(|axis| graph.variable(axis));
    let count = graph.integer((n % 7) as i64 + 1);
    let sum = graph.apply(Op::Add, &[x, count]);
    let product = graph.apply(Op::Mul, &[sum, y]);
    let root = if n.is_multiple_of(3) { graph.apply(Op::Exp, &[product]) } else { product };
    let tape = Tape::<f32>::new(&graph, &[root], &Assumptions::none(0));
    let kernel = Native::<Enclose>::new(tape, Binding::empty()).expect("compiles");
    kernel.eval_all(&[Boxes { count: 1, ..Boxes::default() }]);
    kernel.compiled().code_bytes()
}

#[test]
fn cycles_leave_resident_memory_within_two_megabytes() {
    let cycles = std::env::var("ZEROSET_CYCLES").ok();
    let cycles = cycles.map_or(CYCLES, |text| text.parse().expect("a number"));
    // The first cycles fill tables and the allocator's pools, so their memory is not counted.
    let warm: usize = (0..200).map(cycle).sum();
    let before = resident_kilobytes();
    let code: usize = (0..cycles).map(cycle).sum();
    let grown = resident_kilobytes() - before;
    println!(
        "{cycles} cycles after {warm} bytes, {code} bytes of code; {before} kB resident, {grown} kB more"
    );
    // Each kernel takes at least a page of 4 kB.
    assert!(cycles * 4 > 2 * ALLOWED_KILOBYTES as usize, "a leak would not be seen");
    assert!(grown <= ALLOWED_KILOBYTES, "{grown} kB more than {before} kB");
}
