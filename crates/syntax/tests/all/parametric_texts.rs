//! Checks texts of parametric surfaces of other systems. Each row has the values that the text
//! means, computed apart from this project.

use crate::words::value_in;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use zeroset_interval::Interval;
use zeroset_ir::{Constant, NodeId};
use zeroset_syntax::{Document, Options, Patch, read};

const TEXTS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/parametric.txt");

/// Largest difference of a value, relative to the value or to 1.
const TOLERANCE: f64 = 1e-9;

/// A surface that a text means.
struct Meant {
    names: [String; 2],
    /// The ends of the parameters' ranges.
    ends: [f64; 4],
    /// Two parameters, and the three coordinates there.
    values: Vec<[f64; 5]>,
}

#[derive(Default)]
struct Row {
    line: usize,
    system: String,
    text: String,
    meant: Vec<Meant>,
    message: Option<String>,
}

fn numbers<const N: usize>(words: &[&str]) -> [f64; N] {
    let all: Vec<f64> = words.iter().map(|word| word.parse().expect("a number")).collect();
    all.try_into().expect("so many numbers")
}

fn rows() -> Vec<Row> {
    let text = std::fs::read_to_string(TEXTS).expect("the corpus is there");
    let mut rows: Vec<Row> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        if let Some(head) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            let (system, _) = head.split_once(": ").expect("a system and a place");
            rows.push(Row { line: index + 1, system: system.to_owned(), ..Row::default() });
            continue;
        }
        let row = rows.last_mut().expect("a row begins with its system");
        let (sign, rest) = line.split_at(1);
        let rest = rest.strip_prefix(' ').unwrap_or(rest);
        let words: Vec<&str> = rest.split_whitespace().collect();
        match sign {
            ">" => writeln!(row.text, "{rest}").unwrap(),
            "!" => row.message = Some(rest.to_owned()),
            "@" => row.meant.push(Meant {
                names: [words[1].to_owned(), words[4].to_owned()],
                ends: numbers(&[words[2], words[3], words[5], words[6]]),
                values: Vec::new(),
            }),
            "=" => {
                let number: usize = words[0].parse().expect("a number");
                row.meant[number - 1].values.push(numbers(&words[1..]));
            }
            _ => panic!("line {}: {line}", index + 1),
        }
    }
    rows
}

/// Some values of a document's parametric surfaces at (u, v); `None` where one is undefined.
fn evaluated(document: &Document, roots: &[NodeId], u: f64, v: f64) -> Option<Vec<f64>> {
    let point = [u, v, 0.0].map(|at| Constant::enclosed(Interval::point(at).expect("finite")));
    let parameters: Vec<Constant> =
        document.parameters.iter().map(|parameter| parameter.value.clone()).collect();
    let value = |root: &NodeId| {
        let bounds = value_in(&document.patches.graph, &parameters, *root, &point)?.bounds();
        Some(f64::midpoint(bounds.lo, bounds.hi))
    };
    roots.iter().map(value).collect()
}

fn agree(found: &[f64], meant: &[f64]) -> bool {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= TOLERANCE * (1.0 + b.abs());
    found.len() == meant.len() && found.iter().zip(meant).all(near)
}

/// Describes how a surface differs from the one that is meant, if it does.
fn wrong_surface(document: &Document, patch: &Patch, meant: &Meant) -> Option<String> {
    // The order of the parameters is not part of the meaning.
    let is_turned = patch.names[0].eq_ignore_ascii_case(&meant.names[1])
        && !patch.names[0].eq_ignore_ascii_case(&meant.names[0]);
    let mut ends = evaluated(document, patch.ends.as_flattened(), 0.0, 0.0)?;
    if is_turned {
        ends.rotate_left(2);
    }
    if !agree(&ends, &meant.ends) {
        return Some(format!("ranges {ends:?}, not {:?}", meant.ends));
    }
    for [u, v, place @ ..] in &meant.values {
        let (first, second) = if is_turned { (*v, *u) } else { (*u, *v) };
        let found = evaluated(document, &patch.at, first, second).unwrap_or_default();
        if !agree(&found, place) {
            return Some(format!("at ({u}, {v}): {found:?}, not {place:?}"));
        }
    }
    None
}

/// The outcome of a row.
enum Outcome {
    AsMeant,
    Refused(String),
    Otherwise(String),
}

fn outcome(row: &Row) -> Outcome {
    let document = match (read(&row.text, &Options::default()), &row.message) {
        (Ok(document), None) => document,
        (Ok(_), Some(_)) => return Outcome::Otherwise("is read".to_owned()),
        (Err(errors), message) => {
            let rendered = errors.render(None, &row.text, false);
            let is_meant = message.as_ref().is_some_and(|part| rendered.contains(part.as_str()));
            return if is_meant { Outcome::AsMeant } else { Outcome::Refused(rendered) };
        }
    };
    let patches = &document.patches.all;
    if (patches.len(), document.surfaces.len()) != (row.meant.len(), 0) {
        let counts = format!("{} parametric and {} other", patches.len(), document.surfaces.len());
        return Outcome::Otherwise(counts);
    }
    // The ranges of parameters are no ranges of coordinates.
    if let Some(domain) = &document.domain {
        return Outcome::Otherwise(format!("cut by {domain:?}"));
    }
    let wrong = patches.iter().zip(&row.meant).find_map(|(patch, meant)| {
        let what = wrong_surface(&document, patch, meant)?;
        Some(format!("read as {}\n{what}", patch.echo))
    });
    wrong.map_or(Outcome::AsMeant, Outcome::Otherwise)
}

#[test]
fn parametric_surfaces_of_other_systems_are_read_as_meant() {
    let rows = rows();
    let (mut report, mut as_meant, mut otherwise) = (String::new(), 0, 0);
    // Rows of each system, and how many of them are read as meant.
    let mut systems: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for row in &rows {
        let counts = systems.entry(&row.system).or_default();
        counts[0] += 1;
        let (what, kind) = match outcome(row) {
            Outcome::AsMeant => {
                as_meant += 1;
                counts[1] += 1;
                continue;
            }
            Outcome::Refused(what) => (what, "refused"),
            Outcome::Otherwise(what) => {
                otherwise += 1;
                (what, "otherwise")
            }
        };
        writeln!(report, "line {}, {}, {kind}\n{}{what}\n", row.line, row.system, row.text)
            .unwrap();
    }
    println!("{as_meant} of {} as meant, {otherwise} otherwise; {systems:?}\n{report}", rows.len());
    assert!(rows.len() >= 200, "{} rows", rows.len());
    assert!(as_meant * 100 >= rows.len() * 90 && otherwise == 0, "{as_meant}\n{report}");
}

#[test]
fn a_text_that_means_something_else_is_noticed() {
    let row = |u: f64, high: f64| Row {
        text: "(u, v, u v) for u in [0, 1], v in [0, 2]".to_owned(),
        meant: vec![Meant {
            names: ["u", "v"].map(str::to_owned),
            ends: [0.0, 1.0, 0.0, high],
            values: vec![[u, 0.5, 0.25, 0.5, 0.125]],
        }],
        ..Row::default()
    };
    assert!(matches!(outcome(&row(0.25, 2.0)), Outcome::AsMeant));
    assert!(matches!(outcome(&row(0.5, 2.0)), Outcome::Otherwise(_)));
    assert!(matches!(outcome(&row(0.25, 3.0)), Outcome::Otherwise(_)));
}
