//! Statements before trees are built: their tokens, and what the program around them adds.
//!
//! Nothing here knows whether a statement comes from a plain text or from a program.

use crate::lex::scanner::LexedStatement;
use crate::tree::aliases::Aliases;
use crate::tree::ast::{ExprKind, Name};

/// The tokens of a statement, and what the program around it adds.
pub(crate) struct RawStatement {
    pub lexed: LexedStatement,
    /// Left side of the definition, if the program gives it. The tokens are then its right side.
    pub head: Option<Head>,
    /// Expressions that the program's variables stand for here.
    pub aliases: Aliases,
    /// How the program converts the value, if it does.
    pub conversion: Option<ValueConversion>,
    /// Whether the value is a height over x and y, to be drawn as `z = value`.
    pub is_height: bool,
}

/// `name` or `name(parameters)` before a `=`.
#[derive(Clone, Debug)]
pub(crate) struct Head {
    pub name: Name,
    pub parameters: Option<Vec<Name>>,
}

/// Conversion of a value by a program, before the value gets its name.
pub(crate) enum ValueConversion {
    /// The value replaces the components `letters` of the vector `before` of `size` components.
    Write { letters: String, before: ExprKind, size: usize },
    /// The value is a condition, converted to 1 where it holds, else 0.
    Indicator,
    /// One component of the value.
    Part(char),
}
