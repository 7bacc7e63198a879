//! The gallery in the window. A surface is chosen by parts of its name, arrow keys or pointer.

use super::Window;
use super::enlarge::enlarge;
use super::tasks::LineGoal;
use super::thumbnails::{SIDE, Thumbnails};
use crate::theme::{CHOSEN, DIM, INK};
use minifb::Key;
use std::ops::Range;
use std::time::Instant;
use zeroset_render::overlay::{Canvas, Rgb};

const GROUND: Rgb = 0x0018_1820;
const CELL: Rgb = 0x0028_2832;

/// Gap between pictures, in dots of a letter.
const GAP: usize = 8;

/// State of the gallery.
#[derive(Default)]
pub struct Browser {
    is_open: bool,
    /// Created when the gallery is first opened.
    thumbnails: Option<Thumbnails>,
    filter: String,
    /// Index of the chosen surface in the filtered list.
    chosen: usize,
    /// First visible row.
    scroll: usize,
}

/// Everything that the gallery's drawing depends on. The pictures are represented by `version`.
#[derive(Clone, PartialEq)]
pub struct GalleryContent {
    filter: String,
    matches: Vec<usize>,
    chosen: usize,
    grid: GalleryLayout,
    version: u64,
}

/// Layout of the gallery's pictures. Lengths and positions are in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct GalleryLayout {
    columns: usize,
    /// Number of visible rows. The first visible row is `first`.
    rows: usize,
    first: usize,
    left: usize,
    top: usize,
    side: usize,
    gap: usize,
    line: usize,
}

impl GalleryLayout {
    /// Lays out the gallery in a window of this size, with letters of this scale. Scrolls so that
    /// the `chosen` picture is visible.
    fn new((width, height): (usize, usize), scale: f64, scroll: usize, chosen: usize) -> Self {
        let [side, gap] = [SIDE, GAP].map(|dots| Canvas::dots_at(dots, scale));
        let line = Canvas::line_height_at(scale);
        let columns = (width.saturating_sub(gap) / (side + gap)).max(1);
        let top = line + gap;
        let rows = (height.saturating_sub(top + line) / (side + line + gap)).max(1);
        let row = chosen / columns;
        let first = scroll.min(row).max((row + 1).saturating_sub(rows));
        let left = width.saturating_sub(columns * (side + gap) - gap) / 2;
        Self { columns, rows, first, left, top, side, gap, line }
    }

    /// Returns the upper left corner of the picture with this number.
    fn corner(&self, number: usize) -> (usize, usize) {
        let (row, column) = (number / self.columns - self.first, number % self.columns);
        let (across, down) = (self.side + self.gap, self.side + self.line + self.gap);
        (self.left + column * across, self.top + row * down)
    }

    /// Returns which of `count` pictures are visible, as a range of numbers.
    fn shown(&self, count: usize) -> Range<usize> {
        let first = (self.first * self.columns).min(count);
        first..(first + self.rows * self.columns).min(count)
    }

    fn at(&self, (x, y): (f64, f64), count: usize) -> Option<usize> {
        self.shown(count).find(|number| {
            let (left, top) = self.corner(*number);
            let within =
                |at: f64, from: usize, size: usize| at >= from as f64 && at < (from + size) as f64;
            within(x, left, self.side) && within(y, top, self.side + self.line)
        })
    }
}

impl Browser {
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Ends the thread that renders the gallery's pictures.
    pub fn stop(&mut self) {
        if let Some(thumbnails) = &mut self.thumbnails {
            thumbnails.stop();
        }
    }

    /// Returns the gallery indices of names that match the filter. Names that begin with it come
    /// first.
    fn matches(&self) -> Vec<usize> {
        let examples = self.thumbnails.as_ref().map_or(&[][..], Thumbnails::examples);
        let filter = self.filter.trim().to_lowercase();
        let words: Vec<&str> = filter.split_whitespace().collect();
        let fits = |place: &usize| {
            let example = &examples[*place];
            let title = example.title().to_lowercase();
            words.iter().all(|word| example.slug.contains(word) || title.contains(word))
        };
        let mut found: Vec<usize> = (0..examples.len()).filter(fits).collect();
        found.sort_by_key(|place| !examples[*place].slug.starts_with(&*filter));
        found
    }
}

