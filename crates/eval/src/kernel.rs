//! What a traverser may ask of a function.

use crate::packet::{BoxPacket, EnclosurePacket, GradientPacket, PointPacket, ValuePacket};
use crate::real::Real;

/// Encloses a function over boxes.
pub trait IntervalKernel<T: Real = f32>: Sync {
    /// Encloses the function over each box: for every real point of a box where the function is defined, its value
    /// lies within the lane's bounds.
    ///
    /// # Panics
    /// If `out` is shorter than `boxes`.
    fn enclose(&self, boxes: &[BoxPacket<T>], out: &mut [EnclosurePacket<T>]);
}

/// Samples a function at points, in `T` rounded up: no error bound is claimed.
pub trait PointKernel<T: Real = f32>: Sync {
    /// Evaluates the function at each point.
    ///
    /// # Panics
    /// If `out` is shorter than `points`.
    fn sample(&self, points: &[PointPacket<T>], out: &mut [ValuePacket<T>]);
}

/// Samples a function and its gradient at points, in `T` rounded up: no error bound is claimed.
pub trait GradientKernel<T: Real = f32>: Sync {
    /// Evaluates the function and its gradient at each point.
    ///
    /// # Panics
    /// If `out` is shorter than `points`.
    fn gradient(&self, points: &[PointPacket<T>], out: &mut [GradientPacket<T>]);
}
