//! From a G-buffer to colours: deferred shading, which asks nothing of the function.

use crate::colour::LinearRgb;
use crate::gbuffer::{GBuffer, Status};
use crate::grid::RayGrid;
use crate::light::Light;
use glam::Vec3;
use rayon::prelude::*;

/// The colours of one surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceColours {
    /// Of the side on which f > 0.
    pub positive: LinearRgb,
    /// Of the side on which f < 0, and of a solid's cut faces.
    pub negative: LinearRgb,
}

/// How an undecided pixel is told from a hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UndecidedStyle {
    /// Not at all.
    Shade,
    /// By diagonal stripes.
    #[default]
    Hatch,
    /// By a colour mixed in.
    Tint,
    /// It is left out.
    Miss,
}

/// Everything about a picture that is a matter of taste.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Colours by surface number; further surfaces start over. Empty: the default pairs.
    pub surfaces: Vec<SurfaceColours>,
    /// Shown where nothing is painted.
    pub background: LinearRgb,
    /// Share of the light that comes from everywhere, within [0, 1].
    pub ambient: f32,
    /// Where the rest comes from.
    pub light: Light,
    /// How undecided pixels are marked.
    pub undecided: UndecidedStyle,
}

impl SurfaceColours {
    /// Pairs for surfaces without colours of their own: the first warm and cool, told apart in
    /// every common form of colour blindness (Okabe and Ito, "Color Universal Design", 2008).
    pub fn default_for(surface: usize) -> Self {
        const PAIRS: [[[u8; 3]; 2]; 4] = [
            [[230, 159, 0], [0, 114, 178]],   // orange, blue
            [[240, 228, 66], [86, 180, 233]], // yellow, sky blue
            [[213, 94, 0], [0, 158, 115]],    // vermilion, bluish green
            [[204, 121, 167], [92, 92, 104]], // reddish purple, grey
        ];
        let [positive, negative] = PAIRS[surface % PAIRS.len()].map(LinearRgb::from_srgb);
        Self { positive, negative }
    }
}

impl Appearance {
    /// The default look under this light.
    pub fn new(light: Light) -> Self {
        Self {
            surfaces: Vec::new(),
            background: LinearRgb::from_srgb([244, 244, 246]),
            ambient: 0.3,
            light,
            undecided: UndecidedStyle::default(),
        }
    }

    fn colours(&self, surface: usize) -> SurfaceColours {
        if self.surfaces.is_empty() {
            SurfaceColours::default_for(surface)
        } else {
            self.surfaces[surface % self.surfaces.len()]
        }
    }
}

/// Share of a white highlight in the direct light, and its sharpness.
const HIGHLIGHT: f32 = 0.18;
const HIGHLIGHT_EXPONENT: f32 = 40.0;

/// Distance of the stripes of a hatch, and their width, in pixels along a row.
const HATCH_PERIOD: usize = 6;
const HATCH_WIDTH: usize = 2;

/// Marks undecided pixels under [`UndecidedStyle::Tint`]: no hue of the default pairs.
const TINT: LinearRgb = LinearRgb([0.6, 0.0, 0.6]);

/// The picture as rows of sRGB bytes, red, green, blue, from the top left.
///
/// A surface is lit on both sides: the normal is turned to the eye, and the side that is seen, f >
/// 0 or f < 0, decides the colour. In shadow only the ambient share is left.
pub fn shade(buffer: &GBuffer, rays: &RayGrid, appearance: &Appearance) -> Vec<u8> {
    let background = appearance.background.to_srgb();
    let mut bytes = vec![0; 3 * buffer.status.len()];
    bytes.par_chunks_mut((3 * buffer.width).max(1)).enumerate().for_each(|(row, line)| {
        for (column, out) in line.chunks_exact_mut(3).enumerate() {
            let pixel = row * buffer.width + column;
            let colour = pixel_colour(buffer, rays, appearance, pixel, (column, row));
            out.copy_from_slice(&colour.map_or(background, LinearRgb::to_srgb));
        }
    });
    bytes
}

