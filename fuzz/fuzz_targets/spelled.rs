//! What is spelled by forms, vectors, choices and sums reads as it prints, and is simplified and
//! enclosed soundly.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::spelled;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = spelled(data) {
        panic!("{failure}");
    }
});
