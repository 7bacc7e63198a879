//! What a traverser may ask of a function.

use crate::packet::{BoxPacket, EnclosurePacket, GradientPacket, PointPacket, ValuePacket};

/// Encloses a function over boxes.
pub trait IntervalKernel: Sync {
    /// Encloses the function over each box: for every real point of a box where the function is defined, its value
    /// lies within the lane's bounds.
    ///
    /// # Panics
    /// If `out` is shorter than `boxes`.
    fn enclose(&self, boxes: &[BoxPacket], out: &mut [EnclosurePacket]);
}

/// Samples a function at points, in `f32` rounded up: no error bound is claimed.
pub trait PointKernel: Sync {
    /// Evaluates the function at each point.
    ///
    /// # Panics
    /// If `out` is shorter than `points`.
    fn sample(&self, points: &[PointPacket], out: &mut [ValuePacket]);
}

/// Samples a function and its gradient at points, in `f32` rounded up: no error bound is claimed.
pub trait GradientKernel: Sync {
    /// Evaluates the function and its gradient at each point.
    ///
    /// # Panics
    /// If `out` is shorter than `points`.
    fn gradient(&self, points: &[PointPacket], out: &mut [GradientPacket]);
}
