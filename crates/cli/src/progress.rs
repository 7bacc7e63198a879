//! A progress bar for work that takes over a second, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Progress through a known number of steps, shared by threads.
pub struct Progress {
    bar: ProgressBar,
    started: Instant,
}

impl Progress {
    /// Creates a hidden bar, which stays hidden if standard error is not a terminal.
    pub fn new(steps: u64, what: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}%  {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what);
        Self { bar, started: Instant::now() }
    }

    /// Shows that this many steps are done. A smaller number than before is ignored.
    pub fn reach(&self, steps: u64) {
        if steps > self.bar.position() {
            self.bar.set_position(steps);
        }
        if self.bar.is_hidden()
            && self.started.elapsed() > PATIENCE
            && std::io::stderr().is_terminal()
        {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            // Draw the bar at once, since the next step may take long.
            self.bar.tick();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
