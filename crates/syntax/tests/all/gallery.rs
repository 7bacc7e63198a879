//! Checks that each example file is read without an error, draws one surface, uses all its
//! definitions, and has a title and a domain.

use zeroset_parser::{Note, NoteKind};
use zeroset_syntax::{Options, read};

#[test]
fn every_example_reads() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).expect("the examples are there") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "zset") {
            continue;
        }
        count += 1;
        let name = path.display().to_string();
        let text = std::fs::read_to_string(&path).expect("a text");
        let document = read(&text, &Options::default())
            .unwrap_or_else(|errors| panic!("{}", errors.render(Some(&name), &text, false)));
        assert_eq!(document.surfaces.len(), 1, "{name}");
        let unused = |note: &&Note| matches!(note.kind, NoteKind::Unused { .. });
        assert_eq!(document.notes.iter().find(unused), None, "{name}");
        assert!(document.title.is_some() && document.domain.is_some(), "{name}");
    }
    assert!(count >= 65, "{count} examples");
}
