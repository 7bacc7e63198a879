//! A graph laid out for evaluation. Each node becomes a step, after its operands. Each step has
//! bounds that its value never leaves while inputs meet the tape's assumptions.

use crate::branches::{CHOICES, SELECTOR};
use crate::lanes::Lanes;
use crate::query::{Query, QueryContext, QueryValue};
use crate::real::{Real, outward};
use crate::value_kind::{Loader, ValueKind};
use smallvec::SmallVec;
use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::Arc;
use zeroset_interval::{
    Enclosure, Exponent, Fact, Format, Interval, Machine, Operand, Software, Term,
    Vector128 as Vector,
};
use zeroset_ir::{Axis, Graph, Node, NodeId};
use zeroset_ops::Op;

/// Bounds that code relies on. All boxes and parameters must be within them.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumptions {
    /// Bounds of the coordinates x, y and z.
    pub domain: [Interval; 3],
    /// Bounds of each parameter, indexed by the parameter's number.
    pub parameters: Vec<Interval>,
}

impl Assumptions {
    /// Assumptions that bound neither the coordinates nor any of `parameters` parameters.
    pub fn none(parameters: usize) -> Self {
        Self { domain: [Interval::ENTIRE; 3], parameters: vec![Interval::ENTIRE; parameters] }
    }

    /// Returns the same bounds with ends in `T`, rounded outward.
    fn outward<T: Real>(&self) -> Self {
        Self {
            domain: self.domain.map(outward::<T>),
            parameters: self.parameters.iter().map(|bounds| outward::<T>(*bounds)).collect(),
        }
    }
}

/// Indices of a step's operands.
pub type StepOperands = SmallVec<[usize; 3]>;

/// One step of a [`Tape`].
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Reads a coordinate.
    Coordinate(Axis),
    /// Reads the parameter with this number.
    Parameter(u32),
    /// A constant: its bounds, and which kind of exponent it would be.
    Constant(Interval, Exponent),
    /// An operation on earlier steps.
    Apply(Op, StepOperands),
}

impl Step {
    /// The step's kind as an exponent.
    pub fn exponent(&self) -> Exponent {
        match self {
            Self::Constant(_, exponent) => *exponent,
            Self::Coordinate(_) | Self::Parameter(_) | Self::Apply(..) => Exponent::Real,
        }
    }
}

/// The steps that compute one or more expressions over batches of `T`.
#[derive(Clone, Debug)]
pub struct Tape<T: Real = f32> {
    steps: Vec<Step>,
    ranges: Vec<Interval>,
    outputs: Vec<usize>,
    /// Bounds that the steps rely on. Their ends are numbers of `T`.
    assumptions: Arc<Assumptions>,
    format: PhantomData<T>,
    /// True if the last parameters select branches ([`Tape::branches`]).
    is_by_branches: bool,
    /// Whether ranges were made [coarse](Tape::coarse).
    is_coarse: bool,
}

impl<T: Real> Tape<T> {
    /// Lays out the steps that `roots` need. Computes the range of each step under `assumptions`.
    ///
    /// # Panics
    /// If a parameter has no bounds in `assumptions`.
    pub fn new(graph: &Graph, roots: &[NodeId], assumptions: &Assumptions) -> Self {
        let needed = graph.reachable(roots);
        let mut place = vec![usize::MAX; graph.len()];
        let mut tape = Self {
            steps: Vec::new(),
            ranges: Vec::new(),
            outputs: Vec::new(),
            assumptions: Arc::new(assumptions.outward::<T>()),
            format: PhantomData,
            is_by_branches: false,
            is_coarse: false,
        };
        let mut values: Vec<Operand<Vector>> = Vec::new();
        for (id, node) in graph.iter().filter(|(id, _)| needed[id.index()]) {
            let step = match node {
                Node::Variable(axis) => Step::Coordinate(*axis),
                Node::Parameter(number) => Step::Parameter(*number),
                Node::Constant(value) => {
                    Step::Constant(outward::<T>(value.bounds()), value.exponent())
                }
                Node::Apply(op, operands) => {
                    Step::Apply(*op, operands.iter().map(|id| place[id.index()]).collect())
                }
            };
            let operand = range_of::<T>(&step, &values, assumptions);
            place[id.index()] = tape.steps.len();
            tape.steps.push(step);
            tape.ranges.push(operand.range);
            values.push(operand);
        }
        tape.outputs = roots.iter().map(|root| place[root.index()]).collect();
        tape
    }

