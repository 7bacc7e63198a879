//! Tapes that shrink: in a part of space, steps that cannot change where a function is 0, or its
//! sign, are dropped.
//!
//! A step's value matters only between two *thresholds* −S and T. Its substitute must have the same
//! value wherever that is between them. It must be above T exactly where the value is, below −S
//! exactly where the value is, and undefined exactly where the value is. For the function itself
//! both thresholds are 0, so that zeros, signs and the domain of definition stay.
//! The module [`rules`] has the rule of each operation, and [`thresholds`] applies them.

mod clauses;
mod lane_bounds;
mod rules;
#[cfg(test)]
mod tests;
mod thresholds;

use crate::lanes::{LANES, Lanes};
use crate::real::Real;
use crate::tape::{Step, Tape};
use rules::{Rules, StepRule};
use smallvec::SmallVec;
use std::cell::Cell;
use std::sync::Arc;
use thresholds::{Choosing, StepNeeds, lanes};
use zeroset_interval::Interval;

pub use clauses::{Clause, ClauseOperand, Clauses};
pub use thresholds::LaneSet;

/// Most bytes that a thread keeps for the next selection.
const SCRATCH_BYTES: usize = 1 << 26;

/// Memory for a selection.
#[derive(Default)]
struct Scratch {
    needs: StepNeeds,
    /// Per step, its place in the selection of each lane that needs it.
    places: Vec<[Place; LANES]>,
}

impl Scratch {
    fn bytes(&self) -> usize {
        self.needs.bytes() + self.places.capacity() * size_of::<[Place; LANES]>()
    }
}

thread_local! {
    /// A thread's memory for selections.
    static SCRATCH: Cell<Scratch> = Cell::default();
}

/// Bounds of a step's value in parts of space, one part per lane.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct StepBounds<T: Real> {
    /// Lower bounds of the value, wherever it is defined, negated.
    neg_lo: Lanes<T>,
    /// Upper bounds.
    hi: Lanes<T>,
    /// A mask of the lanes in which the value is defined throughout: all bits or none.
    defined: Lanes<T>,
}

impl<T: Real> StepBounds<T> {
    #[inline]
    fn values(&self, lane: usize) -> Interval {
        Interval { lo: -self.neg_lo[lane].into(), hi: self.hi[lane].into() }
    }

    #[inline]
    fn is_defined(&self, lane: usize) -> bool {
        // A mask with all bits is no number.
        !(self.defined[lane].into() == 0.0)
    }
}

/// An operand of a selected step: another selected step, or a constant of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SelectedOperand(u32);

impl SelectedOperand {
    /// Marks constants and parameters. Their other bits are their index in the tape.
    const CONSTANT: u32 = 1 << 31;
    /// Fills the places of operands that a step does not have.
    const NONE: Self = Self(u32::MAX);

    /// The position of the step in its selection; `None` for a constant.
    #[inline]
    pub fn position(&self) -> Option<usize> {
        (self.0 & Self::CONSTANT == 0).then_some(self.0 as usize)
    }

    /// The index in the tape of a constant or parameter.
    #[inline]
    pub fn origin(&self) -> usize {
        (self.0 & !Self::CONSTANT) as usize
    }
}

/// A step of a [`Selection`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SelectedStep {
    /// Index in the tape, and whether the step is [changed](Self::is_changed).
    origin: u32,
    operands: [SelectedOperand; 3],
}

impl SelectedStep {
    /// Marks changed steps.
    const CHANGED: u32 = 1 << 31;
    /// Stands for an added step, which negates its operand.
    const NEGATION: u32 = u32::MAX;

    #[inline]
    fn new(origin: u32, operands: [SelectedOperand; 3], is_changed: bool) -> Self {
        Self { origin: if is_changed { origin | Self::CHANGED } else { origin }, operands }
    }

    /// The step that negates an operand.
    #[inline]
    fn negation(of: Place) -> Self {
        let operands = [of.operand(), SelectedOperand::NONE, SelectedOperand::NONE];
        Self { origin: Self::NEGATION, operands }
    }

