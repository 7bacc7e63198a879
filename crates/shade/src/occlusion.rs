//! Ambient occlusion: the share of each painted point's surroundings that is hidden by other
//! painted points nearby. It is averaged over neighbors on the same part of a surface.
//!
//! No function is evaluated, and parts of a surface that the picture does not show hide nothing.
//! Occlusion affects only the appearance.

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use zeroset_trace::{GBuffer, RayGrid};

/// Number of sampling patterns, one for each pixel of a small square. The patterns sample different
/// directions, and the mean over the square covers all directions.
pub const TURNS: usize = 16;
/// Number of pixels on a side of the square.
const SIDE: usize = TURNS.isqrt();

/// The number of a pixel's sampling pattern, by its column and row. The numbers of neighboring
/// pixels are far apart (Bayer 1973).
pub fn turn([column, row]: [usize; 2]) -> usize {
    const TURN: [[usize; SIDE]; SIDE] =
        [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    TURN[row % SIDE][column % SIDE]
}

/// Number of places sampled around each point. A mean over the square of [`TURNS`] pixels has
/// sixteen times as many samples.
const LOOKS: usize = 6;
/// The golden angle, in radians. Places at its multiples are spread evenly.
const GOLDEN: f32 = 2.399_963_2;
/// Sampled places are at most this far from a pixel, as a share of the picture's height. The limit
/// matters if the surface is near the eye.
const WIDEST: f64 = 0.125;
/// A point hides nothing if the sine of its elevation above the tangent plane is below this. Pixels
/// do not resolve lower elevations.
const FLAT: f32 = 0.08;
/// Factor by which the mean contribution of the samples is multiplied to give the hidden share.
const STRENGTH: f32 = 2.6;

/// A painted point, with its normal and surface.
#[derive(Clone, Copy)]
struct ShadedPoint {
    /// Position relative to the scene's center.
    at: Vec3,
    /// Normal toward the eye's side; zero where nothing is painted.
    normal: Vec3,
    surface: u16,
}

/// Pictures with at least this many rows are sampled at every second pixel of every second row.
const COARSE_ROWS: usize = 256;

/// Ambient occlusion in screen space: the painted points of a picture, or of every second pixel of
/// every second row. Each quantity has its own array: the allocator would return one large array
/// for all to the system.
pub struct AmbientOcclusion<'a> {
    rays: &'a RayGrid,
    buffer: &'a GBuffer,
    centre: DVec3,
    /// Distance between sampled pixels, in pixels.
    step: usize,
    /// Columns and rows of sampled pixels.
    size: [usize; 2],
    at: Vec<Vec3>,
    normal: Vec<Vec3>,
    /// For each [`turn`], the offsets from a pixel to the places sampled around it. They are within
    /// a circle of radius 1, and scaled when used.
    looks: [[Vec2; LOOKS]; TURNS],
}

impl<'a> AmbientOcclusion<'a> {
    /// All painted points of a buffer that has normals. Positions are relative to `centre`.
    pub fn new(buffer: &'a GBuffer, rays: &'a RayGrid, centre: DVec3) -> Self {
        Self::sampled(buffer, rays, centre, 1)
    }

    /// As [`AmbientOcclusion::new`]. In a large picture, only some points are used, so that
    /// [`AmbientOcclusion::occlusion`] is faster.
    pub fn coarse(buffer: &'a GBuffer, rays: &'a RayGrid, centre: DVec3) -> Self {
        let step = if rays.height() >= COARSE_ROWS { 2 } else { 1 };
        Self::sampled(buffer, rays, centre, step)
    }

    fn sampled(buffer: &'a GBuffer, rays: &'a RayGrid, centre: DVec3, step: usize) -> Self {
        let size = [rays.width(), rays.height()].map(|size| size.div_ceil(step));
        let [mut at, mut normal] = [(); 2].map(|()| vec![Vec3::ZERO; size[0] * size[1]]);
        let width = size[0].max(1);
        let rows = at.par_chunks_mut(width).zip(normal.par_chunks_mut(width)).enumerate();
        rows.with_min_len(8).for_each(|(row, (at, normal))| {
            for (column, (at, normal)) in at.iter_mut().zip(normal).enumerate() {
                let pixel = row * step * rays.width() + column * step;
                if let Some(point) = point(buffer, rays, centre, pixel) {
                    (*at, *normal) = (point.at, point.normal);
                }
            }
        });
        let looks = std::array::from_fn(|turn| {
            let first = turn as f32 / TURNS as f32 * std::f32::consts::TAU;
            std::array::from_fn(|look| {
                let radius = ((look as f32 + 0.5) / LOOKS as f32).sqrt();
                radius * Vec2::from_angle(first + GOLDEN * look as f32)
            })
        });
        Self { rays, buffer, centre, step, size, at, normal, looks }
    }

