//! Pictures in a terminal: as pixels where it takes them, else two to a character, the upper half
//! block in one color over the other, else as letters.

use super::graphics::{Known, Protocol};
use super::notes;
use super::terminal::{self, Answer};
use std::fmt::Write as _;
use std::io::IsTerminal;
use std::sync::OnceLock;
use std::time::Duration;
use zeroset_render::picture::Picture;

/// Used where the terminal does not say how large it is.
const COLUMNS: usize = 80;
const ROWS: usize = 24;
/// Larger pictures scroll more than they show.
const MOST_COLUMNS: usize = 120;
/// Lines left for the prompt and what is said above it.
const SPARE: usize = 4;
/// Width and height of a character in pixels where the terminal does not say, and at most: what is
/// sent stays small.
const CHARACTER: (usize, usize) = (8, 16);
/// The same for sixels, which are not scaled: no more than a small font takes.
const SMALL_CHARACTER: (usize, usize) = (6, 12);

/// A terminal that answers does so after a round trip; one that does not costs this once.
const PATIENCE: Duration = Duration::from_secs(1);

/// Columns and rows of characters that a picture may take.
fn characters() -> (usize, usize) {
    let number = |name: &str| std::env::var(name).ok()?.parse::<usize>().ok();
    let known = terminal::size().map(|(characters, _)| characters);
    let columns = known.map(|size| size.0).or_else(|| number("COLUMNS")).unwrap_or(COLUMNS);
    let rows = known.map(|size| size.1).or_else(|| number("LINES")).unwrap_or(ROWS);
    (columns.clamp(16, MOST_COLUMNS), rows.saturating_sub(SPARE).clamp(8, MOST_COLUMNS / 2))
}

/// How pixels are sent, if they can be, and whether an answer may still come. The terminal is asked
/// when this is first called, which has to be before anything else reads from it.
fn protocol() -> (Option<Protocol>, bool) {
    static FOUND: OnceLock<(Option<Protocol>, bool)> = OnceLock::new();
    *FOUND.get_or_init(|| {
        if !std::io::stdout().is_terminal() {
            return (None, false);
        }
        match Known::detect(|name| std::env::var(name).ok()) {
            Known::Speaks(protocol) => (Some(protocol), false),
            Known::Mute => (None, false),
            // All that an answer could tell is that sixels are shown.
            Known::Unknown if !cfg!(feature = "sixel") => (None, false),
            Known::Unknown => match terminal::ask(PATIENCE) {
                Answer::Given(answer) => (Protocol::answered(&answer), false),
                Answer::Late => (None, true),
                Answer::NotAsked => (None, false),
            },
        }
    })
}

/// To be called before the first line is read: what the terminal answered too late is not a part of
/// it.
pub fn drop_late_answer() {
    if protocol().1 {
        terminal::drop_input();
    }
}

/// Columns and rows of pixels that fit.
pub fn room() -> (usize, usize) {
    let (columns, rows) = characters();
    let Some(protocol) = protocol().0 else {
        // A character is about twice as high as wide, so that pixels are square.
        return (columns, 2 * rows);
    };
    let (across, down) = match (terminal::size().and_then(|(_, character)| character), protocol) {
        (Some((across, down)), _) => (across.min(CHARACTER.0), down.min(CHARACTER.1)),
        (None, Protocol::Sixel) => SMALL_CHARACTER,
        (None, Protocol::Kitty | Protocol::Iterm) => CHARACTER,
    };
    (columns * across, rows * down)
}

/// What shows a picture that was made to fit, and a line below it.
pub fn text(picture: &Picture, below: &str) -> String {
    let size = (picture.buffer.width, picture.buffer.height);
    // As pixels, where they can be packed.
    let sent = protocol().0.and_then(|one| one.encode(&picture.rgb, size, characters()));
    let text = match sent {
        Some(text) => text + "\n",
        None if notes::colored_output() => blocks(picture),
        None => letters(picture),
    };
    text + below
}

/// The picture's rows two by two; the last of an odd number is left out.
fn pairs(picture: &Picture) -> impl Iterator<Item = (&[[u8; 3]], &[[u8; 3]])> {
    let width = picture.buffer.width;
    picture.rgb.as_chunks().0.chunks_exact(2 * width).map(move |pair| pair.split_at(width))
}

fn blocks(picture: &Picture) -> String {
    let mut text = String::new();
    for (upper, lower) in pairs(picture) {
        for ([r, g, b], [s, h, c]) in upper.iter().zip(lower) {
            let _ = write!(text, "\x1b[38;2;{r};{g};{b};48;2;{s};{h};{c}m▀");
        }
        text.push_str("\x1b[0m\n");
    }
    text
}

/// Without colors, letters by brightness; nothing where nothing is painted.
fn letters(picture: &Picture) -> String {
    const RAMP: &[u8] = b"@%#*+=-:";
    let mut text = String::new();
    for (row, (upper, _)) in pairs(picture).enumerate() {
        let mut line = String::new();
        for (pixel, rgb) in (2 * row * upper.len()..).zip(upper) {
            let [r, g, b] = rgb.map(usize::from);
            let bright = (2 * r + 5 * g + b) / 8;
            let letter = char::from(RAMP[bright * RAMP.len() / 256]);
            line.push(if picture.buffer.is_drawn(pixel) { letter } else { ' ' });
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
