//! The list of surfaces: where its rows and their parts are, and what they look like. Knows no mouse
//! and no document.

use crate::cli::canvas::{Canvas, Rgb};
use crate::cli::theme::{CHOSEN, GROUND, INK, TRACK};
use zeroset::live::Listed;

const BRIGHT: Rgb = 0x00ff_ffff;
const HIDDEN: Rgb = 0x0088_8894;

/// So many surfaces are shown at once.
const SHOWN: usize = 8;
/// Letters of a formula, at most; where there is room for fewer than the least, colours are shown alone.
const LETTERS: usize = 24;
const LEAST_LETTERS: usize = 8;
/// The list takes no more than this share of the window's width.
const MOST: f64 = 0.55;
/// Widths in dots of a letter: space around things, a colour, the track of an opacity, the sign that deletes.
const SPACE: usize = 6;
const SWATCH: usize = 18;
const TRACK_WIDTH: usize = 40;
const DELETE: usize = 12;

/// A part of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// Its colour, which hides and shows it.
    Swatch,
    /// Its formula, by which it is dragged.
    Formula,
    /// Its opacity, and which one that place stands for.
    Opacity(f64),
    /// What takes it away.
    Delete,
}

/// Where the surfaces are listed. All places are in pixels of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct List {
    left: usize,
    top: usize,
    width: usize,
    row: usize,
    /// The first surface that is shown, and how many are, of how many.
    pub first: usize,
    shown: usize,
    count: usize,
    /// Letters of each formula; 0 where only colours are shown.
    letters: usize,
    scale: usize,
}

impl List {
    /// The list of so many surfaces from the `scroll`-th on, at the right of a picture of so many
    /// pixels of which `taken` at the left are taken, with the letters of `canvas`; `None` if there is
    /// no surface or no room.
    pub fn new(
        count: usize,
        scroll: usize,
        taken: usize,
        (width, height): (usize, usize),
        canvas: &Canvas,
    ) -> Option<Self> {
        let (scale, row, letter) = (canvas.scale, canvas.line_height(), canvas.advance());
        let top = row + SPACE * scale;
        let room = height.saturating_sub(top + row) / row;
        let shown = count.min(SHOWN).min(if count > SHOWN { room.saturating_sub(1) } else { room });
        let plain = (SWATCH + 2 * SPACE) * scale;
        let parts = (TRACK_WIDTH + DELETE + 3 * SPACE) * scale;
        let most = (MOST * width as f64) as usize;
        let free = most.min(width.saturating_sub(taken + 2 * SPACE * scale));
        let free = free.saturating_sub(plain + parts);
        let letters =
            Some((free / letter).min(LETTERS)).filter(|letters| *letters >= LEAST_LETTERS);
        let own = letters.map_or(plain, |letters| plain + letters * letter + parts);
        if shown == 0 || width < (taken + plain).max(4 * plain) {
            return None;
        }
        let (left, first) = (width - own, scroll.min(count - shown));
        let letters = letters.unwrap_or(0);
        Some(Self { left, top, width: own, row, first, shown, count, letters, scale })
    }

    /// The surface at a place, and the part of its row.
    pub fn at(&self, (x, y): (f64, f64)) -> Option<(usize, Part)> {
        let (across, down) = (x - self.left as f64, y - self.top as f64);
        let inside = across >= 0.0 && across < self.width as f64 && down >= 0.0;
        let row = (down / self.row as f64) as usize;
        if !inside || row >= self.shown {
            return None;
        }
        let x = x as usize;
        let part = if self.letters == 0 || x < self.formula() {
            Part::Swatch
        } else if x < self.track() - SPACE * self.scale / 2 {
            Part::Formula
        } else if x < self.delete() - SPACE * self.scale / 2 {
            Part::Opacity(self.opacity(x as f64))
        } else {
            Part::Delete
        };
        Some((self.first + row, part))
    }

    /// The surface whose place among those that are shown is nearest to a height.
    pub fn place(&self, y: f64) -> usize {
        let row = ((y - self.top as f64) / self.row as f64).max(0.0) as usize;
        self.first + row.min(self.shown - 1)
    }

    /// The opacity that a place of the track stands for, in whole hundredths.
    pub fn opacity(&self, x: f64) -> f64 {
        let share = (x - self.track() as f64) / (TRACK_WIDTH * self.scale) as f64;
        (share.clamp(0.0, 1.0) * 100.0).round() / 100.0
    }

    /// Whether formulas are shown beside the colours.
    pub fn has_formulas(&self) -> bool {
        self.letters > 0
    }

    /// Whether there are more than are shown.
    pub fn scrolls(&self) -> bool {
        self.shown < self.count
    }

    fn formula(&self) -> usize {
        self.left + (SWATCH + 2 * SPACE) * self.scale
    }

    fn track(&self) -> usize {
        self.delete() - (TRACK_WIDTH + SPACE) * self.scale
    }

    fn delete(&self) -> usize {
        self.left + self.width - (DELETE + SPACE) * self.scale
    }

