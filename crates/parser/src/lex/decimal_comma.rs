//! Finds decimal commas, as in `x^2 + y^2 = 0,5`.
//!
//! Commas separate values. Only if a text cannot be read in this way, it is read again with points
//! in place of decimal commas. So the lexer and the grammar do not know decimal commas.

use crate::lex::scanner::scan;
use crate::lex::spelling::decimal;
use crate::lex::token::Token;
use crate::lex::token_kind::TokenKind::{Comma, Minus, Number};
use crate::limits::Limits;
use crate::messages::note::{Note, NoteKind};
use crate::span::Span;

/// The text with points in place of all decimal commas, and a note on each. All places stay the
/// same. `None` if there is no decimal comma, or if a list such as `1,2,3`, `x,0,1` or `(1,2)`
/// shows that commas separate.
pub fn with_points(text: &str, limits: &Limits) -> Option<(String, Vec<Note>)> {
    let mut points = text.as_bytes().to_vec();
    let mut notes = Vec::new();
    for statement in scan(text, limits).ok()? {
        for at in 0..statement.len() {
            let Some(span) = decimal_around(text, &statement, at) else { continue };
            if is_listed(&statement, at) {
                return None;
            }
            points[statement[at].span.start] = b'.';
            let read = decimal(&text[span.range()].replace(',', "."));
            notes.push(Note { span, kind: NoteKind::DecimalComma { read } });
        }
    }
    let points = String::from_utf8(points).ok()?;
    (!notes.is_empty()).then_some((points, notes))
}

/// The commas directly inside one pair of brackets.
#[derive(Default)]
struct Commas {
    /// Notes on commas that may be decimal commas.
    doubts: Vec<Note>,
    /// True if any other comma has a blank after it.
    has_spaced: bool,
    /// True if any other comma has no blank after it.
    has_tight: bool,
}

/// Notes on commas that separate, where a decimal comma may be meant. These are commas between
/// digits whose brackets have other commas, all with a blank after them, as in `max(0,5x, y)`.
pub fn doubts(text: &str, tokens: &[Token]) -> Vec<Note> {
    let mut notes = Vec::new();
    let mut open: Vec<Commas> = Vec::new();
    for (at, token) in tokens.iter().enumerate() {
        if token.kind.closer().is_some() {
            open.push(Commas::default());
        } else if token.kind.is_closer() {
            let closed = open.pop().filter(|commas| commas.has_spaced && !commas.has_tight);
            notes.extend(closed.into_iter().flat_map(|commas| commas.doubts));
        }
        let (Comma, Some(commas), Some(next)) = (token.kind, open.last_mut(), tokens.get(at + 1))
        else {
            continue;
        };
        if let Some(span) = decimal_around(text, tokens, at).filter(|_| !is_listed(tokens, at)) {
            let typed = text[span.range()].to_owned();
            let decimal = decimal(&typed.replace(',', "."));
            commas.doubts.push(Note { span, kind: NoteKind::DoubtfulComma { typed, decimal } });
        } else if touch(token, next) {
            commas.has_tight = true;
        } else {
            let blank = text.get(token.span.end..next.span.start);
            commas.has_spaced |= blank.is_some_and(|blank| !blank.contains('\n'));
        }
    }
    notes
}

/// The place of digits, a comma and digits without blanks between, if the comma is token `at`. An
/// exponent may follow.
pub(crate) fn decimal_around(text: &str, tokens: &[Token], at: usize) -> Option<Span> {
    let [whole, comma, decimals] = tokens.get(at.checked_sub(1)?..at + 2)? else { return None };
    let typed = |token: &Token| &text[token.span.range()];
    let are_numbers = (whole.kind, comma.kind, decimals.kind) == (Number, Comma, Number);
    let is_decimal = are_numbers
        && touch(whole, comma)
        && touch(comma, decimals)
        && typed(comma) == ","
        && typed(whole).bytes().all(|byte| byte.is_ascii_digit())
        && !typed(decimals).contains('.');
    is_decimal.then(|| whole.span.to(decimals.span))
}

/// Returns whether the two numbers around token `at` are part of a list: they fill their brackets,
/// or have another comma beside them with no blank after it.
pub(crate) fn is_listed(tokens: &[Token], at: usize) -> bool {
    let mut first = at - 1;
    if first > 0 && tokens[first - 1].kind == Minus {
        first -= 1;
    }
    let before = first.checked_sub(1).map(|index| tokens[index]);
    let after = tokens.get(at + 2);
    let fills = before.is_some_and(|open| open.kind.closer().is_some())
        && after.is_some_and(|close| close.kind.is_closer());
    let is_comma = |left: Option<&Token>, right: Option<&Token>| {
        left.zip(right).is_some_and(|(left, right)| left.kind == Comma && touch(left, right))
    };
    fills || is_comma(before.as_ref(), tokens.get(first)) || is_comma(after, tokens.get(at + 3))
}

fn touch(left: &Token, right: &Token) -> bool {
    left.span.end == right.span.start
}
