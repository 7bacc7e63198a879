//! Affine forms enclose the oracle's values, and no contraction loses a root.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::forms;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = forms(data) {
        panic!("{failure}");
    }
});
