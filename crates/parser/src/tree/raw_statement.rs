//! Statements before trees are built: their tokens, and additions from the surrounding program.
//!
//! Nothing here knows whether a statement comes from a plain text or from a program.

use crate::lex::scanner::LexedStatement;
use crate::tree::aliases::Aliases;
use crate::tree::ast::{ExprKind, Name};

/// The tokens of a statement, and additions from the surrounding program.
pub struct RawStatement {
    /// The tokens.
    pub lexed: LexedStatement,
    /// Left side of a definition, if the program adds it. The tokens are then the right side.
    pub head: Option<Head>,
    /// Variables of the program at this statement, with the expressions that they stand for.
    pub aliases: Aliases,
    /// Conversion of the statement's value, if the program adds one.
    pub conversion: Option<ValueConversion>,
    /// True if the value is a height over x and y. The statement then draws `z = value`.
    pub is_height: bool,
}

/// The left side of a definition: `name` or `name(parameters)`.
#[derive(Clone, Debug)]
pub struct Head {
    /// The defined name.
    pub name: Name,
    /// The parameters of a function; `None` for a value.
    pub parameters: Option<Vec<Name>>,
}

/// Conversion of a value by a program, before the value gets its name.
pub enum ValueConversion {
    /// The value replaces the components `letters` of `before`, a vector of `size` components.
    Write {
        /// The components that are replaced, such as `xz`.
        letters: String,
        /// The vector before the assignment.
        before: ExprKind,
        /// Number of components of the vector.
        size: usize,
    },
    /// The value is a condition, which becomes 1 where the condition holds, else 0.
    Indicator,
    /// The value becomes one of its components, named by a letter.
    Part(char),
}
