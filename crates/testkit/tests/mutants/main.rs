//! Mutants without rebuilding: a machine does one thing wrong at one place of a rule's text, and a
//! random property must fail.
//!
//! A mutant is one wrong operation: it rounds down, returns the wrong one of two choices, exchanges
//! its operands, leaves one out, or returns the next lower number. Compilers keep the place of each
//! call, so rules need not know of it, and nothing is compiled again. First, the right machine
//! records which calls each trial reaches. Then mutants are drawn, and each trial that reaches a
//! mutant's call is tried until one fails.
//!
//! All mutants, with a line for each survivor:
//! `ZEROSET_MUTANTS=all cargo test -p zeroset-testkit --test mutants -- --nocapture`. In place of
//! `all`, a part of a file's path selects that file.

mod kernel;
mod machine;
mod reasons;
mod strength;
mod trial;

use machine::{Change, Mode, Mutant, Plan, Site};
use reasons::{REASONS, reason, text};
use std::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, Once};
use std::thread;
use std::time::{Duration, Instant};
use trial::{Outcome, Trial, attempt};
use zeroset_testkit::{Effort, Rng};

/// The seed of all trials, for which [`strength`] is recorded.
const SEED: u64 = 0x5eed_0c00_0000;
/// Mutants that a short test draws.
const DRAWN: usize = 200;
/// Least share of found mutants for each crate, in percent, if all are tried.
const LEAST: usize = 94;
/// Least share for the mutants that a short test draws: three standard deviations less.
const LEAST_OF_DRAWN: usize = 90;

/// The name of threads whose panics are results.
const TRIAL: &str = "trial of a mutant";

/// Applies `work` to all numbers below `count`, by all processors. Results are in order.
fn each<R: Send>(count: usize, work: impl Fn(usize) -> R + Sync) -> Vec<R> {
    static SILENCE: Once = Once::new();
    SILENCE.call_once(|| {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |what| {
            if thread::current().name() != Some(TRIAL) {
                usual(what);
            }
        }));
    });
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::with_capacity(count));
    let run = || loop {
        let number = next.fetch_add(1, Ordering::Relaxed);
        if number >= count {
            break;
        }
        let result = work(number);
        results.lock().expect("no panic while adding").push((number, result));
    };
    thread::scope(|scope| {
        let threads: Vec<_> = (0..thread::available_parallelism().map_or(1, usize::from))
            .map(|_| thread::Builder::new().name(TRIAL.into()).spawn_scoped(scope, run))
            .collect();
        for thread in threads {
            thread.expect("a thread").join().expect("no panic outside of trials");
        }
    });
    let mut results = results.into_inner().expect("no panic while adding");
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}

/// All mutants, each with the trials that reach it, the fastest first.
///
/// # Panics
/// If the right machine fails a trial.
fn all_mutants() -> Vec<(Mutant, Vec<Trial>)> {
    let trials = Trial::all();
    let reached = each(trials.len(), |number| {
        let start = Instant::now();
        let sites = trials[number].sites(SEED);
        (trials[number], start.elapsed(), sites)
    });
    let mut sites: BTreeMap<Site, Vec<(Duration, Trial)>> = BTreeMap::new();
    for (trial, time, reached) in reached {
        match reached {
            Ok(reached) => {
                for site in reached {
                    sites.entry(site).or_default().push((time, trial));
                }
            }
            Err((name, what)) => panic!("{trial:?}, {name}: {what}\nseed {SEED:#x}"),
        }
    }
    let mut mutants = Vec::new();
    for (site, mut trials) in sites {
        trials.sort();
        let trials: Vec<Trial> = trials.into_iter().map(|(_, trial)| trial).collect();
        for change in site.changes() {
            mutants.push((Mutant { site, change: *change }, trials.clone()));
        }
    }
    mutants
}

/// The numbers of mutants of a file or a crate, by outcome.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    false_claims: usize,
    weak_claims: usize,
    survived: usize,
    /// No result ever had another value.
    same: usize,
}

impl Score {
    fn found(&self) -> usize {
        self.false_claims + self.weak_claims
    }

    fn add(&mut self, outcome: Outcome) {
        *match outcome {
            Outcome::False => &mut self.false_claims,
            Outcome::Weak => &mut self.weak_claims,
            Outcome::Survived => &mut self.survived,
            Outcome::SameValues => &mut self.same,
        } += 1;
    }
}

