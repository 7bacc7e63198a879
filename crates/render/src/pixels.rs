//! Colors and opacities of pixels.
//!
//! Nothing here knows surfaces, or the format of a file.

use std::borrow::Cow;
use std::ops::Range;
use zeroset_shade::LinearRgb;

/// The bytes of a picture. A picture with a background has no opacities.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pixels {
    /// Red, green and blue bytes (sRGB) of each pixel, row by row from the top. Colors are
    /// multiplied by the opacity until a picture is finished.
    pub rgb: Vec<u8>,
    /// The opacity of each pixel; 255 means opaque. Empty if all pixels are opaque.
    pub alpha: Vec<u8>,
}

impl Pixels {
    /// Sets the color and the opacity of a pixel.
    pub(crate) fn set(&mut self, pixel: usize, [red, green, blue, alpha]: [u8; 4]) {
        self.rgb.as_chunks_mut::<3>().0[pixel] = [red, green, blue];
        if let Some(own) = self.alpha.get_mut(pixel) {
            *own = alpha;
        }
    }

    /// Mixes a color into a pixel, with `share` / 255 as its share.
    pub(crate) fn mix(&mut self, pixel: usize, color: [u8; 3], share: u32) {
        let alpha = self.alpha.get_mut(pixel);
        mix_over(&mut self.rgb.as_chunks_mut::<3>().0[pixel], alpha, color, share);
    }

    /// Keeps only these pixels.
    pub(crate) fn crop(&mut self, kept: Range<usize>) {
        for (bytes, parts) in [(&mut self.rgb, 3), (&mut self.alpha, 1)] {
            bytes.truncate(parts * kept.end);
            bytes.drain(..(parts * kept.start).min(bytes.len()));
        }
    }

    /// Divides colors, which are multiplied by the opacity, by the opacity. Empty pixels get the
    /// color `blank`, which programs that ignore opacities show.
    pub(crate) fn divide(&mut self, blank: [u8; 3]) {
        for (color, alpha) in self.rgb.as_chunks_mut::<3>().0.iter_mut().zip(&self.alpha) {
            *color = match alpha {
                0 => blank,
                255 => continue,
                part => {
                    let share = f32::from(*part) / 255.0;
                    LinearRgb(LinearRgb::from_srgb(*color).0.map(|all| all / share)).to_srgb()
                }
            };
        }
    }
}

/// Red, green, blue and opacity of each pixel, as a PNG stores them; without the opacity if there
/// are no opacities.
pub fn samples<'a>(rgb: &'a [u8], alpha: &[u8]) -> Cow<'a, [u8]> {
    if alpha.is_empty() {
        return Cow::Borrowed(rgb);
    }
    let pixels = rgb.as_chunks::<3>().0.iter().zip(alpha);
    Cow::Owned(
        pixels.flat_map(|([red, green, blue], alpha)| [*red, *green, *blue, *alpha]).collect(),
    )
}

/// The colors of pixels with these opacities before a background. sRGB bytes are mixed, not light,
/// as browsers do. No opacities mean opaque pixels.
pub fn flattened<'a>(rgb: &'a [u8], alpha: &[u8], background: [u8; 3]) -> Cow<'a, [u8]> {
    if alpha.is_empty() {
        return Cow::Borrowed(rgb);
    }
    let pixels = rgb.as_chunks::<3>().0.iter().zip(alpha);
    Cow::Owned(pixels.flat_map(|(own, alpha)| mixed(background, *own, (*alpha).into())).collect())
}

/// Mixes a color into a pixel that may have an opacity, with `share` / 255 as its share.
pub(crate) fn mix_over(rgb: &mut [u8; 3], alpha: Option<&mut u8>, color: [u8; 3], share: u32) {
    let mut part = share;
    if let Some(alpha) = alpha {
        // The color covers its share, and what was there covers a part of the rest.
        let covered = 255 * share + u32::from(*alpha) * (255 - share);
        part = (255 * 255 * share).checked_div(covered).unwrap_or(0);
        *alpha = ((covered + 127) / 255) as u8;
    }
    *rgb = mixed(*rgb, color, part);
}

/// Mixes `new` into `old`, with `share` / 255 as the share of `new`.
pub(crate) fn mixed(old: [u8; 3], new: [u8; 3], share: u32) -> [u8; 3] {
    let part = |n: usize| (u32::from(old[n]) * (255 - share) + u32::from(new[n]) * share) / 255;
    [0, 1, 2].map(|n| part(n) as u8)
}
