//! The line that is typed in the window: text, cursor, selection, undo, history, completion. Knows
//! no keys.

use super::completion::candidates;
use std::ops::Range;

/// Greatest number of steps that can be undone.
const MAX_STEPS: usize = 200;

/// A direction and distance of the cursor's movement.
#[derive(Clone, Copy, PartialEq)]
pub enum Motion {
    Left,
    Right,
    WordLeft,
    WordRight,
    Home,
    End,
}

/// A line, the cursor in it, and the selected part.
#[derive(Clone, Debug, Default)]
pub struct LineEdit {
    text: String,
    cursor: usize,
    /// The other end of the selection. It equals the cursor if nothing is selected.
    anchor: usize,
    /// Number of history lines stepped back, counted from the newest. 0 if none is shown.
    back: usize,
    /// Earlier texts with their cursors, the latest last.
    past: Vec<(String, usize)>,
    /// Undone texts with their cursors, the next one last.
    future: Vec<(String, usize)>,
    /// Whether the last change inserted a letter. Letters of a word are one step of undo.
    is_typing: bool,
}

impl From<String> for LineEdit {
    fn from(text: String) -> Self {
        Self { cursor: text.len(), anchor: text.len(), text, ..Self::default() }
    }
}

impl LineEdit {
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The cursor's position, in bytes.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// The selected part, in bytes. Empty if nothing is selected.
    pub fn selection(&self) -> Range<usize> {
        self.cursor.min(self.anchor)..self.cursor.max(self.anchor)
    }

    /// The selected text.
    pub fn selected(&self) -> &str {
        &self.text[self.selection()]
    }

    pub fn insert(&mut self, letter: char) {
        let goes_on = self.is_typing && letter != ' ' && self.selection().is_empty();
        if !goes_on {
            self.remember();
        }
        self.replace(letter.encode_utf8(&mut [0; 4]));
        self.is_typing = true;
    }

    /// Inserts a text in place of the selection. Control characters become spaces.
    pub fn insert_text(&mut self, text: &str) {
        self.remember();
        let plain: String =
            text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
        self.replace(&plain);
    }

    /// Moves the cursor. With `select`, the text that it passes is selected.
    pub fn step(&mut self, motion: Motion, select: bool) {
        let selection = self.selection();
        let ends_selection = !select && !selection.is_empty();
        self.cursor = match motion {
            Motion::Left if ends_selection => selection.start,
            Motion::Right if ends_selection => selection.end,
            _ => self.target(motion),
        };
        self.is_typing = false;
        if !select {
            self.anchor = self.cursor;
        }
    }

    /// Moves the cursor to a position in bytes.
    pub fn step_to(&mut self, position: usize, select: bool) {
        self.cursor = self.text.floor_char_boundary(position);
        self.is_typing = false;
        if !select {
            self.anchor = self.cursor;
        }
    }

    pub fn select_all(&mut self) {
        (self.anchor, self.cursor) = (0, self.text.len());
    }

    /// Removes the selection, or else the letter before the cursor.
    pub fn backspace(&mut self) {
        self.remove(Motion::Left);
    }

    /// Removes the selection, or else the letter after the cursor.
    pub fn delete(&mut self) {
        self.remove(Motion::Right);
    }

    /// Removes the selection, or else the text from the cursor to where `motion` leads.
    pub fn remove(&mut self, motion: Motion) {
        if self.selection().is_empty() {
            self.anchor = self.target(motion);
        }
        if !self.selection().is_empty() {
            self.remember();
            self.replace("");
        }
    }

    /// Takes back the last change. Returns whether there was one.
    pub fn undo(&mut self) -> bool {
        let Some((text, cursor)) = self.past.pop() else { return false };
        self.future.push((std::mem::replace(&mut self.text, text), self.cursor));
        (self.cursor, self.anchor, self.is_typing) = (cursor, cursor, false);
        true
    }

    /// Makes the last undone change again. Returns whether there was one.
    pub fn redo(&mut self) -> bool {
        let Some((text, cursor)) = self.future.pop() else { return false };
        self.past.push((std::mem::replace(&mut self.text, text), self.cursor));
        (self.cursor, self.anchor, self.is_typing) = (cursor, cursor, false);
        true
    }

