//! The rule of thresholds for each step of a tape.

use crate::real::Real;
use crate::tape::{Step, Tape};
use zeroset_interval::Interval;
use zeroset_ops::Op;

/// The way from a step's thresholds to those of its operands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepRule {
    /// The values of all operands are needed exactly.
    Exact,
    /// The least of two operands.
    Min,
    /// The greatest of two operands.
    Max,
    /// The negative of the operand.
    Neg,
    /// The magnitude of the operand.
    Abs,
    /// The second operand where the first is negative, else the third.
    Choice,
    /// An operand, changed by a constant.
    Shift(Shift),
    /// The product of two operands, of which only zeros and sign matter.
    Product,
    /// A blend of two operands: its number among [`Rules::blends`].
    Blend(u32),
    /// A step inside a blend. The blend passes thresholds on to its operands.
    InBlend,
}

/// A step of an operand and a constant. Its value grows or falls with the operand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shift {
    /// The first operand, plus this constant.
    Plus(Interval),
    /// The second operand, plus this constant.
    PlusSecond(Interval),
    /// This constant minus the second operand.
    Minus(Interval),
    /// The first operand times this constant.
    Times(Interval),
    /// The second operand times this constant.
    TimesSecond(Interval),
    /// The first operand, divided by this constant.
    Over(Interval),
}

impl Shift {
    /// The number of the operand that is not the constant.
    pub fn operand(&self) -> usize {
        usize::from(matches!(self, Self::PlusSecond(_) | Self::Minus(_) | Self::TimesSecond(_)))
    }

    /// The thresholds of the operand.
    pub fn of(&self, thresholds: Interval) -> Interval {
        match *self {
            Self::Plus(constant) | Self::PlusSecond(constant) => {
                thresholds.plus(constant.negated())
            }
            Self::Minus(constant) => constant.plus(thresholds.negated()),
            Self::Times(factor) | Self::TimesSecond(factor) => thresholds.over(factor),
            Self::Over(divisor) => thresholds.times(divisor),
        }
    }
}

/// A quadratic blend of two values: min(a, b) − c·max(k − |a − b|, 0)².
///
/// Or that of their negatives, negated: max(a, b) + c·max(k − |a − b|, 0)².
#[derive(Clone, Debug)]
pub struct Blend {
    /// Which operand of the blend is the minimum or the maximum, whose operands are a and b.
    pub extremum: usize,
    pub is_max: bool,
    /// True if the step computes the negative of the blend.
    pub is_negated: bool,
    /// At least k.
    pub width: f64,
    /// At least k + c·k².
    pub reach: f64,
}

/// The rules of all steps of a tape.
#[derive(Clone, Debug)]
pub struct Rules {
    pub of: Vec<StepRule>,
    pub blends: Vec<Blend>,
}

impl Rules {
    pub fn new<T: Real>(tape: &Tape<T>) -> Self {
        let finder = BlendFinder { tape, users: users(tape) };
        let mut blends = Vec::new();
        let mut of: Vec<StepRule> = tape.steps().iter().map(|step| rule(tape, step)).collect();
        for index in 0..of.len() {
            if let Some((blend, within)) = finder.blend(index) {
                for inner in within {
                    of[inner] = StepRule::InBlend;
                }
                of[index] = StepRule::Blend(blends.len() as u32);
                blends.push(blend);
            }
        }
        find_products(tape, &mut of);
        Self { of, blends }
    }
}

/// Finds the products of which only zeros and sign matter, wherever the tape is evaluated. They
/// have thresholds of 0.
fn find_products<T: Real>(tape: &Tape<T>, rules: &mut [StepRule]) {
    // Steps with a user whose operands may have other thresholds.
    let mut has_width = vec![false; rules.len()];
    for (index, step) in tape.steps().iter().enumerate().rev() {
        let Step::Apply(op, operands) = step else { continue };
        if *op == Op::Mul && rules[index] == StepRule::Exact && !has_width[index] {
            rules[index] = StepRule::Product;
        }
        let passes_zero = match rules[index] {
            StepRule::Product
            | StepRule::Min
            | StepRule::Max
            | StepRule::Neg
            | StepRule::Abs
            | StepRule::Choice
            | StepRule::Shift(Shift::Times(_) | Shift::TimesSecond(_) | Shift::Over(_)) => true,
            StepRule::Exact | StepRule::Shift(_) | StepRule::Blend(_) | StepRule::InBlend => false,
        };
        for (place, operand) in operands.iter().enumerate() {
            let is_condition = rules[index] == StepRule::Choice && place == 0;
            has_width[*operand] |= !passes_zero || has_width[index] && !is_condition;
        }
    }
}

