//! Letters at any size. The font is that of the crate `dejavu`, and its license is in the file
//! `LICENSE-DEJAVU`.

use ab_glyph::{Font, FontRef, PxScale, point};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Size of the font at scale 1, in pixels: the side of the square for which letters are designed.
const SIZE: f64 = 13.0;
/// Distance of the baseline from the top of a letter's box at scale 1, in pixels.
const BASELINE: f64 = 12.6;
/// Greatest number of letters that are kept for the next time.
const MOST_KEPT: usize = 4096;

/// A letter at some size.
pub struct Glyph {
    /// Position of the upper left pixel: right of the pen, and below the top of the letter's box.
    pub left: i64,
    pub top: i64,
    /// Number of pixels in a row, or 1 for a letter without pixels.
    pub width: i64,
    /// Coverage of the pixels, row by row.
    pub cover: Vec<u8>,
    /// Distance to the next letter, in pixels.
    pub advance: f64,
}

/// Letters by their size in thousandths.
type Kept = HashMap<(char, u32), Arc<Glyph>>;

static FONT: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(dejavu::sans::regular()).ok());
static KEPT: LazyLock<Mutex<Kept>> = LazyLock::new(Mutex::default);

/// Returns a letter at this scale. A letter that the font lacks becomes a question mark.
pub fn glyph(letter: char, scale: f64) -> Arc<Glyph> {
    let key = (letter, (scale * 1e3).round() as u32);
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if kept.len() > MOST_KEPT {
        kept.clear();
    }
    Arc::clone(kept.entry(key).or_insert_with(|| Arc::new(draw(letter, scale))))
}

/// Width of a line of text in pixels.
pub fn width(text: &str, scale: f64) -> f64 {
    text.chars().map(|letter| glyph(letter, scale).advance).sum()
}

/// A text with real minus signs in place of hyphens.
pub fn with_minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

fn draw(letter: char, scale: f64) -> Glyph {
    let mut drawn = Glyph { left: 0, top: 0, width: 1, cover: Vec::new(), advance: 0.0 };
    // The font is part of the program, and a test reads it.
    let Some(font) = &*FONT else { return drawn };
    let found = font.glyph_id(letter);
    let id = if found.0 == 0 { font.glyph_id('?') } else { found };
    // The library counts a font's size from the deepest to the highest point of its lines.
    let unit = f64::from(font.units_per_em().unwrap_or(1000.0));
    let size = SIZE * scale * f64::from(font.height_unscaled()) / unit;
    drawn.advance = f64::from(font.h_advance_unscaled(id)) / unit * SIZE * scale;
    let baseline = (BASELINE * scale).round() as f32;
    let glyph = id.with_scale_and_position(PxScale::from(size as f32), point(0.0, baseline));
    let Some(outline) = font.outline_glyph(glyph) else { return drawn };
    let bounds = outline.px_bounds();
    (drawn.left, drawn.top) = (bounds.min.x as i64, bounds.min.y as i64);
    let width = bounds.width() as usize;
    drawn.width = width.max(1) as i64;
    drawn.cover = vec![0; width * bounds.height() as usize];
    outline.draw(|x, y, share| {
        if let Some(cover) = drawn.cover.get_mut(y as usize * width + x as usize) {
            *cover = (share.clamp(0.0, 1.0) * 255.0).round() as u8;
        }
    });
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_the_signs_of_mathematics() {
        let unknown = glyph('\u{f8ff}', 1.0).cover.clone();
        assert_eq!(unknown, glyph('?', 1.0).cover);
        for letter in "\u{2212}π²³√≤≥≠×·…θφλ∞←→↑↓▾✓".chars() {
            let glyph = glyph(letter, 1.5);
            assert!(glyph.cover.iter().any(|cover| *cover > 128), "{letter}");
            assert!(glyph.cover != self::glyph('?', 1.5).cover, "{letter}");
        }
        assert!(glyph(' ', 1.0).cover.is_empty() && glyph(' ', 1.0).advance > 2.0);
    }

    #[test]
    fn letters_have_widths_of_their_own_and_grow_with_the_scale() {
        assert!(width("iiii", 1.0) < width("mmmm", 1.0) / 2.0);
        assert!((width("x^2", 1.5) - 1.5 * width("x^2", 1.0)).abs() < 1e-9);
        // A minus sign is as wide as a plus sign.
        let sign = |text: &str| width(text, 1.0);
        assert!((sign(&with_minus("-")) - sign("+")).abs() < 0.1 && sign("-") < sign("+"));
    }
}
