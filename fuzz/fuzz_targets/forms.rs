//! Tests that affine forms enclose the oracle's values, and that contraction loses no root.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::forms;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = forms(data) {
        panic!("{failure}");
    }
});
