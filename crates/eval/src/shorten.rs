//! Tapes that shrink: in a part of space, steps that cannot change where a function is 0, or its
//! sign, are dropped.
//!
//! A step's value matters only between two *thresholds* −S and T: its substitute must have the same
//! value wherever that is between them, must be above T exactly where the value is above T, below
//! −S exactly where the value is below −S, and undefined exactly where the value is. For the
//! function itself both thresholds are 0, so that zeros, signs and the domain of definition stay.
//! The module [`thresholds`] has the rule of each operation.

mod thresholds;

use crate::real::Real;
use crate::tape::{Step, StepOperands, Tape};
use smallvec::SmallVec;
use thresholds::StepNeeds;
use zeroset_interval::Interval;
use zeroset_ops::Op;

/// Stands in a [`Selection`] for a step that negates its operand and is none of the tape's.
const NEGATION: u32 = u32::MAX;

/// What is known about a step's value over a part of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepBounds {
    /// Bounds of the value, wherever it is defined.
    pub values: Interval,
    /// Whether the value is defined throughout the part.
    pub is_defined: bool,
}

/// Some steps of a tape, with operands among themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// Index of each step in the tape.
    steps: Vec<u32>,
    /// Operands of each step, as positions in this selection.
    operands: Vec<SmallVec<[u32; 3]>>,
    /// Position of the step that computes the function.
    output: u32,
}

impl Selection {
    /// Number of steps.
    pub fn count(&self) -> usize {
        self.steps.len()
    }

    /// Index in the tape of the selected step in this position.
    ///
    /// # Panics
    /// If there is no such position, or if the step is none of the tape's.
    pub fn origin(&self, position: usize) -> usize {
        let step = self.steps[position];
        assert_ne!(step, NEGATION, "a step of the tape");
        step as usize
    }

    /// Returns the same selection as one from the tape from which `outer` was selected.
    #[must_use]
    pub fn from_outer(mut self, outer: &Self) -> Self {
        for step in self.steps.iter_mut().filter(|step| **step != NEGATION) {
            *step = outer.steps[*step as usize];
        }
        self
    }
}

/// Finds which steps of a tape of one function matter in parts of space.
#[derive(Clone, Debug)]
pub struct Shortener {
    /// Steps whose bounds decide which other steps can be dropped, in order.
    deciding: Vec<usize>,
    /// Per step, its place among them; the largest number if it has none.
    places: Vec<u32>,
    /// Per step, the number of steps that use it.
    users: Vec<u32>,
}

impl Shortener {
    /// Examines the steps of a tape.
    pub fn new<T: Real>(tape: &Tape<T>) -> Self {
        let steps = tape.steps();
        let (mut is_deciding, mut users) = (vec![false; steps.len()], vec![0; steps.len()]);
        for step in steps {
            let Step::Apply(op, operands) = step else { continue };
            operands.iter().for_each(|&operand| users[operand] += 1);
            match op {
                Op::Min | Op::Max => {
                    operands.iter().for_each(|&operand| is_deciding[operand] = true);
                }
                Op::Abs | Op::SelectNegative => is_deciding[operands[0]] = true,
                _ => {}
            }
        }
        let mut shortener =
            Self { deciding: Vec::new(), places: vec![u32::MAX; steps.len()], users };
        for (index, step) in steps.iter().enumerate() {
            let is_open = matches!(step, Step::Apply(..) | Step::Coordinate(_));
            if is_deciding[index] && is_open {
                shortener.places[index] = shortener.deciding.len() as u32;
                shortener.deciding.push(index);
            }
        }
        shortener
    }

    /// The steps whose bounds decide which other steps can be dropped, in order.
    pub fn deciding(&self) -> &[usize] {
        &self.deciding
    }

    /// Selects the steps that matter in a part of space. `bounds` tells what holds in that part for
    /// the [deciding](Self::deciding) steps, in the same order.
    ///
    /// The selected function has the same zeros and signs there, and the same domain of definition.
    /// `None` if all steps matter.
    ///
    /// # Panics
    /// If this is not the tape that was examined.
    pub fn select<T: Real>(&self, tape: &Tape<T>, bounds: &[StepBounds]) -> Option<Selection> {
        let needs = StepNeeds::of(tape, self, bounds);
        let steps = tape.steps();
        let mut place = vec![u32::MAX; steps.len()];
        let mut selection = Selection { steps: Vec::new(), operands: Vec::new(), output: 0 };
        for (index, step) in steps.iter().enumerate() {
            if !needs.is_needed(index) {
                continue;
            }
            if let Some(substitute) = needs.substitute(index) {
                place[index] = place[substitute.step];
                if substitute.is_negated {
                    let negated = SmallVec::from_slice(&[place[index]]);
                    place[index] = selection.steps.len() as u32;
                    selection.steps.push(NEGATION);
                    selection.operands.push(negated);
                }
                continue;
            }
            let operands = match step {
                Step::Apply(_, operands) => {
                    operands.iter().map(|&operand| place[operand]).collect()
                }
                Step::Coordinate(_) | Step::Parameter(_) | Step::Constant(..) => SmallVec::new(),
            };
            place[index] = selection.steps.len() as u32;
            selection.steps.push(index as u32);
            selection.operands.push(operands);
        }
        selection.output = place[tape.outputs_at()[0]];
        (selection.count() < steps.len()).then_some(selection)
    }
}

impl<T: Real> Tape<T> {
    /// Returns the tape of some of the steps.
    ///
    /// # Panics
    /// If the selection is from a tape with other steps.
    #[must_use]
    pub fn select(&self, selection: &Selection) -> Self {
        let mut changed = vec![false; selection.count()];
        let (mut steps, mut ranges) = (Vec::new(), Vec::<Interval>::new());
        for (position, (&index, chosen)) in
            selection.steps.iter().zip(&selection.operands).enumerate()
        {
            if index == NEGATION {
                let step =
                    Step::Apply(Op::Neg, chosen.iter().map(|&place| place as usize).collect());
                ranges.push(self.range_among(&step, &steps, &ranges));
                steps.push(step);
                changed[position] = true;
                continue;
            }
            let index = index as usize;
            let mut range = self.range(index);
            let step = match &self.steps()[index] {
                Step::Apply(op, operands) => {
                    let chosen: StepOperands = chosen.iter().map(|&place| place as usize).collect();
                    changed[position] = chosen.iter().zip(operands).any(|(&place, &operand)| {
                        changed[place] || selection.steps[place] as usize != operand
                    });
                    let step = Step::Apply(*op, chosen);
                    if changed[position] {
                        // The substitute of an operand may have values that the operand has not.
                        range = self.range_among(&step, &steps, &ranges);
                    }
                    step
                }
                other => other.clone(),
            };
            steps.push(step);
            ranges.push(range);
        }
        self.with_steps(steps, ranges, selection.output as usize)
    }
}
