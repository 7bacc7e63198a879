//! Tests that native code's bounds of a function as typed enclose the oracle's values.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::jit_vs_oracle;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = jit_vs_oracle(data) {
        panic!("{failure}");
    }
});
