//! The thresholds of each step, from the function down to its operands, in all lanes of a batch.
//!
//! A rule names, for a step with given thresholds, those of its operands. It may also replace the
//! step by one of its operands. `docs/parts.md` has the proofs.

use super::lane_bounds::{Joint, Known, KnownLanes, LaneBounds, Passed};
use super::rules::{Blend, StepRule};
use super::{DecidingSteps, SelectedOperand, Selection, Shortener, StepBounds};
use crate::dispatch;
use crate::lanes::LANES;
use crate::real::Real;
use crate::tape::{Step, Tape};
use fearless_simd::{Level, Simd};
use zeroset_interval::Interval;

/// A set of lanes: one bit for each, the lowest for the first lane.
pub type LaneSet = u16;

/// Returns the lanes in a set.
#[inline]
pub fn lanes(mut set: LaneSet) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = set.trailing_zeros() as usize;
        set &= set.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

/// Lanes in which a step is needed.
#[derive(Clone, Copy, Default)]
pub struct StepNeed {
    /// The lanes in which any step needs this one.
    pub lanes: LaneSet,
    /// Lanes in which an operand replaces the step, for each of the two that may do so.
    pub replaced: [LaneSet; 2],
    /// Lanes in which the negative of the operand replaces the step.
    pub negated: LaneSet,
    /// The place of its thresholds, plus 1. It is 0 for a step whose operands are needed exactly,
    /// whatever its thresholds are.
    thresholds: u32,
}

/// Per selected step, in which lanes it is needed, and in which an operand replaces it.
#[derive(Default)]
pub struct StepNeeds {
    pub of: Vec<StepNeed>,
    /// Per lane, the number of steps that are needed and not replaced.
    pub counts: [usize; LANES],
    thresholds: Vec<LaneBounds>,
}

impl StepNeeds {
    /// Finds in which of the lanes `open` each step of a selection is needed.
    pub fn find<T: Real>(&mut self, choosing: &Choosing<'_, T>, open: LaneSet) {
        let from = choosing.from;
        self.of.clear();
        self.of.resize(from.steps.len(), StepNeed::default());
        self.thresholds.clear();
        self.counts = [0; LANES];
        let mut finder = NeedFinder { choosing, needs: self, level: Level::new() };
        for lane in lanes(open) {
            finder.need(from.outputs[0], lane, Interval::ZERO);
        }
        // Clauses do not name the coordinates that they use.
        for position in from.coordinates() {
            finder.needs.of[position].lanes = open;
        }
        for index in (0..from.steps.len()).rev() {
            if finder.needs.of[index].lanes != 0 {
                finder.pass_on(index);
                let StepNeed { lanes: set, replaced: [first, second], .. } = finder.needs.of[index];
                let kept = set & !first & !second;
                for (lane, count) in finder.needs.counts.iter_mut().enumerate() {
                    *count += usize::from(kept >> lane & 1);
                }
            }
        }
    }

    /// The number of bytes that are reserved.
    pub fn bytes(&self) -> usize {
        self.of.capacity() * size_of::<StepNeed>()
            + self.thresholds.capacity() * size_of::<LaneBounds>()
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
    level: Level,
}

impl<'a, T: Real> NeedFinder<'a, T> {
    /// Returns the rule of a selected step.
    #[inline]
    fn rule(&self, index: usize) -> StepRule {
        let origin = self.choosing.from.steps[index].origin();
        origin.map_or(StepRule::Neg, |origin| self.choosing.shortener.rules.of[origin])
    }

    /// Returns the thresholds of an operand in which others are to be included; `None` for a
    /// constant and for a step without thresholds. The operand is needed in the lanes of a set.
    #[inline]
    fn needed(&mut self, operand: SelectedOperand, set: LaneSet) -> Option<&mut LaneBounds> {
        let index = operand.position()?;
        let is_exact = self.needs.of[index].thresholds == 0 && self.rule(index) == StepRule::Exact;
        let StepNeeds { of, thresholds, .. } = &mut *self.needs;
        let step = &mut of[index];
        step.lanes |= set;
        if is_exact {
            return None;
        }
        if step.thresholds == 0 {
            thresholds.push(LaneBounds::NONE);
            step.thresholds = thresholds.len() as u32;
        }
        Some(&mut thresholds[step.thresholds as usize - 1])
    }

    /// Widens the thresholds of a step in a lane, so that another user's are among them.
    #[inline]
    fn need(&mut self, operand: SelectedOperand, lane: usize, thresholds: Interval) {
        if let Some(own) = self.needed(operand, 1 << lane) {
            own.widen(lane, thresholds);
        }
    }

    /// Needs the exact value of a step in some lanes.
    fn need_exact(&mut self, operand: SelectedOperand, set: LaneSet) {
        if let Some(own) = self.needed(operand, set) {
            lanes(set).for_each(|lane| own.widen(lane, Interval::ENTIRE));
        }
    }

