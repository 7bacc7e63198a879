//! Symbols of a text, and which of them stand between brackets. What they mean is not known here.

use crate::lex::token_kind::TokenKind::{self, CloseParen, OpenParen};
use crate::span::Span;

/// A symbol and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub kind: TokenKind,
    pub span: Span,
    /// Its offset in the symbols of its statement.
    pub at: usize,
}

impl Token {
    pub(crate) fn new(kind: TokenKind, span: Span) -> Self {
        Self { kind, span, at: 0 }
    }
}

/// What is known where a symbol is read.
#[derive(Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools)] // what was seen, each by itself
pub(crate) struct Context {
    /// Whether a part of a fraction is next, which is one digit or stands in braces.
    pub is_part: bool,
    /// Whether a root of LaTeX is open, of which one digit stands below.
    pub is_radicand: bool,
    /// Whether a color is next.
    pub is_color: bool,
    /// Whether nothing stands before it on its line.
    pub starts_line: bool,
    /// The symbol before it, if nothing stands between.
    pub touching: Option<TokenKind>,
    /// The last symbol of its statement.
    pub last: Option<TokenKind>,
}

/// Tells of symbols, asked for one after the other, how many brackets are open behind each.
fn depth() -> impl FnMut(&Token) -> usize {
    let mut depth = 0_usize;
    move |token| {
        if token.kind.closer().is_some() {
            depth += 1;
        } else if token.kind.is_closer() {
            depth = depth.saturating_sub(1);
        }
        depth
    }
}

/// Tells of symbols, asked for one after the other, which are `sign` outside brackets.
pub(crate) fn is_outside(sign: TokenKind) -> impl FnMut(&Token) -> bool {
    let mut depth = depth();
    move |token| depth(token) == 0 && token.kind == sign
}

/// The first place of `sign` outside brackets.
pub(crate) fn outside(tokens: &[Token], sign: TokenKind) -> Option<usize> {
    tokens.iter().position(is_outside(sign))
}

/// The parts between `sign`, outside brackets; empty ones are left out.
pub(crate) fn split(tokens: &[Token], sign: TokenKind) -> Vec<Vec<Token>> {
    let parts = tokens.split(is_outside(sign)).filter(|part| !part.is_empty());
    parts.map(<[Token]>::to_vec).collect()
}

/// Where the bracket is closed that `tokens` begin with.
pub(crate) fn closing(tokens: &[Token]) -> Option<usize> {
    tokens.first()?.kind.closer()?;
    let mut depth = depth();
    tokens.iter().position(|token| depth(token) == 0)
}

/// What brackets hold that `tokens` begin with, and what follows them.
pub(crate) fn bracketed(tokens: &[Token]) -> Option<(&[Token], &[Token])> {
    let end = closing(tokens)?;
    Some((&tokens[1..end], &tokens[end + 1..]))
}

/// From the first of `tokens` to the last.
pub(crate) fn span_of(tokens: &[Token]) -> Option<Span> {
    Some(tokens.first()?.span.to(tokens.last()?.span))
}

/// `tokens` in brackets that were not typed.
pub(crate) fn in_brackets(tokens: &[Token]) -> Vec<Token> {
    let start = tokens.first().map_or(0, |first| first.span.start);
    let end = tokens.last().map_or(0, |last| last.span.end);
    let mut all = vec![Token::new(OpenParen, Span::at(start))];
    all.extend(tokens);
    all.push(Token::new(CloseParen, Span::at(end)));
    all
}
