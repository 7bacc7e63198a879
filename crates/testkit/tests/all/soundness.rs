//! Native intervals must enclose the oracle's values, in both precisions. They are compiled as in
//! programs: the graph is simplified over a domain, its parameters are bound, and the code is
//! evaluated on boxes within the domain.
//!
//! A long run:
//! `ZEROSET_CASES=100000000 cargo test --release -p zeroset-testkit --test all soundness`.

use zeroset_testkit::property::native_interval;
use zeroset_testkit::suite::check_interval_cases;
use zeroset_testkit::{Adversarial, Effort, GraphOptions};

fn check<T: Adversarial>(name: &str, seed: u64, cases: u64, options: &GraphOptions) {
    let effort = Effort::from_environment(seed, cases);
    let tally = check_interval_cases::<T>(&native_interval, effort, options);
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
