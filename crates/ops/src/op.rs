//! What an operation is, and the properties a row of the table states.

use crate::class::{Class, Parity};

/// A native operation: a node of the expression graph that has an interval rule of its own.
///
/// The order is that of [`TABLE`](crate::TABLE). No match on this type may have a wildcard arm: the
/// compiler then lists every place that a new row still needs.
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
    /// This operation's row.
    pub fn row(self) -> &'static Row {
        &crate::TABLE[self as usize]
    }

    /// How many operands it takes: 1, 2 or 3.
    pub fn arity(self) -> usize {
        usize::from(self.row().arity)
    }
}

/// One row of the table of operations.
#[derive(Debug)]
pub struct Row {
    /// The operation described.
    pub op: Op,
    /// The name it is printed and called by.
    pub name: &'static str,
    /// Other accepted names.
    pub aliases: &'static [&'static str],
    /// Number of operands.
    pub arity: u8,
    /// How it is written.
    pub notation: Notation,
    /// Where it is defined, for operands that are themselves defined.
    pub domain: Domain,
    /// Where it is continuous, within its domain.
    pub continuity: Continuity,
    /// Where a function is continuous and has no derivative: integers at which an operand may be;
    /// at all others of its domain, where it is continuous, it has one. `None` if that is not
    /// known.
    pub corners: Option<&'static [i32]>,
    /// Which laws of algebra it obeys.
    pub class: Class,
    /// What it does with a minus sign.
    pub parity: Parity,
    /// Where a function of one operand has a rational value that no law gives: pairs of integers,
    /// argument and value.
    pub values: &'static [(i32, i32)],
    /// Two functions without poles whose quotient it is, if it has poles and is such a quotient.
    pub quotient: Option<[Op; 2]>,
    /// A function of the same operand that shares most of its work, so that both are computed
    /// together.
    pub twin: Option<Op>,
    /// If its bounds come from an approximation: the most floats by which an enclosure of its value
    /// at a point may be wider than the tightest one, in `f32` and in `f64`; such bounds are not
    /// exactly monotone in those of the operands. `None` if they come from correctly rounded
    /// arithmetic alone; claiming `None` otherwise is unsound.
    pub excess: Option<[u64; 2]>,
    /// Its derivative by some variable: a formula over operands `a`, `b`, `c`, their derivatives
    /// `da`, `db`, `dc`, small integers and the operations of the table.
    pub derivative: &'static str,
    /// One line for help.
    pub doc: &'static str,
}

/// How an operation is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notation {
    /// By its name, with arguments in brackets.
    Function,
    /// By a symbol; `callable` if the name may be called as well.
    Infix {
        /// The symbol, as printed.
        symbol: &'static str,
        /// Whether `name(…)` is accepted too.
        callable: bool,
    },
    /// Never by a user: it arises from other notation or from simplification.
    Internal,
}

/// Where an operation is defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// For all reals.
    All,
    /// Where the first operand is ≥ 0.
    Nonneg,
    /// Where the first operand is > 0.
    Positive,
    /// Where the last operand is ≠ 0.
    LastNonzero,
    /// Where the last operand is ≥ 0.
    LastNonneg,
    /// Where the last operand is > 0.
    LastPositive,
    /// From −1 to 1.
    Unit,
    /// From −1 to 1, without both.
    UnitInside,
    /// From 1 on.
    FromOne,
    /// Where the cosine of the operand is ≠ 0.
    CosineNonzero,
    /// Where not all operands are 0.
    AnyNonzero,
    /// That of a power: all reals for an integer exponent ≥ 0, base ≠ 0 for a negative one;
    /// otherwise base > 0, or base = 0 with exponent > 0.
    Power,
}

/// Where an operation is continuous, within its domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Continuity {
    /// Everywhere in its domain.
    Domain,
    /// Everywhere but where it jumps: at integers, half integers, zero, multiples or a cut, as its
    /// doc line says.
    Jumps,
}
