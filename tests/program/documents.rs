//! Checks README, ARCHITECTURE and the manual against the tables and files that they mention.

use crate::surroundings::zeroset;
use std::fs;
use std::path::{Path, PathBuf};
use zeroset_live::COMMANDS;
use zeroset_style::{COLOR_MAPS, LOOKS, Values, settings};
use zeroset_trace::{METHODS, OPTIONS, TraceOptions};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &str) -> String {
    fs::read_to_string(root().join(path)).expect(path)
}

/// Asserts that the table below the line that begins with `heading` has exactly these rows.
fn check_table(path: &str, heading: &str, expected: impl Iterator<Item = String>) {
    let text = text(path);
    let lines = text.lines().skip_while(|line| !line.starts_with(heading)).skip(2);
    let rows: Vec<&str> = lines.take_while(|line| line.starts_with('|')).collect();
    let expected: Vec<String> = expected.collect();
    assert!(!expected.is_empty());
    assert_eq!(rows, expected, "{path} must have:\n{}", expected.join("\n"));
}

/// The words in backquotes after `before` and a colon.
fn list<'a>(text: &'a str, before: &str) -> Vec<&'a str> {
    let (_, list) = text.split_once(&format!("{before}:")).expect("a list");
    list.split('`').nth(1).expect("its words").split_whitespace().collect()
}

/// A text as a cell of a table shows it.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

#[test]
fn changes_are_listed_for_the_version_that_the_program_says() {
    let place = tempfile::tempdir().expect("a directory");
    let output = zeroset(&[], place.path()).arg("--version").output().expect("runs");
    let said = String::from_utf8_lossy(&output.stdout);
    let version = env!("CARGO_PKG_VERSION");
    let bits = 8 * zeroset_jit::vector_widths().next().expect("a width");
    assert!(said.starts_with(&format!("zeroset {version} (")), "{said}");
    assert!(said.contains(std::env::consts::ARCH), "{said}");
    assert!(said.trim_end().ends_with(&format!("vectors of {bits} bits)")), "{said}");
    assert!(text("CHANGELOG.md").contains(&format!("## {version}")));
}

#[test]
fn every_method_has_its_row() {
    let rows = METHODS.iter().map(|row| {
        let options: Vec<String> =
            row.reads.iter().map(|option| format!("`--{}`", option.name)).collect();
        format!("| `{}` | {} | {} |", row.name, row.help, options.join(", "))
    });
    check_table("docs/methods.md", "| `--method` |", rows);
}

#[test]
fn every_option_of_a_method_has_its_row() {
    let rows = OPTIONS.iter().map(|option| {
        let flag = format!("--{} {}", option.name, option.value);
        let command = match option.command {
            "" => String::new(),
            command => format!("`:{command}`"),
        };
        let default = (option.get)(&TraceOptions::default());
        format!("| `{}` | {command} | {default} | {} |", cell(flag.trim()), option.help)
    });
    check_table("docs/methods.md", "| option | at the prompt |", rows);
}

#[test]
fn every_command_of_the_prompt_has_its_row() {
    let rows = COMMANDS.iter().map(|row| format!("| `{}` | {} |", cell(&row.usage()), row.doc));
    check_table("docs/window.md", "| command | meaning |", rows);
}

#[test]
fn every_setting_of_a_picture_has_its_rows() {
    let flags = settings().filter(|row| !row.flag.is_empty());
    let rows = flags.map(|row| format!("| `--{}` | {} |", row.flag, row.flag_help()));
    check_table("docs/command-line.md", "| flag of the picture |", rows);
    let lines = settings().filter(|row| row.is_line);
    let rows = lines
        .map(|row| format!("| `{} {}` | {}: {} |", row.word, row.example, row.help, row.values));
    check_table("docs/language.md", "| line of the picture |", rows);
    for row in settings() {
        if let Values::Number { on: Some(on), .. } = row.values {
            assert!(text("docs/language.md").contains(&format!("`{}` alone is {on}", row.word)));
        }
    }
}

#[test]
fn every_other_system_has_its_row() {
    let rows = zeroset_live::EQUIVALENTS.iter();
    let rows = rows.map(|(from, there, here)| format!("| {from} | `{there}` | {here} |"));
    check_table("docs/language.md", "| coming from |", rows);
}

#[test]
fn every_look_and_every_color_map_is_listed() {
    let rows = LOOKS.iter().map(|look| format!("| `{}` | {} |", look.name, look.help));
    check_table("docs/language.md", "| look | meaning |", rows);
    let text = text("docs/language.md");
    assert_eq!(list(&text, "Color maps"), COLOR_MAPS.map(|map| map.name));
}

