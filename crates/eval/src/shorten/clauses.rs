//! Clauses: steps that are selected together.
//!
//! A part of space needs a sphere or not, not some of its steps. So a step with few choices below
//! it is one *clause*, with all steps that it alone uses. A blend is a clause, too: it passes
//! thresholds on to the two steps that it joins. Coordinates belong to no clause.

use super::rules::{Blend, Rules, StepRule};
use crate::real::Real;
use crate::tape::{Step, Tape};
use smallvec::SmallVec;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use zeroset_interval::{Exponent, Interval};
use zeroset_ir::Axis;
use zeroset_ops::Op;

/// Least number of choices below a step whose value is needed exactly for which it pays to select
/// among them.
pub(super) const LEAST_CHOICES: u32 = 16;

/// Most other steps that a clause may use.
const MOST_USED: usize = 3;

/// Most steps of a clause that shares code. Longer code might need too much stack.
const MOST_SHARED: usize = 64;

/// A clause of a tape.
#[derive(Clone, Debug, Default)]
pub struct Clause {
    /// The clause's steps in order. The last has its value.
    pub steps: Vec<u32>,
    /// The steps outside whose values it uses. They are operations, but those of a blend may also
    /// be coordinates or constants.
    pub used: SmallVec<[usize; MOST_USED]>,
    /// The number of the clause's shape, if it is a blend or if many clauses have this shape.
    pub shape: Option<u32>,
}

/// An operand of a step of a clause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClauseOperand {
    /// A coordinate.
    Coordinate(Axis),
    /// A constant or a parameter, and its kind as an exponent.
    Constant(Exponent),
    /// Another step of the clause, by its place there.
    Inside(u32),
    /// A step outside of the clause, by its place in [`Clause::used`].
    Used(u8),
}

/// The operations of a clause, with their operands.
type Shape = Vec<(Op, SmallVec<[ClauseOperand; 3]>)>;

impl Clause {
    /// Returns how the clause finds an operand of one of its steps.
    ///
    /// # Panics
    /// If no step of the clause has this operand.
    pub fn operand<T: Real>(&self, tape: &Tape<T>, operand: usize) -> ClauseOperand {
        if let Some(number) = self.used.iter().position(|&used| used == operand) {
            return ClauseOperand::Used(number as u8);
        }
        match &tape.steps()[operand] {
            Step::Coordinate(axis) => ClauseOperand::Coordinate(*axis),
            step @ (Step::Constant(..) | Step::Parameter(_)) => {
                ClauseOperand::Constant(step.exponent())
            }
            Step::Apply(..) => {
                let place = self.steps.binary_search(&(operand as u32));
                ClauseOperand::Inside(place.expect("a step of the clause") as u32)
            }
        }
    }

    /// Returns the operation of each step, with its operands.
    pub fn operations<'a, T: Real>(
        &'a self,
        tape: &'a Tape<T>,
    ) -> impl Iterator<Item = (Op, &'a [usize])> {
        self.steps.iter().map(|&index| match &tape.steps()[index as usize] {
            Step::Apply(op, operands) => (*op, &operands[..]),
            _ => unreachable!("an operation"),
        })
    }

    fn shape<T: Real>(&self, tape: &Tape<T>) -> Shape {
        let find = |&operand: &usize| self.operand(tape, operand);
        self.operations(tape).map(|(op, used)| (op, used.iter().map(find).collect())).collect()
    }

    /// Returns the steps whose ranges the clause's code relies on: those of the clause, and each
    /// operand from outside.
    fn all_steps<'a, T: Real>(&'a self, tape: &'a Tape<T>) -> impl Iterator<Item = usize> {
        let outside = self
            .operations(tape)
            .flat_map(|(_, operands)| operands.iter().copied())
            .filter(|operand| self.steps.binary_search(&(*operand as u32)).is_err());
        self.steps.iter().map(|&index| index as usize).chain(outside)
    }
}

/// The clauses of a tape.
#[derive(Clone, Debug)]
pub struct Clauses {
    /// Per step, the clause that ends with it. `None` for a step that is selected alone, or that is
    /// inside of a clause.
    of: Vec<Option<Box<Clause>>>,
    /// Per step, whether it is inside of a clause.
    is_inside: Vec<bool>,
    /// Per step, whether it is inside of a clause that has a shape.
    is_in_shape: Vec<bool>,
    /// Per shape that clauses share, the last steps of these clauses.
    shapes: Vec<Vec<u32>>,
}