/// The colour of what is painted in a pixel, or `None` for the background.
fn pixel_colour(
    buffer: &GBuffer,
    rays: &RayGrid,
    appearance: &Appearance,
    pixel: usize,
    (column, row): (usize, usize),
) -> Option<LinearRgb> {
    let undecided = buffer.status[pixel] == Status::Undecided;
    if !buffer.is_drawn(pixel) || (undecided && appearance.undecided == UndecidedStyle::Miss) {
        return None;
    }
    let ray = rays.ray(column, row);
    let to_eye = -ray.direction.normalize().as_vec3();
    let towards_positive = Vec3::from(buffer.normal[pixel]);
    let facing = towards_positive.dot(to_eye);
    let colours = appearance.colours(usize::from(buffer.surface[pixel]));
    let base = if facing < 0.0 || buffer.cap[pixel] { colours.negative } else { colours.positive };
    let normal = if facing < 0.0 { -towards_positive } else { towards_positive };

    let point = ray.at(ray.parameter(buffer.drawn[pixel]));
    let to_light = appearance.light.towards(point).0.as_vec3();
    let (mut direct, mut highlight) = (0.0, 0.0);
    if !buffer.shadow[pixel] {
        direct = normal.dot(to_light).max(0.0);
        let halfway = (to_light + to_eye).normalize_or_zero();
        highlight =
            HIGHLIGHT * direct.sqrt() * normal.dot(halfway).max(0.0).powf(HIGHLIGHT_EXPONENT);
    }
    // The ambient share falls off towards grazing angles, so that shapes stay readable in shadow.
    let ambient = appearance.ambient * (0.5 + 0.5 * facing.abs());
    let colour = base.lit(ambient + (1.0 - appearance.ambient) * direct, highlight);
    Some(match appearance.undecided {
        UndecidedStyle::Hatch if undecided && (column + row) % HATCH_PERIOD < HATCH_WIDTH => {
            colour.lit(0.25, 0.0)
        }
        UndecidedStyle::Tint if undecided => colour.mixed(TINT, 0.5),
        UndecidedStyle::Shade
        | UndecidedStyle::Hatch
        | UndecidedStyle::Tint
        | UndecidedStyle::Miss => colour,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};
    use glam::DVec3;

    /// One pixel painted at distance 4 on the way along +y from (0, −5, 0).
    fn painted(normal: [f32; 3]) -> (GBuffer, RayGrid) {
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let mut buffer = GBuffer::new(1, 1, 0);
        buffer.status[0] = Status::Hit;
        buffer.drawn[0] = 4.0;
        buffer.normal[0] = normal;
        (buffer, camera.expect("valid").rays(1, 1))
    }

    fn headlight() -> Appearance {
        Appearance::new(Light::Positional(DVec3::NEG_Y * 5.0))
    }

    #[test]
    fn the_side_that_is_seen_decides_the_colour() {
        let (buffer, rays) = painted([0.0, -1.0, 0.0]);
        let warm = shade(&buffer, &rays, &headlight());
        assert!(warm[0] > warm[2], "{warm:?}");
        let (buffer, rays) = painted([0.0, 1.0, 0.0]);
        let cool = shade(&buffer, &rays, &headlight());
        assert!(cool[0] < cool[2], "{cool:?}");
    }

    #[test]
    fn shadow_leaves_the_ambient_share() {
        let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
        let lit = shade(&buffer, &rays, &headlight());
        buffer.shadow[0] = true;
        let dark = shade(&buffer, &rays, &headlight());
        assert!(dark[0] < lit[0] && dark[0] > 0);
    }

    #[test]
    fn undecided_pixels_are_marked_as_asked() {
        let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
        let hit = shade(&buffer, &rays, &headlight());
        buffer.status[0] = Status::Undecided;
        let with = |undecided| shade(&buffer, &rays, &Appearance { undecided, ..headlight() });
        assert_eq!(with(UndecidedStyle::Shade), hit);
        assert!(with(UndecidedStyle::Hatch)[0] < hit[0]);
        assert_ne!(with(UndecidedStyle::Tint), hit);
        assert_eq!(with(UndecidedStyle::Miss), headlight().background.to_srgb());
    }

    #[test]
    fn a_cut_face_has_the_inner_colour() {
        let (mut buffer, rays) = painted([0.0, -1.0, 0.0]);
        buffer.cap[0] = true;
        let cut = shade(&buffer, &rays, &headlight());
        assert!(cut[0] < cut[2], "{cut:?}");
    }
}