impl Window {
    /// Opens the gallery, or closes it.
    pub(super) fn toggle_gallery(&mut self) {
        let scale = self.scale_at(self.size().1);
        let browser = &mut self.browser;
        browser.is_open = !browser.is_open;
        if browser.is_open {
            browser.thumbnails.get_or_insert_with(|| Thumbnails::new(scale));
            browser.filter.clear();
            (browser.chosen, browser.scroll) = (0, 0);
            self.message = None;
        } else if let Some(thumbnails) = &browser.thumbnails {
            thumbnails.leave();
        }
    }

    /// Returns the gallery's layout at the window's current size.
    fn grid(&self) -> GalleryLayout {
        let (size, Browser { scroll, chosen, .. }) = (self.size(), &self.browser);
        GalleryLayout::new(size, self.scale_at(size.1), *scroll, *chosen)
    }

    /// Requests pictures of the visible surfaces, and returns what to draw.
    pub(super) fn gallery_content(&mut self) -> Option<GalleryContent> {
        if !self.browser.is_open {
            return None;
        }
        let matches = self.browser.matches();
        self.browser.chosen = self.browser.chosen.min(matches.len().saturating_sub(1));
        let grid = self.grid();
        let browser = &mut self.browser;
        browser.scroll = grid.first;
        let seen = matches[grid.shown(matches.len())].to_vec();
        let thumbnails = browser.thumbnails.as_mut()?;
        thumbnails.want(seen, &self.session);
        let (filter, chosen) = (browser.filter.clone(), browser.chosen);
        Some(GalleryContent { filter, matches, chosen, grid, version: thumbnails.version() })
    }

    /// Adds a letter to the filter.
    pub(super) fn filter_gallery(&mut self, letter: char) {
        self.browser.filter.push(letter);
        (self.browser.chosen, self.browser.scroll) = (0, 0);
    }

    /// Handles a key that is not a letter.
    pub(super) fn browse(&mut self, key: Key) {
        let count = self.browser.matches().len();
        let grid = self.grid();
        let browser = &mut self.browser;
        let page = grid.columns * grid.rows;
        let last = count.saturating_sub(1);
        let chosen = browser.chosen;
        browser.chosen = match key {
            Key::Left => chosen.saturating_sub(1),
            Key::Right => (chosen + 1).min(last),
            Key::Up => chosen.checked_sub(grid.columns).unwrap_or(chosen),
            Key::Down if chosen + grid.columns <= last => chosen + grid.columns,
            Key::PageUp => chosen.saturating_sub(page),
            Key::PageDown => (chosen + page).min(last),
            Key::Home => 0,
            Key::End => last,
            Key::Backspace => {
                browser.filter.pop();
                0
            }
            Key::Enter | Key::NumPadEnter => return self.open_chosen(),
            _ => return,
        };
    }

    /// Chooses the picture under the pointer, and opens its surface if the button is pressed.
    pub(super) fn point_gallery(&mut self, at: (f64, f64), moved: bool, pressed: bool) {
        let count = self.browser.matches().len();
        let grid = self.grid();
        let browser = &mut self.browser;
        let Some(number) = grid.at(at, count).filter(|_| moved || pressed) else { return };
        browser.chosen = number;
        if pressed {
            self.open_chosen();
        }
    }

    /// Scrolls by one row, up if `steps` is positive.
    pub(super) fn scroll_gallery(&mut self, steps: f64) {
        let count = self.browser.matches().len();
        let grid = self.grid();
        let browser = &mut self.browser;
        let rows = count.div_ceil(grid.columns);
        let most = rows.saturating_sub(grid.rows);
        let first = grid.first;
        browser.scroll = if steps > 0.0 { first.saturating_sub(1) } else { (first + 1).min(most) };
        // Keep the chosen picture among the visible ones.
        let (row, column) = (browser.chosen / grid.columns, browser.chosen % grid.columns);
        let row = row.clamp(browser.scroll, browser.scroll + grid.rows - 1);
        browser.chosen = (row * grid.columns + column).min(count.saturating_sub(1));
    }

