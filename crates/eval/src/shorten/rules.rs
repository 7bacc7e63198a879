//! The rule of thresholds for each step of a tape.

use super::clauses::{LEAST_CHOICES, choices};
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
    /// A sum or difference. The value of one operand is needed exactly; its bounds shift the
    /// thresholds of the other.
    Sum(Sum),
    /// The first operand, defined only where the second meets a condition on its sign.
    Restriction,
    /// The product of two operands, of which only zeros and sign matter.
    Product,
    /// A blend of two operands: its number among [`Rules::blends`].
    Blend(u32),
    /// A step inside a blend, which is selected with it.
    InBlend,
}

impl StepRule {
    /// Returns those operands whose bounds decide whether the step or one of them can be dropped.
    pub fn deciding<'a, O>(&self, operands: &'a [O]) -> &'a [O] {
        match self {
            Self::Min | Self::Max | Self::Product | Self::Blend(_) => &operands[..2],
            Self::Abs | Self::Choice => &operands[..1],
            Self::Sum(sum) => &operands[1 - sum.operand..][..1],
            _ => &[],
        }
    }
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
    /// The place of the operand that is not the constant.
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

/// A sum or difference of two operands that are not constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sum {
    /// The place of the operand that gets thresholds: that with more choices.
    pub operand: usize,
    /// True if the second operand is subtracted.
    pub is_difference: bool,
}

impl Sum {
    /// The rule of the operand that gets thresholds, if the other is between these bounds.
    pub fn shift(&self, other: Interval) -> Shift {
        match (self.operand, self.is_difference) {
            (0, false) => Shift::Plus(other),
            (0, true) => Shift::Plus(other.negated()),
            (_, false) => Shift::PlusSecond(other),
            (_, true) => Shift::Minus(other),
        }
    }
}

/// A quadratic blend of two values: min(a, b) − c·max(k − |a − b|, 0)².
///
/// Or that of their negatives, negated: max(a, b) + c·max(k − |a − b|, 0)².
#[derive(Clone, Debug)]
pub struct Blend {
    /// The steps a and b.
    pub operands: [usize; 2],
    /// The steps from which the blend computes its value, less its last. No other step uses them.
    pub inside: [usize; 7],
    pub is_max: bool,
    /// True if the step computes the negative of the blend.
    pub is_negated: bool,
    /// An upper bound of k.
    pub width: f64,
}

/// The rules of all steps of a tape.
#[derive(Clone, Debug)]
pub struct Rules {
    pub of: Vec<StepRule>,
    pub blends: Vec<Blend>,
}

impl Rules {
    /// Finds the rules for these values of the parameters.
    pub fn new<T: Real>(tape: &Tape<T>, values: &[Interval]) -> Self {
        let constants = Constants { tape, values };
        let mut of: Vec<StepRule> = tape.steps().iter().map(|step| constants.rule(step)).collect();
        let finder = BlendFinder { constants, users: users(tape) };
        let mut blends = Vec::new();
        for index in 0..of.len() {
            if let Some(blend) = finder.blend(index) {
                for inside in blend.inside {
                    of[inside] = StepRule::InBlend;
                }
                of[index] = StepRule::Blend(blends.len() as u32);
                blends.push(blend);
            }
        }
        find_sums(tape, &mut of, &blends);
        find_products(tape, &mut of);
        Self { of, blends }
    }

    /// Returns the number of operations whose bounds decide which steps can be dropped.
    pub fn deciding<T: Real>(&self, tape: &Tape<T>) -> usize {
        let mut is_deciding = vec![false; tape.steps().len()];
        for (rule, step) in self.of.iter().zip(tape.steps()) {
            let Step::Apply(_, operands) = step else { continue };
            let operands = match rule {
                StepRule::Blend(number) => &self.blends[*number as usize].operands,
                _ => &operands[..],
            };
            rule.deciding(operands).iter().for_each(|&operand| is_deciding[operand] = true);
        }
        let steps = tape.steps().iter().zip(is_deciding);
        steps.filter(|(step, is_deciding)| *is_deciding && is_computed(step)).count()
    }
}

/// Returns whether a step is a coordinate or an operation.
fn is_computed(step: &Step) -> bool {
    matches!(step, Step::Coordinate(_) | Step::Apply(..))
}

