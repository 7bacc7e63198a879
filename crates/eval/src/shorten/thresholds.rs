//! The thresholds of each step, from the function down to its operands, in all lanes of a batch.
//!
//! A rule names, for a step with given thresholds, those of its operands. It may also replace the
//! step by one of its operands. `docs/parts.md` has the proofs.

use super::rules::{Blend, StepRule};
use super::{DecidingSteps, SelectedOperand, Selection, Shortener, StepBounds};
use crate::lanes::LANES;
use crate::real::Real;
use crate::tape::{Step, Tape};
use zeroset_interval::Interval;

/// A set of lanes: one bit for each, the lowest for the first lane.
pub type LaneSet = u16;

/// Returns the lanes in a set.
pub fn lanes(mut set: LaneSet) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// Bounds of an operand's value in one lane.
#[derive(Clone, Copy)]
struct Known {
    values: Interval,
    is_defined: bool,
}

impl Known {
    /// Whether the operand has a value throughout, which is nowhere 0.
    fn is_apart(&self) -> bool {
        self.is_defined && !self.values.contains(0.0)
    }
}

/// Returns thresholds that are not beyond the bounds of the step's value, which serve as well.
fn clamped(thresholds: Interval, values: Interval) -> Interval {
    let hi = thresholds.hi.min(values.hi).max(thresholds.lo);
    Interval { lo: thresholds.lo.max(values.lo).min(hi), hi }
}

/// Bounds of the minimum, or if `is_max` of the maximum.
fn extremum(is_max: bool, [a, b]: [Interval; 2]) -> Interval {
    if is_max {
        Interval { lo: a.lo.max(b.lo), hi: a.hi.max(b.hi) }
    } else {
        Interval { lo: a.lo.min(b.lo), hi: a.hi.min(b.hi) }
    }
}

/// Lanes in which a step is needed.
#[derive(Clone, Copy, Default)]
pub struct StepNeed {
    /// The lanes in which any step needs this one.
    pub lanes: LaneSet,
    /// Lanes among them in which the step's value is needed exactly.
    exact: LaneSet,
    /// Lanes in which an operand replaces the step, for each of the two that may do so.
    pub replaced: [LaneSet; 2],
    /// Lanes in which the negative of the operand replaces the step.
    pub negated: LaneSet,
    /// The place of its thresholds for the other lanes, plus 1; 0 if there are no thresholds.
    thresholds: u32,
}

/// Per selected step, in which lanes it is needed, and in which an operand replaces it.
#[derive(Default)]
pub struct StepNeeds {
    pub of: Vec<StepNeed>,
    /// Per lane, the number of steps that are needed and not replaced.
    pub counts: [usize; LANES],
    thresholds: Vec<[Interval; LANES]>,
}

impl StepNeeds {
    /// Finds in which of the lanes `open` each step of a selection is needed.
    pub fn find<T: Real>(&mut self, choosing: &Choosing<'_, T>, open: LaneSet) {
        let from = choosing.from;
        self.of.clear();
        self.of.resize(from.steps.len(), StepNeed::default());
        self.thresholds.clear();
        self.counts = [0; LANES];
        let mut finder = NeedFinder { choosing, needs: self };
        for lane in lanes(open) {
            finder.need(from.outputs[0], lane, Interval::ZERO);
        }
        // Clauses do not name the coordinates that they use.
        for position in from.coordinates() {
            finder.needs.of[position].lanes = open;
            finder.needs.of[position].exact = open;
        }
        for index in (0..from.steps.len()).rev() {
            if finder.needs.of[index].lanes != 0 {
                finder.pass_on(index);
                let StepNeed { lanes: set, replaced: [first, second], .. } = finder.needs.of[index];
                lanes(set & !first & !second).for_each(|lane| finder.needs.counts[lane] += 1);
            }
        }
    }

    /// The number of bytes that are reserved.
    pub fn bytes(&self) -> usize {
        self.of.capacity() * size_of::<StepNeed>()
            + self.thresholds.capacity() * size_of::<[Interval; LANES]>()
    }
}

/// A selection of steps from which shorter ones are chosen, and what is known about it.
pub struct Choosing<'a, T: Real> {
    pub tape: &'a Tape<T>,
    pub shortener: &'a Shortener,
    pub from: &'a Selection,
    pub deciding: &'a DecidingSteps,
    /// The bounds of the deciding steps.
    pub bounds: &'a [StepBounds<T>],
}

/// Passes thresholds from a function down to its operands.
struct NeedFinder<'a, T: Real> {
    choosing: &'a Choosing<'a, T>,
    needs: &'a mut StepNeeds,
}

