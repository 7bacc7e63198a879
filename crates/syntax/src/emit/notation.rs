//! The notation of operations in formulas, for each format. There is no wildcard, so a new
//! operation must be listed here, even if a format has no notation for it.

use super::Format;
use zeroset_ops::Op;

/// The notation of an operation with one or two operands.
#[derive(Clone, Copy)]
pub(super) enum Notation {
    /// A name before operands in brackets.
    Call(&'static str),
    /// Text before and after the only operand.
    Around(&'static str, &'static str),
    /// A sign between operands, or before one: `formula` knows how tightly it binds.
    Sign(&'static str),
    /// The file `formula` writes the operation.
    Special,
    /// The format has no notation for the operation.
    Missing,
}

/// The notation of `op` in one of the formats that hold formulas.
pub(super) fn notation(format: Format, op: Op) -> Notation {
    use Notation::{Around, Call, Missing, Sign, Special};
    let tex = format == Format::Tex;
    let glsl = format == Format::Glsl;
    let by = |plain: &'static str, in_glsl: Notation, in_tex: Notation| match format {
        Format::Glsl => in_glsl,
        Format::Tex => in_tex,
        Format::Zset | Format::Vm => Call(plain),
    };
    // A function with the same name in all formats, apart from the backslash of LaTeX.
    let named = |plain: &'static str, command: &'static str| {
        if tex { Call(command) } else { Call(plain) }
    };
    // A function without a command in LaTeX.
    let upright = |plain: &'static str, command: &'static str| by(plain, Missing, Call(command));
    match op {
        Op::Neg | Op::Sub => Sign("-"),
        Op::Add => Sign("+"),
        Op::Mul => Sign(if tex { "\\cdot" } else { "*" }),
        Op::Div if tex => Special,
        Op::Div => Sign("/"),
        Op::WhereNonneg | Op::WherePositive | Op::WhereNonzero if glsl => Missing,
        Op::Pow
        | Op::Sqr
        | Op::SelectNegative
        | Op::WhereNonneg
        | Op::WherePositive
        | Op::WhereNonzero => Special,
        Op::Abs => by("abs", Call("abs"), Around("\\left|", "\\right|")),
        Op::Sign => named("sign", "\\operatorname{sign}"),
        Op::Floor => by("floor", Call("floor"), Around("\\lfloor ", " \\rfloor")),
        Op::Ceil => by("ceil", Call("ceil"), Around("\\lceil ", " \\rceil")),
        Op::Round => upright("round", "\\operatorname{round}"),
        Op::Trunc => named("trunc", "\\operatorname{trunc}"),
        Op::Fract => named("fract", "\\operatorname{fract}"),
        Op::Sqrt => by("sqrt", Call("sqrt"), Around("\\sqrt{", "}")),
        Op::Cbrt => by("cbrt", Missing, Around("\\sqrt[3]{", "}")),
        Op::Exp => named("exp", "\\exp"),
        Op::Ln => by("ln", Call("log"), Call("\\ln")),
        Op::Log2 => named("log2", "\\operatorname{log2}"),
        Op::Log10 => upright("log10", "\\operatorname{log10}"),
        Op::Sin => named("sin", "\\sin"),
        Op::Cos => named("cos", "\\cos"),
        Op::Tan => named("tan", "\\tan"),
        Op::Asin => named("asin", "\\arcsin"),
        Op::Acos => named("acos", "\\arccos"),
        Op::Atan => named("atan", "\\arctan"),
        Op::Sinh => named("sinh", "\\sinh"),
        Op::Cosh => named("cosh", "\\cosh"),
        Op::Tanh => named("tanh", "\\tanh"),
        Op::Asinh => named("asinh", "\\operatorname{asinh}"),
        Op::Acosh => named("acosh", "\\operatorname{acosh}"),
        Op::Atanh => named("atanh", "\\operatorname{atanh}"),
        Op::Erf => by("erf", Missing, Call("\\operatorname{erf}")),
        Op::BesselJ0 => by("besselj0", Missing, Call("J_0")),
        Op::BesselJ1 => by("besselj1", Missing, Call("J_1")),
        Op::BesselJ2 => by("besselj2", Missing, Call("J_2")),
        Op::BesselJ3 => by("besselj3", Missing, Call("J_3")),
        Op::Mod => named("mod", "\\operatorname{mod}"),
        Op::Atan2 => by("atan2", Call("atan"), Call("\\operatorname{atan2}")),
        Op::Min => named("min", "\\min"),
        Op::Max => named("max", "\\max"),
        Op::Otherwise | Op::WhereDefined => Missing,
    }
}
