//! Checks the README against tables in the code.

use std::fs;
use std::path::Path;
use zeroset_trace::METHODS;

#[test]
fn every_method_has_its_row() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = fs::read_to_string(path).expect("readable");
    let rows: Vec<&str> = readme
        .lines()
        .skip_while(|line| !line.starts_with("| `--method` |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .collect();
    let expected = METHODS.iter().map(|row| {
        let options: Vec<String> =
            row.reads.iter().map(|option| format!("`--{}`", option.name)).collect();
        format!("| `{}` | {} | {} |", row.name, row.help, options.join(", "))
    });
    assert_eq!(rows, expected.collect::<Vec<_>>());
}

#[test]
fn what_is_written_elsewhere_has_its_row() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = fs::read_to_string(path).expect("readable");
    let rows: Vec<&str> = readme
        .lines()
        .skip_while(|line| !line.starts_with("| coming from |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .collect();
    let expected = zeroset_live::EQUIVALENTS
        .iter()
        .map(|(from, there, here)| format!("| {from} | `{there}` | {here} |"));
    assert_eq!(rows, expected.collect::<Vec<_>>());
}

#[test]
fn every_function_and_every_form_is_listed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md");
    let readme = fs::read_to_string(path).expect("readable");
    let (_, list) = readme.split_once("Functions: `").expect("a list of functions");
    let (list, _) = list.split_once('`').expect("its end");
    let listed: Vec<&str> = list.split_whitespace().collect();
    let native = zeroset_ops::TABLE.iter().map(|row| row.name);
    let native = native.filter(|name| zeroset_ops::native(name).is_some());
    let composed = zeroset_ops::COMPOSED.iter().map(|row| row.name);
    let mut expected: Vec<&str> = native.chain(composed).chain(["root"]).collect();
    expected.dedup();
    assert_eq!(listed, expected);
    let rows: Vec<&str> = readme
        .lines()
        .skip_while(|line| !line.starts_with("| what looks like a function |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .collect();
    let forms =
        zeroset_ops::FORMS.iter().map(|form| format!("| `{}` | {} |", form.usage, form.doc));
    assert_eq!(rows, forms.collect::<Vec<_>>());
}
