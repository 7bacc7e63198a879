//! Ambient occlusion: what painted points have near them in a picture, how much of their
//! surroundings that hides, and the mean over neighbours that see the same.
//!
//! Nothing is asked of functions: what a picture does not show hides nothing. So this is for looks,
//! as shading is.

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use zeroset_trace::GBuffer;
use zeroset_trace::RayGrid;
use zeroset_trace::SurfaceIds;

/// Neighbouring pixels take turns in a square of this many: each looks elsewhere, and the mean over
/// a square has looked everywhere.
pub const TURNS: usize = 16;
/// Pixels on the side of such a square.
const SIDE: usize = TURNS.isqrt();

/// Whose turn a pixel is, by its column and row. Turns of neighbours are far apart (Bayer 1973).
pub fn turn([column, row]: [usize; 2]) -> usize {
    const TURN: [[usize; SIDE]; SIDE] =
        [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    TURN[row % SIDE][column % SIDE]
}

/// Places that are looked at around each point: sixteen times as many in the mean.
const LOOKS: usize = 6;
/// The golden angle: places at its multiples are spread evenly.
const GOLDEN: f32 = 2.399_963_2;
/// Nothing farther away in the picture than this share of its height counts, however near in space.
const WIDEST: f64 = 0.125;
/// What rises less than this above the tangent plane, as a sine, hides nothing: pixels are no
/// finer.
const FLAT: f32 = 0.08;
/// How dark what is found makes a point.
const STRENGTH: f32 = 2.6;

/// A painted point and what is known of it.
#[derive(Clone, Copy)]
struct Place {
    /// Relative to the centre.
    at: Vec3,
    /// Towards the eye's side; zero where nothing is painted.
    normal: Vec3,
    surface: u16,
}

/// Ambient occlusion in screen space: the painted points of a picture, by quantity. One large piece
/// of memory would not be given back to the system as soon.
pub struct AmbientOcclusion<'a> {
    rays: &'a RayGrid,
    at: Vec<Vec3>,
    normal: Vec<Vec3>,
    surface: SurfaceIds,
    /// For each turn, where is looked, in a circle of radius 1.
    looks: [[Vec2; LOOKS]; TURNS],
}

impl<'a> AmbientOcclusion<'a> {
    /// Those of a buffer whose normals are known. Points are computed relative to `centre`.
    pub fn new(buffer: &GBuffer, rays: &'a RayGrid, centre: DVec3) -> Self {
        let [mut at, mut normal] = [(); 2].map(|()| vec![Vec3::ZERO; buffer.drawn.len()]);
        let places = at.par_iter_mut().zip(&mut normal).enumerate().with_min_len(4096);
        places.for_each(|(pixel, (at, facing))| {
            let (drawn, normal) = (buffer.drawn[pixel], Vec3::from_array(buffer.normal[pixel]));
            if drawn.is_finite() {
                let ray = rays.ray_of(pixel);
                let is_behind = normal.dot(ray.direction.as_vec3()) > 0.0;
                *at = (ray.at(ray.parameter(drawn)) - centre).as_vec3();
                *facing = if is_behind { -normal } else { normal };
            }
        });
        let surface = buffer.surface.clone();
        let looks = std::array::from_fn(|turn| {
            let first = turn as f32 / TURNS as f32 * std::f32::consts::TAU;
            std::array::from_fn(|look| {
                let radius = ((look as f32 + 0.5) / LOOKS as f32).sqrt();
                radius * Vec2::from_angle(first + GOLDEN * look as f32)
            })
        });
        Self { rays, at, normal, surface, looks }
    }

    #[inline]
    fn place(&self, pixel: usize) -> Place {
        Place { at: self.at[pixel], normal: self.normal[pixel], surface: self.surface[pixel] }
    }

    #[inline]
    fn pixel(&self, column: isize, row: isize) -> Option<Place> {
        let (width, height) = (self.rays.width() as isize, self.rays.height() as isize);
        let is_inside = (0..width).contains(&column) && (0..height).contains(&row);
        is_inside.then(|| self.place((row * width + column) as usize))
    }

    /// How much of the surroundings of each painted point is hidden by what is painted within
    /// `reach` of it, in world units. Rows that are no longer `wanted` stay as they are.
    pub fn occlusion(&self, buffer: &mut GBuffer, reach: f64, wanted: &(dyn Fn() -> bool + Sync)) {
        let rays = self.rays;
        let widest = WIDEST * rays.height() as f64;
        let row = |(row, hidden): (usize, &mut [u8])| {
            if !wanted() {
                return;
            }
            for (column, hidden) in hidden.iter_mut().enumerate() {
                let pixel = row * rays.width() + column;
                if buffer.drawn[pixel].is_finite() {
                    let pixels = (reach / rays.footprint(buffer.drawn[pixel])).min(widest);
                    let share = self.hidden([column, row], pixels as f32, reach as f32);
                    *hidden = (share * 255.0).round() as u8;
                }
            }
        };
        let mut occlusion = std::mem::take(&mut buffer.occlusion);
        occlusion.resize(buffer.status.len(), 0);
        occlusion.par_chunks_mut(rays.width().max(1)).enumerate().for_each(row);
        buffer.occlusion = occlusion;
    }

