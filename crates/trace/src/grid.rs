//! The grid of rays of one picture: a camera together with a size in pixels.

use crate::camera::{Basis, Camera, Projection};
use crate::painted::Window;
use crate::scalar::Scalar;
use fearless_simd::{f32x16, f64x8, prelude::*};
use glam::{DVec3, Vec3};
use std::ops::Range;
use std::sync::Arc;
use zeroset_eval::{LANES, Lanes};
use zeroset_space::Ray;

/// Pixels on the side of a [`Patch`].
pub const SIDE: usize = LANES.isqrt();

/// A square of 4×4 pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// The first column.
    pub column: usize,
    /// The first row.
    pub row: usize,
    /// What lies before the first or behind the second of these values of t is not looked for, if a
    /// method can tell.
    pub between: [f64; 2],
}

/// The rays of a picture, one through each pixel's centre; or of [patches](Self::patches) of it.
#[derive(Clone, Debug)]
pub struct RayGrid {
    width: usize,
    height: usize,
    /// Where the centre of the first pixel is, to the right of the picture's middle and above it,
    /// in halves of a pixel.
    first: [i64; 2],
    /// Columns and rows of the picture before this part of it.
    pub corner: [usize; 2],
    /// What no screen coordinate exceeds: half the width and height of the whole picture that this
    /// is a part of, so that parts are traced as the whole is.
    pub reach: [f64; 2],
    eye: DVec3,
    basis: Basis,
    /// In `f32`, since that is asked for at every window: the direction of view, and what a ray's
    /// direction changes by where it moves by half a pixel to the right, or upward; or its origin,
    /// if parallel.
    steps: [Vec3; 3],
    /// Half a pixel's height, which is half the distance of neighbouring pixels' screen
    /// coordinates: on the plane at distance 1, or in world units if parallel.
    pub unit: f64,
    /// Whether the picture is orthographic.
    pub parallel: bool,
    patches: Option<Arc<[Patch]>>,
}

impl Camera {
    /// The rays of a picture of `width` × `height` pixels.
    pub fn rays(&self, width: usize, height: usize) -> RayGrid {
        let (scale, parallel) = match self.projection() {
            Projection::Perspective { fov } => (half_tangent(fov), false),
            Projection::Orthographic { height } => (height / 2.0, true),
        };
        let unit = scale / height as f64;
        let (eye, basis) = (self.eye(), self.basis);
        let reach = [width as f64 * unit, height as f64 * unit];
        let (first, patches) = ([1 - width as i64, height as i64 - 1], None);
        let (corner, steps) = ([0; 2], steps(&basis, unit));
        RayGrid { width, height, first, corner, reach, eye, basis, steps, unit, parallel, patches }
    }
}

impl RayGrid {
    /// The rays of some columns and rows of the picture, counted from its left edge and its top:
    /// those of `self`, bit for bit.
    ///
    /// # Panics
    /// If they are not in the picture.
    #[must_use]
    pub fn part(&self, columns: Range<usize>, rows: Range<usize>) -> Self {
        assert!(columns.end <= self.width && rows.end <= self.height, "outside of the picture");
        let [across, upward] = self.first;
        let first = [across + 2 * columns.start as i64, upward - 2 * rows.start as i64];
        let corner = [self.corner[0] + columns.start, self.corner[1] + rows.start];
        Self { width: columns.len(), height: rows.len(), first, corner, ..self.clone() }
    }

    /// The rays of the same picture, or part of one, with each pixel cut into `times` columns and
    /// rows.
    #[must_use]
    pub fn finer(&self, times: usize) -> Self {
        let (width, height) = (self.width * times, self.height * times);
        let unit = self.unit / times as f64;
        let [across, upward] = self.first;
        let first = [(across - 1) * times as i64 + 1, (upward + 1) * times as i64 - 1];
        let (corner, steps) = (self.corner.map(|place| place * times), steps(&self.basis, unit));
        Self { width, height, first, corner, steps, unit, ..self.clone() }
    }

    /// The rays of some patches of the picture, one in each row: its sixteen pixels row by row.
    /// What is found for them may be drawn, but is no claim, since it is looked for only within
    /// [`Patch::between`].
    #[must_use]
    pub fn patches(&self, patches: Arc<[Patch]>) -> Self {
        Self { width: LANES, height: patches.len(), patches: Some(patches), ..self.clone() }
    }

    /// The patch in this row, if these are the rays of patches.
    #[inline]
    pub fn patch(&self, row: usize) -> Option<Patch> {
        self.patches.as_ref().map(|patches| patches[row])
    }

