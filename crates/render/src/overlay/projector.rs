//! A picture with its camera, and the projection of points into it.

use super::canvas::Rgb;
use crate::model::Model;
use crate::picture::Picture;
use crate::pixels::is_dark;
use glam::{DVec2, DVec3};
use zeroset_scene::curves::TracedCurves;
use zeroset_space::{Camera, Projection, Region};
use zeroset_trace::RayGrid;

/// Colors of lines and letters, for light and dark backgrounds.
const INKS: [Rgb; 2] = [0x0030_3038, 0x00d8_d8e0];

/// A picture with its camera and region.
#[derive(Clone, Copy)]
pub struct PictureView<'a> {
    /// Camera of the picture.
    pub camera: &'a Camera,
    /// Region of the picture.
    pub region: &'a Region,
    /// The picture.
    pub picture: &'a Picture,
    /// Curves and points that are drawn over the picture.
    pub curves: &'a TracedCurves,
}

impl<'a> PictureView<'a> {
    /// A picture of a model. It may be a smaller one of the same view.
    pub fn of(model: &'a Model, camera: &'a Camera, picture: &'a Picture) -> Self {
        Self { camera, region: model.region(), picture, curves: model.curves() }
    }

    /// The color for lines and letters, which contrasts with the background.
    pub fn ink(&self) -> Rgb {
        INKS[usize::from(is_dark(self.picture.background))]
    }

    /// The color of letters, and that of a rim around them.
    pub fn letter_colors(&self) -> [Rgb; 2] {
        let [red, green, blue] = self.picture.background;
        [self.ink(), u32::from_be_bytes([0, red, green, blue])]
    }
}

/// Projects points into a picture of a given size.
pub struct Projector<'a> {
    pub shown: PictureView<'a>,
    pub rays: RayGrid,
}

impl<'a> Projector<'a> {
    /// A projector for a picture of this size. The shown picture may be smaller.
    pub fn new(shown: PictureView<'a>, width: usize, height: usize) -> Self {
        Self { shown, rays: RayGrid::new(shown.camera, width, height) }
    }

    /// Projects a point into the picture. Returns its position in pixels, and its distance from the
    /// ray's origin in world units. `None` if the point is not in front of the eye.
    pub fn project(&self, point: DVec3) -> Option<(DVec2, f64)> {
        let rays = &self.rays;
        let off = point - rays.eye();
        let way = off * rays.stretch();
        let depth = way.dot(rays.forward());
        let (reach, distance) = match self.shown.camera.projection() {
            Projection::Perspective { fov } => {
                ((fov.to_radians() / 2.0).tan() * depth, off.length())
            }
            Projection::Orthographic { height } => (height / 2.0, rays.ray(0, 0).distance(depth)),
        };
        if depth <= 1e-6 * way.length() || reach <= 0.0 {
            return None;
        }
        let half = rays.height() as f64 / 2.0;
        let across = rays.width() as f64 / 2.0 + way.dot(rays.right()) / reach * half;
        let down = half - way.dot(rays.up()) / reach * half;
        Some((DVec2::new(across, down), distance))
    }

    /// Column and row of the shown picture's pixel at a position.
    fn pixel(&self, at: DVec2) -> [usize; 2] {
        let buffer = &self.shown.picture.buffer;
        let scaled = |at: f64, size: usize, of: usize| {
            let place = (at * of as f64 / size as f64).max(0.0) as usize;
            place.min(of - 1)
        };
        let (width, height) = (self.rays.width(), self.rays.height());
        [scaled(at.x, width, buffer.width), scaled(at.y, height, buffer.height)]
    }

    /// Returns whether nothing is painted in front of a point at this position and distance.
    pub fn is_seen(&self, at: DVec2, distance: f64) -> bool {
        let buffer = &self.shown.picture.buffer;
        let [x, y] = self.pixel(at);
        // The margin keeps a surface that touches the box from hiding it.
        buffer.drawn[y * buffer.width + x] > distance * (1.0 - 2e-3)
    }

    /// Displayed length of a pixel at a point, given by its depth along the view.
    pub fn pixel_size(&self, depth: f64) -> f64 {
        let reach = match self.shown.camera.projection() {
            Projection::Perspective { fov } => (fov.to_radians() / 2.0).tan() * depth,
            Projection::Orthographic { height } => height / 2.0,
        };
        2.0 * reach / self.rays.height() as f64
    }

    /// Displayed distance of a point from the eye's plane.
    pub fn depth(&self, point: DVec3) -> f64 {
        ((point - self.rays.eye()) * self.rays.stretch()).dot(self.rays.forward())
    }

    /// Returns the index of the shown picture's pixel at a position, and whether a point at this
    /// distance is seen there or in a neighboring pixel. So a curve that lies on a surface is seen,
    /// however steep the surface is.
    pub fn is_seen_nearby(&self, at: DVec2, distance: f64) -> (usize, bool) {
        let buffer = &self.shown.picture.buffer;
        let [x, y] = self.pixel(at);
        let around = |at: usize, size: usize| at.saturating_sub(1)..=(at + 1).min(size - 1);
        let is_seen = around(y, buffer.height).any(|y| {
            let row = y * buffer.width;
            around(x, buffer.width).any(|x| buffer.drawn[row + x] > distance * (1.0 - 1e-3))
        });
        (y * buffer.width + x, is_seen)
    }
}
