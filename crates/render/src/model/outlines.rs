//! Lines where surfaces end, bend sharply, meet, or hide each other.
//!
//! The lines are found in the picture, and drawn over its colors. Only the nearest surface counts:
//! nothing is outlined behind translucent surfaces.

use crate::pixels::Pixels;
use rayon::prelude::*;
use zeroset_shade::{Displayed, edges};

/// Rows of a picture in which lines are as thin as possible.
const ROWS: f64 = 640.0;

/// Largest radius of a line, in pixels. A strip knows more rows than that beyond its own.
const WIDEST: f64 = 14.0;

/// Share of a pixel's color that a line has at most.
const INK: f32 = 0.75;

/// Color of lines.
const COLOR: [u8; 3] = [24, 24, 30];

/// Draws lines over the colors of a picture. `height` is that of the whole picture, if this is a
/// strip of it.
pub(super) fn draw(seen: &Displayed<'_>, height: usize, pixels: &mut Pixels) {
    let width = seen.rays.width();
    let radius = (height as f64 / ROWS).round().clamp(1.0, WIDEST) as usize;
    // An edge is two pixels wide. It is spread, so that lines have no steps.
    let mask = edges(&seen.buffer, &seen.rays);
    let cover: Vec<f32> = mask.iter().map(|edge| if *edge { 1.0 } else { 0.0 }).collect();
    let cover = spread(&spread(&cover, width, 1, radius), width, width, radius);
    // The share of a line's middle, if it is straight.
    let middle = (2 * radius + 1) as f32 / ((radius + 1) * (radius + 1)) as f32;
    for (pixel, cover) in cover.iter().enumerate().filter(|(_, cover)| **cover > 0.0) {
        pixels.mix(pixel, COLOR, (255.0 * INK * (cover / middle).min(1.0)).round() as u32);
    }
}

/// Means over neighbors in a row (`step` 1) or in a column (`step` is the width). Weights fall from
/// the middle to 0 beyond `radius` pixels.
fn spread(cover: &[f32], width: usize, step: usize, radius: usize) -> Vec<f32> {
    let all = ((radius + 1) * (radius + 1)) as f32;
    let mean = |pixel: usize| {
        let (place, end) =
            if step == 1 { (pixel % width, width) } else { (pixel / width, cover.len() / width) };
        let near = place.saturating_sub(radius)..(place + radius + 1).min(end);
        let first = pixel - place * step;
        let part = |at: usize| (radius + 1 - at.abs_diff(place)) as f32 * cover[first + at * step];
        near.map(part).sum::<f32>() / all
    };
    (0..cover.len()).into_par_iter().with_min_len(4096).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_edge_is_darkest_in_the_middle_and_as_wide_everywhere() {
        for radius in [1, 3] {
            let (width, height) = (20, 9);
            let mask: Vec<f32> = (0..width * height)
                .map(|n| if [9, 10].contains(&(n % width)) { 1.0 } else { 0.0 })
                .collect();
            let across = spread(&mask, width, 1, radius);
            let row = |cover: &[f32], row: usize| cover[row * width..][..width].to_vec();
            let middle = (2 * radius + 1) as f32 / ((radius + 1) * (radius + 1)) as f32;
            assert!((row(&across, 4)[9] - middle).abs() < 1e-6);
            assert!((row(&across, 4).iter().sum::<f32>() - 2.0).abs() < 1e-5);
            assert_eq!(row(&across, 4)[9 - radius - 1], 0.0);
            let both = spread(&across, width, width, radius);
            assert!((row(&both, 4)[10] - middle).abs() < 1e-6);
        }
    }
}
