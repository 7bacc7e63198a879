//! Views of surfaces: a standard one, and others drawn from a seed.
//!
//! Some views need points on the surface. The certified tracer finds these points, so views do not
//! depend on the methods that are compared.

use crate::error::ChartError;
use crate::surfaces::ChartSurface;
use crate::truth::Certifier;
use fastrand::Rng;
use glam::DVec3;
use zeroset_space::{Camera, Projection, Ray};
use zeroset_testkit::certified::BUDGET;

/// Field of view in degrees, in every view.
const FOV: f64 = 40.0;
/// Offset of the standard eye from the domain's middle, in half extents (Knoll et al. 2007).
const STANDARD: DVec3 = DVec3::new(2.0, 1.5, 3.0);
/// Number of rays tried to find a point on a surface.
const TRIES: usize = 400;
/// Coordinates are multiples of a half extent over this number, which keeps their decimals short.
const STEPS: f64 = 65536.0;

/// Kinds of views, in order. Further views repeat this list without the standard view.
const KINDS: [ViewKind; 8] = [
    ViewKind::Standard,
    ViewKind::Around,
    ViewKind::Close,
    ViewKind::Grazing,
    ViewKind::Inside,
    ViewKind::Around,
    ViewKind::Close,
    ViewKind::Grazing,
];

/// Position of the eye relative to the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ViewKind {
    /// The standard view of the literature.
    Standard,
    /// At the standard distance, in a random direction.
    Around,
    /// A fifth of a half extent in front of a random point of the surface.
    Close,
    /// Beside a random point of the surface, just above its tangent plane.
    Grazing,
    /// At a random place in the domain.
    Inside,
}

/// A camera and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Number and kind of the view, for example `3-grazing`.
    pub name: String,
    /// Camera of the view.
    pub camera: Camera,
}

/// The first `count` views of a surface. A view depends only on the seed, the surface's name and
/// the view's number. If no point of the surface is found, a view around the surface replaces each
/// close or grazing view.
///
/// # Errors
/// If the function cannot be compiled.
pub fn views(surface: &ChartSurface, count: usize, seed: u64) -> Result<Vec<View>, ChartError> {
    (0..count).map(|number| view(surface, number, seed)).collect()
}

fn view(surface: &ChartSurface, number: usize, seed: u64) -> Result<View, ChartError> {
    let mut rng = rng(&format!("{seed} {} view {number}", surface.name));
    let (centre, half) = (surface.region.centre(), surface.region.half_extent());
    let mut kind = if number == 0 { KINDS[0] } else { KINDS[1 + (number - 1) % (KINDS.len() - 1)] };
    let mut near = None;
    if matches!(kind, ViewKind::Close | ViewKind::Grazing) {
        near = point(surface, &mut rng)?;
        if near.is_none() {
            kind = ViewKind::Around;
        }
    }
    let (point, normal) = near.unwrap_or((centre, DVec3::Z));
    let (eye, target) = match kind {
        ViewKind::Standard => (centre + half * STANDARD, centre),
        ViewKind::Around => (centre + half * STANDARD.length() * direction(&mut rng), centre),
        ViewKind::Close => (point + 0.2 * half * (normal + 0.3 * direction(&mut rng)), point),
        ViewKind::Grazing => {
            let along =
                normal.cross(direction(&mut rng)).normalize_or(normal.any_orthonormal_vector());
            (point + half * (0.7 * along + 0.02 * normal), point)
        }
        ViewKind::Inside => {
            let place = 0.6 * half * rng.f64() * direction(&mut rng);
            (centre + place, centre + place + half * direction(&mut rng))
        }
    };
    let snap = |v: DVec3| {
        if kind == ViewKind::Standard { v } else { (v * (STEPS / half)).round() * (half / STEPS) }
    };
    let (eye, target) = (snap(eye), snap(target));
    let upright = (target - eye).normalize().cross(DVec3::Y).length() > 0.05;
    let up = if upright { DVec3::Y } else { DVec3::X };
    let camera = Camera::new(eye, target, up, Projection::Perspective { fov: FOV })
        .map_err(ChartError::of_surface(&surface.name))?;
    let kind = format!("{kind:?}").to_lowercase();
    Ok(View { name: format!("{number}-{kind}"), camera })
}

/// A random number generator seeded by a text.
pub fn rng(purpose: &str) -> Rng {
    let hash = blake3::hash(purpose.as_bytes());
    let bytes = hash.as_bytes().first_chunk().copied().unwrap_or_default();
    Rng::with_seed(u64::from_le_bytes(bytes))
}

/// A unit vector in a uniformly distributed direction.
pub fn direction(rng: &mut Rng) -> DVec3 {
    loop {
        let v = DVec3::new(rng.f64(), rng.f64(), rng.f64()) * 2.0 - 1.0;
        if (0.01..=1.0).contains(&v.length()) {
            return v.normalize();
        }
    }
}

/// A point where the function crosses 0, visible from outside, and its normal towards the viewer.
fn point(surface: &ChartSurface, rng: &mut Rng) -> Result<Option<(DVec3, DVec3)>, ChartError> {
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
