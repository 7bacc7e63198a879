//! From a G-buffer to colors: deferred shading, which evaluates no function.

mod lanes;
mod shader;

use crate::color::LinearRgb;
use crate::colors::{ColorDepth, Colors};
use crate::light::Light;
use fearless_simd::Level;
use rayon::prelude::*;
pub use shader::{ColoredRows, Shader};
pub(crate) use shader::{ShadingInput, ViewAndNormals};
use zeroset_style::{Look, Material};
use zeroset_trace::painted::{SHADED_ROWS, windows};
use zeroset_trace::{GBuffer, RayGrid};

/// The colors of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceColors {
    /// Color of the side on which f > 0.
    pub positive: LinearRgb,
    /// Color of the side on which f < 0.
    pub negative: LinearRgb,
    /// Color of the faces where a region cuts a solid open.
    pub cut: LinearRgb,
    /// How the surface reflects light.
    pub material: &'static Material,
}

/// Marking of undecided pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UndecidedStyle {
    /// Not marked.
    Shade,
    /// Marked by diagonal stripes.
    #[default]
    Hatch,
    /// Marked by a color mixed in.
    Tint,
    /// Not painted.
    Miss,
}

/// The color of one point, if it differs from the color of its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Color of the point on either side; NaN for the surface's color.
    pub base: LinearRgb,
    /// Share of the point that a dark line covers, from 0 to 1.
    pub ink: f32,
}

impl Paint {
    /// The surface's own color, without a line.
    pub const NONE: Self = Self { base: LinearRgb([f32::NAN; 3]), ink: 0.0 };
}

/// Haze, which mixes a color into points that are far from the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Haze {
    /// The color of the haze.
    pub color: LinearRgb,
    /// The distances along a ray, in displayed units, at which haze begins and is strongest.
    pub between: [f64; 2],
    /// The largest share of the color, from 0 to 1.
    pub strength: f32,
}

impl Haze {
    /// The share of the haze's color in a point at this distance.
    fn share(&self, distance: f64) -> f32 {
        let [near, far] = self.between;
        self.strength * ((distance - near) / (far - near)).clamp(0.0, 1.0) as f32
    }
}

/// The settings of a picture's appearance.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Colors by surface id; they repeat for further surfaces. An empty list means the default
    /// pairs.
    pub surfaces: Vec<SurfaceColors>,
    /// Color of pixels where nothing is painted.
    pub background: LinearRgb,
    /// Share of ambient light, within [0, 1].
    pub ambient: f32,
    /// The look that gives the strengths of the lights. Its background and ambient share are
    /// ignored.
    pub look: Look,
    /// The light that casts shadows.
    pub light: Light,
    /// The haze before far points, if there is any.
    pub haze: Option<Haze>,
    /// Marking of undecided pixels.
    pub undecided: UndecidedStyle,
}

impl SurfaceColors {
    /// Colors for a surface without colors of its own. Outer sides have colors that can be told
    /// apart in every common form of color blindness (Okabe and Ito, "Color Universal Design",
    /// 2008). Inner sides are pale, and cool where the outer side is warm.
    pub fn default_for(surface: usize) -> Self {
        let pair = DEFAULT_PAIRS[surface % DEFAULT_PAIRS.len()];
        let [positive, negative] = pair.map(LinearRgb::from_srgb);
        Self { positive, negative, cut: cut(positive), material: Default::default() }
    }

    /// The colors of a surface with this color outside. The inner side is darker and less colorful.
    pub fn around(outer: LinearRgb) -> Self {
        let [red, green, blue] = outer.0;
        let grey = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
        let negative = LinearRgb(outer.0.map(|part| 0.5 * part + 0.12 * grey + 0.02));
        Self { positive: outer, negative, cut: cut(outer), material: Default::default() }
    }

    /// The same colors with the two sides exchanged.
    #[must_use]
    pub fn turned(self) -> Self {
        Self { positive: self.negative, negative: self.positive, ..self }
    }
}

/// The color of a cut through a solid of this color: lighter, as if sawn.
fn cut(outer: LinearRgb) -> LinearRgb {
    LinearRgb(outer.0.map(|part| 0.45 * part + 0.4))
}

impl Appearance {
    /// The appearance of a look under this light.
    pub fn new(look: &Look, light: Light) -> Self {
        Self {
            surfaces: Vec::new(),
            background: LinearRgb::from_srgb(look.background),
            ambient: look.ambient,
            look: *look,
            light,
            haze: None,
            undecided: UndecidedStyle::default(),
        }
    }

    /// The colors of surfaces; they repeat after the last.
    fn palette(&self) -> Vec<SurfaceColors> {
        if self.surfaces.is_empty() {
            (0..DEFAULT_PAIRS.len()).map(SurfaceColors::default_for).collect()
        } else {
            self.surfaces.clone()
        }
    }
}

const DEFAULT_PAIRS: [[[u8; 3]; 2]; 5] = [
    [[230, 159, 0], [112, 163, 212]],  // orange, pale blue
    [[0, 135, 105], [226, 176, 190]],  // bluish green, pale pink
    [[186, 92, 150], [196, 206, 148]], // reddish purple, pale olive
    [[0, 104, 170], [232, 204, 148]],  // blue, sand
    [[205, 85, 10], [150, 200, 190]],  // vermilion, pale teal
];

/// The colors of a picture.
///
/// A surface is lit on both sides: the normal is turned to the eye. The color is that of the
/// visible side, f > 0 or f < 0. In shadow, a tenth of the key light is left, without highlight.
///
/// `paint` gives points other colors than their surface has. It has one entry per pixel, or is
/// empty.
///
/// # Panics
/// If `paint` is not empty and its length differs from the number of pixels, or if the rays are
/// those of a picture of another width.
pub fn shade(
    buffer: &GBuffer,
    rays: &RayGrid,
    appearance: &Appearance,
    paint: &[Paint],
    depth: ColorDepth,
) -> Colors {
    shade_with(Level::new(), buffer, rays, appearance, paint, depth)
}

/// As [`shade`], with vectors of this level. The colors do not depend on the vectors' width, except
/// for the rounding of fused products and sums.
fn shade_with(
    level: Level,
    buffer: &GBuffer,
    rays: &RayGrid,
    appearance: &Appearance,
    paint: &[Paint],
    depth: ColorDepth,
) -> Colors {
    assert!(paint.is_empty() || paint.len() == buffer.status.len(), "a paint for each pixel");
    assert_eq!(buffer.width, rays.width(), "rays of another picture");
    let shader = Shader::new(rays, appearance).with(level);
    let mut colors = Colors::unset(depth, buffer.status.len());
    let size = (SHADED_ROWS * buffer.width).max(1);
    colors.as_mut().split(size).into_par_iter().enumerate().for_each(|(band, colors)| {
        let here = band * size..band * size + colors.len();
        let columns = buffer.columns(here.clone());
        let seen = ShadingInput { columns, paint: paint.get(here).unwrap_or_default() };
        let windows =
            windows(level, columns.status, columns.drawn, band * SHADED_ROWS, rays.width());
        shader.canvas(colors).windows(&seen, &windows);
    });
    colors
}

#[cfg(test)]
mod tests;
