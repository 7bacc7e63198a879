//! Completion and coloring of a line that is being typed. Knows no terminal and no window.

use std::ops::Range;
use zeroset_live::COMMANDS;
use zeroset_scene::gallery;
use zeroset_syntax::{WordKind, words};

/// Returns the start of the word that ends at `pos`.
fn word_start(line: &str, pos: usize) -> usize {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    line[..pos].char_indices().rev().take_while(|(_, c)| part(*c)).last().map_or(pos, |(at, _)| at)
}

/// Returns the start of the word that ends at `pos`, with the possible completions of that word.
pub fn candidates(line: &str, pos: usize) -> (usize, Vec<String>) {
    let head = &line[..pos];
    if let Some(rest) = head.trim_start().strip_prefix(':') {
        let start = pos - rest.len();
        if !rest.contains(' ') {
            let names = COMMANDS.iter().map(|row| row.name).filter(|name| name.starts_with(rest));
            return (start, names.map(str::to_owned).collect());
        }
        if let Some((_, name)) = rest.split_once(' ').filter(|(command, _)| *command == "load") {
            let known = gallery::all().into_iter();
            let slugs = known.map(|example| example.slug.to_owned());
            let found = slugs.filter(|slug| slug.starts_with(name)).collect();
            return (pos - name.len(), found);
        }
    }
    let start = word_start(line, pos);
    let word = &line[start..pos];
    if word.is_empty() {
        return (start, Vec::new());
    }
    let place = WordPosition::of(line, start);
    let mut names: Vec<String> = words()
        .filter(|(name, kind)| name.starts_with(word) && place.takes(*kind))
        .map(|(name, _)| name.to_owned())
        .collect();
    names.sort();
    names.dedup();
    (start, names)
}

/// Position of a word in its statement.
#[derive(Clone, Copy)]
struct WordPosition {
    begins: bool,
    /// Whether the word follows a setting, such as `view` or `color`, in the same statement.
    in_setting: bool,
}

impl WordPosition {
    /// The position in its statement of the word that begins at byte `start` of `line`.
    fn of(line: &str, start: usize) -> Self {
        let head = &line[..start];
        let statement = head[head.rfind(['\n', ';']).map_or(0, |at| at + 1)..].trim_start();
        let first = statement.split(|c: char| !c.is_alphabetic()).next().unwrap_or("");
        let behind = statement[first.len()..].trim_start();
        // A text may define a setting's name as a value: `light = 3` is an ordinary definition.
        let sets = behind.starts_with(['=', '*', '/', '^', '<', '>']) && !behind.is_empty();
        let begins = statement.is_empty();
        let in_setting = !begins && !sets && words().any(|word| word == (first, WordKind::Setting));
        Self { begins, in_setting }
    }

    fn takes(self, kind: WordKind) -> bool {
        match kind {
            WordKind::Setting | WordKind::Drawing => self.begins,
            WordKind::InSetting => self.in_setting,
            WordKind::Function | WordKind::Value | WordKind::Operator | WordKind::Program => true,
        }
    }
}

/// Kind of a colored part of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenClass {
    Number,
    Word(WordKind),
    Comment,
}

/// Returns the colored parts of a line, in order.
pub fn token_classes(line: &str) -> Vec<(Range<usize>, TokenClass)> {
    let mut found = Vec::new();
    let mut start = 0;
    while let Some(first) = line[start..].chars().next() {
        let rest = &line[start..];
        let upto = |part: &dyn Fn(char) -> bool| rest.find(|c| !part(c)).unwrap_or(rest.len());
        let is_digit = |c: char| c.is_ascii_digit();
        let (length, class) = if first == '#' && !rest.starts_with("#define") {
            (upto(&|c| c != '\n'), Some(TokenClass::Comment))
        } else if is_digit(first) || first == '.' && rest[1..].starts_with(is_digit) {
            (upto(&|c| is_digit(c) || c == '.'), Some(TokenClass::Number))
        } else if first.is_alphabetic() || first == '_' {
            let length = upto(&|c| c.is_alphanumeric() || c == '_');
            let place = WordPosition::of(line, start);
            let kinds: Vec<WordKind> = words()
                .filter(|(name, kind)| *name == &rest[..length] && place.takes(*kind))
                .map(|(_, kind)| kind)
                .collect();
            // The meaning inside a setting has priority: in `view top`, `top` names a side.
            let within = kinds.contains(&WordKind::InSetting).then_some(WordKind::InSetting);
            (length, within.or(kinds.first().copied()).map(TokenClass::Word))
        } else {
            (first.len_utf8(), None)
        };
        found.extend(class.map(|class| (start..start + length, class)));
        start += length;
    }
    found
}

