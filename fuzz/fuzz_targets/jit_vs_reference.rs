//! Tests that native code and the reference evaluator agree bit for bit.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::jit_vs_reference;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = jit_vs_reference(data) {
        panic!("{failure}");
    }
});