    /// Whether these are the rays of patches.
    #[inline]
    pub fn is_patched(&self) -> bool {
        self.patches.is_some()
    }

    /// The pixels left of one, right of it, above and below it, by their indices, as far as there
    /// are any.
    pub fn beside(&self, pixel: usize) -> [Option<usize>; 4] {
        let width = if self.is_patched() { SIDE } else { self.width };
        let (column, rows) = (pixel % width, self.width * self.height / width);
        let mut row = pixel / width;
        let mut last = rows - 1;
        if self.is_patched() {
            // Patches are no neighbours.
            (row, last) = (row % SIDE, SIDE - 1);
        }
        [
            (column > 0).then(|| pixel - 1),
            (column + 1 < width).then_some(pixel + 1),
            (row > 0).then(|| pixel - width),
            (row < last).then_some(pixel + width),
        ]
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
        self.basis.forward
    }

    /// The direction of the picture's right edge, of length 1.
    pub fn right(&self) -> DVec3 {
        self.basis.right
    }

    /// The direction of the picture's upper edge, of length 1.
    pub fn up(&self) -> DVec3 {
        self.basis.up
    }

    /// The ray through the centre of the pixel in column `i` and row `j`; row 0 is on top.
    ///
    /// Its direction is `forward + (2(i+½)/width − 1)·s·(width/height)·right + (1 −
    /// 2(j+½)/height)·s·up`, where `s` is the tangent of half the vertical field of view. In an
    /// orthographic picture the direction is `forward`, and the same two offsets, with `s` half the
    /// height, move the origin. How exact that is: [`Camera`].
    #[inline]
    pub fn ray(&self, i: usize, j: usize) -> Ray {
        let [across, upward] = self.offset(i, j).map(|offset| offset * self.unit);
        let Basis { forward, right, up } = self.basis;
        let offset = across * right + upward * up;
        if self.parallel {
            Ray { origin: self.eye + offset, direction: forward }
        } else {
            Ray { origin: self.eye, direction: forward + offset }
        }
    }

    /// Screen coordinates of the point half way between the centres of two pixels, by the sum of
    /// their columns and the sum of their rows, in the picture that there may be patches of: a
    /// ray's direction is `forward` + a·`right` + b·`up`, or in an orthographic picture its origin
    /// is moved so.
    #[inline]
    pub fn screen(&self, columns: usize, rows: usize) -> [f64; 2] {
        let [across, upward] = self.first;
        [across + columns as i64, upward - rows as i64].map(|place| place as f64 * self.unit)
    }

    /// [Screen coordinates](Self::screen) of four points along an axis, by the sum of two columns,
    /// or of two rows, and by what that grows from one to the next.
    #[inline(always)]
    pub fn screens(&self, axis: usize, sum: usize, step: usize) -> [f64; 4] {
        let [across, upward] = self.first;
        // Integers until the last step.
        let (first, step) = if axis == 0 {
            (across + sum as i64, step as f64)
        } else {
            (upward - sum as i64, -(step as f64))
        };
        [0.0, 1.0, 2.0, 3.0].map(|k| (first as f64 + k * step) * self.unit)
    }

    /// About how wide a pixel is at a distance from the eye, in the unit of that distance: of t, or
    /// of the world.
    pub fn footprint(&self, distance: f64) -> f64 {
        let [at_eye, growth] = self.pixel();
        at_eye + growth * distance
    }

    /// About how wide a pixel is where a ray's t is 0, and how much that grows with t, in units of
    /// t.
    pub fn pixel(&self) -> [f64; 2] {
        let width = 2.0 * self.unit;
        if self.parallel { [width, 0.0] } else { [0.0, width] }
    }

    /// Where a pixel is, to the right of the picture's middle and above it, in halves of a pixel.
    #[inline]
    fn offset(&self, i: usize, j: usize) -> [f64; 2] {
        let (i, j) = self.place(i, j);
        // Integers until the last step.
        let [across, upward] = self.first;
        [(across + 2 * i as i64) as f64, (upward - 2 * j as i64) as f64]
    }

    /// The column and the row of a pixel in the picture that there may be patches of. A window may
    /// stick out.
    #[inline]
    fn place(&self, i: usize, j: usize) -> (usize, usize) {
        match self.patch(j) {
            Some(patch) => (patch.column + i % SIDE, patch.row + i / SIDE),
            None => (i, j),
        }
    }

    /// The ray of the pixel with this index, counted row by row from the top.
    pub fn ray_of(&self, index: usize) -> Ray {
        self.ray(index % self.width, index / self.width)
    }

