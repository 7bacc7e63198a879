//! Tests that any bytes are read or refused, and that a printed document reads back the same.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::parse;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = parse(data) {
        panic!("{failure}");
    }
});