    /// Returns the same steps with wider ranges, whose ends are among a few numbers. So few
    /// different cases of a rule arise over all tapes, and each is compiled once for all. Bounds
    /// stay rigorous, but may be wider.
    #[must_use]
    pub fn coarse(mut self) -> Self {
        if self.is_coarse {
            return self;
        }
        self.is_coarse = true;
        self.ranges.iter_mut().for_each(|range| *range = coarse::<T>(*range));
        self
    }

    /// Widens the range of a step to one that contains it. Returns whether it was another.
    pub(crate) fn widen(&mut self, index: usize, range: Interval) -> bool {
        let wider = self.ranges[index].hull(range);
        std::mem::replace(&mut self.ranges[index], wider) != wider
    }

    /// Returns whether another tape has the same steps, and constants within the bounds of this
    /// tape's constants. Then a [`Selection`](crate::Selection) of this tape is also valid for the
    /// other.
    pub fn has_steps_of<U: Real>(&self, other: &Tape<U>) -> bool {
        let is_same = |(own, step): (&Step, &Step)| match (own, step) {
            (Step::Constant(bounds, exponent), Step::Constant(other, as_other)) => {
                bounds.lo <= other.lo && other.hi <= bounds.hi && exponent == as_other
            }
            _ => own == step,
        };
        self.steps.len() == other.steps.len()
            && self.steps.iter().zip(&other.steps).all(is_same)
            && self.outputs == other.outputs
    }

    /// Returns whether the ranges are [coarse](Self::coarse).
    pub fn is_coarse(&self) -> bool {
        self.is_coarse
    }

    /// Lays out steps that find where `roots` may all be 0, branch by branch. The parameters are
    /// followed by three that select branches. The tape can answer only
    /// [`FindZerosInBranch`](crate::FindZerosInBranch).
    ///
    /// `None` if the last root does not jump.
    ///
    /// # Panics
    /// If there is no root, or a parameter has no bounds in `assumptions`.
    pub fn branches(graph: &Graph, roots: &[NodeId], assumptions: &Assumptions) -> Option<Self> {
        let mut assumptions = assumptions.clone();
        assumptions.parameters.extend([SELECTOR; CHOICES]);
        let tape = Self::new(graph, roots, &assumptions);
        tape.last_output_splits().then_some(Self { is_by_branches: true, ..tape })
    }

    /// Returns whether this tape is evaluated branch by branch ([`Tape::branches`]).
    pub fn is_by_branches(&self) -> bool {
        self.is_by_branches
    }

    /// The steps in order: operands precede the steps that use them.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Bounds of a step's value in every sample.
    pub fn range(&self, index: usize) -> Interval {
        self.ranges[index]
    }

    /// Indices of the steps whose values are the outputs.
    pub fn outputs_at(&self) -> &[usize] {
        &self.outputs
    }

    /// The kind of the last of `operands` as an exponent.
    pub(crate) fn exponent(&self, operands: &[usize]) -> Exponent {
        operands.last().map_or(Exponent::Real, |&i| self.steps[i].exponent())
    }

    /// Number of expressions that the tape computes.
    pub fn outputs(&self) -> usize {
        if self.is_by_branches { 1 } else { self.outputs.len() }
    }

    /// The bounds that the steps rely on, rounded outward to `T`.
    pub fn assumptions(&self) -> &Assumptions {
        &self.assumptions
    }

    /// Number of parameters that a binding must have, used or not.
    pub fn parameters(&self) -> usize {
        self.assumptions.parameters.len()
    }

    /// Number of operations, that is of steps other than coordinates, parameters and constants.
    pub fn operations(&self) -> usize {
        self.steps.iter().filter(|step| matches!(step, Step::Apply(..))).count()
    }

    /// Returns whether the range of the first output's value is finite.
    pub fn is_bounded(&self) -> bool {
        T::is_finite(self.ranges[self.outputs[0]])
    }

