//! A turntable camera for dragging and zooming. Lengths are in half extents of the region, so that
//! the view adapts when a surface grows. Angles are in radians. Knows no mouse, only pixels.

use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use zeroset_space::{Camera, CameraError, Projection, Region};

/// A camera that turns around its target, about an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Axis of the turntable, of length 1.
    pole: DVec3,
    azimuth: f64,
    elevation: f64,
    /// Distance from the target to the eye.
    distance: f64,
    /// The target, relative to the region's center.
    target: DVec3,
    /// Projection. The height of a parallel projection is in half extents of the region.
    projection: Projection,
}

/// Smallest and largest distance between target and eye, in half extents.
const NEAREST: f64 = 1e-4;
const FARTHEST: f64 = 1e3;

/// Largest share of the picture that the region's box fills when it is fitted.
const FILLED: f64 = 0.88;

/// Angle of the turn by a drag across the picture's whole height.
const TURN: f64 = PI;

impl Orbit {
    /// The orbit of `camera`. It turns in the displayed space.
    pub fn from_camera(camera: &Camera, region: &Region) -> Self {
        let (camera, region) = (camera.displayed(), region.displayed());
        let scale = region.half_extent();
        let back = camera.eye() - camera.target();
        let basis = camera.basis();
        // Use z as the pole if that keeps the horizon level, or else the camera's own up direction.
        let level = basis.right.z.abs() < 1e-9;
        let pole = match level {
            true if basis.up.z < -1e-9 => DVec3::NEG_Z,
            true => DVec3::Z,
            false => camera.up().normalize(),
        };
        let elevation = basis.forward.dot(-pole).clamp(-1.0, 1.0).asin();
        // If the camera looks straight up or down, the azimuth follows from its up direction.
        let lying = if back.cross(pole).length() < 1e-9 * back.length() {
            basis.up * -elevation.signum()
        } else {
            back
        };
        let (a, b) = axes(pole);
        let mut projection = camera.projection();
        if let Projection::Orthographic { height } = &mut projection {
            *height /= scale;
        }
        Self {
            pole,
            azimuth: lying.dot(b).atan2(lying.dot(a)),
            elevation,
            distance: back.length() / scale,
            target: (camera.target() - region.centre()) / scale,
            projection,
        }
    }

    /// The camera in world units.
    ///
    /// # Errors
    /// If the region is so large or small that the camera's numbers overflow.
    pub fn camera(&self, region: &Region) -> Result<Camera, CameraError> {
        let (stretch, region) = (region.stretch(), region.displayed());
        let scale = region.half_extent();
        let (back, _, up) = self.directions();
        let target = region.centre() + self.target * scale;
        let mut projection = self.projection;
        if let Projection::Orthographic { height } = &mut projection {
            *height *= scale;
        }
        let camera = Camera::new(target + back * self.distance * scale, target, up, projection)?;
        Ok(camera.in_stretched(stretch))
    }

    /// Three unit vectors: toward the eye, to the right in the picture, and up in the picture.
    fn directions(&self) -> (DVec3, DVec3, DVec3) {
        let (a, b) = axes(self.pole);
        let (sine, cosine) = self.azimuth.sin_cos();
        let (level, right) = (a * cosine + b * sine, b * cosine - a * sine);
        let (rise, run) = self.elevation.sin_cos();
        (level * run + self.pole * rise, right, self.pole * run - level * rise)
    }

    /// Length of a pixel's side in the plane through the target, in half extents of the region. The
    /// picture has `height` rows.
    fn unit(&self, height: usize) -> f64 {
        let visible = match self.projection {
            Projection::Orthographic { height } => height,
            Projection::Perspective { fov } => 2.0 * self.distance * (fov.to_radians() / 2.0).tan(),
        };
        visible / height.max(1) as f64
    }