/// Whether a bracket of the text is still open, so that another line has to follow.
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
    depth > 0 && !text.trim_start().starts_with(':') && abandoned_formula(text).is_none()
}

/// Splits a text into an unfinished formula and the command on its last line. The command shows
/// that the formula was abandoned. Returns `None` for any other text.
pub fn abandoned_formula(text: &str) -> Option<(&str, &str)> {
    let (above, last) = text.trim_end().rsplit_once('\n')?;
    let name = last.trim_start().strip_prefix(':')?.split_whitespace().next()?;
    let is_command = COMMANDS.iter().any(|row| row.name == name);
    (is_command && is_open(above)).then_some((above, last))
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

    /// Returns the start of a line in which a word of this kind may come next.
    fn before(kind: WordKind) -> &'static str {
        match kind {
            WordKind::Setting | WordKind::Drawing | WordKind::Program => "",
            WordKind::InSetting => "view ",
            WordKind::Function | WordKind::Value | WordKind::Operator => "x + ",
        }
    }

    #[test]
    fn every_word_completes_and_is_colored_as_what_it_is() {
        let mut count = 0;
        for (word, kind) in words() {
            let before = before(kind);
            let line = format!("{before}{word}");
            for shorter in [1, word.len() / 2 + 1, word.len()] {
                let typed = &line[..before.len() + shorter.min(word.len())];
                let (start, names) = candidates(typed, typed.len());
                assert_eq!(start, before.len(), "{typed}");
                assert!(names.iter().any(|name| name == word), "{typed}: no {word} in {names:?}");
            }
            let (place, class) = token_classes(&line).pop().expect("a word is colored");
            assert_eq!(&line[place], word);
            let other = |class: TokenClass| {
                words().any(|(name, kind)| name == word && class == TokenClass::Word(kind))
            };
            assert!(
                class == TokenClass::Word(kind) || other(class),
                "{line}: {class:?}, not {kind:?}"
            );
            count += 1;
        }
        assert!(count > 150, "{count} words");
    }

    #[test]
    fn parts_of_a_line_are_told_apart() {
        let told = |line: &str| -> Vec<(String, TokenClass)> {
            let all = token_classes(line).into_iter();
            all.map(|(place, class)| (line[place].to_owned(), class)).collect()
        };
        let word = |word: &str, kind| (word.to_owned(), TokenClass::Word(kind));
        assert_eq!(
            told("vec3(x, .5, log10(y)).zx # sin"),
            [
                word("vec3", WordKind::Function),
                word("x", WordKind::Value),
                (".5".to_owned(), TokenClass::Number),
                word("log10", WordKind::Function),
                word("y", WordKind::Value),
                ("# sin".to_owned(), TokenClass::Comment),
            ]
        );
        assert_eq!(
            told("contours z, 2; light = 3"),
            [
                word("contours", WordKind::Setting),
                word("z", WordKind::Value),
                ("2".to_owned(), TokenClass::Number),
                word("light", WordKind::Setting),
                ("3".to_owned(), TokenClass::Number),
            ]
        );
        assert_eq!(
            told("view top"),
            [word("view", WordKind::Setting), word("top", WordKind::InSetting)]
        );
        // A word that has a meaning only in settings is a plain name elsewhere.
        assert_eq!(told("top + looks"), []);
    }

    #[test]
    fn open_brackets_ask_for_another_line() {
        assert!(is_open("max(x,"));
        assert!(is_open("x = 1 {y > 0,\n"));
        assert!(is_open("max(x > 0 ? y\n: z,") && is_open("max(x > 0 ? y\n:z,"));
        assert_eq!(abandoned_formula("max(x,\n:quit"), Some(("max(x,", ":quit")));
        assert_eq!(
            abandoned_formula("max(x,\ny,\n :help sin\n"),
            Some(("max(x,\ny,", " :help sin"))
        );
        assert!(!is_open("max(x,\n:quit") && abandoned_formula("x = 1\n:quit").is_none());
        assert!(
            !is_open("max(x,\ny)") && !is_open("x # (") && !is_open(":help (") && !is_open(")")
        );
    }
}
