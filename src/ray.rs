//! Rays, and what is proven about them.

use crate::error::Error;
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;
use zeroset_trace::{KernelStats, Segment, Start, Status, Tracer, UndecidedReason};

/// Largest magnitude of a number of a ray. The limit for cameras is the same.
const LARGEST: f64 = 1e100;

/// Number of rays that a thread follows at a time.
const RAYS: usize = 64;

/// A half line: the points `origin + t · direction` for t ≥ 0.
///
/// Its numbers are taken as exact, and proofs hold for the exact line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at which t is 0.
    pub origin: [f64; 3],
    /// The change of the point when t grows by 1. It may have any length but 0.
    pub direction: [f64; 3],
}

/// A claim about a ray within a domain, with its proof. All distances are values of t on the ray.
/// Multiply them by the direction's length to get world units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum RayResult {
    /// Proven: the ray meets no zero in the domain.
    Miss,
    /// Proven: the ray meets a zero in the domain.
    #[non_exhaustive]
    Hit {
        /// The value of t at which a picture draws the surface, near the zero.
        t: f64,
        /// Lower and upper bound of t at the first zero. No zero lies before the bracket.
        bracket: [f64; 2],
    },
    /// Neither a hit nor a miss is proven.
    #[non_exhaustive]
    Undecided {
        /// Value of t up to which the ray meets no zero.
        from: f64,
        /// The value of t at which a picture draws the surface. `None` if it draws the background.
        t: Option<f64>,
        /// The reason why the first unproven part of the ray is undecided.
        reason: Reason,
    },
}

/// The reason why neither a hit nor a miss is proven. `Display` completes the phrase "undecided:
/// …".
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Reason {
    /// The method gives no reason.
    Other,
    /// The function comes too near to 0 for arithmetic to tell the difference, and shows no change
    /// of sign. The surface touches itself, or the function touches 0 without crossing it.
    Touching,
    /// The function may be undefined on a part of the ray.
    Undefined,
    /// The function may be discontinuous on a part of the ray.
    Discontinuous,
    /// The limit of effort per ray, or of time per picture, was reached.
    Budget,
    /// The method proves nothing about rays of this kind.
    Unproven,
    /// The method needs a bound of the function's slope, and none is known.
    Steep,
    /// A part of the ray was not examined. This shows a flaw in the program, never a miss.
    Unseen,
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
            UndecidedReason::Unseen => Self::Unseen,
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
            Self::Unseen => "it was not examined, by a flaw in the program: please report it",
        })
    }
}

/// Smallest allowed magnitude of a direction's largest component.
const LEAST: f64 = 1e-100;

/// Returns the ray in the form that methods take, and the factor from its t to the caller's t.
///
/// The factor is a power of two that brings the direction's largest component within [0.5, 1).
/// Scaling by a power of two is exact, so both rays lie on the same line.
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
    /// Follows rays. If the method proves zeros, a hit is at most `accuracy`, in world units, from
    /// its zero.
    pub(crate) fn follow(
        tracer: &dyn Tracer,
        rays: &[Ray],
        accuracy: f64,
    ) -> Result<Vec<Self>, Error> {
        let segments = rays.iter().enumerate().map(|(n, ray)| scaled(ray, n, accuracy));
        let (segments, scales): (Vec<_>, Vec<_>) =
            segments.collect::<Result<Vec<_>, Error>>()?.into_iter().unzip();
        let mut found = vec![zeroset_trace::RayResult::UNSEEN; rays.len()];
        let batches = segments.par_chunks(RAYS).zip(found.par_chunks_mut(RAYS));
        batches.for_each(|(rays, found)| {
            tracer.follow(rays, Start::Anywhere, found, &mut KernelStats::default());
        });
        Ok(found.iter().zip(scales).map(|(found, scale)| Self::of(found, scale)).collect())
    }

    /// Converts a result, and multiplies its distances by `scale`, a power of two.
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

/// Returns `t · scale`, where `scale` is a power of two. Rounds down if the product is subnormal.
fn below(t: f64, scale: f64) -> f64 {
    let product = t * scale;
    if product / scale > t { product.next_down() } else { product }
}