#[test]
fn a_rule_that_does_one_thing_wrong_is_found() {
    let start = Instant::now();
    let mut mutants = all_mutants();
    let (total, recorded) = (mutants.len(), start.elapsed());
    mutants.retain(|(mutant, _)| reason(mutant).is_none());
    let harmless = total - mutants.len();
    let (drawn, is_thorough) = match env::var("ZEROSET_MUTANTS").as_deref() {
        Ok("all") => (mutants.len(), true),
        Ok(path) => {
            mutants.retain(|(mutant, _)| mutant.site.file().contains(path));
            (mutants.len(), true)
        }
        Err(_) => (DRAWN, false),
    };
    let least = if is_thorough { LEAST } else { LEAST_OF_DRAWN };
    let mut rng = Rng::with_seed(Effort::from_environment(SEED, 1).seed);
    // The first of a random order of mutants.
    for place in (1..mutants.len()).rev() {
        mutants.swap(place, rng.u64(0..=place as u64) as usize);
    }
    mutants.truncate(drawn);
    let outcomes = each(mutants.len(), |number| {
        let (mutant, trials) = &mutants[number];
        attempt(*mutant, trials, SEED, is_thorough)
    });
    let mut files: BTreeMap<&str, Score> = BTreeMap::new();
    let mut crates: BTreeMap<&str, Score> = BTreeMap::new();
    let mut changes: BTreeMap<Change, Score> = BTreeMap::new();
    let mut survivors = Vec::new();
    for ((mutant, trials), outcome) in mutants.iter().zip(outcomes) {
        let file = mutant.site.file();
        let of = file.split('/').nth(1).unwrap_or_default();
        files.entry(file).or_default().add(outcome);
        crates.entry(of).or_default().add(outcome);
        changes.entry(mutant.change).or_default().add(outcome);
        if matches!(outcome, Outcome::Survived | Outcome::SameValues) {
            survivors.push(format!(
                "{outcome:?} {mutant}, {} trials: {}",
                trials.len(),
                text(&mutant.site)
            ));
        }
    }
    survivors.sort();
    for line in survivors {
        println!("{line}");
    }
    for (name, score) in files {
        println!("{name}: {score:?}");
    }
    for (change, score) in changes {
        println!("{change:?}: {score:?}");
    }
    println!(
        "{total} mutants, {harmless} of them harmless; {} tried, after {recorded:?} of {:?}",
        mutants.len(),
        start.elapsed()
    );
    for (name, score) in &crates {
        let tried = score.found() + score.survived;
        println!("{name}: {} of {tried} mutants found, {score:?}", score.found());
    }
    for (name, score) in crates {
        let tried = score.found() + score.survived;
        // A few mutants say little about a share.
        assert!(score.found() * 100 + 100 >= tried * least, "{name}: {score:?}");
    }
}

/// A reason whose line is gone would excuse other lines one day.
#[test]
fn each_reason_names_a_line_of_code() {
    for reason in REASONS {
        let path = root().join(reason.file);
        let code = std::fs::read_to_string(&path);
        let code = code.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let is_there = code.lines().any(|line| line.contains(reason.line));
        assert!(is_there, "{}: {}", reason.file, reason.line);
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Writes how much is claimed, after rules or trials have changed:
/// `cargo test -p zeroset-testkit --test mutants -- --ignored records`.
#[test]
#[ignore = "writes strength.txt"]
fn records_how_much_is_claimed() {
    let trials = Trial::all();
    let lines = each(trials.len(), |number| {
        let trial = trials[number];
        let plan = || Plan::new(Mode::Record(Arc::default()));
        let single = trial.summarise::<f32>(&plan(), SEED);
        let double = trial.summarise::<f64>(&plan(), SEED);
        [("F32", single), ("F64", double)].map(|(format, summary)| {
            let name = format!("{trial:?} {format}");
            let summary = summary.map_err(|(property, what)| format!("{name}, {property}: {what}"));
            summary.map(|summary| strength::line(&name, &summary))
        })
    });
    let text: Result<String, String> = lines.into_iter().flatten().collect();
    let text = text.unwrap_or_else(|what| panic!("{what}"));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mutants/strength.txt");
    std::fs::write(path, text).expect("writes");
}
