//! Parts as people print them, from text to file: each is meshed at the default tolerance, and its
//! STL file checked by a reader that knows nothing of how meshes are made.
//!
//! All parts with their figures: `cargo test --test program parts -- --nocapture`. The variable
//! `ZEROSET_SLOW_PARTS=1` adds the parts that take long.

use crate::cli_support::Sandbox;
use rayon::prelude::*;
use std::collections::{BTreeSet, HashSet};
use std::fmt::Write as _;
use std::time::{Duration, Instant};
use zeroset_testkit::Stl;

/// The parts, and the description of their format.
const ROWS: &str = include_str!("../data/parts.toml");

/// True if a part with more triangles than `most_triangles` fails.
const LIMITS_TRIANGLES: bool = true;

/// The program gives up a part after this many seconds. Its last step may take as long again.
const BUDGET: u64 = 120;

#[derive(Default)]
struct Part<'a> {
    name: &'a str,
    text: String,
    domain: Option<&'a str>,
    volume: Option<f64>,
    within: Option<f64>,
    euler: Option<i64>,
    pieces: Option<usize>,
    no_manifold: Option<&'a str>,
    most_triangles: Option<usize>,
    slow: Option<&'a str>,
    known: BTreeSet<&'a str>,
}

/// The result for a part.
struct Outcome {
    /// The checks that failed.
    failed: BTreeSet<&'static str>,
    /// True if the program says that shape and distance are proven.
    is_proven: bool,
    /// All figures.
    line: String,
}

impl<'a> Part<'a> {
    fn read(table: &'a str) -> Self {
        let mut part = Self::default();
        let lines = table.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
        for line in lines {
            let (key, value) = line.split_once(" = ").unwrap_or_else(|| panic!("{line}"));
            let quoted = value.strip_prefix('"').and_then(|value| value.strip_suffix('"'));
            let word = || quoted.unwrap_or_else(|| panic!("no string: {line}"));
            let number = || value.parse().unwrap_or_else(|_| panic!("no number: {line}"));
            match key {
                "name" => part.name = word(),
                "text" => part.text = word().replace("\\n", "\n"),
                "domain" => part.domain = Some(word()),
                "volume" => part.volume = Some(number()),
                "within" => part.within = Some(number()),
                "euler" => part.euler = Some(number() as i64),
                "pieces" => part.pieces = Some(number() as usize),
                "no_manifold" => part.no_manifold = Some(word()),
                "most_triangles" => part.most_triangles = Some(number() as usize),
                "slow" => part.slow = Some(word()),
                "known" => part.known = word().split(", ").collect(),
                _ => panic!("unknown key: {line}"),
            }
        }
        let is_complete = part.euler.is_some() && part.pieces.is_some();
        assert!(!part.text.is_empty() && is_complete != part.no_manifold.is_some(), "{table}");
        part
    }

