//! The window's help: its keys and their actions, laid out to fit the window.

use super::theme::{CHOSEN as KEY, GROUND, INK};
use super::window::keys::SHORTCUTS;
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

/// Draws the help in the middle of the window, in the largest letters that fit.
pub fn draw(canvas: &mut Canvas) {
    let scale = canvas.scale;
    let tries = SHRINK.iter().flat_map(|shrink| (1..=MOST_COLUMNS).map(move |n| (*shrink, n)));
    let mut found = None;
    for (shrink, columns) in tries {
        canvas.scale = shrink * scale;
        let shown = layout(columns, canvas);
        let fits = shown.1 <= canvas.width && shown.2 <= canvas.height;
        found = Some(shown);
        if fits {
            break;
        }
    }
    let Some((cells, width, height)) = found else { return };
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
        let canvas = Canvas::new(400, 300, Vec::new(), SHRINK[SHRINK.len() - 1]);
        let fits = |columns: &usize| {
            let (cells, width, height) = layout(*columns, &canvas);
            cells.len() == 2 * rows().len() && width <= 400 && height <= 300
        };
        assert!((1..=MOST_COLUMNS).any(|columns| fits(&columns)));
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
