//! The panel of sliders: layout, drawing, and the value at a position of a track. Knows no mouse
//! and no document.

use super::rows::{RowLayout, SPACE};
use crate::theme::{CHOSEN, DIM, INK, TRACK};
use zeroset_live::Slider;
use zeroset_render::overlay::{Canvas, Rgb, with_minus};

/// Color of the part under the pointer.
const BRIGHT: Rgb = 0x00ff_ffff;

/// Width of a button, greatest width of a name in a small window, and width of a value, in dots of
/// a letter.
const BUTTON: usize = 12;
const NAME: usize = 96;
const VALUE: usize = 72;
/// Longest and shortest track, in dots of a letter.
const LONGEST: usize = 160;
const SHORTEST: usize = 40;

/// A part of a slider's row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SliderPart {
    /// The button that lets the value run.
    Play,
    /// The name and the track.
    Track,
    /// The number.
    Value,
}

/// Everything that the drawing of the panel depends on.
#[derive(Clone, PartialEq)]
pub struct PanelContent {
    pub panel: Panel,
    pub sliders: Vec<Slider>,
    /// Index of the slider under the pointer, and of the one that runs.
    pub hovered: Option<(usize, SliderPart)>,
    pub playing: Option<usize>,
}

impl PanelContent {
    /// Says what a press at the pointer's position does.
    pub fn tip(&self) -> Option<&'static str> {
        let (index, part) = self.hovered?;
        match part {
            SliderPart::Play if self.playing == Some(index) => Some("stop"),
            SliderPart::Play => Some("let it run"),
            SliderPart::Track => None,
            SliderPart::Value => Some("click: edit value and range"),
        }
    }
}

/// Layout of the panel, in pixels of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    pub rows: RowLayout,
    pub width: usize,
    track: (usize, usize),
    scale: f64,
}

impl Panel {
    /// Lays out the panel at the left of a picture, in an area of this width and height in pixels.
    /// Uses the letters of `canvas`. The first `scroll` sliders are scrolled out of view. Returns
    /// `None` without a slider or enough space.
    pub fn new(
        sliders: &[Slider],
        scroll: usize,
        (width, height): (usize, usize),
        canvas: &Canvas,
    ) -> Option<Self> {
        let rows = RowLayout::new(sliders.len(), scroll, height, canvas)?;
        let [space, button, most, value] =
            [SPACE, BUTTON, NAME, VALUE].map(|dots| canvas.dots(dots));
        // In a large window names have more room. They give way to the shortest track.
        let most = most.max(width / 4);
        let others = button + value + 4 * space + canvas.dots(SHORTEST);
        let most = most.min(width.saturating_sub(others));
        let longest = sliders.iter().map(|one| canvas.text_width(&one.name)).max()?.min(most);
        let rest = button + longest + value + 4 * space;
        let track = canvas.dots(LONGEST).min(width.saturating_sub(rest));
        if track < canvas.dots(SHORTEST) {
            return None;
        }
        let left = button + 2 * space + longest;
        let scale = canvas.scale;
        Some(Self { rows, width: rest + track, track: (left, left + track), scale })
    }

    /// Returns the index of the slider at a position, and the part of its row.
    pub fn at(&self, (x, y): (f64, f64)) -> Option<(usize, SliderPart)> {
        let inside = x >= 0.0 && x < self.width as f64;
        let index = self.rows.at(y).filter(|_| inside)?;
        let [space, button] = [SPACE, BUTTON].map(|dots| Canvas::dots_at(dots, self.scale));
        let part = if x < (space / 2 + button) as f64 {
            SliderPart::Play
        } else if x < (self.track.1 + space) as f64 {
            SliderPart::Track
        } else {
            SliderPart::Value
        };
        Some((index, part))
    }

    /// Returns the change of the value for one pixel of the track.
    pub fn step(&self, slider: &Slider) -> f64 {
        (slider.high - slider.low) / (self.track.1 - self.track.0) as f64
    }

    /// Returns the value at a horizontal position on the track.
    pub fn value(&self, slider: &Slider, x: f64) -> f64 {
        slider.low + (x - self.track.0 as f64) * self.step(slider)
    }

    /// Whether a horizontal position is on or near the handle.
    pub fn is_on_handle(&self, slider: &Slider, x: f64) -> bool {
        (x - self.handle(slider)).abs() <= SPACE as f64 * self.scale
    }

