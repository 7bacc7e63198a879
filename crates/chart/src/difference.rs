//! Pictures that show errors pixel by pixel.

use crate::error::ChartError;
use crate::errors::{Mistake, mistake};
use crate::reference::RootReference;
use crate::truth::Truth;
use image::{ImageFormat, Rgb, RgbImage};
use std::io::Cursor;
use zeroset_trace::GBuffer;

/// Color of pixels with this mistake.
fn color(mistake: Mistake) -> Rgb<u8> {
    match mistake {
        Mistake::Missed => Rgb([214, 39, 40]),
        Mistake::Phantom => Rgb([31, 95, 214]),
        Mistake::WrongRoot => Rgb([242, 200, 15]),
    }
}

const OPEN: Rgb<u8> = Rgb([140, 140, 140]);
const RIGHT: Rgb<u8> = Rgb([220, 220, 220]);
const NOTHING: Rgb<u8> = Rgb([255, 255, 255]);

/// Colors each pixel by its mistake; pixels without a reference are white.
pub fn difference(reference: &RootReference, buffer: &GBuffer) -> RgbImage {
    let (width, height) = (buffer.width as u32, buffer.height as u32);
    let mut image = RgbImage::from_pixel(width, height, NOTHING);
    for (pixel, truth) in &reference.pixels {
        let drawn = buffer.drawn[*pixel];
        let shown = match (truth, mistake(truth, drawn)) {
            (Truth::Open, _) => OPEN,
            (_, Some(mistake)) => color(mistake),
            (_, None) if drawn.is_finite() => RIGHT,
            (_, None) => NOTHING,
        };
        let (column, row) = (*pixel as u32 % width, *pixel as u32 / width);
        image.put_pixel(column, row, shown);
    }
    image
}

/// Encodes a picture as a PNG file.
///
/// # Errors
/// If the picture is too large for the format.
pub fn png(image: &RgbImage) -> Result<Vec<u8>, ChartError> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).map_err(ChartError::of_chart("picture"))?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::truth::Root;

    #[test]
    fn each_mistake_has_its_color() {
        let root = |next: Option<f64>| {
            let next = next.map(|at| [at, at]);
            Truth::Root(Root { pieces: vec![[1.0, 1.0]], next, normal: None })
        };
        let truths =
            [root(None), Truth::Miss, root(Some(2.0)), root(None), Truth::Miss, Truth::Open];
        let drawn = [f64::INFINITY, 1.0, 1.9, 1.0, f64::INFINITY, 1.0];
        let mut buffer = GBuffer::new(truths.len(), 1, 0);
        buffer.drawn.copy_from_slice(&drawn);
        let image =
            difference(&RootReference::of(truths.into_iter().enumerate().collect()), &buffer);
        let [missed, phantom, wrong] =
            [Mistake::Missed, Mistake::Phantom, Mistake::WrongRoot].map(color);
        let pixels: Vec<Rgb<u8>> = image.pixels().copied().collect();
        assert_eq!(pixels, [missed, phantom, wrong, RIGHT, NOTHING, OPEN]);
        assert!(png(&image).expect("a file").starts_with(b"\x89PNG"));
    }
}
