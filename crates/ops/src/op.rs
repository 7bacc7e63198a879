//! The native operations and the properties that a row of the table states.

use crate::class::{Class, Parity};

/// A native operation: a node of the expression graph with its own interval rule.
///
/// The order is that of [`TABLE`](crate::TABLE). No match on this type may have a wildcard arm, so
/// that the compiler lists every match that a new operation needs to be added to.
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
    /// The row of this operation.
    pub fn row(self) -> &'static OpRow {
        &crate::TABLE[self as usize]
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
    /// The name by which it is printed and called.
    pub name: &'static str,
    /// Other accepted names.
    pub aliases: &'static [&'static str],
    /// Number of operands.
    pub arity: u8,
    /// Its notation in a formula.
    pub notation: Notation,
    /// Its domain of definition, for operands that are themselves defined.
    pub domain: Domain,
    /// Its continuity within its domain.
    pub continuity: Continuity,
    /// Integers at which a function may be continuous without a derivative. Wherever else it is
    /// continuous, it has a derivative. `None` if the points without a derivative are unknown.
    pub corners: Option<&'static [i32]>,
    /// Its kind, by the laws of algebra that it obeys.
    pub class: Class,
    /// Effect of the operand's sign on its value.
    pub parity: Parity,
    /// Pairs of argument and value, both integers, of a function of one operand. They follow from
    /// no law.
    pub values: &'static [(i32, i32)],
    /// Numerator and denominator of an operation that has poles: two functions without poles.
    pub quotient: Option<[Op; 2]>,
    /// A function of the same operand that shares most of the work, so that both are computed
    /// together.
    pub twin: Option<Op>,
    /// Largest number of floats, in `f32` and in `f64`, by which the enclosure at a point may be
    /// wider than the tightest one. It applies to bounds that come from an approximation, which are
    /// not exactly monotone in the operands' bounds. `None` if the bounds come from correctly
    /// rounded arithmetic alone; claiming `None` otherwise is unsound.
    pub excess: Option<[u64; 2]>,
    /// Its derivative with respect to some variable: a formula over the operands `a`, `b`, `c`,
    /// their derivatives `da`, `db`, `dc`, small integers and the operations of the table.
    pub derivative: &'static str,
    /// One line for help.
    pub doc: &'static str,
}

/// The notation of an operation in a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// By its name, with arguments in brackets.
    Function,
    /// By a symbol.
    Infix {
        /// The symbol, as printed.
        symbol: &'static str,
        /// Whether `name(…)` is accepted as well.
        callable: bool,
    },
    /// No notation: the operation arises from other notation or from simplification.
    Internal,
}

/// Domain of definition of an operation, as a condition on its operands.
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
    /// The domain of a power. An integer exponent ≥ 0 allows all bases, a negative one all bases ≠
    /// 0. Any other exponent needs a base > 0, or a base = 0 with an exponent > 0.
    Power,
}

/// The continuity of an operation within its domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// Everywhere in its domain.
    Domain,
    /// Everywhere but at its jumps: at integers, half integers, zero, multiples or a cut, as its
    /// help line says.
    Jumps,
}
