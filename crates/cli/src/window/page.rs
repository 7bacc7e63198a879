//! A text over the picture, wrapped to fit and scrolled if it is too long. Knows no keys.

use crate::theme::{DIM, GROUND, INK};
use zeroset_render::overlay::Canvas;

/// Padding around the text, in font pixels.
const PAD: usize = 8;

/// A text, and the number of its first visible line.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    text: String,
    scroll: usize,
}

impl Page {
    pub fn new(text: &str) -> Self {
        // The font lacks the character `…`.
        Self { text: text.trim_end().replace('…', ".."), scroll: 0 }
    }

    /// Scrolls down by this many lines, or up if negative. `size` is the window's size in pixels.
    /// `scale` is the scale of the letters.
    pub fn scroll(&mut self, lines: isize, size: (usize, usize), scale: usize) {
        let canvas = Canvas::new(size.0, size.1, Vec::new(), scale);
        let (all, shown) = (wrapped(&self.text, letters(&canvas)).len(), rows(&canvas));
        let most = all.saturating_sub(shown);
        self.scroll = self.scroll.min(most).saturating_add_signed(lines).min(most);
    }

    /// Draws the visible lines in the middle of the window.
    pub fn draw(&self, canvas: &mut Canvas) {
        let lines = wrapped(&self.text, letters(canvas));
        let rows = rows(canvas);
        let first = self.scroll.min(lines.len().saturating_sub(rows));
        let shown = &lines[first..lines.len().min(first + rows)];
        let longest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
        let (pad, row) = (PAD * canvas.scale, canvas.line_height());
        let is_long = shown.len() < lines.len();
        let width = (longest * canvas.advance() + 2 * pad).min(canvas.width);
        let height = (shown.len() + usize::from(is_long)) * row + 2 * pad;
        let left = (canvas.width - width) as i64 / 2;
        let top = canvas.height.saturating_sub(height) as i64 / 2;
        canvas.fill(left, top, width, height, GROUND, 236);
        let mut y = top + pad as i64;
        for line in shown {
            canvas.write(line, left + pad as i64, y, INK);
            y += row as i64;
        }
        if is_long {
            let range = format!("{}-{} of {}", first + 1, first + shown.len(), lines.len());
            let more = canvas.fitting(&format!("{range}: Up, Down, Esc"), width - 2 * pad);
            canvas.write(&more, left + pad as i64, y, DIM);
        }
    }
}

/// Number of letters that fit in a line.
fn letters(canvas: &Canvas) -> usize {
    (canvas.width.saturating_sub(2 * PAD * canvas.scale) / canvas.advance()).max(1)
}

/// Number of lines that fit, with one line reserved for the range of visible lines.
fn rows(canvas: &Canvas) -> usize {
    let room = canvas.height.saturating_sub(2 * PAD * canvas.scale);
    (room / canvas.line_height()).saturating_sub(1).max(1)
}

/// Breaks lines longer than this many letters, and indents their continuation lines further.
fn wrapped(text: &str, letters: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for line in text.lines() {
        let indent = (line.chars().take_while(|c| *c == ' ').count() + 2).min(letters / 2);
        let mut rest: Vec<char> = line.chars().collect();
        while rest.len() > letters {
            let within = &rest[..=letters];
            let blank = within.iter().rposition(|c| *c == ' ').filter(|at| *at > indent);
            let end = blank.unwrap_or(letters);
            let more: Vec<char> =
                rest[end..].iter().copied().skip_while(|letter| *letter == ' ').collect();
            let part: String = rest[..end].iter().collect();
            lines.push(part.trim_end().to_owned());
            rest = std::iter::repeat_n(' ', indent).chain(more).collect();
        }
        lines.push(rest.iter().collect());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_fit_and_lose_nothing() {
        let text = "short\n  a line that is longer than the others are\nnoblankstobreakatanywhere";
        for letters in [7, 12, 30, 80] {
            let lines = wrapped(text, letters);
            assert!(lines.iter().all(|line| line.chars().count() <= letters), "{lines:#?}");
            let plain = |text: &str| text.split_whitespace().collect::<String>();
            assert_eq!(plain(&lines.concat()), plain(text));
        }
        assert_eq!(wrapped(text, 80).join("\n"), text);
    }

    #[test]
    fn what_does_not_fit_is_scrolled_to_its_end_and_not_beyond() {
        let lines: Vec<String> = (0..40).map(|n| n.to_string()).collect();
        let mut page = Page::new(&lines.join("\n"));
        page.scroll(-3, (300, 200), 1);
        assert_eq!(page.scroll, 0);
        page.scroll(1000, (300, 200), 1);
        let end = page.scroll;
        assert!(end > 30 && end < 39, "{end}");
        page.scroll(-1, (300, 200), 1);
        assert_eq!(page.scroll, end - 1);
    }
}
