//! Kinds of values that a tape computes with, such as intervals or points.
//!
//! Each kind implements the steps of a tape in its own way, on any machine.

use crate::forms::Path;
use crate::real::{Real, middle};
use std::marker::PhantomData;
use zeroset_interval::{
    Enclosure, Exponent, Form, Interval, Machine, Term, enclose, enclose_sincos, evaluate,
    evaluate_sincos, form_bounds, linearise, linearise_sincos,
};
use zeroset_ir::Axis;
use zeroset_ops::Op;

/// A kind of values, and how each step of a tape computes one.
pub trait ValueKind: Copy + Send + Sync + 'static {
    /// A value of this kind in the lanes of vectors `V`.
    type Value<V: Vector>: Vector;

    /// The data that all coordinates of a batch use, such as a range of t.
    type Context<V: Vector>: Copy;

    /// Loads the context of a batch.
    fn context<T: Real, M: Machine>(m: &mut M, loader: &mut impl Loader<M>) -> Self::Context<M::V>;
    /// Loads or computes a coordinate.
    fn coordinate<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        context: Self::Context<M::V>,
        axis: Axis,
    ) -> Self::Value<M::V>;
    /// Returns the parameter with this number.
    fn parameter<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        number: usize,
    ) -> Self::Value<M::V>;
    /// Returns a constant that lies within `bounds`, whose ends are numbers of `T`.
    fn constant<T: Real, M: Machine>(m: &mut M, bounds: Interval) -> Self::Value<M::V>;
    /// Applies an operation to earlier values.
    fn apply<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operands: &[Term<Self::Value<M::V>>],
    ) -> Self::Value<M::V>;
    /// Applies an operation and its [twin](zeroset_ops::OpRow::twin) to the same value, such as
    /// sine and cosine. `None` if the two share no work.
    fn apply_twins<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operand: &Term<Self::Value<M::V>>,
    ) -> Option<[Self::Value<M::V>; 2]>;
    /// Returns the value with all delayed work done, so that few shapes of values exist.
    fn settled<T: Real, M: Machine>(_m: &mut M, value: Self::Value<M::V>) -> Self::Value<M::V> {
        value
    }
    /// Returns proven bounds of a value; `None` for a kind without proofs.
    fn bounds<T: Real, M: Machine>(
        m: &mut M,
        value: &Term<Self::Value<M::V>>,
    ) -> Option<Enclosure<M::V>>;
    /// Replaces each vector of a value, always in the same order. What is known when code is
    /// compiled stays.
    fn map<V: Vector, U: Vector>(
        value: &Self::Value<V>,
        f: &mut impl FnMut(V) -> U,
    ) -> Self::Value<U>;
    /// A code of what is known about a value when code is compiled, such as which vectors it has.
    /// Values with the same code differ in their vectors only.
    fn shape<V: Vector>(value: &Self::Value<V>) -> u128;
}

/// A type that can stand for a vector of a machine.
pub trait Vector: Copy + Send + Sync + 'static {}

impl<V: Copy + Send + Sync + 'static> Vector for V {}

/// Loads the inputs and parameters of a kernel.
pub trait Loader<M: Machine> {
    /// Returns the input's quantity with this number, in the lanes that are being evaluated.
    fn input(&mut self, m: &mut M, quantity: usize) -> M::V;
    /// Returns the quantity with this number of the [`Binding`](crate::Binding).
    fn parameter(&mut self, m: &mut M, quantity: usize) -> M::V;
}

impl<M: Machine, L: Loader<M> + ?Sized> Loader<M> for &mut L {
    fn input(&mut self, m: &mut M, quantity: usize) -> M::V {
        (**self).input(m, quantity)
    }

    fn parameter(&mut self, m: &mut M, quantity: usize) -> M::V {
        (**self).parameter(m, quantity)
    }
}

/// Intervals with facts.
#[derive(Clone, Copy, Debug)]
pub struct Intervals;

/// Numbers without error bounds.
#[derive(Clone, Copy, Debug)]
pub struct Numbers;

/// Affine forms of `N` symbols on a path.
#[derive(Clone, Copy, Debug)]
pub struct Forms<P, const N: usize>(PhantomData<P>);

/// Number of quantities per parameter in a [`Binding`](crate::Binding): −lo, hi, and a value
/// between them.
pub(crate) const PARAMETER_QUANTITIES: usize = 3;

/// Loads the bounds of a parameter.
pub(crate) fn parameter_bounds<M: Machine>(
    m: &mut M,
    loader: &mut impl Loader<M>,
    number: usize,
) -> Enclosure<M::V> {
    let [neg_lo, hi] = [0, 1].map(|end| loader.parameter(m, PARAMETER_QUANTITIES * number + end));
    Enclosure::total(neg_lo, hi)
}

/// Loads the bounds of a coordinate from [`Boxes`](crate::Boxes).
pub(crate) fn coordinate_bounds<M: Machine>(
    m: &mut M,
    loader: &mut impl Loader<M>,
    axis: Axis,
) -> Enclosure<M::V> {
    let neg_lo = loader.input(m, axis as usize);
    let hi = loader.input(m, 3 + axis as usize);
    Enclosure::total(neg_lo, hi)
}

