//! The list of surfaces: layout and drawing of its rows. Knows no mouse and no document.

use super::rows::{RowLayout, SPACE};
use crate::theme::{CHOSEN, GROUND, INK, TRACK};
use zeroset_live::SurfaceEntry;
use zeroset_render::overlay::{Canvas, Rgb};

const BRIGHT: Rgb = 0x00ff_ffff;
const HIDDEN: Rgb = 0x0088_8894;

/// Largest and smallest number of letters shown of a formula. A narrower list shows only colors.
const MAX_LETTERS: usize = 24;
const MIN_LETTERS: usize = 8;
/// Largest share of the window's width that the list takes.
const MAX_WIDTH_SHARE: f64 = 0.55;
/// Widths of a color, of the track of an opacity, and of the delete sign, in font pixels.
const SWATCH: usize = 18;
const TRACK_WIDTH: usize = 40;
const DELETE: usize = 12;

/// A part of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ListPart {
    /// The color. A press hides or shows the surface.
    Swatch,
    /// The formula. Dragging it moves the surface.
    Formula,
    /// The track of the opacity. The number is the opacity at the pointer's position.
    Opacity(f64),
    Delete,
}

/// Layout of the list, in pixels of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct List {
    pub rows: RowLayout,
    left: usize,
    width: usize,
    /// Number of letters shown of each formula; 0 if only colors are shown.
    letters: usize,
    scale: usize,
}

/// Everything that the drawing of the list depends on.
#[derive(Clone, PartialEq)]
pub struct ListContent {
    pub list: List,
    pub surfaces: Vec<SurfaceEntry>,
    pub hovered: Option<(usize, ListPart)>,
    /// Index of the dragged surface, and the index that it would get if dropped.
    pub dragged: Option<(usize, usize)>,
}

impl List {
    /// Lays out the list at the right of a picture of this size in pixels, with the letters of
    /// `canvas`. The list has `count` surfaces, and the first `scroll` are scrolled out of view.
    /// The picture's left `taken` columns are occupied. Returns `None` without a surface or enough
    /// space.
    pub fn new(
        count: usize,
        scroll: usize,
        taken: usize,
        (width, height): (usize, usize),
        canvas: &Canvas,
    ) -> Option<Self> {
        // The last line of the picture is reserved for messages.
        let bottom = height.saturating_sub(canvas.line_height());
        let rows = RowLayout::new(count, scroll, bottom, canvas)?;
        let (scale, letter) = (canvas.scale, canvas.advance());
        let plain = (SWATCH + 2 * SPACE) * scale;
        let parts = (TRACK_WIDTH + DELETE + 3 * SPACE) * scale;
        let most = (MAX_WIDTH_SHARE * width as f64) as usize;
        let free = most.min(width.saturating_sub(taken + 2 * SPACE * scale));
        let free = free.saturating_sub(plain + parts);
        let letters =
            Some((free / letter).min(MAX_LETTERS)).filter(|letters| *letters >= MIN_LETTERS);
        let own = letters.map_or(plain, |letters| plain + letters * letter + parts);
        if width < (taken + plain).max(4 * plain) {
            return None;
        }
        Some(Self { rows, left: width - own, width: own, letters: letters.unwrap_or(0), scale })
    }

    /// Returns the index of the surface at a position, and the part of its row.
    pub fn at(&self, (x, y): (f64, f64)) -> Option<(usize, ListPart)> {
        let across = x - self.left as f64;
        let inside = across >= 0.0 && across < self.width as f64;
        let index = self.rows.at(y).filter(|_| inside)?;
        let x = x as usize;
        let part = if self.letters == 0 || x < self.formula() {
            ListPart::Swatch
        } else if x < self.track() - SPACE * self.scale / 2 {
            ListPart::Formula
        } else if x < self.delete() - SPACE * self.scale / 2 {
            ListPart::Opacity(self.opacity(x as f64))
        } else {
            ListPart::Delete
        };
        Some((index, part))
    }

    /// Returns the opacity at a horizontal position on the track, rounded to hundredths.
    pub fn opacity(&self, x: f64) -> f64 {
        let share = (x - self.track() as f64) / (TRACK_WIDTH * self.scale) as f64;
        (share.clamp(0.0, 1.0) * 100.0).round() / 100.0
    }

