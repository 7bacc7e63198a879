//! Recognizes statements that draw curves, points and parametric surfaces, by their tokens.
//!
//! `curve f = 0, g = 0` and `(cos t, sin t, t) for t in [0, 20]` draw curves. `(1, 2, 3)` draws a
//! point. `(u, v, u v) for u in [0, 1], v in [0, 1]` draws a surface. A statement found here begins
//! with the word `curve` or `point`, which is added if it was not typed. A parameter's range gets
//! the form `for t in [a, b]`. Names have no meaning here.

use crate::lex::spelling::plain_name;
use crate::lex::token::{Token, bracketed, closing, outside, split};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::span::Span;

/// The tokens of a statement that draws a curve or a point, with its word and its range in standard
/// form. `None` for other statements.
pub fn marked_curve(text: &str, tokens: &[Token]) -> Option<Vec<Token>> {
    let typed = |token: &Token| plain_name(&text[token.span.range()]);
    let word = match tokens.first() {
        Some(first) if first.kind == TokenKind::Name => typed(first),
        _ => String::new(),
    };
    let is_labeled =
        after_tuple(tokens).is_some_and(|behind| !behind.is_empty() && is_label(text, behind));
    let rest = match word.as_str() {
        _ if is_labeled => tokens,
        "curve" if is_curve(tokens) => &tokens[1..],
        "point" if after_tuple(&tokens[1..]).is_some_and(|rest| is_label(text, rest)) => {
            &tokens[1..]
        }
        _ => without_head(tokens),
    };
    if rest.is_empty() {
        return None;
    }
    let is_curve = word == "curve" && rest.len() < tokens.len();
    let is_word = is_curve || word == "point" && rest.len() < tokens.len();
    let first = if is_word { tokens[0].span } else { Span::at(tokens[0].span.start) };
    let mut marked = Vec::with_capacity(tokens.len() + 8);
    let is_point = is_labeled || is_word && !is_curve || after_triple(tokens).is_some();
    if let Some(behind) = after_tuple(rest).filter(|behind| is_point && is_label(text, behind)) {
        marked.push(Token::new(PointWord, first));
        marked.extend(in_parentheses(&rest[..rest.len() - behind.len()]));
        marked.extend(behind.iter().map(|label| Token::new(Label, label.span)));
    } else if let Some((at, range)) = path(text, rest, is_curve) {
        marked.push(Token::new(CurveWord, first));
        marked.extend(at);
        marked.extend(range);
    } else if is_curve {
        marked.push(Token::new(CurveWord, first));
        marked.extend(rest);
    } else {
        return None;
    }
    Some(marked)
}

/// The tokens after the left side of `r(t) = (…)` or `(x, y, z) = (…)`. Empty if these are not
/// three coordinates.
fn without_head(tokens: &[Token]) -> &[Token] {
    let is_start =
        |pair: &[Token]| pair[0].kind == Equals && matches!(pair[1].kind, OpenParen | OpenList);
    let start = tokens.windows(2).position(is_start).filter(|at| is_head(&tokens[..*at]));
    let rest = &tokens[start.map_or(0, |at| at + 1)..];
    let end = rest.iter().position(|token| token.kind == In).unwrap_or(0);
    let is_path = end > 2 && is_sum(&rest[..end - 2]);
    if is_path || after_triple(rest).is_some() { rest } else { &[] }
}

/// Returns whether `tokens` may be the left side of a curve. LaTeX writes a bold name in braces.
fn is_head(tokens: &[Token]) -> bool {
    let is_call = |rest: &[Token]| bracketed(rest).is_some_and(|(_, rest)| rest.is_empty());
    match tokens {
        [name] => name.kind.is_name(),
        [open, name, close, rest @ ..] if (open.kind, close.kind) == (OpenBrace, CloseBrace) => {
            name.kind.is_name() && (rest.is_empty() || is_call(rest))
        }
        [name, rest @ ..] if name.kind.is_name() => is_call(rest),
        head => after_triple(head).is_some_and(<[Token]>::is_empty),
    }
}

/// Returns whether the word `curve` at the start of `tokens` is no name of the document.
fn is_curve(tokens: &[Token]) -> bool {
    let Some(next) = tokens.get(1) else { return false };
    let has_comma = outside(tokens, Comma).is_some();
    match next.kind {
        // `curve(t) = …` defines a function, and `curve(t)` calls it.
        OpenParen => {
            let behind = closing(&tokens[1..]).and_then(|end| tokens.get(end + 2));
            let is_apart = tokens[0].span.end < next.span.start;
            has_comma || is_apart && behind.is_none_or(|sign| sign.kind != Equals)
        }
        // `curve -x` has a sign, and `curve - x` is a difference.
        Plus | Minus => {
            let is_sign = tokens[0].span.end < next.span.start
                && tokens.get(2).is_some_and(|after| after.span.start == next.span.end);
            has_comma || is_sign
        }
        kind => kind.begins_operand(),
    }
}

/// If `tokens` begin with three coordinates in brackets, returns the tokens after them.
fn after_triple(tokens: &[Token]) -> Option<&[Token]> {
    let (inner, _) = bracketed(tokens)?;
    after_tuple(tokens).filter(|_| split(inner, Comma).len() == 3)
}

/// If `tokens` begin with several values in brackets, returns the tokens after them.
fn after_tuple(tokens: &[Token]) -> Option<&[Token]> {
    let (inner, rest) = bracketed(tokens)?;
    let is_list = matches!(tokens[0].kind, OpenParen | OpenList);
    (is_list && outside(inner, Comma).is_some()).then_some(rest)
}

