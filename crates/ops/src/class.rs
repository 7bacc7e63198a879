//! Kinds of operation, by the laws of algebra that they obey. Simplification, conversion to
//! rational form and printing use these laws.
//!
//! Most functions obey no law, so adding one seldom needs a new kind.

use crate::Op;

/// The kind of an operation.
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
    /// The smallest or the largest operand.
    Extremum,
    /// The second or the third operand, by the sign of the first.
    Choice,
    /// The first operand where it is defined, else the second.
    Fallback,
    /// The first operand, where the second meets a condition.
    Restriction(Restriction),
    /// A function of one operand.
    Function(Law),
    /// A function of two operands that obeys no law.
    FunctionOfTwo,
}

/// The condition under which a restriction keeps its first operand. The simplifier nests
/// restrictions in this order, the first one innermost.
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

/// The law by which a function of one operand simplifies, besides its parity and its exact values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// No law.
    Plain,
    /// |c·a| = |c|·|a|, and |a| is a or −a where the sign of a is known.
    Magnitude,
    /// 1 or −1 where the sign of the operand is known.
    Sign,
    /// Integers are unchanged, and the value at a rational number is exact.
    Rounding(Rounding),
    /// a − ⌊a⌋: the value at a rational number is exact.
    Fraction,
    /// √(a²) = |a|
    SquareRoot,
    /// ∛(a³) = a
    CubeRoot,
    /// f(g(a)) = a wherever g(a) is defined, where g is this operation. The simplifier uses the law
    /// only if the domain of g is [`All`](crate::Domain::All) or
    /// [`Positive`](crate::Domain::Positive).
    Undoes(Op),
}

/// How a function rounds a number to an integer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// The largest integer that is not above the number.
    Down,
    /// The smallest integer that is not below the number.
    Up,
    /// The nearest integer, halves to even.
    Nearest,
    /// The nearest integer of no larger magnitude.
    TowardZero,
}

/// Effect of the operand's sign on the value of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// f(−a) = f(a)
    Even,
    /// f(−a) = −f(a)
    Odd,
    /// Neither law holds, or the function has several operands.
    Neither,
}