    /// The share that is hidden of what surrounds a point, by what is within `pixels` of it in the
    /// picture (Mara, `McGuire`, Bukowski, Luebke, "Scalable Ambient Obscurance", 2012).
    fn hidden(&self, [column, row]: [usize; 2], pixels: f32, reach: f32) -> f32 {
        let Some(here) = self.pixel(column as isize, row as isize) else { return 0.0 };
        let mut sum = 0.0;
        // Half a pixel more, so that cutting off rounds; what sticks out to the left or above is
        // cut off to the first pixel.
        let middle = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
        for look in self.looks[turn([column, row])] {
            let at = middle + pixels * look;
            let Some(there) = self.pixel(at.x as isize, at.y as isize) else { continue };
            if there.normal == Vec3::ZERO {
                continue;
            }
            let way = there.at - here.at;
            let (rise, square) = (way.dot(here.normal), way.length_squared());
            // Most of what is seen lies in the tangent plane or behind it.
            if rise > 0.0 && square < reach * reach {
                let near = 1.0 - square / (reach * reach);
                sum += (rise / square.sqrt() - FLAT).max(0.0) * near;
            }
        }
        (STRENGTH * sum / LOOKS as f32).min(1.0)
    }

    /// The mean of `hidden` over the square of [`TURNS`] pixels around each, of those on the same
    /// part of the same surface.
    pub fn mean(&self, hidden: &mut [u8]) {
        let width = self.rays.width();
        let before = hidden.to_vec();
        let row = |(row, hidden): (usize, &mut [u8])| {
            for (column, hidden) in hidden.iter_mut().enumerate() {
                let here = self.place(row * width + column);
                if here.normal == Vec3::ZERO || is_even(&before, width, [column, row]) {
                    continue;
                }
                let (mut sum, mut count) = (0, 0);
                for n in 0..TURNS {
                    let half = SIDE as isize / 2;
                    let column = column as isize + (n % SIDE) as isize - half;
                    let row = row as isize + (n / SIDE) as isize - half;
                    if self.pixel(column, row).is_some_and(|there| here.is_beside(&there)) {
                        sum += u32::from(before[row as usize * width + column as usize]);
                        count += 1;
                    }
                }
                // The pixel itself is among them.
                *hidden = ((sum + count / 2) / count.max(1)) as u8;
            }
        };
        hidden.par_chunks_mut(width.max(1)).enumerate().for_each(row);
    }
}

/// Whether all of the square around a pixel has the same value; not known at the picture's edge.
fn is_even(values: &[u8], width: usize, [column, row]: [usize; 2]) -> bool {
    let half = SIDE / 2;
    if column < half || row < half || column + half > width {
        return false;
    }
    let all = [values[row * width + column]; SIDE];
    (0..SIDE).all(|k| {
        let first = (row - half + k) * width + column - half;
        values.get(first..first + SIDE).is_some_and(|four| *four == all)
    })
}

impl Place {
    /// Whether a place nearby is on the same part of the same surface: it is near the tangent plane
    /// and faces the same way.
    fn is_beside(&self, other: &Self) -> bool {
        let way = other.at - self.at;
        let is_near = way.dot(self.normal).abs() <= 0.3 * way.length();
        self.surface == other.surface && self.normal.dot(other.normal) > 0.7 && is_near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_trace::{Camera, Projection};

    /// Two walls that meet in a right angle along the middle column, looked into or at from
    /// outside.
    fn corner(inward: bool) -> (GBuffer, RayGrid) {
        let projection = Projection::Orthographic { height: 4.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let rays = camera.expect("valid").rays(64, 64);
        let mut buffer = GBuffer::new(64, 64, 0);
        let sign = if inward { 1.0 } else { -1.0 };
        for pixel in 0..64 * 64 {
            let x = rays.ray_of(pixel).origin.x;
            buffer.drawn[pixel] = 5.0 - sign * x.abs();
            buffer.normal[pixel] =
                DVec3::new(-sign * x.signum(), -1.0, 0.0).normalize().as_vec3().to_array();
        }
        (buffer, rays)
    }

    #[test]
    fn an_inner_corner_is_dark_and_an_outer_one_is_not() {
        for inward in [true, false] {
            let (mut buffer, rays) = corner(inward);
            let near = AmbientOcclusion::new(&buffer, &rays, DVec3::ZERO);
            near.occlusion(&mut buffer, 0.8, &|| true);
            near.mean(&mut buffer.occlusion);
            let column = |column: usize| {
                let rows = 24..40;
                let sum: u32 = rows.map(|row| u32::from(buffer.occlusion[row * 64 + column])).sum();
                (sum / 16) as u8
            };
            let row: Vec<u8> = (0..64).map(column).collect();
            assert!(row[4] < 10 && row[60] < 10, "far from the corner");
            assert_eq!(row[31] > 60 && row[32] > 60, inward, "at the corner");
            // The square reaches one pixel farther to the left than to the right; places looked at
            // are not symmetric.
            assert!((24..32).all(|k| row[k].abs_diff(row[64 - k]) < 16));
        }
    }

    #[test]
    fn a_mean_does_not_reach_across_an_edge() {
        let (mut buffer, rays) = corner(false);
        let near = AmbientOcclusion::new(&buffer, &rays, DVec3::ZERO);
        buffer.shadow = (0..64 * 64).map(|pixel| if pixel % 64 < 32 { 200 } else { 0 }).collect();
        let before = buffer.shadow.clone();
        near.mean(&mut buffer.shadow);
        assert_eq!(buffer.shadow, before);
        // Over turns it is the same for all.
        let shadow = |pixel: usize| (16 * turn([pixel % 64, pixel / 64])) as u8;
        buffer.shadow = (0..64 * 64).map(shadow).collect();
        near.mean(&mut buffer.shadow);
        assert!((8..24).all(|column| buffer.shadow[30 * 64 + column] == 120));
    }

    #[test]
    fn each_of_sixteen_has_its_turn() {
        let mut seen: Vec<usize> = (0..16).map(|n| turn([n % 4, n / 4])).collect();
        seen.sort_unstable();
        assert_eq!(seen, (0..TURNS).collect::<Vec<_>>());
    }
}
