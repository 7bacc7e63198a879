//! What the README says of tables in the code.

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
            row.reads.iter().map(|option| format!("`--{}`", option.name())).collect();
        format!("| `{}` | {} | {} |", row.name, row.help, options.join(", "))
    });
    assert_eq!(rows, expected.collect::<Vec<_>>());
}
