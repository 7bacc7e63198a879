//! Progress bars, hidden if standard error is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A progress bar of this many steps.
pub fn progress(steps: usize) -> ProgressBar {
    let bar = ProgressBar::new(steps as u64);
    let style = ProgressStyle::with_template("{msg} {wide_bar} {percent}%  {eta} left");
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
