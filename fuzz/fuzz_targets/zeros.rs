//! Tests that no kernel excludes a zero that certainly exists.

#![no_main]

#[path = "../../tests/pictures/property_support/mod.rs"]
mod property_support;

use libfuzzer_sys::fuzz_target;
use property_support::zero_kernel;
use zeroset_testkit::property::zeros;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = zeros(data, &zero_kernel, &zero_kernel) {
        panic!("{failure}");
    }
});
