//! Tokens of a text, and functions that find tokens outside brackets.

use crate::lex::token_kind::TokenKind::{self, CloseParen, OpenParen};
use crate::span::Span;

/// A token and its place in the text.
#[derive(Clone, Copy, Debug)]
pub struct Token {
    /// The token's kind.
    pub kind: TokenKind,
    /// The token's place in the text.
    pub span: Span,
    /// Byte offset of the token's character in the `symbols` of its statement.
    pub at: usize,
    /// Number of the value that the token stands for, if the kind is `Saved`.
    pub number: u32,
}

impl Token {
    /// A token of this kind at `span`.
    pub fn new(kind: TokenKind, span: Span) -> Self {
        Self { kind, span, at: 0, number: 0 }
    }
}

/// The context in which the next token is read.
#[derive(Clone, Copy, Default)]
#[allow(clippy::struct_excessive_bools)] // independent observations
pub(crate) struct LexContext {
    /// True if the next token is a part of `\frac`: one digit or letter, or a group in braces.
    pub is_part: bool,
    /// True if the preceding token is a LaTeX command. After `\sqrt`, one digit needs no braces.
    pub follows_command: bool,
    /// True if the next token may be a color, as after `color` and `background`.
    pub is_color: bool,
    /// True if the text is a program in Python.
    pub is_python: bool,
    /// True if the next token is the first on its line.
    pub starts_line: bool,
    /// Kind of the preceding token, if no blank separates it from the next token.
    pub touching: Option<TokenKind>,
    /// Kind of the preceding token in the same statement.
    pub last: Option<TokenKind>,
}

/// Returns a counter of open brackets. Call the counter with each token in order. It returns the
/// number of brackets that are open after the token.
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

/// Returns a test for a `sign` outside brackets. The test must be called with each token in order.
pub fn is_outside(sign: TokenKind) -> impl FnMut(&Token) -> bool {
    let mut depth = depth();
    move |token| depth(token) == 0 && token.kind == sign
}

/// Index of the first `sign` outside brackets.
pub fn outside(tokens: &[Token], sign: TokenKind) -> Option<usize> {
    tokens.iter().position(is_outside(sign))
}

/// Splits `tokens` at each `sign` outside brackets. Leaves out empty parts.
pub fn split(tokens: &[Token], sign: TokenKind) -> Vec<Vec<Token>> {
    let parts = tokens.split(is_outside(sign)).filter(|part| !part.is_empty());
    parts.map(<[Token]>::to_vec).collect()
}

/// Index of the bracket that closes the bracket at the start of `tokens`.
pub fn closing(tokens: &[Token]) -> Option<usize> {
    tokens.first()?.kind.closer()?;
    let mut depth = depth();
    tokens.iter().position(|token| depth(token) == 0)
}

/// The contents of the brackets at the start of `tokens`, and the tokens after the brackets.
pub fn bracketed(tokens: &[Token]) -> Option<(&[Token], &[Token])> {
    let end = closing(tokens)?;
    Some((&tokens[1..end], &tokens[end + 1..]))
}

/// The span from the first token to the last; `None` if there are no tokens.
pub fn span_of(tokens: &[Token]) -> Option<Span> {
    Some(tokens.first()?.span.to(tokens.last()?.span))
}

/// Puts `tokens` in round brackets. The brackets were not typed, so the brackets' spans are empty.
pub fn in_brackets(tokens: &[Token]) -> Vec<Token> {
    let start = tokens.first().map_or(0, |first| first.span.start);
    let end = tokens.last().map_or(0, |last| last.span.end);
    let mut all = vec![Token::new(OpenParen, Span::at(start))];
    all.extend(tokens);
    all.push(Token::new(CloseParen, Span::at(end)));
    all
}