    /// Index in the tape; `None` for an added step, which negates its operand.
    #[inline]
    pub fn origin(&self) -> Option<usize> {
        (self.origin != Self::NEGATION).then_some((self.origin & !Self::CHANGED) as usize)
    }

    /// Whether an operand's value may be another than in the tape, because the operand or one of
    /// its own operands was replaced.
    #[inline]
    pub fn is_changed(&self) -> bool {
        self.origin & Self::CHANGED != 0
    }

    /// The operands of the step.
    #[inline]
    pub fn operands(&self) -> &[SelectedOperand] {
        let count =
            self.operands.iter().take_while(|operand| **operand != SelectedOperand::NONE).count();
        &self.operands[..count]
    }
}

/// Some steps of a tape, in its order, with operands among themselves. Constants and parameters are
/// not among them.
#[derive(Clone, Debug)]
pub struct Selection {
    steps: Vec<SelectedStep>,
    /// Number of coordinates, which come first.
    coordinates: usize,
    outputs: SmallVec<[SelectedOperand; 1]>,
}

/// The steps of a selection whose bounds decide which others can be dropped.
#[derive(Clone, Debug)]
pub struct DecidingSteps {
    positions: Vec<u32>,
    /// Per step, its place among those; the largest number for other steps.
    places: Vec<u32>,
}

impl DecidingSteps {
    /// Positions of the steps, in order.
    pub fn positions(&self) -> &[u32] {
        &self.positions
    }
}

impl Selection {
    /// Selects all steps.
    ///
    /// # Panics
    /// If an operation has more than three operands, or the tape 2²⁹ steps.
    pub fn all<T: Real>(tape: &Tape<T>) -> Self {
        Self::of_clauses(tape, &Clauses::none(tape.steps().len()))
    }

    /// Selects all clauses, and all steps that are in none.
    fn of_clauses<T: Real>(tape: &Tape<T>, clauses: &Clauses) -> Self {
        assert!(tape.steps().len() < Place::NEGATED as usize, "indices of 29 bits");
        let mut steps = Vec::new();
        let mut places = vec![SelectedOperand::NONE; tape.steps().len()];
        for (index, step) in tape.steps().iter().enumerate() {
            if let Step::Coordinate(_) = step {
                places[index] = SelectedOperand(steps.len() as u32);
                steps.push(SelectedStep::new(index as u32, [SelectedOperand::NONE; 3], false));
            }
        }
        let coordinates = steps.len();
        for (index, step) in tape.steps().iter().enumerate() {
            let mut operands = [SelectedOperand::NONE; 3];
            match step {
                Step::Constant(..) | Step::Parameter(_) => {
                    places[index] = SelectedOperand(index as u32 | SelectedOperand::CONSTANT);
                    continue;
                }
                Step::Apply(..) if clauses.is_inside(index) => continue,
                Step::Apply(_, used) => {
                    let clause = clauses.ending_with(index);
                    let used = clause.map_or(&**used, |clause| &clause.used);
                    for (operand, &used) in operands[..used.len()].iter_mut().zip(used) {
                        *operand = places[used];
                    }
                }
                Step::Coordinate(_) => continue,
            }
            places[index] = SelectedOperand(steps.len() as u32);
            steps.push(SelectedStep::new(index as u32, operands, false));
        }
        let outputs = tape.outputs_at().iter().map(|&output| places[output]).collect();
        Self { steps, coordinates, outputs }
    }

    /// Positions of the coordinates. They are in every selection.
    pub fn coordinates(&self) -> std::ops::Range<usize> {
        0..self.coordinates
    }

    /// The steps.
    pub fn steps(&self) -> &[SelectedStep] {
        &self.steps
    }

    /// The steps or constants that are the values of the expressions.
    pub fn outputs(&self) -> &[SelectedOperand] {
        &self.outputs
    }
}

