//! The native operations, and the properties that the table states of each.

use crate::class::{Class, Parity};

/// A native operation: a node of the expression graph with its own interval rule.
///
/// The variants are in the order of [`TABLE`](crate::TABLE). No match on this type may have a
/// wildcard arm. The compiler then lists every match that a new operation must be added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[allow(missing_docs)] // each variant is documented by its row
pub enum Op {
    Neg,
    Abs,
    Sign,
    Floor,
    Ceil,
    Round,
    Trunc,
    Fract,
    Sqr,
    Sqrt,
    Cbrt,
    Exp,
    Ln,
    Log2,
    Log10,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Asinh,
    Acosh,
    Atanh,
    Erf,
    BesselJ0,
    BesselJ1,
    BesselJ2,
    BesselJ3,
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Mod,
    Atan2,
    Min,
    Max,
    SelectNegative,
    Otherwise,
    WhereNonneg,
    WherePositive,
    WhereNonzero,
    WhereDefined,
}

impl Op {
    /// The row of the table that describes this operation.
    pub fn row(self) -> &'static OpRow {
        &crate::TABLE[self as usize]
    }

    /// The order of a Bessel function. For other operations, the result is meaningless.
    pub fn bessel_order(self) -> usize {
        (self as usize).wrapping_sub(Self::BesselJ0 as usize)
    }

    /// Number of operands: 1, 2 or 3.
    pub fn arity(self) -> usize {
        usize::from(self.row().arity)
    }
}

/// One row of the table of operations.
#[derive(Debug)]
pub struct OpRow {
    /// The operation that the row describes.
    pub op: Op,
    /// The name by which the operation is printed and called.
    pub name: &'static str,
    /// Other names that formulas may use for the operation.
    pub aliases: &'static [&'static str],
    /// Number of operands.
    pub arity: u8,
    /// Notation of the operation in a formula.
    pub notation: Notation,
    /// Domain of definition of the operation, for operands that are themselves defined.
    pub domain: Domain,
    /// Continuity of the operation within its domain of definition.
    pub continuity: Continuity,
    /// Integer operands at which a function may be continuous but not differentiable. At other
    /// operands the function is differentiable wherever it is continuous. `None` if these integers
    /// are unknown. Unused for operations that are not functions.
    pub corners: Option<&'static [i32]>,
    /// Kind of the operation, by the laws of algebra that it obeys.
    pub class: Class,
    /// Effect of the operand's sign on the operation's value.
    pub parity: Parity,
    /// Pairs of an integer operand and the function's integer value there. Only functions of one
    /// operand have such pairs. Values that follow from a law are not listed.
    pub values: &'static [(i32, i32)],
    /// For an operation with poles: its numerator and its denominator, two functions without poles.
    pub quotient: Option<[Op; 2]>,
    /// Difference quotients of the function that have a continuous extension, such as sin(a)/a.
    pub secants: &'static [Secant],
    /// A function that shares most of its work with this one, as the cosine does with the sine. For
    /// one operand, both are computed together.
    pub twin: Option<Op>,
    /// Largest number of floats, in `f32` and in `f64`, by which the enclosure at a point may be
    /// wider than the tightest enclosure. Bounds with an excess come from approximations, which are
    /// not exactly monotone in the operands' bounds. `None` if all bounds come from correctly
    /// rounded arithmetic; claiming `None` otherwise is unsound.
    pub excess: Option<[u64; 2]>,
    /// The operation's derivative with respect to some variable. It is a formula over the operands
    /// `a`, `b`, `c`, their derivatives `da`, `db`, `dc`, small integers and operations of the
    /// table.
    pub derivative: &'static str,
    /// The function's value for a complex number `w`, as a formula in the language; empty for a
    /// function without one. Where several values are possible, it is the principal value.
    pub complex: &'static str,
    /// One line of help about the operation.
    pub doc: &'static str,
}

/// A quotient (f(a) − value)/(a − at)^order, for a function f, and its continuous extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Secant {
    /// The operand at which the quotient is undefined.
    pub at: i32,
    /// The function's value there.
    pub value: i32,
    /// The exponent of the divisor.
    pub order: u8,
    /// A formula over the operand `a`, over `b`, which is `a` − `at`, small integers and operations
    /// of the table. It equals the quotient wherever that is defined, and is undefined where f is.
    /// Its enclosures stay narrow near `b` = 0.
    pub formula: &'static str,
    /// Numerator and denominator of the limit at `b` = 0. The formula may be undefined there.
    pub limit: [i32; 2],
}

/// The notation of an operation in a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// The name, with arguments in brackets.
    Function,
    /// A symbol, such as `+`.
    Infix {
        /// The symbol, as printed.
        symbol: &'static str,
        /// Whether formulas may also call the operation as `name(…)`.
        callable: bool,
    },
    /// No notation of its own: the operation arises from other notation or from simplification.
    Internal,
}

/// The domain of definition of an operation, as a condition on its operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// No condition: all reals.
    All,
    /// The first operand is ≥ 0.
    Nonneg,
    /// The first operand is > 0.
    Positive,
    /// The last operand is ≠ 0.
    LastNonzero,
    /// The last operand is ≥ 0.
    LastNonneg,
    /// The last operand is > 0.
    LastPositive,
    /// The operand is in [−1, 1].
    Unit,
    /// The operand is in (−1, 1).
    UnitInside,
    /// The operand is ≥ 1.
    FromOne,
    /// The cosine of the operand is ≠ 0.
    CosineNonzero,
    /// Not all operands are 0.
    AnyNonzero,
    /// The domain of a power. If the exponent is an integer ≥ 0, it holds all bases; if it is a
    /// negative integer, all bases but 0. For any other exponent it holds bases > 0, and a base 0
    /// if the exponent is > 0.
    Power,
}

/// The continuity of an operation within its domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// The operation is continuous everywhere in its domain.
    Domain,
    /// The operation jumps where its help line says: at integers, half integers, 0, multiples or a
    /// cut.
    Jumps,
}
