//! Tests that bounds of gradients enclose the oracle's slopes and derivatives.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::slopes;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = slopes(data) {
        panic!("{failure}");
    }
});