impl ValueKind for Intervals {
    type Value<V: Vector> = Enclosure<V>;
    type Context<V: Vector> = ();

    fn context<T: Real, M: Machine>(_: &mut M, _: &mut impl Loader<M>) {}

    fn coordinate<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        (): (),
        axis: Axis,
    ) -> Enclosure<M::V> {
        coordinate_bounds(m, loader, axis)
    }

    fn parameter<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        number: usize,
    ) -> Enclosure<M::V> {
        parameter_bounds(m, loader, number)
    }

    fn constant<T: Real, M: Machine>(m: &mut M, bounds: Interval) -> Enclosure<M::V> {
        let (neg_lo, hi) = (m.number(T::FORMAT, -bounds.lo), m.number(T::FORMAT, bounds.hi));
        Enclosure::total(neg_lo, hi)
    }

    fn apply<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operands: &[Term<Enclosure<M::V>>],
    ) -> Enclosure<M::V> {
        enclose(m, T::FORMAT, op, operands)
    }

    fn apply_twins<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operand: &Term<Enclosure<M::V>>,
    ) -> Option<[Enclosure<M::V>; 2]> {
        enclose_sincos(m, T::FORMAT, op, operand)
    }

    fn bounds<T: Real, M: Machine>(
        _: &mut M,
        value: &Term<Enclosure<M::V>>,
    ) -> Option<Enclosure<M::V>> {
        Some(value.value)
    }

    fn map<V: Vector, U: Vector>(value: &Enclosure<V>, f: &mut impl FnMut(V) -> U) -> Enclosure<U> {
        value.map(f)
    }

    fn shape<V: Vector>(value: &Enclosure<V>) -> u128 {
        value.facts.shape()
    }
}

impl ValueKind for Numbers {
    type Value<V: Vector> = V;
    type Context<V: Vector> = ();

    fn context<T: Real, M: Machine>(_: &mut M, _: &mut impl Loader<M>) {}

    fn coordinate<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        (): (),
        axis: Axis,
    ) -> M::V {
        loader.input(m, axis as usize)
    }

    fn parameter<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        number: usize,
    ) -> M::V {
        loader.parameter(m, PARAMETER_QUANTITIES * number + 2)
    }

    fn constant<T: Real, M: Machine>(m: &mut M, bounds: Interval) -> M::V {
        m.number(T::FORMAT, middle::<T>(bounds))
    }

    fn apply<T: Real, M: Machine>(m: &mut M, op: Op, operands: &[Term<M::V>]) -> M::V {
        let exponent = operands.last().map_or(Exponent::Real, |term| term.exponent);
        let values: Vec<M::V> = operands.iter().map(|term| term.value).collect();
        evaluate(m, T::FORMAT, op, &values, exponent)
    }

    fn apply_twins<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operand: &Term<M::V>,
    ) -> Option<[M::V; 2]> {
        evaluate_sincos(m, T::FORMAT, op, operand.value, operand.range)
    }

    fn bounds<T: Real, M: Machine>(_: &mut M, _: &Term<M::V>) -> Option<Enclosure<M::V>> {
        None
    }

    fn map<V: Vector, U: Vector>(value: &V, f: &mut impl FnMut(V) -> U) -> U {
        f(*value)
    }

    fn shape<V: Vector>(_: &V) -> u128 {
        0
    }
}

impl<P: Path<N>, const N: usize> ValueKind for Forms<P, N> {
    type Value<V: Vector> = Form<V, N>;
    type Context<V: Vector> = P::Context<V>;

    fn context<T: Real, M: Machine>(m: &mut M, loader: &mut impl Loader<M>) -> P::Context<M::V> {
        P::context(m, T::FORMAT, loader)
    }

    fn coordinate<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        context: P::Context<M::V>,
        axis: Axis,
    ) -> Form<M::V, N> {
        P::coordinate(m, T::FORMAT, loader, context, axis)
    }

    fn parameter<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        number: usize,
    ) -> Form<M::V, N> {
        let bounds = parameter_bounds(m, loader, number);
        Form::between(m, T::FORMAT, &bounds)
    }

    fn constant<T: Real, M: Machine>(m: &mut M, bounds: Interval) -> Form<M::V, N> {
        Form::constant(m, T::FORMAT, bounds)
    }

    fn apply<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operands: &[Term<Form<M::V, N>>],
    ) -> Form<M::V, N> {
        linearise(m, T::FORMAT, op, operands)
    }

    fn apply_twins<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operand: &Term<Form<M::V, N>>,
    ) -> Option<[Form<M::V, N>; 2]> {
        linearise_sincos(m, T::FORMAT, op, operand)
    }

    fn settled<T: Real, M: Machine>(m: &mut M, value: Form<M::V, N>) -> Form<M::V, N> {
        value.settled(m, T::FORMAT)
    }

    fn bounds<T: Real, M: Machine>(
        m: &mut M,
        value: &Term<Form<M::V, N>>,
    ) -> Option<Enclosure<M::V>> {
        Some(form_bounds(m, T::FORMAT, value))
    }

    fn map<V: Vector, U: Vector>(value: &Form<V, N>, f: &mut impl FnMut(V) -> U) -> Form<U, N> {
        value.map(f)
    }

    fn shape<V: Vector>(value: &Form<V, N>) -> u128 {
        value.shape()
    }
}
