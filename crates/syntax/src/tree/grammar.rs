//! The pest grammar, compiled in.

use crate::lex::token_kind::TokenKind;

pub(crate) use rules::{Rule, Zeroset};

/// A part of a statement, as parsed by the grammar.
pub(crate) type Pair<'i> = pest::iterators::Pair<'i, Rule>;

/// Parts of a statement that are yet to be read.
pub(crate) type Pairs<'i> = pest::iterators::Pairs<'i, Rule>;

/// The parts of a line, without the end of input.
pub(crate) fn parts(line: Pair<'_>) -> Vec<Pair<'_>> {
    line.into_inner().filter(|part| part.as_rule() != Rule::EOI).collect()
}

/// The kind of the first token of a part.
pub(crate) fn first_kind(part: &Pair<'_>) -> Option<TokenKind> {
    part.as_str().chars().next().and_then(TokenKind::of_char)
}

/// The generated items have no documentation, so they are in a module of their own.
#[allow(missing_docs, clippy::pedantic)]
mod rules {
    /// The parser generated from the grammar file.
    #[derive(pest_derive::Parser)]
    #[grammar = "../../grammar/zeroset.pest"]
    pub(crate) struct Zeroset;
}
