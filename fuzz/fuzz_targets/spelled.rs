//! Generated texts of forms, vectors, piecewise definitions and sums: they read as they print, and
//! are simplified and enclosed soundly.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::spelled;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = spelled(data) {
        panic!("{failure}");
    }
});
