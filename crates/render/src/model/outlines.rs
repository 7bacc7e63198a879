//! Lines where surfaces end, bend sharply, meet, or hide each other.
//!
//! The lines are found in the picture, and drawn over its colors. Only the nearest surface counts:
//! nothing is outlined behind translucent surfaces.

use super::blur::box_blur;
use crate::pixels::{ColorBuffer, is_dark};
use zeroset_shade::{Displayed, edges};

/// The radius of lines is a pixel for each of this many rows of the picture, but at least a pixel.
const ROWS: f64 = 900.0;

/// Largest radius of a line, in pixels. A strip has more extra rows than that.
const WIDEST: f64 = 14.0;

/// Largest share of a pixel's color that a line takes.
const INK: f32 = 0.75;

/// Colors of lines before a light background and before a dark one.
const COLORS: [[u8; 3]; 2] = [[24, 24, 30], [226, 228, 236]];

/// Draws lines over the colors of a picture. `height` is the height of the whole picture, of which
/// `pixels` may be a strip. The lines contrast with the background.
pub(super) fn draw(
    seen: &Displayed<'_>,
    height: usize,
    background: [u8; 3],
    pixels: &mut ColorBuffer,
) {
    let color = COLORS[usize::from(is_dark(background))];
    let width = seen.rays.width();
    let radius = (height as f64 / ROWS).round().clamp(1.0, WIDEST) as usize;
    // An edge is two pixels wide. It is blurred, so that lines have no steps.
    let mask = edges(&seen.buffer, &seen.rays);
    let cover = mask.iter().map(|edge| if *edge { 1.0 } else { 0.0 }).collect();
    let cover = box_blur(cover, width, radius, 1);
    // The share of a line's middle, if it is straight.
    let middle = 2.0 / (2 * radius + 1) as f32;
    for (pixel, cover) in cover.iter().enumerate().filter(|(_, cover)| **cover > 0.0) {
        pixels.mix(pixel, color, INK * (cover / middle).min(1.0));
    }
}
