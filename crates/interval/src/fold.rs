//! Interval evaluation of one operation in software, for constants and range analysis.

use crate::bounds::Interval;
use crate::enclosure::{Claims, Exponent, Fact, Operand};
use crate::facts::Facts;
use crate::machine::Format;
use crate::software::{Software, Vector128};
use crate::unbounded::{product, quotient};
use zeroset_ops::{Class, Op};

/// Bounds, facts and kind of exponent of an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decorated {
    /// Interval that contains all values of the expression.
    pub bounds: Interval,
    /// Facts about where the expression is defined and continuous.
    pub facts: Facts,
    /// The expression's kind as an exponent.
    pub exponent: Exponent,
}

impl From<(Interval, Facts)> for Decorated {
    /// Takes the bounds and facts of an operand that is not a constant integer.
    fn from((bounds, facts): (Interval, Facts)) -> Self {
        Self { bounds, facts, exponent: Exponent::Real }
    }
}

/// Encloses `op` over boxes of operands in `f64`, rounded outward. Returns bounds and facts.
///
/// If the result is defined nowhere, its bounds are all reals. Bounds are the tightest for sums,
/// products, quotients, squares, square roots, minima, maxima, choices and roundings to integers.
/// They are the tightest even for infinite operands, for which kernels may be less tight.
///
/// ```
/// use zeroset_interval::{Facts, Interval, fold};
/// use zeroset_ops::Op;
///
/// let a = (Interval::new(-1.0, 4.0).unwrap(), Facts::TOTAL);
/// let (bounds, facts) = fold(Op::Sqrt, &[a]);
/// assert_eq!((bounds.lo, bounds.hi), (0.0, 2.0));
/// assert_eq!(facts, Facts::NONE); // undefined for part of the operand
/// ```
///
/// # Panics
/// If the number of operands is not the arity of `op`.
pub fn fold<V: Copy + Into<Decorated>>(op: Op, operands: &[V]) -> (Interval, Facts) {
    let values: Vec<Decorated> = operands.iter().map(|&operand| operand.into()).collect();
    fold_decorated(op, &values)
}

/// Does the work of [`fold`]. Unlike that function, it is compiled only once.
fn fold_decorated(op: Op, values: &[Decorated]) -> (Interval, Facts) {
    let operands: Vec<Operand<Vector128>> = values
        .iter()
        .map(|&Decorated { bounds: range, facts, exponent }| {
            let fact = |bit: Facts| {
                if facts.has(bit) { Fact::True } else { Fact::False }
            };
            let facts = Claims {
                nowhere: fact(Facts::NOWHERE),
                defined: fact(Facts::DEFINED),
                continuous: fact(Facts::CONTINUOUS),
            };
            let bounds = [-range.lo, range.hi].map(|end| Vector128::from_f64([end; 2]));
            Operand { value: facts.with(bounds), range, exponent }
        })
        .collect();
    let value = Software::enclose(Format::F64, op, &operands);
    let (neg_lo, hi) = (value.neg_lo.f64()[0], value.hi.f64()[0]);
    let facts = [
        (value.facts.nowhere, Facts::NOWHERE),
        (value.facts.defined, Facts::DEFINED),
        (value.facts.continuous, Facts::CONTINUOUS),
    ]
    .into_iter()
    .filter(|(fact, _)| fact.mask(&mut Software::new(), Format::F64).bits_64()[0] != 0)
    .fold(Facts::NONE, |facts, (_, bit)| facts | bit);
    if facts.has(Facts::NOWHERE) {
        return (Interval::ENTIRE, Facts::NOWHERE);
    }
    let bounds = match op.row().class {
        Class::Product => product(values[0].bounds, values[1].bounds),
        Class::Quotient => quotient(values[0].bounds, values[1].bounds),
        Class::Negation
        | Class::Sum
        | Class::Square
        | Class::Power
        | Class::Remainder
        | Class::Extremum
        | Class::Choice
        | Class::Fallback
        | Class::Restriction(_)
        | Class::Function(_)
        | Class::FunctionOfTwo => Interval { lo: 0.0 - neg_lo, hi: hi + 0.0 }, // turns −0 into 0
    };
    (bounds, facts)
}
