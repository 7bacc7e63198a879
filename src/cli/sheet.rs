//! A contact sheet: small pictures with their names. The letters are Noto Sans Mono (SIL Open Font
//! License 1.1), as the crate `noto-sans-mono-bitmap` has drawn them.

use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Side of a small picture, in pixels.
const SIDE: u32 = 224;
/// Space around a small picture.
const MARGIN: u32 = 8;
/// Height of the line for the name.
const LABEL: u32 = 22;
/// Small pictures in a row.
const COLUMNS: u32 = 13;

const PAPER: Rgb<u8> = Rgb([255, 255, 255]);
const INK: u8 = 32;

const WEIGHT: FontWeight = FontWeight::Regular;
const HEIGHT: RasterHeight = RasterHeight::Size16;

/// A sheet with room for a given number of pictures.
pub struct Sheet {
    image: RgbImage,
    filled: u32,
}

impl Sheet {
    /// An empty sheet.
    pub fn new(pictures: usize) -> Self {
        let rows = (pictures as u32).div_ceil(COLUMNS).max(1);
        let width = COLUMNS * (SIDE + MARGIN) + MARGIN;
        let height = rows * (SIDE + LABEL + MARGIN) + MARGIN;
        Self { image: RgbImage::from_pixel(width, height, PAPER), filled: 0 }
    }

    /// Adds a picture of any size, scaled to fit; one more than there is room for is dropped.
    pub fn add(&mut self, name: &str, picture: &RgbImage) {
        let (column, row) = (self.filled % COLUMNS, self.filled / COLUMNS);
        let left = MARGIN + column * (SIDE + MARGIN);
        let top = MARGIN + row * (SIDE + LABEL + MARGIN);
        let longest = picture.width().max(picture.height());
        let scaled = |side: u32| (side * SIDE / longest).max(1);
        let (width, height) = (scaled(picture.width()), scaled(picture.height()));
        let small = imageops::resize(picture, width, height, FilterType::Triangle);
        let inset = |side: u32| i64::from((SIDE - side) / 2);
        let (x, y) = (i64::from(left) + inset(width), i64::from(top) + inset(height));
        imageops::replace(&mut self.image, &small, x, y);
        self.write(name, left, top + SIDE + 2);
        self.filled += 1;
    }

    /// The sheet's pixels.
    pub fn into_image(self) -> RgbImage {
        self.image
    }

    fn write(&mut self, text: &str, left: u32, top: u32) {
        let advance = get_raster_width(WEIGHT, HEIGHT) as u32;
        let room = (SIDE / advance) as usize;
        let shown: String = if text.chars().count() > room {
            text.chars().take(room - 2).chain("..".chars()).collect()
        } else {
            text.to_owned()
        };
        let indent = (SIDE - shown.chars().count() as u32 * advance) / 2;
        for (place, letter) in (0..).zip(shown.chars()) {
            let Some(glyph) = get_raster(letter, WEIGHT, HEIGHT) else {
                continue;
            };
            for (y, line) in (top..).zip(glyph.rows()) {
                for (x, &cover) in (left + indent + place * advance..).zip(line.iter()) {
                    if x < self.image.width() && y < self.image.height() {
                        let shade = 255 - (u32::from(cover) * u32::from(255 - INK) / 255) as u8;
                        self.image.put_pixel(x, y, Rgb([shade; 3]));
                    }
                }
            }
        }
    }
}
