//! Statements with their syntax trees. Some are not in the text: they are synthesized from a
//! program's branches, loops and calls.

use crate::messages::note::Note;
use crate::span::Span;
use crate::tree::ast::{Expr, ExprKind, Function, LETTERS, Statement};
use rustc_hash::FxHashSet;

/// A statement with its syntax tree, the notes on it, and the names that it uses.
#[derive(Clone)]
pub struct BuiltStatement {
    /// The syntax tree.
    pub statement: Statement,
    /// The statement's place in the text.
    pub span: Span,
    /// Notes on the statement.
    pub notes: Vec<Note>,
    /// Names that the document defines and the statement uses.
    pub used: FxHashSet<String>,
}

impl BuiltStatement {
    /// Creates a statement that is not in the text.
    pub fn synthesized(statement: Statement, span: Span) -> Self {
        let parts = statement.expressions().into_iter().flat_map(Expr::all_parts);
        let used = parts.filter_map(|part| part.kind.defined()).map(str::to_owned).collect();
        Self { statement, span, notes: Vec::new(), used }
    }
}

/// The vector `before`, in which components of `value` replace the components that `letters` name.
pub fn with_parts(
    letters: &str,
    before: &ExprKind,
    size: usize,
    value: &ExprKind,
    span: Span,
) -> ExprKind {
    let expr = |kind: &ExprKind| Expr::new(kind.clone(), span);
    let part = |of: &ExprKind, letter: char| {
        Expr::new(ExprKind::Component(Box::new(expr(of)), letter.to_string()), span)
    };
    let parts = LETTERS.chars().take(size).map(|letter| match letters.find(letter) {
        Some(_) if letters.len() == 1 => expr(value),
        Some(at) => part(value, LETTERS.chars().nth(at).unwrap_or('x')),
        None => part(before, letter),
    });
    let function = Function::Vector(u8::try_from(size).unwrap_or(3));
    ExprKind::Call(function, parts.collect())
}
