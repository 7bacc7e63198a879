//! Tests that no kernel excludes a zero that certainly exists, where formulas fold, jump or divide.

#![no_main]

#[path = "../../tests/pictures/property_support/mod.rs"]
mod property_support;

use libfuzzer_sys::fuzz_target;
use property_support::interpreted_zero_kernel;
use zeroset_testkit::property::seam_zeros;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = seam_zeros(data, &interpreted_zero_kernel, &interpreted_zero_kernel) {
        panic!("{failure}");
    }
});
