//! Clauses: steps that are selected together.
//!
//! A part of space needs a sphere or not, not some of its steps. So a step with few choices below
//! it is one *clause*, with all steps that it alone uses. Coordinates belong to no clause.

use super::rules::{Rules, StepRule};
use crate::real::Real;
use crate::tape::{Step, Tape};
use smallvec::SmallVec;

/// Least number of choices below a step whose value is needed exactly for which it pays to select
/// among them.
pub(super) const LEAST_CHOICES: u32 = 16;

/// Most other steps that a clause may use.
const MOST_USED: usize = 3;

/// A clause of a tape.
#[derive(Clone, Debug, Default)]
pub struct Clause {
    /// The clause's steps in order. The last has its value.
    pub steps: Vec<u32>,
    /// The steps outside whose values it uses, without coordinates and constants.
    pub used: SmallVec<[usize; MOST_USED]>,
}

/// The clauses of a tape.
#[derive(Clone, Debug)]
pub struct Clauses {
    /// Per step, the clause that ends with it. `None` for a step that is selected alone, or that is
    /// inside of a clause.
    of: Vec<Option<Box<Clause>>>,
    /// Per step, whether it is inside of a clause.
    is_inside: Vec<bool>,
}

/// The place of a step among clauses.
#[derive(Clone, Copy, PartialEq)]
enum Owner {
    /// No step of the function uses it.
    Nothing,
    /// It is selected as a step, with its rule.
    Own,
    /// It is the last step of a clause, or selected as a step whose value is exact.
    Last,
    /// It is inside of the clause that ends with this step.
    Clause(u32),
}

impl Clauses {
    /// Without clauses: each step is selected alone.
    pub fn none(steps: usize) -> Self {
        Self { of: vec![None; steps], is_inside: vec![false; steps] }
    }

    /// The clause that ends with a step, if there is one.
    pub fn ending_with(&self, step: usize) -> Option<&Clause> {
        self.of[step].as_deref()
    }

    /// Whether a step is inside of a clause, and not its last.
    pub fn is_inside(&self, step: usize) -> bool {
        self.is_inside[step]
    }

    /// Finds the clauses of a tape. Their steps lose their rules: their values are exact.
    pub(super) fn find<T: Real>(tape: &Tape<T>, rules: &mut Rules) -> Self {
        let steps = tape.steps();
        let choices = choices(tape, &rules.of);
        let mut owners = vec![Owner::Nothing; steps.len()];
        for &output in tape.outputs_at() {
            owners[output] = Owner::Own;
        }
        // All users of a step come behind it.
        for index in (0..steps.len()).rev() {
            let Step::Apply(_, operands) = &steps[index] else { continue };
            let has_few = choices[index] < LEAST_CHOICES;
            let is_clause = match (owners[index], rules.of[index]) {
                (Owner::Nothing, _) => continue,
                (Owner::Own, StepRule::InBlend) => false,
                (Owner::Own, StepRule::Exact) => has_few,
                (Owner::Own, _) => choices[index] == 0,
                (Owner::Last | Owner::Clause(_), _) => true,
            };
            let last = match owners[index] {
                Owner::Clause(last) => last,
                _ => index as u32,
            };
            if is_clause {
                rules.of[index] = StepRule::Exact;
                if last as usize == index {
                    owners[index] = Owner::Last;
                }
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
        Self::of_owners(tape, &owners)
    }

    fn of_owners<T: Real>(tape: &Tape<T>, owners: &[Owner]) -> Self {
        let steps = tape.steps();
        let last = |index: usize| match owners[index] {
            Owner::Clause(last) => last,
            _ => index as u32,
        };
        let mut clauses: Vec<Clause> = vec![Clause::default(); steps.len()];
        for (index, step) in steps.iter().enumerate() {
            let (Step::Apply(_, operands), Owner::Clause(_) | Owner::Last) = (step, owners[index])
            else {
                continue;
            };
            let clause = &mut clauses[last(index) as usize];
            clause.steps.push(index as u32);
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
}

/// Per step, the number of choices among it and the steps below. Those of shared steps count more
/// than once.
pub(super) fn choices<T: Real>(tape: &Tape<T>, rules: &[StepRule]) -> Vec<u32> {
    let mut choices = vec![0_u32; rules.len()];
    for (index, step) in tape.steps().iter().enumerate() {
        let Step::Apply(_, operands) = step else { continue };
        let own = match rules[index] {
            StepRule::Min
            | StepRule::Max
            | StepRule::Choice
            | StepRule::Product
            | StepRule::Blend(_) => 1,
            _ => 0,
        };
        let sum = |all: u32, &operand: &usize| all.saturating_add(choices[operand]);
        choices[index] = operands.iter().fold(own, sum);
    }
    choices
}
