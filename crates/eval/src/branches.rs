//! Functions that jump, evaluated branch by branch.
//!
//! At a jump, the enclosure of a function is the hull of both branches. It contains 0 even if
//! neither branch does. The branches together cover the box, so what is proven on each is proven on
//! the box. The interval rules define which operations have branches.
//!
//! In each box, the first three steps that jump make a choice each, in the order of the tape. A
//! kernel evaluates one combination of choices, which its last three parameters select. Steps that
//! jump after all choices are made are enclosed over the whole box.

use crate::batch::{Boxes, BranchSigns};
use crate::binding::Binding;
use crate::lanes::LANES;
use crate::query::{FindZerosInBranch, Kernel, eval_lanes};
use crate::real::Real;
use crate::shorten::LaneSet;
use crate::tape::{Step, Tape, may_vanish};
use crate::value_kind::{
    Intervals, Loader, PARAMETER_QUANTITIES, ValueKind, coordinate_bounds, parameter_bounds,
};
use zeroset_interval::{
    Branch, Claims, Enclosure, Fact, Format, Interval, Machine, Operand, Split, enclose,
    enclose_branch,
};
use zeroset_ops::Op;

/// Most choices in a box.
pub(crate) const CHOICES: usize = 3;
/// Number of combinations of choices.
const COMBINATIONS: usize = 1 << CHOICES;

/// Returns a binding for each combination of choices of a [tape of branches](Tape::branches), with
/// `values` for its other parameters. Choice k takes the second branch if bit k of the
/// combination's number is set.
pub fn branch_bindings<T: Real>(values: &[Interval]) -> impl Iterator<Item = Binding<T>> {
    let selector = |combination: u32, choice| {
        let taken = f64::from(combination >> choice & 1);
        Interval { lo: taken, hi: taken }
    };
    (0..COMBINATIONS as u32).map(move |combination| {
        let selectors = (0..CHOICES).map(|choice| selector(combination, choice));
        Binding::new(&values.iter().copied().chain(selectors).collect::<Vec<_>>())
    })
}

/// The range of a parameter that selects a branch.
pub(crate) const SELECTOR: Interval = Interval { lo: 0.0, hi: 1.0 };

impl<T: Real> Tape<T> {
    /// Returns whether an operation of the tape may jump or have a pole.
    pub fn may_jump(&self) -> bool {
        (0..self.steps().len()).any(|index| self.split(index) != Split::Whole)
    }

    /// Returns how a step splits boxes.
    fn split(&self, index: usize) -> Split {
        match &self.steps()[index] {
            Step::Apply(op, operands) => {
                let ranges: Vec<Interval> = operands.iter().map(|&i| self.range(i)).collect();
                Split::of(*op, &ranges, self.exponent(operands))
            }
            Step::Coordinate(_) | Step::Parameter(_) | Step::Constant(..) => Split::Whole,
        }
    }

    /// Returns whether the last output depends on a step that splits boxes.
    pub(crate) fn last_output_splits(&self) -> bool {
        let mut splits: Vec<bool> = Vec::with_capacity(self.steps().len());
        for (index, step) in self.steps().iter().enumerate() {
            let Step::Apply(_, operands) = step else {
                splits.push(false);
                continue;
            };
            let inherited = operands.iter().any(|&i| splits[i]);
            splits.push(inherited || self.split(index) != Split::Whole);
        }
        self.outputs_at().last().is_some_and(|&last| splits[last])
    }

    /// Encloses the outputs in the combination of branches that the tape's last parameters select.
    pub(crate) fn enclose_in_branch<M: Machine>(
        &self,
        m: &mut M,
        loader: &mut impl Loader<M>,
    ) -> InBranch<M::V> {
        let mut choices =
            Choices { made: [Fact::False; CHOICES], first_parameter: self.parameters() - CHOICES };
        let mut values: Vec<Operand<M::V>> = Vec::with_capacity(self.steps().len());
        for (index, step) in self.steps().iter().enumerate() {
            let value = match step {
                Step::Coordinate(axis) => coordinate_bounds(m, loader, *axis),
                Step::Parameter(number) => parameter_bounds(m, loader, *number as usize),
                Step::Constant(bounds, _) => Intervals::constant::<T, M>(m, *bounds),
                Step::Apply(op, operands) => {
                    let operands: Vec<_> = operands.iter().map(|&i| values[i]).collect();
                    let split = self.split(index);
                    choices.enclose::<T, M>(m, loader, *op, &operands, split)
                }
            };
            let (range, exponent) = (self.range(index), step.exponent());
            values.push(Operand { value, range, exponent });
        }
        let outputs = self.outputs_at().iter().map(|&output| values[output].value).collect();
        InBranch { outputs, made: choices.made }
    }
}

