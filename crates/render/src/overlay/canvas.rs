//! Drawing letters, lines and boxes into an image. The letters are Noto Sans Mono (SIL Open Font
//! License 1.1), rasterized by the crate `noto-sans-mono-bitmap`.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

const WEIGHT: FontWeight = FontWeight::Regular;
const HEIGHT: RasterHeight = RasterHeight::Size16;

/// The letter π, which the font lacks, in the same height and weight as the font.
const PI: [[u8; 7]; 16] = {
    let none = [0; 7];
    let bar = [90, 235, 250, 250, 250, 235, 90];
    let legs = [0, 80, 220, 0, 60, 235, 0];
    let feet = [0, 110, 190, 0, 25, 225, 70];
    [none, none, none, none, none, none, bar, legs, legs, legs, legs, legs, feet, none, none, none]
};

/// A color as 0xRRGGBB.
pub type Rgb = u32;

/// Mixes `new` into `old`, with `share` / 255 as the share of `new`.
fn mixed(old: [u8; 3], new: [u8; 3], share: u32) -> [u8; 3] {
    let part = |n: usize| (u32::from(old[n]) * (255 - share) + u32::from(new[n]) * share) / 255;
    [0, 1, 2].map(|n| part(n) as u8)
}

/// An image with one number per pixel, as windows use it.
pub struct Canvas {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Pixels, row by row from the top. Empty if drawings are recorded instead, for
    /// [`Canvas::mix_into`].
    pub pixels: Vec<Rgb>,
    /// Width and height of a letter's dot, in pixels.
    pub scale: usize,
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
    /// `scale` is the width and height of a letter's dot, in pixels.
    pub fn new(width: usize, height: usize, pixels: Vec<Rgb>, scale: usize) -> Self {
        Self { width, height, pixels, scale, marks: Vec::new() }
    }

    /// Mixes the recorded drawings into an image of red, green and blue bytes, whose first row is
    /// row `top` of the canvas.
    pub fn mix_into(&self, rgb: &mut [u8], top: usize) {
        let (pixels, first) = (rgb.as_chunks_mut::<3>().0, top * self.width);
        for Mark { pixel, color, share } in &self.marks {
            if let Some(pixel) = pixel.checked_sub(first).and_then(|there| pixels.get_mut(there)) {
                let [_, parts @ ..] = color.to_be_bytes();
                *pixel = mixed(*pixel, parts, u32::from(*share));
            }
        }
    }

    /// Width of a letter in pixels.
    pub fn advance(&self) -> usize {
        get_raster_width(WEIGHT, HEIGHT) * self.scale
    }

    /// Width of a line of text in pixels.
    pub fn text_width(&self, text: &str) -> usize {
        text.chars().count() * self.advance()
    }

    /// Height of a letter in pixels.
    pub fn letter_height(&self) -> usize {
        HEIGHT.val() * self.scale
    }

    /// Height of a line of text in pixels, including space between lines.
    pub fn line_height(&self) -> usize {
        Self::line_height_at(self.scale)
    }

    /// Like [`Canvas::line_height`], for letters of this scale.
    pub fn line_height_at(scale: usize) -> usize {
        (HEIGHT.val() + 4) * scale
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
        let advance = self.advance() as i64;
        for (place, letter) in (0_i64..).zip(text.chars()) {
            let left = x + place * advance;
            if left >= self.width as i64 {
                break;
            }
            if letter == 'π' {
                self.dots(left, y, PI.iter().map(<[u8; 7]>::as_slice), color);
                continue;
            }
            let glyph = get_raster(letter, WEIGHT, HEIGHT)
                .or_else(|| get_raster(if letter == ' ' { '_' } else { '?' }, WEIGHT, HEIGHT));
            let Some(glyph) = glyph else { continue };
            self.dots(left, y, glyph.rows(), color);
        }
    }

    /// Draws a letter from the coverage of its dots, given in rows.
    fn dots<'a>(&mut self, x: i64, y: i64, rows: impl Iterator<Item = &'a [u8]>, color: Rgb) {
        let scale = self.scale as i64;
        for (row, line) in (0_i64..).zip(rows) {
            for (column, &cover) in (0_i64..).zip(line.iter()).filter(|(_, cover)| **cover > 0) {
                for dot in 0..scale * scale {
                    let x = x + column * scale + dot % scale;
                    let y = y + row * scale + dot / scale;
                    self.blend(x, y, color, u32::from(cover));
                }
            }
        }
    }

    /// Writes a line of text on a dark background.
    pub fn label(&mut self, text: &str, x: i64, y: i64, color: Rgb) {
        let width = text.chars().count() * self.advance() + 8 * self.scale;
        self.fill(x, y, width, self.line_height(), 0x0020_2028, 208);
        self.write(text, x + 4 * self.scale as i64, y + 2 * self.scale as i64, color);
    }

    /// The text, shortened to fit a width in pixels. Shortened text ends with two dots.
    pub fn fitting(&self, text: &str, room: usize) -> String {
        let letters = room / self.advance();
        if text.chars().count() <= letters {
            return text.to_owned();
        }
        text.chars().take(letters.saturating_sub(2)).chain("..".chars()).collect()
    }
}
