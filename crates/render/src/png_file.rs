//! PNG files of pictures.

use crate::pixels::samples;
use std::io::{self, Write};
use std::path::Path;

/// Refuses a path with another extension than `png`.
///
/// # Errors
/// If the path has another extension. The error is one sentence.
pub fn check_png(path: &Path) -> Result<(), String> {
    if path.extension().is_none_or(|extension| extension.eq_ignore_ascii_case("png")) {
        return Ok(());
    }
    Err(format!(
        "pictures are written as PNG only: '{}' has another extension; use '{}'",
        path.display(),
        path.with_extension("png").display()
    ))
}

/// Writes a picture as PNG (sRGB), with `texts` (keyword, text). `rgb` has red, green and blue
/// bytes, and `alpha` has opacities, or is empty.
///
/// # Errors
/// If writing to `out` fails.
pub fn write_png(
    out: impl Write,
    (rgb, alpha): (&[u8], &[u8]),
    size: [usize; 2],
    texts: &[(&'static str, String)],
) -> io::Result<()> {
    let mut writer = png_encoder(out, size, !alpha.is_empty(), texts)?.write_header()?;
    writer.write_image_data(&samples(rgb, alpha))?;
    writer.finish()?;
    Ok(())
}

/// Returns an encoder that writes a PNG (sRGB) of this width and height to `out`, with `texts`
/// (keyword, text). Pixels have opacities if `has_alpha` is true.
///
/// # Errors
/// If a text cannot be written.
pub fn png_encoder<W: Write>(
    out: W,
    [width, height]: [usize; 2],
    has_alpha: bool,
    texts: &[(&'static str, String)],
) -> io::Result<png::Encoder<'static, W>> {
    let mut encoder = png::Encoder::new(out, width as u32, height as u32);
    let color = if has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb };
    encoder.set_color(color);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let software = concat!("zeroset ", env!("CARGO_PKG_VERSION")).to_owned();
    encoder.add_itxt_chunk("Software".to_owned(), software)?;
    for (key, text) in texts {
        encoder.add_itxt_chunk((*key).to_owned(), text.clone())?;
    }
    Ok(encoder)
}
