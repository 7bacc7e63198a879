//! Messages for wrong lines say what a teacher would say.

use zeroset_syntax::{Options, read};

struct Row {
    text: String,
    hint: String,
    /// Pieces of a good message. One is enough.
    pieces: Vec<String>,
}

fn rows() -> Vec<Row> {
    let path = format!("{}/../../tests/data/hints.txt", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the corpus is there");
    let mut rows = Vec::new();
    for block in text.split("\n\n") {
        let lines = |sign: char| -> Vec<String> {
            let all = block.lines().filter_map(|line| line.strip_prefix(sign));
            all.map(|line| line.strip_prefix(' ').unwrap_or(line).to_owned()).collect()
        };
        let (text, pieces) = (lines('>').join("\n"), lines('*'));
        if !text.is_empty() {
            rows.push(Row { text, hint: lines('?').join("\n"), pieces });
        }
    }
    rows
}

/// The messages for a text, without the text itself.
fn messages(text: &str) -> String {
    let unquoted = |rendered: String| -> String {
        let is_quoted = |line: &&str| text.lines().any(|own| !own.is_empty() && line.contains(own));
        rendered.lines().filter(|line| !is_quoted(line)).collect::<Vec<_>>().join("\n")
    };
    match read(text, &Options::default()) {
        Ok(document) => {
            let notes = document.notes.iter().map(|note| note.message());
            unquoted(notes.collect::<Vec<_>>().join("\n"))
        }
        Err(errors) => unquoted(errors.render(None, text, false)),
    }
}

/// As many rows have a good message as when this was written, at least. Commands at the prompt are
/// not asked here.
#[test]
fn wrong_lines_get_the_hints_of_a_teacher() {
    let without_blanks = |text: &str| text.replace(char::is_whitespace, "");
    let (mut good, mut asked) = (0, 0);
    for Row { text, hint, pieces } in rows().iter().filter(|row| !row.text.starts_with(':')) {
        let said = messages(text);
        asked += 1;
        let plain = without_blanks(&said);
        if pieces.iter().any(|piece| plain.contains(&without_blanks(piece))) {
            good += 1;
        } else {
            println!("{text}\n  wanted {hint}\n  {}", said.replace('\n', "\n  "));
        }
    }
    println!("{good} of {asked}");
    assert!(asked > 150 && good >= 192, "{good} of {asked}");
}
