//! Pixels for which one ray is not enough: those along visible edges.

use fearless_simd::{Level, f32x16, f64x8, prelude::*, u16x16};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;
use zeroset_eval::LANES;
use zeroset_eval::dispatch;
use zeroset_trace::painted::SHADED_ROWS;
use zeroset_trace::{GBuffer, RayGrid, SIDE};

/// Two normals make an edge if the cosine of their angle is below this (about 20 degrees).
const LEAST_COSINE: f32 = 0.94;
/// A step in depth is an edge if it is more than this many times a pixel's width, and more than
/// this many times the step that the slope causes.
const STEEPER: f64 = 3.0;

/// For each pixel, row by row, whether it differs from one of its four neighbors in surface, side,
/// depth or orientation. Features thinner than a pixel that no ray meets are not found.
pub fn edges(buffer: &GBuffer, rays: &RayGrid) -> Vec<bool> {
    let (width, height) = (rays.width(), rays.height());
    let pairs = EdgeDetector { buffer, rays, level: Level::new() };
    let mut edges = vec![false; buffer.drawn.len()];
    let bands = edges.par_chunks_mut((SHADED_ROWS * width).max(1));
    bands.enumerate().for_each(|(band, edges)| {
        let top = band * SHADED_ROWS;
        let rows = top..top + edges.len() / width;
        for row in rows.clone() {
            let (columns, here) = (pairs.painted(row), row * width);
            let edge = here - top * width;
            pairs.each(here..here + 1, columns, true, |column| {
                edges[edge + column..=edge + column + 1].fill(true);
            });
        }
        // Pairs of adjacent rows, including the rows just above and just below the band.
        for row in top.max(1)..=rows.end.min(height - 1) {
            let (above, below) = (pairs.painted(row - 1), pairs.painted(row));
            let here = row * width;
            let columns = above.start.min(below.start)..above.end.max(below.end) + 1;
            pairs.each(here - width..here, columns, false, |column| {
                for pixel in [here - width + column, here + column] {
                    if let Some(edge) = pixel.checked_sub(top * width)
                        && let Some(edge) = edges.get_mut(edge)
                    {
                        *edge = true;
                    }
                }
            });
        }
    });
    edges
}

struct EdgeDetector<'a> {
    buffer: &'a GBuffer,
    rays: &'a RayGrid,
    level: Level,
}

/// The compared quantities of adjacent pixels in a row.
struct PixelRun<'a> {
    drawn: &'a [f64],
    /// Empty if the picture has only one surface.
    surface: &'a [u16],
    cap: &'a [bool],
    normal: &'a [[f32; 3]],
}

impl<'a> PixelRun<'a> {
    #[inline]
    fn new(buffer: &'a GBuffer, first: usize, count: usize) -> Self {
        Self {
            drawn: &buffer.drawn[first..][..count],
            surface: buffer.surface.part(first..first + count).each,
            cap: buffer.cap.get(first..first + count).unwrap_or_default(),
            normal: &buffer.normal[first..][..count],
        }
    }
}

/// The bits of all lanes.
const ALL: u32 = (1 << LANES) - 1;

