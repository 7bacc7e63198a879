//! The light of a picture that casts shadows.

use crate::occlusion::TURNS;
use fearless_simd::{f32x16, f64x8, prelude::*};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;
use zeroset_eval::Lanes;
use zeroset_trace::RayGrid;

/// The light's position or direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Infinitely far away; the vector points toward the light and has length 1.
    Directional(DVec3),
    /// At a point of space.
    Positional(DVec3),
}

/// Half the width of a light, as a share of its distance. The sun's is a tenth of that.
const WIDTH: f64 = 0.05;
/// The golden angle, in turns.
const GOLDEN: f64 = 0.381_966_011_25;

impl Light {
    /// A distant light that moves with the camera, above it and to its left.
    pub fn above_left(rays: &RayGrid) -> Self {
        // The light is about 50 degrees off the view direction, and more above it than beside it.
        // In the default view of a cube, the three visible faces then differ clearly, and the top
        // is the brightest.
        let towards = -rays.forward() + 1.1 * rays.up() - 0.35 * rays.right();
        Self::Directional(towards.normalize())
    }

    /// Sixteen places on the light, taken as a [disc](Self::disc).
    pub fn widened(&self, centre: DVec3) -> [Self; TURNS] {
        let disc = self.disc(centre);
        std::array::from_fn(|turn| {
            // Vogel's spiral spreads places evenly over the disc. Consecutive places lie far apart.
            let place = (7 * turn % TURNS) as f64;
            disc([(place + 0.5) / TURNS as f64, place * GOLDEN])
        })
    }

    /// The light as a disc that faces `centre`. Its radius is a 20th of its distance from there.
    /// The returned function maps polar coordinates to a place on the disc. The coordinates are the
    /// square of the distance from its middle, as a share of the squared radius, and the angle in
    /// turns.
    pub fn disc(self, centre: DVec3) -> impl Fn([f64; 2]) -> Self + Sync {
        let (way, distance) = self.towards(centre);
        let (across, upward) = way.try_normalize().unwrap_or(DVec3::Z).any_orthonormal_pair();
        move |[square, turns]| {
            let (sine, cosine) = (turns * TAU).sin_cos();
            let aside = WIDTH * square.sqrt() * (cosine * across + sine * upward);
            match self {
                Self::Directional(way) => Self::Directional((way + aside).normalize()),
                Self::Positional(at) => Self::Positional(at + distance * aside),
            }
        }
    }

    /// The unit vector from `point` toward the light, and the distance, which is infinite for a
    /// directional light. At the light itself the vector is zero.
    pub fn towards(&self, point: DVec3) -> (DVec3, f64) {
        match self {
            Self::Directional(direction) => (*direction, f64::INFINITY),
            Self::Positional(at) => {
                let way = *at - point;
                (way.normalize_or_zero(), way.length())
            }
        }
    }

    /// The unit vectors from sixteen points to the light; zero at the light itself.
    #[inline(always)]
    pub(crate) fn all_towards<S: Simd>(
        &self,
        simd: S,
        points: impl FnOnce() -> [Lanes<f64>; 3],
    ) -> [f32x16<S>; 3] {
        let at = match self {
            Self::Directional(way) => {
                let Vec3 { x, y, z } = way.as_vec3();
                return [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)];
            }
            Self::Positional(at) => at,
        };
        let (points, mut ways) = (points(), [[f64x8::splat(simd, 0.0); 3]; 2]);
        for (half, way) in ways.iter_mut().enumerate() {
            for (axis, way) in way.iter_mut().enumerate() {
                *way = at[axis] - f64x8::from_slice(simd, &points[axis][8 * half..8 * half + 8]);
            }
            let square = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
            let scale = 1.0 / square.max(f64::MIN_POSITIVE).sqrt();
            for way in way {
                *way *= scale;
            }
        }
        let [low, high] = ways;
        [low[0].narrow(high[0]), low[1].narrow(high[1]), low[2].narrow(high[2])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_space::{Camera, Projection};

    #[test]
    fn the_default_light_stands_above_and_left_of_the_eye() {
        let eye = DVec3::new(0.0, -5.0, 0.0);
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, projection).expect("valid");
        let (direction, distance) =
            Light::above_left(&RayGrid::new(&camera, 2, 2)).towards(DVec3::ZERO);
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
