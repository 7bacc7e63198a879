//! Tests the claims that small pictures make about their rays.

#![no_main]

#[path = "../../tests/pictures/property_support/mod.rs"]
mod property_support;

use libfuzzer_sys::fuzz_target;
use property_support::draw;
use zeroset_testkit::property::render;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = render(data, &draw) {
        panic!("{failure}");
    }
});
