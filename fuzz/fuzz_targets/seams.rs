//! Tests that waves of angles and quotients that are rewritten keep their values and zeros.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::seams;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = seams(data) {
        panic!("{failure}");
    }
});
