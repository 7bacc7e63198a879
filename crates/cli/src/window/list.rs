//! The list of formulas: layout and drawing of its rows. Knows no mouse and no document.

use super::rows::{RowLayout, SPACE};
use crate::theme::{CHOSEN, GROUND, INK, TRACK};
use zeroset_live::SurfaceEntry;
use zeroset_render::overlay::{Canvas, Rgb, with_minus};

const BRIGHT: Rgb = 0x00ff_ffff;
const HIDDEN: Rgb = 0x0088_8894;

/// Greatest and least width of a formula, in dots of a letter. A narrower list shows only colors.
const LONGEST: usize = 190;
const SHORTEST: usize = 48;
/// Largest share of the window's width that the list takes.
const MAX_WIDTH_SHARE: f64 = 0.55;
/// Widths of a color, of the track of an opacity, and of a button, in dots of a letter.
const SWATCH: usize = 18;
const TRACK_WIDTH: usize = 40;
const BUTTON: usize = 14;

/// The last row's text.
const NEW: &str = "+ formula";

/// A part of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ListPart {
    /// The color. A press hides or shows the surface.
    Swatch,
    /// The formula. A click edits it, and dragging it moves the surface.
    Formula,
    /// The track of the opacity. The number is the opacity at the pointer's position.
    Opacity(f64),
    Delete,
    /// The last row, which adds a formula.
    New,
}

/// Layout of the list, in pixels of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct List {
    pub rows: RowLayout,
    /// Number of formulas. The row after them adds one.
    count: usize,
    left: usize,
    width: usize,
    /// Width of the formulas; 0 if only colors are shown.
    formula_width: usize,
    has_tracks: bool,
    scale: f64,
}

/// Everything that the drawing of the list depends on.
#[derive(Clone, PartialEq)]
pub struct ListContent {
    pub list: List,
    pub formulas: Vec<SurfaceEntry>,
    /// Number of the formulas that are surfaces. Curves and points follow.
    pub surfaces: usize,
    pub hovered: Option<(usize, ListPart)>,
    /// Index of the formula that is edited in the line.
    pub edited: Option<usize>,
    /// Index of the dragged surface, and the index that it would get if dropped.
    pub dragged: Option<(usize, usize)>,
}

impl List {
    /// Lays out the list at the right of an area of this size in pixels, with the letters of
    /// `canvas`. The first `scroll` rows are scrolled out of view. The area's left `taken` columns
    /// are occupied. Returns `None` without enough space.
    pub fn new(
        formulas: &[SurfaceEntry],
        scroll: usize,
        taken: usize,
        (width, height): (usize, usize),
        canvas: &Canvas,
    ) -> Option<Self> {
        let count = formulas.len();
        let rows = RowLayout::new(count + 1, scroll, height, canvas)?;
        let dots = |dots: usize| canvas.dots(dots);
        let colors = dots(SWATCH + 2 * SPACE);
        let track = dots(TRACK_WIDTH + SPACE);
        let buttons = dots(BUTTON + SPACE);
        let most = (MAX_WIDTH_SHARE * width as f64) as usize;
        let free = most.min(width.saturating_sub(taken + dots(2 * SPACE)));
        let texts = formulas.iter().map(|one| canvas.text_width(&shown(one)));
        let wanted = texts.chain([canvas.text_width(NEW)]).max()?.min(dots(LONGEST)) + dots(SPACE);
        // First the tracks give way, then the formulas.
        let has_tracks = free >= colors + track + buttons + wanted.min(dots(2 * SHORTEST));
        let parts = colors + buttons + if has_tracks { track } else { 0 };
        let formula_width =
            Some(wanted.min(free.saturating_sub(parts))).filter(|width| *width >= dots(SHORTEST));
        let own = formula_width.map_or(colors, |width| width + parts);
        if width < (taken + colors).max(4 * colors) {
            return None;
        }
        Some(Self {
            rows,
            count,
            left: width - own,
            width: own,
            formula_width: formula_width.unwrap_or(0),
            has_tracks: has_tracks && formula_width.is_some(),
            scale: canvas.scale,
        })
    }

    /// Returns the index of the formula at a position, and the part of its row.
    pub fn at(&self, (x, y): (f64, f64)) -> Option<(usize, ListPart)> {
        let across = x - self.left as f64;
        let inside = across >= 0.0 && across < self.width as f64;
        let index = self.rows.at(y).filter(|_| inside)?;
        let half = Canvas::dots_at(SPACE, self.scale) / 2;
        let part = if index == self.count {
            ListPart::New
        } else if self.formula_width == 0 || x < self.formula() as f64 {
            ListPart::Swatch
        } else if x < (self.formula() + self.formula_width) as f64 {
            ListPart::Formula
        } else if x < self.delete().saturating_sub(half) as f64 {
            ListPart::Opacity(self.opacity(x))
        } else {
            ListPart::Delete
        };
        Some((index, part))
    }

