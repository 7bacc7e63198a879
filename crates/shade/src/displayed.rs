//! Pictures of a stretched space, as seen in the displayed space. Light, edges and occlusion are
//! those of the displayed space, so the code that computes them ignores stretching.

use glam::Vec3;
use rayon::prelude::*;
use std::borrow::Cow;
use zeroset_trace::{GBuffer, RayGrid};

/// Fewest pixels that a thread converts.
const LEAST: usize = 4096;

/// A picture and its rays in the displayed space.
pub struct Displayed<'a> {
    /// The G-buffer, whose distances and normals are measured in the displayed space. Its brackets
    /// are not converted.
    pub buffer: Cow<'a, GBuffer>,
    /// The rays.
    pub rays: Cow<'a, RayGrid>,
}

impl<'a> Displayed<'a> {
    /// The picture `buffer` along `rays`. It is borrowed unless space is stretched.
    pub fn new(buffer: &'a GBuffer, rays: &'a RayGrid) -> Self {
        if !rays.is_stretched() {
            return Self { buffer: Cow::Borrowed(buffer), rays: Cow::Borrowed(rays) };
        }
        let (seen, stretch) = (rays.displayed(), rays.stretch());
        let mut buffer = buffer.clone();
        buffer.drawn.par_iter_mut().enumerate().with_min_len(LEAST).for_each(|(pixel, drawn)| {
            if drawn.is_finite() {
                // A point has the same t in both spaces.
                *drawn = seen.ray_of(pixel).distance(rays.ray_of(pixel).parameter(*drawn));
            }
        });
        let shrink = stretch.recip().as_vec3();
        buffer.normal.par_iter_mut().with_min_len(LEAST).for_each(|normal| {
            *normal = (Vec3::from_array(*normal) * shrink).normalize_or_zero().to_array();
        });
        Self { buffer: Cow::Owned(buffer), rays: Cow::Owned(seen) }
    }
}
