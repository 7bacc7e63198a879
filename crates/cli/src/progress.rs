//! A progress bar for work that takes over a second, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use zeroset_render::progress::Progress as Known;

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Progress through a known number of steps, or through a picture. Shared by threads.
pub struct Progress {
    bar: ProgressBar,
    /// Says what is done.
    stage: Mutex<&'static str>,
    started: Instant,
    /// Set if the standard error is a terminal.
    is_seen: bool,
}

impl Progress {
    /// Creates a hidden bar, which stays hidden if standard error is not a terminal.
    pub fn new(steps: u64, what: &'static str) -> Self {
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}%  {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what);
        let is_seen = std::io::stderr().is_terminal();
        Self { bar, stage: Mutex::new(what), started: Instant::now(), is_seen }
    }

    /// Returns whether the bar is shown once the work takes long.
    pub fn is_seen(&self) -> bool {
        self.is_seen
    }

    /// Shows how much of a picture is done. The bar has a hundred steps, and begins anew with each
    /// stage.
    pub fn follow(&self, known: Known) {
        let mut stage = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        if *stage != known.stage {
            *stage = known.stage;
            self.bar.set_message(known.stage);
            self.bar.reset();
        }
        drop(stage);
        self.reach(known.percent() as u64);
    }

    /// Shows that this many steps are done. A smaller number than before is ignored.
    pub fn reach(&self, steps: u64) {
        if steps > self.bar.position() {
            self.bar.set_position(steps);
        }
        if self.is_seen && self.bar.is_hidden() && self.started.elapsed() > PATIENCE {
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
