//! The thresholds of each step, from the function down to its operands.
//!
//! A rule names, for a step with given thresholds, those of its operands. It may also replace the
//! step by one of its operands. `docs/parts.md` has the proofs.

use super::{Shortener, StepBounds};
use crate::real::Real;
use crate::tape::{Step, Tape};
use zeroset_interval::Interval;
use zeroset_ops::Op;

/// What each step of a tape is needed for.
pub struct StepNeeds<'a, T: Real> {
    tape: &'a Tape<T>,
    shortener: &'a Shortener,
    bounds: &'a [StepBounds],
    /// Per step, its thresholds as an interval; `None` if no step needs it.
    thresholds: Vec<Option<Interval>>,
    /// Per step, what replaces it, if anything.
    substitutes: Vec<Option<Substitute>>,
    /// Steps inside a blend. The blend has set the thresholds of their operands.
    within_blend: Vec<bool>,
}

/// An earlier step that replaces a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Substitute {
    pub step: usize,
    /// Whether the value is replaced by the negative of that step's.
    pub is_negated: bool,
}

/// A quadratic blend of two values: min(a, b) − c·max(k − |a − b|, 0)².
///
/// Or that of their negatives, negated: max(a, b) + c·max(k − |a − b|, 0)².
struct Blend {
    operands: [usize; 2],
    is_max: bool,
    /// Whether the step computes the negative of the blend.
    is_negated: bool,
    /// At least k.
    width: f64,
    /// At least k + c·k².
    reach: f64,
    /// The steps between the blend and its operands.
    within: [usize; 7],
    constants: [usize; 3],
}

impl<'a, T: Real> StepNeeds<'a, T> {
    /// Finds the thresholds of all steps of a tape of one function.
    pub fn of(tape: &'a Tape<T>, shortener: &'a Shortener, bounds: &'a [StepBounds]) -> Self {
        let count = tape.steps().len();
        let mut needs = Self {
            tape,
            shortener,
            bounds,
            thresholds: vec![None; count],
            substitutes: vec![None; count],
            within_blend: vec![false; count],
        };
        needs.need(tape.outputs_at()[0], Interval::ZERO);
        for index in (0..count).rev() {
            if let (Some(thresholds), Step::Apply(op, operands)) =
                (needs.thresholds[index], &tape.steps()[index])
                && !needs.within_blend[index]
            {
                needs.pass_on(index, *op, operands, thresholds);
            }
        }
        needs
    }

    /// Whether a step is needed.
    pub fn is_needed(&self, index: usize) -> bool {
        self.thresholds[index].is_some()
    }

    /// Returns what replaces a step.
    pub fn substitute(&self, index: usize) -> Option<Substitute> {
        self.substitutes[index]
    }

    /// Widens the thresholds of a step so that another user's are among them.
    fn need(&mut self, index: usize, thresholds: Interval) {
        let all = &mut self.thresholds[index];
        *all = Some(all.map_or(thresholds, |others| others.hull(thresholds)));
    }

    fn replace(&mut self, index: usize, by: usize, thresholds: Interval) {
        self.substitutes[index] = Some(Substitute { step: by, is_negated: false });
        self.need(by, thresholds);
    }

    /// Returns what is known about a step.
    fn known(&self, index: usize) -> StepBounds {
        if let Step::Constant(values, _) = &self.tape.steps()[index] {
            return StepBounds { values: *values, is_defined: true };
        }
        let place = self.shortener.places[index] as usize;
        let nothing = StepBounds { values: Interval::ENTIRE, is_defined: false };
        self.bounds.get(place).copied().unwrap_or(nothing)
    }

    fn constant(&self, index: usize) -> Option<Interval> {
        match &self.tape.steps()[index] {
            Step::Constant(bounds, _) => Some(*bounds),
            _ => None,
        }
    }

