//! A text over the picture, wrapped to fit and scrolled if it is too long. Columns, which two or
//! more spaces separate, stay aligned. Knows no keys.

use crate::theme::{DIM, GROUND, INK};
use zeroset_render::overlay::Canvas;

/// Padding around the text, and the space between columns, in dots of a letter.
const PAD: usize = 8;
const GAP: usize = 14;

/// A text, and the number of its first visible line.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    text: String,
    scroll: usize,
}

/// Parts of a line, each with its distance from the left in pixels.
type Line = Vec<(usize, String)>;

impl Page {
    pub fn new(text: &str) -> Self {
        Self { text: text.trim_end().to_owned(), scroll: 0 }
    }

    /// Whether both pages have the same text.
    pub fn is_like(&self, other: &Self) -> bool {
        self.text == other.text
    }

    /// Scrolls down by this many lines, or up if negative. `size` is the window's size in pixels.
    /// `scale` is the scale of the letters.
    pub fn scroll(&mut self, lines: isize, size: (usize, usize), scale: f64) {
        let canvas = Canvas::new(size.0, size.1, Vec::new(), scale);
        let (all, shown) = (laid_out(&self.text, room(&canvas), &canvas).len(), rows(&canvas));
        let most = all.saturating_sub(shown);
        self.scroll = self.scroll.min(most).saturating_add_signed(lines).min(most);
    }

    /// Draws the visible lines in the middle of the window.
    pub fn draw(&self, canvas: &mut Canvas) {
        let lines = laid_out(&self.text, room(canvas), canvas);
        let rows = rows(canvas);
        let first = self.scroll.min(lines.len().saturating_sub(rows));
        let shown = &lines[first..lines.len().min(first + rows)];
        let longest = lines.iter().map(|line| line_width(line, canvas)).max().unwrap_or(0);
        let (pad, row) = (canvas.dots(PAD), canvas.line_height());
        let is_long = shown.len() < lines.len();
        let width = (longest + 2 * pad).min(canvas.width);
        let height = (shown.len() + usize::from(is_long)) * row + 2 * pad;
        let left = (canvas.width - width) as i64 / 2;
        let top = canvas.height.saturating_sub(height) as i64 / 2;
        canvas.fill(left, top, width, height, GROUND, 236);
        let (left, mut y) = (left + pad as i64, top + pad as i64);
        for line in shown {
            for (x, text) in line {
                canvas.write(text, left + *x as i64, y, INK);
            }
            y += row as i64;
        }
        if is_long {
            let range = format!("{}–{} of {}", first + 1, first + shown.len(), lines.len());
            let more = canvas.fitting(&format!("{range}: Up, Down, Esc"), width - 2 * pad);
            canvas.write(&more, left, y, DIM);
        }
    }
}

/// Width of a line of text in pixels.
fn room(canvas: &Canvas) -> usize {
    canvas.width.saturating_sub(2 * canvas.dots(PAD)).max(1)
}

/// Number of lines that fit, with one line reserved for the range of visible lines.
fn rows(canvas: &Canvas) -> usize {
    let room = canvas.height.saturating_sub(2 * canvas.dots(PAD));
    (room / canvas.line_height()).saturating_sub(1).max(1)
}

fn line_width(line: &Line, canvas: &Canvas) -> usize {
    line.iter().map(|(x, text)| x + canvas.text_width(text)).max().unwrap_or(0)
}

/// Lays out lines in this width, with aligned columns.
fn laid_out(text: &str, room: usize, canvas: &Canvas) -> Vec<Line> {
    let lines: Vec<(usize, Vec<&str>)> = text.lines().map(|line| cells(line, canvas)).collect();
    let mut all = Vec::new();
    // Lines that follow one another and have as many columns are a table.
    for table in lines.chunk_by(|(_, one), (_, other)| one.len() == other.len()) {
        let columns = table[0].1.len();
        let mut stops = Vec::new();
        let mut at = 0;
        for column in 0..columns {
            stops.push(at);
            let ends = table.iter().map(|(indent, cells)| {
                let indent = if column == 0 { *indent } else { 0 };
                at + indent + canvas.text_width(cells[column])
            });
            let end = ends.max().unwrap_or(at) + canvas.dots(GAP);
            // A cell wider than that is on a line of its own.
            at = end.min(at + room * 2 / 5);
        }
        for (indent, cells) in table {
            all.extend(wrapped(*indent, cells, &stops, room, canvas));
        }
    }
    all
}

