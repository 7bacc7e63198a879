//! Rays, and what is proven of them.

use crate::error::Error;
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;
use zeroset_trace::{KernelStats, Segment, Start, Status, Tracer, UndecidedReason};

/// Largest magnitude of a coordinate: as of cameras, whose rays the methods are made for.
const LARGEST: f64 = 1e100;

/// Rays that a thread follows at a time.
const RAYS: usize = 64;

/// A half line: the points `origin + t · direction` for t ≥ 0.
///
/// It is exactly the line of these numbers, and proofs hold for that line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at which t is 0.
    pub origin: [f64; 3],
    /// The step of the point while t grows by 1. It may have any length but 0.
    pub direction: [f64; 3],
}

/// A claim about a ray within a domain, with its proof. Distances are values of the ray's t:
/// multiply them by the direction's length to get world units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RayResult {
    /// The ray meets no zero in the domain.
    Miss,
    /// The ray meets a zero.
    #[non_exhaustive]
    Hit {
        /// A point near the zero, at which a picture shows it.
        t: f64,
        /// Lower and upper bound of the first zero: it lies between them, and none lies before.
        bracket: [f64; 2],
    },
    /// Neither is proven.
    #[non_exhaustive]
    Undecided {
        /// No zero lies before this t.
        from: f64,
        /// The point at which a picture shows the surface; `None` if it shows the background.
        t: Option<f64>,
        /// The reason, by the first part of the ray for which nothing is proven.
        reason: Reason,
    },
}

/// The reason why neither a hit nor a miss is proven. `Display` completes "undecided: …".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Reason {
    /// The method does not tell.
    Other,
    /// The function comes as near to 0 as arithmetic can tell, and shows no change of sign: it
    /// touches 0, or the surface meets itself.
    Touching,
    /// The function may be undefined there.
    Undefined,
    /// The function may be discontinuous there.
    Discontinuous,
    /// The effort or time that a ray or a picture may take was not enough.
    Budget,
    /// The method proves nothing of such a ray.
    Unproven,
    /// The method needs a bound of the function's slope, and none is known.
    Steep,
}

impl Reason {
    pub(crate) fn of(reason: UndecidedReason) -> Self {
        match reason {
            UndecidedReason::None => Self::Other,
            UndecidedReason::Touching => Self::Touching,
            UndecidedReason::Undefined => Self::Undefined,
            UndecidedReason::Discontinuous => Self::Discontinuous,
            UndecidedReason::Budget => Self::Budget,
            UndecidedReason::Unproven => Self::Unproven,
            UndecidedReason::Steep => Self::Steep,
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Other => "for no known reason",
            Self::Touching => "the function comes near 0 and no change of sign is proven",
            Self::Undefined => "the function may be undefined",
            Self::Discontinuous => "the function may be discontinuous",
            Self::Budget => "effort or time ran out",
            Self::Unproven => "the method proves nothing of such rays",
            Self::Steep => "the method needs a bound of the slope, and none is known",
        })
    }
}

/// The least largest component of a direction.
const LEAST: f64 = 1e-100;

/// A ray as methods take it, and the factor between its t and that of the caller's ray.
///
/// The factor is a power of two that brings the direction's largest component within [0.5, 1).
/// Scaling by it is exact, so both rays lie on the same line.
fn scaled(ray: &Ray, number: usize, accuracy: f64) -> Result<(Segment, f64), Error> {
    let refuse = |why: &str| Err(Error::argument(format!("ray {number} {why}")));
    let (origin, direction) = (DVec3::from(ray.origin), DVec3::from(ray.direction));
    let is_within = |c: &f64| c.abs() <= LARGEST;
    if !ray.origin.iter().chain(&ray.direction).all(is_within) {
        return refuse("has a coordinate that is not a number within ±1e100");
    }
    let largest = direction.abs().max_element();
    if largest == 0.0 {
        return refuse("has no direction: all of its components are 0");
    }
    let scale = f64::from_bits((2045 - (largest.to_bits() >> 52)) << 52);
    let scaled = direction * scale;
    if largest < LEAST || scaled / scale != direction {
        return refuse("has a direction with components too small for 64-bit floats");
    }
    let pixel = [accuracy / scaled.length(), 0.0];
    let ray = zeroset_space::Ray { origin, direction: scaled };
    Ok((Segment { ray, to: f64::INFINITY, pixel }, scale))
}

impl RayResult {
    /// Follows rays; a hit's t is within `accuracy`, a length in world units, of its zero if the
    /// method can tell.
    pub(crate) fn follow(
        tracer: &dyn Tracer,
        rays: &[Ray],
        accuracy: f64,
    ) -> Result<Vec<Self>, Error> {
        let segments = rays.iter().enumerate().map(|(n, ray)| scaled(ray, n, accuracy));
        let (segments, scales): (Vec<_>, Vec<_>) =
            segments.collect::<Result<Vec<_>, Error>>()?.into_iter().unzip();
        let mut found = vec![zeroset_trace::RayResult::MISS; rays.len()];
        let batches = segments.par_chunks(RAYS).zip(found.par_chunks_mut(RAYS));
        batches.for_each(|(rays, found)| {
            tracer.follow(rays, Start::Anywhere, found, &mut KernelStats::default());
        });
        Ok(found.iter().zip(scales).map(|(found, scale)| Self::of(found, scale)).collect())
    }

    /// A result whose distances are multiplied by a power of two.
    fn of(found: &zeroset_trace::RayResult, scale: f64) -> Self {
        let t = found.drawn * scale;
        match found.status {
            Status::Miss => Self::Miss,
            Status::Hit => {
                let [near, far] = found.bracket;
                Self::Hit { t, bracket: [below(near, scale), -below(-far, scale)] }
            }
            Status::Undecided => Self::Undecided {
                from: below(found.distance, scale),
                t: t.is_finite().then_some(t),
                reason: Reason::of(found.reason),
            },
        }
    }
}

/// The product with a power of two, rounded down where it is subnormal.
fn below(t: f64, scale: f64) -> f64 {
    let product = t * scale;
    if product / scale > t { product.next_down() } else { product }
}
