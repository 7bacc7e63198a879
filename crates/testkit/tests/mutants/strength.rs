//! How much kernels claim in each trial, as recorded.
//!
//! A rule that claims less than it could makes no property false. So the number of facts and the
//! mean size of bounds are recorded in `strength.txt`, for the seed of the trials.

use crate::machine::Summary;
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// By how much the mean of the logarithms of bounds may differ from the recorded one.
const TOLERANCE: f64 = 1e-4;

static RECORDED: LazyLock<BTreeMap<&str, (u64, f64)>> = LazyLock::new(|| {
    let lines = include_str!("strength.txt").lines();
    let row = |line: &'static str| {
        let (rest, mean) = line.rsplit_once(' ')?;
        let (name, facts) = rest.rsplit_once(' ')?;
        Some((name, (facts.parse().ok()?, mean.parse().ok()?)))
    };
    lines.map(|line| row(line).unwrap_or_else(|| panic!("strength.txt: {line}"))).collect()
});

/// Returns in what a trial claims less or more than recorded.
pub fn difference(name: &str, found: &Summary) -> Option<String> {
    let Some((facts, mean)) = RECORDED.get(name) else {
        return Some("not recorded".to_owned());
    };
    let is_same = *facts == found.facts && (mean - found.mean()).abs() <= TOLERANCE;
    (!is_same).then(|| {
        format!(
            "{} facts and a mean of {:.5}, not {facts} and {mean}; if this is meant, run \
             `cargo test -p zeroset-testkit --test mutants -- --ignored records`",
            found.facts,
            found.mean()
        )
    })
}

/// Returns a line of the record.
pub fn line(name: &str, summary: &Summary) -> String {
    format!("{name} {} {:.5}\n", summary.facts, summary.mean())
}
