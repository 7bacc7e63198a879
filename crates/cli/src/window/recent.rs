//! The menu of recent files. A file is chosen by arrow keys or by the pointer.

use super::Window;
use super::tasks::LineGoal;
use crate::data::recent_files;
use crate::theme::{CHOSEN, DIM, GROUND, INK};
use minifb::Key;
use std::time::Instant;
use zeroset_render::overlay::Canvas;

/// Space around the menu's text, in dots of a letter.
const PAD: usize = 10;

/// The open menu: the paths, and the index of the chosen one.
#[derive(Clone, PartialEq)]
pub struct RecentMenu {
    files: Vec<String>,
    chosen: usize,
}

/// Layout of the menu, in pixels of the window. The title is above the rows.
struct MenuLayout {
    left: usize,
    top: usize,
    width: usize,
    row: usize,
    pad: usize,
    /// Number of rows that fit.
    shown: usize,
}

impl MenuLayout {
    fn at(&self, (x, y): (f64, f64)) -> Option<usize> {
        let inside = x >= self.left as f64 && x < (self.left + self.width) as f64;
        let down = y - (self.top + self.pad + self.row) as f64;
        let number = (down / self.row as f64).floor();
        (inside && number >= 0.0 && number < self.shown as f64).then_some(number as usize)
    }
}

impl RecentMenu {
    /// Places the menu in the middle of the canvas, with as many files as fit.
    fn layout(&self, canvas: &Canvas) -> MenuLayout {
        let (pad, row) = (canvas.dots(PAD), canvas.line_height());
        let texts = self.files.iter().map(String::as_str).chain([self.title()]);
        let widest = texts.map(|text| canvas.text_width(text)).max().unwrap_or(0);
        let width = (widest + 2 * pad).min(canvas.width);
        let room = canvas.height.saturating_sub(2 * pad + row) / row;
        let shown = self.files.len().min(room);
        let height = 2 * pad + (shown + 1) * row;
        let left = (canvas.width - width) / 2;
        let top = canvas.height.saturating_sub(height) / 2;
        MenuLayout { left, top, width, row, pad, shown }
    }

    fn title(&self) -> &'static str {
        if self.files.is_empty() {
            "no file was opened or saved yet; Esc closes"
        } else {
            "recent files: Enter opens, Esc closes"
        }
    }

    pub fn draw(&self, canvas: &mut Canvas) {
        let layout = self.layout(canvas);
        let MenuLayout { left, top, width, row, pad, shown } = layout;
        let height = 2 * pad + (shown + 1) * row;
        canvas.fill(left as i64, top as i64, width, height, GROUND, 244);
        let (x, room) = ((left + pad) as i64, width.saturating_sub(2 * pad));
        let mut y = (top + pad) as i64;
        canvas.write(&canvas.fitting(self.title(), room), x, y, DIM);
        for (n, file) in self.files.iter().enumerate().take(shown) {
            y += row as i64;
            if n == self.chosen {
                canvas.fill(left as i64, y - canvas.dots(2) as i64, width, row, CHOSEN, 110);
            }
            canvas.write(&ending(canvas, file, room), x, y, INK);
        }
    }
}

/// A path, shortened at its beginning to fit a width in pixels.
fn ending(canvas: &Canvas, path: &str, room: usize) -> String {
    if canvas.text_width(path) <= room {
        return path.to_owned();
    }
    let starts = path.char_indices().map(|(at, _)| format!("…{}", &path[at..]));
    { starts }.find(|text| canvas.text_width(text) <= room).unwrap_or_default()
}

impl Window {
    /// Opens the menu of recent files, or closes it.
    pub(super) fn toggle_recent(&mut self) {
        self.recent = match self.recent {
            Some(_) => None,
            None => Some(RecentMenu { files: recent_files(), chosen: 0 }),
        };
    }

    /// Handles a key while the menu is open.
    pub(super) fn choose_recent(&mut self, key: Key) {
        let Some(menu) = &mut self.recent else { return };
        let last = menu.files.len().saturating_sub(1);
        match key {
            Key::Up => menu.chosen = menu.chosen.saturating_sub(1),
            Key::Down => menu.chosen = (menu.chosen + 1).min(last),
            Key::Home => menu.chosen = 0,
            Key::End => menu.chosen = last,
            Key::Enter | Key::NumPadEnter => self.open_recent(),
            _ => self.recent = None,
        }
    }

    /// Chooses the file under the pointer, and opens it if the button is pressed. A press beside
    /// the menu closes it.
    pub(super) fn point_recent(&mut self, at: (f64, f64), moved: bool, pressed: bool) {
        let (width, height) = self.size();
        let canvas = Canvas::new(width, height, Vec::new(), self.scale_at(height));
        let Some(menu) = self.recent.as_mut().filter(|_| moved || pressed) else { return };
        match menu.layout(&canvas).at(at) {
            Some(number) => {
                menu.chosen = number;
                if pressed {
                    self.open_recent();
                }
            }
            None if pressed => self.recent = None,
            None => {}
        }
    }

    fn open_recent(&mut self) {
        let Some(menu) = self.recent.take() else { return };
        if let Some(file) = menu.files.get(menu.chosen) {
            self.send(format!(":load {file}"), LineGoal::Replace);
            self.active = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_found_where_it_is_shown() {
        let files = (0..30).map(|n| format!("/a/rather/long/path/surface-{n}.zset")).collect();
        let menu = RecentMenu { files, chosen: 0 };
        for (size, scale) in [((800, 600), 1.0), ((400, 300), 1.0), ((200, 150), 2.0)] {
            let canvas = Canvas::new(size.0, size.1, Vec::new(), scale);
            let layout = menu.layout(&canvas);
            assert!(layout.shown > 0 && layout.left + layout.width <= size.0);
            for number in 0..layout.shown {
                let y = layout.top + layout.pad + layout.row * (number + 1) + layout.row / 2;
                assert_eq!(layout.at(((layout.left + 3) as f64, y as f64)), Some(number));
                assert!(y < size.1);
            }
            assert_eq!(layout.at(((layout.left + 3) as f64, layout.top as f64)), None);
        }
    }

    #[test]
    fn a_long_path_keeps_its_end() {
        let canvas = Canvas::new(100, 100, Vec::new(), 1.0);
        let shown = ending(&canvas, "/home/somebody/surfaces/heart.zset", 100);
        assert!(shown.starts_with('…') && shown.ends_with("heart.zset"), "{shown}");
    }
}
