//! Parses the formulas of composed functions, of functions of complex numbers and of builders once.

use std::sync::LazyLock;
use zeroset_ops::{BUILDERS, COMPOSED, Composed, Op, Sequence, TABLE};
use zeroset_parser::lex::arrangement::statements;
use zeroset_parser::tree::ast::{Expr, Name};
use zeroset_parser::tree::builder::Builder;
use zeroset_parser::tree::scope::Scope;
use zeroset_parser::{Limits, Span};

/// The parameter of functions of complex numbers.
pub(crate) const COMPLEX: &str = "w";

static BODIES: LazyLock<Vec<Expr>> = LazyLock::new(|| {
    let body = |composed: &Composed| parsed(composed.name, composed.body, composed.parameters);
    COMPOSED.iter().map(body).collect()
});

static SEQUENCES: LazyLock<Vec<Option<Sequence<Expr>>>> = LazyLock::new(|| {
    let sequence = |composed: &Composed| {
        let names: Vec<&str> = composed.parameters.iter().copied().chain(["p", "q"]).collect();
        let formula = |text| parsed(composed.name, text, &names);
        composed.sequence.map(|sequence| sequence.map(formula))
    };
    COMPOSED.iter().map(sequence).collect()
});

static COMPLEX_BODIES: LazyLock<Vec<Option<Expr>>> = LazyLock::new(|| {
    let body = |row: &zeroset_ops::OpRow| {
        (!row.complex.is_empty()).then(|| parsed(row.name, row.complex, &[COMPLEX]))
    };
    TABLE.iter().map(body).collect()
});

static BUILDER_FORMULAS: LazyLock<Vec<(Option<Expr>, Expr)>> = LazyLock::new(|| {
    let formulas = |builder: &zeroset_ops::Builder| {
        let names = builder.parameters.iter().map(|(name, _)| *name);
        let names: Vec<&str> = names.chain(["i"]).collect();
        let place = (!builder.place.is_empty()).then_some(builder.place);
        let place = place.map(|place| parsed(builder.name, place, &names));
        (place, parsed(builder.name, builder.body, &names))
    };
    BUILDERS.iter().map(formulas).collect()
});

/// Parses a formula of the function called `function`, which has these parameters.
fn parsed(function: &str, formula: &str, parameters: &[&str]) -> Expr {
    let scope = Scope::prelude();
    let limits = Limits::default();
    let name = |text: &&str| Name { text: (*text).to_owned(), span: Span::default() };
    let locals: Vec<Name> = parameters.iter().map(name).collect();
    let statements = statements(formula, &limits).unwrap_or_default();
    let body = statements
        .first()
        .map(|lexed| Builder::new(formula, lexed, &scope, &locals, &limits).only_expression());
    let body = body.and_then(Result::ok);
    body.unwrap_or_else(|| panic!("the body of `{function}` must parse"))
}

/// The body of the composed function at `index` of [`COMPOSED`].
pub(crate) fn body(index: usize) -> &'static Expr {
    &BODIES[index]
}

/// The formulas of a sequence of functions; `None` for a single function.
pub(crate) fn sequence(index: usize) -> Option<&'static Sequence<Expr>> {
    SEQUENCES[index].as_ref()
}

/// The value of a function for a complex number; `None` for a function without one.
pub(crate) fn complex(op: Op) -> Option<&'static Expr> {
    COMPLEX_BODIES[op as usize].as_ref()
}

/// The place and the body of the builder at `index` of [`BUILDERS`]. The place is `None` if the
/// builder evaluates at the same point.
pub(crate) fn builder(index: usize) -> (Option<&'static Expr>, &'static Expr) {
    let (place, body) = &BUILDER_FORMULAS[index];
    (place.as_ref(), body)
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_body_parses() {
        for (index, composed) in zeroset_ops::COMPOSED.iter().enumerate() {
            assert!(!super::body(index).to_string().is_empty(), "{}", composed.name);
            let sequence = super::sequence(index);
            assert_eq!(sequence.is_some(), composed.sequence.is_some(), "{}", composed.name);
        }
        for row in zeroset_ops::TABLE {
            let body = super::complex(row.op).map(ToString::to_string);
            assert_eq!(body.is_none(), row.complex.is_empty(), "{}", row.name);
        }
        for (index, builder) in zeroset_ops::BUILDERS.iter().enumerate() {
            let (place, body) = super::builder(index);
            assert!(!body.to_string().is_empty(), "{}", builder.name);
            assert_eq!(place.is_none(), builder.place.is_empty(), "{}", builder.name);
        }
    }
}
