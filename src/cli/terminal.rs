//! The terminal itself: its size, and how it is set up beside a window, which may end while a line is being typed.
//! Elsewhere than on Unix nothing is known of either.

/// The terminal's columns and rows.
#[cfg(unix)]
pub fn size() -> Option<(usize, usize)> {
    let size = rustix::termios::tcgetwinsize(std::io::stdout()).ok()?;
    let (columns, rows) = (usize::from(size.ws_col), usize::from(size.ws_row));
    (columns > 0 && rows > 0).then_some((columns, rows))
}

/// Width and height of a character in pixels, where the terminal tells.
#[cfg(unix)]
pub fn character() -> Option<(usize, usize)> {
    let size = rustix::termios::tcgetwinsize(std::io::stdout()).ok()?;
    let (across, down) =
        (size.ws_xpixel.checked_div(size.ws_col)?, size.ws_ypixel.checked_div(size.ws_row)?);
    (across > 0 && down > 0).then_some((usize::from(across), usize::from(down)))
}

/// Width and height of a character in pixels, where the terminal tells.
#[cfg(not(unix))]
pub fn character() -> Option<(usize, usize)> {
    None
}

/// The terminal's columns and rows.
#[cfg(not(unix))]
pub fn size() -> Option<(usize, usize)> {
    None
}

/// How the terminal was set up before the prompt changed it.
#[cfg(feature = "window")]
pub struct State(#[cfg(unix)] Option<rustix::termios::Termios>);

#[cfg(all(unix, feature = "window"))]
impl State {
    pub fn save() -> Self {
        Self(rustix::termios::tcgetattr(std::io::stdin()).ok())
    }

    pub fn restore(&self) {
        let now = rustix::termios::OptionalActions::Now;
        if let Some(state) = &self.0
            && rustix::termios::tcsetattr(std::io::stdin(), now, state).is_ok()
        {
            // The line that was being typed has no end.
            println!();
        }
    }
}

#[cfg(all(not(unix), feature = "window"))]
impl State {
    pub fn save() -> Self {
        Self()
    }

    pub fn restore(&self) {}
}