/// Per step, the number of steps that use it.
fn users<T: Real>(tape: &Tape<T>) -> Vec<u32> {
    let mut users = vec![0; tape.steps().len()];
    for step in tape.steps() {
        if let Step::Apply(_, operands) = step {
            operands.iter().for_each(|&operand| users[operand] += 1);
        }
    }
    users
}

fn constant<T: Real>(tape: &Tape<T>, index: usize) -> Option<Interval> {
    match &tape.steps()[index] {
        Step::Constant(bounds, _) => Some(*bounds),
        _ => None,
    }
}

/// Returns the rule of a step that is no blend.
fn rule<T: Real>(tape: &Tape<T>, step: &Step) -> StepRule {
    let Step::Apply(op, operands) = step else { return StepRule::Exact };
    let constants = operands.iter().map(|&operand| constant(tape, operand));
    let constants: smallvec::SmallVec<[Option<Interval>; 3]> = constants.collect();
    let is_apart = |constant: &Interval| !constant.contains(0.0);
    let shift = match (op, &constants[..]) {
        (Op::Min, _) => return StepRule::Min,
        (Op::Max, _) => return StepRule::Max,
        (Op::Neg, _) => return StepRule::Neg,
        (Op::Abs, _) => return StepRule::Abs,
        (Op::SelectNegative, _) => return StepRule::Choice,
        (Op::Add, [_, Some(constant)]) => Shift::Plus(*constant),
        (Op::Add, [Some(constant), _]) => Shift::PlusSecond(*constant),
        (Op::Sub, [_, Some(constant)]) => Shift::Plus(constant.negated()),
        (Op::Sub, [Some(constant), _]) => Shift::Minus(*constant),
        (Op::Mul, [_, Some(factor)]) if is_apart(factor) => Shift::Times(*factor),
        (Op::Mul, [Some(factor), _]) if is_apart(factor) => Shift::TimesSecond(*factor),
        (Op::Div, [_, Some(divisor)]) if is_apart(divisor) => Shift::Over(*divisor),
        _ => return StepRule::Exact,
    };
    StepRule::Shift(shift)
}

/// Finds blends in a tape.
struct BlendFinder<'a, T: Real> {
    tape: &'a Tape<T>,
    users: Vec<u32>,
}

impl<'a, T: Real> BlendFinder<'a, T> {
    /// Returns the operands of a step if it is this operation and has one user.
    fn only(&self, index: usize, op: Op) -> Option<&'a [usize]> {
        match &self.tape.steps()[index] {
            Step::Apply(other, operands) if *other == op && self.users[index] == 1 => {
                Some(operands)
            }
            _ => None,
        }
    }

    /// Returns the constant among two operands, and the other operand.
    fn with_constant(&self, operands: &[usize]) -> Option<(Interval, usize)> {
        let &[a, b] = operands else { return None };
        let of = |one: usize, other: usize| Some((constant(self.tape, one)?, other));
        of(a, b).or_else(|| of(b, a))
    }

    /// Finds whether a step is a blend. Also returns the steps between it and its operands. None of
    /// them has another user.
    fn blend(&self, index: usize) -> Option<(Blend, [usize; 7])> {
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
        let (factors, squared) = self.with_constant(self.only(square, Op::Mul)?)?;
        let &[part] = self.only(squared, Op::Sqr)? else { return None };
        let (zeros, rest) = self.with_constant(self.only(part, Op::Max)?)?;
        let &[width, magnitude] = self.only(rest, Op::Sub)? else { return None };
        let widths = constant(self.tape, width)?;
        let &[difference] = self.only(magnitude, Op::Abs)? else { return None };
        let of = self.only(difference, Op::Sub)?;
        let &[a, b] = ends else { return None };
        let is_of_them = of == [a, b] || of == [b, a];
        // 0 ≤ 2·c·k ≤ 1
        let twice = factors.times(widths).times(Interval { lo: 2.0, hi: 2.0 });
        let is_monotone = factors.lo >= 0.0 && widths.lo >= 0.0 && twice.hi <= 1.0;
        let reach = widths.plus(factors.times(widths.power(2)));
        let blend = Blend {
            extremum: usize::from(extremum == second),
            is_max,
            is_negated,
            width: widths.hi,
            reach: reach.hi,
        };
        let within = [extremum, square, squared, part, rest, magnitude, difference];
        (is_of_them && is_monotone && zeros == Interval::ZERO && reach.is_bounded())
            .then_some((blend, within))
    }
}
