//! Parameter values in the layout that kernels read.

use crate::lanes::Lanes;
use crate::real::{Real, middle, outward};
use crate::value_kind::PARAMETER_QUANTITIES;
use std::sync::Arc;
use zeroset_interval::Interval;

/// Values of all parameters for one picture.
///
/// A typed number need not be a float, so bounds enclose each value. Clones share the values.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding<T: Real = f32> {
    quantities: Arc<[Lanes<T>]>,
    bounds: Arc<[Interval]>,
}

impl<T: Real> Binding<T> {
    /// Creates a binding from the bounds of each parameter's value.
    pub fn new(parameters: &[Interval]) -> Self {
        let bounds: Arc<[Interval]> =
            parameters.iter().map(|bounds| outward::<T>(*bounds)).collect();
        let quantities = |b: &Interval| -> [Lanes<T>; PARAMETER_QUANTITIES] {
            [-b.lo, b.hi, middle::<T>(*b)].map(|number| Lanes::splat(T::nearest(number)))
        };
        Self { quantities: bounds.iter().flat_map(quantities).collect(), bounds }
    }

    /// The binding of functions without parameters.
    pub fn empty() -> Self {
        Self::new(&[])
    }

    /// The quantities that kernels read. Each parameter has three: −lo and hi of its bounds, and a
    /// value near the middle of the bounds. All lanes of a quantity are equal.
    pub fn quantities(&self) -> &[Lanes<T>] {
        &self.quantities
    }

    /// Bounds of each parameter, with ends in `T`.
    pub fn bounds(&self) -> &[Interval] {
        &self.bounds
    }

    /// Returns whether each parameter lies within its range in `ranges`. Code compiled for these
    /// ranges is then valid for this binding.
    pub fn is_within(&self, ranges: &[Interval]) -> bool {
        let inside = |(b, range): (&Interval, &Interval)| range.lo <= b.lo && b.hi <= range.hi;
        self.bounds.len() == ranges.len() && self.bounds.iter().zip(ranges).all(inside)
    }
}
