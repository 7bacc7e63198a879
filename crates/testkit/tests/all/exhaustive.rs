//! A sample of the exhaustive sweep. At every float checked, the native enclosure of a function of
//! one variable must contain the value, and be as tight as the function's row in the table says.
//!
//! All floats: `cargo run --release -p zeroset-testkit --example exhaustive`.

#[path = "../../examples/exhaustive/sweep.rs"]
mod sweep;

/// The stride is a prime, so that all exponents and low bits occur.
const STRIDE: u64 = 20_011;

#[test]
fn enclosures_hold_and_are_tight_on_a_slice_of_all_floats() {
    for function in sweep::functions() {
        let report = function.sweep(STRIDE);
        let name = function.name();
        println!("{name}: {report:?}");
        assert!(report.tried > 100_000, "{name}: too few floats: {report:?}");
        assert_eq!(report.violations, 0, "{name}: {report:?}");
        assert_eq!(report.unbounded, 0, "{name}: {report:?}");
        assert_eq!(report.wide, 0, "{name}: {report:?}");
        // Half of all floats are tiny. For these, the rule for bounded angles is an ulp too wide.
        let mean = if function.within.is_some() { 1.1 } else { 1.0 };
        assert!(report.mean() < mean, "{name}: {} ulp on average", report.mean());
    }
}
