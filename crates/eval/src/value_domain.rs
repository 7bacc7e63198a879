//! Domains of values with which a tape computes, such as intervals or points.
//!
//! Each domain implements the steps of a tape in its own way.

use crate::real::{Real, middle};
use zeroset_interval::{
    Enclosure, Exponent, Interval, Machine, Term, enclose, enclose_sincos, evaluate,
    evaluate_sincos,
};
use zeroset_ir::Axis;
use zeroset_ops::Op;

/// A kind of value, such as intervals or points, for the lanes of a machine.
pub trait ValueDomain<T: Real, M: Machine> {
    /// A value in each lane.
    type Value: Copy;

    /// Returns the value of a coordinate.
    fn coordinate(&mut self, m: &mut M, axis: Axis) -> Self::Value;
    /// Returns the value of the parameter with this number.
    fn parameter(&mut self, m: &mut M, number: usize) -> Self::Value;
    /// Returns the value of a constant known by bounds with ends in `T`.
    fn constant(&mut self, m: &mut M, bounds: Interval) -> Self::Value;
    /// Applies an operation to earlier values.
    fn apply(&mut self, m: &mut M, op: Op, operands: &[Term<Self::Value>]) -> Self::Value;
    /// Applies an operation and its [twin](zeroset_ops::OpRow::twin), such as sine and cosine, to
    /// one operand. `None` if the two share no work.
    fn apply_twins(
        &mut self,
        m: &mut M,
        op: Op,
        operand: &Term<Self::Value>,
    ) -> Option<[Self::Value; 2]>;
    /// Clamps a value that is known to be within `range`; see [`Machine::clamp_to`].
    fn clamp_to(&mut self, _m: &mut M, value: Self::Value, _range: Interval) -> Self::Value {
        value
    }
}

/// Loads the inputs and parameters of a kernel.
pub trait Loader<M: Machine> {
    /// Loads the input's quantity with this number, in the lanes that are being evaluated.
    fn input(&mut self, m: &mut M, quantity: usize) -> M::V;
    /// Loads the quantity with this number from the [`Binding`](crate::Binding).
    fn parameter(&mut self, m: &mut M, quantity: usize) -> M::V;
}

/// The domain of values that are intervals with facts. It reads boxes and parameters with a loader.
pub(crate) struct Bounds<'a, I>(pub &'a mut I);

/// The domain of values at points, without error bounds. It reads inputs with a loader.
pub(crate) struct Samples<'a, I>(pub &'a mut I);

/// Number of quantities per parameter of a binding: −lo, hi and a value between them.
pub(crate) const PARAMETER_QUANTITIES: usize = 3;

impl<T: Real, M: Machine, I: Loader<M>> ValueDomain<T, M> for Bounds<'_, I> {
    type Value = Enclosure<M::V>;

    fn coordinate(&mut self, m: &mut M, axis: Axis) -> Self::Value {
        let neg_lo = self.0.input(m, axis as usize);
        let hi = self.0.input(m, 3 + axis as usize);
        Enclosure::total(neg_lo, hi)
    }

    fn parameter(&mut self, m: &mut M, number: usize) -> Self::Value {
        let [neg_lo, hi] =
            [0, 1].map(|end| self.0.parameter(m, PARAMETER_QUANTITIES * number + end));
        Enclosure::total(neg_lo, hi)
    }

    fn constant(&mut self, m: &mut M, bounds: Interval) -> Self::Value {
        let (neg_lo, hi) = (m.number(T::FORMAT, -bounds.lo), m.number(T::FORMAT, bounds.hi));
        Enclosure::total(neg_lo, hi)
    }

    fn apply(&mut self, m: &mut M, op: Op, operands: &[Term<Self::Value>]) -> Self::Value {
        enclose(m, T::FORMAT, op, operands)
    }

    fn apply_twins(
        &mut self,
        m: &mut M,
        op: Op,
        operand: &Term<Self::Value>,
    ) -> Option<[Self::Value; 2]> {
        enclose_sincos(m, T::FORMAT, op, operand)
    }

    fn clamp_to(&mut self, m: &mut M, value: Self::Value, range: Interval) -> Self::Value {
        let neg_lo = m.clamp_to(T::FORMAT, value.neg_lo, -range.lo);
        let hi = m.clamp_to(T::FORMAT, value.hi, range.hi);
        Enclosure { neg_lo, hi, ..value }
    }
}

impl<T: Real, M: Machine, I: Loader<M>> ValueDomain<T, M> for Samples<'_, I> {
    type Value = M::V;

    fn coordinate(&mut self, m: &mut M, axis: Axis) -> M::V {
        self.0.input(m, axis as usize)
    }

    fn parameter(&mut self, m: &mut M, number: usize) -> M::V {
        self.0.parameter(m, PARAMETER_QUANTITIES * number + 2)
    }

    fn constant(&mut self, m: &mut M, bounds: Interval) -> M::V {
        m.number(T::FORMAT, middle::<T>(bounds))
    }

    fn apply(&mut self, m: &mut M, op: Op, operands: &[Term<M::V>]) -> M::V {
        let exponent = operands.last().map_or(Exponent::Real, |term| term.exponent);
        let values: Vec<M::V> = operands.iter().map(|term| term.value).collect();
        evaluate(m, T::FORMAT, op, &values, exponent)
    }

    fn apply_twins(&mut self, m: &mut M, op: Op, operand: &Term<M::V>) -> Option<[M::V; 2]> {
        evaluate_sincos(m, T::FORMAT, op, operand.value, operand.range)
    }
}
