//! The grid of rays of one picture: a camera together with a size in pixels.

use crate::painted::PixelWindow;
use crate::scalar::Scalar;
use fearless_simd::{f32x16, f64x8, prelude::*};
use glam::{DVec3, Vec3};
use std::ops::Range;
use std::sync::Arc;
use zeroset_eval::{LANES, Lanes};
use zeroset_space::{Basis, Camera, Projection, Ray};

/// Number of rows in a band, which is the unit of a thread's work and of cancellation. It is also
/// the side of the largest tiles, in pixels.
pub const BAND_ROWS: usize = 16;

/// Number of pixels on the side of a [`Patch`].
pub const SIDE: usize = LANES.isqrt();

/// Relative error of the projection of a point onto the screen.
const PROJECTION_ERROR: f64 = 1e-14;

/// A square of 4×4 pixels of a picture, which is traced on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The square's first column.
    pub column: usize,
    /// The square's first row.
    pub row: usize,
    /// Range of t in which zeros are wanted. A method may skip zeros outside it.
    pub between: [f64; 2],
}

/// The rays of a picture, one through the center of each pixel. Or the rays of some
/// [patches](Self::patches) of a picture.
#[derive(Clone, Debug)]
pub struct RayGrid {
    width: usize,
    height: usize,
    /// Position of the first pixel's center relative to the picture's middle: to the right, and
    /// upward. The unit is half a pixel.
    first: [i64; 2],
    /// Column and row of the whole picture in which this part begins.
    pub corner: [usize; 2],
    /// Bounds of the screen coordinates: half the whole picture's width and height. A part has the
    /// bounds of the whole, so that it is traced in the same way.
    pub(crate) reach: [f64; 2],
    eye: DVec3,
    /// For each axis, the factor by which lengths are multiplied for display.
    stretch: DVec3,
    /// The axes of the view as displayed.
    basis: Basis,
    /// The same axes in space: a ray's direction is a sum of their multiples.
    pub(crate) axes: Basis,
    /// The direction of view, then the change of a ray's direction per half pixel to the right and
    /// per half pixel upward. In an orthographic picture, the ray's origin changes instead. Stored
    /// in `f32`, since each window needs the numbers in `f32`.
    steps: [Vec3; 3],
    /// Half the distance between neighboring pixels, in screen coordinates. Perspective screen
    /// coordinates are measured on the plane at distance 1 from the eye, others in world units.
    pub unit: f64,
    /// Whether the picture is orthographic.
    pub(crate) parallel: bool,
    /// Whether space is stretched for display.
    is_stretched: bool,
    patches: Option<Arc<[Patch]>>,
}

/// The pixels of a picture in which a box may be visible.
#[derive(Clone, Debug, PartialEq)]
pub struct Window {
    /// Columns of pixels. Rays through pixels outside of these columns and rows, and through the
    /// edges of these pixels, do not meet the box.
    pub columns: Range<usize>,
    /// Rows of pixels.
    pub rows: Range<usize>,
}

impl Window {
    /// Returns whether the window has pixels of these columns and rows.
    pub fn shows(&self, columns: &Range<usize>, rows: &Range<usize>) -> bool {
        let overlap = |a: &Range<usize>, b: &Range<usize>| a.start.max(b.start) < a.end.min(b.end);
        overlap(&self.columns, columns) && overlap(&self.rows, rows)
    }

    /// Returns whether the window has the pixel in this column and row.
    pub fn contains(&self, column: usize, row: usize) -> bool {
        self.columns.contains(&column) && self.rows.contains(&row)
    }

    /// The window, enlarged to whole tiles of the largest size. So rays of its part of the picture
    /// form the same tiles as in the whole picture.
    #[must_use]
    pub fn with_whole_tiles(&self, rays: &RayGrid) -> Self {
        let whole = |range: &Range<usize>, size: usize| {
            let first = range.start / BAND_ROWS * BAND_ROWS;
            first..range.end.next_multiple_of(BAND_ROWS).min(size)
        };
        let (columns, rows) = (whole(&self.columns, rays.width), whole(&self.rows, rays.height));
        Self { columns, rows }
    }
}

