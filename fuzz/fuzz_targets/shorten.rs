//! Tests that the steps selected for a part of space give the signs of all steps.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::shorten;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = shorten(data) {
        panic!("{failure}");
    }
});