#[test]
fn every_function_and_every_form_is_listed() {
    let native = zeroset_ops::TABLE.iter().map(|row| row.name);
    let native = native.filter(|name| zeroset_ops::native(name).is_some());
    let composed = zeroset_ops::COMPOSED.iter().map(|row| row.name);
    let mut expected: Vec<&str> = native.chain(composed).chain(["root"]).collect();
    expected.dedup();
    assert_eq!(list(&text("docs/language.md"), "Functions"), expected);
    let forms = zeroset_ops::FORMS.iter();
    let rows = forms.map(|form| format!("| `{}` | {} |", form.usage, form.doc));
    check_table("docs/language.md", "| form | meaning |", rows);
}

#[test]
fn every_builder_has_its_row() {
    let rows = zeroset_ops::BUILDERS.iter();
    let rows =
        rows.map(|row| format!("| `{}` | {} | {} |", row.usage, row.doc, row.distance.words()));
    check_table("docs/modeling.md", "| builder | meaning |", rows);
}

/// Examples of the language stand in fenced blocks marked `text`. In the README, each line is an
/// example.
#[test]
fn examples_of_the_language_read() {
    let blocks = |path: &str| -> Vec<String> {
        let text = text(path);
        let blocks = text.split("```text\n").skip(1);
        blocks.map(|block| block.split("```").next().unwrap_or_default().to_owned()).collect()
    };
    let read = |text: &str| {
        let read = zeroset_syntax::read(text, &zeroset_syntax::Options::default());
        let document = read.unwrap_or_else(|errors| panic!("{text}: {errors}"));
        assert!(document.drawn_surfaces().next().is_some(), "{text}");
    };
    let lines = blocks("README.md").concat();
    assert_eq!(lines.lines().count(), 10);
    lines.lines().for_each(read);
    for path in ["docs/language.md", "docs/modeling.md"] {
        let blocks = blocks(path);
        assert!(!blocks.is_empty());
        for block in &blocks {
            read(block);
        }
    }
}

/// README, ARCHITECTURE, CONTRIBUTING and the manual.
fn documents() -> Vec<PathBuf> {
    let directories = [root().to_owned(), root().join("docs")];
    let entries = directories.iter().flat_map(|directory| directory.read_dir().expect("there"));
    let paths = entries.map(|entry| entry.expect("readable").path());
    let documents: Vec<PathBuf> =
        paths.filter(|path| path.extension().is_some_and(|extension| extension == "md")).collect();
    assert!(documents.len() >= 12, "{documents:?}");
    documents
}

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    let heading = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || "- _".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn every_link_leads_somewhere() {
    for document in documents() {
        let text = fs::read_to_string(&document).expect("readable");
        for link in text.split("](").skip(1) {
            let link = link.split(')').next().unwrap_or_default();
            if link.starts_with("https:") {
                continue;
            }
            let (path, wanted) = link.split_once('#').unwrap_or((link, ""));
            let target = match path {
                "" => document.clone(),
                path => document.parent().expect("a directory").join(path),
            };
            assert!(target.exists(), "{}: {link}", document.display());
            if !wanted.is_empty() {
                let target = fs::read_to_string(&target).expect("readable");
                let mut headings = target.lines().filter(|line| line.starts_with('#'));
                let found = headings.any(|heading| anchor(heading) == wanted);
                assert!(found, "{}: {link}", document.display());
            }
        }
    }
}

#[test]
fn every_file_that_is_named_exists() {
    let mut named = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).expect("readable");
        for name in text.split('`').skip(1).step_by(2) {
            let is_path = ["crates/", "tests/", "src/", "benches/", "fuzz/"]
                .iter()
                .any(|directory| name.starts_with(directory) && !name.contains(' '));
            if is_path {
                named += 1;
                assert!(root().join(name).exists(), "{}: {name}", document.display());
            }
        }
    }
    assert!(named > 40, "{named}");
}

#[test]
fn functions_of_the_life_of_a_picture_are_where_it_says() {
    let text = text("ARCHITECTURE.md");
    let (_, table) = text.split_once("| step | function | file |\n").expect("the table");
    let rows: Vec<&str> = table.lines().skip(1).take_while(|row| row.starts_with('|')).collect();
    assert!(rows.len() > 10, "{rows:?}");
    for row in rows {
        let [_, function, file] = row.trim_matches('|').split('|').collect::<Vec<_>>()[..] else {
            panic!("{row}");
        };
        let [function, file] = [function, file].map(|cell| cell.trim().trim_matches('`'));
        let source = fs::read_to_string(root().join(file)).expect(file);
        let defines = |opening: char| source.contains(&format!("fn {function}{opening}"));
        assert!(defines('(') || defines('<'), "{row}");
    }
}
