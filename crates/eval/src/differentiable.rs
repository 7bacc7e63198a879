//! Enclosures with two more facts: whether a function is Lipschitz continuous or differentiable.
//!
//! If a function is Lipschitz continuous in a box, bounds of its derivatives limit how much it
//! changes along a segment in the box. Without that fact, bounds of derivatives prove nothing.

use crate::real::Real;
use crate::value_kind::{
    Intervals, Loader, ValueKind, Vector, coordinate_bounds, parameter_bounds,
};
use zeroset_interval::{Enclosure, Exponent, Fact, Interval, Machine, Term};
use zeroset_ir::Axis;
use zeroset_ops::{Class, Law, Op};

/// An enclosure, with facts about how smooth the expression is over the box.
#[derive(Clone, Copy, Debug)]
pub struct Smooth<V> {
    pub value: Enclosure<V>,
    /// Lanes in which the expression is Lipschitz continuous on the box.
    pub lipschitz: Fact<V>,
    /// Lanes in which the expression is differentiable on the box.
    pub differentiable: Fact<V>,
}

/// Enclosures with the facts of [`Smooth`].
#[derive(Clone, Copy, Debug)]
pub struct Smoothness;

/// The value of a coordinate, parameter or constant.
fn leaf<V: Copy>(value: Enclosure<V>) -> Smooth<V> {
    Smooth { value, lipschitz: Fact::True, differentiable: Fact::True }
}

impl ValueKind for Smoothness {
    type Value<V: Vector> = Smooth<V>;
    type Context<V: Vector> = ();

    fn context<T: Real, M: Machine>(_: &mut M, _: &mut impl Loader<M>) {}

    fn coordinate<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        (): (),
        axis: Axis,
    ) -> Smooth<M::V> {
        leaf(coordinate_bounds(m, loader, axis))
    }

    fn parameter<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        number: usize,
    ) -> Smooth<M::V> {
        leaf(parameter_bounds(m, loader, number))
    }

    fn constant<T: Real, M: Machine>(m: &mut M, bounds: Interval) -> Smooth<M::V> {
        leaf(Intervals::constant::<T, M>(m, bounds))
    }

    fn apply<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operands: &[Term<Smooth<M::V>>],
    ) -> Smooth<M::V> {
        let bounds: Vec<_> = operands.iter().map(|term| term.with(term.value.value)).collect();
        let value = Intervals::apply::<T, M>(m, op, &bounds);
        smooth::<T, M>(m, op, operands, value)
    }

    fn apply_twins<T: Real, M: Machine>(
        m: &mut M,
        op: Op,
        operand: &Term<Smooth<M::V>>,
    ) -> Option<[Smooth<M::V>; 2]> {
        let bounds = operand.with(operand.value.value);
        let both = Intervals::apply_twins::<T, M>(m, op, &bounds)?;
        Some(both.map(|value| smooth::<T, M>(m, op, &[*operand], value)))
    }

    fn bounds<T: Real, M: Machine>(
        _: &mut M,
        value: &Term<Smooth<M::V>>,
    ) -> Option<Enclosure<M::V>> {
        Some(value.value.value)
    }

    fn map<V: Vector, U: Vector>(value: &Smooth<V>, f: &mut impl FnMut(V) -> U) -> Smooth<U> {
        Smooth {
            value: value.value.map(f),
            lipschitz: value.lipschitz.map(f),
            differentiable: value.differentiable.map(f),
        }
    }

    fn shape<V: Vector>(value: &Smooth<V>) -> u128 {
        let own = [value.lipschitz.shape(), value.differentiable.shape()];
        own.into_iter().fold(value.value.facts.shape(), |code, fact| 3 * code + fact)
    }
}

