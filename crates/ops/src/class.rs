//! Kinds of operation, by the laws of algebra that they obey. The laws serve simplification,
//! conversion to rational form and printing.
//!
//! Most functions obey no law, so adding one seldom needs a new kind.

use crate::Op;

/// The kind of an operation, which states its laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// −a
    Negation,
    /// a + b or a − b
    Sum,
    /// a · b
    Product,
    /// a / b
    Quotient,
    /// a²
    Square,
    /// a to the power b
    Power,
    /// a − b·⌊a/b⌋
    Remainder,
    /// The smaller or the larger of two operands.
    Extremum,
    /// The second operand where the first is negative, else the third.
    Choice,
    /// The first operand where it is defined, else the second.
    Fallback,
    /// The first operand, defined only where the second meets a condition.
    Restriction(Restriction),
    /// A function of one operand.
    Function(Law),
    /// A function of two operands that obeys no law.
    FunctionOfTwo,
}

/// The condition on the second operand of a restriction: the restriction is defined only where the
/// condition holds. The simplifier nests restrictions in the order of these variants, the first
/// variant innermost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Restriction {
    /// The second operand is defined.
    Defined,
    /// The second operand is ≠ 0.
    Nonzero,
    /// The second operand is ≥ 0.
    Nonneg,
    /// The second operand is > 0.
    Positive,
}

/// The law by which the simplifier rewrites a function of one operand. The table states the
/// function's parity and known values separately.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// No law.
    Plain,
    /// |c·a| = |c|·|a|, and |a| is a or −a if the sign of a is known.
    Magnitude,
    /// The value is 1 or −1 if the sign of the operand is known.
    Sign,
    /// Rounds to an integer. An integer is its own value, and values at rational numbers are
    /// computed exactly.
    Rounding(Rounding),
    /// a − ⌊a⌋. Values at rational numbers are computed exactly.
    Fraction,
    /// √(a²) = |a|
    SquareRoot,
    /// ∛(a³) = a
    CubeRoot,
    /// f(g(a)) = a wherever g(a) is defined, for this operation g. The simplifier uses the law only
    /// if the domain of g is [`All`](crate::Domain::All) or [`Positive`](crate::Domain::Positive).
    Undoes(Op),
}

/// The way in which a function rounds a number to an integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// The largest integer that is not above the number.
    Down,
    /// The smallest integer that is not below the number.
    Up,
    /// The nearest integer. A number halfway between two integers goes to the even one.
    Nearest,
    /// The nearest integer whose magnitude is not larger than that of the number.
    TowardZero,
}

/// Effect of the operand's sign on a function's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// f(−a) = f(a)
    Even,
    /// f(−a) = −f(a)
    Odd,
    /// The function is neither even nor odd, or has several operands.
    Neither,
}
