//! Native intervals hold what the oracle knows, in both precisions, compiled as programs are: the graph is simplified
//! over a domain, its parameters are bound, and the code is asked about boxes within the domain.
//!
//! A long run: `ZEROSET_CASES=100000000 cargo test --release -p zeroset-testkit --test soundness`.

use zeroset_eval::{Binding, IntervalKernel, Real, Tape};
use zeroset_interval::Facts;
use zeroset_ir::{rewrite, simplify};
use zeroset_jit::NativeInterval;
use zeroset_testkit::suite::check_interval_cases;
use zeroset_testkit::{Adversarial, Case, Effort, GraphOptions};

/// Native code for a case, by the steps that lead from a document to a kernel.
fn native<T: Real>(case: &Case) -> Option<Box<dyn IntervalKernel<T>>> {
    let bounds = &case.assumptions;
    let (graph, roots) =
        rewrite(&case.graph, &[case.root], &bounds.domain, &bounds.parameters).ok()?;
    let (graph, roots) = simplify(&graph, &roots, &bounds.domain, &bounds.parameters).ok()?;
    let tape = Tape::new(&graph, &roots, bounds);
    let values: Vec<_> = case.parameters.iter().map(|value| (*value, Facts::TOTAL)).collect();
    let kernel = NativeInterval::compile(&tape, &Binding::new(&values)).expect("compiles");
    Some(Box::new(kernel))
}

fn check<T: Adversarial>(name: &str, seed: u64, cases: u64, options: &GraphOptions) {
    let effort = Effort::from_environment(seed, cases);
    let tally = check_interval_cases::<T>(&native, effort, options);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    println!("{name}, {:?}: {tally:?}", T::FORMAT);
    assert!(tally.defined >= effort.cases, "{tally:?}");
}

#[test]
fn typical_formulas_are_enclosed() {
    let options = GraphOptions { adversarial: false, ..GraphOptions::default() };
    check::<f32>("typical", 0x5eed_0100_0000, 700_000, &options);
    check::<f64>("typical", 0x5eed_0110_0000, 700_000, &options);
}

#[test]
fn adversarial_formulas_with_parameters_are_enclosed() {
    let options = GraphOptions { size: 6, parameters: 2, ..GraphOptions::default() };
    check::<f32>("adversarial", 0x5eed_0200_0000, 400_000, &options);
    check::<f64>("adversarial", 0x5eed_0210_0000, 400_000, &options);
}

#[test]
fn long_formulas_are_enclosed() {
    let options = GraphOptions { size: 24, parameters: 1, ..GraphOptions::default() };
    check::<f32>("long", 0x5eed_0300_0000, 100_000, &options);
    check::<f64>("long", 0x5eed_0310_0000, 100_000, &options);
}