/// The outputs of a tape in one combination of branches.
pub(crate) struct InBranch<V> {
    pub outputs: Vec<Enclosure<V>>,
    /// For each choice, the lanes in which it is made.
    pub made: [Fact<V>; CHOICES],
}

impl<V: Copy> InBranch<V> {
    /// Lanes in which all outputs may be 0 together.
    pub fn possible<M: Machine<V = V>>(&self, m: &mut M, format: Format) -> Fact<V> {
        self.outputs.iter().fold(Fact::True, |all, output| {
            let zero = may_vanish(m, format, output);
            all.and(m, zero)
        })
    }

    /// Lanes in which the first output is below 0 everywhere, and lanes in which it is nowhere 0 or
    /// below.
    pub fn sides<M: Machine<V = V>>(&self, m: &mut M, format: Format) -> [Fact<V>; 2] {
        let Enclosure { neg_lo, hi, facts } = self.outputs[0];
        let zero = m.number(format, 0.0);
        let (below, above) = (Fact::Lanes(m.lt(hi, zero)), Fact::Lanes(m.lt(neg_lo, zero)));
        [below.and(m, facts.defined), above.or(m, facts.nowhere)]
    }

    /// The choices that are made, as a sum of powers of two per lane: 2ᵏ for choice k.
    pub fn choices<M: Machine<V = V>>(&self, m: &mut M, format: Format) -> V {
        let mut sum = m.number(format, 0.0);
        for (choice, made) in self.made.into_iter().enumerate() {
            let power = m.number(format, f64::from(1_u32 << choice));
            let mask = made.mask(m, format);
            let own = m.and(mask, power);
            sum = m.add(sum, own);
        }
        sum
    }
}

/// The choices that the steps of a tape have made so far.
struct Choices<V> {
    /// For each choice, the lanes in which it is made.
    made: [Fact<V>; CHOICES],
    /// Number of the parameter that selects the branch of the first choice.
    first_parameter: usize,
}

impl<V: Copy> Choices<V> {
    /// Encloses an operation, in its selected branch where it jumps and a choice is left.
    fn enclose<T: Real, M: Machine<V = V>>(
        &mut self,
        m: &mut M,
        loader: &mut impl Loader<M>,
        op: Op,
        operands: &[Operand<V>],
        split: Split,
    ) -> Enclosure<V> {
        let whole = enclose(m, T::FORMAT, op, operands);
        if split == Split::Whole || matches!(whole.facts.continuous, Fact::True) {
            return whole;
        }
        let part = |m: &mut M, branch| enclose_branch(m, T::FORMAT, op, operands, branch);
        let jumps = whole.facts.continuous.not(m, T::FORMAT);
        let low = part(m, Branch::Low);
        let mut rest = part(m, Branch::Rest);
        // A pole takes only the last choice, so that jumps have more. The rational form has cleared
        // most poles, and at the other poles the function may not jump.
        let first = if split == Split::AtPole { CHOICES - 1 } else { 0 };
        let Chosen { made, second } = self.choose::<T, M>(m, loader, jumps, first);
        if split == Split::AtBothJumps {
            let [middle, high] = [Branch::Middle, Branch::High].map(|branch| part(m, branch));
            let jumps = rest.facts.continuous.not(m, T::FORMAT);
            let jumps = jumps.and(m, second);
            let again = self.choose::<T, M>(m, loader, jumps, first);
            let upper = pick(m, T::FORMAT, again.second, &high, &middle);
            rest = pick(m, T::FORMAT, again.made, &upper, &rest);
        }
        let chosen = pick(m, T::FORMAT, second, &rest, &low);
        pick(m, T::FORMAT, made, &chosen, &whole)
    }

    /// Makes a choice in the lanes of `jumps` that have one left, the first of which is `first`.
    fn choose<T: Real, M: Machine<V = V>>(
        &mut self,
        m: &mut M,
        loader: &mut impl Loader<M>,
        jumps: Fact<V>,
        first: usize,
    ) -> Chosen<V> {
        let mut chosen = Chosen { made: Fact::False, second: Fact::False };
        let mut left = jumps;
        for choice in first..CHOICES {
            let free = self.made[choice].not(m, T::FORMAT);
            let own = left.and(m, free);
            if matches!(own, Fact::False) {
                continue;
            }
            let quantity = PARAMETER_QUANTITIES * (self.first_parameter + choice) + 1;
            let selector = loader.parameter(m, quantity);
            let zero = m.number(T::FORMAT, 0.0);
            let is_second = Fact::Lanes(m.lt(zero, selector));
            let second = own.and(m, is_second);
            chosen.second = chosen.second.or(m, second);
            chosen.made = chosen.made.or(m, own);
            self.made[choice] = self.made[choice].or(m, own);
            let others = own.not(m, T::FORMAT);
            left = left.and(m, others);
        }
        chosen
    }
}