/// Finds the sums with an operand that has many choices.
fn find_sums<T: Real>(tape: &Tape<T>, rules: &mut [StepRule], blends: &[Blend]) {
    let choices = choices(tape, rules, blends);
    for (index, step) in tape.steps().iter().enumerate() {
        let Step::Apply(op @ (Op::Add | Op::Sub), operands) = step else { continue };
        let (a, b) = (choices[operands[0]], choices[operands[1]]);
        if rules[index] == StepRule::Exact && a.max(b) >= LEAST_CHOICES {
            let operand = usize::from(b > a);
            rules[index] = StepRule::Sum(Sum { operand, is_difference: *op == Op::Sub });
        }
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
            | StepRule::Restriction
            | StepRule::Shift(Shift::Times(_) | Shift::TimesSecond(_) | Shift::Over(_)) => true,
            StepRule::Exact
            | StepRule::Shift(_)
            | StepRule::Sum(_)
            | StepRule::Blend(_)
            | StepRule::InBlend => false,
        };
        for (place, operand) in operands.iter().enumerate() {
            let is_condition = match rules[index] {
                StepRule::Choice => place == 0,
                StepRule::Restriction => place == 1,
                _ => false,
            };
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

/// The constants of a tape, and the values of its parameters.
struct Constants<'a, T: Real> {
    tape: &'a Tape<T>,
    values: &'a [Interval],
}

impl<T: Real> Constants<'_, T> {
    fn of(&self, index: usize) -> Option<Interval> {
        match &self.tape.steps()[index] {
            Step::Constant(bounds, _) => Some(*bounds),
            Step::Parameter(number) => self.values.get(*number as usize).copied(),
            _ => None,
        }
    }

    /// Returns the rule of a step that is no blend.
    fn rule(&self, step: &Step) -> StepRule {
        let Step::Apply(op, operands) = step else { return StepRule::Exact };
        let constants = operands.iter().map(|&operand| self.of(operand));
        let constants: smallvec::SmallVec<[Option<Interval>; 3]> = constants.collect();
        let is_apart = |constant: &Interval| !constant.contains(0.0);
        let shift = match (op, &constants[..]) {
            (Op::Min, _) => return StepRule::Min,
            (Op::Max, _) => return StepRule::Max,
            (Op::Neg, _) => return StepRule::Neg,
            (Op::Abs, _) => return StepRule::Abs,
            (Op::SelectNegative, _) => return StepRule::Choice,
            (Op::WhereNonneg | Op::WherePositive | Op::WhereNonzero | Op::WhereDefined, _) => {
                return StepRule::Restriction;
            }
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
}

/// Finds blends in a tape.
struct BlendFinder<'a, T: Real> {
    constants: Constants<'a, T>,
    users: Vec<u32>,
}

impl<'a, T: Real> BlendFinder<'a, T> {
    /// Returns the operands of a step if it is this operation and has one user.
    fn only(&self, index: usize, op: Op) -> Option<&'a [usize]> {
        match &self.constants.tape.steps()[index] {
            Step::Apply(other, operands) if *other == op && self.users[index] == 1 => {
                Some(operands)
            }
            _ => None,
        }
    }

    /// Returns the constant among two operands, and the other operand.
    fn with_constant(&self, operands: &[usize]) -> Option<(Interval, usize)> {
        let &[a, b] = operands else { return None };
        let of = |one: usize, other: usize| Some((self.constants.of(one)?, other));
        of(a, b).or_else(|| of(b, a))
    }

    /// Finds whether a step is a blend.
    fn blend(&self, index: usize) -> Option<Blend> {
        let Step::Apply(op, operands) = &self.constants.tape.steps()[index] else { return None };
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
        let widths = self.constants.of(width)?;
        let &[difference] = self.only(magnitude, Op::Abs)? else { return None };
        let of = self.only(difference, Op::Sub)?;
        let &[a, b] = ends else { return None };
        let is_of_them = of == [a, b] || of == [b, a];
        // The rules hold for 0 ≤ c·k ≤ 1.
        let is_flat = factors.lo >= 0.0 && widths.lo >= 0.0 && factors.times(widths).hi <= 1.0;
        let blend = Blend {
            operands: [a, b],
            inside: [extremum, square, squared, part, rest, magnitude, difference],
            is_max,
            is_negated,
            width: widths.hi,
        };
        let is_quadratic = is_of_them && zeros == Interval::ZERO;
        (is_quadratic && is_flat && widths.is_bounded()).then_some(blend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;
    use std::path::Path;

    /// The statements in the folder `proofs` on which a rule rests.
    fn proofs(rule: &StepRule) -> &'static [&'static str] {
        match rule {
            // Wide thresholds are exact values. A step with several users has the widest.
            StepRule::Exact | StepRule::InBlend => &["widen"],
            StepRule::Min => &["min", "min-drop", "min-bounds", "clamp"],
            StepRule::Max => &["max", "max-drop", "min-bounds", "clamp"],
            StepRule::Neg => &["neg"],
            StepRule::Abs => &["abs", "abs-drop"],
            StepRule::Choice => &["choice", "choice-first", "choice-second"],
            StepRule::Shift(Shift::Times(_) | Shift::TimesSecond(_)) => {
                &["times-positive", "times-negative"]
            }
            StepRule::Shift(Shift::Over(_)) => &["over-positive", "over-negative"],
            StepRule::Shift(Shift::Plus(_) | Shift::PlusSecond(_) | Shift::Minus(_))
            | StepRule::Sum(_) => &["sum", "difference", "difference-second"],
            StepRule::Restriction => &[
                "restriction-defined",
                "restriction-nonneg",
                "restriction-nonzero",
                "restriction-positive",
            ],
            StepRule::Product => &["product", "product-drop", "product-negated"],
            StepRule::Blend(_) => {
                &["blend", "blend-max", "blend-drop", "blend-max-drop", "blend-bounds", "clamp"]
            }
        }
    }

    #[test]
    fn the_statements_that_are_proven_are_those_of_the_rules() {
        let one = Interval { lo: 1.0, hi: 1.0 };
        let rules = [
            StepRule::Exact,
            StepRule::Min,
            StepRule::Max,
            StepRule::Neg,
            StepRule::Abs,
            StepRule::Choice,
            StepRule::Shift(Shift::Plus(one)),
            StepRule::Shift(Shift::Times(one)),
            StepRule::Shift(Shift::Over(one)),
            StepRule::Sum(Sum { operand: 0, is_difference: false }),
            StepRule::Restriction,
            StepRule::Product,
            StepRule::Blend(0),
            StepRule::InBlend,
        ];
        let named: BTreeSet<String> =
            rules.iter().flat_map(proofs).map(ToString::to_string).collect();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../proofs");
        let files = std::fs::read_dir(folder).expect("the folder of proofs");
        let names = files.filter_map(|file| {
            let name = file.expect("a file").file_name().into_string().expect("a name");
            name.strip_suffix(".smt2").map(ToString::to_string)
        });
        let proven: BTreeSet<String> = names.filter(|name| name != "prelude").collect();
        assert_eq!(named, proven);
    }
}
