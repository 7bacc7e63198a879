//! The window's help: its keys and their actions, laid out to fit the window.

use super::theme::{GROUND, INK};
use super::window::keys::SHORTCUTS;
use std::fmt::Write as _;
use zeroset_render::overlay::Canvas;

/// What the mouse and the keys of the typed line do. The commands on other keys follow.
const MOUSE_AND_LINE: &[(&str, &str)] = &[
    ("drag", "turn"),
    ("right drag", "move"),
    ("wheel", "zoom"),
    ("click", "show point"),
    ("Ctrl wheel", "move cut"),
    ("any letter", "type"),
    ("Enter", "replace"),
    ("Ctrl-Enter", "add"),
    ("Tab", "complete"),
    ("Up, Down", "history"),
    ("Esc", "close"),
    ("arrows", "turn"),
];

/// Rows of the help: a key or an action of the mouse, and its effect.
fn rows() -> Vec<(&'static str, &'static str)> {
    let commands = SHORTCUTS.iter().map(|row| (row.name, row.help));
    MOUSE_AND_LINE.iter().copied().chain(commands).collect()
}

/// Lays out all rows of the table in this many aligned columns.
fn layout(columns: usize) -> Vec<String> {
    let rows = rows();
    let height = rows.len().div_ceil(columns);
    let mut lines = vec![String::new(); height];
    for (index, column) in rows.chunks(height).enumerate() {
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

/// Lays out all rows of the table like words of a text, wrapped at this many letters.
fn flow(letters: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for (key, action) in rows() {
        let (row, last) = (format!("{key}: {action}"), lines.len() - 1);
        let line = &mut lines[last];
        if line.is_empty() {
            *line = row;
        } else if line.len() + 2 + row.len() <= letters {
            line.push_str("  ");
            line.push_str(&row);
        } else {
            lines.push(row);
        }
    }
    lines
}

/// Padding around the help, in font pixels.
const PAD: usize = 10;
/// Padding in a small window, in font pixels.
const LITTLE_PAD: usize = 3;

/// Draws the help in the middle of the window. Prefers large letters, then two columns. If even one
/// column of small letters does not fit, the rows are wrapped like text and may be cut off.
pub fn draw(canvas: &mut Canvas) {
    let size = |lines: &[String], canvas: &Canvas| {
        let pad = PAD * canvas.scale;
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
    let is_small = fitting.is_none();
    let lines = fitting.unwrap_or_else(|| {
        canvas.scale = 1;
        flow(canvas.width.saturating_sub(2 * LITTLE_PAD) / canvas.advance())
    });
    let (width, height) =
        if is_small { (canvas.width, canvas.height) } else { size(&lines, canvas) };
    let pad = (if is_small { LITTLE_PAD } else { PAD } * canvas.scale) as i64;
    let centred = |room: usize, size: usize| ((room as i64 - size as i64) / 2).max(0);
    let (left, top) = (centred(canvas.width, width), centred(canvas.height, height));
    canvas.fill(left, top, width, height, GROUND, 232);
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
        assert_eq!(lines.len(), 13);
        assert_eq!(lines[0], "drag        turn        R           reset view", "{lines:#?}");
        assert!(lines.iter().all(|line| line.len() <= 47), "{lines:#?}");
        assert_eq!(layout(1)[24], "Q           quit");
    }

    #[test]
    fn every_key_is_there_in_a_window_300_pixels_wide() {
        let canvas = Canvas::new(300, 220, vec![0; 300 * 220], 1);
        let lines = flow((canvas.width - 2 * LITTLE_PAD) / canvas.advance());
        assert!(lines.len() * canvas.line_height() + 2 * LITTLE_PAD <= canvas.height, "{lines:#?}");
        for line in &lines {
            assert!(line.len() * canvas.advance() + 2 * LITTLE_PAD <= canvas.width, "{line}");
        }
        let text = lines.join("\n");
        assert!(rows().iter().all(|(key, action)| text.contains(&format!("{key}: {action}"))));
    }
}
