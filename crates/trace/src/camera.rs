//! Where a picture is taken from, and the ray of each pixel.
//!
//! A camera knows nothing of the surface, of pixels' contents, or of how rays are grouped.

use crate::frame::Frame;
use glam::DVec3;
use thiserror::Error;

/// A half line from `origin` along `direction`, in world coordinates.
///
/// Both are exactly the `f64` numbers stored: a proof about a pixel is a proof about this line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where the ray starts: the eye, or a point of the eye's plane in an orthographic picture.
    pub origin: DVec3,
    /// Where it goes: of length 1 up to rounding.
    pub direction: DVec3,
}

impl Ray {
    /// The point at `distance` along the ray, rounded to nearest.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }
}

/// How points of space are mapped to the picture's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays start at the eye and spread.
    Perspective {
        /// The angle between the picture's lowest and highest edge, in degrees, within (0, 180).
        fov: f64,
    },
    /// Rays are parallel and start on the plane through the eye.
    Orthographic {
        /// The height of the picture in world units, above 0.
        height: f64,
    },
}

/// A point of view. The eye may lie anywhere, inside the domain too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    projection: Projection,
}

/// Why a camera cannot exist.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CameraError {
    /// A coordinate is NaN, infinite or too large.
    #[error("the {0} has a coordinate that is not a number within ±1e100")]
    NotFinite(&'static str),
    /// There is no direction of view.
    #[error("the eye and the target are the same point, so there is no direction to look in")]
    EyeIsTarget,
    /// There is no way to tell the picture's upper edge.
    #[error("the up vector is zero or points along the view, so the picture has no upper edge")]
    UpAlongView,
    /// The field of view leaves no picture.
    #[error("the field of view is {0} degrees; it must be above 0 and below 180")]
    FieldOfView(f64),
    /// The height leaves no picture.
    #[error("the orthographic height is {0}; it must be above 0 and finite")]
    Height(f64),
}

/// Below this sine between view and `up`, the picture's horizontal would be made of rounding errors.
const LEAST_SINE: f64 = 1e-9;

/// Coordinates beyond this magnitude leave no room for their squares.
const LARGEST: f64 = 1e100;

impl Camera {
    /// A camera at `eye` that looks at `target`, with `up` as near to upright as the view allows.
    ///
    /// # Errors
    /// If a coordinate is not within ±1e100, eye and target coincide, `up` does not determine a direction across the view,
    /// or the projection's parameter is out of range.
    pub fn new(
        eye: DVec3,
        target: DVec3,
        up: DVec3,
        projection: Projection,
    ) -> Result<Self, CameraError> {
        for (vector, name) in [(eye, "eye"), (target, "target"), (up, "up vector")] {
            if !vector.is_finite() || vector.abs().max_element() > LARGEST {
                return Err(CameraError::NotFinite(name));
            }
        }
        let forward = (target - eye).try_normalize().ok_or(CameraError::EyeIsTarget)?;
        let sine = up.try_normalize().map_or(0.0, |up| forward.cross(up).length());
        if sine < LEAST_SINE {
            return Err(CameraError::UpAlongView);
        }
        match projection {
            Projection::Perspective { fov } if !(fov > 0.0 && fov < 180.0) => {
                return Err(CameraError::FieldOfView(fov));
            }
            Projection::Orthographic { height } if !(height > 0.0 && height.is_finite()) => {
                return Err(CameraError::Height(height));
            }
            Projection::Perspective { .. } | Projection::Orthographic { .. } => {}
        }
        Ok(Self { eye, target, up, projection })
    }

    /// Where the picture is taken from.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The point in the middle of the picture.
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// The direction that appears upright, as given.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// How space is mapped to the picture.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// The rays of a picture of `width` × `height` pixels.
    pub fn frame(&self, width: usize, height: usize) -> Frame {
        Frame::new(self, width, height)
    }

