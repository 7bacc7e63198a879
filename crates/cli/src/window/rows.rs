//! Layout of rows over the picture, which scroll if they do not fit. Knows nothing of their
//! content.

use crate::theme::GROUND;
use zeroset_render::overlay::{Canvas, Rgb};

/// Largest number of rows that are visible at once.
const SHOWN: usize = 8;
/// Space around items, in dots of a letter.
pub const SPACE: usize = 6;

/// Layout of rows, in pixels of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowLayout {
    pub top: usize,
    /// Height of each row.
    pub height: usize,
    /// Index of the first visible row, number of visible rows, and number of all rows.
    pub first: usize,
    pub shown: usize,
    count: usize,
}

impl RowLayout {
    /// Lays out `count` rows below the top and above `bottom`, with the letters of
    /// `canvas`. The first `scroll` rows are scrolled out of view. Returns `None` without a row or
    /// enough space.
    pub fn new(count: usize, scroll: usize, bottom: usize, canvas: &Canvas) -> Option<Self> {
        let height = canvas.line_height();
        let top = canvas.dots(SPACE);
        let room = bottom.saturating_sub(top) / height;
        // Rows that scroll leave a row free, which says which of them are visible.
        let is_whole = count <= SHOWN.min(room);
        let shown = if is_whole { count } else { SHOWN.min(room.saturating_sub(1)) };
        let first = scroll.min(count - shown);
        (shown > 0).then_some(Self { top, height, first, shown, count })
    }

    /// Returns the index of the row at a vertical position.
    pub fn at(&self, y: f64) -> Option<usize> {
        let place = (y - self.top as f64) / self.height as f64;
        (place >= 0.0 && place < self.shown as f64).then_some(self.first + place as usize)
    }

    /// Returns the index of the visible row nearest to a vertical position.
    pub fn nearest(&self, y: f64) -> usize {
        let place = ((y - self.top as f64) / self.height as f64).max(0.0) as usize;
        self.first + place.min(self.shown - 1)
    }

    /// Whether some rows are not visible.
    pub fn scrolls(&self) -> bool {
        self.shown < self.count
    }

    /// Scrolls by a row, up if `steps` is positive. Returns false if all rows are visible.
    pub fn scroll(&self, scroll: &mut usize, steps: f64) -> bool {
        if self.scrolls() {
            *scroll = if steps > 0.0 { self.first.saturating_sub(1) } else { self.first + 1 };
        }
        self.scrolls()
    }

    /// Returns the index and the top of each visible row.
    pub fn each(&self) -> impl Iterator<Item = (usize, i64)> + use<> {
        let Self { top, height, first, shown, .. } = *self;
        (0..shown).map(move |place| (first + place, (top + place * height) as i64))
    }

    /// Draws the background of the rows.
    pub fn draw_ground(&self, canvas: &mut Canvas, left: usize, width: usize) {
        let height = (self.shown + usize::from(self.scrolls())) * self.height;
        canvas.fill(left as i64, self.top as i64, width, height, GROUND, 208);
    }

    /// Writes below the rows which of them are visible, such as 3-10, unless all are visible. `all`
    /// adds the total.
    pub fn write_range(&self, canvas: &mut Canvas, left: i64, ink: Rgb, all: bool) {
        if self.scrolls() {
            let of = if all { format!(" of {}", self.count) } else { String::new() };
            let range = format!("{}-{}{of}", self.first + 1, self.first + self.shown);
            let y = self.top + self.shown * self.height + canvas.dots(2);
            canvas.write(&range, left, y as i64, ink);
        }
    }
}