/// The place of a step among clauses.
#[derive(Clone, Copy, PartialEq)]
enum Owner {
    /// No step of the function uses it.
    Nothing,
    /// It is selected as a step, with its rule.
    Own,
    /// It is a blend, which is selected as a step, with its rule.
    Blend,
    /// It is inside of the blend that ends with this step.
    InBlend(u32),
    /// It is the last step of a clause, or selected as a step whose value is exact.
    Last,
    /// It is inside of the clause that ends with this step.
    Clause(u32),
}

impl Clauses {
    /// Without clauses: each step is selected alone.
    pub fn none(steps: usize) -> Self {
        let (is_inside, is_in_shape) = (vec![false; steps], vec![false; steps]);
        Self { of: vec![None; steps], is_inside, is_in_shape, shapes: Vec::new() }
    }

    /// The clause that ends with a step, if there is one.
    pub fn ending_with(&self, step: usize) -> Option<&Clause> {
        self.of[step].as_deref()
    }

    /// Whether a step is inside of a clause, and not its last.
    pub fn is_inside(&self, step: usize) -> bool {
        self.is_inside[step]
    }

    /// Whether a step is inside of a clause that has a shape, and not its last.
    pub fn is_in_shape(&self, step: usize) -> bool {
        self.is_in_shape[step]
    }

    /// Number of shapes that clauses share.
    pub fn shapes(&self) -> usize {
        self.shapes.len()
    }

    /// Returns the tape with [coarse](Tape::coarse) ranges. Clauses of one shape get the same
    /// ranges, so that they can share code.
    ///
    /// # Panics
    /// If the clauses are of a tape with other steps.
    #[must_use]
    pub fn coarse<T: Real>(&self, tape: Tape<T>) -> Tape<T> {
        let mut tape = tape.coarse();
        let clause = |&last: &u32| self.of[last as usize].as_deref().expect("a clause");
        // Shapes have steps in common: what one uses is often the value of another.
        loop {
            let mut changed = false;
            for shape in &self.shapes {
                let mut ranges: Vec<Interval> = Vec::new();
                for last in shape {
                    for (place, step) in clause(last).all_steps(&tape).enumerate() {
                        let range = tape.range(step);
                        match ranges.get_mut(place) {
                            Some(hull) => *hull = hull.hull(range),
                            None => ranges.push(range),
                        }
                    }
                }
                for last in shape {
                    let steps: Vec<usize> = clause(last).all_steps(&tape).collect();
                    for (step, &range) in steps.into_iter().zip(&ranges) {
                        changed |= tape.widen(step, range);
                    }
                }
            }
            if !changed {
                return tape;
            }
        }
    }

    /// Finds the clauses of a tape. Their steps lose their rules, except blends: their values are
    /// exact.
    /// Clauses share code if at least `least_shared` have the same shape.
    pub(super) fn find<T: Real>(tape: &Tape<T>, rules: &mut Rules, least_shared: usize) -> Self {
        let steps = tape.steps();
        let choices = choices(tape, &rules.of, &rules.blends);
        let mut owners = vec![Owner::Nothing; steps.len()];
        for &output in tape.outputs_at() {
            owners[output] = Owner::Own;
        }
        // All users of a step come behind it.
        for index in (0..steps.len()).rev() {
            let Step::Apply(_, operands) = &steps[index] else { continue };
            let has_few = choices[index] < LEAST_CHOICES;
            let is_clause = match (owners[index], rules.of[index]) {
                (Owner::Nothing | Owner::Blend | Owner::InBlend(_), _) => continue,
                (Owner::Own, StepRule::Exact) => has_few,
                (Owner::Own, _) => choices[index] == 0,
                (Owner::Last | Owner::Clause(_), _) => true,
            };
            let last = match owners[index] {
                Owner::Clause(last) => last,
                _ => index as u32,
            };
            let mut operands = &operands[..];
            if is_clause {
                rules.of[index] = StepRule::Exact;
                if last as usize == index {
                    owners[index] = Owner::Last;
                }
            } else if let StepRule::Blend(number) = rules.of[index] {
                let blend = &rules.blends[number as usize];
                owners[index] = Owner::Blend;
                for &inside in &blend.inside {
                    owners[inside] = Owner::InBlend(last);
                }
                operands = &blend.operands;
            }
            for &operand in operands {
                let owner = &mut owners[operand];
                *owner = match (*owner, is_clause) {
                    (Owner::Nothing, true) => Owner::Clause(last),
                    (Owner::Nothing | Owner::Own, false) => Owner::Own,
                    (Owner::Clause(other), true) if other == last => Owner::Clause(last),
                    // A step that several clauses use is replaced by none of its operands.
                    _ => Owner::Last,
                };
            }
        }
        let mut found = Self::of_owners(tape, &owners, rules);
        found.find_shapes(tape, rules, least_shared);
        found
    }

