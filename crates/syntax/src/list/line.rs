//! Splits an expression list into lines and words, and recognizes a list by its first line.

use crate::list::opcode::opcode;
use zeroset_parser::Span;
use zeroset_parser::lex::spelling::typed_setting;

/// A line of a list, with its place in the text.
#[derive(Clone, Copy)]
pub(crate) struct Line<'a> {
    text: &'a str,
    start: usize,
    /// Number of the line, counted from 1.
    pub number: usize,
}

/// The lines of a text that hold words, without byte order mark and without comments.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let mut start = 0;
    let all = text.split_inclusive('\n').enumerate().map(move |(index, line)| {
        let begin = start;
        start += line.len();
        let kept = if index == 0 { line.trim_start_matches('\u{FEFF}') } else { line };
        Line { text: kept, start: begin + (line.len() - kept.len()), number: index + 1 }
    });
    all.filter(|line| line.words().next().is_some())
}

impl<'a> Line<'a> {
    /// The words before a comment, each with its place. A comment begins a word with `#`.
    pub fn words(self) -> impl Iterator<Item = (&'a str, Span)> {
        let words = self.text.split_whitespace().take_while(|word| !word.starts_with('#'));
        words.map(move |word| {
            let start = self.start + (word.as_ptr().addr() - self.text.as_ptr().addr());
            (word, Span::new(start, start + word.len()))
        })
    }

    /// The place of the line from its first word to the end of its last one.
    pub fn span(self) -> Span {
        let mut words = self.words().map(|(_, span)| span);
        let first = words.next().unwrap_or(Span::at(self.start));
        words.fold(first, Span::to)
    }

    /// The whole line, with its line break.
    pub fn range(self) -> std::ops::Range<usize> {
        self.start..self.start + self.text.len()
    }

    /// Returns whether the line is about the picture: it begins with a word such as `domain`, and
    /// no operation follows.
    pub fn is_setting(self) -> bool {
        let mut words = self.words().map(|(word, _)| word);
        let first = words.next().unwrap_or_default();
        words.next().is_none_or(|word| opcode(word).is_none()) && typed_setting(first).is_some()
    }
}

/// Returns whether a text is an expression list, by its first line that is not about the picture.
///
/// The first line of a list defines a constant or a coordinate, since no other value exists yet.
/// A line such as `_0 ad _1 _2`, with a name that formulas cannot have, is a list with an error.
pub(crate) fn is_list(text: &str) -> bool {
    let first = lines(text).find(|line| !line.is_setting());
    let Some(line) = first else { return false };
    let mut words = line.words().map(|(word, _)| word);
    let (Some(name), Some(operation)) = (words.next(), words.next()) else { return false };
    let is_numbered = || {
        let number = name.strip_prefix('_').unwrap_or_default();
        !number.is_empty()
            && number.bytes().all(|byte| byte.is_ascii_hexdigit())
            && operation.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-')
    };
    operation == "const" || operation.starts_with("var-") || is_numbered()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_told_from_formulas() {
        for list in [
            "_0 const 1",
            "\u{FEFF}# title\r\n\r\n_0 const 2.95\r\n",
            "  a   var-x  # the first",
            "domain 2\ncolor red\nx var-y",
            "_1a ad _0 _0",
            "f var-w",
            "a const",
        ] {
            assert!(is_list(list), "{list}");
        }
        for formula in [
            "",
            "# no more",
            "domain 3",
            "x",
            "x y",
            "a sin x",
            "_0 = 3",
            "k = 2\n_0 const 1",
            "_0 + 1",
            "x - var",
            "const x = 3",
        ] {
            assert!(!is_list(formula), "{formula}");
        }
    }

    #[test]
    fn words_have_their_places() {
        let text = "\u{FEFF}a  const 1\r\n\n # no\n\u{a0}b add a a#1 # c";
        let found: Vec<(usize, Vec<&str>)> = lines(text)
            .map(|line| (line.number, line.words().map(|(_, span)| &text[span.range()]).collect()))
            .collect();
        assert_eq!(found, [(1, vec!["a", "const", "1"]), (4, vec!["b", "add", "a", "a#1"])]);
        let pieces: Vec<&str> = lines(text).map(|line| &text[line.range()]).collect();
        assert_eq!(pieces, ["a  const 1\r\n", "\u{a0}b add a a#1 # c"]);
    }
}