impl RayGrid {
    /// The rays of a picture of `width` × `height` pixels.
    pub fn new(camera: &Camera, width: usize, height: usize) -> Self {
        let (scale, parallel) = match camera.projection() {
            Projection::Perspective { fov } => (half_tangent(fov), false),
            Projection::Orthographic { height } => (height / 2.0, true),
        };
        let unit = scale / height as f64;
        let (eye, stretch, basis) = (camera.eye(), camera.stretch(), camera.basis());
        let axes = basis.divided(stretch);
        let reach = [width as f64 * unit, height as f64 * unit];
        let (first, patches) = ([1 - width as i64, height as i64 - 1], None);
        let (corner, steps) = ([0; 2], steps(&basis, unit));
        Self {
            width,
            height,
            first,
            corner,
            reach,
            eye,
            stretch,
            is_stretched: stretch != DVec3::ONE,
            basis,
            axes,
            steps,
            unit,
            parallel,
            patches,
        }
    }

    /// The rays of some columns and rows, counted from the left and upper edges of `self`. They
    /// equal the same rays of `self`, bit for bit.
    ///
    /// # Panics
    /// If the ranges exceed the picture.
    #[must_use]
    pub fn part(&self, columns: Range<usize>, rows: Range<usize>) -> Self {
        assert!(columns.end <= self.width && rows.end <= self.height, "outside of the picture");
        let [across, upward] = self.first;
        let first = [across + 2 * columns.start as i64, upward - 2 * rows.start as i64];
        let corner = [self.corner[0] + columns.start, self.corner[1] + rows.start];
        Self { width: columns.len(), height: rows.len(), first, corner, ..self.clone() }
    }

    /// The window of the whole picture or part.
    pub fn everywhere(&self) -> Window {
        Window { columns: 0..self.width, rows: 0..self.height }
    }

