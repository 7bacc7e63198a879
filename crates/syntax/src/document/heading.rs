//! Reads the comment at the start of a document.

/// The title, which is the comment's first line, and the comment's other lines.
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
