//! Zero tests of functions that jump: a box is enclosed branch by branch.
//!
//! At a jump, the enclosure of a function is the hull of both branches. It contains 0 even if
//! neither branch does. The branches together cover the box. If none of them has a zero, neither
//! has the box. The interval rules define which operations have branches.

use crate::real::Real;
use crate::tape::{Step, Tape, may_vanish};
use crate::value_kind::{Intervals, Loader, ValueKind, coordinate_bounds, parameter_bounds};
use zeroset_interval::{
    Branch, Claims, Enclosure, Fact, Format, Interval, Machine, Operand, Split, enclose,
    enclose_branch,
};
use zeroset_ops::Op;

/// Largest number of combinations of branches in one kernel.
const COMBINATIONS: usize = 8;
/// Largest number of operations in one kernel, over all combinations. In a longer tape fewer jumps
/// are split.
const OPERATIONS: usize = 4_000;

/// The steps of a tape that have branches, and the combinations of these branches.
#[derive(Clone, Debug)]
pub(crate) struct Branches {
    /// The choices between branches. A combination takes one branch of each choice.
    choices: Vec<Choice>,
    /// For each step, the index of the choice that it makes, if any.
    makes: Vec<Option<usize>>,
    /// For each step, the choices that its value depends on, as a set of bits.
    depends: Vec<u32>,
    /// Number of operations to enclose, over all combinations.
    operations: usize,
}

/// A choice between the branches of a split. Several steps may share a choice. In each box, the
/// first of these steps that jumps makes the choice. The later ones are then enclosed over the
/// whole box.
#[derive(Clone, Copy, Debug)]
struct Choice {
    split: Split,
    is_shared: bool,
}

impl Choice {
    fn parts(self) -> &'static [Branch] {
        self.split.branches()
    }
}

impl Branches {
    /// Finds the branches of a tape. `None` if the last output depends on no step with branches, or
    /// if code for two branches would be too long.
    pub fn new<T: Real>(tape: &Tape<T>) -> Option<Self> {
        let mut combinations = COMBINATIONS;
        while combinations > 1 {
            let branches = Self::within(tape, combinations);
            let last = tape.outputs_at().last()?;
            if branches.depends[*last] == 0 {
                return None;
            }
            if branches.operations <= OPERATIONS {
                return Some(branches);
            }
            combinations /= 2;
        }
        None
    }

    fn within<T: Real>(tape: &Tape<T>, combinations: usize) -> Self {
        let splits: Vec<Split> = (0..tape.steps().len()).map(|index| split(tape, index)).collect();
        let mut choices: Vec<Choice> = Vec::new();
        let mut makes = vec![None; splits.len()];
        let mut left = combinations;
        // Jumps are split before poles. The rational form has cleared most poles, and at the other
        // poles the whole function may not jump.
        for poles in [false, true] {
            let first = choices.len();
            let mut next = first;
            for (index, &split) in splits.iter().enumerate() {
                let parts = split.branches().len();
                if parts < 2 || (split == Split::AtPole) != poles {
                    continue;
                }
                if parts <= left {
                    left /= parts;
                    makes[index] = Some(choices.len());
                    choices.push(Choice { split, is_shared: false });
                } else if let Some(own) = shared(&choices[first..], split, next - first) {
                    choices[first + own].is_shared = true;
                    makes[index] = Some(first + own);
                    next = first + own + 1;
                }
            }
        }
        let mut branches = Self { choices, makes, depends: Vec::new(), operations: 0 };
        branches.find_dependences(tape);
        branches
    }

    fn find_dependences<T: Real>(&mut self, tape: &Tape<T>) {
        // For each choice, the choices that decide in which lanes an earlier step has made that
        // choice.
        let mut made = vec![0_u32; self.choices.len()];
        for (index, step) in tape.steps().iter().enumerate() {
            let Step::Apply(_, operands) = step else {
                self.depends.push(0);
                continue;
            };
            let mut depends = operands.iter().fold(0, |all, &i| all | self.depends[i]);
            if let Some(choice) = self.makes[index] {
                depends |= 1 << choice | made[choice];
                made[choice] |= depends;
            }
            self.depends.push(depends);
            self.operations += self.variants(depends);
        }
    }