    /// Passes a step's thresholds on to its operands.
    fn pass_on(&mut self, index: usize, op: Op, operands: &[usize], thresholds: Interval) {
        if let Some(blend) = self.blend(index) {
            return self.pass_on_blend(index, &blend, thresholds);
        }
        match (op, operands) {
            (Op::Min, &[a, b]) => self.pass_on_least(index, [a, b], thresholds, false),
            (Op::Max, &[a, b]) => self.pass_on_least(index, [a, b], thresholds, true),
            (Op::Neg, &[a]) => self.need(a, thresholds.negated()),
            (Op::Abs, &[a]) => {
                if self.known(a).values.lo >= 0.0 {
                    return self.replace(index, a, thresholds);
                }
                let most = thresholds.hi.max(0.0);
                self.need(a, Interval { lo: -most, hi: most });
            }
            (Op::Add, &[a, b]) => match (self.constant(a), self.constant(b)) {
                (_, Some(constant)) => self.shift([a, b], thresholds.plus(constant.negated())),
                (Some(constant), _) => self.shift([b, a], thresholds.plus(constant.negated())),
                _ => self.need_all(operands),
            },
            (Op::Sub, &[a, b]) => match (self.constant(a), self.constant(b)) {
                (_, Some(constant)) => self.shift([a, b], thresholds.plus(constant)),
                (Some(constant), _) => {
                    self.shift([b, a], constant.plus(thresholds.negated()));
                }
                _ => self.need_all(operands),
            },
            (Op::Mul, &[a, b]) => match (self.constant(a), self.constant(b)) {
                (_, Some(factor)) if !factor.contains(0.0) => {
                    self.shift([a, b], thresholds.over(factor));
                }
                (Some(factor), _) if !factor.contains(0.0) => {
                    self.shift([b, a], thresholds.over(factor));
                }
                _ => self.need_all(operands),
            },
            (Op::Div, &[a, b]) => match self.constant(b) {
                Some(divisor) if !divisor.contains(0.0) => {
                    self.shift([a, b], thresholds.times(divisor));
                }
                _ => self.need_all(operands),
            },
            (Op::SelectNegative, &[condition, negative, other]) => {
                let known = self.known(condition);
                if known.is_defined && known.values.hi < 0.0 {
                    self.replace(index, negative, thresholds);
                } else if known.is_defined && known.values.lo >= 0.0 {
                    self.replace(index, other, thresholds);
                } else {
                    // The condition is compared with 0: only its sign matters.
                    self.need(condition, Interval::ZERO);
                    self.need(negative, thresholds);
                    self.need(other, thresholds);
                }
            }
            _ => self.need_all(operands),
        }
    }

    /// Needs the exact values of operands.
    fn need_all(&mut self, operands: &[usize]) {
        for &operand in operands {
            self.need(operand, Interval::ENTIRE);
        }
    }

    /// Needs an operand between thresholds, and a constant.
    fn shift(&mut self, [operand, constant]: [usize; 2], thresholds: Interval) {
        self.need(operand, thresholds);
        self.need(constant, Interval::ENTIRE);
    }

    /// The rule of the minimum, or if `is_max` of the maximum.
    fn pass_on_least(
        &mut self,
        index: usize,
        operands: [usize; 2],
        thresholds: Interval,
        is_max: bool,
    ) {
        let [a, b] = operands.map(|operand| self.known(operand));
        let is_beyond = |one: &StepBounds, other: &StepBounds| {
            // A dropped operand must not be where the result has no value.
            one.is_defined
                && if is_max {
                    one.values.hi < thresholds.lo.max(other.values.lo)
                } else {
                    one.values.lo > thresholds.hi.min(other.values.hi)
                }
        };
        if is_beyond(&b, &a) {
            self.replace(index, operands[0], thresholds);
        } else if is_beyond(&a, &b) {
            self.replace(index, operands[1], thresholds);
        } else {
            for operand in operands {
                self.need(operand, thresholds);
            }
        }
    }