    /// The window in which the box with the corners `low` and `high` may be visible. Not for
    /// patches.
    pub fn window(&self, low: DVec3, high: DVec3) -> Window {
        let Basis { forward, right, up } = self.basis;
        // Range of the box's screen coordinates, and its least depth.
        let mut screen = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let mut nearest = f64::INFINITY;
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            let corner = DVec3::new(pick(0), pick(1), pick(2));
            let [corner, eye] = [corner, self.eye].map(|point| point * self.stretch);
            let off = corner - eye;
            // Far above the rounding errors of these numbers, of the basis and of rays.
            let error = PROJECTION_ERROR * (off.length() + corner.length() + eye.length());
            let depth = off.dot(forward);
            nearest = nearest.min(depth - error);
            for (screen, axis) in screen.iter_mut().zip([right, up]) {
                let (mut at, mut error) = (off.dot(axis), error);
                if !self.parallel {
                    at /= depth;
                    error *= (1.0 + at.abs()) / (depth - error);
                }
                *screen = [screen[0].min(at - error), screen[1].max(at + error)];
            }
        }
        // The corners' hull is that of the box only if the box lies in front of the eye.
        let is_in_front = self.parallel || nearest > 0.0;
        if !is_in_front || !screen.as_flattened().iter().all(|end| end.is_finite()) {
            return self.everywhere();
        }
        let [across, upward] = self.first.map(|first| first as f64);
        let [columns, rows] = [screen[0], screen[1].map(|end| -end)]
            .map(|[one, other]| [one.min(other) / self.unit, one.max(other) / self.unit]);
        let range = |[first, last]: [f64; 2], size: usize| {
            // A margin of a pixel, since rays pass anywhere through a pixel. Casts saturate.
            let first = (first / 2.0).floor() - 1.0;
            let end = (last / 2.0).ceil() + 2.0;
            (first.max(0.0) as usize).min(size)..(end.max(0.0) as usize).min(size)
        };
        let columns = range(columns.map(|end| end - across), self.width);
        let rows = range(rows.map(|end| end + upward), self.height);
        Window { columns, rows }
    }

    /// The rays of this picture or part, with each pixel divided into `times` columns and rows.
    #[must_use]
    pub fn finer(&self, times: usize) -> Self {
        let (width, height) = (self.width * times, self.height * times);
        let unit = self.unit / times as f64;
        let [across, upward] = self.first;
        let first = [(across - 1) * times as i64 + 1, (upward + 1) * times as i64 - 1];
        let (corner, steps) = (self.corner.map(|place| place * times), steps(&self.basis, unit));
        Self { width, height, first, corner, steps, unit, ..self.clone() }
    }

    /// The rays of patches of the picture. Each row of the result has the sixteen pixels of one
    /// patch, row by row. Traced results may be drawn but prove nothing, since zeros are found only
    /// within [`Patch::between`].
    #[must_use]
    pub fn patches(&self, patches: Arc<[Patch]>) -> Self {
        Self { width: LANES, height: patches.len(), patches: Some(patches), ..self.clone() }
    }

    /// The patch whose pixels are in this row; `None` if the grid does not consist of patches.
    #[inline]
    pub(crate) fn patch(&self, row: usize) -> Option<Patch> {
        self.patches.as_ref().map(|patches| patches[row])
    }

    /// Returns whether these are the rays of patches.
    #[inline]
    pub fn is_patched(&self) -> bool {
        self.patches.is_some()
    }

    /// The indices of the pixels left of, right of, above and below a pixel. `None` for a neighbor
    /// outside the picture or patch.
    pub fn beside(&self, pixel: usize) -> [Option<usize>; 4] {
        let width = if self.is_patched() { SIDE } else { self.width };
        let (column, rows) = (pixel % width, self.width * self.height / width);
        let mut row = pixel / width;
        let mut last = rows - 1;
        if self.is_patched() {
            // Patches are not neighbors of each other.
            (row, last) = (row % SIDE, SIDE - 1);
        }
        [
            (column > 0).then(|| pixel - 1),
            (column + 1 < width).then_some(pixel + 1),
            (row > 0).then(|| pixel - width),
            (row < last).then_some(pixel + width),
        ]
    }

    /// Number of pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The position of the camera's eye.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// For each axis, the factor by which lengths are multiplied for display. The directions of
    /// view and the widths of pixels are measured in the displayed space.
    pub fn stretch(&self) -> DVec3 {
        self.stretch
    }

    /// Returns whether space is stretched for display.
    #[inline]
    pub fn is_stretched(&self) -> bool {
        self.is_stretched
    }

    /// The rays of the same picture in the displayed space. A point on a ray has the same t in both
    /// spaces.
    #[must_use]
    pub fn displayed(&self) -> Self {
        let (eye, stretch, axes) = (self.eye * self.stretch, DVec3::ONE, self.basis);
        Self { eye, stretch, is_stretched: false, axes, ..self.clone() }
    }

    /// The direction of view, of length 1.
    pub fn forward(&self) -> DVec3 {
        self.basis.forward
    }

    /// The direction to the right in the picture, of length 1.
    pub fn right(&self) -> DVec3 {
        self.basis.right
    }

    /// The direction upward in the picture, of length 1.
    pub fn up(&self) -> DVec3 {
        self.basis.up
    }

    /// The ray through the center of the pixel in column `i` and row `j`. Row 0 is on top.
    ///
    /// The ray's direction is `forward + (2(i+½)/width − 1)·s·(width/height)·right + (1 −
    /// 2(j+½)/height)·s·up`, where `s` is the tangent of half the vertical field of view.
    ///
    /// In an orthographic picture the direction is `forward`. The other two terms then move the
    /// origin, and `s` is half the picture's height in world units. [`Camera`] bounds the rounding
    /// errors of rays.
    #[inline]
    pub fn ray(&self, i: usize, j: usize) -> Ray {
        self.through(self.offset(i, j))
    }

    /// The ray through a place, which is relative to the picture's middle. The unit is half a
    /// pixel.
    #[inline]
    fn through(&self, place: [f64; 2]) -> Ray {
        let [across, upward] = place.map(|offset| offset * self.unit);
        let Basis { forward, right, up } = self.axes;
        let offset = across * right + upward * up;
        if self.parallel {
            Ray { origin: self.eye + offset, direction: forward }
        } else {
            Ray { origin: self.eye, direction: forward + offset }
        }
    }

    /// Screen coordinates of the point halfway between the centers of two pixels. `columns` is the
    /// sum of their columns, `rows` the sum of their rows. Both are counted in this picture or
    /// part, never in a patch.
    ///
    /// A ray with screen coordinates a and b has the direction `forward` + a·`right` + b·`up`. In
    /// an orthographic picture, its origin is the eye + a·`right` + b·`up`.
    #[inline]
    pub fn screen(&self, columns: usize, rows: usize) -> [f64; 2] {
        let [across, upward] = self.first;
        [across + columns as i64, upward - rows as i64].map(|place| place as f64 * self.unit)
    }

    /// [Screen coordinates](Self::screen) of four points along one axis. For the first point, `sum`
    /// is the sum of two columns, or of two rows. From point to point it changes by `step`.
    #[inline(always)]
    pub(crate) fn screens(&self, axis: usize, sum: usize, step: usize) -> [f64; 4] {
        let [across, upward] = self.first;
        // All numbers are integers until the multiplication by the unit, which rounds.
        let (first, step) = if axis == 0 {
            (across + sum as i64, step as f64)
        } else {
            (upward - sum as i64, -(step as f64))
        };
        [0.0, 1.0, 2.0, 3.0].map(|k| (first as f64 + k * step) * self.unit)
    }

    /// The approximate width of a pixel at a distance from the eye. Width and distance are both in
    /// units of t, or both in world units.
    #[inline]
    pub fn footprint(&self, distance: f64) -> f64 {
        let [at_eye, growth] = self.pixel();
        at_eye + growth * distance
    }

    /// The approximate width of a pixel at t = 0, and its growth per t, both in units of t.
    #[inline]
    pub fn pixel(&self) -> [f64; 2] {
        let width = 2.0 * self.unit;
        if self.parallel { [width, 0.0] } else { [0.0, width] }
    }

    /// The position of a pixel's center relative to the picture's middle: to the right, and upward.
    /// The unit is half a pixel.
    #[inline]
    fn offset(&self, i: usize, j: usize) -> [f64; 2] {
        let (i, j) = self.place(i, j);
        // All numbers are integers until the conversion to `f64`.
        let [across, upward] = self.first;
        [(across + 2 * i as i64) as f64, (upward - 2 * j as i64) as f64]
    }

    /// The column and row of pixel (`i`, `j`) in the picture or part. In a grid of patches, `j` is
    /// the patch and `i` the pixel in the patch. The pixel may lie outside the picture.
    #[inline]
    fn place(&self, i: usize, j: usize) -> (usize, usize) {
        match self.patch(j) {
            Some(patch) => (patch.column + i % SIDE, patch.row + i / SIDE),
            None => (i, j),
        }
    }

    /// Four rays within a pixel: a third of its width to the left and right of the center, below
    /// and above it.
    pub fn rays_within(&self, index: usize) -> [Ray; 4] {
        let [across, upward] = self.offset(index % self.width, index / self.width);
        let third = 2.0 / 3.0;
        [[-third, 0.0], [third, 0.0], [0.0, -third], [0.0, third]]
            .map(|[x, y]| self.through([across + x, upward + y]))
    }

    /// The ray of the pixel with this index, counted row by row from the top.
    pub fn ray_of(&self, index: usize) -> Ray {
        self.ray(index % self.width, index / self.width)
    }

    /// The points at `distances` from the rays' origins, in world units: one for each pixel, row by
    /// row from the top. NaN where a distance is infinite.
    pub fn drawn_points(&self, distances: &[f64]) -> impl Iterator<Item = [f64; 3]> {
        let point = move |(pixel, distance): (usize, &f64)| {
            let ray = self.ray_of(pixel);
            let is_drawn = distance.is_finite();
            if is_drawn { ray.at(ray.parameter(*distance)).into() } else { [f64::NAN; 3] }
        };
        distances.iter().enumerate().map(point)
    }

    /// Columns and rows of a window's pixels in the picture, relative to the window's first pixel.
    #[inline(always)]
    fn places(&self, window: PixelWindow) -> [Lanes<f32>; 2] {
        if self.is_patched() {
            places_in_patch(window.column)
        } else {
            [ALONG, Lanes([0.0; LANES])]
        }
    }

    /// The points on the rays of a window at `distances` in world units. They equal
    /// `ray.at(ray.parameter(distance))`, bit for bit.
    #[inline(always)]
    pub fn points<S: Simd>(
        &self,
        simd: S,
        window: PixelWindow,
        distances: &[f64; LANES],
    ) -> [Lanes<f64>; 3] {
        let Basis { forward, right, up } = self.axes;
        let [first, upward] = self.offset(window.column, window.row);
        let [columns, rows] = self.places(window);
        let (columns, rows) = (f32::wide(simd, &columns), f32::wide(simd, &rows));
        let zero = f64x8::splat(simd, 0.0);
        let mut points = [Lanes::splat(0.0); 3];
        for (k, distances) in distances.as_chunks::<8>().0.iter().enumerate() {
            // All numbers are integers until they are multiplied by the unit.
            let across = (first + 2.0 * columns[k]) * self.unit;
            let rise = (upward - 2.0 * rows[k]) * self.unit;
            let (mut origin, mut way) = ([zero; 3], [zero; 3]);
            for axis in 0..3 {
                let offset = across * right[axis] + rise * up[axis];
                let (eye, forward) = (self.eye[axis], forward[axis]);
                if self.parallel {
                    (origin[axis], way[axis]) = (eye + offset, f64x8::splat(simd, forward));
                } else {
                    (origin[axis], way[axis]) = (f64x8::splat(simd, eye), forward + offset);
                }
            }
            let length = (way[0] * way[0] + way[1] * way[1] + way[2] * way[2]).sqrt();
            let t = f64x8::simd_from(simd, *distances) / length;
            for axis in 0..3 {
                let point = origin[axis] + way[axis] * t;
                point.store_slice(&mut points[axis][8 * k..8 * k + 8]);
            }
        }
        points
    }

    /// The directions of a window's rays as displayed. Their error, a few ulps of `f32`, does not
    /// matter for colors.
    #[inline(always)]
    pub fn ways<S: Simd>(&self, simd: S, window: PixelWindow) -> RayDirections<S> {
        let [forward, right, up] = self.steps;
        // The offsets are in halves of a pixel. They are integers, so a part of a picture has the
        // same directions as the whole.
        let [across, upward] = self.offset(window.column, window.row).map(|offset| offset as f32);
        let [columns, rows] = self.places(window);
        let column = across + 2.0 * f32x16::from_slice(simd, &columns[..]);
        let mut row = f32x16::splat(simd, upward);
        if self.is_patched() {
            row -= 2.0 * f32x16::from_slice(simd, &rows[..]);
        }
        let (mut aside, mut to_eye) = ([row; 3], [row; 3]);
        for axis in 0..3 {
            aside[axis] = column.mul_add(right[axis], row * up[axis]);
            to_eye[axis] = f32x16::splat(simd, -forward[axis]);
        }
        if !self.parallel {
            let [x, y, z] = aside;
            let square = z.mul_add(z, y.mul_add(y, x * x));
            let length = (1.0 + square).sqrt();
            let both = 1.0 / (length * (1.0 + length));
            let scale = both * (1.0 + length);
            // This is 1 − 1/length without cancellation, so its relative error is small.
            let less = both * square;
            for axis in 0..3 {
                aside[axis] = aside[axis].mul_sub(scale, forward[axis] * less);
                to_eye[axis] -= aside[axis];
            }
        }
        RayDirections { to_eye, aside }
    }

    /// The points on the rays of a window at `distances` in world units, if space is not stretched.
    /// The error is a few ulps of `f32`, relative to a point's coordinates or to its distance from
    /// the picture's middle ray. That is far less than a pixel.
    #[inline(always)]
    pub fn points_along<S: Simd>(
        &self,
        simd: S,
        ways: &RayDirections<S>,
        distances: &[f64; LANES],
    ) -> [Lanes<f32>; 3] {
        let low = f64x8::from_slice(simd, &distances[..8]);
        let high = f64x8::from_slice(simd, &distances[8..]);
        // In an orthographic picture, rays are equally far apart everywhere.
        let reach = if self.parallel { f32x16::splat(simd, 1.0) } else { low.narrow(high) };
        let mut points = [Lanes::splat(0.0); 3];
        for (axis, points) in points.iter_mut().enumerate() {
            let (eye, forward) = (self.eye[axis], self.basis.forward[axis]);
            // This is computed in `f64`, since the terms nearly cancel if the eye is far away.
            let middle = low.mul_add(forward, eye).narrow(high.mul_add(forward, eye));
            let point = ways.aside[axis].mul_add(reach, middle);
            point.store_slice(&mut points[..]);
        }
        points
    }
}

