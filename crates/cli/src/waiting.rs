//! Coarse pictures in the terminal while a fine one is made. Each is written over the one before.

use super::output::print;
use super::{notes, preview};
use anyhow::Result;
use std::sync::Arc;
use std::time::{Duration, Instant};
use zeroset_live::{Rendering, Snapshot};

/// Interval between looks at the work.
pub const STEP: Duration = Duration::from_millis(40);

/// If the fine picture takes at most this long, no coarse one is shown.
const PATIENCE: Duration = Duration::from_millis(200);

/// The coarse picture in the terminal, and the line below it.
pub struct Waiting {
    begun: Instant,
    picture: Option<Arc<Rendering>>,
    /// The line below the picture, on which the cursor stands.
    line: String,
}

impl Waiting {
    pub fn begin() -> Self {
        Self { begun: Instant::now(), picture: None, line: String::new() }
    }

    /// Shows the coarse picture of the request with this revision, and how much of the finer one is
    /// done. Does nothing unless the output is a terminal in which the cursor can be moved.
    ///
    /// # Errors
    /// If the terminal cannot be written to.
    pub fn show(&mut self, seen: &Snapshot, revision: u64) -> Result<()> {
        if self.begun.elapsed() < PATIENCE || !notes::colored_output() {
            return Ok(());
        }
        let picture = seen.rendering.as_ref().filter(|picture| picture.revision == revision);
        let working = seen.working.map(|working| working.to_string());
        let parts: Vec<String> =
            working.into_iter().chain(picture.map(|picture| picture.in_words())).collect();
        // A line that the terminal wraps would take two rows.
        let line: String = parts.join(" · ").chars().take(preview::columns() - 1).collect();
        let is_known = |picture: &Arc<Rendering>| {
            self.picture.as_ref().is_some_and(|known| Arc::ptr_eq(known, picture))
        };
        let new = picture.filter(|picture| !is_known(picture) && preview::rows().is_some());
        if line == self.line && new.is_none() {
            return Ok(());
        }
        let mut text = String::from("\r");
        if let Some(new) = new {
            text += &self.above();
            text += &preview::picture(new);
            self.picture = Some(Arc::clone(new));
        }
        text += &line;
        self.line = line;
        print(&(text + "\x1b[K"))
    }

    /// Moves the cursor to where the picture begins.
    fn above(&self) -> String {
        let rows = self.picture.as_ref().and_then(|_| preview::rows()).unwrap_or(0);
        if rows > 0 { format!("\x1b[{rows}A") } else { String::new() }
    }

    /// Removes what was shown, so that the fine picture takes its place.
    ///
    /// # Errors
    /// If the terminal cannot be written to.
    pub fn end(self) -> Result<()> {
        if self.line.is_empty() {
            return Ok(());
        }
        print(&format!("\r{}\x1b[J", self.above()))
    }
}