/// The tokens of a point. Brackets of a list become round brackets.
fn in_parentheses(point: &[Token]) -> Vec<Token> {
    let mut point = point.to_vec();
    if let [open, .., close] = point.as_mut_slice()
        && open.kind == OpenList
    {
        (open.kind, close.kind) = (OpenParen, CloseParen);
    }
    point
}

/// Returns whether `rest` is empty, or is the label of a point.
fn is_label(text: &str, rest: &[Token]) -> bool {
    match rest {
        [] => true,
        [label] => label.kind == Unknown && text[label.span.range()].starts_with('"'),
        _ => false,
    }
}

/// The point that moves along a curve or a surface, and the ranges of its parameters, in the form
/// that the grammar reads. `None` without ranges, or with more than two.
fn path(text: &str, tokens: &[Token], is_curve: bool) -> Option<(Vec<Token>, Vec<Token>)> {
    let word = |token: &Token| {
        let is_name = token.kind == TokenKind::Name;
        if is_name { &text[token.span.range()] } else { "" }
    };
    let word_for = || {
        let at = tokens.iter().position(|token| word(token) == "for")?;
        (is_curve || is_sum(&tokens[..at])).then_some(at)
    };
    let ends = |rest: &&[Token]| rest.first().is_none_or(|next| !next.kind.is_arithmetic());
    let behind = after_triple(tokens).filter(ends).map(|rest| tokens.len() - rest.len());
    let (point, rest) = tokens.split_at(behind.or_else(word_for)?);
    let is_lead = |token: &&Token| {
        token.kind == Comma || matches!(word(token), "for" | "where" | "with" | "when")
    };
    let lead = rest.iter().take_while(is_lead).count();
    if lead == 0 {
        return None;
    }
    let split = split_ranges(&rest[lead..], |token| word(token) == "for");
    if !(1..=2).contains(&split.len()) {
        return None;
    }
    let sign = |kind: TokenKind, at: Span| Token::new(kind, Span::at(at.start));
    let mut marked = Vec::new();
    for range in &split {
        let (name, low, high) = match range.as_slice() {
            [name, sign, all]
                if name.kind.is_name() && sign.kind == In && matches!(word(all), "R" | "ℝ") =>
            {
                (*name, &range[2..], &range[2..])
            }
            _ => parameter_range(range)?,
        };
        let ends = |tokens: &[Token]| tokens.iter().map(|token| infinity(text, *token)).collect();
        let [low, high]: [Vec<Token>; 2] = [low, high].map(ends);
        marked.extend([sign(For, name.span), name, sign(In, name.span)]);
        marked.push(sign(OpenBracket, low[0].span));
        marked.extend(low);
        marked.push(sign(Comma, high[0].span));
        marked.extend(&high);
        marked.push(Token::new(CloseBracket, Span::at(high[high.len() - 1].span.end)));
    }
    Some((in_parentheses(point), marked))
}

/// The sign `∞` as a name, which may be the end of a range; other tokens as they are.
fn infinity(text: &str, token: Token) -> Token {
    let is_sign = token.kind == Unknown && &text[token.span.range()] == "∞";
    if is_sign { Token { kind: TokenKind::Name, ..token } } else { token }
}

/// Returns whether `tokens` are a sum with a vector in brackets, as in `(1-t)*(1, 2, 3) + t*p`.
fn is_sum(tokens: &[Token]) -> bool {
    let is_vector = |at: usize| after_triple(&tokens[at..]).is_some();
    outside(tokens, Comma).is_none()
        && !tokens.iter().any(|token| token.kind.is_relation())
        && (0..tokens.len()).any(is_vector)
}

/// Splits several ranges at commas and at the word `for`.
fn split_ranges(tokens: &[Token], is_for: impl Fn(&Token) -> bool) -> Vec<Vec<Token>> {
    let commas = split(tokens, Comma);
    let words = commas.iter().flat_map(|part| part.split(&is_for));
    words.filter(|part| !part.is_empty()).map(<[Token]>::to_vec).collect()
}

/// The parameter and the ends of a range `t in [a, b]`, `t = a..b`, `t: a..b` or `a <= t <= b`.
pub fn parameter_range(tokens: &[Token]) -> Option<(Token, &[Token], &[Token])> {
    let is_order = |kind: TokenKind| matches!(kind, Less | LessEqual);
    let ends = match tokens {
        [name, sign, ends @ ..] if name.kind.is_name() && sign.kind == In => {
            let (inner, []) = bracketed(ends)? else { return None };
            let comma = outside(inner, Comma)?;
            Some((*name, &inner[..comma], &inner[comma + 1..]))
        }
        [name, sign, ends @ ..] if name.kind.is_name() && matches!(sign.kind, Equals | Colon) => {
            let dots = outside(ends, Dots)?;
            Some((*name, &ends[..dots], &ends[dots + 1..]))
        }
        _ => {
            let first = tokens.iter().position(|token| is_order(token.kind))?;
            let [name, sign, high @ ..] = &tokens[first + 1..] else { return None };
            (name.kind.is_name() && is_order(sign.kind)).then_some((*name, &tokens[..first], high))
        }
    };
    let (name, low, high) = ends?;
    (!low.is_empty() && !high.is_empty() && outside(high, Comma).is_none())
        .then_some((name, low, high))
}
