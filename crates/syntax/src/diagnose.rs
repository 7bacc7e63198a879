//! What is wrong with a statement that the grammar does not accept, told from where it stopped.

use crate::error::{Error, ErrorKind};
use crate::grammar::Rule;
use crate::scan::{Piece, Token, TokenKind, is_operator_word};
use crate::span::Span;
use crate::statement::LineKind;
use pest::error::InputLocation;

/// The error behind the grammar's refusal of `piece`.
pub(crate) fn diagnose(
    text: &str,
    piece: &Piece,
    line: LineKind,
    refusal: &pest::error::Error<Rule>,
) -> Box<Error> {
    let typed = |token: &Token| &text[token.span.range()];
    let at = piece.span.start
        + match refusal.location {
            InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
        };
    let next = piece.tokens.partition_point(|token| token.span.end <= at);
    let found = piece.tokens.get(next);
    let here = found.map_or(piece.span, |token| token.span);
    match line {
        LineKind::Domain => return Error::new(here, ErrorKind::BadDomain),
        LineKind::View => return Error::new(here, ErrorKind::BadView),
        LineKind::Color => return Error::new(here, ErrorKind::BadColor),
        LineKind::Formula => {}
    }
    if let Some(error) = unknown_character(piece) {
        return error;
    }
    let before = next.checked_sub(1).map(|index| &piece.tokens[index]);
    let is_sign = |token: &Token| token.kind == TokenKind::Sign || is_operator_word(typed(token));
    let Some(found) = found else {
        let Some(last) = before else {
            return Error::new(piece.span, ErrorKind::Empty);
        };
        if is_range_word(typed(last)) {
            return Error::new(last.span, ErrorKind::BadRange);
        }
        if let Some(error) = half_fraction(text, piece, next) {
            return error;
        }
        if !is_sign(last) {
            return Error::new(Span::at(last.span.end), ErrorKind::Unfinished);
        }
        let sign = typed(last).to_owned();
        return Error::new(last.span, ErrorKind::MissingAfter { sign });
    };
    let sign = typed(found).to_owned();
    let after = piece.tokens.get(next + 1);
    if let Some(after) = after.filter(|after| sign == "=" && matches!(typed(after), "<" | ">")) {
        let meant = format!("{}=", typed(after));
        return foreign(text, found.span.to(after.span), &meant);
    }
    let Some(before) = before else {
        let kind = if is_sign(found) {
            ErrorKind::MissingBefore { sign }
        } else {
            ErrorKind::Unexpected { found: sign }
        };
        return Error::new(found.span, kind);
    };
    let both = before.span.to(found.span);
    match (typed(before), sign.as_str()) {
        ("<", "=") => return foreign(text, both, "<="),
        (">", "=") => return foreign(text, both, ">="),
        ("==", "=") | ("-", ">") | ("<", "-" | ">") => return foreign(text, both, "="),
        ("/", "/") => return foreign(text, both, "/"),
        (_, ",") if before.kind == TokenKind::Number => return comma(piece, next),
        (_, ",") if !is_sign(before) => return Error::new(found.span, ErrorKind::Comma),
        _ => {}
    }
    if is_range_word(typed(before)) {
        return Error::new(both, ErrorKind::BadRange);
    }
    if is_range_word(&sign) {
        let range = found.span.to(piece.span);
        return Error::new(Span::new(found.span.start, range.end), ErrorKind::BadRange);
    }
    if let Some(error) = half_fraction(text, piece, next) {
        return error;
    }
    if found.kind == TokenKind::Break {
        // Outside brackets it would have ended the statement, so arguments are being separated.
        return Error::new(found.span, ErrorKind::Unexpected { found: sign })
            .suggest(found.span, ",");
    }
    if is_sign(before) {
        let sign = typed(before).to_owned();
        return Error::new(before.span, ErrorKind::MissingAfter { sign });
    }
    if is_sign(found) && matches!(before.kind, TokenKind::Open(_) | TokenKind::Bar) {
        return Error::new(found.span, ErrorKind::MissingBefore { sign });
    }
    if matches!((before.kind, found.kind), (TokenKind::Open(_), TokenKind::Close(_))) {
        return Error::new(both, ErrorKind::EmptyBrackets);
    }
    Error::new(found.span, ErrorKind::Unexpected { found: short(&sign) })
}

/// A sign of other languages, and what is written here.
fn foreign(text: &str, span: Span, meant: &str) -> Box<Error> {
    let sign = text[span.range()].to_owned();
    Error::new(span, ErrorKind::ForeignOperator { sign }).suggest(span, meant)
}

/// A comma outside brackets; between two numbers it is a decimal comma.
fn comma(piece: &Piece, index: usize) -> Box<Error> {
    let token = &piece.tokens[index];
    let (before, after) = (piece.tokens.get(index - 1), piece.tokens.get(index + 1));
    let touches = |number: &Token| {
        number.kind == TokenKind::Number
            && (number.span.end == token.span.start || token.span.end == number.span.start)
    };
    match (before.filter(|t| touches(t)), after.filter(|t| touches(t))) {
        (Some(before), Some(after)) => {
            Error::new(before.span.to(after.span), ErrorKind::Comma).suggest(token.span, ".")
        }
        _ => Error::new(token.span, ErrorKind::Comma),
    }
}

/// The error for `\frac{a}` without its second braces, if the grammar stopped right behind it.
fn half_fraction(text: &str, piece: &Piece, next: usize) -> Option<Box<Error>> {
    let before = piece.tokens[..next].iter().rev();
    let mut depth = 0_usize;
    for token in before {
        match token.kind {
            TokenKind::Close('}') => depth += 1,
            TokenKind::Open('{') => depth = depth.checked_sub(1)?,
            TokenKind::Command if depth == 0 => {
                let typed = &text[token.span.range()];
                let is_fraction = matches!(typed, "\\frac" | "\\dfrac" | "\\tfrac");
                return is_fraction.then(|| Error::new(token.span, ErrorKind::HalfFraction));
            }
            // Its first part, as in `\frac1x`.
            TokenKind::Number if depth == 0 => {}
            _ if depth == 0 => return None,
            _ => {}
        }
    }
    None
}

fn is_range_word(word: &str) -> bool {
    matches!(word, "in" | "∈" | "\\in")
}

/// The first character that has no meaning, which is reported before anything else.
fn unknown_character(piece: &Piece) -> Option<Box<Error>> {
    piece.tokens.iter().find_map(|token| {
        let TokenKind::Unknown(character) = token.kind else {
            return None;
        };
        let error = Error::new(token.span, ErrorKind::UnexpectedCharacter { character });
        let meant = match character {
            '–' | '—' | '‐' | '‑' | '‒' | '－' => "-",
            '（' => "(",
            '）' => ")",
            '＋' => "+",
            '＊' | '∗' | '•' | '⋆' => "*",
            '∕' | '⁄' => "/",
            '，' => ",",
            '＝' | '：' | ':' | '≡' | '≈' => "=",
            '&' => "and",
            _ => return Some(error),
        };
        Some(error.suggest(token.span, meant))
    })
}

/// A word that is not too long for a message.
pub(crate) fn short(word: &str) -> String {
    const LONGEST: usize = 40;
    if word.chars().count() <= LONGEST {
        return word.to_owned();
    }
    word.chars().take(LONGEST).chain(['…']).collect()
}