/// Compares sixteen pairs of pixels, of which the `k`th is the first. Returns a bit for each pair
/// that may have an edge; most pairs have none. Between pixels without an edge, depths differ by at
/// most `at_eye` plus `growth` times the smaller depth.
#[inline(always)]
fn differing<S: Simd>(
    simd: S,
    one: &PixelRun<'_>,
    other: &PixelRun<'_>,
    k: usize,
    [at_eye, growth]: [f64; 2],
) -> u32 {
    let here = k..k + LANES;
    let (mut bits, mut empty) = (0, 0);
    for half in [0, 8] {
        let part = k + half..k + half + 8;
        let a = f64x8::from_slice(simd, &one.drawn[part.clone()]);
        let b = f64x8::from_slice(simd, &other.drawn[part]);
        let step = a - b;
        bits |= (!step.abs().simd_le(at_eye + growth * a.min(b))).to_bitmask() << half;
        // The difference of two infinite depths is NaN: both pixels are empty, so there is no edge.
        empty |= step.is_nan().to_bitmask() << half;
    }
    if let (Some(a), Some(b)) = (one.surface.get(here.clone()), other.surface.get(here.clone())) {
        let (a, b) = (u16x16::from_slice(simd, a), u16x16::from_slice(simd, b));
        bits |= a.simd_ne(b).to_bitmask();
    }
    // If the picture has no caps, both slices are `None`.
    if one.cap.get(here.clone()) != other.cap.get(here.clone()) {
        return ALL & !empty as u32;
    }
    let [n, m] = [one, other].map(|side| side.normal[here.clone()].as_flattened());
    let mut products = [0.0; 3 * LANES];
    for part in 0..3 {
        let part = LANES * part..LANES * (part + 1);
        let n = f32x16::from_slice(simd, &n[part.clone()]);
        (n * f32x16::from_slice(simd, &m[part.clone()])).store_slice(&mut products[part]);
    }
    let mut cosine = [0.0; LANES];
    for (cosine, [x, y, z]) in cosine.iter_mut().zip(products.as_chunks::<3>().0) {
        *cosine = x + y + z;
    }
    let is_even = f32x16::simd_from(simd, cosine).simd_ge(LEAST_COSINE);
    ALL & ((bits | (!is_even).to_bitmask()) & !empty) as u32
}

