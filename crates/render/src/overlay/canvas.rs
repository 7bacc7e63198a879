//! Drawing letters, lines and boxes into an image.

use super::letters::{glyph, width};
use crate::picture::Picture;
use crate::pixels::{mix_over, mixed, mixed_over};
use glam::Vec4;
use std::collections::BTreeMap;

/// Height of a letter's box, and of a line of text, in dots. A dot is a pixel at scale 1.
const LETTER: usize = 16;
const LINE: usize = 20;

/// Width of the rim around letters in dots, and its opacity as a share of 255.
const HALO: usize = 1;
const HALO_SHARE: u32 = 200;

/// A color as 0xRRGGBB.
pub type Rgb = u32;

/// An image with one number per pixel, as windows use it.
pub struct Canvas {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Pixels, row by row from the top. Empty if drawings are recorded instead, for
    /// [`Canvas::mix_into_picture`].
    pub pixels: Vec<Rgb>,
    /// Size of letters and of all that is drawn with them: the size of a dot in pixels.
    pub scale: f64,
    /// Recorded drawings, if there are no pixels.
    marks: Vec<Mark>,
}

/// A color that is to be mixed into the pixel with this index, with `share` / 255 as its share.
struct Mark {
    pixel: usize,
    color: Rgb,
    share: u8,
}

impl Canvas {
    /// Creates a canvas with these pixels. If `pixels` is empty, the canvas records drawings.
    /// `scale` is the size of a dot in pixels.
    pub fn new(width: usize, height: usize, pixels: Vec<Rgb>, scale: f64) -> Self {
        Self { width, height, pixels, scale, marks: Vec::new() }
    }

    /// Mixes the recorded drawings into an image of red, green and blue bytes, whose first row is
    /// row `top` of the canvas. `alpha` has the opacities of its pixels, or is empty.
    pub fn mix_into(&self, rgb: &mut [u8], alpha: &mut [u8], top: usize) {
        let pixels = rgb.as_chunks_mut::<3>().0;
        for (there, color, share) in self.marks_from(top) {
            let Some(pixel) = pixels.get_mut(there) else { continue };
            mix_over(pixel, alpha.get_mut(there), color, share.into());
        }
    }

    /// Mixes the recorded drawings into a picture, or into a strip that begins at row `top`.
    pub fn mix_into_picture(&self, picture: &mut Picture, top: usize) {
        self.mix_into(&mut picture.rgb, &mut picture.alpha, top);
        if picture.light.is_empty() {
            return;
        }
        for (there, color, share) in self.marks_from(top) {
            let Some(light) = picture.light.get_mut(there) else { continue };
            let own = Vec4::from_array(*light);
            *light = mixed_over(own, color, f32::from(share) / 255.0).to_array();
        }
    }

    /// The recorded drawings from this row on: the pixel, counted from the row's first, the color,
    /// and its share of 255.
    fn marks_from(&self, top: usize) -> impl Iterator<Item = (usize, [u8; 3], u8)> {
        self.marks.iter().filter_map(move |&Mark { pixel, color, share }| {
            let [_, parts @ ..] = color.to_be_bytes();
            Some((pixel.checked_sub(top * self.width)?, parts, share))
        })
    }

    /// Returns a number of dots in pixels.
    pub fn dots(&self, dots: usize) -> usize {
        Self::dots_at(dots, self.scale)
    }

    /// Like [`Canvas::dots`], at this scale. A dot is never lost.
    pub fn dots_at(dots: usize, scale: f64) -> usize {
        ((dots as f64 * scale).round() as usize).max(usize::from(dots > 0))
    }

    /// Width of a line of text in pixels.
    pub fn text_width(&self, text: &str) -> usize {
        width(text, self.scale).ceil() as usize
    }

    /// Height of a letter's box in pixels.
    pub fn letter_height(&self) -> usize {
        self.dots(LETTER)
    }

    /// Height of a line of text in pixels, including space between lines.
    pub fn line_height(&self) -> usize {
        Self::line_height_at(self.scale)
    }

    /// Like [`Canvas::line_height`], for letters of this scale.
    pub fn line_height_at(scale: f64) -> usize {
        Self::dots_at(LINE, scale)
    }

    /// Mixes `color` into a pixel, with `share` / 255 as its share. Pixels outside the canvas are
    /// ignored.
    pub fn blend(&mut self, x: i64, y: i64, color: Rgb, share: u32) {
        let inside = |at: i64, size: usize| at >= 0 && at < size as i64;
        if !(inside(x, self.width) && inside(y, self.height)) {
            return;
        }
        let place = y as usize * self.width + x as usize;
        let Some(pixel) = self.pixels.get_mut(place) else {
            self.marks.push(Mark { pixel: place, color, share: share as u8 });
            return;
        };
        let [_, old @ ..] = pixel.to_be_bytes();
        let [_, new @ ..] = color.to_be_bytes();
        let [red, green, blue] = mixed(old, new, share);
        *pixel = u32::from_be_bytes([0, red, green, blue]);
    }