    /// The ray through the centre of the pixel in column `i` and row `j`; row 0 is on top.
    ///
    /// With `forward` the direction of view, `right = forward × up` and `up' = right × forward`, all of length 1, its
    /// direction is `forward + (2(i+½)/width − 1)·s·(width/height)·right + (1 − 2(j+½)/height)·s·up'`, normalised, where
    /// `s` is the tangent of half the vertical field of view. In an orthographic picture the same two offsets, with `s`
    /// half the height, move the origin instead. A whole picture is better taken from [`Camera::frame`].
    pub fn ray(&self, i: usize, j: usize, width: usize, height: usize) -> Ray {
        self.frame(width, height).ray(i, j)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOV_40: Projection = Projection::Perspective { fov: 40.0 };

    fn camera(projection: Projection) -> Camera {
        Camera::new(DVec3::new(4.0, 3.0, 6.0), DVec3::ZERO, DVec3::Y, projection).expect("valid")
    }

    #[test]
    fn rays_follow_the_stated_formula() {
        // The formula spelt out once more in scalar arithmetic, for one pixel off every symmetry.
        let (i, j, width, height) = (5.0, 11.0, 64.0, 48.0);
        let norm = |v: [f64; 3]| {
            let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
            v.map(|c| c / length)
        };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let forward = norm([-4.0, -3.0, -6.0]);
        let right = norm(cross(forward, [0.0, 1.0, 0.0]));
        let up = cross(right, forward);
        let s = (20.0_f64).to_radians().tan();
        let a = (2.0 * (i + 0.5) / width - 1.0) * s * (width / height);
        let b = (1.0 - 2.0 * (j + 0.5) / height) * s;
        let expected = norm([0, 1, 2].map(|k| forward[k] + a * right[k] + b * up[k]));
        let ray = camera(FOV_40).ray(5, 11, 64, 48);
        assert!((ray.direction - DVec3::from(expected)).length() < 1e-15);
        assert_eq!(ray.origin, DVec3::new(4.0, 3.0, 6.0));
    }

    #[test]
    fn row_0_is_on_top_and_column_0_on_the_left() {
        let camera =
            Camera::new(DVec3::new(0.0, -5.0, 0.0), DVec3::ZERO, DVec3::Z, FOV_40).expect("valid");
        let corner = camera.ray(0, 0, 8, 8).direction;
        assert!(corner.x < 0.0 && corner.z > 0.0 && corner.y > 0.0);
    }

    #[test]
    fn orthographic_rays_are_parallel_and_span_the_height() {
        let camera = camera(Projection::Orthographic { height: 3.0 });
        let (top, bottom) = (camera.ray(2, 0, 4, 6), camera.ray(2, 5, 4, 6));
        assert_eq!(top.direction, bottom.direction);
        // Six rows of half a unit: the outer centres are 2.5 apart.
        assert!(((top.origin - bottom.origin).length() - 2.5).abs() < 1e-14);
    }

    #[test]
    fn impossible_cameras_are_refused() {
        let new = |eye, up, projection| Camera::new(eye, DVec3::ZERO, up, projection);
        let eye = DVec3::new(0.0, 0.0, 3.0);
        assert_eq!(new(DVec3::ZERO, DVec3::Y, FOV_40), Err(CameraError::EyeIsTarget));
        assert_eq!(new(eye, DVec3::Z, FOV_40), Err(CameraError::UpAlongView));
        assert_eq!(new(eye, DVec3::ZERO, FOV_40), Err(CameraError::UpAlongView));
        assert_eq!(new(eye * f64::NAN, DVec3::Y, FOV_40), Err(CameraError::NotFinite("eye")));
        for fov in [0.0, -1.0, 180.0, f64::INFINITY] {
            let projection = Projection::Perspective { fov };
            assert_eq!(new(eye, DVec3::Y, projection), Err(CameraError::FieldOfView(fov)));
        }
        let nan = Projection::Perspective { fov: f64::NAN };
        assert!(matches!(new(eye, DVec3::Y, nan), Err(CameraError::FieldOfView(_))));
        let flat = Projection::Orthographic { height: 0.0 };
        assert_eq!(new(eye, DVec3::Y, flat), Err(CameraError::Height(0.0)));
    }
}
