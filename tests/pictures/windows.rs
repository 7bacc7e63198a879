//! The automatic domain against the windows that a mathematician would choose for solids, graphs
//! and periodic surfaces.
//!
//! All texts with their results: `cargo test --release --test all windows -- --nocapture`.

use super::domains::holds;
use std::fmt::Write as _;
use zeroset_scene::view;
use zeroset_syntax::{Options, read};

/// The texts, and the description of their format.
const ROWS: &str = include_str!("../data/windows.toml");

/// A text, and per axis the intervals of which one is wanted. An axis without one may have any.
struct Row {
    text: String,
    wanted: [Vec<[f64; 2]>; 3],
}

/// The value of `key` in a table of the list.
fn value<'a>(table: &'a str, key: &str) -> &'a str {
    let found = table.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
    found.unwrap_or_else(|| panic!("no {key} in {table}"))
}

fn rows() -> Vec<Row> {
    let row = |table: &str| {
        let intervals = |axis: &str| {
            let text = value(table, axis);
            let numbers = text.split(|c: char| "[], ".contains(c)).filter(|part| !part.is_empty());
            let numbers: Vec<f64> = numbers
                .take_while(|_| text != "\"any\"")
                .map(|number| number.parse().expect("a number"))
                .collect();
            assert!(
                numbers.len().is_multiple_of(2) && (text == "\"any\"") == numbers.is_empty(),
                "{text}"
            );
            numbers.chunks(2).map(|ends| [ends[0], ends[1]]).collect()
        };
        let text = value(table, "text").trim_matches('"').replace("\\n", "\n");
        Row { text, wanted: ["x", "y", "z"].map(intervals) }
    };
    ROWS.split("[[window]]\n").skip(1).map(row).collect()
}

/// Least number of the 120 texts whose extents agree along all axes.
const LEAST: usize = 112;

#[test]
fn windows_are_those_that_a_mathematician_would_choose() {
    let rows = rows();
    assert_eq!(rows.len(), 120);
    let (mut report, mut missed) = (String::new(), 0);
    for row in &rows {
        let document = read(&row.text, &Options::default()).expect(&row.text);
        let found = view::search(&document).expect(&row.text);
        let agrees = |axis: &usize| {
            let range = [found.low[*axis], found.high[*axis]];
            let wanted = &row.wanted[*axis];
            let fits = |one: &[f64; 2]| holds(range, *one, 0.0) && holds(*one, range, 0.0);
            wanted.is_empty() || wanted.iter().any(fits)
        };
        if !(0..3).all(|axis| agrees(&axis)) {
            missed += 1;
            let axes: Vec<&str> =
                (0..3).filter(|axis| !agrees(axis)).map(|axis| ["x", "y", "z"][axis]).collect();
            let (low, high) = (found.low, found.high);
            let _ = writeln!(report, "{}: {}: {low:?} {high:?}", row.text, axes.join(", "));
        }
    }
    println!("{report}{} of {} agree", rows.len() - missed, rows.len());
    assert!(rows.len() - missed >= LEAST, "{report}");
}