    /// Returns the opacity at a horizontal position on the track, rounded to hundredths.
    pub fn opacity(&self, x: f64) -> f64 {
        let share = (x - self.track() as f64) / self.dots(TRACK_WIDTH) as f64;
        (share.clamp(0.0, 1.0) * 100.0).round() / 100.0
    }

    /// The first column of the list.
    pub fn left(&self) -> usize {
        self.left
    }

    /// Whether formulas are shown beside the colors.
    pub fn has_formulas(&self) -> bool {
        self.formula_width > 0
    }

    fn dots(&self, dots: usize) -> usize {
        Canvas::dots_at(dots, self.scale)
    }

    fn formula(&self) -> usize {
        self.left + self.dots(SWATCH + 2 * SPACE)
    }

    fn track(&self) -> usize {
        self.delete() - self.dots(TRACK_WIDTH + SPACE)
    }

    fn delete(&self) -> usize {
        self.left + self.width - self.dots(BUTTON + SPACE)
    }

    /// Draws the colors of a formula, or only their frame if it is hidden.
    fn swatch(&self, canvas: &mut Canvas, formula: &SurfaceEntry, top: i64, is_bright: bool) {
        let [dot, pad, high] = [1, SPACE, 12].map(|dots| canvas.dots(dots));
        let (left, top) = ((self.left + pad) as i64, top + (self.rows.height - high) as i64 / 2);
        let wide = canvas.dots(SWATCH);
        let frame = if is_bright { BRIGHT } else { TRACK };
        canvas.fill(left, top, wide, high, frame, 255);
        let count = formula.colors.len().max(1);
        let inner = wide - 2 * dot;
        for (n, rgb) in formula.colors.iter().enumerate() {
            let (from, to) = (n * inner / count, (n + 1) * inner / count);
            let color = u32::from_be_bytes([0, rgb[0], rgb[1], rgb[2]]);
            let x = left + (dot + from) as i64;
            canvas.fill(x, top + dot as i64, to - from, high - 2 * dot, color, 255);
        }
        if formula.hidden {
            let (x, y) = (left + 3 * dot as i64, top + 3 * dot as i64);
            canvas.fill(x, y, wide - 6 * dot, high - 6 * dot, GROUND, 255);
        }
    }

    /// Draws the track of an opacity.
    fn draw_track(&self, canvas: &mut Canvas, formula: &SurfaceEntry, top: i64, ink: Rgb) {
        let [dot, thin, high, wide] = [1, 2, 10, TRACK_WIDTH].map(|dots| canvas.dots(dots));
        let (track, middle) = (self.track() as i64, top + self.rows.height as i64 / 2);
        let filled = (formula.opacity * wide as f64).round() as usize;
        canvas.fill(track, middle - dot as i64, wide, thin, TRACK, 255);
        let color = if formula.hidden { HIDDEN } else { CHOSEN };
        canvas.fill(track, middle - dot as i64, filled, thin, color, 255);
        let handle = track + filled as i64 - dot as i64;
        canvas.fill(handle, middle - high as i64 / 2, 3 * dot, high, ink, 255);
    }
}

/// A formula as the list shows it.
fn shown(formula: &SurfaceEntry) -> String {
    with_minus(&formula.echo)
}

impl ListContent {
    /// Draws the list. The row under the pointer is brighter, and the edited one has a frame. A
    /// line marks the target of a drag.
    pub fn draw(&self, canvas: &mut Canvas) {
        let Self { list, formulas, hovered, edited, dragged, .. } = self;
        let [dot, pad] = [1, 2].map(|dots| canvas.dots(dots) as i64);
        list.rows.draw_ground(canvas, list.left, list.width);
        for (index, top) in list.rows.each() {
            let part = hovered.filter(|(other, _)| *other == index).map(|(_, part)| part);
            let is_bright = part.is_some() || dragged.is_some_and(|(from, _)| from == index);
            let Some(formula) = formulas.get(index) else {
                let left = list.left + canvas.dots(SPACE);
                let text = canvas.fitting(NEW, list.width - canvas.dots(SPACE));
                canvas.write(
                    &text,
                    left as i64,
                    top + pad,
                    if is_bright { BRIGHT } else { CHOSEN },
                );
                continue;
            };
            if *edited == Some(index) {
                canvas.fill(list.left as i64, top, list.width, list.rows.height, CHOSEN, 90);
            }
            list.swatch(canvas, formula, top, part == Some(ListPart::Swatch));
            if list.formula_width == 0 {
                continue;
            }
            let ink = match (formula.hidden, is_bright) {
                (true, _) => HIDDEN,
                (false, true) => BRIGHT,
                (false, false) => INK,
            };
            let text = canvas.fitting(&shown(formula), list.formula_width - pad as usize);
            canvas.write(&text, list.formula() as i64, top + pad, ink);
            if list.has_tracks && index < self.surfaces {
                list.draw_track(canvas, formula, top, ink);
            }
            let ink = if part == Some(ListPart::Delete) { BRIGHT } else { HIDDEN };
            canvas.write("×", list.delete() as i64 + pad, top + pad, ink);
        }
        if let Some((from, to)) = dragged.filter(|(from, to)| from != to) {
            let below = usize::from(to > from);
            let line = list.rows.top + (to + below - list.rows.first) * list.rows.height;
            canvas.fill(list.left as i64, line as i64 - dot, list.width, pad as usize, CHOSEN, 255);
        }
        list.rows.write_range(canvas, list.left as i64 + 3 * dot, HIDDEN, list.has_formulas());
    }