    /// Computes all outputs on `m`, as the values that query `Q` needs.
    ///
    /// # Panics
    /// If the tape is made by [`Tape::branches`].
    pub fn evaluate<Q: Query, M: Machine>(
        &self,
        m: &mut M,
        loader: &mut impl Loader<M>,
        context: QueryContext<Q, M>,
    ) -> Vec<QueryValue<Q, M>> {
        assert!(!self.is_by_branches, "branches only find zeros");
        let mut terms: Vec<Term<QueryValue<Q, M>>> = Vec::with_capacity(self.steps.len());
        let mut twins = Twins(HashMap::new());
        for (step, &range) in self.steps.iter().zip(&self.ranges) {
            let value = match step {
                Step::Coordinate(axis) => Q::Kind::coordinate::<T, M>(m, loader, context, *axis),
                Step::Parameter(number) => Q::Kind::parameter::<T, M>(m, loader, *number as usize),
                Step::Constant(bounds, _) => Q::Kind::constant::<T, M>(m, *bounds),
                Step::Apply(op, operands) => {
                    let both = || {
                        let operand = &terms[operands[0]];
                        if self.is_coarse {
                            return None;
                        }
                        Q::Kind::apply_twins::<T, M>(m, *op, operand)
                    };
                    if let Some(value) = twins.take(*op, operands[0], both) {
                        value
                    } else {
                        let operands: Vec<_> = operands.iter().map(|&i| terms[i]).collect();
                        Q::Kind::apply::<T, M>(m, *op, &operands)
                    }
                }
            };
            let value = if self.is_coarse { Q::Kind::settled::<T, M>(m, value) } else { value };
            terms.push(Term { value, range, exponent: step.exponent() });
        }
        self.outputs.iter().map(|&output| terms[output].value).collect()
    }

    /// Returns the [coarse](Tape::coarse) range of an operation on operands with these ranges and
    /// kinds of exponent.
    pub fn coarse_range(op: Op, operands: &[(Interval, Exponent)]) -> Interval {
        let lanes = |end: f64| T::load(&Lanes::splat(T::nearest(end)), 0);
        let values: Vec<_> = operands
            .iter()
            .map(|&(range, exponent)| {
                let value = Enclosure::total(lanes(-range.lo), lanes(range.hi));
                Operand { value, range, exponent }
            })
            .collect();
        let step = Step::Apply(op, (0..values.len()).collect());
        coarse::<T>(range_of::<T>(&step, &values, &Assumptions::none(0)).range)
    }
}

/// Lanes in which `value` may be 0.
pub(crate) fn may_vanish<M: Machine>(
    m: &mut M,
    format: Format,
    value: &Enclosure<M::V>,
) -> Fact<M::V> {
    let zero = m.number(format, 0.0);
    let least = m.min(value.neg_lo, value.hi);
    let holds_zero = Fact::Lanes(m.le(zero, least));
    let somewhere = value.facts.nowhere.not(m, format);
    holds_zero.and(m, somewhere)
}

/// Values that were computed together with their [twin](zeroset_ops::OpRow::twin) and are not used
/// yet. A key is an operation and the step of its operand.
struct Twins<V>(HashMap<(Op, usize), V>);

impl<V> Twins<V> {
    /// Returns the value of `op` for an operand. If the value is not stored, `both` computes it and
    /// its twin's value, which is then stored. `None` if the operation is not computed with a twin.
    fn take(&mut self, op: Op, operand: usize, both: impl FnOnce() -> Option<[V; 2]>) -> Option<V> {
        let twin = op.row().twin?;
        if let Some(value) = self.0.remove(&(op, operand)) {
            return Some(value);
        }
        let [value, other] = both()?;
        self.0.insert((twin, operand), other);
        Some(value)
    }
}

/// Limit on how far an elementary function's bounds over part of a box may exceed its bounds over
/// the whole box, as a fraction of the bound. They may exceed them because approximations are not
/// exactly monotone. The limit is far above twice the error of each bound.
const NOT_MONOTONE: f64 = 1.0 / 1_048_576.0;

