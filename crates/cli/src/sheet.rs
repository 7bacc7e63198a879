//! A contact sheet: small pictures with their names.

use image::imageops::{self, FilterType};
use image::{Rgb, RgbImage};
use zeroset_render::overlay::Canvas;

/// Width and height of a small picture, in pixels.
const SIDE: u32 = 224;
const MARGIN: u32 = 8;
/// Height of the line with a picture's name, in pixels.
const LABEL: u32 = 22;
const COLUMNS: u32 = 13;

const PAPER: Rgb<u8> = Rgb([255, 255, 255]);
const INK: u32 = 0x0020_2020;

/// A sheet with room for a given number of pictures.
pub struct ContactSheet {
    image: RgbImage,
    filled: u32,
}

impl ContactSheet {
    /// An empty sheet.
    pub fn new(pictures: usize) -> Self {
        let rows = (pictures as u32).div_ceil(COLUMNS).max(1);
        let width = COLUMNS * (SIDE + MARGIN) + MARGIN;
        let height = rows * (SIDE + LABEL + MARGIN) + MARGIN;
        Self { image: RgbImage::from_pixel(width, height, PAPER), filled: 0 }
    }

    /// Adds a picture of any size, scaled to fit. A picture beyond the sheet's capacity is dropped.
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
        let [width, height] = [self.image.width(), self.image.height()].map(|side| side as usize);
        let mut canvas = Canvas::new(width, height, Vec::new(), 1.0);
        let shown = canvas.fitting(text, SIDE as usize);
        let indent = (SIDE as usize).saturating_sub(canvas.text_width(&shown)) / 2;
        canvas.write(&shown, i64::from(left) + indent as i64, i64::from(top), INK);
        canvas.mix_into(&mut self.image, &mut [], 0);
    }
}