    /// Number of combinations that differ in the choices of the set `depends`.
    fn variants(&self, depends: u32) -> usize {
        let chosen = self.choices.iter().enumerate().filter(|(k, _)| depends >> k & 1 == 1);
        chosen.map(|(_, choice)| choice.parts().len()).product()
    }

    pub fn operations(&self) -> usize {
        self.operations
    }

    /// All combinations: lists with one branch per choice.
    fn combinations(&self) -> Vec<Vec<Branch>> {
        let mut all = vec![Vec::new()];
        for choice in &self.choices {
            let longer = |parts: &Vec<Branch>, part: Branch| {
                let mut parts = parts.clone();
                parts.push(part);
                parts
            };
            all = all
                .iter()
                .flat_map(|parts| choice.parts().iter().map(|&part| longer(parts, part)))
                .collect();
        }
        all
    }
}

/// Returns the index of a choice with this split. The search starts at `next` and wraps around.
fn shared(choices: &[Choice], split: Split, next: usize) -> Option<usize> {
    let mut turn = (0..choices.len()).map(|k| (next + k) % choices.len());
    turn.find(|&k| choices[k].split == split)
}

impl<T: Real> Tape<T> {
    /// Returns whether an operation of the tape may jump or have a pole.
    pub fn may_jump(&self) -> bool {
        (0..self.steps().len()).any(|index| split(self, index) != Split::Whole)
    }
}

fn split<T: Real>(tape: &Tape<T>, index: usize) -> Split {
    match &tape.steps()[index] {
        Step::Apply(op, operands) => {
            let ranges: Vec<Interval> = operands.iter().map(|&i| tape.range(i)).collect();
            Split::of(*op, &ranges, tape.exponent(operands))
        }
        Step::Coordinate(_) | Step::Parameter(_) | Step::Constant(..) => Split::Whole,
    }
}

/// The evaluation of a tape for one combination of branches.
struct Combination<V> {
    parts: Vec<Branch>,
    values: Vec<Operand<V>>,
    /// For each shared choice, the lanes in which an earlier step has made it.
    made: Vec<Fact<V>>,
    /// For each step with a shared choice, the lanes in which this step or an earlier one has made
    /// the choice.
    made_at: Vec<Fact<V>>,
}

impl<V: Copy> Combination<V> {
    /// Returns whether both combinations have the same branches for the set `choices`.
    fn agrees(&self, other: &Self, choices: u32) -> bool {
        let mut pairs = self.parts.iter().zip(&other.parts).enumerate();
        pairs.all(|(choice, (a, b))| choices >> choice & 1 == 0 || a == b)
    }
}

impl<T: Real> Tape<T> {
    /// Returns the lanes in which all outputs may be 0 together, in some combination of branches.
    pub(crate) fn possible_branches<M: Machine>(
        &self,
        m: &mut M,
        branches: &Branches,
        loader: &mut impl Loader<M>,
    ) -> Fact<M::V> {
        let mut done: Vec<Combination<M::V>> = Vec::new();
        for parts in branches.combinations() {
            let made = vec![Fact::False; branches.choices.len()];
            let mut now = Combination { parts, values: Vec::new(), made, made_at: Vec::new() };
            for (index, step) in self.steps().iter().enumerate() {
                let depends = branches.depends[index];
                let same = done.iter().find(|other| other.agrees(&now, depends));
                let (operand, made) = if let Some(other) = same {
                    (other.values[index], other.made_at[index])
                } else {
                    let leaf = |value| (value, Fact::False);
                    let (value, made) = match step {
                        Step::Coordinate(axis) => leaf(coordinate_bounds(m, loader, *axis)),
                        Step::Parameter(number) => {
                            leaf(parameter_bounds(m, loader, *number as usize))
                        }
                        Step::Constant(bounds, _) => leaf(Intervals::constant::<T, M>(m, *bounds)),
                        Step::Apply(op, operands) => {
                            enclose_step::<T, M>(m, branches, &now, index, *op, operands)
                        }
                    };
                    let (range, exponent) = (self.range(index), step.exponent());
                    let value = Intervals::clamp_to::<T, M>(m, value, range);
                    (Operand { value, range, exponent }, made)
                };
                if let Some(choice) = branches.makes[index] {
                    now.made[choice] = made;
                }
                now.values.push(operand);
                now.made_at.push(made);
            }
            done.push(now);
        }
        let mut possible = Fact::False;
        for combination in done {
            let mut all = Fact::True;
            for &output in self.outputs_at() {
                let zero = may_vanish(m, T::FORMAT, &combination.values[output].value);
                all = all.and(m, zero);
            }
            possible = possible.or(m, all);
        }
        possible
    }
}

