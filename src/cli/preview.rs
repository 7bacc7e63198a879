//! Pictures in a terminal: two pixels to a character, the upper half block in one colour over the other.

use std::fmt::Write as _;
use std::io::{IsTerminal, Write as _};
use zeroset::picture::Picture;

/// Used where the terminal does not say how large it is.
const COLUMNS: usize = 80;
const ROWS: usize = 24;
/// Larger pictures scroll more than they show.
const MOST_COLUMNS: usize = 120;
/// Lines left for the prompt and what is said above it.
const SPARE: usize = 4;

/// Columns and rows of pixels that fit.
pub fn room() -> (usize, usize) {
    let number = |name: &str| std::env::var(name).ok()?.parse::<usize>().ok();
    let known = super::terminal::size();
    let columns = known.map(|size| size.0).or_else(|| number("COLUMNS")).unwrap_or(COLUMNS);
    let rows = known.map(|size| size.1).or_else(|| number("LINES")).unwrap_or(ROWS);
    let columns = columns.clamp(16, MOST_COLUMNS);
    // A character is about twice as high as wide, so that pixels are square.
    let rows = 2 * rows.saturating_sub(SPARE).clamp(8, MOST_COLUMNS / 2);
    (columns, rows)
}

/// Prints a picture that was made to fit.
pub fn print(picture: &Picture) {
    let coloured = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
        && std::io::stdout().is_terminal();
    let text = if coloured { blocks(picture) } else { letters(picture) };
    // Nobody is left to tell if that fails.
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

fn pixel(picture: &Picture, x: usize, y: usize) -> [u8; 3] {
    let index = 3 * (y * picture.buffer.width + x);
    [picture.rgb[index], picture.rgb[index + 1], picture.rgb[index + 2]]
}

fn blocks(picture: &Picture) -> String {
    let (width, height) = (picture.buffer.width, picture.buffer.height);
    let mut text = String::new();
    for y in (0..height.saturating_sub(1)).step_by(2) {
        for x in 0..width {
            let [r, g, b] = pixel(picture, x, y);
            let [s, h, c] = pixel(picture, x, y + 1);
            let _ = write!(text, "\x1b[38;2;{r};{g};{b};48;2;{s};{h};{c}m▀");
        }
        text.push_str("\x1b[0m\n");
    }
    text
}

/// Without colours, letters by brightness; nothing where nothing is painted.
fn letters(picture: &Picture) -> String {
    const RAMP: &[u8] = b"@%#*+=-:";
    let (width, height) = (picture.buffer.width, picture.buffer.height);
    let mut text = String::new();
    for y in (0..height.saturating_sub(1)).step_by(2) {
        let mut line = String::new();
        for x in 0..width {
            let drawn = picture.buffer.is_drawn(y * width + x);
            let [r, g, b] = pixel(picture, x, y).map(usize::from);
            let bright = (2 * r + 5 * g + b) / 8;
            line.push(if drawn { char::from(RAMP[bright * RAMP.len() / 256]) } else { ' ' });
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