    /// Turns by a drag of this many pixels to the right and downward, in a picture of this height.
    pub fn turn(&mut self, across: f64, down: f64, height: usize) {
        let angle = TURN / height.max(1) as f64;
        self.azimuth = (self.azimuth - across * angle).rem_euclid(2.0 * PI);
        self.elevation = (self.elevation + down * angle).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Pans by a drag of this many pixels. Points at the target's distance follow the pointer.
    pub fn pan(&mut self, across: f64, down: f64, height: usize) {
        let (_, right, up) = self.directions();
        self.target += (up * down - right * across) * self.unit(height);
    }

    /// Zooms so that sizes in the picture are divided by `factor`. The point this many pixels to
    /// the right of and below the picture's middle stays in place.
    pub fn zoom(&mut self, factor: f64, across: f64, down: f64, height: usize) {
        let factor = (self.distance * factor).clamp(NEAREST, FARTHEST) / self.distance;
        let (_, right, up) = self.directions();
        self.target += (right * across - up * down) * self.unit(height) * (1.0 - factor);
        self.distance *= factor;
        if let Projection::Orthographic { height } = &mut self.projection {
            *height *= factor;
        }
    }

    /// Fits the box of `shown` into a picture of this size in pixels, with space for labels. The
    /// direction of the view stays. The orbit's lengths are in half extents of `region`.
    pub fn fit(&mut self, shown: &Region, region: &Region, width: usize, height: usize) {
        let (shown, region) = (shown.displayed(), region.displayed());
        let scale = region.half_extent();
        self.target = (shown.centre() - region.centre()) / scale;
        let (back, right, up) = self.directions();
        let aspect = width.max(1) as f64 / height.max(1) as f64;
        let half = (shown.high() - shown.low()) / (2.0 * scale);
        // Two distances for each corner: from the picture's middle, in half heights of the picture,
        // and from the target toward the eye.
        let corners = (0..8).map(|n: i32| {
            let side = |axis: usize| if n >> axis & 1 == 1 { half[axis] } else { -half[axis] };
            let corner = DVec3::new(side(0), side(1), side(2));
            let reach = (corner.dot(right).abs() / aspect).max(corner.dot(up).abs()) / FILLED;
            (reach, corner.dot(back))
        });
        match &mut self.projection {
            Projection::Perspective { fov } => {
                let slope = (fov.to_radians() / 2.0).tan();
                let distance = corners.map(|(reach, near)| reach / slope + near);
                self.distance = distance.fold(NEAREST, f64::max).min(FARTHEST);
            }
            Projection::Orthographic { height } => {
                *height = corners.map(|(reach, _)| 2.0 * reach).fold(NEAREST, f64::max);
            }
        }
    }

    /// Switches between perspective and parallel projection. Objects at the target's distance keep
    /// their size in the picture.
    pub fn toggle_projection(&mut self) {
        let visible = self.unit(1);
        self.projection = match self.projection {
            Projection::Perspective { .. } => Projection::Orthographic { height: visible },
            Projection::Orthographic { .. } => {
                let fov = zeroset_style::FOV;
                self.distance = visible / 2.0 / (fov.to_radians() / 2.0).tan();
                Projection::Perspective { fov }
            }
        };
    }
}

/// Two unit vectors perpendicular to the pole: x and y if the pole is z.
fn axes(pole: DVec3) -> (DVec3, DVec3) {
    let a = if pole.z.abs() > 0.9 { DVec3::X } else { DVec3::Z.cross(pole).normalize() };
    let a = (a - pole * a.dot(pole)).normalize();
    (a, pole.cross(a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_scene::camera::{CameraChoice, camera};
    use zeroset_style::{StandardView, VIEWS};
    use zeroset_trace::RayGrid;

    const PERSPECTIVE: Projection = Projection::Perspective { fov: 40.0 };

    fn region() -> Region {
        Region::new(DVec3::new(-1.0, 0.0, 2.0), DVec3::new(3.0, 1.0, 5.0)).expect("valid")
    }

    fn standard(
        view: &'static StandardView,
        region: &Region,
        projection: Projection,
    ) -> Result<Camera, CameraError> {
        let (view, projection) = (Some(view), Some(projection));
        camera(&CameraChoice { view, projection, ..CameraChoice::default() }, region)
    }

    fn same(one: &Camera, other: &Camera) {
        let (a, b) = (RayGrid::new(one, 9, 7), RayGrid::new(other, 9, 7));
        for (p, q) in [(a.eye(), b.eye()), (a.right(), b.right()), (a.up(), b.up())] {
            assert!((p - q).length() < 1e-9, "{one:?} and {other:?}");
        }
    }

    #[test]
    fn every_camera_lies_on_its_own_orbit() {
        let region = region();
        for view in &VIEWS {
            for projection in [PERSPECTIVE, Projection::Orthographic { height: 3.0 }] {
                let camera = standard(view, &region, projection).expect("valid");
                let orbit = Orbit::from_camera(&camera, &region);
                let again = orbit.camera(&region).expect("valid");
                same(&camera, &again);
                assert_eq!(
                    matches!(again.projection(), Projection::Perspective { .. }),
                    matches!(projection, Projection::Perspective { .. })
                );
            }
        }
        for up in [DVec3::Y, DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Z, DVec3::X] {
            let eye = DVec3::new(4.0, 3.0, 6.0);
            let camera = Camera::new(eye, DVec3::ONE, up, PERSPECTIVE).expect("valid");
            same(&camera, &Orbit::from_camera(&camera, &region).camera(&region).expect("valid"));
        }
    }

    #[test]
    fn a_drag_turns_about_z_and_stops_at_the_poles() {
        let region = region();
        let start = standard(&VIEWS[0], &region, PERSPECTIVE).expect("valid");
        let mut orbit = Orbit::from_camera(&start, &region);
        orbit.turn(100.0, 0.0, 400);
        let turned = orbit.camera(&region).expect("valid");
        assert!((turned.eye().z - start.eye().z).abs() < 1e-9);
        assert!((turned.eye() - start.eye()).length() > 1.0);
        // The near side follows the pointer to the right, so the eye moves to the left.
        assert!((turned.eye() - start.eye()).dot(start.basis().right) < 0.0);
        orbit.turn(0.0, 1e6, 400);
        let top = orbit.camera(&region).expect("straight down is a view");
        assert!(top.basis().forward.z < -0.999_999);
    }

    /// Position of a point in pixels, to the right of and below the picture's middle.
    fn pixel(camera: &Camera, point: DVec3, height: f64) -> (f64, f64) {
        let basis = camera.basis();
        let way = point - camera.eye();
        let half = match camera.projection() {
            Projection::Perspective { fov } => {
                way.dot(basis.forward) * (fov.to_radians() / 2.0).tan()
            }
            Projection::Orthographic { height } => height / 2.0,
        };
        let scale = height / 2.0 / half;
        (way.dot(basis.right) * scale, -way.dot(basis.up) * scale)
    }

    #[test]
    fn zoom_keeps_what_is_under_the_pointer_and_pan_moves_it_along() {
        let region = region();
        for projection in [PERSPECTIVE, Projection::Orthographic { height: 5.0 }] {
            let camera = standard(&VIEWS[0], &region, projection).expect("valid");
            let basis = camera.basis();
            let point = camera.target() + 0.4 * basis.right - 0.3 * basis.up;
            let at = pixel(&camera, point, 480.0);
            let mut orbit = Orbit::from_camera(&camera, &region);
            orbit.zoom(0.7, at.0, at.1, 480);
            let zoomed = orbit.camera(&region).expect("valid");
            let after = pixel(&zoomed, point, 480.0);
            assert!((after.0 - at.0).abs() + (after.1 - at.1).abs() < 1e-6);
            orbit.pan(30.0, -20.0, 480);
            let moved = pixel(&orbit.camera(&region).expect("valid"), point, 480.0);
            assert!((moved.0 - at.0 - 30.0).abs() + (moved.1 - at.1 + 20.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_whole_box_fits_and_fills_the_picture() {
        let region = region();
        for view in &VIEWS {
            for projection in [PERSPECTIVE, Projection::Orthographic { height: 0.3 }] {
                for (width, height) in [(800, 600), (300, 200), (100, 400)] {
                    let camera = standard(view, &region, projection).expect("valid");
                    let mut orbit = Orbit::from_camera(&camera, &region);
                    orbit.pan(77.0, -50.0, height);
                    orbit.fit(&region, &region, width, height);
                    let camera = orbit.camera(&region).expect("valid");
                    let corners = (0..8).map(|n: i32| {
                        let low = [n & 1, n >> 1 & 1, n >> 2 & 1].map(|bit| bit == 0);
                        let at = |k: usize| if low[k] { region.low()[k] } else { region.high()[k] };
                        pixel(&camera, DVec3::new(at(0), at(1), at(2)), height as f64)
                    });
                    let share = |(x, y): (f64, f64)| {
                        (2.0 * x.abs() / width as f64).max(2.0 * y.abs() / height as f64)
                    };
                    let most = corners.map(share).fold(0.0, f64::max);
                    assert!((most - FILLED).abs() < 1e-9, "{view:?} {projection:?}: {most}");
                }
            }
        }
    }

    #[test]
    fn projections_change_without_a_jump() {
        let region = region();
        let camera = standard(&VIEWS[0], &region, PERSPECTIVE).expect("valid");
        let point = camera.target() + 0.5 * camera.basis().right;
        let mut orbit = Orbit::from_camera(&camera, &region);
        let before = pixel(&camera, point, 480.0).0;
        for _ in 0..2 {
            orbit.toggle_projection();
            let after = pixel(&orbit.camera(&region).expect("valid"), point, 480.0).0;
            assert!((before - after).abs() < 1e-6);
        }
    }
}
