//! Any bytes are read or refused, and a printed document reads as the same one.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::parse;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = parse(data) {
        panic!("{failure}");
    }
});
