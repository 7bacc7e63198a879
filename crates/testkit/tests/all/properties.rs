//! Checks the properties of the fuzz targets on random bytes and on the fuzzers' seeds. The seeds
//! include every input that broke a property.
//!
//! A long run of one property:
//! `ZEROSET_CASES=100000 cargo test --release -p zeroset-testkit --test all simplif`.

use std::path::{Path, PathBuf};
use zeroset_testkit::property::{
    forms, jit_vs_oracle, jit_vs_reference, parse, seams, shorten, simplify, slopes, spelled,
};
use zeroset_testkit::suite::{Failure, Tally};
use zeroset_testkit::{Effort, attack};

type Property = fn(&[u8]) -> Result<Tally, Failure>;

fn directory(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// Checks a property. On average, each case must make at least one comparison, and more than one in
/// eight cases a comparison of certainly defined values.
fn hold(property: Property, target: &str, seed: u64, cases: u64) {
    let effort = Effort::from_environment(seed, cases);
    let tally = attack(&property, &directory("fuzz/seeds").join(target), effort);
    println!("{target}: {tally:?}");
    assert!(tally.compared >= effort.cases && tally.defined > effort.cases / 8, "{tally:?}");
}

#[test]
fn texts_are_read_or_refused_and_printed_as_they_read() {
    // Most random bytes are refused, so only the files are expected to be accepted.
    let directories = [
        ("fuzz/seeds/parse", 20),
        ("examples", 65),
        ("examples/parametric", 30),
        ("examples/models", 3),
    ];
    for (name, accepted) in directories {
        let tally = attack(&parse, &directory(name), Effort { seed: 0x5eed_06f0, cases: 1000 });
        println!("{name}: {tally:?}");
        assert!(tally.defined >= accepted, "{tally:?}");
    }
}

#[test]
fn simplifying_keeps_values_and_domains() {
    hold(simplify, "simplify", 0x5eed_0700, 3000);
}

#[test]
fn native_code_gives_the_bits_of_the_reference() {
    hold(jit_vs_reference, "jit_vs_reference", 0x5eed_0710, 1000);
}

#[test]
fn native_code_encloses_what_the_oracle_knows() {
    hold(jit_vs_oracle, "jit_vs_oracle", 0x5eed_0720, 3000);
}

#[test]
fn what_is_spelled_by_forms_holds_as_what_is_written_out() {
    hold(spelled, "spelled", 0x5eed_0750, 1000);
}

#[test]
fn affine_forms_hold_what_the_oracle_knows() {
    hold(forms, "forms", 0x5eed_0740, 1000);
}

#[test]
fn bounds_of_gradients_hold_what_the_oracle_knows() {
    hold(slopes, "slopes", 0x5eed_0790, 1000);
}

#[test]
fn shortened_functions_have_the_signs_of_the_whole() {
    hold(shorten, "shorten", 0x5eed_07a0, 1000);
}

#[test]
fn seams_that_are_rewritten_keep_values_and_zeros() {
    hold(seams, "seams", 0x5eed_07b0, 3000);
}
