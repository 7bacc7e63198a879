//! Reads LaTeX environments: pieces of a choice, aligned lines, or the rows of a matrix. A matrix
//! becomes a list of lists, as elsewhere in the language.

use crate::lex::spelling::start;
use crate::lex::token::{Token, closing, is_outside, outside};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::span::Span;

/// Environments that hold the pieces of a choice.
const PIECES: &[&str] = &["cases", "dcases", "rcases", "array", "cases*", "dcases*"];

/// Environments that hold the elements of a matrix.
const MATRICES: &[&str] = &["matrix", "pmatrix", "bmatrix", "Bmatrix", "smallmatrix"];

/// Environments that hold a matrix between bars.
const BARRED: &[&str] = &["vmatrix", "Vmatrix"];

/// Number of bytes within which an environment must end.
const MAX_ENVIRONMENT_BYTES: usize = 10_000;

/// The token of `\begin{…}` or `\end{…}`, and its length. `last` is the preceding token's kind.
pub(crate) fn environment(rest: &str, begins: bool, last: Option<TokenKind>) -> (TokenKind, usize) {
    let open = if begins { r"\begin{".len() } else { r"\end{".len() };
    let Some(length) = start(rest, 60).get(open..).and_then(|name| name.find('}')) else {
        return (Unknown, 1);
    };
    let name = &rest[open..open + length];
    let mut end = open + length + 1;
    let is_matrix = MATRICES.contains(&name) || BARRED.contains(&name);
    if !PIECES.contains(&name) && !is_matrix {
        return (if begins { OpenAlignment } else { CloseAlignment }, end);
    }
    // Skips the column format of an array, such as `{ll}`.
    if let Some(columns) = rest[end..].strip_prefix('{').filter(|_| begins && name == "array") {
        end += columns.find('}').map_or(0, |length| length + 2);
    }
    let kind = match (begins, last) {
        // The scanner changes this kind if the matching `\begin` opened a choice or an alignment.
        (false, _) => CloseMatrix,
        (true, _) if is_matrix => OpenMatrix,
        // An array after a bracket or bar is a matrix. At the start of a statement, an environment
        // may hold lines.
        (true, Some(OpenParen | OpenBracket | Bar | OpenBar)) if name == "array" => OpenMatrix,
        (true, None) if holds_lines(&rest[end..], name) => OpenAlignment,
        _ => OpenChoice,
    };
    (kind, end)
}

/// Returns whether each row of the environment `name` is a separate formula. `rest` is the text
/// after `\begin{…}`. The environment must end its statement. Its rows must have no columns, except
/// for the alignment of an array at relations.
fn holds_lines(rest: &str, name: &str) -> bool {
    let close = format!(r"\end{{{name}}}");
    let Some((inner, behind)) = start(rest, MAX_ENVIRONMENT_BYTES).split_once(&close) else {
        return false;
    };
    let behind = behind.trim_start_matches([' ', '\t', '\r', '$', '.', ',']);
    let behind = behind.strip_prefix(r"\right.").unwrap_or(behind).trim_start();
    let is_all =
        behind.is_empty() || behind.starts_with(['\n', '$', ';', '.']) || behind.starts_with(r"\]");
    let is_aligned = |row: &str| {
        let row = row.replace(' ', "");
        ["&=&", "&<&", "&>&", r"&\le", r"&\ge", "&=", "=&"].iter().any(|sign| row.contains(sign))
    };
    let mut rows = inner.split(r"\\").filter(|row| !row.trim().is_empty());
    is_all
        && rows.all(|row| {
            let is_one = !row.contains('&') && !row.contains(r"\text");
            is_one || name == "array" && is_aligned(row)
        })
}

/// Returns a matrix as a list of lists. A matrix of one row or one column becomes a single list. In
/// `inner`, commas separate elements and `RowEnd` separates rows. Also returns the tokens that
/// enclose the list: bars for an environment such as `vmatrix`, otherwise brackets.
pub(crate) fn matrix(
    typed: &str,
    (open, close): (Token, Token),
    inner: &[Token],
) -> (Token, Vec<Token>, Token) {
    let at = |place: Span, kind: TokenKind| Token::new(kind, place);
    let rows: Vec<&[Token]> = inner.split(is_outside(RowEnd)).collect();
    let is_nested = outside(inner, Comma).is_some() && rows.len() > 1;
    let mut all = vec![at(open.span, OpenList)];
    for (index, row) in rows.into_iter().enumerate() {
        let begin = row.first().map_or(close.span.start, |first| first.span.start);
        let end = row.last().map_or(begin, |last| last.span.end);
        if index > 0 {
            all.push(at(Span::at(begin), Comma));
        }
        all.extend(is_nested.then(|| at(Span::at(begin), OpenList)));
        all.extend(row);
        all.extend(is_nested.then(|| at(Span::at(end), CloseList)));
    }
    all.push(at(close.span, CloseList));
    let is_barred = BARRED.iter().any(|name| typed.starts_with(&format!(r"\begin{{{name}}}")));
    let (before, behind) = if is_barred { (OpenBar, CloseBar) } else { (OpenParen, CloseParen) };
    (at(open.span, before), all, at(close.span, behind))
}

