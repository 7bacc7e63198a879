//! The properties that fuzz targets attack, over random bytes and over what fuzzers are started from: the seeds, among
//! which every input is kept that once broke a property.
//!
//! A long run of one: `ZEROSET_CASES=100000 cargo test --release -p zeroset-testkit --test properties -- simplif`.

use std::path::{Path, PathBuf};
use zeroset_testkit::property::{jit_vs_oracle, jit_vs_reference, parse, simplify};
use zeroset_testkit::suite::{Failure, Tally};
use zeroset_testkit::{Effort, Rng};

type Property = fn(&[u8]) -> Result<Tally, Failure>;

/// Files under a directory of the repository, in order.
fn files(directory: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let entries = std::fs::read_dir(root.join(directory)).expect("a directory");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("readable").path()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read(path).expect("a file"))).collect()
}

fn check(property: Property, data: &[u8], what: &str) -> Tally {
    property(data).unwrap_or_else(|failure| panic!("{what}: {failure}"))
}

/// Runs a property on its seeds, then on random bytes until enough was compared.
fn hold(property: Property, target: &str, seed: u64, cases: u64) {
    let mut tally = Tally::default();
    for (path, data) in files(&format!("fuzz/seeds/{target}")) {
        tally.add(check(property, &data, &path.display().to_string()));
    }
    let effort = Effort::from_environment(seed, cases);
    for seed in effort.seed..effort.seed + effort.cases {
        let mut rng = Rng::with_seed(seed);
        let length = rng.u32(0..256);
        let data: Vec<u8> = (0..length).map(|_| rng.u32(0..256) as u8).collect();
        let what = format!("{data:?}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1");
        tally.add(check(property, &data, &what));
    }
    println!("{target}: {tally:?}");
    assert!(tally.compared >= effort.cases && tally.defined > effort.cases / 8, "{tally:?}");
}

#[test]
fn texts_are_read_or_refused_and_printed_as_they_read() {
    let mut tally = Tally::default();
    for (path, data) in files("fuzz/seeds/parse").into_iter().chain(files("examples")) {
        tally.add(check(parse, &data, &path.display().to_string()));
    }
    assert!(tally.defined > 65, "{tally:?}");
}

#[test]
fn simplifying_keeps_values_and_domains() {
    hold(simplify, "simplify", 0x5eed_0700_0000, 3000);
}

#[test]
fn native_code_gives_the_bits_of_the_reference() {
    hold(jit_vs_reference, "jit_vs_reference", 0x5eed_0710_0000, 3000);
}

#[test]
fn native_code_encloses_what_the_oracle_knows() {
    hold(jit_vs_oracle, "jit_vs_oracle", 0x5eed_0720_0000, 3000);
}