    /// Replaces the text by the next older or next newer line of the history. After the newest
    /// line, the text is empty.
    pub fn recall(&mut self, history: &[String], older: bool) {
        self.remember();
        self.back =
            if older { (self.back + 1).min(history.len()) } else { self.back.saturating_sub(1) };
        self.text = match self.back {
            0 => String::new(),
            back => history[history.len() - back].clone(),
        };
        (self.cursor, self.anchor) = (self.text.len(), self.text.len());
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
        self.remember();
        self.anchor = start;
        self.replace(common);
        if names.len() > 1 { names } else { Vec::new() }
    }

    /// Keeps the present text for undo.
    fn remember(&mut self) {
        if self.past.len() == MAX_STEPS {
            self.past.remove(0);
        }
        self.past.push((self.text.clone(), self.cursor));
        self.future.clear();
        self.is_typing = false;
    }

    /// Replaces the selection, and puts the cursor behind the new text.
    fn replace(&mut self, text: &str) {
        let selection = self.selection();
        self.cursor = selection.start + text.len();
        self.anchor = self.cursor;
        self.text.replace_range(selection, text);
    }

    /// The position to which a movement leads.
    fn target(&self, motion: Motion) -> usize {
        let (before, after) = self.text.split_at(self.cursor);
        let is_word = |letter: char| letter.is_alphanumeric() || letter == '_';
        match motion {
            Motion::Left => before.char_indices().next_back().map_or(0, |(at, _)| at),
            Motion::Right => self.cursor + after.chars().next().map_or(0, char::len_utf8),
            Motion::WordLeft => {
                let end = before.trim_end_matches(|letter| !is_word(letter));
                end.trim_end_matches(is_word).len()
            }
            Motion::WordRight => {
                let rest = after.trim_start_matches(|letter| !is_word(letter));
                self.text.len() - rest.trim_start_matches(is_word).len()
            }
            Motion::Home => 0,
            Motion::End => self.text.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(text: &str) -> LineEdit {
        let mut line = LineEdit::default();
        text.chars().for_each(|letter| line.insert(letter));
        line
    }

    #[test]
    fn letters_go_where_the_cursor_is() {
        let mut line = typed("x²+y");
        line.step(Motion::Left, false);
        line.step(Motion::Left, false);
        line.backspace();
        line.insert('³');
        assert_eq!((line.text(), line.cursor()), ("x³+y", 3));
        line.step(Motion::Home, false);
        line.step(Motion::Left, false);
        line.delete();
        line.step(Motion::End, false);
        line.step(Motion::Right, false);
        line.delete();
        assert_eq!((line.text(), line.cursor()), ("³+y", 4));
    }

    #[test]
    fn a_selection_is_replaced_and_taken_out() {
        let mut line = typed("sin x + cos y");
        line.step(Motion::WordLeft, true);
        line.step(Motion::WordLeft, true);
        assert_eq!(line.selected(), "cos y");
        line.insert_text("a\nb");
        assert_eq!((line.text(), line.selected()), ("sin x + a b", ""));
        line.select_all();
        line.step(Motion::Left, false);
        assert_eq!(line.cursor(), 0);
        line.step(Motion::WordRight, true);
        line.backspace();
        assert_eq!((line.text(), line.cursor()), (" x + a b", 0));
        line.select_all();
        line.insert('z');
        assert_eq!(line.text(), "z");
    }

    #[test]
    fn typing_is_undone_word_by_word_and_done_again() {
        let mut line = typed("ab cd");
        line.backspace();
        for expected in ["ab cd", "ab", ""] {
            assert!(line.undo());
            assert_eq!(line.text(), expected);
        }
        assert!(!line.undo());
        for expected in ["ab", "ab cd", "ab c"] {
            assert!(line.redo());
            assert_eq!(line.text(), expected);
        }
        assert!(!line.redo() && line.undo());
        line.insert('!');
        assert!(!line.redo());
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
        let mut line = typed(":s");
        assert_eq!(line.complete(), ["show", "set", "shadows", "steps", "save", "status"]);
    }
}