/// The lanes in which a step makes a choice, and the lanes in which it takes the second branch.
struct Chosen<V> {
    made: Fact<V>,
    second: Fact<V>,
}

/// A test, branch by branch, of boxes in which a function may jump.
pub struct BranchTest<T: Real> {
    /// A kernel for each combination of choices.
    combinations: Vec<Box<dyn Kernel<FindZerosInBranch, T>>>,
    is_solid: bool,
}

impl<T: Real> BranchTest<T> {
    /// Creates a test from the code of a [tape of branches](Tape::branches). `bind` binds `values`
    /// to the tape's parameters, followed by those that select branches.
    ///
    /// # Errors
    /// The first error of `bind`.
    pub fn new<E>(
        values: &[Interval],
        is_solid: bool,
        bind: impl FnMut(Binding<T>) -> Result<Box<dyn Kernel<FindZerosInBranch, T>>, E>,
    ) -> Result<Self, E> {
        let combinations = branch_bindings(values).map(bind).collect::<Result<_, E>>()?;
        Ok(Self { combinations, is_solid })
    }

    /// Returns those of `lanes` whose boxes are proven to hold no zero of the function. For a
    /// solid: whose boxes are proven to hold no point of its boundary. There the function's sign
    /// must be the same on all branches, since the boundary includes places where it changes sign
    /// at a jump.
    pub fn proven_empty(&self, boxes: &Boxes<T>, lanes: LaneSet) -> LaneSet {
        let [a, b] = self.proven_sides(boxes, lanes);
        a | b
    }

    /// For a solid, returns those of `lanes` in whose boxes the function is defined and below 0,
    /// and those in whose boxes it is above 0 or undefined. For an equation, the first are those
    /// without a zero.
    pub(crate) fn proven_sides(&self, boxes: &Boxes<T>, lanes: LaneSet) -> [LaneSet; 2] {
        // The lanes for which a combination must be evaluated. In other lanes, a choice by which it
        // differs from an earlier combination is not made.
        let mut needed = [0; COMBINATIONS];
        needed[0] = lanes;
        let mut proven = if self.is_solid { [lanes, lanes] } else { [lanes, 0] };
        for (combination, kernel) in self.combinations.iter().enumerate() {
            let asked = needed[combination] & (proven[0] | proven[1]);
            if asked == 0 {
                continue;
            }
            let signs = eval_lanes(&**kernel, boxes, asked);
            let found =
                if self.is_solid { [signs.below, signs.above] } else { [!signs.possible, 0] };
            for (proven, found) in proven.iter_mut().zip(found) {
                *proven &= found | !asked;
            }
            let last = (usize::BITS - combination.leading_zeros()) as usize;
            for choice in last..CHOICES {
                needed[combination | 1 << choice] = asked & signs.made(choice);
            }
        }
        proven
    }
}

impl<T: Real> BranchSigns<T> {
    /// Lanes in which a choice is made.
    fn made(&self, choice: usize) -> LaneSet {
        let is_made = |lane: &usize| {
            let choices: f64 = self.choices[*lane].into();
            choices as u32 >> choice & 1 == 1
        };
        (0..LANES).filter(is_made).map(|lane| 1 << lane).sum()
    }
}

