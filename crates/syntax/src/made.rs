//! Statements that a text does not spell out: what branches, loops and calls are written out to.

use crate::ast::{Definition, Expr, ExprKind, Function, NamedValue, Statement};
use crate::span::Span;
use crate::statement::Built;
use rustc_hash::FxHashSet;

impl Built {
    /// A statement that the text does not spell out.
    pub(crate) fn made(statement: Statement, span: Span) -> Self {
        let mut used = FxHashSet::default();
        let (Statement::Draw { expr, .. } | Statement::Define(Definition { body: expr, .. })) =
            &statement;
        names_in(expr, &mut used);
        Self { statement, span, notes: Vec::new(), used }
    }
}

/// Collects the names of the document that what a program makes is made of.
fn names_in(expr: &Expr, used: &mut FxHashSet<String>) {
    match &expr.kind {
        ExprKind::Name(NamedValue::Defined(name)) => {
            used.insert(name.clone());
        }
        ExprKind::Call(function, arguments) => {
            if let Function::Defined(name) = function {
                used.insert(name.clone());
            }
            for argument in arguments {
                names_in(argument, used);
            }
        }
        ExprKind::Choice(pieces, otherwise) => {
            for (condition, value) in pieces {
                names_in(condition, used);
                names_in(value, used);
            }
            if let Some(otherwise) = otherwise {
                names_in(otherwise, used);
            }
        }
        ExprKind::Compare(left, rest) => {
            names_in(left, used);
            for (_, right) in rest {
                names_in(right, used);
            }
        }
        ExprKind::Sum(left, rest) => {
            names_in(left, used);
            for (_, right) in rest {
                names_in(right, used);
            }
        }
        ExprKind::Component(inner, _) | ExprKind::Negate(inner) => names_in(inner, used),
        _ => {}
    }
}
