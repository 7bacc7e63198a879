//! Files of programs with their values, and the comparison of these values with our reading.

use super::{Language, Rng, once_in};
use std::fmt::Write as _;
use zeroset_interval::Interval;
use zeroset_ir::{Axis, Constant, Graph, Node, simplify};
use zeroset_syntax::{Document, Options, read};

/// Number of points at which each program has a value.
const POINTS: usize = 5;

/// A program, and its values at points.
#[derive(Clone, Debug)]
pub struct ProgramRecord {
    /// Language and number, for messages.
    pub title: String,
    /// Text of the program.
    pub text: String,
    /// Coordinates of each point, in eighths, and the value there. A value is missing if no
    /// interpreter has run, or if rounding decides it.
    pub values: Vec<([i64; 3], Option<f64>)>,
}

/// Result of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// All values agree.
    Same {
        /// Number of values that agree.
        count: usize,
        /// Number of values within enclosures that are too wide to compare.
        wide: usize,
    },
    /// The program was refused with this message.
    Refused(String),
    /// A value differs. Holds a description.
    Wrong(String),
}

/// Returns a file of `count` programs without values.
pub fn write_records(language: Language, seed: u64, count: u64) -> String {
    let mut file = format!("# {count} random programs of seed {seed}.\n");
    for number in 0..count {
        let mut rng = Rng::with_seed(seed << 20 | number);
        let text = language.program(&mut rng);
        writeln!(file, "[{} {number}]", language.name()).expect("a string");
        text.lines().for_each(|line| writeln!(file, "> {line}").expect("a string"));
        for _ in 0..POINTS {
            let mut eighth = || {
                let whole = rng.i32(-20..=20);
                if once_in(&mut rng, 12) { 0 } else { whole }
            };
            let [x, y, z] = [eighth(), eighth(), eighth()];
            writeln!(file, "@ {x} {y} {z}").expect("a string");
        }
    }
    file
}

/// Returns the records of a file.
///
/// # Panics
/// If a line has another form.
pub fn read_records(file: &str) -> Vec<ProgramRecord> {
    let mut all: Vec<ProgramRecord> = Vec::new();
    for line in file.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let (sign, rest) = line.split_at(1);
        if sign == "[" {
            let title = rest.trim_end_matches(']').to_owned();
            all.push(ProgramRecord { title, text: String::new(), values: Vec::new() });
            continue;
        }
        let record = all.last_mut().expect("a record begins with its title");
        match sign {
            ">" => {
                record.text.push_str(rest.strip_prefix(' ').unwrap_or(rest));
                record.text.push('\n');
            }
            "@" => {
                let (place, value) = rest.split_once('=').unwrap_or((rest, "?"));
                let eighths: Vec<i64> =
                    place.split_whitespace().map(|c| c.parse().expect("an integer")).collect();
                let eighths = <[i64; 3]>::try_from(eighths).expect("three coordinates");
                record.values.push((eighths, value.trim().parse().ok()));
            }
            _ => panic!("{line}"),
        }
    }
    all
}

/// Compares our values of a program with those of its record. Values agree if they differ by
/// `tolerance` at most, relative to the value or to 1.
pub fn compare(record: &ProgramRecord, tolerance: f64) -> Outcome {
    let document = match read(&record.text, &Options::default()) {
        Ok(document) => document,
        Err(errors) => return Outcome::Refused(errors.render(None, &record.text, false)),
    };
    let (mut count, mut wide) = (0, 0);
    for (eighths, expected) in &record.values {
        let Some(expected) = expected else { continue };
        let found = value(&document, eighths);
        let reach = tolerance * expected.abs().max(1.0);
        let holds = found
            .is_some_and(|found| found.lo - reach <= *expected && *expected <= found.hi + reach);
        if holds && found.is_some_and(|found| found.hi - found.lo > reach) {
            // A condition whose sides are equal within the enclosures decides the value.
            wide += 1;
            continue;
        }
        if !holds {
            let place = eighths.map(|eighth| eighth as f64 / 8.0);
            return Outcome::Wrong(format!("at {place:?}: {found:?}, not {expected}"));
        }
        count += 1;
    }
    Outcome::Same { count, wide }
}

/// Bounds of the first surface's function at a point; `None` if it has no value there.
fn value(document: &Document, eighths: &[i64; 3]) -> Option<Interval> {
    let mut graph = Graph::new();
    let mut map = Vec::new();
    for (_, node) in document.graph.iter() {
        map.push(match node {
            Node::Variable(axis) => {
                let index = match axis {
                    Axis::X => 0,
                    Axis::Y => 1,
                    Axis::Z => 2,
                };
                graph.constant(Constant::ratio(eighths[index], 8).expect("not zero"))
            }
            Node::Parameter(number) => {
                graph.constant(document.parameters[*number as usize].value.clone())
            }
            Node::Constant(value) => graph.constant(value.clone()),
            Node::Apply(op, operands) => {
                let operands: Vec<_> = operands.iter().map(|id| map[id.index()]).collect();
                graph.apply(*op, &operands)
            }
        });
    }
    let root = map[document.surfaces.first()?.root.index()];
    let (graph, roots) = simplify(&graph, &[root], &[Interval::ENTIRE; 3], &[]).ok()?;
    match graph.node(roots[0]) {
        Node::Constant(value) => Some(value.bounds()),
        _ => None,
    }
}