    /// Draws the list, the row under the pointer brighter; of one that is dragged, where it would go.
    pub fn draw(
        &self,
        canvas: &mut Canvas,
        surfaces: &[Listed],
        hovered: Option<(usize, Part)>,
        dragged: Option<(usize, usize)>,
    ) {
        let dot = self.scale as i64;
        let height = (self.shown + usize::from(self.scrolls())) * self.row;
        canvas.fill(self.left as i64, self.top as i64, self.width, height, GROUND, 208);
        let shown = surfaces.iter().enumerate().skip(self.first).take(self.shown);
        for (place, (index, surface)) in shown.enumerate() {
            let part = hovered.filter(|(other, _)| *other == index).map(|(_, part)| part);
            let is_bright = part.is_some() || dragged.is_some_and(|(from, _)| from == index);
            let top = (self.top + place * self.row) as i64;
            self.swatch(canvas, surface, top, part == Some(Part::Swatch));
            if self.letters == 0 {
                continue;
            }
            let ink = match (surface.hidden, is_bright) {
                (true, _) => HIDDEN,
                (false, true) => BRIGHT,
                (false, false) => INK,
            };
            let formula = canvas.fitting(&surface.echo, self.letters * canvas.advance());
            canvas.write(&formula, self.formula() as i64, top + 2 * dot, ink);
            let (track, middle) = (self.track() as i64, top + self.row as i64 / 2 - dot);
            let wide = TRACK_WIDTH * self.scale;
            let filled = (surface.opacity * wide as f64).round() as usize;
            canvas.fill(track, middle, wide, 2 * self.scale, TRACK, 255);
            let colour = if surface.hidden { HIDDEN } else { CHOSEN };
            canvas.fill(track, middle, filled, 2 * self.scale, colour, 255);
            let handle = track + filled as i64 - dot;
            canvas.fill(handle, top + 5 * dot, 3 * self.scale, 10 * self.scale, ink, 255);
            let ink = if part == Some(Part::Delete) { BRIGHT } else { HIDDEN };
            canvas.write("×", self.delete() as i64 + 2 * dot, top + 2 * dot, ink);
        }
        if let Some((from, to)) = dragged.filter(|(from, to)| from != to) {
            let below = usize::from(to > from);
            let line = self.top + (to + below - self.first) * self.row;
            let (y, thick) = (line as i64 - dot, 2 * self.scale);
            canvas.fill(self.left as i64, y, self.width, thick, CHOSEN, 255);
        }
        if self.scrolls() {
            let top = (self.top + self.shown * self.row) as i64;
            let range = format!("{}-{}", self.first + 1, self.first + self.shown);
            let text = if self.letters == 0 { range } else { format!("{range} of {}", self.count) };
            canvas.write(&text, self.left as i64 + 3 * dot, top + 2 * dot, HIDDEN);
        }
    }

    /// Its colours, or a frame of them if it is hidden.
    fn swatch(&self, canvas: &mut Canvas, surface: &Listed, top: i64, is_bright: bool) {
        let scale = self.scale;
        let (left, top) = ((self.left + SPACE * scale) as i64, top + 4 * scale as i64);
        let (wide, high) = (SWATCH * scale, 12 * scale);
        let frame = if is_bright { BRIGHT } else { TRACK };
        canvas.fill(left, top, wide, high, frame, 255);
        let count = surface.colours.len().max(1);
        let inner = wide - 2 * scale;
        for (n, rgb) in surface.colours.iter().enumerate() {
            let (from, to) = (n * inner / count, (n + 1) * inner / count);
            let colour = u32::from_be_bytes([0, rgb[0], rgb[1], rgb[2]]);
            let x = left + (scale + from) as i64;
            canvas.fill(x, top + scale as i64, to - from, high - 2 * scale, colour, 255);
        }
        if surface.hidden {
            let x = left + 3 * scale as i64;
            let (wide, high) = (wide - 6 * scale, high - 6 * scale);
            canvas.fill(x, top + 3 * scale as i64, wide, high, GROUND, 255);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn canvas(scale: usize) -> Canvas {
        Canvas::new(0, 0, Vec::new(), scale)
    }

    #[test]
    fn every_part_is_found_where_it_is_drawn() {
        for (size, scale) in [((800, 600), 1), ((1600, 1180), 2), ((1000, 300), 1)] {
            let list = List::new(3, 0, 270 * scale, size, &canvas(scale)).expect("room");
            assert!(list.left >= 270 * scale && list.left + list.width == size.0);
            let y = (list.top + list.row + list.row / 2) as f64;
            let part = |x: usize| list.at((x as f64, y));
            assert_eq!(part(list.left + 8 * scale), Some((1, Part::Swatch)));
            assert_eq!(part(list.formula() + 8 * scale), Some((1, Part::Formula)));
            let half = list.track() + TRACK_WIDTH * scale / 2;
            assert_eq!(part(half), Some((1, Part::Opacity(0.5))));
            assert_eq!(part(list.delete() + 4 * scale), Some((1, Part::Delete)));
            assert_eq!(part(list.left - 1), None);
            assert_eq!(list.at((half as f64, 3.0)), None);
            assert_eq!((list.opacity(0.0), list.opacity(1e9)), (0.0, 1.0));
            assert_eq!((list.place(0.0), list.place(y), list.place(1e9)), (0, 1, 2));
        }
    }

    #[test]
    fn little_room_leaves_colours_and_none_leaves_nothing() {
        let list = List::new(3, 0, 0, (240, 200), &canvas(1)).expect("room for colours");
        assert_eq!((list.letters, list.at((230.0, 30.0))), (0, Some((0, Part::Swatch))));
        assert_eq!(List::new(3, 0, 0, (100, 90), &canvas(1)), None);
        assert_eq!(List::new(0, 0, 0, (800, 600), &canvas(1)), None);
        let many = List::new(20, 100, 0, (800, 600), &canvas(1)).expect("room");
        assert!((many.first, many.shown) == (12, 8) && many.scrolls());
    }
}
