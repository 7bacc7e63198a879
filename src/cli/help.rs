//! The window's help: its keys and what they do, laid out to fit.

use super::canvas::{Canvas, Rgb};
use std::fmt::Write as _;

const GROUND: Rgb = 0x0020_2028;
const INK: Rgb = 0x00f0_f0f4;

/// Keys and what they do, the mouse first.
const ROWS: &[(&str, &str)] = &[
    ("drag", "turn"),
    ("right drag", "move"),
    ("wheel", "zoom"),
    ("click", "print a point"),
    ("/ or Enter", "type"),
    ("Tab", "complete"),
    ("Up, Down", "history"),
    ("Esc", "close"),
    ("F1", "this help"),
    ("arrows", "turn"),
    ("+ -", "zoom"),
    ("R", "reset view"),
    ("F", "fit"),
    ("P", "projection"),
    ("X", "box and axes"),
    ("U", "undecided"),
    ("S", "save a PNG"),
    ("Q", "quit"),
];

/// The rows in so many columns, each padded to the width of its widest.
fn layout(columns: usize) -> Vec<String> {
    let height = ROWS.len().div_ceil(columns);
    let mut lines = vec![String::new(); height];
    for (index, column) in ROWS.chunks(height).enumerate() {
        let keys = column.iter().map(|(key, _)| key.len()).max().unwrap_or(0);
        let width = lines.iter().map(String::len).max().unwrap_or(0);
        for (line, (key, action)) in lines.iter_mut().zip(column) {
            let gap = if index == 0 { 0 } else { width + 2 - line.len() };
            // Writing to a string cannot fail.
            let _ = write!(line, "{:gap$}{key:keys$}  {action}", "");
        }
    }
    lines
}

/// Draws the help in the middle: in two columns if they fit, else in one, with smaller letters where it must be.
pub fn draw(canvas: &mut Canvas) {
    let size = |lines: &[String], canvas: &Canvas| {
        let pad = 10 * canvas.scale;
        let longest = lines.iter().map(String::len).max().unwrap_or(0);
        (longest * canvas.advance() + 2 * pad, lines.len() * canvas.line_height() + 2 * pad)
    };
    let scale = canvas.scale;
    let fitting = (1..=scale).rev().find_map(|scale| {
        canvas.scale = scale;
        [2, 1].into_iter().map(layout).find(|lines| {
            let (width, height) = size(lines, canvas);
            width <= canvas.width && height <= canvas.height
        })
    });
    let lines = fitting.unwrap_or_else(|| layout(2));
    let (width, height) = size(&lines, canvas);
    let centred = |room: usize, size: usize| ((room as i64 - size as i64) / 2).max(0);
    let (left, top) = (centred(canvas.width, width), centred(canvas.height, height));
    canvas.fill(left, top, width, height, GROUND, 232);
    let pad = 10 * canvas.scale as i64;
    for (index, line) in (0_i64..).zip(&lines) {
        let y = top + pad + index * canvas.line_height() as i64;
        canvas.write(line, left + pad, y, INK);
    }
    canvas.scale = scale;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_columns_fit_a_small_window() {
        let lines = layout(2);
        assert_eq!(lines.len(), 9);
        assert_eq!(lines[3], "click       print a point  F       fit");
        assert!(lines.iter().all(|line| line.len() <= 47), "{lines:#?}");
        assert_eq!(layout(1)[17], "Q           quit");
    }
}
