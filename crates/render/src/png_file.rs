//! PNG files of pictures.

use std::io::{self, Write};
use std::path::Path;
use zeroset_shade::ColorDepth;

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

/// The format of a PNG's pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PngFormat {
    /// Set if pixels have opacities.
    pub has_alpha: bool,
    /// Eight bits per channel for bytes, sixteen for floats.
    pub depth: ColorDepth,
}

impl PngFormat {
    /// Red, green and blue bytes.
    pub const RGB: Self = Self { has_alpha: false, depth: ColorDepth::Bytes };

    /// The format of pixels with these opacities and this light. Both may be empty.
    pub fn of(alpha: &[u8], light: &[[f32; 4]]) -> Self {
        let depth = if light.is_empty() { ColorDepth::Bytes } else { ColorDepth::Floats };
        Self { has_alpha: !alpha.is_empty(), depth }
    }
}

/// Writes a picture as PNG (sRGB), with `texts` (keyword, text). `samples` are the channels of the
/// pixels, as PNG stores them.
///
/// # Errors
/// If writing to `out` fails.
pub fn write_png(
    out: impl Write,
    samples: &[u8],
    format: PngFormat,
    size: [usize; 2],
    texts: &[(&'static str, String)],
) -> io::Result<()> {
    let mut writer = png_encoder(out, size, format, texts)?.write_header()?;
    writer.write_image_data(samples)?;
    writer.finish()?;
    Ok(())
}

/// Returns an encoder that writes a PNG (sRGB) of this width and height to `out`, with `texts`
/// (keyword, text).
///
/// # Errors
/// If a text cannot be written.
pub fn png_encoder<W: Write>(
    out: W,
    [width, height]: [usize; 2],
    format: PngFormat,
    texts: &[(&'static str, String)],
) -> io::Result<png::Encoder<'static, W>> {
    let mut encoder = png::Encoder::new(out, width as u32, height as u32);
    encoder.set_color(if format.has_alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(match format.depth {
        ColorDepth::Bytes => png::BitDepth::Eight,
        ColorDepth::Floats => png::BitDepth::Sixteen,
    });
    encoder.set_compression(png::Compression::Fast);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let software = concat!("zeroset ", env!("CARGO_PKG_VERSION")).to_owned();
    encoder.add_itxt_chunk("Software".to_owned(), software)?;
    for (key, text) in texts {
        encoder.add_itxt_chunk((*key).to_owned(), text.clone())?;
    }
    Ok(encoder)
}