    fn open_chosen(&mut self) {
        let browser = &self.browser;
        let Some(thumbnails) = &browser.thumbnails else { return };
        let Some(&place) = browser.matches().get(browser.chosen) else { return };
        self.send(format!(":load {}", thumbnails.examples()[place].slug), LineGoal::Replace);
        self.active = Instant::now();
        self.toggle_gallery();
    }

    pub(super) fn draw_gallery(&self, canvas: &mut Canvas, shown: &GalleryContent) {
        let Some(thumbnails) = &self.browser.thumbnails else { return };
        let GalleryContent { filter, matches, chosen, grid, .. } = shown;
        let (width, height, pad) = (canvas.width, canvas.height, canvas.dots(2));
        canvas.fill(0, 0, width, height, GROUND, 255);
        let examples = thumbnails.examples();
        for number in grid.shown(matches.len()) {
            let (left, top) = grid.corner(number);
            let (x, y, below) = (left as i64, top as i64, (top + grid.side) as i64);
            let example = &examples[matches[number]];
            if number == *chosen {
                let (frame, wide) = (pad as i64, grid.side + 2 * pad);
                canvas.fill(x - frame, y - frame, wide, wide + grid.line, CHOSEN, 255);
                canvas.fill(x, below, grid.side, grid.line, GROUND, 255);
            }
            canvas.fill(x, y, grid.side, grid.side, CELL, 255);
            if let Some(picture) = thumbnails.picture(matches[number]) {
                let mut pixels = vec![0; grid.side * grid.side];
                enlarge(&picture.rgb, [picture.side; 2], &mut pixels, [grid.side; 2]);
                canvas.paste(&pixels, grid.side, (left, top));
            }
            let name = canvas.fitting(example.slug, grid.side);
            let ink = if number == *chosen { INK } else { DIM };
            canvas.write(&name, x, below + pad as i64, ink);
        }
        let room = width.saturating_sub(2 * grid.gap);
        let found = match (matches.len(), filter.is_empty()) {
            (count, true) => {
                format!("{count} surfaces: type to find one, Enter opens, Ctrl-R: recent files")
            }
            (0, false) => format!("> {filter}_   none"),
            (count, false) => format!("> {filter}_   {count}"),
        };
        let text_y = pad as i64 + grid.gap as i64 / 2;
        canvas.write(&canvas.fitting(&found, room), grid.gap as i64, text_y, INK);
        let bottom = height as i64 - grid.line as i64;
        canvas.fill(0, bottom, width, grid.line, 0x0020_2028, 255);
        if let Some(&place) = matches.get(*chosen) {
            let example = &examples[place];
            let text = format!("{}: {}", example.title(), example.summary());
            let text = canvas.fitting(&text, room);
            canvas.write(&text, grid.gap as i64, bottom + pad as i64, DIM);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_is_found_where_it_is_shown() {
        for (size, scale) in
            [((800, 620), 1.0), ((300, 220), 1.0), ((1600, 1200), 2.25), ((90, 60), 1.0)]
        {
            for chosen in [0, 30, 64] {
                let grid = GalleryLayout::new(size, scale, 0, chosen);
                assert!(grid.shown(65).contains(&chosen), "{grid:?}");
                for number in grid.shown(65) {
                    let (left, top) = grid.corner(number);
                    let middle = ((left + grid.side / 2) as f64, (top + grid.side / 2) as f64);
                    assert_eq!(grid.at(middle, 65), Some(number), "{grid:?}");
                    assert!(size.0 < 120 || left + grid.side <= size.0, "{grid:?}");
                }
            }
        }
    }

    #[test]
    fn letters_choose_by_name_and_title() {
        let thumbnails = Some(Thumbnails::new(1.0));
        let mut browser = Browser { thumbnails, ..Browser::default() };
        assert!(browser.matches().len() >= 95);
        browser.filter = "Bar sex".to_owned();
        let examples = zeroset_scene::gallery::examples();
        let names: Vec<&str> =
            browser.matches().into_iter().map(|place| examples[place].slug).collect();
        assert_eq!(names, ["barth-sextic"]);
        browser.filter = "qqq".to_owned();
        assert!(browser.matches().is_empty());
    }
}
