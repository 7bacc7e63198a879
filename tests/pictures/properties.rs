//! The properties of whole pictures that fuzz targets attack, checked on random bytes and on the
//! fuzzers' seeds.
//!
//! A long run of one property: `ZEROSET_CASES=100000 cargo test --release --test all
//! properties::pictures`.

use super::property_support::{draw, interpreted_zero_kernel, zero_kernel};
use std::path::{Path, PathBuf};
use zeroset_testkit::property::{render, seam_pictures, seam_zeros, zeros};
use zeroset_testkit::{Effort, attack};

fn seeds(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target)
}

#[test]
fn pictures_claim_nothing_false() {
    let effort = Effort::from_environment(0x5eed_0730, 800);
    let tally = attack(&|data| render(data, &draw), &seeds("render"), effort);
    println!("{tally:?}");
    // On average, over five rays per case are compared, and every second case has a certain
    // crossing.
    assert!(tally.compared > 5 * effort.cases && tally.defined > effort.cases / 2, "{tally:?}");
}

#[test]
fn no_kernel_denies_a_certain_zero() {
    let effort = Effort::from_environment(0x5eed_0740, 1500);
    let property = |data: &[u8]| zeros(data, &zero_kernel, &zero_kernel);
    let tally = attack(&property, &seeds("zeros"), effort);
    println!("{tally:?}");
    assert!(tally.compared > 3 * effort.cases && tally.defined > 3 * effort.cases, "{tally:?}");
}

#[test]
fn pictures_of_seams_claim_nothing_false() {
    let effort = Effort::from_environment(0x5eed_0750, 60);
    let tally = attack(&|data| seam_pictures(data, &draw), &seeds("seam_pictures"), effort);
    println!("{tally:?}");
    assert!(tally.compared > 5 * effort.cases && tally.defined > effort.cases, "{tally:?}");
}

#[test]
fn no_kernel_denies_a_certain_zero_at_seams() {
    let effort = Effort::from_environment(0x5eed_0760, 1000);
    let property =
        |data: &[u8]| seam_zeros(data, &interpreted_zero_kernel, &interpreted_zero_kernel);
    let tally = attack(&property, &seeds("seam_zeros"), effort);
    println!("{tally:?}");
    assert!(tally.compared > 3 * effort.cases && tally.defined > 3 * effort.cases, "{tally:?}");
}
