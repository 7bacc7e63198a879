//! Checks of a property on seed files and random bytes: a bounded fuzzing run for `cargo test`.

use crate::suite::{Failure, Tally};
use crate::{Effort, count_claims};
use proptest::collection::vec;
use proptest::num::u8::ANY;
use proptest::test_runner::{Config, RngSeed, TestCaseError, TestRunner};
use std::cell::RefCell;
use std::path::Path;

/// Lengths of random inputs, in bytes.
const LENGTH: std::ops::Range<usize> = 4..256;
/// Greatest number of simpler inputs that are tried after a failure.
const SHRINKING: u32 = 500;

/// Checks a property on each file of the directory `seeds`, then on random bytes. Returns the sum
/// of the property's counts, and prints the number of comparisons.
///
/// # Panics
/// If the property fails on a file or on random bytes, or if the directory cannot be read. Failing
/// bytes are made simpler before the panic.
pub fn attack(
    property: &dyn Fn(&[u8]) -> Result<Tally, Failure>,
    seeds: &Path,
    effort: Effort,
) -> Tally {
    let mut tally = Tally::default();
    let mut paths: Vec<_> = std::fs::read_dir(seeds)
        .and_then(Iterator::collect::<Result<Vec<_>, _>>)
        .unwrap_or_else(|error| panic!("{}: {error}", seeds.display()))
        .iter()
        .map(std::fs::DirEntry::path)
        .filter(|path| path.is_file())
        .collect();
    paths.sort();
    for path in paths {
        let data = std::fs::read(&path).expect("a file");
        let checked = property(&data);
        tally.add(checked.unwrap_or_else(|failure| panic!("{}: {failure}", path.display())));
    }
    let tally = RefCell::new(tally);
    let mut runner = TestRunner::new(Config {
        cases: effort.cases.try_into().unwrap_or(u32::MAX),
        rng_seed: RngSeed::Fixed(effort.seed),
        failure_persistence: None,
        max_shrink_iters: SHRINKING,
        ..Config::default()
    });
    let result = runner.run(&vec(ANY, LENGTH), |data| match property(&data) {
        Ok(checked) => {
            tally.borrow_mut().add(checked);
            Ok(())
        }
        Err(failure) => Err(TestCaseError::fail(failure.to_string())),
    });
    result.unwrap_or_else(|failure| panic!("{failure}\n{effort}"));
    let tally = tally.into_inner();
    count_claims(tally.compared);
    tally
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    #[test]
    fn a_failure_is_made_simple_and_says_how_to_repeat_it() {
        let failure = catch_unwind(|| {
            // The seeds are source files, which have no byte above 250. Only random bytes fail.
            let few = |data: &[u8]| match data.iter().position(|byte| *byte > 250) {
                Some(at) => Err(Failure::new(format!("{} at {at}", data[at]))),
                None => Ok(Tally { compared: 1, defined: 1 }),
            };
            let texts = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/property");
            attack(&few, &texts, Effort { seed: 0x5eed_0750, cases: 100 })
        });
        let message = failure.expect_err("must fail");
        let message = message.downcast_ref::<String>().expect("text");
        assert!(message.contains("251 at 0"), "{message}");
        assert!(message.ends_with("ZEROSET_SEED=0x5eed0750 ZEROSET_CASES=100"), "{message}");
    }
}
