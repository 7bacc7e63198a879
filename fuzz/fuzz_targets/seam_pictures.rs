//! Tests the claims that small pictures make about their rays, where formulas fold, jump or divide.

#![no_main]

#[path = "../../tests/pictures/property_support/mod.rs"]
mod property_support;

use libfuzzer_sys::fuzz_target;
use property_support::draw;
use zeroset_testkit::property::seam_pictures;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = seam_pictures(data, &draw) {
        panic!("{failure}");
    }
});