impl<T: Real> NeedFinder<'_, T> {
    /// Widens the thresholds of a step in a lane, so that another user's are among them.
    fn need(&mut self, operand: SelectedOperand, lane: usize, thresholds: Interval) {
        let Some(index) = operand.position() else { return };
        let step = &mut self.needs.of[index];
        let bit = 1 << lane;
        let is_first = step.lanes & bit == 0;
        step.lanes |= bit;
        if thresholds == Interval::ENTIRE {
            step.exact |= bit;
        }
        if step.exact & bit != 0 {
            return;
        }
        if step.thresholds == 0 {
            self.needs.thresholds.push([Interval::ZERO; LANES]);
            step.thresholds = self.needs.thresholds.len() as u32;
        }
        let own = &mut self.needs.thresholds[step.thresholds as usize - 1][lane];
        *own = if is_first { thresholds } else { own.hull(thresholds) };
    }

    /// Needs the exact value of a step in some lanes.
    fn need_exact(&mut self, operand: SelectedOperand, set: LaneSet) {
        if let Some(index) = operand.position() {
            self.needs.of[index].lanes |= set;
            self.needs.of[index].exact |= set;
        }
    }

    fn thresholds(&self, index: usize, lane: usize) -> Interval {
        let step = &self.needs.of[index];
        if step.exact >> lane & 1 == 1 {
            return Interval::ENTIRE;
        }
        self.needs.thresholds[step.thresholds as usize - 1][lane]
    }

    /// Returns what is known about an operand.
    fn known(&self, operand: SelectedOperand, lane: usize) -> Known {
        let nothing = Known { values: Interval::ENTIRE, is_defined: false };
        match operand.position() {
            Some(index) => {
                let place = self.choosing.deciding.places[index] as usize;
                self.choosing.bounds.get(place).map_or(nothing, |bounds| Known {
                    values: bounds.values(lane),
                    is_defined: bounds.is_defined(lane),
                })
            }
            None => match &self.choosing.tape.steps()[operand.origin()] {
                Step::Constant(values, _) => Known { values: *values, is_defined: true },
                _ => nothing,
            },
        }
    }

    /// Passes a step's thresholds on to its operands.
    fn pass_on(&mut self, index: usize) {
        let step = &self.choosing.from.steps[index];
        let operands = step.operands;
        let StepNeed { lanes: set, exact, .. } = self.needs.of[index];
        let shortener = self.choosing.shortener;
        let rule = step.origin().map_or(StepRule::Neg, |origin| shortener.rules.of[origin]);
        match rule {
            StepRule::Exact | StepRule::InBlend => {
                for operand in operands {
                    self.need_exact(operand, set);
                }
            }
            StepRule::Min | StepRule::Max => {
                self.pass_on_least(index, [operands[0], operands[1]], rule == StepRule::Max);
            }
            StepRule::Neg | StepRule::Shift(_) => {
                let operand = match rule {
                    StepRule::Shift(shift) => operands[shift.operand()],
                    _ => operands[0],
                };
                self.need_exact(operand, exact);
                for lane in lanes(set & !exact) {
                    let thresholds = self.thresholds(index, lane);
                    let thresholds = match rule {
                        StepRule::Shift(shift) => shift.of(thresholds),
                        _ => thresholds.negated(),
                    };
                    self.need(operand, lane, thresholds);
                }
            }
            StepRule::Abs => {
                for lane in lanes(set) {
                    let thresholds = self.thresholds(index, lane);
                    if self.known(operands[0], lane).values.lo >= 0.0 {
                        self.needs.of[index].replaced[0] |= 1 << lane;
                        self.need(operands[0], lane, thresholds);
                    } else {
                        let most = thresholds.hi.max(0.0);
                        self.need(operands[0], lane, Interval { lo: -most, hi: most });
                    }
                }
            }
            StepRule::Sum(sum) => {
                self.need_exact(operands[1 - sum.operand], set);
                self.need_exact(operands[sum.operand], exact);
                for lane in lanes(set & !exact) {
                    let other = self.known(operands[1 - sum.operand], lane).values;
                    let thresholds = sum.shift(other).of(self.thresholds(index, lane));
                    self.need(operands[sum.operand], lane, thresholds);
                }
            }
            StepRule::Restriction => {
                self.need_exact(operands[0], exact);
                for lane in lanes(set) {
                    self.need(operands[0], lane, self.thresholds(index, lane));
                    // Only the sign matters, and whether there is a value.
                    self.need(operands[1], lane, Interval::ZERO);
                }
            }
            StepRule::Choice => self.pass_on_choice(index, operands),
            StepRule::Product => self.pass_on_product(index, [operands[0], operands[1]]),
            StepRule::Blend(number) => {
                let blend = &shortener.rules.blends[number as usize];
                self.pass_on_blend(index, [operands[0], operands[1]], blend);
            }
        }
    }

    fn pass_on_choice(&mut self, index: usize, operands: [SelectedOperand; 3]) {
        let [condition, negative, other] = operands;
        for lane in lanes(self.needs.of[index].lanes) {
            let thresholds = self.thresholds(index, lane);
            let known = self.known(condition, lane);
            if known.is_defined && known.values.hi < 0.0 {
                self.needs.of[index].replaced[0] |= 1 << lane;
                self.need(negative, lane, thresholds);
            } else if known.is_defined && known.values.lo >= 0.0 {
                self.needs.of[index].replaced[1] |= 1 << lane;
                self.need(other, lane, thresholds);
            } else {
                // The condition is compared with 0: only its sign matters.
                self.need(condition, lane, Interval::ZERO);
                self.need(negative, lane, thresholds);
                self.need(other, lane, thresholds);
            }
        }
    }

    /// The rule of the minimum, or if `is_max` of the maximum.
    fn pass_on_least(&mut self, index: usize, operands: [SelectedOperand; 2], is_max: bool) {
        for lane in lanes(self.needs.of[index].lanes) {
            let [a, b] = operands.map(|operand| self.known(operand, lane));
            let own = extremum(is_max, [a.values, b.values]);
            let thresholds = clamped(self.thresholds(index, lane), own);
            // A dropped operand must not be where the result has no value.
            let is_beyond = |known: &Known| {
                known.is_defined
                    && if is_max {
                        known.values.hi < thresholds.lo
                    } else {
                        known.values.lo > thresholds.hi
                    }
            };
            let [first, second] = [is_beyond(&a), is_beyond(&b)];
            self.pass_on_either(index, lane, operands, [second, first], [thresholds; 2]);
        }
    }

    fn pass_on_product(&mut self, index: usize, operands: [SelectedOperand; 2]) {
        for lane in lanes(self.needs.of[index].lanes) {
            if self.thresholds(index, lane) != Interval::ZERO {
                for operand in operands {
                    self.need_exact(operand, 1 << lane);
                }
                continue;
            }
            let factors = operands.map(|operand| self.known(operand, lane));
            let beyond = [factors[1].is_apart(), factors[0].is_apart()];
            let other = if beyond[0] { factors[1] } else { factors[0] };
            if (beyond[0] || beyond[1]) && other.values.hi < 0.0 {
                self.needs.of[index].negated |= 1 << lane;
            }
            self.pass_on_either(index, lane, operands, beyond, [Interval::ZERO; 2]);
        }
    }

    fn pass_on_blend(&mut self, index: usize, operands: [SelectedOperand; 2], blend: &Blend) {
        let Blend { is_max, is_negated, width, depth, .. } = *blend;
        for lane in lanes(self.needs.of[index].lanes) {
            let thresholds = self.thresholds(index, lane);
            let thresholds = if is_negated { thresholds.negated() } else { thresholds };
            let known = operands.map(|operand| self.known(operand, lane));
            let own = extremum(is_max, known.map(|known| known.values));
            let reach = |lo: f64, hi: f64| Interval { lo: -lo, hi };
            let [own, each] = if is_max {
                let own = clamped(thresholds, own.plus(reach(0.0, depth)));
                [own, own.plus(reach(width, 0.0))]
            } else {
                let own = clamped(thresholds, own.plus(reach(depth, 0.0)));
                [own, own.plus(reach(0.0, width))]
            };
            let is_beyond = |known: Known| {
                known.is_defined
                    && if is_max { known.values.hi < each.lo } else { known.values.lo > each.hi }
            };
            let [first, second] = known.map(is_beyond);
            let beyond = [second, first && !second];
            if is_negated && (first || second) {
                self.needs.of[index].negated |= 1 << lane;
            }
            self.pass_on_either(index, lane, operands, beyond, [own, each]);
        }
    }

    /// Passes thresholds on to one of two operands, which replaces the step, or to both.
    /// `beyond` states for each whether it replaces the step, because the other is beyond the
    /// thresholds.
    fn pass_on_either(
        &mut self,
        index: usize,
        lane: usize,
        operands: [SelectedOperand; 2],
        beyond: [bool; 2],
        [own, each]: [Interval; 2],
    ) {
        if let Some(k) = beyond.iter().position(|is_beyond| *is_beyond) {
            self.needs.of[index].replaced[k] |= 1 << lane;
            self.need(operands[k], lane, own);
        } else {
            for operand in operands {
                self.need(operand, lane, each);
            }
        }
    }
}
