//! Any bytes are read or refused. A printed document reads back as the same document.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::parse;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = parse(data) {
        panic!("{failure}");
    }
});
