//! The comment that a text starts with. Nothing is known of statements.

/// The title and text of the comment that a document starts with.
pub(crate) fn heading(text: &str) -> (Option<String>, String) {
    let mut lines = text
        .trim_start_matches('\u{FEFF}')
        .lines()
        .skip_while(|line| line.trim().is_empty())
        .map_while(|line| line.trim().strip_prefix('#'))
        .map(|line| line.trim_start_matches('#').trim().to_owned());
    let title = lines.next().filter(|title| !title.is_empty());
    let doc: Vec<String> = lines.collect();
    (title, doc.join("\n").trim().to_owned())
}
