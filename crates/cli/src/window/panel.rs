//! The panel of sliders: layout, drawing, and the value at a position of a track. Knows no mouse
//! and no document.

use super::rows::{RowLayout, SPACE};
use crate::theme::{CHOSEN, DIM, INK, TRACK};
use zeroset_live::Slider;
use zeroset_render::overlay::Canvas;

/// Largest number of letters shown of a name, and of a value.
const NAME: usize = 8;
const VALUE: usize = 9;
/// Longest and shortest track, in font pixels.
const LONGEST: usize = 160;
const SHORTEST: usize = 40;

/// Layout of the panel, in pixels of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    pub rows: RowLayout,
    pub width: usize,
    track: (usize, usize),
    scale: usize,
}

impl Panel {
    /// Lays out the panel at the left of a picture of this size in pixels, below its first line.
    /// Uses the letters of `canvas`. The first `scroll` sliders are scrolled out of view. Returns
    /// `None` without a slider or enough space.
    pub fn new(
        sliders: &[Slider],
        scroll: usize,
        (width, height): (usize, usize),
        canvas: &Canvas,
    ) -> Option<Self> {
        let rows = RowLayout::new(sliders.len(), scroll, height, canvas)?;
        let (scale, letter) = (canvas.scale, canvas.advance());
        let longest = sliders.iter().map(|one| one.name.chars().count()).max()?.min(NAME);
        let space = SPACE * scale;
        let letters = (longest + VALUE) * letter + 4 * space;
        let track = (LONGEST * scale).min(width.saturating_sub(letters));
        if track < SHORTEST * scale {
            return None;
        }
        let left = 2 * space + longest * letter;
        Some(Self { rows, width: letters + track, track: (left, left + track), scale })
    }

    /// Returns the index of the slider at a position.
    pub fn at(&self, (x, y): (f64, f64)) -> Option<usize> {
        let inside = x >= 0.0 && x < self.width as f64;
        self.rows.at(y).filter(|_| inside)
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
        (x - self.handle(slider)).abs() <= (SPACE * self.scale) as f64
    }

    fn handle(&self, slider: &Slider) -> f64 {
        let (left, right) = (self.track.0 as f64, self.track.1 as f64);
        let share = (slider.value - slider.low) / (slider.high - slider.low);
        // If the range overflows, the share is not finite. Then show the handle in the middle.
        left + if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 } * (right - left)
    }

    /// Draws the sliders. The one under the pointer is brighter.
    pub fn draw(&self, canvas: &mut Canvas, sliders: &[Slider], hovered: Option<usize>) {
        let dot = self.scale as i64;
        let space = SPACE as i64 * dot;
        self.rows.draw_ground(canvas, 0, self.width);
        for (index, top) in self.rows.each() {
            let slider = &sliders[index];
            let ink = if hovered == Some(index) { 0x00ff_ffff } else { INK };
            let name: String = slider.name.chars().take(NAME).collect();
            canvas.write(&name, space, top + 2 * dot, ink);
            let (left, right) = (self.track.0 as i64, self.track.1 as i64);
            let (middle, thin) = (top + self.rows.height as i64 / 2 - dot, 2 * self.scale);
            let handle = self.handle(slider).round() as i64;
            canvas.fill(left, middle, (right - left) as usize, thin, TRACK, 255);
            canvas.fill(left, middle, (handle - left).max(0) as usize, thin, CHOSEN, 255);
            let (wide, high) = (6 * self.scale, 14 * self.scale);
            canvas.fill(handle - 3 * dot, top + 3 * dot, wide, high, ink, 255);
            let value: String = slider.shown(self.step(slider)).chars().take(VALUE).collect();
            canvas.write(&value, right + space + 2 * dot, top + 2 * dot, ink);
        }
        self.rows.write_range(canvas, space, DIM, true);
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

    fn canvas(width: usize, height: usize, scale: usize) -> Canvas {
        Canvas::new(width, height, vec![0; width * height], scale)
    }

    #[test]
    fn a_place_on_the_track_is_a_value_and_the_value_s_handle_is_there() {
        for (width, height, scale) in [(800, 620, 1), (1600, 1200, 2), (300, 200, 1)] {
            let sliders = sliders(3);
            let panel = Panel::new(&sliders, 0, (width, height), &canvas(width, height, scale));
            let panel = panel.expect("room");
            let slider = &sliders[1];
            let at = panel.handle(slider);
            assert!((panel.value(slider, at) - 1.0).abs() < 1e-9);
            assert!(panel.is_on_handle(slider, at + 2.0) && !panel.is_on_handle(slider, at + 30.0));
            let y = panel.rows.top as f64 + 1.5 * panel.rows.height as f64;
            assert_eq!(panel.at((at, y)), Some(1));
            assert_eq!(panel.at((panel.width as f64 + 1.0, y)), None);
            assert_eq!(panel.at((at, 2.0)), None);
        }
    }

    #[test]
    fn more_than_eight_are_scrolled_and_none_are_where_there_is_no_room() {
        let canvas = canvas(800, 600, 1);
        let rows = Panel::new(&sliders(20), 100, (800, 600), &canvas).expect("room").rows;
        assert!((rows.first, rows.shown) == (12, 8) && rows.scrolls());
        assert!(!Panel::new(&sliders(8), 0, (800, 600), &canvas).expect("room").rows.scrolls());
        assert_eq!(Panel::new(&sliders(2), 0, (120, 90), &canvas), None);
        assert_eq!(Panel::new(&[], 0, (800, 600), &canvas), None);
    }
}
