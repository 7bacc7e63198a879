//! The line that is typed in the window: text, cursor, history, completion. Knows no keys.

use super::completion::candidates;

/// A line and the cursor in it.
#[derive(Clone, Debug, Default)]
pub struct LineEdit {
    text: String,
    cursor: usize,
    /// Number of history lines stepped back, counted from the newest. 0 if none is shown.
    back: usize,
}

impl From<String> for LineEdit {
    fn from(text: String) -> Self {
        Self { cursor: text.len(), text, back: 0 }
    }
}

impl LineEdit {
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Position of the cursor, in characters.
    pub fn column(&self) -> usize {
        self.text[..self.cursor].chars().count()
    }

    pub fn insert(&mut self, letter: char) {
        self.text.insert(self.cursor, letter);
        self.cursor += letter.len_utf8();
    }

    pub fn left(&mut self) {
        self.cursor = self.text[..self.cursor].char_indices().next_back().map_or(0, |(at, _)| at);
    }

    pub fn right(&mut self) {
        self.cursor += self.text[self.cursor..].chars().next().map_or(0, char::len_utf8);
    }

    pub fn home(&mut self) {
        self.cursor = 0;
    }

    pub fn end(&mut self) {
        self.cursor = self.text.len();
    }

    pub fn backspace(&mut self) {
        if self.cursor > 0 {
            self.left();
            self.text.remove(self.cursor);
        }
    }

    pub fn delete(&mut self) {
        if self.cursor < self.text.len() {
            self.text.remove(self.cursor);
        }
    }

    /// Replaces the text by the next older or next newer line of the history. After the newest
    /// line, the text is empty.
    pub fn recall(&mut self, history: &[String], older: bool) {
        self.back =
            if older { (self.back + 1).min(history.len()) } else { self.back.saturating_sub(1) };
        self.text = match self.back {
            0 => String::new(),
            back => history[history.len() - back].clone(),
        };
        self.end();
    }

    /// Completes the word at the cursor up to the first letter in which the candidates differ.
    /// Returns the candidates if there are several.
    pub fn complete(&mut self) -> Vec<String> {
        let (start, names) = candidates(&self.text, self.cursor);
        let Some(first) = names.first() else { return names };
        let common = names.iter().fold(first.as_str(), |common, name| {
            let same = common.chars().zip(name.chars()).take_while(|(a, b)| a == b);
            &common[..same.map(|(a, _)| a.len_utf8()).sum()]
        });
        self.text.replace_range(start..self.cursor, common);
        self.cursor = start + common.len();
        if names.len() > 1 { names } else { Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_where_the_cursor_is() {
        let mut line = LineEdit::default();
        "x²+y".chars().for_each(|letter| line.insert(letter));
        line.left();
        line.left();
        line.backspace();
        line.insert('³');
        assert_eq!((line.text(), line.column()), ("x³+y", 2));
        line.home();
        line.left();
        line.delete();
        line.end();
        line.right();
        line.delete();
        assert_eq!((line.text(), line.column()), ("³+y", 3));
    }

    #[test]
    fn history_is_walked_and_words_completed() {
        let history = ["a".to_owned(), "b".to_owned()];
        let mut line = LineEdit::default();
        for expected in ["b", "a", "a"] {
            line.recall(&history, true);
            assert_eq!(line.text(), expected);
        }
        line.recall(&history, false);
        assert_eq!(line.text(), "b");
        line.recall(&history, false);
        "smooths".chars().for_each(|letter| line.insert(letter));
        assert_eq!(line.complete(), Vec::<String>::new());
        assert_eq!(line.text(), "smoothstep");
        let mut line = LineEdit::default();
        ":s".chars().for_each(|letter| line.insert(letter));
        assert_eq!(line.complete(), ["show", "set", "shadows", "steps", "save", "status"]);
    }
}
