//! The one light of a picture.

use crate::grid::RayGrid;
use crate::near::TURNS;
use glam::DVec3;
use zeroset_eval::{LANES, Lanes};

/// Where light comes from, beside the ambient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// From infinitely far away; the direction points at the light and has length 1.
    Directional(DVec3),
    /// From a point of space.
    Positional(DVec3),
}

/// The half width of a light, as a share of how far it is.
const WIDTH: f64 = 0.05;

impl Light {
    /// A distant light above and to the left of the camera, which moves with it.
    pub fn above_left(rays: &RayGrid) -> Self {
        // Some 50 degrees off the view and more above than beside it: in the default view of a
        // cube, its three visible faces then differ clearly, the top the brightest.
        let towards = -rays.forward() + 1.1 * rays.up() - 0.35 * rays.right();
        Self::Directional(towards.normalize())
    }

    /// The light as a disc rather than a point, by sixteen places on it: a 20th as wide to every side as it is far from
    /// `centre`. The sun is a tenth of that.
    pub fn widened(&self, centre: DVec3) -> [Self; TURNS] {
        let (way, distance) = self.towards(centre);
        let (across, upward) = way.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_pair();
        std::array::from_fn(|turn| {
            // Vogel's spiral: evenly over the disc. Turns that follow each other lie far apart.
            let place = (7 * turn % TURNS) as f64;
            let (radius, angle) = (((place + 0.5) / TURNS as f64).sqrt(), place * 2.399_963_23);
            let aside = WIDTH * radius * (angle.cos() * across + angle.sin() * upward);
            match self {
                Self::Directional(way) => Self::Directional((*way + aside).normalize()),
                Self::Positional(at) => Self::Positional(*at + distance * aside),
            }
        })
    }

    /// The way from `point` to the light: a unit vector and the distance, infinite for a distant
    /// light. At the light itself the vector is zero.
    pub fn towards(&self, point: DVec3) -> (DVec3, f64) {
        match self {
            Self::Directional(direction) => (*direction, f64::INFINITY),
            Self::Positional(at) => {
                let way = *at - point;
                (way.normalize_or_zero(), way.length())
            }
        }
    }

    /// The unit vectors from sixteen points to the light, zero at the light itself.
    pub(crate) fn all_towards(&self, points: impl FnOnce() -> [Lanes<f64>; 3]) -> [Lanes<f32>; 3] {
        let at = match self {
            Self::Directional(way) => return way.as_vec3().to_array().map(Lanes::splat),
            Self::Positional(at) => at,
        };
        let (points, mut ways) = (points(), [Lanes::splat(0.0); 3]);
        for lane in 0..LANES {
            let way = *at - DVec3::from_array([0, 1, 2].map(|axis| points[axis][lane]));
            // No branch: it would stand in the way of vectors.
            let scale = 1.0 / way.length_squared().max(f64::MIN_POSITIVE).sqrt();
            (0..3).for_each(|axis| ways[axis][lane] = (way[axis] * scale) as f32);
        }
        ways
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{Camera, Projection};

    #[test]
    fn the_default_light_stands_above_and_left_of_the_eye() {
        let eye = DVec3::new(0.0, -5.0, 0.0);
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("valid");
        let (direction, distance) = Light::above_left(&camera.rays(2, 2)).towards(DVec3::ZERO);
        assert!(direction.x < 0.0 && direction.y < 0.0 && direction.z > 0.0);
        assert!((direction.length() - 1.0).abs() < 1e-12 && distance == f64::INFINITY);
    }

    #[test]
    fn a_positional_light_is_approached() {
        let light = Light::Positional(DVec3::new(0.0, 0.0, 4.0));
        assert_eq!(light.towards(DVec3::Z), (DVec3::Z, 3.0));
        assert_eq!(light.towards(DVec3::new(0.0, 0.0, 4.0)), (DVec3::ZERO, 0.0));
    }
}
