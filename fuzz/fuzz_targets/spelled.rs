//! Tests generated texts with special forms, vectors, piecewise definitions and sums. They must
//! read back as printed. Their simplification and enclosures must be sound.

#![no_main]

use libfuzzer_sys::fuzz_target;
use zeroset_testkit::property::spelled;

fuzz_target!(|data: &[u8]| {
    if let Err(failure) = spelled(data) {
        panic!("{failure}");
    }
});
