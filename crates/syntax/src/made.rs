//! Statements that a text does not spell out: what branches, loops and calls are written out to.

use crate::ast::{Definition, ExprKind, Function, NamedValue, Statement};
use crate::span::Span;
use crate::statement::Built;
use rustc_hash::FxHashSet;

impl Built {
    /// A statement that the text does not spell out.
    pub(crate) fn made(statement: Statement, span: Span) -> Self {
        let mut used = FxHashSet::default();
        let (Statement::Draw { expr, .. } | Statement::Define(Definition { body: expr, .. })) =
            &statement;
        for part in expr.all_parts() {
            if let ExprKind::Name(NamedValue::Defined(name))
            | ExprKind::Call(Function::Defined(name), _) = &part.kind
            {
                used.insert(name.clone());
            }
        }
        Self { statement, span, notes: Vec::new(), used }
    }
}