/// Rewrites `row matrix column` as the scalar product of `(row matrix)` and `column`. Later stages
/// do not tell rows from columns. A transposed column counts as a row.
pub(crate) fn scalar_products(text: &str, tokens: Vec<Token>) -> Vec<Token> {
    if !tokens.iter().any(|token| begins_matrix(text, *token)) {
        return tokens;
    }
    let mut all = Vec::with_capacity(tokens.len());
    let mut rest = tokens.as_slice();
    while let Some(first) = rest.first() {
        let found = row(text, rest).and_then(|(row, behind)| {
            let (between, column) = factors(text, &rest[behind..])?;
            Some((row, &rest[behind..behind + between], &rest[behind + column..]))
        });
        let Some((row, between, column)) = found else {
            all.push(*first);
            rest = &rest[1..];
            continue;
        };
        let (begin, end) = (Span::at(first.span.start), Span::at(column[0].span.start));
        all.push(Token::new(OpenParen, begin));
        all.extend(&rest[..row]);
        all.extend(between);
        all.extend([Token::new(CloseParen, end), Token::new(DotProduct, end)]);
        let length = closing(column).map_or(1, |close| close + 1);
        all.extend(&column[..length]);
        rest = &column[length..];
    }
    all
}

/// Returns whether a token opens a matrix.
fn begins_matrix(text: &str, token: Token) -> bool {
    token.kind == OpenParen && text[token.span.range()].starts_with(r"\begin{")
}

/// Lengths of the row vector at the start of `tokens`, in tokens: without and with a transposition
/// sign.
fn row(text: &str, tokens: &[Token]) -> Option<(usize, usize)> {
    let end = closing(tokens).filter(|_| begins_matrix(text, tokens[0]))? + 1;
    match shape(text, &tokens[..end]) {
        Some(Ampersand) => Some((end, end)),
        Some(_) => transposed(text, &tokens[end..]).map(|sign| (end, end + sign)),
        None => None,
    }
}

/// `Ampersand` for a matrix of one row, `RowEnd` for a matrix of one column, otherwise `None`.
fn shape(text: &str, tokens: &[Token]) -> Option<TokenKind> {
    let commas = || tokens.iter().filter(|token| token.kind == Comma);
    let is_list = tokens.get(2).is_some_and(|first| first.kind == OpenList);
    let of_columns = commas().any(|comma| &text[comma.span.range()] == "&");
    (!is_list).then_some(if of_columns { Ampersand } else { RowEnd })
}

/// Number of tokens in the transposition sign at the start of `tokens`.
fn transposed(text: &str, tokens: &[Token]) -> Option<usize> {
    let is_sign = |token: &Token| matches!(&text[token.span.range()], "T" | r"\top" | r"\intercal");
    match tokens {
        [caret, sign, ..] if caret.kind == Caret && is_sign(sign) => Some(2),
        [caret, open, sign, close, ..]
            if caret.kind == Caret
                && open.kind == OpenBrace
                && is_sign(sign)
                && close.kind == CloseBrace =>
        {
            Some(4)
        }
        _ => None,
    }
}

/// Finds a column vector that follows matrices and names. Returns the number of tokens before the
/// vector, without a last `*`, and the index of the vector's first token.
fn factors(text: &str, tokens: &[Token]) -> Option<(usize, usize)> {
    let (mut at, mut end) = (0, 0);
    loop {
        let token = *tokens.get(at)?;
        if begins_matrix(text, token) {
            let length = closing(&tokens[at..])? + 1;
            if shape(text, &tokens[at..at + length]) == Some(RowEnd) {
                return Some((end, at));
            }
            at += length;
            end = at;
        } else if token.kind.is_name() {
            at += 1;
            end = at;
        } else if token.kind == Star {
            at += 1;
        } else {
            return None;
        }
    }
}
