//! What a line that is being typed can go on with. Knows no terminal and no window.

use zeroset::gallery;
use zeroset::live::COMMANDS;

/// Where the word begins that ends at `pos`.
fn word_start(line: &str, pos: usize) -> usize {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    line[..pos].char_indices().rev().take_while(|(_, c)| part(*c)).last().map_or(pos, |(at, _)| at)
}

/// What may stand where the line's last word does.
pub fn candidates(line: &str, pos: usize) -> (usize, Vec<String>) {
    let head = &line[..pos];
    if let Some(rest) = head.trim_start().strip_prefix(':') {
        let start = pos - rest.len();
        if !rest.contains(' ') {
            let names = COMMANDS.iter().map(|row| row.name).filter(|name| name.starts_with(rest));
            return (start, names.map(str::to_owned).collect());
        }
        if let Some((_, name)) = rest.split_once(' ').filter(|(command, _)| *command == "load") {
            let slugs = gallery::examples().into_iter().map(|example| example.slug.to_owned());
            let found = slugs.filter(|slug| slug.starts_with(name)).collect();
            return (pos - name.len(), found);
        }
    }
    let start = word_start(line, pos);
    let word = &line[start..pos];
    if word.is_empty() {
        return (start, Vec::new());
    }
    let mut names: Vec<String> = zeroset_syntax::language_names()
        .filter(|name| name.starts_with(word))
        .map(str::to_owned)
        .collect();
    names.sort();
    names.dedup();
    (start, names)
}

/// Whether a bracket is still open, so that another line is to come.
pub fn is_open(text: &str) -> bool {
    let code = text.lines().map(|line| line.split('#').next().unwrap_or(line));
    let depth: i64 = code
        .flat_map(str::chars)
        .map(|c| match c {
            '(' | '[' | '{' => 1,
            ')' | ']' | '}' => -1,
            _ => 0,
        })
        .sum();
    depth > 0 && !text.trim_start().starts_with(':')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_completed_where_they_stand() {
        assert_eq!(candidates(":sta", 4), (1, vec!["status".to_owned()]));
        assert_eq!(candidates(":load gyr", 9), (6, vec!["gyroid".to_owned()]));
        let (start, names) = candidates("x + smooth", 10);
        assert!(start == 4 && names.contains(&"smoothstep".to_owned()), "{names:?}");
        assert_eq!(candidates("x + ", 4).1, Vec::<String>::new());
        assert_eq!(candidates("é²x", 5).0, 0);
    }

    #[test]
    fn open_brackets_ask_for_another_line() {
        assert!(is_open("max(x,"));
        assert!(is_open("x = 1 {y > 0,\n"));
        assert!(
            !is_open("max(x,\ny)") && !is_open("x # (") && !is_open(":help (") && !is_open(")")
        );
    }
}