impl EdgeDetector<'_> {
    /// The columns of a row that may have an edge at their right border. They reach from the column
    /// before the first painted pixel to the last painted pixel, without the picture's last column.
    /// Empty if no pixel is painted.
    fn painted(&self, row: usize) -> Range<usize> {
        let width = self.rays.width();
        let drawn = &self.buffer.drawn[row * width..][..width];
        let is_painted = |distance: &f64| distance.is_finite();
        let first = drawn.iter().position(is_painted).unwrap_or(width);
        let last = drawn.iter().rposition(is_painted).unwrap_or(0);
        first.saturating_sub(1)..(last + 1).min(width - 1)
    }

    /// Calls `edge` with each column in which there is an edge between two pixels. In column k, the
    /// pixels have the indices `pair.start` + k and `pair.end` + k; the second is to the right of
    /// the first, or below it.
    #[inline]
    fn each(
        &self,
        pair: Range<usize>,
        columns: Range<usize>,
        is_row: bool,
        mut edge: impl FnMut(usize),
    ) {
        let (start, count) = (columns.start, columns.len());
        let side = |first: usize| PixelRun::new(self.buffer, first + start, count);
        let (one, other) = (side(pair.start), side(pair.end));
        let even = self.rays.pixel().map(|part| STEEPER * part);
        let mut look = |k: usize| {
            if self.is_edge([pair.start, pair.end].map(|first| first + start + k), is_row) {
                edge(start + k);
            }
        };
        if count < LANES {
            (0..count).for_each(look);
            return;
        }
        for k in (0..count).step_by(LANES) {
            // The last sixteen pairs must lie in the row, so some may be compared twice.
            let k = k.min(count - LANES);
            let mut left = dispatch!(self.level, simd => differing(simd, &one, &other, k, even));
            while left != 0 {
                look(k + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
    }

    /// Returns whether there is an edge between two pixels.
    fn is_edge(&self, pixels: [usize; 2], is_row: bool) -> bool {
        let buffer = self.buffer;
        let [a, b] = pixels.map(|pixel| buffer.drawn[pixel]);
        let step = (a - b).abs();
        if !step.is_finite() {
            // The difference of two infinite depths is NaN: both pixels are empty.
            return !step.is_nan();
        }
        let [n, m] = pixels.map(|pixel| buffer.normal[pixel]);
        let [one, other] = pixels.map(|pixel| (buffer.surface[pixel], buffer.is_cap(pixel)));
        // Normals point toward f > 0, so they differ between the two sides of a surface.
        let is_even = n[0] * m[0] + n[1] * m[1] + n[2] * m[2] >= LEAST_COSINE;
        let footprint = self.rays.footprint(a.min(b));
        one != other || !is_even || step > STEEPER * footprint * self.slope(pixels, is_row).max(1.0)
    }

    /// The change of depth from pixel to pixel, in widths of a pixel, at the steeper of these two
    /// pixels.
    fn slope(&self, pixels: [usize; 2], is_row: bool) -> f64 {
        let axis = if is_row { self.rays.right() } else { self.rays.up() };
        let slope = |pixel: usize| slope_along(self.buffer.normal[pixel], self.rays, pixel, axis);
        slope(pixels[0]).max(slope(pixels[1]))
    }
}

/// The change of depth along an axis of the picture for this normal, in widths of a pixel.
fn slope_along(normal: [f32; 3], rays: &RayGrid, pixel: usize, axis: DVec3) -> f64 {
    let normal = DVec3::from_array(normal.map(f64::from));
    let along = rays.ray_of(pixel).direction.normalize();
    (normal.dot(axis) / normal.dot(along)).abs()
}

/// The steepest change of depth per pixel in the picture, in widths of a pixel, for this normal.
/// `along` is a unit vector along the ray.
pub fn slope(normal: [f32; 3], along: Vec3) -> f32 {
    // The tangent of the angle between normal and view.
    let cosine = Vec3::from_array(normal).dot(along);
    ((1.0 - cosine * cosine).max(0.0) / (cosine * cosine)).sqrt()
}

/// Returns whether a pixel shows a crease of a surface: its normal differs from the normal of one
/// of the four pixels beside it, or only one of these two pixels is on a cap.
pub fn is_creased(buffer: &GBuffer, rays: &RayGrid, pixel: usize) -> bool {
    let normal = |pixel: usize| Vec3::from_array(buffer.normal[pixel]);
    let differs = |other: usize| {
        buffer.is_drawn(other)
            && (normal(pixel).dot(normal(other)) < LEAST_COSINE
                || buffer.is_cap(pixel) != buffer.is_cap(other))
    };
    rays.beside(pixel).into_iter().flatten().any(differs)
}

/// Returns whether a whole patch shows one smooth part of one surface, so that it needs no shading
/// of its own. The patch refines a coarser pixel with this `normal`. `row` is the patch's row in
/// `buffer` and `rays`.
///
/// # Panics
/// If there is no such row.
pub fn is_smooth(buffer: &GBuffer, rays: &RayGrid, row: usize, normal: [f32; 3]) -> bool {
    let first = row * LANES;
    let drawn: &[f64; LANES] = buffer.drawn[first..].first_chunk().expect("a row");
    if !drawn.iter().all(|distance| distance.is_finite()) {
        return false;
    }
    let most = STEEPER * rays.footprint(drawn[0]);
    let [across, down] = [rays.right(), rays.up()]
        .map(|axis| most * slope_along(normal, rays, first + LANES / 2, axis).max(1.0));
    let caps = buffer.cap.get(first..first + LANES).unwrap_or_default();
    let is_below = |n: usize, next: usize, step: f64| (drawn[n + next] - drawn[n]).abs() <= step;
    caps.iter().all(|cap| *cap == caps[0])
        && (0..LANES).filter(|n| n % SIDE < SIDE - 1).all(|n| is_below(n, 1, across))
        && (0..LANES - SIDE).all(|n| is_below(n, SIDE, down))
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_space::{Camera, Projection};

    fn rays(width: usize, height: usize) -> RayGrid {
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        RayGrid::new(&camera.expect("valid"), width, height)
    }

    /// A wall at distance 4 that faces the eye.
    fn wall(width: usize, height: usize) -> GBuffer {
        let mut buffer = GBuffer::new(width, height, 0);
        buffer.keep_caps();
        buffer.drawn.fill(4.0);
        buffer.normal.fill([0.0, -1.0, 0.0]);
        buffer
    }

    fn around(change: impl Fn(&mut GBuffer, usize)) -> Vec<usize> {
        // Rows 7 and 8 are in different bands.
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
        assert_eq!(
            around(|buffer, pixel| buffer.surface.set(pixel, 1, buffer.status.len())),
            cross
        );
        assert_eq!(around(|buffer, pixel| buffer.cap[pixel] = true), cross);
        assert_eq!(around(|buffer, pixel| buffer.normal[pixel] = [0.6, -0.8, 0.0]), cross);
        assert_eq!(around(|buffer, pixel| buffer.drawn[pixel] = 3.0), cross);
    }

    #[test]
    fn sixteen_pairs_at_once_are_as_each_alone() {
        let (width, height) = (53, 19);
        let mut random = {
            let mut state = 7_u32;
            move |below: u32| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (state >> 16) % below
            }
        };
        let mut buffer = wall(width, height);
        for pixel in 0..width * height {
            match random(40) {
                0 => buffer.drawn[pixel] = f64::INFINITY,
                1 => buffer.drawn[pixel] = 3.5 + f64::from(random(100)) / 100.0,
                2 => buffer.surface.set(pixel, 1, buffer.status.len()),
                3 => buffer.cap[pixel] = true,
                4 => buffer.normal[pixel] = [0.6, -0.8, 0.0],
                _ => {}
            }
        }
        let rays = rays(width, height);
        let pairs = EdgeDetector { buffer: &buffer, rays: &rays, level: Level::new() };
        let mut expected = vec![false; width * height];
        for pixel in 0..width * height {
            for (other, is_row) in [(pixel + 1, true), (pixel + width, false)] {
                let is_pair = other < width * height && (!is_row || other % width > 0);
                if is_pair && pairs.is_edge([pixel, other], is_row) {
                    (expected[pixel], expected[other]) = (true, true);
                }
            }
        }
        assert_eq!(edges(&buffer, &rays), expected);
        assert!(expected.contains(&true) && expected.contains(&false));
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

    #[test]
    fn what_is_smooth_is_not_lit_anew() {
        let whole = rays(40, 32);
        let patch = zeroset_trace::Patch { column: 8, row: 8, between: [0.0, f64::INFINITY] };
        let rays = whole.patches([patch; 2].into());
        let normal = [0.0, -1.0, 0.0];
        let is_smooth = |change: &dyn Fn(&mut GBuffer)| {
            let mut buffer = wall(16, 2);
            change(&mut buffer);
            [0, 1].map(|row| super::is_smooth(&buffer, &rays, row, normal))
        };
        assert_eq!(is_smooth(&|_| {}), [true; 2]);
        assert_eq!(is_smooth(&|buffer| buffer.drawn[3] = f64::INFINITY), [false, true]);
        assert_eq!(is_smooth(&|buffer| buffer.drawn[31] = 3.0), [true, false]);
        assert_eq!(is_smooth(&|buffer| buffer.cap[20] = true), [true, false]);
        // Within a patch, depth may change from row to row as much as from column to column.
        // Adjacent patches are not compared.
        assert_eq!(is_smooth(&|buffer| buffer.drawn[16..].fill(1.0)), [true; 2]);
    }

    #[test]
    fn a_crease_is_seen_on_both_sides() {
        let rays = rays(9, 9);
        let mut buffer = wall(9, 9);
        for pixel in (0..81).filter(|pixel| pixel % 9 > 4) {
            buffer.normal[pixel] = [0.6, -0.8, 0.0];
        }
        let creased: Vec<usize> = (0..9).filter(|n| is_creased(&buffer, &rays, 36 + n)).collect();
        assert_eq!(creased, [4, 5]);
    }
}
