//! Pictures in a terminal: as pixels if it can show them, else as half blocks of two colors, else
//! as letters.

use super::graphics::{GraphicsSupport, Protocol};
use super::notes;
use super::terminal::{self, QueryAnswer};
use std::fmt::Write as _;
use std::io::IsTerminal;
use std::sync::OnceLock;
use std::time::Duration;
use zeroset_live::Rendering;
use zeroset_render::overlay::Overlay;
use zeroset_render::picture::Picture;
use zeroset_render::pixels::{Pixels, flattened};

/// Assumed size in characters of a terminal that reports no size.
const COLUMNS: usize = 80;
const ROWS: usize = 24;
/// Largest number of columns of a picture, so that the whole picture stays in view.
const MOST_COLUMNS: usize = 120;
/// Rows left free for the prompt and the messages above it.
const RESERVED_ROWS: usize = 4;
/// Assumed width and height of a character in pixels, if the terminal does not report them. Larger
/// reported sizes are reduced to these, to keep the data small.
const CHARACTER: (usize, usize) = (8, 16);
/// Assumed width and height of a character for sixels, in pixels. This is the size of a small font,
/// since sixels are not scaled.
const SMALL_CHARACTER: (usize, usize) = (6, 12);

/// Longest wait for the terminal's answer. Only the first call of [`protocol`] waits.
const PATIENCE: Duration = Duration::from_secs(1);

/// Returns the number of columns and rows of characters that a picture may take.
fn characters() -> (usize, usize) {
    let number = |name: &str| std::env::var(name).ok()?.parse::<usize>().ok();
    let known = terminal::size().map(|(characters, _)| characters);
    let columns = known.map(|size| size.0).or_else(|| number("COLUMNS")).unwrap_or(COLUMNS);
    let rows = known.map(|size| size.1).or_else(|| number("LINES")).unwrap_or(ROWS);
    (columns.clamp(16, MOST_COLUMNS), rows.saturating_sub(RESERVED_ROWS).clamp(8, MOST_COLUMNS / 2))
}

/// Returns the protocol for sending pixels, if there is one, and whether a late answer may still
/// come. The first call queries the terminal, and must come before anything else reads from it.
fn protocol() -> (Option<Protocol>, bool) {
    static FOUND: OnceLock<(Option<Protocol>, bool)> = OnceLock::new();
    *FOUND.get_or_init(|| {
        if !std::io::stdout().is_terminal() {
            return (None, false);
        }
        match GraphicsSupport::detect(|name| std::env::var(name).ok()) {
            GraphicsSupport::Supports(protocol) => (Some(protocol), false),
            GraphicsSupport::Mute => (None, false),
            // An answer can only reveal support for sixels, which this build cannot send.
            GraphicsSupport::Unknown if !cfg!(feature = "sixel") => (None, false),
            GraphicsSupport::Unknown => match terminal::ask(PATIENCE) {
                QueryAnswer::Given(answer) => (Protocol::from_answer(&answer), false),
                QueryAnswer::Late => (None, true),
                QueryAnswer::NotAsked => (None, false),
            },
        }
    })
}

/// Drops an answer that the terminal sent too late. Call this before reading the first line, which
/// would otherwise begin with that answer.
pub fn drop_late_answer() {
    if protocol().1 {
        terminal::drop_input();
    }
}

/// Returns the width and height in pixels of a picture that fits the terminal.
pub fn pixel_size() -> (usize, usize) {
    let (columns, rows) = characters();
    let Some(protocol) = protocol().0 else {
        // A character is about twice as high as wide, and shows two square pixels.
        return (columns, 2 * rows);
    };
    let (across, down) = match (terminal::size().and_then(|(_, character)| character), protocol) {
        (Some((across, down)), _) => (across.min(CHARACTER.0), down.min(CHARACTER.1)),
        (None, Protocol::Sixel) => SMALL_CHARACTER,
        (None, Protocol::Kitty | Protocol::Iterm) => CHARACTER,
    };
    (columns * across, rows * down)
}

/// Returns the number of columns that a picture may take.
pub fn columns() -> usize {
    characters().0
}

