//! Memory layouts that evaluators share: packets of four lanes, in `f32` unless said otherwise.

use crate::real::Real;
use zeroset_interval::Facts;

/// Lanes in a packet, of `f32` and of `f64`: traversers follow 2×2 rays in either.
pub const LANES: usize = 4;

/// Four lanes of one quantity.
pub type Lanes<T = f32> = [T; LANES];

/// Four boxes. Each coordinate is stored as the pair (−lo, hi), so that rounding both up rounds outward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct BoxPacket<T: Real = f32> {
    /// Per axis, the negated lower ends.
    pub neg_lo: [Lanes<T>; 3],
    /// Per axis, the upper ends.
    pub hi: [Lanes<T>; 3],
}

/// Four enclosures of a function, one per box.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct EnclosurePacket<T: Real = f32> {
    /// The negated lower ends; never NaN, never −∞ (where the facts say nowhere, nothing else is said of them).
    pub neg_lo: Lanes<T>,
    /// The upper ends; never NaN, never −∞.
    pub hi: Lanes<T>,
    /// The bits of [`Facts`], per lane.
    pub facts: [T::Word; LANES],
}

/// Four points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct PointPacket<T: Real = f32> {
    /// Per axis, the coordinates.
    pub at: [Lanes<T>; 3],
}

/// Four values of a function, one per point. NaN where it is undefined, or infinite at a pole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct ValuePacket<T: Real = f32> {
    /// The values.
    pub value: Lanes<T>,
}

/// Four values and gradients, one per point. NaN or infinite where they do not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct GradientPacket<T: Real = f32> {
    /// The values.
    pub value: Lanes<T>,
    /// Per axis, the partial derivatives.
    pub gradient: [Lanes<T>; 3],
}

impl<T: Real> EnclosurePacket<T> {
    /// What is proven of the function over one box.
    ///
    /// # Panics
    /// If there is no such lane.
    pub fn facts(&self, lane: usize) -> Facts {
        T::facts(self.facts[lane])
    }
}