    fn of_owners<T: Real>(tape: &Tape<T>, owners: &[Owner], rules: &Rules) -> Self {
        let steps = tape.steps();
        let last = |index: usize| match owners[index] {
            Owner::Clause(last) | Owner::InBlend(last) => last,
            _ => index as u32,
        };
        let mut clauses: Vec<Clause> = vec![Clause::default(); steps.len()];
        for (index, step) in steps.iter().enumerate() {
            let Step::Apply(_, operands) = step else { continue };
            if matches!(owners[index], Owner::Nothing | Owner::Own) {
                continue;
            }
            let clause = &mut clauses[last(index) as usize];
            clause.steps.push(index as u32);
            if let (Owner::Blend, StepRule::Blend(number)) = (owners[index], rules.of[index]) {
                clause.used = SmallVec::from_slice(&rules.blends[number as usize].operands);
            }
            if matches!(owners[index], Owner::Blend | Owner::InBlend(_)) {
                continue;
            }
            for &operand in operands {
                if matches!(steps[operand], Step::Apply(..))
                    && last(operand) != last(index)
                    && !clause.used.contains(&operand)
                {
                    clause.used.push(operand);
                }
            }
        }
        let mut found = Self::none(steps.len());
        for (index, clause) in clauses.into_iter().enumerate() {
            // The steps of a clause that uses too many others are selected one by one.
            if clause.steps.len() > 1 && clause.used.len() <= MOST_USED {
                for &inside in &clause.steps[..clause.steps.len() - 1] {
                    found.is_inside[inside as usize] = true;
                }
                found.of[index] = Some(Box::new(clause));
            }
        }
        found
    }

    /// Finds which clauses have the same shape.
    fn find_shapes<T: Real>(&mut self, tape: &Tape<T>, rules: &Rules, least_shared: usize) {
        let mut numbers: HashMap<Shape, usize> = HashMap::new();
        let mut shapes: Vec<(bool, Vec<u32>)> = Vec::new();
        for (index, clause) in self.of.iter().enumerate() {
            let Some(clause) = clause.as_ref().filter(|one| one.steps.len() <= MOST_SHARED) else {
                continue;
            };
            let is_blend = matches!(rules.of[index], StepRule::Blend(_));
            let number = match numbers.entry(clause.shape(tape)) {
                Entry::Occupied(entry) => *entry.get(),
                Entry::Vacant(entry) => {
                    shapes.push((false, Vec::new()));
                    *entry.insert(shapes.len() - 1)
                }
            };
            shapes[number].0 |= is_blend;
            shapes[number].1.push(index as u32);
        }
        for (is_blend, lasts) in shapes {
            if is_blend || lasts.len() >= least_shared {
                for &last in &lasts {
                    let clause = self.of[last as usize].as_deref_mut().expect("a clause");
                    clause.shape = Some(self.shapes.len() as u32);
                    for &inside in &clause.steps[..clause.steps.len() - 1] {
                        self.is_in_shape[inside as usize] = true;
                    }
                }
                self.shapes.push(lasts);
            }
        }
    }
}

/// Per step, the number of choices among it and the steps below. Those of shared steps count more
/// than once.
pub(super) fn choices<T: Real>(tape: &Tape<T>, rules: &[StepRule], blends: &[Blend]) -> Vec<u32> {
    let mut choices = vec![0_u32; rules.len()];
    for (index, step) in tape.steps().iter().enumerate() {
        let Step::Apply(_, operands) = step else { continue };
        let (own, operands) = match rules[index] {
            StepRule::Min | StepRule::Max | StepRule::Choice | StepRule::Product => {
                (1, &operands[..])
            }
            StepRule::Blend(number) => (1, &blends[number as usize].operands[..]),
            _ => (0, &operands[..]),
        };
        let sum = |all: u32, &operand: &usize| all.saturating_add(choices[operand]);
        choices[index] = operands.iter().fold(own, sum);
    }
    choices
}
