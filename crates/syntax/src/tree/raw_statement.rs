//! Statements before trees are built: the tokens of each, and what the text around it says of them.
//!
//! Where these come from, a plain text or a program, is not known here.

use crate::lex::scanner::LexedStatement;
use crate::tree::aliases::Aliases;
use crate::tree::ast::{ExprKind, Name};

/// A statement, and what the program around it says of it.
pub(crate) struct RawStatement {
    pub lexed: LexedStatement,
    /// What it defines, where its symbols are the right side only.
    pub head: Option<Head>,
    /// What names stand for here, the last of a name counting.
    pub aliases: Aliases,
    /// What is made of its value.
    pub wrap: Option<Wrap>,
    /// Whether a height over x and y is drawn.
    pub is_height: bool,
}

/// `name` or `name(parameters)` before a `=`.
#[derive(Clone, Debug)]
pub(crate) struct Head {
    pub name: Name,
    pub parameters: Option<Vec<Name>>,
}

/// What a program makes of a value before it has a name.
pub(crate) enum Wrap {
    /// Some components of a vector are set, which had this value before.
    Write { letters: String, before: ExprKind, size: usize },
    /// 1 where a condition holds, else 0.
    Flag,
    /// One component of it.
    Pick(char),
}