    fn pass_on_blend(&mut self, index: usize, blend: &Blend, thresholds: Interval) {
        let Blend { operands, is_max, is_negated, width, reach, .. } = *blend;
        let thresholds = if is_negated { thresholds.negated() } else { thresholds };
        let by = |reach: f64| {
            let all = Interval { lo: -reach, hi: reach }.plus(thresholds);
            if is_max {
                Interval { lo: all.lo, hi: thresholds.hi }
            } else {
                Interval { lo: thresholds.lo, hi: all.hi }
            }
        };
        let farthest = by(width);
        let is_beyond = |known: StepBounds| {
            known.is_defined
                && if is_max {
                    known.values.hi < farthest.lo
                } else {
                    known.values.lo > farthest.hi
                }
        };
        let beyond = operands.map(|operand| is_beyond(self.known(operand)));
        if beyond.contains(&true) {
            let step = if beyond[1] { operands[0] } else { operands[1] };
            self.substitutes[index] = Some(Substitute { step, is_negated });
            self.need(step, thresholds);
        } else {
            for inner in blend.within {
                self.need(inner, Interval::ENTIRE);
                self.within_blend[inner] = true;
            }
            for constant in blend.constants {
                self.need(constant, Interval::ENTIRE);
            }
            for operand in operands {
                self.need(operand, by(reach));
            }
        }
    }

    /// Returns the operands of a step if it is this operation and has one user.
    fn only(&self, index: usize, op: Op) -> Option<&'a [usize]> {
        match &self.tape.steps()[index] {
            Step::Apply(other, operands) if *other == op && self.shortener.users[index] == 1 => {
                Some(operands)
            }
            _ => None,
        }
    }

    /// Returns the constant among two operands, and the other operand.
    fn with_constant(&self, operands: &[usize]) -> Option<([usize; 2], Interval)> {
        let &[a, b] = operands else { return None };
        let of = |constant: usize, other: usize| {
            self.constant(constant).map(|bounds| ([constant, other], bounds))
        };
        of(a, b).or_else(|| of(b, a))
    }

    /// Finds whether a step is a blend.
    fn blend(&self, index: usize) -> Option<Blend> {
        let Step::Apply(op, operands) = &self.tape.steps()[index] else { return None };
        let &[first, second] = &operands[..] else { return None };
        let is_negated = *op == Op::Sub && self.only(second, Op::Min).is_some();
        let (extremum, square, is_max) = match op {
            Op::Sub if is_negated => (second, first, false),
            Op::Sub if self.only(first, Op::Min).is_some() => (first, second, false),
            Op::Add if self.only(first, Op::Max).is_some() => (first, second, true),
            Op::Add if self.only(second, Op::Max).is_some() => (second, first, true),
            _ => return None,
        };
        let ends = self.only(extremum, if is_max { Op::Max } else { Op::Min })?;
        let product = self.only(square, Op::Mul)?;
        let ([factor, squared], factors) = self.with_constant(product)?;
        let &[part] = self.only(squared, Op::Sqr)? else { return None };
        let ([zero, rest], zeros) = self.with_constant(self.only(part, Op::Max)?)?;
        let &[width, magnitude] = self.only(rest, Op::Sub)? else { return None };
        let widths = self.constant(width)?;
        let &[difference] = self.only(magnitude, Op::Abs)? else { return None };
        let of = self.only(difference, Op::Sub)?;
        let &[a, b] = ends else { return None };
        let is_of_them = of == [a, b] || of == [b, a];
        // 0 ≤ 2·c·k ≤ 1
        let twice = factors.times(widths).times(Interval { lo: 2.0, hi: 2.0 });
        let is_monotone = factors.lo >= 0.0 && widths.lo >= 0.0 && twice.hi <= 1.0;
        let reach = widths.plus(factors.times(widths.power(2)));
        (is_of_them && is_monotone && zeros == Interval::ZERO && reach.is_bounded()).then_some(
            Blend {
                operands: [a, b],
                is_max,
                is_negated,
                width: widths.hi,
                reach: reach.hi,
                within: [extremum, square, squared, part, rest, magnitude, difference],
                constants: [factor, zero, width],
            },
        )
    }
}
