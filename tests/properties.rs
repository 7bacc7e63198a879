//! The properties of whole pictures that fuzz targets attack, over random bytes and over the fuzzers' seeds.
//!
//! A long run of one: `ZEROSET_CASES=100000 cargo test --release --test properties -- pictures`.

mod property_support;

use property_support::{draw, zero_kernel};
use std::path::Path;
use zeroset_testkit::property::{render, zeros};
use zeroset_testkit::suite::{Failure, Tally};
use zeroset_testkit::{Effort, Rng};

/// Runs a property on its seeds, then on random bytes.
fn hold(
    property: &dyn Fn(&[u8]) -> Result<Tally, Failure>,
    target: &str,
    seed: u64,
    cases: u64,
) -> Tally {
    let mut tally = Tally::default();
    let mut check = |data: &[u8], what: &str| {
        let checked = property(data);
        tally.add(checked.unwrap_or_else(|failure| panic!("{what}: {failure}")));
    };
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(target);
    for entry in std::fs::read_dir(seeds).expect("a directory") {
        let path = entry.expect("readable").path();
        check(&std::fs::read(&path).expect("a file"), &path.display().to_string());
    }
    let effort = Effort::from_environment(seed, cases);
    for seed in effort.seed..effort.seed + effort.cases {
        let mut rng = Rng::with_seed(seed);
        let data: Vec<u8> = (0..rng.u32(4..256)).map(|_| rng.u32(0..256) as u8).collect();
        check(&data, &format!("{data:?}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1"));
    }
    println!("{target}: {tally:?}");
    tally
}

#[test]
fn pictures_claim_nothing_false() {
    let tally = hold(&|data| render(data, &draw), "render", 0x5eed_0730_0000, 800);
    assert!(tally.compared > 800 && tally.defined > 400, "{tally:?}");
}

#[test]
fn no_kernel_denies_a_certain_zero() {
    let tally =
        hold(&|data| zeros(data, &zero_kernel, &zero_kernel), "zeros", 0x5eed_0740_0000, 1500);
    assert!(tally.compared > 1500 && tally.defined > 1000, "{tally:?}");
}