    /// Meshes the part and checks its file.
    fn check(&self) -> Outcome {
        let mut place = Sandbox::new();
        place.limit = Duration::from_secs(2 * BUDGET);
        let budget = BUDGET.to_string();
        // As many parts at once as there are processors: so times are those of one.
        let usual = ["--json", "--threads", "1", "--budget", &budget, "-o", "part.stl"];
        let mut arguments = vec!["mesh", &self.text];
        arguments.extend(usual);
        arguments.extend(self.domain.iter().flat_map(|domain| ["--domain", domain]));
        let clock = Instant::now();
        let run = place.run(&arguments);
        let seconds = clock.elapsed().as_secs_f64();
        if run.code != Some(0) {
            let line = format!("no file  {seconds:6.2} s  {}", run.stderr.trim());
            return Outcome { failed: ["failed"].into(), is_proven: false, line };
        }
        let report = run.json();
        let number = |key: &str| report[key].as_f64().expect(key);
        let bytes = std::fs::read(place.path("part.stl")).expect("a file");
        let mesh = Stl::read(&bytes).expect(self.name);
        let count = mesh.triangles.len();
        assert_eq!(count as f64, number("triangles"), "{}", self.name);
        let mut line = format!("{count:>7}  {seconds:6.2} s  ");
        let mut failed = BTreeSet::new();
        // Without a proof of the shape, the program claims nothing of the distance.
        if let Some(key) = ["unproven", "far"].into_iter().find(|key| number(key) > 0.0) {
            let _ = write!(line, "{} of {} cells {key}, ", report[key], report["cells"]);
            failed.insert(key);
        }
        let is_proven = failed.is_empty();
        line += if is_proven { "proven" } else { "not proven" };
        for (kind, number) in mesh.flaws().kinds() {
            let _ = write!(line, ", {number} {kind}");
            failed.insert(kind);
        }
        let figures = mesh.figures();
        if let Some(euler) = self.euler.filter(|euler| *euler != figures.euler) {
            let _ = write!(line, ", Euler number {} in place of {euler}", figures.euler);
            failed.insert("euler");
        }
        if let Some(pieces) = self.pieces.filter(|pieces| *pieces != figures.pieces) {
            let _ = write!(line, ", {} pieces in place of {pieces}", figures.pieces);
            failed.insert("pieces");
        }
        if let Some(volume) = self.volume {
            // Each face moves by the tolerance at most.
            let most =
                self.within.map_or(number("tolerance") * figures.area, |share| share * volume);
            let _ = write!(line, ", volume {:+.1e}", figures.volume / volume - 1.0);
            if (figures.volume - volume).abs() > most {
                let _ = write!(line, ": {} in place of {volume}", figures.volume);
                failed.insert("volume");
            }
        } else if figures.volume <= 0.0 {
            let _ = write!(line, ", volume {}", figures.volume);
            failed.insert("volume");
        }
        if let Some(most) = self.most_triangles {
            let _ = write!(line, ", {most} triangles wanted");
            if LIMITS_TRIANGLES && count > most {
                failed.insert("triangles");
            }
        }
        if self.no_manifold.is_some() {
            // A file with the right triangles is no manifold either.
            for kind in ["unproven", "far", "crowded", "pinched", "close"] {
                failed.remove(kind);
            }
        }
        Outcome { failed, is_proven, line }
    }
}

/// A file is right wherever the program calls it proven, except for failures that are on record.
#[test]
fn parts_for_print_are_as_proven() {
    let parts: Vec<Part> = ROWS.split("[[part]]\n").skip(1).map(Part::read).collect();
    let names: HashSet<&str> = parts.iter().map(|part| part.name).collect();
    assert_eq!(names.len(), parts.len(), "two parts have one name");
    let with_slow = std::env::var_os("ZEROSET_SLOW_PARTS").is_some();
    let (mut sound, mut unproven, mut wrong, mut left_out) = (0, 0, 0, 0);
    let mut surprises = String::new();
    let is_left_out = |part: &Part| part.slow.is_some() && !with_slow;
    let results: Vec<_> =
        parts.par_iter().map(|part| (!is_left_out(part)).then(|| part.check())).collect();
    for (part, result) in parts.iter().zip(results) {
        let Some(Outcome { failed, is_proven, line }) = result else {
            println!("{:<38} left out: {}", part.name, part.slow.unwrap_or_default());
            left_out += 1;
            continue;
        };
        println!("{:<38} {line}", part.name);
        match (failed.is_empty(), is_proven) {
            (true, _) => sound += 1,
            (false, true) => wrong += 1,
            (false, false) => unproven += 1,
        }
        if failed != part.known {
            let [failed, known] = [&failed, &part.known]
                .map(|kinds| kinds.iter().copied().collect::<Vec<_>>().join(", "));
            let _ = writeln!(surprises, "{}: '{failed}', known is '{known}': {line}", part.name);
        }
    }
    println!(
        "{} parts: {sound} sound, {unproven} not proven, {wrong} called proven but wrong, {left_out} \
         left out",
        parts.len()
    );
    assert!(surprises.is_empty(), "not as tests/data/parts.toml has it:\n{surprises}");
}
