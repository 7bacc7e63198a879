//! Tests that native code's bounds overlap the oracle's bounds of the function as typed.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::jit_vs_oracle;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = jit_vs_oracle(data) {
        panic!("{failure}");
    }
});