/// Finds which steps of a tape of one function matter in parts of space.
#[derive(Clone, Debug)]
pub struct Shortener {
    rules: Rules,
    clauses: Arc<Clauses>,
    /// Number of products of which only zeros and sign matter.
    products: usize,
    /// Number of steps whose bounds decide which others can be dropped, if no step is in a clause.
    deciding: usize,
}

impl Shortener {
    /// Examines the steps of a tape. Selections are for these values of its parameters; without
    /// values, for all. Clauses share code if at least `least_shared` differ in constants only.
    /// Blends always do.
    pub fn new<T: Real>(tape: &Tape<T>, values: &[Interval], least_shared: usize) -> Self {
        let mut rules = Rules::new(tape, values);
        let products = rules.of.iter().filter(|rule| **rule == StepRule::Product).count();
        let deciding = rules.deciding(tape);
        let clauses = Arc::new(Clauses::find(tape, &mut rules, least_shared));
        Self { rules, clauses, products, deciding }
    }

    /// Number of products of which only zeros and sign matter.
    pub fn products(&self) -> usize {
        self.products
    }

    /// Number of steps of the tape whose bounds decide which others can be dropped.
    pub fn choices(&self) -> usize {
        self.deciding
    }

    /// The steps that are selected together.
    pub fn clauses(&self) -> &Arc<Clauses> {
        &self.clauses
    }

    /// Selects all clauses of the tape, and all steps that are in none.
    ///
    /// # Panics
    /// If it is not the tape that was examined.
    pub fn all<T: Real>(&self, tape: &Tape<T>) -> Selection {
        Selection::of_clauses(tape, &self.clauses)
    }

    /// Finds the steps of a selection whose bounds decide which others can be dropped.
    ///
    /// # Panics
    /// If the selection is not of the tape that was examined.
    pub fn deciding(&self, selection: &Selection) -> DecidingSteps {
        let mut places = vec![u32::MAX; selection.steps.len()];
        let mut mark = |operand: SelectedOperand| {
            if let Some(position) = operand.position() {
                places[position] = 0;
            }
        };
        for step in &selection.steps {
            let rule = step.origin().map_or(StepRule::Neg, |origin| self.rules.of[origin]);
            rule.deciding(&step.operands).iter().copied().for_each(&mut mark);
        }
        let mut positions = Vec::new();
        for (position, place) in places.iter_mut().enumerate().filter(|(_, place)| **place == 0) {
            *place = positions.len() as u32;
            positions.push(position as u32);
        }
        DecidingSteps { positions, places }
    }

