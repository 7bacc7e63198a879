//! Colors and opacities of pixels.
//!
//! Nothing here knows surfaces, or the format of a file.

use glam::Vec4;
use rayon::prelude::*;
use std::borrow::Cow;
use std::ops::Range;
use zeroset_shade::{Colors, LinearRgb};

/// The bytes of a picture. A picture with a background has no opacities.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Pixels {
    /// Red, green and blue bytes (sRGB) of each pixel, row by row from the top.
    pub rgb: Vec<u8>,
    /// The opacity of each pixel; 255 means opaque. Empty if all pixels are opaque.
    pub alpha: Vec<u8>,
}

/// The colors of a picture while it is drawn, row by row from the top. They are multiplied by the
/// opacity until [`ColorBuffer::divide`].
#[derive(Clone, Debug, Default)]
pub(crate) struct ColorBuffer {
    pub colors: Colors,
    /// The opacity of each pixel, within [0, 1]. Empty if all pixels are opaque.
    pub opacity: Vec<f32>,
}

impl ColorBuffer {
    /// The light of a pixel, followed by its opacity.
    pub fn get(&self, pixel: usize) -> Vec4 {
        let [red, green, blue] = self.colors.get(pixel).0;
        Vec4::new(red, green, blue, self.opacity.get(pixel).copied().unwrap_or(1.0))
    }

    /// Sets the light and the opacity of a pixel.
    pub fn set(&mut self, pixel: usize, all: Vec4) {
        self.colors.set(pixel, LinearRgb(all.truncate().to_array()));
        if let Some(own) = self.opacity.get_mut(pixel) {
            *own = all.w;
        }
    }

    /// Mixes a color into a pixel, whose color is not multiplied by the opacity.
    pub fn mix(&mut self, pixel: usize, color: [u8; 3], share: f32) {
        self.set(pixel, mixed_over(self.get(pixel), color, share));
    }

    /// Keeps only these pixels.
    pub fn crop(&mut self, kept: Range<usize>) {
        self.opacity.truncate(kept.end);
        self.opacity.drain(..kept.start.min(self.opacity.len()));
        self.colors.crop(kept);
    }

    /// Divides colors by the opacity. Pixels whose opacity is written as 0 get the color `blank`,
    /// which programs that ignore opacities show.
    pub fn divide(&mut self, blank: [u8; 3]) {
        let steps = match self.colors {
            Colors::Bytes(_) => 255.0,
            Colors::Floats(_) => 65535.0,
        };
        for (pixel, opacity) in self.opacity.iter_mut().enumerate() {
            if *opacity < 0.5 / steps {
                *opacity = 0.0;
                self.colors.set(pixel, LinearRgb::from_srgb(blank));
            } else if *opacity < 1.0 {
                let light = self.colors.get(pixel).0.map(|light| light / *opacity);
                self.colors.set(pixel, LinearRgb(light));
            }
        }
    }

    /// The light and the opacity of each pixel. Empty if colors are bytes.
    pub fn light(&self) -> Vec<[f32; 4]> {
        let Colors::Floats(light) = &self.colors else { return Vec::new() };
        (0..light.len()).map(|pixel| self.get(pixel).to_array()).collect()
    }

    /// The finished bytes.
    pub fn into_bytes(self) -> Pixels {
        let alpha = self.opacity.iter().map(|opacity| (255.0 * opacity).round() as u8).collect();
        Pixels { rgb: self.colors.into_bytes(), alpha }
    }
}

/// The channels of the pixels, as a PNG stores them: red, green and blue, then the opacity unless
/// `alpha` is empty. They have sixteen bits if there is `light`, or else eight.
pub fn samples<'a>(rgb: &'a [u8], alpha: &[u8], light: &[[f32; 4]]) -> Cow<'a, [u8]> {
    if !light.is_empty() {
        return Cow::Owned(samples_of_light(light, !alpha.is_empty()));
    }
    if alpha.is_empty() {
        return Cow::Borrowed(rgb);
    }
    let pixels = rgb.as_chunks::<3>().0.iter().zip(alpha);
    Cow::Owned(
        pixels.flat_map(|([red, green, blue], alpha)| [*red, *green, *blue, *alpha]).collect(),
    )
}

/// Red, green and blue of each pixel in sixteen bits, as a PNG stores them, from the pixels' light
/// and opacities. The opacity is stored only if `has_alpha`.
fn samples_of_light(light: &[[f32; 4]], has_alpha: bool) -> Vec<u8> {
    let channels = if has_alpha { 4 } else { 3 };
    let of_pixel = |&[red, green, blue, opacity]: &[f32; 4]| {
        let [red, green, blue] = LinearRgb([red, green, blue]).encoded();
        let sixteen = |share: f32| (65535.0 * share).round() as u16;
        [red, green, blue, opacity]
            .into_iter()
            .take(channels)
            .flat_map(move |n| sixteen(n).to_be_bytes())
    };
    light.par_iter().flat_map_iter(of_pixel).collect()
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

/// A color of which `share` is this sRGB color, and the rest `own`, whose last component is the
/// opacity. The light of `own` is not multiplied by the opacity. sRGB values are mixed, not light.
pub(crate) fn mixed_over(own: Vec4, color: [u8; 3], share: f32) -> Vec4 {
    // The color covers its share, and what was there covers a part of the rest.
    let covered = share + own.w * (1.0 - share);
    let part = if covered > 0.0 { share / covered } else { 0.0 };
    let old = LinearRgb(own.truncate().to_array()).encoded();
    let mixed = |n: usize| old[n] + part * (f32::from(color[n]) / 255.0 - old[n]);
    let [red, green, blue] = LinearRgb::from_encoded([0, 1, 2].map(mixed)).0;
    Vec4::new(red, green, blue, covered)
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

/// Returns whether lines before a background of this color must be light to be seen.
pub(crate) fn is_dark(background: [u8; 3]) -> bool {
    background.into_iter().map(u32::from).sum::<u32>() < 300
}

/// Mixes `new` into `old`, with `share` / 255 as the share of `new`.
pub(crate) fn mixed(old: [u8; 3], new: [u8; 3], share: u32) -> [u8; 3] {
    let part =
        |n: usize| (u32::from(old[n]) * (255 - share) + u32::from(new[n]) * share + 127) / 255;
    [0, 1, 2].map(|n| part(n) as u8)
}
