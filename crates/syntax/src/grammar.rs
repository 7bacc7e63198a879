//! The grammar, compiled in.

use crate::diagnose::diagnose;
use crate::error::{Error, ErrorKind, Fallible};
use crate::scan::Piece;
use pest::Parser as _;
use pest::error::{ErrorVariant, InputLocation};
pub(crate) use rules::Rule;

/// A recognised part of a statement.
pub(crate) type Pair<'i> = pest::iterators::Pair<'i, Rule>;

/// Parts of a statement that are still to be read.
pub(crate) type Pairs<'i> = pest::iterators::Pairs<'i, Rule>;

/// Recognises a statement of `text`.
pub(crate) fn recognise<'i>(text: &str, piece: &'i Piece, rule: Rule) -> Fallible<Pair<'i>> {
    let mut pairs = rules::Zeroset::parse(rule, &piece.symbols).map_err(|refusal| {
        // Where a thread has little of its stack left, pest stops.
        if matches!(&refusal.variant, ErrorVariant::CustomError { .. }) {
            return Error::new(piece.span, ErrorKind::NoStack);
        }
        let (InputLocation::Pos(at) | InputLocation::Span((at, _))) = refusal.location;
        diagnose(text, piece, rule, piece.index(at))
    })?;
    Ok(pairs.next().expect("a statement is one pair"))
}

/// A module of its own, because the generated items carry no documentation.
#[allow(missing_docs, clippy::pedantic)]
mod rules {
    /// The parser generated from the grammar file.
    #[derive(pest_derive::Parser)]
    #[grammar = "../../grammar/zeroset.pest"]
    pub(crate) struct Zeroset;
}
