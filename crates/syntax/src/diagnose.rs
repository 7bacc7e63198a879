//! What is wrong with a statement that the grammar does not accept, told from where it stopped.

use crate::error::{Error, ErrorKind};
use crate::grammar::Rule;
use crate::scan::{Piece, TokenKind};
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
    match line {
        LineKind::Domain => return Error::new(piece.span, ErrorKind::BadDomain),
        LineKind::View => return Error::new(piece.span, ErrorKind::BadView),
        LineKind::Color => return Error::new(piece.span, ErrorKind::BadColor),
        LineKind::Formula => {}
    }
    let at = piece.span.start
        + match refusal.location {
            InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
        };
    let next = piece.tokens.iter().position(|token| token.span.end > at);
    let next = next.unwrap_or(piece.tokens.len());
    let found = piece.tokens.get(next);
    let before = next.checked_sub(1).map(|index| &piece.tokens[index]);
    let typed = |span: Span| text[span.range()].to_owned();
    if let Some(token) = piece
        .tokens
        .iter()
        .find(|token| matches!(token.kind, TokenKind::Unknown(_)))
    {
        let TokenKind::Unknown(character) = token.kind else {
            return Error::new(token.span, ErrorKind::Empty);
        };
        return Error::new(token.span, ErrorKind::UnexpectedCharacter { character });
    }
    let Some(found) = found else {
        let last = before.map_or(piece.span, |token| token.span);
        let sign = typed(last);
        return Error::new(last, ErrorKind::MissingAfter { sign });
    };
    let sign = typed(found.span);
    if sign == "," {
        return Error::new(found.span, ErrorKind::Comma);
    }
    match before {
        Some(before) if before.kind == TokenKind::Sign => {
            let sign = typed(before.span);
            Error::new(before.span, ErrorKind::MissingAfter { sign })
        }
        None if found.kind == TokenKind::Sign => {
            Error::new(found.span, ErrorKind::MissingBefore { sign })
        }
        _ => Error::new(found.span, ErrorKind::Unexpected { found: sign }),
    }
}