/// Directions of the rays of a window.
#[derive(Clone, Copy)]
pub struct RayDirections<S: Simd> {
    /// Unit vectors from the visible points to the eye.
    pub to_eye: [f32x16<S>; 3],
    /// Offset of each ray's point from the point of the picture's middle ray at the same distance.
    /// A share of that distance; in world units if rays are parallel.
    aside: [f32x16<S>; 3],
}

/// [`RayGrid::steps`] of a grid whose pixels are 2·`unit` apart.
fn steps(basis: &Basis, unit: f64) -> [Vec3; 3] {
    [basis.forward, unit * basis.right, unit * basis.up].map(|way| way.as_vec3())
}

/// Columns and rows of a window's pixels relative to the window's first pixel, which is pixel
/// `first` of a patch. Not inlined, so that windows outside patches do not compute it.
#[inline(never)]
fn places_in_patch(first: usize) -> [Lanes<f32>; 2] {
    let place = |pixel: usize| [(pixel % SIDE) as f32, (pixel / SIDE) as f32];
    let [column, row] = place(first);
    let [mut columns, mut rows] = [Lanes([0.0; LANES]); 2];
    for lane in 0..LANES {
        let [across, down] = place(first + lane);
        (columns[lane], rows[lane]) = (across - column, down - row);
    }
    [columns, rows]
}

/// The columns of sixteen adjacent pixels: 0 to 15.
const ALONG: Lanes<f32> = {
    let mut along = [0.0; LANES];
    let mut lane = 1;
    while lane < LANES {
        along[lane] = along[lane - 1] + 1.0;
        lane += 1;
    }
    Lanes(along)
};

/// The tangent of half an angle in degrees. Above 90°, it is computed from 180° minus the angle.
/// That difference is exact.
fn half_tangent(degrees: f64) -> f64 {
    let half = |degrees: f64| (degrees.to_radians() / 2.0).tan();
    if degrees <= 90.0 { half(degrees) } else { half(180.0 - degrees).recip() }
}

#[cfg(test)]
mod tests;