/// Adds the two facts to `value`, the result of an operation. In general, a fact holds if it holds
/// for all operands, and for the operation over the operands' bounds. For choices, fallbacks and
/// restrictions, only the operand counts that gives the value.
fn smooth<T: Real, M: Machine>(
    m: &mut M,
    op: Op,
    operands: &[Term<Smooth<M::V>>],
    value: Enclosure<M::V>,
) -> Smooth<M::V> {
    let a = &operands[0];
    let continuous = value.facts.continuous;
    let row = op.row();
    let (own_lipschitz, own_differentiable) = match row.class {
        Class::Negation
        | Class::Sum
        | Class::Product
        | Class::Quotient
        | Class::Square
        | Class::Remainder => both(continuous),
        Class::Function(_) | Class::FunctionOfTwo => {
            let mut away = if row.corners.is_some() { Fact::True } else { Fact::False };
            for &corner in row.corners.unwrap_or_default() {
                let differs = differs::<T, M>(m, a, f64::from(corner));
                away = away.and(m, differs);
            }
            // At its corner, the magnitude has slopes 1 and −1. At the corners of other functions,
            // slopes are infinite.
            let is_magnitude = row.class == Class::Function(Law::Magnitude);
            (if is_magnitude { continuous } else { away }, away)
        }
        Class::Power => match operands[1].exponent {
            Exponent::Integer(_) => both(continuous),
            Exponent::Real => both(above::<T, M>(m, a, 0.0)),
            Exponent::LargeInteger { .. } => both(Fact::False),
        },
        Class::Extremum => (continuous, apart(m, &a.value.value, &operands[1].value.value)),
        Class::Choice => {
            // The condition's bounds hold only at points where the condition is defined.
            let defined = a.value.value.facts.defined;
            let negative = below::<T, M>(m, a, 0.0).and(m, defined);
            let other = at_least::<T, M>(m, a, 0.0).and(m, defined);
            let [b, c] = [operands[1].value, operands[2].value];
            let mut choose = |b: Fact<M::V>, c: Fact<M::V>| {
                let (b, c) = (negative.and(m, b), other.and(m, c));
                b.or(m, c)
            };
            return Smooth {
                value,
                lipschitz: choose(b.lipschitz, c.lipschitz),
                differentiable: choose(b.differentiable, c.differentiable),
            };
        }
        // The result equals the first operand wherever that operand and the result are defined.
        Class::Fallback | Class::Restriction(_) => {
            let defined = value.facts.defined.and(m, a.value.value.facts.defined);
            return Smooth {
                value,
                lipschitz: a.value.lipschitz.and(m, defined),
                differentiable: a.value.differentiable.and(m, defined),
            };
        }
    };
    let (mut lipschitz, mut differentiable) =
        (own_lipschitz.and(m, continuous), own_differentiable.and(m, continuous));
    for operand in operands {
        lipschitz = lipschitz.and(m, operand.value.lipschitz);
        differentiable = differentiable.and(m, operand.value.differentiable);
    }
    Smooth { value, lipschitz, differentiable }
}
fn both<V: Copy>(fact: Fact<V>) -> (Fact<V>, Fact<V>) {
    (fact, fact)
}

/// Lanes in which the operand `a` is above `number` in the whole box.
fn above<T: Real, M: Machine>(m: &mut M, a: &Term<Smooth<M::V>>, number: f64) -> Fact<M::V> {
    if a.range.lo > number {
        return Fact::True;
    }
    let number = m.number(T::FORMAT, -number);
    Fact::Lanes(m.lt(a.value.value.neg_lo, number))
}

/// Lanes in which the operand `a` is at least `number` in the whole box.
fn at_least<T: Real, M: Machine>(m: &mut M, a: &Term<Smooth<M::V>>, number: f64) -> Fact<M::V> {
    if a.range.lo >= number {
        return Fact::True;
    }
    let number = m.number(T::FORMAT, -number);
    Fact::Lanes(m.le(a.value.value.neg_lo, number))
}

/// Lanes in which the operand `a` is below `number` in the whole box.
fn below<T: Real, M: Machine>(m: &mut M, a: &Term<Smooth<M::V>>, number: f64) -> Fact<M::V> {
    if a.range.hi < number {
        return Fact::True;
    }
    let number = m.number(T::FORMAT, number);
    Fact::Lanes(m.lt(a.value.value.hi, number))
}

/// Lanes in which the operand `a` differs from `number` in the whole box.
fn differs<T: Real, M: Machine>(m: &mut M, a: &Term<Smooth<M::V>>, number: f64) -> Fact<M::V> {
    let above = above::<T, M>(m, a, number);
    below::<T, M>(m, a, number).or(m, above)
}

/// Lanes in which the operands `a` and `b` have disjoint bounds.
fn apart<M: Machine>(m: &mut M, a: &Enclosure<M::V>, b: &Enclosure<M::V>) -> Fact<M::V> {
    let mut less = |a: &Enclosure<M::V>, b: &Enclosure<M::V>| {
        // Tests a.hi < b.lo without computing a sum, which would be rounded.
        let lo = m.neg(b.neg_lo);
        Fact::Lanes(m.lt(a.hi, lo))
    };
    let (a_less, b_less) = (less(a, b), less(b, a));
    a_less.or(m, b_less)
}
