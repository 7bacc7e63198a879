//! Generated texts with forms, vectors, piecewise definitions and sums. They read back as printed,
//! and are simplified and enclosed soundly.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::spelled;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = spelled(data) {
        panic!("{failure}");
    }
});
