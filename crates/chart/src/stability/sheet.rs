//! The contact sheet. It has a row for each case and a column for each method. A cell shows the
//! picture beside a picture of its errors. The letters are Noto Sans Mono (SIL Open Font License
//! 1.1), from the crate `noto-sans-mono-bitmap`.

use super::{Outcome, SIDE, Verdict};
use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use zeroset_trace::Method;

/// Side of a picture on the sheet: pictures are shown at twice their size.
const SHOWN: u32 = 2 * SIDE as u32;
/// Margin around pictures.
const MARGIN: u32 = 6;
/// Height of a line of text.
const LINE: u32 = 18;
/// Width and height of a cell with two pictures side by side.
const CELL: [u32; 2] = [2 * SHOWN + 3 * MARGIN, SHOWN + LINE + 2 * MARGIN];

const WEIGHT: FontWeight = FontWeight::Regular;
const HEIGHT: RasterHeight = RasterHeight::Size16;

/// The sheet's image.
pub struct Sheet(RgbImage);

/// Background color of the outcome's name.
fn color(outcome: Outcome) -> Rgb<u8> {
    match outcome {
        Outcome::Sound => Rgb([198, 235, 214]),
        Outcome::Phantoms | Outcome::Slow | Outcome::Refused => Rgb([250, 232, 170]),
        Outcome::Holes | Outcome::Wall | Outcome::Noise => Rgb([246, 190, 170]),
        Outcome::Unjudged => Rgb([225, 225, 225]),
    }
}

impl Sheet {
    /// An empty sheet with the methods' names on top.
    pub fn new(cases: usize, methods: &[&'static Method]) -> Self {
        let size = [methods.len() as u32 * CELL[0], LINE + cases as u32 * CELL[1]];
        let mut sheet = Self(RgbImage::from_pixel(size[0].max(1), size[1], Rgb([255; 3])));
        for (column, method) in (0..).zip(methods) {
            sheet.write(method.name, column * CELL[0] + MARGIN, 1);
        }
        sheet
    }

    /// Adds a verdict, and the two pictures if there are any.
    pub fn add(
        &mut self,
        row: usize,
        column: usize,
        verdict: &Verdict,
        shown: Option<&[RgbImage; 2]>,
    ) {
        let left = column as u32 * CELL[0] + MARGIN;
        let top = LINE + row as u32 * CELL[1] + MARGIN;
        for (place, picture) in (0..).zip(shown.into_iter().flatten()) {
            let large = imageops::resize(picture, SHOWN, SHOWN, FilterType::Nearest);
            let x = left + place * (SHOWN + MARGIN);
            imageops::replace(&mut self.0, &large, i64::from(x), i64::from(top));
        }
        let (below, width) = (top + SHOWN, 2 * SHOWN + MARGIN);
        for y in below..below + LINE {
            for x in left..left + width {
                self.0.put_pixel(x, y, color(verdict.outcome));
            }
        }
        self.write(&format!("{} {}", verdict.case, verdict.outcome.name()), left + 4, below + 1);
    }

    /// The sheet as an image.
    pub fn into_image(self) -> RgbImage {
        self.0
    }

    fn write(&mut self, text: &str, left: u32, top: u32) {
        let advance = get_raster_width(WEIGHT, HEIGHT) as u32;
        for (place, letter) in (0..).zip(text.chars()) {
            let Some(glyph) = get_raster(letter, WEIGHT, HEIGHT) else { continue };
            for (y, line) in (top..).zip(glyph.rows()) {
                for (x, &cover) in (left + place * advance..).zip(line.iter()) {
                    if let Some(pixel) = self.0.get_pixel_mut_checked(x, y) {
                        let paper = 255 - u32::from(cover);
                        pixel.0 = pixel.0.map(|shade| (u32::from(shade) * paper / 255) as u8);
                    }
                }
            }
        }
    }
}
