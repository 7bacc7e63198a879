//! A sixel decoder written from the VT330's manual
//! (<https://vt100.net/docs/vt3xx-gp/chapter14.html>), independent of the encoder.

use image::{Rgb, RgbImage};

/// The numbers at the start of `data`, and the rest.
fn numbers(data: &[u8]) -> (Vec<u32>, &[u8]) {
    let end = data.iter().position(|b| !(b.is_ascii_digit() || *b == b';')).unwrap_or(data.len());
    let text = std::str::from_utf8(&data[..end]).expect("ASCII");
    (text.split(';').map(|number| number.parse().unwrap_or(0)).collect(), &data[end..])
}

/// The first complete picture in a terminal's output, if there is one.
pub fn picture(sent: &[u8]) -> Option<RgbImage> {
    let start = sent.windows(2).position(|two| two == b"\x1bP")? + 2;
    let length = sent[start..].windows(2).position(|two| two == b"\x1b\\")?;
    let (_, data) = numbers(&sent[start..start + length]);
    let mut data = data.strip_prefix(b"q")?;
    let mut palette = std::collections::HashMap::new();
    let mut dots = Vec::new();
    let (mut x, mut band, mut color, mut repeat) = (0, 0, 0, 1);
    let mut size = None;
    while let Some((&first, rest)) = data.split_first() {
        data = rest;
        match first {
            b'"' => {
                let (raster, rest) = numbers(data);
                assert_eq!(raster[..2], [1, 1], "dots are square");
                (size, data) = (Some((raster[2], raster[3])), rest);
            }
            b'#' => {
                let (values, rest) = numbers(data);
                (color, data) = (values[0], rest);
                if let [_, 2, r, g, b] = values[..] {
                    let channel = |percent: u32| ((percent * 255 + 50) / 100) as u8;
                    palette.insert(color, Rgb([channel(r), channel(g), channel(b)]));
                }
            }
            b'!' => {
                let (count, rest) = numbers(data);
                (repeat, data) = (count[0], rest);
            }
            b'$' => x = 0,
            b'-' => (x, band) = (0, band + 1),
            b'?'..=b'~' => {
                for dot in (0..6).filter(|dot| (first - b'?') >> dot & 1 == 1) {
                    dots.extend((x..x + repeat).map(|x| (x, 6 * band + dot, color)));
                }
                (x, repeat) = (x + repeat, 1);
            }
            b'\r' | b'\n' => {}
            other => panic!("{:?} among sixels", char::from(other)),
        }
    }
    let (width, height) = size.expect("raster attributes");
    // Pixels that are never drawn become magenta, which no picture here has.
    let mut image = RgbImage::from_pixel(width, height, Rgb([255, 0, 255]));
    for (x, y, color) in dots {
        // The last band may extend below the picture.
        if y < height {
            image.put_pixel(x, y, palette[&color]);
        }
    }
    Some(image)
}