    /// Selects, for each of the lanes `open`, the steps of a selection that matter in a part of
    /// space. `bounds` tells what holds in the part of each lane for the deciding steps, in the
    /// same order.
    ///
    /// The selected function has the same zeros and signs there, and the same domain of definition.
    /// `None` for lanes that are not open, and those in which more than `most` steps matter.
    ///
    /// # Panics
    /// If the selection is not of the tape that was examined.
    pub fn select<T: Real>(
        &self,
        tape: &Tape<T>,
        from: &Selection,
        deciding: &DecidingSteps,
        bounds: &[StepBounds<T>],
        open: LaneSet,
        most: usize,
    ) -> [Option<Selection>; LANES] {
        let mut scratch = SCRATCH.take();
        let Scratch { needs, places } = &mut scratch;
        needs.find(&Choosing { tape, shortener: self, from, deciding, bounds }, open);
        if places.len() < from.steps.len() {
            places.resize(from.steps.len(), [Place(0); LANES]);
        }
        let counts = needs.counts;
        let is_short = |lane: &usize| counts[*lane] <= most;
        let short: LaneSet = lanes(open).filter(is_short).map(|lane| 1 << lane).sum();
        let mut chosen: [Vec<SelectedStep>; LANES] = std::array::from_fn(|lane| {
            Vec::with_capacity(if short >> lane & 1 == 1 { counts[lane] } else { 0 })
        });
        for (index, (step, need)) in from.steps.iter().zip(&needs.of).enumerate() {
            for lane in lanes(need.lanes & short) {
                let chosen = &mut chosen[lane];
                let mut push = |step: SelectedStep| {
                    let flag = if step.is_changed() { Place::CHANGED } else { 0 };
                    chosen.push(step);
                    Place((chosen.len() as u32 - 1) | flag)
                };
                let place = |operand: SelectedOperand| match operand.position() {
                    Some(position) => places[position][lane],
                    None => Place(operand.0),
                };
                let replaced = need.replaced.iter().position(|lanes| lanes >> lane & 1 == 1);
                places[index][lane] = if let Some(k) = replaced {
                    let substitute = place(self.candidates(step)[k]).changed();
                    let is_negated = need.negated >> lane & 1 == 1;
                    if is_negated { substitute.negated() } else { substitute }
                } else if step.origin().is_none() {
                    // Added again where it is needed.
                    place(step.operands[0]).negated()
                } else {
                    let (mut is_changed, mut is_negated) = (step.is_changed(), false);
                    let operands = step.operands.map(|operand| {
                        let place = place(operand);
                        is_changed |= place.is_changed();
                        if !place.is_negated() {
                            place.operand()
                        } else if self.is_product(step) {
                            is_negated = !is_negated;
                            place.operand()
                        } else {
                            push(SelectedStep::negation(place)).operand()
                        }
                    });
                    let place = push(SelectedStep::new(step.origin, operands, is_changed));
                    if is_negated { place.negated() } else { place }
                };
            }
        }
        let mut lane = 0;
        let selections = chosen.map(|mut steps| {
            lane += 1;
            (short >> (lane - 1) & 1 == 1).then(|| {
                let output = match from.outputs[0].position() {
                    Some(position) if places[position][lane - 1].is_negated() => {
                        steps.push(SelectedStep::negation(places[position][lane - 1]));
                        SelectedOperand(steps.len() as u32 - 1)
                    }
                    Some(position) => places[position][lane - 1].operand(),
                    None => from.outputs[0],
                };
                let outputs = SmallVec::from_slice(&[output]);
                Selection { steps, coordinates: from.coordinates, outputs }
            })
        });
        if scratch.bytes() <= SCRATCH_BYTES {
            SCRATCH.set(scratch);
        }
        selections
    }

    /// The two operands that may replace a step.
    #[inline]
    fn candidates(&self, step: &SelectedStep) -> [SelectedOperand; 2] {
        let [first, second, third] = step.operands;
        match step.origin().map(|origin| self.rules.of[origin]) {
            Some(StepRule::Choice) => [second, third],
            _ => [first, second],
        }
    }

    #[inline]
    fn is_product(&self, step: &SelectedStep) -> bool {
        step.origin().is_some_and(|origin| self.rules.of[origin] == StepRule::Product)
    }
}

/// An operand in a shorter selection, and whether its value may differ from the one that the tape
/// has in its place. Its negative may be meant: the step that negates it is added only for a user
/// that needs it.
#[derive(Clone, Copy)]
struct Place(u32);

impl Place {
    const CHANGED: u32 = 1 << 30;
    const NEGATED: u32 = 1 << 29;

    #[inline]
    fn changed(self) -> Self {
        Self(self.0 | Self::CHANGED)
    }

    #[inline]
    fn is_changed(self) -> bool {
        self.0 & Self::CHANGED != 0 && self.0 != SelectedOperand::NONE.0
    }

    #[inline]
    fn negated(self) -> Self {
        Self(self.0 ^ Self::NEGATED).changed()
    }

    #[inline]
    fn is_negated(self) -> bool {
        self.0 & Self::NEGATED != 0 && self.0 != SelectedOperand::NONE.0
    }

    #[inline]
    fn operand(self) -> SelectedOperand {
        if self.0 == SelectedOperand::NONE.0 {
            SelectedOperand::NONE
        } else {
            SelectedOperand(self.0 & !(Self::CHANGED | Self::NEGATED))
        }
    }
}
