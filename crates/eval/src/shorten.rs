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
use crate::tape::{Operands, Step, Tape};
use smallvec::SmallVec;
use thresholds::Needs;
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
    pub fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether there is no step, which is never the case.
    pub fn is_empty(&self) -> bool {
        self.steps.is_empty()
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

impl<T: Real> Tape<T> {
    /// Steps whose bounds decide which other steps can be dropped, in order.
    pub fn deciding_steps(&self) -> Vec<usize> {
        let mut deciding = vec![false; self.steps().len()];
        for step in self.steps() {
            match step {
                Step::Apply(Op::Min | Op::Max, operands) => {
                    operands.iter().for_each(|&operand| deciding[operand] = true);
                }
                Step::Apply(Op::Abs | Op::SelectNegative, operands) => deciding[operands[0]] = true,
                _ => {}
            }
        }
        let is_open =
            |step: &usize| matches!(self.steps()[*step], Step::Apply(..) | Step::Coordinate(_));
        (0..deciding.len()).filter(|&step| deciding[step]).filter(is_open).collect()
    }

    /// Selects the steps that matter in a part of space, for a tape of one function. `bounds` tells
    /// what holds in that part for the [`Tape::deciding_steps`], in the same order.
    ///
    /// The selected function has the same zeros and signs there, and the same domain of definition.
    /// `None` if all steps matter.
    pub fn shortened(&self, bounds: &[StepBounds]) -> Option<Selection> {
        let needs = Needs::of(self, bounds);
        let steps = self.steps();
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
        selection.output = place[self.outputs_at()[0]];
        (selection.len() < steps.len()).then_some(selection)
    }

    /// Returns the tape of some of the steps.
    ///
    /// # Panics
    /// If the selection is from a tape with other steps.
    #[must_use]
    pub fn select(&self, selection: &Selection) -> Self {
        let mut changed = vec![false; selection.len()];
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
                    let chosen: Operands = chosen.iter().map(|&place| place as usize).collect();
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
