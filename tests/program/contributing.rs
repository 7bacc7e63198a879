//! The worked example of CONTRIBUTING.md names exactly the files that name a similar operation.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn sources(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(directory).expect("a directory") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Returns the section on a native function in two parts: its prose, and its table row.
fn native_section() -> (String, String) {
    let text = std::fs::read_to_string(root().join("CONTRIBUTING.md")).expect("there");
    let section = text.split("**Natively**").nth(1).expect("the section");
    let section = section.split("\n## ").next().expect("its text");
    let (before, rest) = section.split_once("```rust\n").expect("a row");
    let (row, after) = rest.split_once("```").expect("the row's end");
    (format!("{before}{after}"), row.to_owned())
}

/// The paths in backquotes in the section on a native function. A bare file name is in the
/// directory of the path before it.
fn named() -> BTreeSet<String> {
    let (section, _) = native_section();
    let mut directory = String::new();
    let mut paths = BTreeSet::new();
    for quoted in section.split('`').skip(1).step_by(2) {
        let is_file = Path::new(quoted).extension().is_some_and(|extension| extension == "rs");
        if let Some((before, last)) = quoted.rsplit_once('/') {
            directory = format!("{before}/");
            if last.is_empty() {
                continue;
            }
        }
        if is_file {
            let name = quoted.rsplit('/').next().unwrap_or(quoted);
            paths.insert(format!("{directory}{name}"));
        }
    }
    paths
}

#[test]
fn the_worked_example_names_every_place_and_no_other() {
    let mut files = Vec::new();
    for directory in ["crates", "src"] {
        sources(&root().join(directory), &mut files);
    }
    let arms: BTreeSet<String> = files
        .into_iter()
        .filter(|path| {
            let text = std::fs::read_to_string(path).expect("readable");
            // The example's `sinh` is like `atan`: odd, increasing and elementary. So the example
            // must name each place with a match arm, a row or a variant for `atan`. Tests of `atan`
            // alone do not count.
            let is_place = |line: &str| {
                let places =
                    ["Op::Atan =>", "op: Op::Atan,", "(Op::Atan, f64::", "case(Op::Atan, "];
                let line = line.trim();
                ["Atan,", "| Op::Atan"].contains(&line)
                    || line.contains("| Op::Atan ")
                    || places.iter().any(|place| line.contains(place))
            };
            text.lines().any(is_place)
        })
        .map(|path| path.strip_prefix(root()).expect("inside").display().to_string())
        .collect();
    assert_eq!(named(), arms);
}

/// Each test file must be named in the `main.rs` beside it. Otherwise it would not be compiled, and
/// its tests would not run.
#[test]
fn every_file_of_a_test_binary_is_a_part_of_it() {
    let mut files = Vec::new();
    for directory in ["tests", "crates"] {
        sources(&root().join(directory), &mut files);
    }
    let mains: Vec<_> = files
        .iter()
        .filter(|path| path.ends_with("main.rs") && path.iter().any(|part| part == "tests"))
        .collect();
    assert!(mains.len() >= 8, "{mains:?}");
    for main in mains {
        let text = std::fs::read_to_string(main).expect("readable");
        for entry in main.parent().expect("a directory").read_dir().expect("readable") {
            let path = entry.expect("readable").path();
            let name = path.file_stem().expect("a name").to_string_lossy();
            let named = text.contains(&format!("mod {name};\n"));
            assert!(named || name == "main", "{} is not in {}", path.display(), main.display());
        }
    }
}

/// The test binary of the window has a runner of its own, so the compiler would drop functions
/// marked `#[test]` there.
#[test]
fn no_test_of_the_window_is_dropped() {
    let mut files = Vec::new();
    sources(&root().join("tests/window"), &mut files);
    assert!(files.len() >= 5, "{files:?}");
    for path in files {
        let text = std::fs::read_to_string(&path).expect("readable");
        let is_marked = text.lines().any(|line| line.trim() == "#[test]");
        assert!(!is_marked, "a test of {} would never run", path.display());
    }
}

#[test]
fn the_native_example_states_columns_of_the_table() {
    let (_, row) = native_section();
    let source = std::fs::read_to_string(root().join("crates/ops/src/op.rs")).expect("there");
    let columns: Vec<&str> = row
        .split_inclusive(": ")
        .filter_map(|piece| piece.strip_suffix(": "))
        .filter_map(|piece| piece.rsplit([' ', '\n']).next())
        .collect();
    assert!(columns.contains(&"parity"), "{columns:?}");
    for column in columns {
        assert!(source.contains(&format!("    pub {column}: ")), "no column `{column}`");
    }
}

#[test]
fn the_native_example_is_the_row_itself() {
    let (_, row) = native_section();
    let table = std::fs::read_to_string(root().join("crates/ops/src/table.rs")).expect("there");
    let squeezed = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(squeezed(&table).contains(&squeezed(&row)), "{row}");
}

#[test]
fn the_composed_example_is_the_row_itself() {
    let text = std::fs::read_to_string(root().join("CONTRIBUTING.md")).expect("there");
    let row = text.lines().find(|line| line.starts_with("row(\"mix\"")).expect("the row");
    let table = std::fs::read_to_string(root().join("crates/ops/src/composed.rs")).expect("there");
    assert!(table.contains(row.trim()), "{row}");
}
