//! Writes random programs, and compares values of other interpreters with our reading. See
//! CONTRIBUTING.md for the commands.

use std::collections::BTreeMap;
use std::process::ExitCode;
use zeroset_testkit::programs::{Language, Outcome, compare, read_records, write_records};

const USAGE: &str =
    "programs write LANGUAGE SEED COUNT > FILE, or programs compare TOLERANCE < FILE";

fn main() -> ExitCode {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let given: Vec<&str> = given.iter().map(String::as_str).collect();
    match given.as_slice() {
        ["write", name, seed, count] => {
            let language = Language::ALL.into_iter().find(|language| language.name() == *name);
            let (Some(language), Ok(seed), Ok(count)) = (language, seed.parse(), count.parse())
            else {
                return usage();
            };
            print!("{}", write_records(language, seed, count));
            ExitCode::SUCCESS
        }
        ["compare", tolerance] => match tolerance.parse() {
            Ok(tolerance) => compare_all(tolerance),
            Err(_) => usage(),
        },
        _ => usage(),
    }
}

fn usage() -> ExitCode {
    eprintln!("{USAGE}");
    ExitCode::FAILURE
}

/// Compares the records of the standard input. Prints every program that is read wrongly, and how
/// often each reason of a refusal occurs.
fn compare_all(tolerance: f64) -> ExitCode {
    let file = std::io::read_to_string(std::io::stdin()).expect("text");
    let (mut same, mut values, mut wide, mut missing, mut wrong) = (0, 0, 0, 0, 0);
    let mut refused: BTreeMap<String, (usize, String)> = BTreeMap::new();
    for record in read_records(&file) {
        missing += record.values.iter().filter(|(_, value)| value.is_none()).count();
        match compare(&record, tolerance) {
            Outcome::Same { count, wide: undecided } => {
                same += 1;
                wide += undecided;
                values += count;
            }
            Outcome::Refused(message) => {
                let reason = message.lines().next().unwrap_or_default().to_owned();
                refused.entry(reason).or_insert((0, format!("{}\n{message}", record.title))).0 += 1;
            }
            Outcome::Wrong(message) => {
                wrong += 1;
                println!("{}: {message}\n{}", record.title, record.text);
            }
        }
    }
    for (reason, (count, example)) in &refused {
        println!("{count} refused: {reason}\n{example}\n");
    }
    let refused: usize = refused.values().map(|(count, _)| count).sum();
    println!("{same} programs the same in {values} values, {refused} refused, {wrong} wrong");
    println!("{wide} values within wide enclosures");
    println!("{missing} values left out because rounding decides them, or no interpreter has run");
    if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
