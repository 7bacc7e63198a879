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
    /// Half the picture's height: on the plane at distance 1, or in world units if parallel.
    scale: f64,
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
            scale,
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
        let (width, height) = (self.width as f64, self.height as f64);
        let across = (2.0 * (i as f64 + 0.5) / width - 1.0) * self.scale * (width / height);
        let upward = (1.0 - 2.0 * (j as f64 + 0.5) / height) * self.scale;
        let offset = across * self.right + upward * self.up;
        if self.parallel {
            Ray { origin: self.eye + offset, direction: self.forward }
        } else {
            Ray { origin: self.eye, direction: (self.forward + offset).normalize() }
        }
    }

    /// The ray of the pixel with this index, counted row by row from the top.
    pub fn ray_of(&self, index: usize) -> Ray {
        self.ray(index % self.width, index / self.width)
    }
}