    /// The index in the picture of the sampled pixel with this index.
    #[inline]
    fn in_picture(&self, sample: usize) -> usize {
        let (column, row) = (sample % self.size[0], sample / self.size[0]);
        (row * self.rays.width() + column) * self.step
    }

    #[inline]
    fn place(&self, sample: usize) -> ShadedPoint {
        let pixel = if self.step == 1 { sample } else { self.in_picture(sample) };
        ShadedPoint {
            at: self.at[sample],
            normal: self.normal[sample],
            surface: self.buffer.surface[pixel],
        }
    }

    #[inline]
    fn pixel(&self, column: isize, row: isize) -> Option<ShadedPoint> {
        let [width, height] = self.size.map(|size| size as isize);
        let is_inside = (0..width).contains(&column) && (0..height).contains(&row);
        is_inside.then(|| self.place((row * width + column) as usize))
    }

    /// The share of each painted point's surroundings that is hidden by points within `reach`, in
    /// world units. It is averaged over neighbors. Once `wanted` returns false, nothing hides the
    /// points of further rows.
    pub fn occlusion(&self, reach: f64, wanted: &(dyn Fn() -> bool + Sync)) -> Vec<u8> {
        let Self { rays, buffer, step, .. } = *self;
        let widest = WIDEST * rays.height() as f64;
        let row = |(row, hidden): (usize, &mut [u8])| {
            if !wanted() {
                return;
            }
            for (column, hidden) in hidden.iter_mut().enumerate() {
                let pixel = (row * rays.width() + column) * step;
                if buffer.drawn[pixel].is_finite() {
                    let pixels = (reach / rays.footprint(buffer.drawn[pixel])).min(widest);
                    let share =
                        self.hidden([column, row], pixels as f32 / step as f32, reach as f32);
                    *hidden = (share * 255.0).round() as u8;
                }
            }
        };
        let mut occlusion = vec![0; self.at.len()];
        occlusion.par_chunks_mut(self.size[0].max(1)).enumerate().for_each(row);
        self.mean(&mut occlusion);
        if step == 1 { occlusion } else { self.for_all_pixels(&occlusion) }
    }

    /// The values of all pixels, computed from the values of sampled pixels: means over the nearest
    /// sampled pixels on the same part of the same surface.
    fn for_all_pixels(&self, sampled: &[u8]) -> Vec<u8> {
        let Self { rays, buffer, centre, step, size: [width, height], .. } = *self;
        let mut all = vec![0; buffer.drawn.len()];
        let row = |(row, all): (usize, &mut [u8])| {
            let above = row / step;
            let below = row.div_ceil(step).min(height - 1);
            for (column, value) in all.iter_mut().enumerate() {
                let (left, right) = (column / step, column.div_ceil(step).min(width - 1));
                let near = [[left, above], [right, above], [left, below], [right, below]]
                    .map(|[column, row]| row * width + column);
                let values = near.map(|sample| sampled[sample]);
                *value = values[0];
                if values == [values[0]; 4] {
                    continue;
                }
                let pixel = row * rays.width() + column;
                let Some(here) = point(buffer, rays, centre, pixel) else { continue };
                let [mut near_sum, mut far_sum] = [[0_u32; 2]; 2];
                for (sample, value) in near.into_iter().zip(values) {
                    let there = self.place(sample);
                    let sums = if here.is_beside(&there) { &mut near_sum } else { &mut far_sum };
                    if there.normal != Vec3::ZERO {
                        *sums = [sums[0] + u32::from(value), sums[1] + 1];
                    }
                }
                // A part that no sampled pixel shows has the mean of its surroundings.
                let [sum, count] = if near_sum[1] > 0 { near_sum } else { far_sum };
                *value = (sum + count / 2).checked_div(count).unwrap_or(0) as u8;
            }
        };
        all.par_chunks_mut(rays.width().max(1)).enumerate().for_each(row);
        all
    }

    /// The share of a point's surroundings that is hidden by points within `pixels` of it in the
    /// picture and within `reach` of it in space (Mara, `McGuire`, Bukowski, Luebke, "Scalable
    /// Ambient Obscurance", 2012).
    fn hidden(&self, [column, row]: [usize; 2], pixels: f32, reach: f32) -> f32 {
        let Some(here) = self.pixel(column as isize, row as isize) else { return 0.0 };
        let mut sum = 0.0;
        // Half a pixel is added so that truncation rounds to nearest. A position just left of the
        // picture or above it is truncated to the first pixel.
        let middle = Vec2::new(column as f32 + 0.5, row as f32 + 0.5);
        for look in self.looks[turn([column, row])] {
            let at = middle + pixels * look;
            let Some(there) = self.pixel(at.x as isize, at.y as isize) else { continue };
            if there.normal == Vec3::ZERO {
                continue;
            }
            let way = there.at - here.at;
            let (rise, square) = (way.dot(here.normal), way.length_squared());
            // Most points nearby lie in the tangent plane or behind it, and hide nothing.
            if rise > 0.0 && square < reach * reach {
                let near = 1.0 - square / (reach * reach);
                sum += (rise / square.sqrt() - FLAT).max(0.0) * near;
            }
        }
        (STRENGTH * sum / LOOKS as f32).min(1.0)
    }

