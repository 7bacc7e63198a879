//! The terminal itself: its size, what it answers, and how it is set up beside a window, which may
//! end while a line is being typed. Elsewhere than on Unix nothing is known of any.

#[cfg(unix)]
use rustix::termios::{LocalModes, OptionalActions, SpecialCodeIndex};
use std::time::Duration;

/// Columns and rows of a terminal.
pub type Size = (usize, usize);

/// The terminal's columns and rows, and width and height of a character in pixels where it tells.
#[cfg(unix)]
pub fn size() -> Option<(Size, Option<Size>)> {
    let size = rustix::termios::tcgetwinsize(std::io::stdout()).ok()?;
    let pair = |(across, down): (u16, u16)| {
        (across > 0 && down > 0).then_some((usize::from(across), usize::from(down)))
    };
    let characters = pair((size.ws_col, size.ws_row))?;
    Some((characters, pair((size.ws_xpixel / size.ws_col, size.ws_ypixel / size.ws_row))))
}

/// Nothing is known of it.
#[cfg(not(unix))]
pub fn size() -> Option<(Size, Option<Size>)> {
    None
}

/// What a terminal said when it was asked for its primary device attributes.
pub enum Answer {
    /// All of it, from the escape to the `c`.
    Given(String),
    /// Nothing in time; it may still come.
    Late,
    /// There was nobody to ask, or keys had been pressed already, among which an answer would be
    /// lost.
    NotAsked,
}

/// No answer is longer.
#[cfg(unix)]
const LONGEST: usize = 64;

/// Asks the terminal for its primary device attributes (DA1) before anything else reads from it.
/// What is typed until the answer is there is dropped, as it would be on the way into the prompt.
#[cfg(unix)]
pub fn ask(limit: Duration) -> Answer {
    use std::io::{IsTerminal, Write};
    let (input, mut output) = (std::io::stdin(), std::io::stdout());
    if !(input.is_terminal() && output.is_terminal()) {
        return Answer::NotAsked;
    }
    let Ok(before) = rustix::termios::tcgetattr(&input) else { return Answer::NotAsked };
    // The answer has no end of line, and nobody wants to see it. An interruption would leave the
    // terminal so.
    let mut silent = before.clone();
    silent.local_modes.remove(LocalModes::ECHO | LocalModes::ICANON | LocalModes::ISIG);
    silent.special_codes[SpecialCodeIndex::VMIN] = 0;
    silent.special_codes[SpecialCodeIndex::VTIME] = 0;
    if rustix::termios::tcsetattr(&input, OptionalActions::Now, &silent).is_err() {
        return Answer::NotAsked;
    }
    let mut send = || output.write_all(b"\x1b[c").and_then(|()| output.flush());
    let answer = if is_ready(&input, Duration::ZERO) || send().is_err() {
        Answer::NotAsked
    } else {
        read_answer(&input, limit).map_or(Answer::Late, Answer::Given)
    };
    // It was read with the same descriptor a moment ago; if that fails now, the terminal has gone.
    let _ = rustix::termios::tcsetattr(&input, OptionalActions::Now, &before);
    answer
}

/// Asks the terminal for its primary device attributes.
#[cfg(not(unix))]
pub fn ask(_: Duration) -> Answer {
    Answer::NotAsked
}

/// Whether something can be read within this time.
#[cfg(unix)]
fn is_ready(input: &std::io::Stdin, limit: Duration) -> bool {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let Ok(limit) = Timespec::try_from(limit) else { return false };
    matches!(poll(&mut [PollFd::new(input, PollFlags::IN)], Some(&limit)), Ok(1..))
}

/// Byte by byte, so that nothing after the answer is taken, and past the buffer of standard input,
/// which the prompt does not know.
#[cfg(unix)]
fn read_answer(input: &std::io::Stdin, limit: Duration) -> Option<String> {
    let end = std::time::Instant::now() + limit;
    let mut answer = String::new();
    while is_ready(input, end.checked_duration_since(std::time::Instant::now())?) {
        let mut byte = [0];
        let Ok(1) = rustix::io::read(input, &mut byte) else { return None };
        let letter = char::from(byte[0]);
        if letter == '\x1b' {
            answer.clear();
        }
        answer.push(letter);
        if letter == 'c' && answer.starts_with("\x1b[?") {
            return Some(answer);
        }
        if answer.len() > LONGEST {
            answer.clear();
        }
    }
    None
}

/// Drops what has been typed or answered and not yet read.
pub fn drop_input() {
    #[cfg(unix)]
    let _ = rustix::termios::tcflush(std::io::stdin(), rustix::termios::QueueSelector::IFlush);
}

/// Keeps how the terminal is set up before the prompt changes it. What is returned sets it up so
/// again.
#[cfg(feature = "window")]
pub fn keep_setup() -> impl FnOnce() {
    #[cfg(unix)]
    let before = rustix::termios::tcgetattr(std::io::stdin());
    move || {
        #[cfg(unix)]
        if let Ok(before) = before
            && rustix::termios::tcsetattr(std::io::stdin(), OptionalActions::Now, &before).is_ok()
        {
            // The line that was being typed has no end.
            println!();
        }
    }
}
