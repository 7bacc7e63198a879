//! In a part of space, a function with fewer steps must have the same signs and the same domain of
//! definition.
//!
//! A long run: `ZEROSET_CASES=10000000 cargo test -p zeroset-testkit --test all shortening`.

use zeroset_testkit::property::check_shortening;
use zeroset_testkit::{Adversarial, Effort, Rng, count_claims};

/// Checks random formulas until `cases` points were compared.
fn check<T: Adversarial>(seed: u64) {
    let effort = Effort::from_environment(seed, 40_000);
    let (mut compared, mut defined) = (0, 0);
    for seed in effort.seed.. {
        if compared >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let tally = check_shortening::<T>(&mut rng)
            .unwrap_or_else(|failure| panic!("{failure}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1"));
        compared += tally.compared;
        defined += tally.defined;
    }
    println!("{:?}: {defined} of {compared} points are defined", T::FORMAT);
    count_claims(compared);
    assert!(defined * 4 > compared, "{defined} of {compared}");
}

#[test]
fn dropped_steps_do_not_matter() {
    check::<f32>(0x5eed_0b00_0000);
    check::<f64>(0x5eed_0b10_0000);
}
