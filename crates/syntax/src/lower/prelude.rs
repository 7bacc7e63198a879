//! Parses the bodies of composed functions once.

use crate::lex::arrangement::statements;
use crate::limits::Limits;
use crate::span::Span;
use crate::tree::ast::{Expr, Name};
use crate::tree::builder::Builder;
use crate::tree::scope::Scope;
use std::sync::LazyLock;
use zeroset_ops::COMPOSED;

static BODIES: LazyLock<Vec<Expr>> = LazyLock::new(|| {
    let scope = Scope::prelude();
    let limits = Limits::default();
    let bodies = COMPOSED.iter().map(|composed| {
        let name = |text: &&str| Name { text: (*text).to_owned(), span: Span::default() };
        let locals: Vec<Name> = composed.parameters.iter().map(name).collect();
        let statements = statements(composed.body, &limits).unwrap_or_default();
        let body = statements.first().map(|lexed| {
            Builder::new(composed.body, lexed, &scope, &locals, &limits).only_expression()
        });
        let body = body.and_then(Result::ok);
        body.unwrap_or_else(|| panic!("the body of `{}` must parse", composed.name))
    });
    bodies.collect()
});

/// The body of the composed function at `index` of [`COMPOSED`].
pub(crate) fn body(index: usize) -> &'static Expr {
    &BODIES[index]
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_body_parses() {
        for (index, composed) in zeroset_ops::COMPOSED.iter().enumerate() {
            assert!(!super::body(index).to_string().is_empty(), "{}", composed.name);
        }
    }
}