    /// Mixes `color` into a rectangle.
    pub fn fill(&mut self, x: i64, y: i64, width: usize, height: usize, color: Rgb, share: u32) {
        for y in y.max(0)..(y + height as i64).min(self.height as i64) {
            for x in x.max(0)..(x + width as i64).min(self.width as i64) {
                self.blend(x, y, color, share);
            }
        }
    }

    /// Copies an image of this width to a position. Parts outside the canvas are cut off.
    pub fn paste(&mut self, pixels: &[Rgb], width: usize, (left, top): (usize, usize)) {
        let shown = width.min(self.width.saturating_sub(left));
        let rows = self.pixels.chunks_exact_mut(self.width).skip(top);
        for (row, new) in rows.zip(pixels.chunks_exact(width)).filter(|_| shown > 0) {
            row[left..left + shown].copy_from_slice(&new[..shown]);
        }
    }

    /// Draws a frame along the edges of the canvas.
    pub fn border(&mut self, thickness: usize, color: Rgb) {
        let (w, h, t) = (self.width, self.height, thickness);
        self.fill(0, 0, w, t, color, 255);
        self.fill(0, h as i64 - t as i64, w, t, color, 255);
        self.fill(0, 0, t, h, color, 255);
        self.fill(w as i64 - t as i64, 0, t, h, color, 255);
    }

    /// Writes a line of text with its upper left corner at this position. Letters that the font
    /// lacks become question marks.
    pub fn write(&mut self, text: &str, x: i64, y: i64, color: Rgb) {
        for (x, y, cover) in self.covered(text, x, y) {
            self.blend(x, y, color, cover);
        }
    }

    /// Writes a line of text like [`Canvas::write`], with a rim of the color `halo` around each
    /// letter, so that it can be read over anything.
    pub fn write_with_halo(&mut self, text: &str, x: i64, y: i64, [color, halo]: [Rgb; 2]) {
        let covered = self.covered(text, x, y);
        let reach = self.dots(HALO) as i64;
        let around =
            || (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| (dx, dy)));
        let in_reach = |(dx, dy): &(i64, i64)| dx * dx + dy * dy <= reach * reach + 1;
        // Rims of neighboring pixels do not add up.
        let mut rim: BTreeMap<(i64, i64), u32> = BTreeMap::new();
        for &(x, y, cover) in &covered {
            for (dx, dy) in around().filter(in_reach) {
                let share = rim.entry((y + dy, x + dx)).or_insert(0);
                *share = (*share).max(cover * HALO_SHARE / 255);
            }
        }
        for ((y, x), share) in rim {
            self.blend(x, y, halo, share);
        }
        for (x, y, cover) in covered {
            self.blend(x, y, color, cover);
        }
    }

    /// The pixels that a line of text covers, each with its share of 255.
    fn covered(&self, text: &str, x: i64, y: i64) -> Vec<(i64, i64, u32)> {
        let (mut pen, mut covered) = (0.0, Vec::new());
        for letter in text.chars() {
            let glyph = glyph(letter, self.scale);
            let left = x + f64::round(pen) as i64;
            if left >= self.width as i64 {
                break;
            }
            for (n, cover) in (0_i64..).zip(&glyph.cover).filter(|(_, cover)| **cover > 0) {
                let (row, column) = (n / glyph.width, n % glyph.width);
                covered.push((left + glyph.left + column, y + glyph.top + row, u32::from(*cover)));
            }
            pen += glyph.advance;
        }
        covered
    }

    /// Writes a line of text on a dark background.
    pub fn label(&mut self, text: &str, x: i64, y: i64, color: Rgb) {
        let width = self.text_width(text) + self.dots(8);
        self.fill(x, y, width, self.line_height(), 0x0020_2028, 208);
        self.write(text, x + self.dots(4) as i64, y + self.dots(2) as i64, color);
    }

    /// The text, shortened to fit a width in pixels. Shortened text ends with an ellipsis.
    pub fn fitting(&self, text: &str, room: usize) -> String {
        if self.text_width(text) <= room {
            return text.to_owned();
        }
        let free = room.saturating_sub(self.text_width("…"));
        let mut kept: String = text[..self.fitting_bytes(text, free)].trim_end().to_owned();
        kept.push('…');
        kept
    }

    /// Number of bytes of the longest beginning of the text that fits a width in pixels.
    pub fn fitting_bytes(&self, text: &str, room: usize) -> usize {
        let mut pen = 0.0;
        let fits = |(_, letter): &(usize, char)| {
            pen += glyph(*letter, self.scale).advance;
            f64::ceil(pen) as usize <= room
        };
        let last = text.char_indices().take_while(fits).last();
        last.map_or(0, |(at, letter)| at + letter.len_utf8())
    }
}