/// Encloses an operation in one combination. Also returns the lanes in which this or an earlier
/// operation has made its shared choice.
fn enclose_step<T: Real, M: Machine>(
    m: &mut M,
    branches: &Branches,
    now: &Combination<M::V>,
    index: usize,
    op: Op,
    operands: &[usize],
) -> (Enclosure<M::V>, Fact<M::V>) {
    let operands: Vec<_> = operands.iter().map(|&i| now.values[i]).collect();
    let Some(choice) = branches.makes[index] else {
        return (enclose(m, T::FORMAT, op, &operands), Fact::False);
    };
    let part = enclose_branch(m, T::FORMAT, op, &operands, now.parts[choice]);
    if !branches.choices[choice].is_shared {
        return (part, Fact::False);
    }
    let whole = enclose(m, T::FORMAT, op, &operands);
    let made = now.made[choice];
    // An operation makes no choice in lanes in which it does not jump.
    let jumps = whole.facts.continuous.not(m, T::FORMAT);
    (pick(m, T::FORMAT, made, &whole, &part), made.or(m, jumps))
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
    use crate::{Assumptions, Binding, Boxes, FindZeros, Kernel, Reference};
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
        fn is_empty(&self, root: NodeId, ranges: [[f32; 2]; 3]) -> bool {
            let tape = self.branches(root).expect("it jumps");
            let ends = ranges.map(|[lo, hi]| Interval { lo: lo.into(), hi: hi.into() });
            let kernel = Reference::<FindZeros>::new(tape, Binding::empty());
            kernel.eval_all(&Boxes::around(&[ends]))[0].possible == 0
        }
    }

    /// Seven steps jump, but there are only three choices. The fourth and the seventh step share a
    /// choice. The fourth jumps in only one branch of the second. In that branch the seventh must
    /// not choose again, so it depends on the second as well.
    #[test]
    fn a_choice_already_made_by_another_jump_is_not_made_again() {
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
        assert!(!builder.is_empty(root, near));
        // The sum takes the values 0, 1, 101 and 110 (and 111 at z = 1).
        for (value, is_taken) in [(0, true), (1, true), (50, false), (110, true), (115, false)] {
            let root = builder.plus(sum, -value);
            assert_eq!(!builder.is_empty(root, near), is_taken, "{value}");
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

    #[test]
    fn long_formulas_are_written_for_fewer_branches_or_none() {
        let written = |length: usize| {
            let mut builder = GraphBuilder::default();
            let [x, y, z] = Axis::ALL.map(|axis| builder.0.variable(axis));
            let mut sum = builder.of(Op::Floor, &[x]);
            for axis in [y, z] {
                let jump = builder.of(Op::Floor, &[axis]);
                sum = builder.of(Op::Add, &[sum, jump]);
            }
            for _ in 0..length {
                sum = builder.of(Op::Sin, &[sum]);
            }
            builder.branches(sum).map(|tape| tape.operations())
        };
        let over = |all: usize, length: usize| Some(all * length);
        let near = |found: Option<usize>, expected: Option<usize>| match (found, expected) {
            (Some(a), Some(b)) => a.abs_diff(b) < 40,
            (a, b) => a == b,
        };
        assert!(near(written(400), over(8, 400)), "{:?}", written(400));
        assert!(near(written(900), over(4, 900)), "{:?}", written(900));
        assert!(near(written(1900), over(2, 1900)), "{:?}", written(1900));
        assert_eq!(written(2100), None);
    }
}
