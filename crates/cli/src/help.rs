//! The window's help: its keys and their actions, laid out to fit the window.

use super::theme::{CHOSEN as KEY, GROUND, INK};
use super::window::keys::SHORTCUTS;
use zeroset_render::overlay::Canvas;

/// Actions of the mouse, and keys of the typed line. The commands on other keys follow.
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

/// Space around the help and between its columns, in dots of a letter.
const PAD: usize = 12;
/// Space between a key and its effect, in dots of a letter.
const GAP: usize = 8;
/// Scales of the letters that are tried, in units of the window's scale.
const SHRINK: [f64; 4] = [1.0, 0.85, 0.7, 0.6];
/// Largest number of columns.
const MOST_COLUMNS: usize = 4;

/// A cell of the help: its text and its upper left corner, in pixels from the help's corner.
type Cell = (&'static str, usize, usize);

/// Lays out all rows of the table in this many columns. Returns the cells, and the help's width and
/// height in pixels.
fn layout(columns: usize, canvas: &Canvas) -> (Vec<Cell>, usize, usize) {
    let rows = rows();
    let height = rows.len().div_ceil(columns);
    let [pad, gap] = [PAD, GAP].map(|dots| canvas.dots(dots));
    let mut cells = Vec::new();
    let mut left = pad;
    for column in rows.chunks(height) {
        let widest = |texts: &mut dyn Iterator<Item = &'static str>| {
            texts.map(|text| canvas.text_width(text)).max().unwrap_or(0)
        };
        let keys = widest(&mut column.iter().map(|row| row.0));
        let effects = widest(&mut column.iter().map(|row| row.1));
        for (n, (key, effect)) in column.iter().enumerate() {
            let top = pad + n * canvas.line_height();
            cells.extend([(*key, left, top), (*effect, left + keys + gap, top)]);
        }
        left += keys + gap + effects + 2 * pad;
    }
    (cells, left - pad, 2 * pad + height * canvas.line_height())
}

/// The help as a text, for windows in which it has to be scrolled.
pub fn text() -> String {
    let lines = rows().into_iter().map(|(key, effect)| format!("{key}  {effect}"));
    lines.collect::<Vec<_>>().join("\n")
}

/// The largest scale of the letters, and the number of columns, with which the help fits a window
/// of this size. `None` if it has to be scrolled.
pub fn fitting((width, height): (usize, usize), scale: f64) -> Option<(f64, usize)> {
    let tries = SHRINK.iter().flat_map(|shrink| (1..=MOST_COLUMNS).map(move |n| (*shrink, n)));
    let tries = tries.map(|(shrink, columns)| (shrink * scale, columns));
    { tries }.find(|(scale, columns)| {
        let shown = layout(*columns, &Canvas::new(width, height, Vec::new(), *scale));
        shown.1 <= width && shown.2 <= height
    })
}

/// Draws the help in the middle of the window, if it fits.
pub fn draw(canvas: &mut Canvas) {
    let scale = canvas.scale;
    let Some((shrunk, columns)) = fitting((canvas.width, canvas.height), scale) else { return };
    canvas.scale = shrunk;
    let (cells, width, height) = layout(columns, canvas);
    let centred = |room: usize, size: usize| room.saturating_sub(size) as i64 / 2;
    let (left, top) = (centred(canvas.width, width), centred(canvas.height, height));
    canvas.fill(left, top, width, height, GROUND, 236);
    for (n, (text, x, y)) in cells.into_iter().enumerate() {
        let ink = if n % 2 == 0 { KEY } else { INK };
        canvas.write(text, left + x as i64, top + y as i64, ink);
    }
    canvas.scale = scale;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_there_in_a_window_400_by_300_pixels() {
        assert!(fitting((400, 300), 1.0).is_some() && fitting((800, 600), 2.0).is_some());
        assert_eq!(fitting((3000, 2000), 1.0), Some((1.0, 1)));
        assert_eq!(fitting((120, 90), 1.0), None);
        assert!(rows().iter().all(|(key, effect)| text().contains(&format!("{key}  {effect}"))));
    }

    #[test]
    fn effects_begin_below_one_another() {
        let canvas = Canvas::new(800, 600, Vec::new(), 1.0);
        let (cells, ..) = layout(2, &canvas);
        let effects: Vec<usize> = cells.iter().skip(1).step_by(2).map(|cell| cell.1).collect();
        let half = effects.len().div_ceil(2);
        for column in [&effects[..half], &effects[half..]] {
            assert!(column.iter().all(|left| *left == column[0]), "{effects:?}");
        }
    }
}
