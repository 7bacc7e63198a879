//! Cameras: the view from which a picture is taken.
//!
//! A camera knows nothing of surfaces, of pixels' contents, or of how rays are grouped.

use glam::DVec3;
use thiserror::Error;

/// The mapping from space to the picture's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays start at the eye and spread.
    Perspective {
        /// The angle of view from the picture's lowest to its highest edge, in degrees. At least
        /// 1e-7 and below 180.
        fov: f64,
    },
    /// Rays are parallel and start on the plane through the eye.
    Orthographic {
        /// The height of the picture in world units as displayed, from 1e-300 to 1e100.
        height: f64,
    },
}

/// A camera. The eye may lie anywhere, also inside the domain.
///
/// Rays differ from exact geometry only by rounding. Each direction is within 2⁻⁴⁹ radians of the
/// exact one: 2⁻²⁰ of the narrowest field of view. Perspective rays start exactly at the eye.
/// Between the eye's plane and the target's, a parallel ray is within 2⁻²⁰ of the picture's height
/// of the exact ray. [`Camera::new`] refuses a camera for which `f64` cannot achieve this. So all
/// rays of a picture with fewer than 10⁵ rows are different.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    target: DVec3,
    up: DVec3,
    projection: Projection,
    stretch: DVec3,
    basis: Basis,
}

/// The axes of a view, each of length 1 unless space is stretched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    /// The direction of view.
    pub forward: DVec3,
    /// The direction to the right in the picture.
    pub right: DVec3,
    /// The direction upward in the picture.
    pub up: DVec3,
}

/// Why a camera is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum CameraError {
    /// A coordinate is NaN, infinite or larger than 1e100.
    #[error("the {0} has a coordinate that is not a number within ±1e100")]
    NotFinite(&'static str),
    /// The eye and the target coincide, so there is no direction of view.
    #[error("the eye and the target are the same point, so there is no direction to look in")]
    EyeIsTarget,
    /// The up vector is zero or along the view, so the picture has no upper edge.
    #[error("the up vector is zero or points along the view, so the picture has no upper edge")]
    UpAlongView,
    /// The field of view is out of range, or so small that rays would coincide.
    #[error("the field of view is {0} degrees; it must be at least 1e-7 and below 180")]
    FieldOfView(f64),
    /// The orthographic height is out of range.
    #[error("the orthographic height is {0:?}; it must be from 1e-300 to 1e100")]
    Height(f64),
    /// The orthographic height is so small that rounding could move parallel rays onto each other.
    #[error(
        "the orthographic height is {height:?}, too little for an eye and a target this far away: 64-bit floats can \
         tell the rays apart from a height of about {least:.1e} on"
    )]
    RaysCoincide {
        /// The given height.
        height: f64,
        /// Approximately the least height that this eye and target allow.
        least: f64,
    },
}

/// Least sine of the angle between the view and `up`. At a smaller angle, `up` does not determine
/// the picture's upper edge well enough.
const LEAST_SINE: f64 = 1e-9;

/// Largest magnitude of a coordinate. Squares of larger coordinates could overflow.
const LARGEST: f64 = 1e100;

/// Least field of view, in degrees. In a narrower one, rows differ by less than rounding errors.
const LEAST_FOV: f64 = 1e-7;

/// Least orthographic height. At a smaller one, fractions of a pixel could be subnormal floats.
const LEAST_HEIGHT: f64 = 1e-300;

/// Largest distance by which rounding may move a parallel ray, as a share of the picture's height:
/// about a millionth.
const LARGEST_DRIFT: f64 = 1.0 / 1_048_576.0; // 2^-20

impl Camera {
    /// A camera at `eye` that looks at `target`. In the picture, `up` is as upright as the view
    /// allows.
    ///
    /// # Errors
    /// If a coordinate is not within ±1e100, or the projection's number is out of range. Also if
    /// eye and target coincide, `up` is zero or nearly along the view, or parallel rays would be
    /// too close together for `f64`.
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
        if eye == target {
            return Err(CameraError::EyeIsTarget);
        }
        let basis = Basis::new(eye, target, up).ok_or(CameraError::UpAlongView)?;
        match projection {
            Projection::Perspective { fov } if !(LEAST_FOV..180.0).contains(&fov) => {
                return Err(CameraError::FieldOfView(fov));
            }
            Projection::Orthographic { height } => {
                if !(LEAST_HEIGHT..=LARGEST).contains(&height) {
                    return Err(CameraError::Height(height));
                }
                let least = basis.drift(eye, target) / LARGEST_DRIFT;
                if height < least {
                    return Err(CameraError::RaysCoincide { height, least });
                }
            }
            Projection::Perspective { .. } => {}
        }
        Ok(Self { eye, target, up, projection, stretch: DVec3::ONE, basis })
    }

    /// The camera of a stretched space that takes the same picture as `self` takes of the displayed
    /// space. A point p of the stretched space is displayed at p·`stretch`, axis by axis.
    ///
    /// The factors must be powers of two, so that nothing is rounded unless it overflows.
    #[must_use]
    pub fn in_stretched(self, stretch: DVec3) -> Self {
        if stretch == DVec3::ONE {
            return self;
        }
        let up = (self.up / stretch).normalize_or(self.up);
        Self { eye: self.eye / stretch, target: self.target / stretch, up, stretch, ..self }
    }

    /// The camera of the displayed space that takes the same picture.
    #[must_use]
    pub fn displayed(&self) -> Self {
        let Self { stretch, .. } = *self;
        let up = self.up * stretch;
        let (eye, target) = (self.eye * stretch, self.target * stretch);
        Self { eye, target, up, stretch: DVec3::ONE, ..*self }
    }

    /// For each axis, the factor by which lengths are multiplied for display.
    pub fn stretch(&self) -> DVec3 {
        self.stretch
    }

    /// The position of the camera.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The point in the middle of the picture.
    pub fn target(&self) -> DVec3 {
        self.target
    }

    /// The direction that appears upright, as it was passed to [`Camera::new`].
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The mapping from space to the picture's plane.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// The axes of the view as displayed, each of length 1.
    pub fn basis(&self) -> Basis {
        self.basis
    }
}

