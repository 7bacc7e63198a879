//! The size and the modes of the terminal, and queries to it. If a window ends while a line is
//! being typed, the terminal's modes are restored. Elsewhere than on Unix only the size is known.

#[cfg(unix)]
use rustix::termios::{LocalModes, OptionalActions, SpecialCodeIndex};
use std::time::Duration;

/// Columns and rows of a terminal.
pub type TerminalSize = (usize, usize);

/// Returns the terminal's columns and rows, and the size of a character in pixels if it is known.
#[cfg(unix)]
pub fn size() -> Option<(TerminalSize, Option<TerminalSize>)> {
    let size = rustix::termios::tcgetwinsize(std::io::stdout()).ok()?;
    let pair = |(across, down): (u16, u16)| {
        (across > 0 && down > 0).then_some((usize::from(across), usize::from(down)))
    };
    let characters = pair((size.ws_col, size.ws_row))?;
    Some((characters, pair((size.ws_xpixel / size.ws_col, size.ws_ypixel / size.ws_row))))
}

/// Returns the terminal's columns and rows. The size of a character in pixels is known on Unix
/// only.
#[cfg(not(unix))]
pub fn size() -> Option<(TerminalSize, Option<TerminalSize>)> {
    let (columns, rows) = terminal_size::terminal_size()?;
    Some(((usize::from(columns.0), usize::from(rows.0)), None))
}

/// Returns whether the terminal interprets escape sequences. A console of Windows does so only on
/// request, and not before Windows 10.
pub fn takes_escapes() -> bool {
    #[cfg(windows)]
    let takes = anstyle_query::windows::enable_ansi_colors().unwrap_or(false);
    #[cfg(not(windows))]
    let takes = true;
    takes
}

/// The answer to a query for the primary device attributes.
#[cfg_attr(not(unix), expect(dead_code, reason = "queries are sent on Unix only"))]
pub enum QueryAnswer {
    /// The full answer, from the escape character to the final `c`.
    Given(String),
    /// There was no answer in time; it may still come.
    Late,
    /// No query was sent: there is no terminal, or waiting input would mix with the answer.
    NotAsked,
}

/// Longest answer that is read, in bytes.
#[cfg(unix)]
const LONGEST: usize = 64;

/// Queries the terminal for its primary device attributes (DA1). Call this before anything else
/// reads from the terminal. Drops keys typed between query and answer.
#[cfg(unix)]
pub fn ask(limit: Duration) -> QueryAnswer {
    use std::io::{IsTerminal, Write};
    let (input, mut output) = (std::io::stdin(), std::io::stdout());
    if !(input.is_terminal() && output.is_terminal()) {
        return QueryAnswer::NotAsked;
    }
    let Ok(before) = rustix::termios::tcgetattr(&input) else { return QueryAnswer::NotAsked };
    // The answer has no newline and must not be echoed. Interrupts are disabled, since an interrupt
    // would leave the terminal without echo.
    let mut silent = before.clone();
    silent.local_modes.remove(LocalModes::ECHO | LocalModes::ICANON | LocalModes::ISIG);
    silent.special_codes[SpecialCodeIndex::VMIN] = 0;
    silent.special_codes[SpecialCodeIndex::VTIME] = 0;
    if rustix::termios::tcsetattr(&input, OptionalActions::Now, &silent).is_err() {
        return QueryAnswer::NotAsked;
    }
    let mut send = || output.write_all(b"\x1b[c").and_then(|()| output.flush());
    let answer = if is_ready(&input, Duration::ZERO) || send().is_err() {
        QueryAnswer::NotAsked
    } else {
        read_answer(&input, limit).map_or(QueryAnswer::Late, QueryAnswer::Given)
    };
    // Restore the modes that were just read. If this fails, the terminal is gone.
    let _ = rustix::termios::tcsetattr(&input, OptionalActions::Now, &before);
    answer
}

/// Sends no query, since queries are supported only on Unix.
#[cfg(not(unix))]
pub fn ask(_: Duration) -> QueryAnswer {
    QueryAnswer::NotAsked
}

/// Whether a byte can be read within this time.
#[cfg(unix)]
fn is_ready(input: &std::io::Stdin, limit: Duration) -> bool {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let Ok(limit) = Timespec::try_from(limit) else { return false };
    matches!(poll(&mut [PollFd::new(input, PollFlags::IN)], Some(&limit)), Ok(1..))
}

/// Reads an answer byte by byte, so that nothing after it is consumed. Bypasses the buffer of
/// standard input, since the prompt would miss bytes left there.
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

/// Drops keys and answers that have not been read yet.
pub fn drop_input() {
    #[cfg(unix)]
    let _ = rustix::termios::tcflush(std::io::stdin(), rustix::termios::QueueSelector::IFlush);
}

/// Saves the terminal's modes before the prompt changes them. The returned function restores them.
#[cfg(feature = "window")]
pub fn keep_setup() -> impl FnOnce() {
    #[cfg(unix)]
    let before = rustix::termios::tcgetattr(std::io::stdin());
    move || {
        #[cfg(unix)]
        if let Ok(before) = before
            && rustix::termios::tcsetattr(std::io::stdin(), OptionalActions::Now, &before).is_ok()
        {
            // End the line that was being typed.
            println!();
        }
    }
}