    /// Replaces the value of each sampled pixel by a mean over the square of [`TURNS`] sampled
    /// pixels around it. The mean is over the pixels on the same part of the same surface.
    pub fn mean(&self, hidden: &mut [u8]) {
        let width = self.size[0];
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
                // The pixel itself is counted, so `count` is not 0.
                *hidden = ((sum + count / 2) / count.max(1)) as u8;
            }
        };
        hidden.par_chunks_mut(width.max(1)).enumerate().for_each(row);
    }
}

/// The painted point of a pixel. `None` if nothing is painted.
#[inline]
fn point(buffer: &GBuffer, rays: &RayGrid, centre: DVec3, pixel: usize) -> Option<ShadedPoint> {
    let (drawn, normal) = (buffer.drawn[pixel], Vec3::from_array(buffer.normal[pixel]));
    drawn.is_finite().then(|| {
        let ray = rays.ray_of(pixel);
        let is_behind = normal.dot(ray.direction.as_vec3()) > 0.0;
        let at = (ray.at(ray.parameter(drawn)) - centre).as_vec3();
        let normal = if is_behind { -normal } else { normal };
        ShadedPoint { at, normal, surface: buffer.surface[pixel] }
    })
}

/// Returns whether the whole square around a pixel has the same value; `false` near the picture's
/// edge.
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

impl ShadedPoint {
    /// Returns whether a place nearby is on the same part of the same surface: near the tangent
    /// plane, with a similar normal.
    fn is_beside(&self, other: &Self) -> bool {
        let way = other.at - self.at;
        let is_near = way.dot(self.normal).abs() <= 0.3 * way.length();
        self.surface == other.surface && self.normal.dot(other.normal) > 0.7 && is_near
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_space::{Camera, Projection};

    /// Two walls that meet at a right angle along the middle column. If `inward`, the camera is
    /// inside the corner, and otherwise outside.
    fn corner(inward: bool) -> (GBuffer, RayGrid) {
        let projection = Projection::Orthographic { height: 4.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let rays = RayGrid::new(&camera.expect("valid"), 64, 64);
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
            let occlusion = near.occlusion(0.8, &|| true);
            buffer.occlusion = occlusion;
            let column = |column: usize| {
                let rows = 24..40;
                let sum: u32 = rows.map(|row| u32::from(buffer.occlusion[row * 64 + column])).sum();
                (sum / 16) as u8
            };
            let row: Vec<u8> = (0..64).map(column).collect();
            assert!(row[4] < 10 && row[60] < 10, "far from the corner");
            assert_eq!(row[31] > 60 && row[32] > 60, inward, "at the corner");
            // The two sides may differ a little: the square reaches one pixel farther to the left,
            // and sampled places are not symmetric.
            assert!((24..32).all(|k| row[k].abs_diff(row[64 - k]) < 16));
        }
    }

    #[test]
    fn a_coarse_picture_has_nearly_the_same_occlusion() {
        for inward in [true, false] {
            let (buffer, rays) = corner(inward);
            let [fine, coarse] = [1, 2].map(|step| {
                let near = AmbientOcclusion::sampled(&buffer, &rays, DVec3::ZERO, step);
                near.occlusion(0.8, &|| true)
            });
            let differ = fine.iter().zip(&coarse).filter(|(a, b)| a.abs_diff(**b) > 24).count();
            assert!(differ * 50 < fine.len(), "{differ} pixels differ");
        }
    }

    #[test]
    fn a_mean_does_not_reach_across_an_edge() {
        let (buffer, rays) = corner(false);
        let near = AmbientOcclusion::new(&buffer, &rays, DVec3::ZERO);
        let halves = |pixel: usize| if pixel % 64 < 32 { 200 } else { 0 };
        let mut shadow: Vec<u8> = (0..64 * 64).map(halves).collect();
        let before = shadow.clone();
        near.mean(&mut shadow);
        assert_eq!(shadow, before);
        // Each of the pixels compared has the mean over all sixteen patterns.
        let of_turn = |pixel: usize| (16 * turn([pixel % 64, pixel / 64])) as u8;
        let mut shadow: Vec<u8> = (0..64 * 64).map(of_turn).collect();
        near.mean(&mut shadow);
        assert!((8..24).all(|column| shadow[30 * 64 + column] == 120));
    }

    #[test]
    fn each_of_sixteen_has_its_turn() {
        let mut seen: Vec<usize> = (0..16).map(|n| turn([n % 4, n / 4])).collect();
        seen.sort_unstable();
        assert_eq!(seen, (0..TURNS).collect::<Vec<_>>());
    }
}
