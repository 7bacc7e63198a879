//! The grid of rays of one picture: a camera together with a size in pixels.

use crate::camera::{Camera, Projection, Ray};
use glam::DVec3;

/// The rays of a picture, one through each pixel's centre.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    width: usize,
    height: usize,
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Half a pixel's height: on the plane at distance 1, or in world units if parallel.
    unit: f64,
    parallel: bool,
}

impl Frame {
    pub(crate) fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let forward = (camera.target() - camera.eye()).normalize();
        // Normalised first, so that a tiny or huge `up` neither underflows nor overflows.
        let right = forward.cross(camera.up().normalize()).normalize();
        let (scale, parallel) = match camera.projection() {
            Projection::Perspective { fov } => ((fov.to_radians() / 2.0).tan(), false),
            Projection::Orthographic { height } => (height / 2.0, true),
        };
        Self {
            width,
            height,
            eye: camera.eye(),
            forward,
            right,
            up: right.cross(forward),
            unit: scale / height as f64,
            parallel,
        }
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Where the picture is taken from.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The direction of view, of length 1.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The direction of the picture's right edge, of length 1.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The direction of the picture's upper edge, of length 1.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The ray through the centre of the pixel in column `i` and row `j`, by the formula of [`Camera::ray`].
    pub fn ray(&self, i: usize, j: usize) -> Ray {
        let (origin, direction) = self.line(i, j);
        Ray { origin, direction: direction.normalize() }
    }

    /// Origin and direction of the same ray, the direction at any length: without the cost of a root and a division.
    #[inline]
    pub(crate) fn line(&self, i: usize, j: usize) -> (DVec3, DVec3) {
        // (2(i+½)/width − 1)·s·width/height and (1 − 2(j+½)/height)·s with s the scale: integers until the last step.
        let across = (2 * i as i64 + 1 - self.width as i64) as f64 * self.unit;
        let upward = (self.height as i64 - 1 - 2 * j as i64) as f64 * self.unit;
        let offset = across * self.right + upward * self.up;
        if self.parallel {
            (self.eye + offset, self.forward)
        } else {
            (self.eye, self.forward + offset)
        }
    }

    /// The ray of the pixel with this index, counted row by row from the top.
    pub fn ray_of(&self, index: usize) -> Ray {
        self.ray(index % self.width, index / self.width)
    }
}
