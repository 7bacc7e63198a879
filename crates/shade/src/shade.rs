//! From a G-buffer to colors: deferred shading, which asks nothing of the function.

mod lanes;
mod shader;

use crate::color::LinearRgb;
use crate::light::Light;
use fearless_simd::Level;
use rayon::prelude::*;
pub use shader::{Canvas, Shader};
pub(crate) use shader::{Faced, Seen};
use zeroset_style::Look;
use zeroset_trace::GBuffer;
use zeroset_trace::RayGrid;
use zeroset_trace::buffer_pool::{BufferPool, PICTURES, serves};
use zeroset_trace::painted::{BAND, windows};

/// The colors of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceColors {
    /// Of the side on which f > 0.
    pub positive: LinearRgb,
    /// Of the side on which f < 0.
    pub negative: LinearRgb,
    /// Of the faces where a region cuts a solid open.
    pub cut: LinearRgb,
}

/// How an undecided pixel is told from a hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UndecidedStyle {
    /// Not at all.
    Shade,
    /// By diagonal stripes.
    #[default]
    Hatch,
    /// By a color mixed in.
    Tint,
    /// It is left out.
    Miss,
}

/// What the light of one pixel's own point is, where it is not that of its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Its color on either side; NaN for that of the surface.
    pub base: LinearRgb,
    /// How much of a dark line covers it, from 0 to 1.
    pub ink: f32,
}

impl Paint {
    /// The surface's own color, without a line.
    pub const NONE: Self = Self { base: LinearRgb([f32::NAN; 3]), ink: 0.0 };
}

/// Everything about a picture that is a matter of taste.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Colors by surface number; further surfaces start over. Empty: the default pairs.
    pub surfaces: Vec<SurfaceColors>,
    /// Shown where nothing is painted.
    pub background: LinearRgb,
    /// Share of the light that comes from everywhere, within [0, 1].
    pub ambient: f32,
    /// How the surfaces are lit; its background and ambient share do not count.
    pub look: Look,
    /// Where the light comes from that casts shadows.
    pub light: Light,
    /// How undecided pixels are marked.
    pub undecided: UndecidedStyle,
}

impl SurfaceColors {
    /// Pairs for surfaces without colors of their own: the first warm and cool, told apart in
    /// every common form of color blindness (Okabe and Ito, "Color Universal Design", 2008).
    pub fn default_for(surface: usize) -> Self {
        let pair = DEFAULT_PAIRS[surface % DEFAULT_PAIRS.len()];
        let [positive, negative] = pair.map(LinearRgb::from_srgb);
        Self { positive, negative, cut: cut(positive) }
    }

    /// The sides of a surface whose outer one has this color: the inner one is darker and less
    /// colorful.
    pub fn around(outer: LinearRgb) -> Self {
        let [red, green, blue] = outer.0;
        let grey = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
        let negative = LinearRgb(outer.0.map(|part| 0.5 * part + 0.12 * grey + 0.02));
        Self { positive: outer, negative, cut: cut(outer) }
    }

    /// The same with the sides exchanged.
    #[must_use]
    pub fn turned(self) -> Self {
        Self { positive: self.negative, negative: self.positive, ..self }
    }
}

/// The color of what is inside of a solid of this color: lighter, as if sawn.
fn cut(outer: LinearRgb) -> LinearRgb {
    LinearRgb(outer.0.map(|part| 0.45 * part + 0.4))
}

impl Appearance {
    /// A look under this light.
    pub fn new(look: &Look, light: Light) -> Self {
        Self {
            surfaces: Vec::new(),
            background: LinearRgb::from_srgb(look.background),
            ambient: look.ambient,
            look: *look,
            light,
            undecided: UndecidedStyle::default(),
        }
    }

    /// The colors of surfaces, from the first on until they start over.
    fn palette(&self) -> Vec<SurfaceColors> {
        if self.surfaces.is_empty() {
            (0..DEFAULT_PAIRS.len()).map(SurfaceColors::default_for).collect()
        } else {
            self.surfaces.clone()
        }
    }
}

const DEFAULT_PAIRS: [[[u8; 3]; 2]; 4] = [
    [[230, 159, 0], [0, 114, 178]],   // orange, blue
    [[240, 228, 66], [86, 180, 233]], // yellow, sky blue
    [[213, 94, 0], [0, 158, 115]],    // vermilion, bluish green
    [[204, 121, 167], [92, 92, 104]], // reddish purple, grey
];

/// The picture as rows of sRGB bytes, red, green, blue, from the top left.
///
/// A surface is lit on both sides: the normal is turned to the eye, and the side that is seen, f >
/// 0 or f < 0, decides the color. In shadow only the ambient share is left.
///
/// Points may have other colors than their surface has: there is one paint for each pixel, or none
/// at all.
///
/// # Panics
/// If there are paints, but not as many as pixels; or the rays are of a picture of another width.
pub fn shade(
    buffer: &GBuffer,
    rays: &RayGrid,
    appearance: &Appearance,
    paint: &[Paint],
) -> Vec<u8> {
    shade_with(Level::new(), buffer, rays, appearance, paint)
}

/// The same with such vectors; the bytes do not depend on how wide they are, but for how sums of
/// products are rounded.
fn shade_with(
    level: Level,
    buffer: &GBuffer,
    rays: &RayGrid,
    appearance: &Appearance,
    paint: &[Paint],
) -> Vec<u8> {
    assert!(paint.is_empty() || paint.len() == buffer.status.len(), "a paint for each pixel");
    assert_eq!(buffer.width, rays.width(), "rays of another picture");
    let shader = Shader::new(rays, appearance).with(level);
    let mut bytes = unset_colors(buffer.status.len());
    let size = (BAND * buffer.width).max(1);
    bytes.par_chunks_mut(3 * size).enumerate().for_each(|(band, bytes)| {
        let here = band * size..band * size + bytes.len() / 3;
        let columns = buffer.columns(here.clone());
        let seen = Seen { columns, paint: paint.get(here).unwrap_or_default() };
        let windows = windows(level, columns.status, columns.drawn, band * BAND, rays.width());
        shader.canvas(bytes).windows(&seen, &windows);
    });
    bytes
}

/// Memory for the colors of so many pixels, which holds those of no picture.
pub fn unset_colors(pixels: usize) -> Vec<u8> {
    let mut bytes =
        SPARES.take().filter(|bytes| serves(bytes.capacity(), 3 * pixels)).unwrap_or_default();
    bytes.resize(3 * pixels, 0);
    bytes
}

/// Leaves the memory of a picture to the next ones. Up to two pictures' are kept, until the end of
/// the process.
pub fn hand_back_colors(bytes: Vec<u8>) {
    SPARES.hand_back(bytes);
}

static SPARES: BufferPool<Vec<u8>> = BufferPool::new(PICTURES);

#[cfg(test)]
mod tests;
