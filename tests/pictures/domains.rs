//! The automatic domain against the one that a mathematician would choose, for a hundred typed equations.
//!
//! All rows, with what was found: `cargo test --release --test pictures domains -- --nocapture`.

use std::fmt::Write as _;
use std::time::Instant;
use zeroset::domain::AutoDomain;
use zeroset::scene;
use zeroset_syntax::{Options, read};

/// The rows, and what they mean.
const ROWS: &str = include_str!("../data/domains.txt");

/// A box agrees with another if each, made larger by so much about its own centre, holds the other.
const TOLERANCE: f64 = 1.3;

/// Extents that were counted on a grid, or typed with few digits, may be off by this share of the largest.
const COUNTED: f64 = 0.01;

pub struct Row {
    pub text: String,
    pub bounded: bool,
    wanted: Vec<f64>,
}

pub fn rows() -> Vec<Row> {
    let lines = ROWS.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let row = |line: &str| {
        let parts: Vec<&str> = line.split(" | ").collect();
        let [text, what, place, _] = parts[..] else { panic!("not four parts: {line}") };
        assert!(["bounded", "window"].contains(&what), "{line}");
        let wanted: Vec<f64> =
            place.split(',').map(|number| number.parse().expect("a number")).collect();
        assert!(wanted.len() == 6 || what == "window" && wanted.len() == 1, "{line}");
        Row { text: text.replace(';', "\n"), bounded: what == "bounded", wanted }
    };
    lines.map(row).collect()
}

/// Whether the interval, grown by [`TOLERANCE`] about its middle, holds the other; `spare` is allowed on each side.
fn holds([low, high]: [f64; 2], other: [f64; 2], spare: f64) -> bool {
    let (middle, half) = (low.midpoint(high), TOLERANCE * (high - low) / 2.0 + spare);
    middle - half <= other[0] && other[1] <= middle + half
}

/// What is wrong with a found domain, if something is.
fn miss(row: &Row, found: &AutoDomain) -> Option<&'static str> {
    let ranges = [0, 1, 2].map(|axis| [found.low[axis], found.high[axis]]);
    if found.finding.is_bounded() != row.bounded {
        return Some(if row.bounded { "not proven bounded" } else { "bounded, it is said" });
    }
    if let [half] = row.wanted[..] {
        let largest = ranges.iter().map(|[low, high]| (high - low) / 2.0).fold(0.0, f64::max);
        let reach = ranges.as_flattened().iter().fold(0.0_f64, |most, end| most.max(end.abs()));
        let fits = |size: f64| size <= TOLERANCE * half && half <= TOLERANCE * size;
        return (!fits(largest) || reach > TOLERANCE * half).then_some("another size");
    }
    let wanted = [0, 1, 2].map(|axis| [row.wanted[2 * axis], row.wanted[2 * axis + 1]]);
    let spare = COUNTED * wanted.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
    for (range, wanted) in ranges.into_iter().zip(wanted) {
        if row.bounded && (range[0] > wanted[0] || wanted[1] > range[1]) {
            return Some("cut");
        }
        if !holds(range, wanted, spare) || !holds(wanted, range, spare) {
            return Some("another box");
        }
    }
    None
}

/// The rows of which the automatic domain is another one.
const MISSES: &[&str] = &["x^2*y^2+y^2*z^2+x^2*z^2+x*y*z=0"];

/// At least so many of a hundred agree.
const LEAST: usize = 90;

#[test]
fn domains_are_those_that_a_mathematician_would_choose() {
    let rows = rows();
    assert_eq!(rows.len(), 100);
    let (mut missed, mut report, mut times) = (Vec::new(), String::new(), Vec::new());
    for row in &rows {
        let document = read(&row.text, &Options::default()).expect(&row.text);
        let started = Instant::now();
        let found = scene::search(&document).expect(&row.text);
        times.push(started.elapsed().as_secs_f64() * 1e3);
        let ms = times.last().copied().unwrap_or_default();
        let why = miss(row, &found);
        let name = row.text.lines().last().unwrap_or_default();
        let _ = writeln!(report, "{:18} {ms:6.2} ms {name}: {found:?}", why.unwrap_or("agrees"));
        // What is wrong with a bounded surface is never a matter of judgement.
        assert!(!(row.bounded && why == Some("cut")), "{report}");
        missed.extend(why.map(|_| name.to_owned()));
    }
    times.sort_unstable_by(f64::total_cmp);
    let (median, worst) = (times[times.len() / 2], times[times.len() - 1]);
    println!("{report}{} of {} agree", rows.len() - missed.len(), rows.len());
    println!("median {median:.2} ms, worst {worst:.2} ms");
    assert_eq!(missed, MISSES, "{report}");
    assert!(rows.len() - missed.len() >= LEAST);
}
