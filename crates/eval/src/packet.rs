//! Memory layouts that evaluators share: packets of four lanes.

/// Lanes in a packet of `f32`.
pub const LANES: usize = 4;

/// Four lanes of one quantity.
pub type Lanes = [f32; LANES];

/// Four boxes. Each coordinate is stored as the pair (−lo, hi), so that rounding both up rounds outward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct BoxPacket {
    /// Per axis, the negated lower ends.
    pub neg_lo: [Lanes; 3],
    /// Per axis, the upper ends.
    pub hi: [Lanes; 3],
}

/// Four enclosures of a function, one per box.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct EnclosurePacket {
    /// The negated lower ends; never NaN, never −∞ (where the facts say nowhere, nothing else is said of them).
    pub neg_lo: Lanes,
    /// The upper ends; never NaN, never −∞.
    pub hi: Lanes,
    /// The bits of [`Facts`](zeroset_interval::Facts), per lane.
    pub facts: [u32; LANES],
}

/// Four points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct PointPacket {
    /// Per axis, the coordinates.
    pub at: [Lanes; 3],
}

/// Four values of a function, one per point. NaN where it is undefined, or infinite at a pole.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct ValuePacket {
    /// The values.
    pub value: Lanes,
}

/// Four values and gradients, one per point. NaN or infinite where they do not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct GradientPacket {
    /// The values.
    pub value: Lanes,
    /// Per axis, the partial derivatives.
    pub gradient: [Lanes; 3],
}
