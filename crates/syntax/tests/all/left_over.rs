//! Checks that notes name each argument, option and line that has no effect, and no other.

use crate::words::{Row, points, rows, wrong};
use std::fmt::Write as _;
use zeroset_parser::NoteKind;
use zeroset_syntax::{Options, read};

/// Describes how a row is read otherwise than it says, if it is.
fn misread(row: &Row) -> Option<String> {
    if let Some(what) = wrong(row, &points()) {
        return Some(what);
    }
    let document = read(&row.text, &Options::default()).ok()?;
    let is_note_on_rest = |kind: &NoteKind| {
        matches!(
            kind,
            NoteKind::PlotPartsLeftOut { .. }
                | NoteKind::PlotWithoutLevel
                | NoteKind::PlotDomainLeftOut { .. }
                | NoteKind::ContainerIgnored
                | NoteKind::FileLeftOut { .. }
                | NoteKind::ShapeAtZero { .. }
                | NoteKind::StyleLeftOut { .. }
                | NoteKind::Unused { .. }
        )
    };
    let given = document.notes.iter().filter(|note| is_note_on_rest(&note.kind)).count();
    (given != row.notes.len()).then(|| format!("{given} notes: {:?}", document.notes))
}

#[test]
fn whatever_is_given_is_used_or_said() {
    let mut report = String::new();
    for row in rows("left_over.txt") {
        if let Some(what) = misread(&row) {
            writeln!(report, "{}\n{}\n{what}\n", row.place, row.text).unwrap();
        }
    }
    assert!(report.is_empty(), "{report}");
}
