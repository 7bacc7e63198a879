//! Any bytes are read or refused, and what was read is printed so that it reads alike.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::parse;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = parse(data) {
        panic!("{failure}");
    }
});
