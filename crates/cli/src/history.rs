//! The latest lines entered in prompt and window. Reads and writes no files.

use std::collections::VecDeque;

/// Greatest number of lines kept in a history: here, in the prompt, and in the history file.
pub const KEPT_LINES: usize = 1000;

/// The latest lines entered.
#[derive(Default)]
pub struct History {
    lines: VecDeque<String>,
    /// Number of earlier lines that were dropped.
    dropped: usize,
}

impl History {
    pub fn add(&mut self, line: String) {
        if self.lines.len() == KEPT_LINES {
            self.lines.pop_front();
            self.dropped += 1;
        }
        self.lines.push_back(line);
    }

    /// Returns the lines in the history, oldest first, without the first `known` lines ever
    /// entered. Sets `known` to the number of all lines entered so far.
    pub fn since(&self, known: &mut usize) -> Vec<String> {
        let kept = known.saturating_sub(self.dropped);
        *known = self.dropped + self.lines.len();
        self.lines.iter().skip(kept).cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_lines_are_kept_and_counted_from_the_first() {
        let mut history = History::default();
        (0..KEPT_LINES + 5).for_each(|line| history.add(line.to_string()));
        assert_eq!((history.lines.len(), history.dropped), (KEPT_LINES, 5));
        let mut known = 0;
        assert_eq!(history.since(&mut known).first().map(String::as_str), Some("5"));
        assert_eq!((known, history.since(&mut known).len()), (KEPT_LINES + 5, 0));
        known -= 1;
        assert_eq!(history.since(&mut known), [(KEPT_LINES + 4).to_string()]);
    }
}