/// The cells of a line, and the first one's distance from the left in pixels.
fn cells<'a>(line: &'a str, canvas: &Canvas) -> (usize, Vec<&'a str>) {
    let inner = line.trim_start_matches(' ');
    let indent = canvas.text_width(&line[..line.len() - inner.len()]);
    let mut cells = Vec::new();
    let mut rest = inner.trim_end();
    while let Some(end) = rest.find("  ") {
        cells.push(&rest[..end]);
        rest = rest[end..].trim_start_matches(' ');
    }
    cells.push(rest);
    (indent, cells)
}

/// Breaks a line that is too wide, at blanks where possible. What follows a break begins below the
/// last column, if that leaves enough room, and a little further right.
fn wrapped(
    indent: usize,
    cells: &[&str],
    stops: &[usize],
    room: usize,
    canvas: &Canvas,
) -> Vec<Line> {
    let mut lines = vec![Line::new()];
    let hang = canvas.dots(GAP);
    let mut end = 0;
    for (column, cell) in cells.iter().enumerate() {
        let stop = (stops[column] + if column == 0 { indent } else { 0 }).min(room / 2);
        if stop < end {
            lines.push(Line::new());
        }
        let mut rest = *cell;
        let mut x = stop;
        loop {
            let fits = canvas.fitting_bytes(rest, room.saturating_sub(x));
            let last = lines.len() - 1;
            if fits == rest.len() {
                end = x + canvas.text_width(rest);
                lines[last].push((x, rest.to_owned()));
                break;
            }
            let blank = rest[..fits].rfind(' ').filter(|at| *at > 0);
            // Even without room, each line takes a letter.
            let letter = rest.chars().next().map_or(0, char::len_utf8);
            let until = blank.unwrap_or(fits.max(letter));
            lines[last].push((x, rest[..until].trim_end().to_owned()));
            lines.push(Line::new());
            rest = rest[until..].trim_start();
            x = (stop + hang).min(room / 2);
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn canvas() -> Canvas {
        Canvas::new(300, 200, Vec::new(), 1.0)
    }

    #[test]
    fn lines_fit_and_lose_nothing() {
        let text = "short\n  a line that is longer than the others are\nnoblankstobreakatanywhere";
        let canvas = canvas();
        for room in [60, 100, 250, 600] {
            let lines = laid_out(text, room, &canvas);
            assert!(lines.iter().all(|line| line_width(line, &canvas) <= room), "{lines:#?}");
            let plain = |text: &str| text.split_whitespace().collect::<String>();
            let shown: String = lines.iter().flatten().map(|(_, part)| part.as_str()).collect();
            assert_eq!(plain(&shown), plain(text));
        }
        assert_eq!(laid_out(text, 600, &canvas).len(), 3);
    }

    #[test]
    fn columns_are_aligned_whatever_the_letters_widths() {
        let canvas = canvas();
        let lines = laid_out("  iii  one\n  mmm  two and more to wrap\nalone", 140, &canvas);
        let left = lines[0][1].0;
        assert!(left == lines[1][1].0 && left > lines[0][0].0 + canvas.text_width("mmm"));
        assert!(lines[2][0].0 > left, "{lines:?}");
        assert_eq!(lines.last().map(|line| line[0].clone()), Some((0, "alone".to_owned())));
    }

    #[test]
    fn what_does_not_fit_is_scrolled_to_its_end_and_not_beyond() {
        let lines: Vec<String> = (0..40).map(|n| n.to_string()).collect();
        let mut page = Page::new(&lines.join("\n"));
        page.scroll(-3, (300, 200), 1.0);
        assert_eq!(page.scroll, 0);
        page.scroll(1000, (300, 200), 1.0);
        let end = page.scroll;
        assert!(end > 30 && end < 39, "{end}");
        page.scroll(-1, (300, 200), 1.0);
        assert_eq!(page.scroll, end - 1);
    }
}