    #[inline]
    fn thresholds(&self, index: usize, lane: usize) -> Interval {
        let step = &self.needs.of[index];
        self.needs.thresholds[step.thresholds as usize - 1].of(lane)
    }

    /// Returns what is known about an operand in all lanes.
    #[inline]
    fn known_lanes(&self, operand: SelectedOperand) -> KnownLanes<'a, T> {
        match operand.position() {
            Some(index) => {
                let place = self.choosing.deciding.places[index] as usize;
                self.choosing.bounds.get(place).map_or(KnownLanes::Nothing, KnownLanes::Found)
            }
            None => match &self.choosing.tape.steps()[operand.origin()] {
                Step::Constant(values, _) => KnownLanes::Constant(*values),
                _ => KnownLanes::Nothing,
            },
        }
    }

    /// Returns what is known about an operand in a lane.
    #[inline]
    fn known(&self, operand: SelectedOperand, lane: usize) -> Known {
        self.known_lanes(operand).of(lane)
    }

    /// Passes a step's thresholds on to its operands.
    fn pass_on(&mut self, index: usize) {
        let operands = self.choosing.from.steps[index].operands;
        let set = self.needs.of[index].lanes;
        let rule = self.rule(index);
        let pair = [operands[0], operands[1]];
        match rule {
            StepRule::Exact | StepRule::InBlend => {
                for operand in operands {
                    self.need_exact(operand, set);
                }
            }
            StepRule::Min | StepRule::Max => {
                let is_max = rule == StepRule::Max;
                self.pass_on_joint(index, pair, Joint { is_max, is_negated: false, width: None });
            }
            StepRule::Blend(number) => {
                let blend = &self.choosing.shortener.rules.blends[number as usize];
                let Blend { is_max, is_negated, width, .. } = *blend;
                self.pass_on_joint(index, pair, Joint { is_max, is_negated, width: Some(width) });
            }
            StepRule::Neg | StepRule::Shift(_) => {
                let operand = match rule {
                    StepRule::Shift(shift) => operands[shift.operand()],
                    _ => operands[0],
                };
                for lane in lanes(set) {
                    let thresholds = self.thresholds(index, lane);
                    let thresholds = match rule {
                        _ if thresholds == Interval::ENTIRE => thresholds,
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
                for lane in lanes(set) {
                    let thresholds = match self.thresholds(index, lane) {
                        Interval::ENTIRE => Interval::ENTIRE,
                        own => {
                            let other = self.known(operands[1 - sum.operand], lane).values;
                            sum.shift(other).of(own)
                        }
                    };
                    self.need(operands[sum.operand], lane, thresholds);
                }
            }
            StepRule::Restriction => {
                for lane in lanes(set) {
                    self.need(operands[0], lane, self.thresholds(index, lane));
                    // Only the sign matters, and whether there is a value.
                    self.need(operands[1], lane, Interval::ZERO);
                }
            }
            StepRule::Choice => self.pass_on_choice(index, operands),
            StepRule::Product => self.pass_on_product(index, pair),
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

    /// The rule of the minimum, the maximum and the blend.
    fn pass_on_joint(&mut self, index: usize, operands: [SelectedOperand; 2], joint: Joint) {
        dispatch!(self.level, simd => self.pass_on_joint_with(simd, index, operands, joint));
    }

    #[inline(always)]
    fn pass_on_joint_with<S: Simd>(
        &mut self,
        simd: S,
        index: usize,
        operands: [SelectedOperand; 2],
        joint: Joint,
    ) {
        let StepNeed { lanes: set, thresholds, .. } = self.needs.of[index];
        let known = operands.map(|operand| self.known_lanes(operand));
        let thresholds = &self.needs.thresholds[thresholds as usize - 1];
        let Passed { own, each, beyond: [first, second] } = joint.pass_on(simd, thresholds, known);
        let replaced = [second & set, first & !second & set];
        self.needs.of[index].replaced = replaced;
        if joint.is_negated {
            self.needs.of[index].negated = replaced[0] | replaced[1];
        }
        let both = set & !replaced[0] & !replaced[1];
        for (operand, alone) in operands.into_iter().zip(replaced) {
            for (set, thresholds) in [(alone, &own), (both, &each)] {
                if set != 0
                    && let Some(needed) = self.needed(operand, set)
                {
                    needed.widen_all(simd, set, thresholds);
                }
            }
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
            let apart = [factors[1].is_apart(), factors[0].is_apart()];
            if let Some(k) = apart.iter().position(|is_apart| *is_apart) {
                // Only zeros and sign matter, so that the other operand or its negative will do.
                self.needs.of[index].replaced[k] |= 1 << lane;
                if factors[1 - k].values.hi < 0.0 {
                    self.needs.of[index].negated |= 1 << lane;
                }
                self.need(operands[k], lane, Interval::ZERO);
            } else {
                for operand in operands {
                    self.need(operand, lane, Interval::ZERO);
                }
            }
        }
    }
}