    /// Columns and rows of a window's pixels, from those of its first, in the picture that there
    /// may be patches of.
    #[inline(always)]
    fn places(&self, window: Window) -> [Lanes<f32>; 2] {
        if self.is_patched() {
            places_in_patch(window.column)
        } else {
            [ALONG, Lanes([0.0; LANES])]
        }
    }

    /// The points at these distances in world units on the rays of a window:
    /// `ray.at(ray.parameter(distance))`, bit for bit.
    #[inline(always)]
    pub fn points<S: Simd>(
        &self,
        simd: S,
        window: Window,
        distances: &[f64; LANES],
    ) -> [Lanes<f64>; 3] {
        let Basis { forward, right, up } = self.basis;
        let [first, upward] = self.offset(window.column, window.row);
        let [columns, rows] = self.places(window);
        let (columns, rows) = (f32::wide(simd, &columns), f32::wide(simd, &rows));
        let zero = f64x8::splat(simd, 0.0);
        let mut points = [Lanes::splat(0.0); 3];
        for (k, distances) in distances.as_chunks::<8>().0.iter().enumerate() {
            // Integers until the last step.
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

    /// Which way the rays of a window go, to some units in the last place of `f32`, which is enough
    /// for colors.
    #[inline(always)]
    pub fn ways<S: Simd>(&self, simd: S, window: Window) -> Ways<S> {
        let [forward, right, up] = self.steps;
        // In halves of a pixel: integers, so that a part of a picture has the same ways as the
        // whole.
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
            // 1 − 1/length without cancellation, so that its error is relative, too.
            let less = both * square;
            for axis in 0..3 {
                aside[axis] = aside[axis].mul_sub(scale, forward[axis] * less);
                to_eye[axis] -= aside[axis];
            }
        }
        Ways { to_eye, aside }
    }

    /// The points at these distances in world units on the rays of a window which go these ways.
    /// They are off by some units in the last place of `f32`, of a point's coordinates or of how
    /// far it is from the ray through the picture's middle: by far less than a pixel.
    #[inline(always)]
    pub fn points_along<S: Simd>(
        &self,
        simd: S,
        ways: &Ways<S>,
        distances: &[f64; LANES],
    ) -> [Lanes<f32>; 3] {
        let low = f64x8::from_slice(simd, &distances[..8]);
        let high = f64x8::from_slice(simd, &distances[8..]);
        // A parallel picture's rays are as far apart anywhere.
        let reach = if self.parallel { f32x16::splat(simd, 1.0) } else { low.narrow(high) };
        let mut points = [Lanes::splat(0.0); 3];
        for (axis, points) in points.iter_mut().enumerate() {
            let (eye, forward) = (self.eye[axis], self.basis.forward[axis]);
            // From a far eye it is a small difference.
            let middle = low.mul_add(forward, eye).narrow(high.mul_add(forward, eye));
            let point = ways.aside[axis].mul_add(reach, middle);
            point.store_slice(&mut points[..]);
        }
        points
    }
}

/// Which way the rays of a window go.
#[derive(Clone, Copy)]
pub struct Ways<S: Simd> {
    /// The unit vectors from what is seen to where it is seen from.
    pub to_eye: [f32x16<S>; 3],
    /// How far a ray is from that through the middle of the whole picture: at the same distance
    /// from the eye, as a share of that; or in world units, if rays are parallel.
    aside: [f32x16<S>; 3],
}

/// [`RayGrid::steps`] of a grid whose pixels are twice this `unit` apart.
fn steps(basis: &Basis, unit: f64) -> [Vec3; 3] {
    [basis.forward, unit * basis.right, unit * basis.up].map(|way| way.as_vec3())
}

/// Columns and rows of a window's pixels from this pixel of a patch on. Not in place: it would be
/// computed of others, too.
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

/// The columns of neighbouring pixels.
const ALONG: Lanes<f32> = {
    let mut along = [0.0; LANES];
    let mut lane = 1;
    while lane < LANES {
        along[lane] = along[lane - 1] + 1.0;
        lane += 1;
    }
    Lanes(along)
};

/// The tangent of half an angle in degrees. Near 180 it hangs on how much the angle lacks, which is
/// exact.
fn half_tangent(degrees: f64) -> f64 {
    let half = |degrees: f64| (degrees.to_radians() / 2.0).tan();
    if degrees <= 90.0 { half(degrees) } else { half(180.0 - degrees).recip() }
}

#[cfg(test)]
mod tests;
