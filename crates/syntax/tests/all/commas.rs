//! Checks commas between numbers: each row of the corpus is read as it was meant, or is refused.

use crate::words::{Row, points, rows, wrong};
use std::fmt::Write as _;
use zeroset_parser::NoteKind;
use zeroset_syntax::{Document, Options, read};

/// The lines about the picture and the sliders of a document, as text.
fn settings(document: &Document) -> String {
    let colors = document.surfaces.iter().map(|one| format!("{:?} {}", one.color, one.opacity));
    let parameters = document.parameters.iter().map(|one| (&one.name, &one.value, &one.range));
    let text = format!(
        "{:?} {:?} {:?} {:?} {:?} {:?}",
        document.domain,
        document.view,
        document.picture,
        document.title,
        colors.collect::<Vec<_>>(),
        parameters.collect::<Vec<_>>(),
    );
    // Places differ from text to text.
    let mut pieces = text.split("Span {");
    let mut kept = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        kept += piece.split_once('}').map_or(piece, |(_, rest)| rest);
    }
    kept
}

/// Describes how a row is read otherwise than it says, if it is.
fn misread(row: &Row) -> Option<String> {
    if let Some(what) = wrong(row, &points()) {
        return Some(what);
    }
    let document = read(&row.text, &Options::default()).ok()?;
    let decimal = |kind: &NoteKind| matches!(kind, NoteKind::DecimalComma { .. });
    let is_decimal = document.notes.iter().any(|note| decimal(&note.kind));
    if is_decimal != row.notes.iter().any(|note| note == "decimal") {
        return Some(format!("decimal commas: {is_decimal}"));
    }
    let doubtful = |kind: &NoteKind| matches!(kind, NoteKind::DoubtfulComma { .. });
    let doubts = document.notes.iter().filter(|note| doubtful(&note.kind)).count();
    if doubts != row.notes.iter().filter(|note| note.contains("two values")).count() {
        return Some(format!("{doubts} doubtful commas: {:?}", document.notes));
    }
    let meant = read(&row.meant, &Options::default()).ok()?;
    let (own, other) = (settings(&document), settings(&meant));
    (own != other).then(|| format!("settings\n{own}\nnot\n{other}"))
}

#[test]
fn commas_separate_or_are_decimal_in_the_whole_text() {
    let rows = rows("commas.txt");
    let refused = |row: &&Row| row.message.is_some();
    let decimal = rows.iter().position(|row| row.notes.iter().any(|note| note == "decimal"));
    let (lists, decimals) = rows.split_at(decimal.expect("decimal commas"));
    assert!(lists.len() >= 100 && decimals.len() >= 30, "{} and {}", lists.len(), decimals.len());
    assert!(lists.iter().filter(refused).count() * 8 <= lists.len(), "most are read");
    let mut report = String::new();
    for row in &rows {
        if let Some(what) = misread(row) {
            writeln!(report, "{}\n{}\n{what}\n", row.place, row.text).unwrap();
        }
    }
    assert!(report.is_empty(), "{report}");
}

/// Places in the text stay, whichever reading counts.
#[test]
fn a_decimal_comma_moves_nothing() {
    let text = "# Radius 0,5\nx = 0,25; y = 1,5";
    let document = read(text, &Options::default()).expect("decimal commas");
    let typed = |surface: &zeroset_syntax::Surface| &text[surface.span.range()];
    let surfaces: Vec<&str> = document.surfaces.iter().map(typed).collect();
    assert_eq!(surfaces, ["x = 0,25", "y = 1,5"]);
    assert_eq!(document.title.as_deref(), Some("Radius 0,5"));
    let notes: Vec<&str> = document.notes.iter().map(|note| &text[note.span.range()]).collect();
    assert_eq!(notes, ["0,25", "1,5"]);
}