    /// Whether formulas are shown beside the colors.
    pub fn has_formulas(&self) -> bool {
        self.letters > 0
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

    /// Draws the colors of a surface, or only their frame if it is hidden.
    fn swatch(&self, canvas: &mut Canvas, surface: &SurfaceEntry, top: i64, is_bright: bool) {
        let scale = self.scale;
        let (left, top) = ((self.left + SPACE * scale) as i64, top + 4 * scale as i64);
        let (wide, high) = (SWATCH * scale, 12 * scale);
        let frame = if is_bright { BRIGHT } else { TRACK };
        canvas.fill(left, top, wide, high, frame, 255);
        let count = surface.colors.len().max(1);
        let inner = wide - 2 * scale;
        for (n, rgb) in surface.colors.iter().enumerate() {
            let (from, to) = (n * inner / count, (n + 1) * inner / count);
            let color = u32::from_be_bytes([0, rgb[0], rgb[1], rgb[2]]);
            let x = left + (scale + from) as i64;
            canvas.fill(x, top + scale as i64, to - from, high - 2 * scale, color, 255);
        }
        if surface.hidden {
            let x = left + 3 * scale as i64;
            let (wide, high) = (wide - 6 * scale, high - 6 * scale);
            canvas.fill(x, top + 3 * scale as i64, wide, high, GROUND, 255);
        }
    }
}

impl ListContent {
    /// Draws the list. The row under the pointer is brighter. A line marks the target of a drag.
    pub fn draw(&self, canvas: &mut Canvas) {
        let Self { list, surfaces, hovered, dragged } = self;
        let (scale, dot) = (list.scale, list.scale as i64);
        list.rows.draw_ground(canvas, list.left, list.width);
        for (index, top) in list.rows.each() {
            let surface = &surfaces[index];
            let part = hovered.filter(|(other, _)| *other == index).map(|(_, part)| part);
            let is_bright = part.is_some() || dragged.is_some_and(|(from, _)| from == index);
            list.swatch(canvas, surface, top, part == Some(ListPart::Swatch));
            if list.letters == 0 {
                continue;
            }
            let ink = match (surface.hidden, is_bright) {
                (true, _) => HIDDEN,
                (false, true) => BRIGHT,
                (false, false) => INK,
            };
            let formula = canvas.fitting(&surface.echo, list.letters * canvas.advance());
            canvas.write(&formula, list.formula() as i64, top + 2 * dot, ink);
            let (track, middle) = (list.track() as i64, top + list.rows.height as i64 / 2 - dot);
            let wide = TRACK_WIDTH * scale;
            let filled = (surface.opacity * wide as f64).round() as usize;
            canvas.fill(track, middle, wide, 2 * scale, TRACK, 255);
            let color = if surface.hidden { HIDDEN } else { CHOSEN };
            canvas.fill(track, middle, filled, 2 * scale, color, 255);
            let handle = track + filled as i64 - dot;
            canvas.fill(handle, top + 5 * dot, 3 * scale, 10 * scale, ink, 255);
            let ink = if part == Some(ListPart::Delete) { BRIGHT } else { HIDDEN };
            canvas.write("×", list.delete() as i64 + 2 * dot, top + 2 * dot, ink);
        }
        if let Some((from, to)) = dragged.filter(|(from, to)| from != to) {
            let below = usize::from(to > from);
            let line = list.rows.top + (to + below - list.rows.first) * list.rows.height;
            let (y, thick) = (line as i64 - dot, 2 * scale);
            canvas.fill(list.left as i64, y, list.width, thick, CHOSEN, 255);
        }
        list.rows.write_range(canvas, list.left as i64 + 3 * dot, HIDDEN, list.has_formulas());
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
            let y = (list.rows.top + list.rows.height + list.rows.height / 2) as f64;
            let part = |x: usize| list.at((x as f64, y));
            assert_eq!(part(list.left + 8 * scale), Some((1, ListPart::Swatch)));
            assert_eq!(part(list.formula() + 8 * scale), Some((1, ListPart::Formula)));
            let half = list.track() + TRACK_WIDTH * scale / 2;
            assert_eq!(part(half), Some((1, ListPart::Opacity(0.5))));
            assert_eq!(part(list.delete() + 4 * scale), Some((1, ListPart::Delete)));
            assert_eq!(part(list.left - 1), None);
            assert_eq!(list.at((half as f64, 3.0)), None);
            assert_eq!((list.opacity(0.0), list.opacity(1e9)), (0.0, 1.0));
            assert_eq!([0.0, y, 1e9].map(|y| list.rows.nearest(y)), [0, 1, 2]);
        }
    }

    #[test]
    fn little_room_leaves_colors_and_none_leaves_nothing() {
        let list = List::new(3, 0, 0, (240, 200), &canvas(1)).expect("room for colors");
        assert_eq!((list.letters, list.at((230.0, 30.0))), (0, Some((0, ListPart::Swatch))));
        assert_eq!(List::new(3, 0, 0, (100, 90), &canvas(1)), None);
        assert_eq!(List::new(0, 0, 0, (800, 600), &canvas(1)), None);
        let many = List::new(20, 100, 0, (800, 600), &canvas(1)).expect("room").rows;
        assert!((many.first, many.shown) == (12, 8) && many.scrolls());
    }
}