    fn handle(&self, slider: &Slider) -> f64 {
        let (left, right) = (self.track.0 as f64, self.track.1 as f64);
        let share = (slider.value - slider.low) / (slider.high - slider.low);
        // If the range overflows, the share is not finite. Then show the handle in the middle.
        left + if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 } * (right - left)
    }

    /// Draws the button of a row: two bars if the value runs, or else a triangle.
    fn draw_button(&self, canvas: &mut Canvas, top: i64, runs: bool, ink: Rgb) {
        let [pad, size, bar] = [SPACE / 2, BUTTON - 4, 3].map(|dots| canvas.dots(dots));
        let (left, top) = (pad as i64, top + (self.rows.height - size) as i64 / 2);
        if runs {
            for x in [left, left + (size - bar) as i64] {
                canvas.fill(x, top, bar, size, ink, 255);
            }
            return;
        }
        for column in 0..size {
            let high = size - column;
            let above = (size - high) as i64 / 2;
            canvas.fill(left + column as i64, top + above, 1, high, ink, 255);
        }
    }
}

impl PanelContent {
    /// Draws the sliders. The one under the pointer is brighter.
    pub fn draw(&self, canvas: &mut Canvas) {
        let Self { panel, sliders, hovered, playing } = self;
        let [dot, pad, space, button] = [1, 2, SPACE, BUTTON].map(|dots| canvas.dots(dots) as i64);
        let [thin, wide, high] = [2, 6, 14].map(|dots| canvas.dots(dots));
        let name_width = (panel.track.0 as i64 - 2 * space - button) as usize;
        panel.rows.draw_ground(canvas, 0, panel.width);
        for (index, top) in panel.rows.each() {
            let slider = &sliders[index];
            let part = hovered.filter(|(other, _)| *other == index).map(|(_, part)| part);
            let ink_of = |is_bright: bool| if is_bright { BRIGHT } else { INK };
            let is_pressed = part == Some(SliderPart::Play);
            panel.draw_button(canvas, top, *playing == Some(index), ink_of(is_pressed));
            let ink = ink_of(part.is_some());
            let name = canvas.fitting(&slider.name, name_width);
            canvas.write(&name, button + space, top + pad, ink);
            let (left, right) = (panel.track.0 as i64, panel.track.1 as i64);
            let middle = top + panel.rows.height as i64 / 2 - dot;
            let handle = panel.handle(slider).round() as i64;
            canvas.fill(left, middle, (right - left) as usize, thin, TRACK, 255);
            canvas.fill(left, middle, (handle - left).max(0) as usize, thin, CHOSEN, 255);
            let (x, y) = (handle - wide as i64 / 2, middle + dot - high as i64 / 2);
            canvas.fill(x, y, wide, high, ink, 255);
            let value = with_minus(&slider.shown(panel.step(slider)));
            let value = canvas.fitting(&value, canvas.dots(VALUE));
            canvas.write(&value, right + space + pad, top + pad, ink);
        }
        panel.rows.write_range(canvas, button + space, DIM, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sliders(count: usize) -> Vec<Slider> {
        let slider = |k: usize| Slider {
            name: format!("r{k}"),
            value: 1.0,
            low: 0.0,
            high: 5.0,
            is_time: false,
        };
        (0..count).map(slider).collect()
    }

    fn canvas(width: usize, height: usize, scale: f64) -> Canvas {
        Canvas::new(width, height, vec![0; width * height], scale)
    }

    #[test]
    fn a_place_on_the_track_is_a_value_and_the_value_s_handle_is_there() {
        for (width, height, scale) in [(800, 620, 1.0), (1600, 1200, 2.5), (300, 200, 1.0)] {
            let sliders = sliders(3);
            let panel = Panel::new(&sliders, 0, (width, height), &canvas(width, height, scale));
            let panel = panel.expect("room");
            let slider = &sliders[1];
            let at = panel.handle(slider);
            assert!((panel.value(slider, at) - 1.0).abs() < 1e-9);
            assert!(panel.is_on_handle(slider, at + 2.0) && !panel.is_on_handle(slider, at + 30.0));
            let y = panel.rows.top as f64 + 1.5 * panel.rows.height as f64;
            assert_eq!(panel.at((at, y)), Some((1, SliderPart::Track)));
            assert_eq!(panel.at((scale * 6.0, y)), Some((1, SliderPart::Play)));
            let number = panel.width as f64 - 20.0 * scale;
            assert_eq!(panel.at((number, y)), Some((1, SliderPart::Value)));
            assert_eq!(panel.at((panel.width as f64 + 1.0, y)), None);
            assert_eq!(panel.at((at, 2.0)), None);
        }
    }

    #[test]
    fn more_than_eight_are_scrolled_and_none_are_where_there_is_no_room() {
        let canvas = canvas(800, 600, 1.0);
        let rows = Panel::new(&sliders(20), 100, (800, 600), &canvas).expect("room").rows;
        assert!((rows.first, rows.shown) == (12, 8) && rows.scrolls());
        assert!(!Panel::new(&sliders(8), 0, (800, 600), &canvas).expect("room").rows.scrolls());
        assert_eq!(Panel::new(&sliders(2), 0, (120, 90), &canvas), None);
        assert_eq!(Panel::new(&[], 0, (800, 600), &canvas), None);
    }
}
