//! What the rewriting, clearing and printing of formulas tell apart: kinds of operation, not
//! operations.
//!
//! A new function needs no new kind: the kinds here say which laws of algebra an operation obeys,
//! and most functions obey none.

use crate::Op;

/// What kind of operation it is.
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

/// Where a restriction lets its first operand through. Of several, those that stand first here are
/// the innermost when a formula is rewritten.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Restriction {
    /// Wherever the other is defined.
    Defined,
    /// Where the other is ≠ 0.
    Nonzero,
    /// Where the other is ≥ 0.
    Nonneg,
    /// Where the other is > 0.
    Positive,
}

/// The law that a function of one operand simplifies by, besides its parity and its exact values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// None.
    Plain,
    /// |c·a| = |c|·|a|, and |a| is a or −a where the sign of a is known.
    Magnitude,
    /// 1 or −1 where the sign of the operand is known, whatever its size.
    Sign,
    /// An integer is itself; any rational number has an exact value.
    Rounding(Rounding),
    /// a − ⌊a⌋: any rational number has an exact value.
    Fraction,
    /// √(a²) = |a|
    SquareRoot,
    /// ∛(a³) = a
    CubeRoot,
    /// f(g(a)) = a wherever g(a) is defined, where g is the operation named. Only the domains
    /// [`All`](crate::Domain::All) and [`Positive`](crate::Domain::Positive) of g are made use of.
    Undoes(Op),
}

/// To which integer a number is rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// The largest not above it.
    Down,
    /// The smallest not below it.
    Up,
    /// The nearest, halves to even.
    Nearest,
    /// The nearest of those no larger in magnitude.
    TowardZero,
}

/// What a function does with a minus sign of its operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parity {
    /// f(−a) = f(a)
    Even,
    /// f(−a) = −f(a)
    Odd,
    /// Neither, or not a function of one operand.
    Neither,
}
