//! The bodies of composed functions, parsed once.

use crate::ast::{Expr, Name};
use crate::build::Builder;
use crate::grammar::{Rule, Zeroset};
use crate::limits::Limits;
use crate::scope::Scope;
use crate::span::Span;
use pest::Parser as _;
use std::sync::LazyLock;
use zeroset_ops::COMPOSED;

static BODIES: LazyLock<Vec<Expr>> = LazyLock::new(|| {
    let scope = Scope::prelude();
    let limits = Limits::default();
    COMPOSED
        .iter()
        .map(|composed| {
            let name = |text: &&str| Name { text: (*text).to_owned(), span: Span::default() };
            let locals: Vec<Name> = composed.parameters.iter().map(name).collect();
            let mut builder = Builder::new(composed.body, 0, &scope, &locals, &limits);
            let body = Zeroset::parse(Rule::line, composed.body)
                .ok()
                .and_then(|pairs| pairs.flatten().find(|pair| pair.as_rule() == Rule::expression))
                .and_then(|pair| builder.value(pair).ok());
            body.unwrap_or_else(|| panic!("the body of `{}` must parse", composed.name))
        })
        .collect()
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
