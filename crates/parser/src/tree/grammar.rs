//! The grammar, which pest compiles.

use crate::lex::token_kind::TokenKind;

pub use rules::Rule;
pub(crate) use rules::Zeroset;

/// A part of a statement, as parsed by the grammar.
pub type Pair<'i> = pest::iterators::Pair<'i, Rule>;

/// Parts of a statement that were not read yet.
pub(crate) type Pairs<'i> = pest::iterators::Pairs<'i, Rule>;

/// The parts of a line, without the end of input.
pub fn parts(line: Pair<'_>) -> Vec<Pair<'_>> {
    line.into_inner().filter(|part| part.as_rule() != Rule::EOI).collect()
}

pub(crate) fn first_kind(part: &Pair<'_>) -> Option<TokenKind> {
    part.as_str().chars().next().and_then(TokenKind::of_char)
}

/// The items that pest generates have no documentation, so they are in a separate module.
#[allow(missing_docs, clippy::pedantic)]
mod rules {
    /// The parser that pest generates from the grammar file.
    #[derive(pest_derive::Parser)]
    #[grammar = "../../grammar/zeroset.pest"]
    pub struct Zeroset;
}