/// Takes `whole` in the lanes of `mask`, else `part`.
fn pick<M: Machine>(
    m: &mut M,
    format: Format,
    mask: Fact<M::V>,
    whole: &Enclosure<M::V>,
    part: &Enclosure<M::V>,
) -> Enclosure<M::V> {
    let lanes = match mask {
        Fact::False => return *part,
        Fact::True => return *whole,
        Fact::Lanes(lanes) => lanes,
    };
    let others = mask.not(m, format);
    let mut fact = |whole: Fact<M::V>, part: Fact<M::V>| {
        let (whole, part) = (whole.and(m, mask), part.and(m, others));
        whole.or(m, part)
    };
    let facts = Claims {
        nowhere: fact(whole.facts.nowhere, part.facts.nowhere),
        defined: fact(whole.facts.defined, part.facts.defined),
        continuous: fact(whole.facts.continuous, part.facts.continuous),
    };
    Enclosure {
        neg_lo: m.select(lanes, whole.neg_lo, part.neg_lo),
        hi: m.select(lanes, whole.hi, part.hi),
        facts,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Assumptions, Reference};
    use std::convert::Infallible;
    use zeroset_ir::{Axis, Graph, NodeId};
    use zeroset_ops::Op;

    #[derive(Default)]
    struct GraphBuilder(Graph);

    impl GraphBuilder {
        fn of(&mut self, op: Op, operands: &[NodeId]) -> NodeId {
            self.0.apply(op, operands)
        }

        fn plus(&mut self, a: NodeId, n: i64) -> NodeId {
            let n = self.0.integer(n);
            self.of(Op::Add, &[a, n])
        }

        fn weighted(&mut self, a: NodeId, n: i64, sum: NodeId) -> NodeId {
            let n = self.0.integer(n);
            let product = self.of(Op::Mul, &[a, n]);
            self.of(Op::Add, &[product, sum])
        }

        fn branches(&self, root: NodeId) -> Option<Tape> {
            Tape::branches(&self.0, &[root], &Assumptions::none(0))
        }

        /// Returns whether `root` is proven to have no zero for x, y and z in `ranges`.
        fn is_empty(&self, root: NodeId, is_solid: bool, ranges: [[f32; 2]; 3]) -> bool {
            let tape = self.branches(root).expect("it jumps");
            let ends = ranges.map(|[lo, hi]| Interval { lo: lo.into(), hi: hi.into() });
            let bind = |binding| {
                let kernel = Reference::<FindZerosInBranch>::new(tape.clone(), binding);
                Ok::<_, Infallible>(Box::new(kernel) as Box<_>)
            };
            let Ok(test) = BranchTest::new(&[], is_solid, bind);
            test.proven_empty(&Boxes::around(&[ends])[0], 1) == 1
        }
    }

    /// Seven steps may jump, and three of them do in this box. The fourth jumps in only one branch
    /// of the second, so the seventh makes the second choice in one branch, and the third in the
    /// other.
    #[test]
    fn the_steps_that_jump_in_a_box_choose() {
        let mut builder = GraphBuilder::default();
        let [x, y, z] = Axis::ALL.map(|axis| builder.0.variable(axis));
        let still = |builder: &mut GraphBuilder, n| {
            let sum = builder.plus(y, n);
            builder.of(Op::Floor, &[sum])
        };
        let first = still(&mut builder, 0);
        let second = builder.of(Op::Floor, &[x]);
        let third = still(&mut builder, 1);
        let product = builder.of(Op::Mul, &[second, z]);
        let fourth = builder.of(Op::Floor, &[product]);
        let fifth = still(&mut builder, 2);
        let sixth = still(&mut builder, 3);
        let two = builder.0.integer(2);
        let falling = builder.of(Op::Sub, &[two, z]);
        let seventh = builder.of(Op::Floor, &[falling]);
        let mut sum = seventh;
        for (n, jump) in
            [(0, first), (100, second), (0, third), (10, fourth), (0, fifth), (0, sixth)]
        {
            sum = builder.weighted(jump, n, sum);
        }
        let near = [[0.875, 1.125], [0.5, 0.5], [0.875, 1.125]];
        // The root is 0 near x = 1.1, z = 0.9, where the sum is 100·1 + 10·0 + 1.
        let root = builder.plus(sum, -101);
        assert!(!builder.is_empty(root, false, near));
        // The sum takes the values 0, 1, 101 and 110 (and 111 at z = 1).
        for (value, is_taken) in [(0, true), (1, true), (50, false), (110, true), (115, false)] {
            let root = builder.plus(sum, -value);
            assert_eq!(!builder.is_empty(root, false, near), is_taken, "{value}");
        }
    }

    #[test]
    fn what_does_not_jump_has_no_branches() {
        let mut builder = GraphBuilder::default();
        let [x, y, _] = Axis::ALL.map(|axis| builder.0.variable(axis));
        let smooth = builder.of(Op::Add, &[x, y]);
        assert!(builder.branches(smooth).is_none());
        // Only the last of several roots decides whether a tape has branches.
        let jump = builder.of(Op::Floor, &[x]);
        let tape =
            |roots: &[NodeId]| Tape::<f32>::branches(&builder.0, roots, &Assumptions::none(0));
        assert!(tape(&[jump, smooth]).is_none());
        assert!(tape(&[smooth, jump]).is_some());
        assert_eq!(tape(&[smooth, jump]).expect("it jumps").outputs(), 1);
    }

    /// A solid's boundary includes a jump at which the sign changes, but none at which it stays.
    #[test]
    fn a_jump_bounds_a_solid_only_where_the_sign_changes() {
        let mut builder = GraphBuilder::default();
        let [x, ..] = Axis::ALL.map(|axis| builder.0.variable(axis));
        let jump = builder.of(Op::Floor, &[x]);
        let near = [[0.875, 1.125], [0.0, 0.0], [0.0, 0.0]];
        for (value, is_empty) in [(-1, [true, true]), (1, [true, false]), (2, [false; 2])] {
            // 2·floor(x) is 0 and 2.
            let value = builder.0.integer(-value);
            let root = builder.weighted(jump, 2, value);
            let found = [false, true].map(|is_solid| builder.is_empty(root, is_solid, near));
            assert_eq!(found, is_empty, "{value:?}");
        }
    }
}
