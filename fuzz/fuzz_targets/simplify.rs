//! Tests that simplification preserves values and domains of definition.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::simplify;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = simplify(data) {
        panic!("{failure}");
    }
});
