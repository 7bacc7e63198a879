//! Where surfaces are seen from: a standard view, and others that a seed draws.
//!
//! Points on surfaces are found by the certified tracer, so that a view does not change with the
//! methods that it judges.

use crate::error::ChartError;
use crate::surfaces::Surface;
use crate::truth::Certifier;
use fastrand::Rng;
use glam::DVec3;
use zeroset_testkit::certified::BUDGET;
use zeroset_trace::{Camera, Projection, Ray};

/// Degrees, in every view.
const FOV: f64 = 40.0;
/// From the middle of the domain to the eye of the standard view, in half extents: that of Knoll et
/// al. 2007.
const STANDARD: DVec3 = DVec3::new(2.0, 1.5, 3.0);
/// Rays that are tried for a point on a surface.
const TRIES: usize = 400;
/// Parts of a half extent that coordinates are rounded to, so that they are short where they are
/// printed.
const STEPS: f64 = 65536.0;

/// What kinds of views there are; the next after the last is the first but the standard one.
const KINDS: [Kind; 8] = [
    Kind::Standard,
    Kind::Around,
    Kind::Close,
    Kind::Grazing,
    Kind::Inside,
    Kind::Around,
    Kind::Close,
    Kind::Grazing,
];

/// How the eye lies to the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// As in the literature.
    Standard,
    /// In a random direction, as far away.
    Around,
    /// Before a random point of the surface, a fifth of a half extent away.
    Close,
    /// Beside a random point of the surface, hardly above its tangent plane.
    Grazing,
    /// At a random place in the domain.
    Inside,
}

/// A camera, and what it is there for.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Its number and kind, as in `3-grazing`.
    pub name: String,
    /// Where the picture is taken from.
    pub camera: Camera,
}

/// The first `count` views of a surface; each depends on the seed, the surface's name and its own
/// number only.
///
/// # Errors
/// If the function has no code. Where the surface was not met by any of many rays, views from all
/// around take the place of those near it.
pub fn views(surface: &Surface, count: usize, seed: u64) -> Result<Vec<View>, ChartError> {
    (0..count).map(|number| view(surface, number, seed)).collect()
}

fn view(surface: &Surface, number: usize, seed: u64) -> Result<View, ChartError> {
    let mut rng = rng(&format!("{seed} {} view {number}", surface.name));
    let (centre, half) = (surface.region.centre(), surface.region.half_extent());
    let mut kind = if number == 0 { KINDS[0] } else { KINDS[1 + (number - 1) % (KINDS.len() - 1)] };
    let mut near = None;
    if matches!(kind, Kind::Close | Kind::Grazing) {
        near = point(surface, &mut rng)?;
        if near.is_none() {
            kind = Kind::Around;
        }
    }
    let (point, normal) = near.unwrap_or((centre, DVec3::Z));
    let (eye, target) = match kind {
        Kind::Standard => (centre + half * STANDARD, centre),
        Kind::Around => (centre + half * STANDARD.length() * direction(&mut rng), centre),
        Kind::Close => (point + 0.2 * half * (normal + 0.3 * direction(&mut rng)), point),
        Kind::Grazing => {
            let along =
                normal.cross(direction(&mut rng)).normalize_or(normal.any_orthonormal_vector());
            (point + half * (0.7 * along + 0.02 * normal), point)
        }
        Kind::Inside => {
            let place = 0.6 * half * rng.f64() * direction(&mut rng);
            (centre + place, centre + place + half * direction(&mut rng))
        }
    };
    let snap = |v: DVec3| {
        if kind == Kind::Standard { v } else { (v * (STEPS / half)).round() * (half / STEPS) }
    };
    let (eye, target) = (snap(eye), snap(target));
    let upright = (target - eye).normalize().cross(DVec3::Y).length() > 0.05;
    let up = if upright { DVec3::Y } else { DVec3::X };
    let camera = Camera::new(eye, target, up, Projection::Perspective { fov: FOV })
        .map_err(ChartError::of_surface(&surface.name))?;
    let kind = format!("{kind:?}").to_lowercase();
    Ok(View { name: format!("{number}-{kind}"), camera })
}

/// A generator for one purpose.
pub fn rng(purpose: &str) -> Rng {
    let hash = blake3::hash(purpose.as_bytes());
    let bytes = hash.as_bytes().first_chunk().copied().unwrap_or_default();
    Rng::with_seed(u64::from_le_bytes(bytes))
}

/// A direction of length 1, all alike.
pub fn direction(rng: &mut Rng) -> DVec3 {
    loop {
        let v = DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - 1.0;
        if (0.01..=1.0).contains(&v.length()) {
            return v.normalize();
        }
    }
}

/// A point where the function crosses 0, seen from outside, and its normal towards where it is seen
/// from.
fn point(surface: &Surface, rng: &mut Rng) -> Result<Option<(DVec3, DVec3)>, ChartError> {
    let certifier = Certifier::new(surface, BUDGET)?;
    let (centre, half) = (surface.region.centre(), surface.region.half_extent());
    for _ in 0..TRIES {
        let origin = centre + half * STANDARD.length() * direction(rng);
        let through = centre + 0.7 * half * rng.f64() * direction(rng);
        let ray = Ray { origin, direction: through - origin };
        let Some(crossing) = certifier.trace(&ray).crossing else { continue };
        let point = ray.at(crossing.near);
        let normal = certifier.gradient(point).normalize_or_zero();
        if crossing.simple && normal.is_normalized() {
            let towards = -normal.dot(ray.direction).signum();
            return Ok(Some((point, normal * towards)));
        }
    }
    Ok(None)
}
