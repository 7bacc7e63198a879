//! Reads matrices of MATLAB, such as `[1 2; 3 4]`, whose rows end with semicolons.

use crate::lists::separated;
use crate::program_words::Words;
use zeroset_parser::Span;
use zeroset_parser::lex::token::{Token, bracketed, closing};
use zeroset_parser::lex::token_kind::TokenKind::*;

/// The shape of a matrix in brackets.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Row,
    Column,
    Other,
}

/// The values of a row, which blanks or commas separate.
pub(crate) fn row_values(tokens: &[Token]) -> Vec<Vec<Token>> {
    let mut values: Vec<Vec<Token>> = Vec::new();
    let mut end = None;
    let mut rest = tokens;
    while let Some(first) = rest.first() {
        let (piece, more) = rest.split_at(closing(rest).map_or(1, |close| close + 1));
        rest = more;
        let touches = end == Some(first.span.start);
        // In `[a - b]` the sign joins two values, and in `[a -b]` it begins one.
        let is_sign = first.kind == Minus
            && more.first().is_some_and(|next| next.span.start == first.span.end);
        let begins = !touches && (is_sign || first.kind.begins_operand());
        let ends = |value: &Vec<Token>| value.last().is_some_and(|last| last.kind.ends_operand());
        end = piece.last().map(|last| last.span.end);
        match values.last_mut() {
            _ if first.kind == Comma => values.push(Vec::new()),
            Some(last) if !(begins && ends(last)) => last.extend(piece),
            _ => values.push(piece.to_vec()),
        }
    }
    values.retain(|value| !value.is_empty());
    values
}

impl Words<'_> {
    /// A statement with lists in place of MATLAB's matrices. A product of a row, matrices and a
    /// column becomes a scalar product.
    pub(crate) fn with_matrices(tokens: Vec<Token>) -> Vec<Token> {
        if !tokens.iter().any(|token| token.kind == Semicolon) {
            return tokens;
        }
        let mut all: Vec<Token> = Vec::new();
        // Where the last row vector begins, if only factors follow it.
        let mut row: Option<usize> = None;
        let mut rest = tokens.as_slice();
        while let Some(first) = rest.first().copied() {
            let Some((inner, behind)) = bracketed(rest).filter(|_| first.kind == OpenBracket)
            else {
                row = row.filter(|_| first.kind == Star || first.kind.is_name());
                all.push(first);
                rest = &rest[1..];
                continue;
            };
            let (shape, list) = matrix(first, inner, rest[inner.len() + 1]);
            rest = behind;
            let factors = all.last().filter(|last| last.kind == Star).and(row);
            match (shape, factors) {
                (Shape::Column, Some(begin)) => {
                    let place = Span::at(first.span.start);
                    all.pop();
                    all.insert(begin, Token::new(OpenParen, Span::at(all[begin].span.start)));
                    all.extend([Token::new(CloseParen, place), Token::new(DotProduct, place)]);
                    row = None;
                }
                (Shape::Row, None) => row = Some(all.len()),
                _ => {}
            }
            all.extend(list);
        }
        all
    }
}

/// The shape of the matrix in brackets, and its values as a list or a list of lists.
fn matrix(open: Token, inner: &[Token], close: Token) -> (Shape, Vec<Token>) {
    let rows = inner.split(|token| token.kind == Semicolon);
    let rows: Vec<Vec<Vec<Token>>> =
        rows.map(row_values).filter(|values| !values.is_empty()).collect();
    let in_list = |values: &[Vec<Token>]| [&[open], &separated(values)[..], &[close]].concat();
    let shape = match rows.as_slice() {
        [_] => Shape::Row,
        rows if rows.iter().all(|values| values.len() == 1) => Shape::Column,
        _ => Shape::Other,
    };
    let list = match shape {
        Shape::Other => in_list(&rows.iter().map(|values| in_list(values)).collect::<Vec<_>>()),
        _ => in_list(&rows.concat()),
    };
    (shape, list)
}