/// Returns the number of rows of characters that a picture takes. `None` if the terminal does not
/// tell, so that no other picture can be written over it.
pub fn rows() -> Option<usize> {
    match protocol().0 {
        Some(Protocol::Kitty) => Some(characters().1),
        Some(Protocol::Iterm | Protocol::Sixel) => None,
        None => notes::colored_output().then(|| characters().1),
    }
}

/// Returns the text that shows a picture of the size of [`pixel_size`], with its curves, and a line
/// below it.
pub fn text(seen: &Rendering) -> String {
    picture(seen) + &seen.summary()
}

/// Returns the text that shows a picture with its curves. A coarse one is enlarged.
pub fn picture(seen: &Rendering) -> String {
    let (picture, full) = (&seen.picture, &seen.request.settings);
    let Pixels { rgb, alpha } = Overlay::CURVES.over(seen.into());
    let rgb = flattened(&rgb, &alpha, picture.look.background);
    let size = (picture.buffer.width, picture.buffer.height);
    if seen.is_full() {
        return shown(&rgb, size).unwrap_or_else(|| letters(picture, &picture.opaque_rgb(), &rgb));
    }
    let to = (full.width, full.height);
    shown(&enlarged(&rgb, size, to), to).unwrap_or_default()
}

/// Returns the text that shows these colors. `None` if the terminal shows no colors.
fn shown(rgb: &[u8], size: (usize, usize)) -> Option<String> {
    // Prefer pixels to characters.
    let sent = protocol().0.and_then(|one| one.encode(rgb, size, characters()));
    sent.map(|text| text + "\n").or_else(|| notes::colored_output().then(|| blocks(rgb, size.0)))
}

/// Enlarges a picture, whose pixels become rectangles of one color.
fn enlarged(rgb: &[u8], from: (usize, usize), to: (usize, usize)) -> Vec<u8> {
    let colors = rgb.as_chunks::<3>().0;
    let row = |y: usize| &colors[y * from.1 / to.1 * from.0..][..from.0];
    (0..to.1).flat_map(|y| (0..to.0).flat_map(move |x| row(y)[x * from.0 / to.0])).collect()
}

/// Returns pairs of consecutive rows of a picture. An odd last row is left out.
fn pairs(rgb: &[u8], width: usize) -> impl Iterator<Item = (&[[u8; 3]], &[[u8; 3]])> {
    rgb.as_chunks().0.chunks_exact(2 * width).map(move |pair| pair.split_at(width))
}

fn blocks(rgb: &[u8], width: usize) -> String {
    let mut text = String::new();
    for (upper, lower) in pairs(rgb, width) {
        for ([r, g, b], [s, h, c]) in upper.iter().zip(lower) {
            let _ = write!(text, "\x1b[38;2;{r};{g};{b};48;2;{s};{h};{c}m▀");
        }
        text.push_str("\x1b[0m\n");
    }
    text
}

/// Draws the picture in letters that stand for brightness, with spaces where nothing is painted.
/// `shown` has curves over the colors `plain`.
fn letters(picture: &Picture, plain: &[u8], shown: &[u8]) -> String {
    const RAMP: &[u8] = b"@%#*+=-:";
    let mut text = String::new();
    for (row, (upper, _)) in pairs(shown, picture.buffer.width).enumerate() {
        let mut line = String::new();
        for (pixel, rgb) in (2 * row * upper.len()..).zip(upper) {
            let [r, g, b] = rgb.map(usize::from);
            let bright = (2 * r + 5 * g + b) / 8;
            let letter = char::from(RAMP[bright * RAMP.len() / 256]);
            let bytes = 3 * pixel..3 * pixel + 3;
            let is_curve = plain.get(bytes.clone()) != shown.get(bytes);
            line.push(if is_curve || picture.buffer.is_drawn(pixel) { letter } else { ' ' });
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pixel_of_a_coarse_picture_covers_its_share() {
        let colors = [[1, 2, 3], [4, 5, 6]];
        let [left, right] = colors;
        let rows = [[left, left, left, right, right], [left, left, left, right, right]];
        assert_eq!(enlarged(&colors.concat(), (2, 1), (5, 2)), rows.concat().concat());
    }
}