/// Encloses a step over all values that `assumptions` allow. By isotone rules, narrower operands
/// give no wider bounds. So the result contains the step's value in every kernel.
fn range_of<T: Real>(
    step: &Step,
    values: &[Operand<Vector>],
    assumptions: &Assumptions,
) -> Operand<Vector> {
    let given = |bounds: Interval| {
        let bounds = outward::<T>(bounds);
        let lanes = |end: f64| T::load(&Lanes::splat(T::nearest(end)), 0);
        Operand::new(Enclosure::total(lanes(-bounds.lo), lanes(bounds.hi)), bounds)
    };
    match step {
        Step::Coordinate(axis) => given(assumptions.domain[*axis as usize]),
        Step::Parameter(number) => given(assumptions.parameters[*number as usize]),
        Step::Constant(bounds, exponent) => Operand { exponent: *exponent, ..given(*bounds) },
        Step::Apply(op, operands) => {
            let operands: Vec<_> = operands.iter().map(|&i| values[i]).collect();
            let value = Software::enclose(T::FORMAT, *op, &operands);
            // The subtraction and the addition of 0 turn a zero of either sign into +0.
            let (lo, hi) = (0.0 - first::<T>(value.neg_lo), 0.0 + first::<T>(value.hi));
            let nowhere =
                T::bits(value.facts.nowhere.mask(&mut Software::new(), T::FORMAT)) & 1 == 1;
            let range = match Interval::new(lo, hi) {
                Some(range) if !nowhere => {
                    op.row().excess.map_or(range, |[f32, f64]| match T::FORMAT {
                        Format::F32 => inflate(range, f64::from(f32::from_bits(1)) * f32 as f64),
                        Format::F64 => inflate(range, f64::from_bits(f64)),
                    })
                }
                _ => Interval::ENTIRE,
            };
            let bounds = given(range);
            let Enclosure { neg_lo, hi, .. } = bounds.value;
            bounds.with(Enclosure { neg_lo, hi, ..value })
        }
    }
}

/// Widens a range so that each end is among a few numbers.
fn coarse<T: Real>(range: Interval) -> Interval {
    let least = match T::FORMAT {
        Format::F32 => f64::from(f32::from_bits(1)),
        Format::F64 => f64::from_bits(1),
    };
    // Rules distinguish signs, whether a bound is finite, and a few magnitudes.
    let magnitudes = [least, 1.0, 1_048_576.0, T::LARGEST.into(), f64::INFINITY];
    let ends = magnitudes.iter().map(|end| -end).rev().chain([0.0]).chain(magnitudes);
    let lo = ends.clone().filter(|end| *end <= range.lo).fold(f64::NEG_INFINITY, f64::max);
    let hi = ends.filter(|end| *end >= range.hi).fold(f64::INFINITY, f64::min);
    Interval { lo, hi }
}

fn first<T: Real>(vector: Vector) -> f64 {
    let mut lanes = Lanes::default();
    T::store(vector, 0, &mut lanes);
    lanes[0].into()
}

/// Widens a range so that it contains the bounds over a part of the box, which may exceed it. Each
/// end moves by a fraction of its magnitude, but at least by `excess`, the largest error of an
/// enclosure below the normal numbers. An end at 0 stays, because no approximation changes the sign
/// of a value.
fn inflate(range: Interval, excess: f64) -> Interval {
    let out = |end: f64, sign: f64| match end {
        0.0 => end,
        _ => end + sign * (end.abs() * NOT_MONOTONE).max(excess),
    };
    Interval { lo: out(range.lo, -1.0), hi: out(range.hi, 1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_ir::Constant;

    #[test]
    fn ends_below_the_normal_numbers_are_widened_too() {
        let excess = f64::from_bits(4);
        for bits in [1, 3, 1 << 10, 1 << 19, 1 << 40] {
            let end = f64::from_bits(bits);
            let Interval { lo, hi } = inflate(Interval { lo: end, hi: end }, excess);
            assert!(lo < end && end < hi && hi - end >= excess, "{end:e}: {lo:e} {hi:e}");
        }
        assert_eq!(inflate(Interval::ZERO, excess), Interval::ZERO);
    }

    #[test]
    fn tapes_of_both_formats_have_the_same_steps_and_others_do_not() {
        let mut graph = Graph::new();
        let [x, y, _] = Axis::ALL.map(|axis| graph.variable(axis));
        let tenth = graph.constant(Constant::decimal("0.1").expect("a number"));
        let [sum, difference] = [Op::Add, Op::Sub].map(|op| graph.apply(op, &[x, tenth]));
        let other = graph.apply(Op::Add, &[y, tenth]);
        let assumptions = Assumptions::none(0);
        let single = |root| Tape::<f32>::new(&graph, &[root], &assumptions);
        let double = |root| Tape::<f64>::new(&graph, &[root], &assumptions);
        assert!(single(sum).has_steps_of(&double(sum)));
        for another in [difference, other, x, tenth] {
            assert!(!single(sum).has_steps_of(&double(another)));
        }
        // The tape of `f32` has the wider constants.
        assert!(!double(sum).has_steps_of(&single(sum)));
        // The steps are the same, but the values are not.
        let both = |roots| Tape::<f64>::new(&graph, roots, &assumptions);
        assert!(!both(&[sum, x]).has_steps_of(&both(&[x, sum])));
    }
}
