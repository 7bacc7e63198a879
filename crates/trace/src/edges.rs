//! Where one ray does not tell what a pixel shows: along the edges of what is seen.

use crate::gbuffer::GBuffer;
use crate::grid::RayGrid;
use crate::painted::BAND;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Normals that differ by more than this cosine make an edge: 20 degrees.
const SAME_WAY: f32 = 0.94;
/// A step in depth this many times as far as the surface's slope explains, and as far as a pixel is wide, makes an edge.
const STEEPER: f64 = 3.0;

/// Whether a pixel differs from one of the four beside it: in what surface it shows, if any, from which side, at what
/// distance, or which way that faces. Row by row; what is thinner than a pixel and on no ray is not seen.
pub fn edges(buffer: &GBuffer, rays: &RayGrid) -> Vec<bool> {
    let (width, height) = (rays.width(), rays.height());
    let pairs = Pairs { buffer, rays };
    let mut edges = vec![false; buffer.drawn.len()];
    let bands = edges.par_chunks_mut((BAND * width).max(1));
    bands.enumerate().for_each(|(band, edges)| {
        let top = band * BAND;
        let rows = top..top + edges.len() / width;
        for row in rows.clone() {
            for column in pairs.painted(row) {
                let here = row * width + column;
                if pairs.differ(here, here + 1, true) {
                    let edge = here - top * width;
                    edges[edge..=edge + 1].fill(true);
                }
            }
        }
        // Pairs of rows, the one above the band and the one below it among them.
        for row in top.max(1)..=rows.end.min(height - 1) {
            let (above, below) = (pairs.painted(row - 1), pairs.painted(row));
            for column in above.start.min(below.start)..=above.end.max(below.end) {
                let here = row * width + column;
                if pairs.differ(here - width, here, false) {
                    for pixel in [here - width, here] {
                        if let Some(edge) = pixel.checked_sub(top * width)
                            && let Some(edge) = edges.get_mut(edge)
                        {
                            *edge = true;
                        }
                    }
                }
            }
        }
    });
    edges
}

struct Pairs<'a> {
    buffer: &'a GBuffer,
    rays: &'a RayGrid,
}

impl Pairs<'_> {
    /// The columns of a row from the one before the first that is painted to the last, but no farther than the last but one
    /// of the picture; none if none is painted.
    fn painted(&self, row: usize) -> Range<usize> {
        let width = self.rays.width();
        let drawn = &self.buffer.drawn[row * width..][..width];
        let is_painted = |distance: &f64| distance.is_finite();
        let first = drawn.iter().position(is_painted).unwrap_or(width);
        let last = drawn.iter().rposition(is_painted).unwrap_or(0);
        first.saturating_sub(1)..(last + 1).min(width - 1)
    }

    /// Whether there is an edge between two pixels, the first left of the second, or above it.
    #[inline]
    fn differ(&self, one: usize, other: usize, is_row: bool) -> bool {
        let GBuffer { drawn, surface, cap, normal, .. } = self.buffer;
        let step = (drawn[one] - drawn[other]).abs();
        if !step.is_finite() {
            // Two that are infinite have no difference.
            return !step.is_nan();
        }
        if surface[one] != surface[other] || cap[one] != cap[other] {
            return true;
        }
        let [a, b] = [one, other].map(|pixel| Vec3::from_array(normal[pixel]));
        // Towards the other side, too, if the other side is seen.
        if a.dot(b) < SAME_WAY {
            return true;
        }
        let footprint = self.rays.footprint(drawn[one].min(drawn[other]));
        step > STEEPER * footprint && step > STEEPER * self.slope([one, other], is_row) * footprint
    }

    /// How far depth changes from pixel to pixel at the steeper of two, in pixels' widths.
    fn slope(&self, pixels: [usize; 2], is_row: bool) -> f64 {
        let axis = if is_row { self.rays.right() } else { self.rays.up() };
        let slope = |pixel: usize| {
            let normal = DVec3::from_array(self.buffer.normal[pixel].map(f64::from));
            let along = self.rays.ray_of(pixel).direction.normalize();
            (normal.dot(axis) / normal.dot(along)).abs()
        };
        slope(pixels[0]).max(slope(pixels[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};

    fn rays(width: usize, height: usize) -> RayGrid {
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        camera.expect("valid").rays(width, height)
    }

    /// A wall at distance 4 that faces the eye.
    fn wall(width: usize, height: usize) -> GBuffer {
        let mut buffer = GBuffer::new(width, height, 0);
        buffer.drawn.fill(4.0);
        buffer.normal.fill([0.0, -1.0, 0.0]);
        buffer
    }

    fn around(change: impl Fn(&mut GBuffer, usize)) -> Vec<usize> {
        // Rows 7 and 8 are of different bands.
        let (width, pixel) = (9, 8 * 9 + 4);
        let mut buffer = wall(width, 20);
        change(&mut buffer, pixel);
        let edges = edges(&buffer, &rays(width, 20));
        (0..edges.len()).filter(|&pixel| edges[pixel]).collect()
    }

    #[test]
    fn both_sides_of_every_difference_are_an_edge() {
        let cross = [7 * 9 + 4, 8 * 9 + 3, 8 * 9 + 4, 8 * 9 + 5, 9 * 9 + 4];
        assert_eq!(around(|_, _| {}), []);
        assert_eq!(around(|buffer, pixel| buffer.drawn[pixel] = f64::INFINITY), cross);
        assert_eq!(around(|buffer, pixel| buffer.surface[pixel] = 1), cross);
        assert_eq!(around(|buffer, pixel| buffer.cap[pixel] = true), cross);
        assert_eq!(around(|buffer, pixel| buffer.normal[pixel] = [0.6, -0.8, 0.0]), cross);
        assert_eq!(around(|buffer, pixel| buffer.drawn[pixel] = 3.0), cross);
    }

    #[test]
    fn slopes_and_the_background_are_none() {
        let rays = rays(40, 30);
        let normal = DVec3::new(-0.8, -0.6, 0.0);
        let mut buffer = wall(40, 30);
        for pixel in 0..40 * 30 {
            // The plane through the origin with that normal.
            let ray = rays.ray_of(pixel);
            buffer.drawn[pixel] = -ray.origin.dot(normal) / ray.direction.dot(normal);
            buffer.normal[pixel] = normal.as_vec3().to_array();
        }
        assert!(!edges(&buffer, &rays).contains(&true));
        buffer.drawn.fill(f64::INFINITY);
        assert!(!edges(&buffer, &rays).contains(&true));
    }
}
