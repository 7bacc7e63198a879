//! Values with their gradients, propagated forward through a tape.
//!
//! A tape of a function alone then gives its gradient, too. The derivative of each operation is the
//! one that [`gradient`] has for graphs, evaluated at the operands' values.

use crate::real::{Real, outward};
use crate::value_kind::{Loader, Numbers, ValueKind, Vector};
use zeroset_interval::{Enclosure, Exponent, Interval, Machine, Term};
use zeroset_ir::{Axis, Graph, Node, NodeId, gradient};
use zeroset_ops::{Class, Op};

/// A number and its partial derivatives, without error bounds.
#[derive(Clone, Copy, Debug)]
pub struct Dual<V> {
    pub value: V,
    /// Partial derivatives by x, y and z; `None` if the value depends on none of them.
    pub slopes: Option<[V; 3]>,
}

/// Numbers with their gradients.
#[derive(Clone, Copy, Debug)]
pub struct Duals;

impl<V: Vector> Dual<V> {
    fn constant(value: V) -> Self {
        Self { value, slopes: None }
    }

    fn slopes<T: Real, M: Machine<V = V>>(&self, m: &mut M) -> [V; 3] {
        self.slopes.unwrap_or_else(|| [m.number(T::FORMAT, 0.0); 3])
    }
}

/// Evaluates nodes of a graph whose variables are the operands of an operation.
fn evaluate<T: Real, M: Machine>(
    m: &mut M,
    graph: &Graph,
    roots: &[NodeId],
    operands: &[Term<Dual<M::V>>],
) -> Vec<M::V> {
    let needed = graph.reachable(roots);
    let unused = m.number(T::FORMAT, 0.0);
    let mut terms = vec![
        Term { value: unused, range: Interval::ENTIRE, exponent: Exponent::Real };
        graph.len()
    ];
    for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
        let (value, exponent) = match node {
            Node::Variable(axis) => (operands[*axis as usize].value.value, Exponent::Real),
            Node::Constant(constant) => {
                let bounds = outward::<T>(constant.bounds());
                (Numbers::constant::<T, M>(m, bounds), constant.exponent())
            }
            Node::Parameter(_) => unreachable!("no operand is a parameter"),
            Node::Apply(op, of) => {
                let of: Vec<_> = of.iter().map(|id| terms[id.index()]).collect();
                (Numbers::apply::<T, M>(m, *op, &of), Exponent::Real)
            }
        };
        terms[id.index()] = Term { value, range: Interval::ENTIRE, exponent };
    }
    roots.iter().map(|root| terms[root.index()].value).collect()
}

impl ValueKind for Duals {
    type Value<V: Vector> = Dual<V>;
    type Context<V: Vector> = ();

    fn context<T: Real, M: Machine>(_: &mut M, _: &mut impl Loader<M>) {}

    fn coordinate<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        (): (),
        axis: Axis,
    ) -> Dual<M::V> {
        let slopes = Axis::ALL.map(|other| {
            let slope = if other == axis { 1.0 } else { 0.0 };
            m.number(T::FORMAT, slope)
        });
        Dual { value: loader.input(m, axis as usize), slopes: Some(slopes) }
    }

    fn parameter<T: Real, M: Machine>(
        m: &mut M,
        loader: &mut impl Loader<M>,
        number: usize,
    ) -> Dual<M::V> {
        Dual::constant(Numbers::parameter::<T, M>(m, loader, number))
    }

    fn constant<T: Real, M: Machine>(m: &mut M, bounds: Interval) -> Dual<M::V> {
        Dual::constant(Numbers::constant::<T, M>(m, bounds))
    }

    fn apply<T: Real, M: Machine>(m: &mut M, op: Op, operands: &[Term<Dual<M::V>>]) -> Dual<M::V> {
        let numbers: Vec<_> = operands.iter().map(|term| term.with(term.value.value)).collect();
        let value = Numbers::apply::<T, M>(m, op, &numbers);
        if operands.iter().all(|operand| operand.value.slopes.is_none()) {
            return Dual::constant(value);
        }
        // A slope that is not chosen may be infinite, so slopes are chosen like values.
        let choice = match (op.row().class, &numbers[..]) {
            (Class::Extremum, [a, b]) if op == Op::Min => Some((m.lt(a.value, b.value), [0, 1])),
            (Class::Extremum, [a, b]) => Some((m.lt(b.value, a.value), [0, 1])),
            (Class::Choice, [a, ..]) => {
                let zero = m.number(T::FORMAT, 0.0);
                Some((m.lt(a.value, zero), [1, 2]))
            }
            // The second operand stands for the first where that has no value.
            (Class::Fallback, [a, _]) => Some((m.eq(a.value, a.value), [0, 1])),
            _ => None,
        };
        if let Some((mask, chosen)) = choice {
            let [a, b] = chosen.map(|operand| operands[operand].value.slopes::<T, M>(m));
            let slopes = std::array::from_fn(|axis| m.select(mask, a[axis], b[axis]));
            return Dual { value, slopes: Some(slopes) };
        }
        let mut graph = Graph::new();
        let variables: Vec<NodeId> = operands
            .iter()
            .zip(Axis::ALL)
            .map(|(operand, axis)| match operand.exponent {
                // Only powers distinguish exponents, as in stencils.
                Exponent::Integer(n) if op == Op::Pow => graph.integer(n.into()),
                _ => graph.variable(axis),
            })
            .collect();
        let root = graph.apply(op, &variables);
        let derivatives = gradient(&mut graph, root);
        let derivatives = evaluate::<T, M>(m, &graph, &derivatives, operands);
        let mut sum: Option<[M::V; 3]> = None;
        for (operand, derivative) in operands.iter().zip(derivatives) {
            let Some(slopes) = operand.value.slopes else { continue };
            sum = Some(std::array::from_fn(|axis| match sum {
                Some(sum) => m.mul_add(derivative, slopes[axis], sum[axis]),
                None => m.mul(derivative, slopes[axis]),
            }));
        }
        Dual { value, slopes: sum }
    }

    fn apply_twins<T: Real, M: Machine>(
        _: &mut M,
        _: Op,
        _: &Term<Dual<M::V>>,
    ) -> Option<[Dual<M::V>; 2]> {
        None
    }

    fn bounds<T: Real, M: Machine>(_: &mut M, _: &Term<Dual<M::V>>) -> Option<Enclosure<M::V>> {
        None
    }

    fn map<V: Vector, U: Vector>(value: &Dual<V>, f: &mut impl FnMut(V) -> U) -> Dual<U> {
        Dual { value: f(value.value), slopes: value.slopes.map(|slopes| slopes.map(&mut *f)) }
    }

    fn shape<V: Vector>(value: &Dual<V>) -> u128 {
        u128::from(value.slopes.is_some())
    }
}