    /// Says what a press at the pointer's position does.
    pub fn tip(&self) -> Option<String> {
        let (index, part) = self.hovered?;
        let formula = self.formulas.get(index);
        Some(match part {
            ListPart::New => "add a formula".to_owned(),
            ListPart::Delete => "delete".to_owned(),
            ListPart::Formula => "click: edit, drag: move".to_owned(),
            ListPart::Swatch if formula.is_some_and(|one| one.hidden) => "show".to_owned(),
            ListPart::Swatch if index < self.surfaces => "click: hide, right: color".to_owned(),
            ListPart::Swatch => "hide".to_owned(),
            ListPart::Opacity(_) => {
                format!("opacity {:.0} %", 100.0 * formula.map_or(1.0, |one| one.opacity))
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::panel::Panel;
    use super::*;
    use zeroset_live::Slider;

    fn canvas(scale: f64) -> Canvas {
        Canvas::new(0, 0, Vec::new(), scale)
    }

    fn formulas(count: usize) -> Vec<SurfaceEntry> {
        let one = |n: usize| SurfaceEntry {
            echo: format!("x^2 + y^2 + z^2 = {n}"),
            colors: vec![[9, 9, 9]],
            opacity: 1.0,
            hidden: false,
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn every_part_is_found_where_it_is_drawn() {
        for (size, scale) in [((800, 600), 1.0), ((1600, 1180), 2.0), ((1000, 300), 1.25)] {
            let pixels = |dots: usize| Canvas::dots_at(dots, scale);
            let taken = pixels(270);
            let list = List::new(&formulas(3), 0, taken, size, &canvas(scale)).expect("room");
            assert!(list.left >= taken && list.left + list.width == size.0 && list.has_tracks);
            let y = (list.rows.top + list.rows.height + list.rows.height / 2) as f64;
            let part = |x: usize| list.at((x as f64, y));
            assert_eq!(part(list.left + pixels(8)), Some((1, ListPart::Swatch)));
            assert_eq!(part(list.formula() + pixels(8)), Some((1, ListPart::Formula)));
            let half = list.track() + pixels(TRACK_WIDTH) / 2;
            assert_eq!(part(half), Some((1, ListPart::Opacity(0.5))));
            assert_eq!(part(list.delete() + pixels(4)), Some((1, ListPart::Delete)));
            assert_eq!(part(list.left - 1), None);
            let last = y + 2.0 * list.rows.height as f64;
            assert_eq!(list.at((half as f64, last)), Some((3, ListPart::New)));
            assert_eq!(list.at((half as f64, 3.0)), None);
            assert_eq!((list.opacity(0.0), list.opacity(1e9)), (0.0, 1.0));
            assert_eq!([0.0, y, 1e9].map(|y| list.rows.nearest(y)), [0, 1, 3]);
        }
    }

    #[test]
    fn sliders_and_list_leave_each_other_room() {
        let slider = |n: usize| Slider {
            name: ["r", "height", "a_rather_long_name"][n % 3].to_owned(),
            value: 1.0,
            low: 0.0,
            high: 2.0,
            is_time: false,
        };
        for (width, height, scale) in [(400, 300, 1.0), (500, 300, 1.0), (1600, 1200, 3.0)] {
            for count in 1..12 {
                let sliders: Vec<Slider> = (0..count).map(slider).collect();
                let (canvas, free) = (canvas(scale), height - Canvas::dots_at(60, scale));
                let panel = Panel::new(&sliders, 0, (width / 2, free), &canvas).expect("room");
                let list = List::new(&formulas(count), 0, panel.width, (width, free), &canvas);
                let list = list.expect("room");
                assert!(panel.width <= list.left && list.has_formulas(), "{panel:?} {list:?}");
                for rows in [panel.rows, list.rows] {
                    let shown = rows.shown + usize::from(rows.scrolls());
                    assert!(rows.top + shown * rows.height <= free, "{rows:?}");
                }
            }
        }
    }

    #[test]
    fn little_room_leaves_colors_and_none_leaves_nothing() {
        let list = List::new(&formulas(3), 0, 200, (260, 200), &canvas(1.0));
        let list = list.expect("room for colors");
        assert_eq!((list.formula_width, list.at((250.0, 12.0))), (0, Some((0, ListPart::Swatch))));
        assert_eq!(List::new(&formulas(3), 0, 0, (100, 90), &canvas(1.0)), None);
        let list = List::new(&formulas(3), 0, 0, (240, 200), &canvas(1.0)).expect("room");
        assert!(list.has_formulas() && !list.has_tracks);
        let many = List::new(&formulas(20), 100, 0, (800, 600), &canvas(1.0)).expect("room").rows;
        assert!((many.first, many.shown) == (13, 8) && many.scrolls());
    }
}