impl Basis {
    /// Axes whose components are divided by these factors.
    #[must_use]
    pub fn divided(self, by: DVec3) -> Self {
        Self { forward: self.forward / by, right: self.right / by, up: self.up / by }
    }

    /// The axes of a view, each within a few ulps of the exact one. `None` if `up` is along the
    /// view.
    fn new(eye: DVec3, target: DVec3, up: DVec3) -> Option<Self> {
        // high + low is exactly target − eye. The axes depend only on the directions of the
        // vectors, so all vectors are first scaled to lengths of about 1.
        let low = DVec3::from_array([0, 1, 2].map(|axis| difference(target[axis], eye[axis]).1));
        let high = target - eye;
        let (scale, up) = (scale_to_one(high), up * scale_to_one(up));
        let (high, low) = (high * scale, low * scale);
        // This is (high + low) × up. The two products of a component nearly cancel if `up` is
        // almost along the view, so they are computed exactly. The sine is at least LEAST_SINE, so
        // the remaining rounding is below the last place of the result.
        let component = |i: usize, j: usize| {
            let (one, other) = (high[i] * up[j], high[j] * up[i]);
            let rests = high[i].mul_add(up[j], -one) - high[j].mul_add(up[i], -other);
            let (main, rest) = difference(one, other);
            main + (rest + (rests + (low[i] * up[j] - low[j] * up[i])))
        };
        let across = DVec3::new(component(1, 2), component(2, 0), component(0, 1));
        let sine = across.length() / (high.length() * up.length());
        // If `up` is zero, the sine is NaN.
        (sine >= LEAST_SINE).then(|| {
            let (forward, right) = (high.normalize(), across.normalize());
            Self { forward, right, up: right.cross(forward) }
        })
    }

    /// Bounds how far rounding moves a parallel ray aside between the eye's plane and the target's:
    /// by an ulp of its origin and two ulps of its direction. Moves along the ray do not count, so
    /// a view along an axis is exact from any distance.
    fn drift(&self, eye: DVec3, target: DVec3) -> f64 {
        let DVec3 { x, y, z } = self.forward;
        let aside = DVec3::new(y.hypot(z), z.hypot(x), x.hypot(y));
        (eye.abs() + 2.0 * (target - eye).abs()).dot(aside) * f64::EPSILON
    }
}

/// a − b as a rounded difference and its error. The sum of the two is exactly a − b (Knuth's
/// `TwoSum`), unless something overflows.
fn difference(a: f64, b: f64) -> (f64, f64) {
    let main = a - b;
    let taken = main - a;
    (main, (a - (main - taken)) - (b + taken))
}

/// The power of two that scales the vector's largest component to between ½ and 1. A subnormal
/// component is scaled to between 2⁻⁵² and 1.
fn scale_to_one(vector: DVec3) -> f64 {
    let exponent = vector.abs().max_element().to_bits() >> 52;
    f64::from_bits((2045 - exponent) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FOV_40: Projection = Projection::Perspective { fov: 40.0 };

    #[test]
    fn impossible_cameras_are_refused() {
        let new = |eye, up, projection| Camera::new(eye, DVec3::ZERO, up, projection);
        let eye = DVec3::new(0.0, 0.0, 3.0);
        assert_eq!(new(DVec3::ZERO, DVec3::Y, FOV_40), Err(CameraError::EyeIsTarget));
        assert_eq!(new(eye, DVec3::Z, FOV_40), Err(CameraError::UpAlongView));
        assert_eq!(new(eye, DVec3::ZERO, FOV_40), Err(CameraError::UpAlongView));
        assert_eq!(new(eye * f64::NAN, DVec3::Y, FOV_40), Err(CameraError::NotFinite("eye")));
        for fov in [0.0, -1.0, 9e-8, 180.0, f64::INFINITY] {
            let projection = Projection::Perspective { fov };
            assert_eq!(new(eye, DVec3::Y, projection), Err(CameraError::FieldOfView(fov)));
        }
        let nan = Projection::Perspective { fov: f64::NAN };
        assert!(matches!(new(eye, DVec3::Y, nan), Err(CameraError::FieldOfView(_))));
        for height in [0.0, -1.0, 1e-301, 2e100, f64::INFINITY] {
            let projection = Projection::Orthographic { height };
            assert_eq!(new(eye, DVec3::Y, projection), Err(CameraError::Height(height)));
        }
        let parallel = Projection::Orthographic { height: 3.0 };
        let refused = new(DVec3::splat(1e30), DVec3::Y, parallel);
        assert!(matches!(refused, Err(CameraError::RaysCoincide { height: 3.0, .. })));
        // In a view along an axis, rounding changes only the distance to the eye.
        assert!(new(DVec3::X * 4e38, DVec3::Y, parallel).is_ok());
    }
}
