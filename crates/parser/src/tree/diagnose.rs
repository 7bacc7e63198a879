//! Parses statements by the grammar. If the grammar refuses a statement, the token at which parsing
//! stopped determines the error.

use crate::lex::decimal_comma::{decimal_around, is_listed};
use crate::lex::scanner::LexedStatement;
use crate::lex::spelling::{short_name, typed_setting};
use crate::lex::token::{Token, split};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::span::Span;
use crate::tree::grammar::{Pair, Rule, Zeroset};
use pest::Parser as _;
use pest::error::{ErrorVariant, InputLocation};

/// Largest size of a corrected statement that is suggested, in bytes.
const MAX_SUGGESTION: usize = 60;

/// Parses a statement of `text` by `rule`.
pub(crate) fn recognise<'i>(
    text: &str,
    lexed: &'i LexedStatement,
    rule: Rule,
) -> Fallible<Pair<'i>> {
    let mut pairs = Zeroset::parse(rule, &lexed.symbols).map_err(|refusal| {
        // pest stops parsing when the thread has little stack left.
        if matches!(&refusal.variant, ErrorVariant::CustomError { .. }) {
            return Error::new(lexed.span, ErrorKind::NoStack);
        }
        let (InputLocation::Pos(at) | InputLocation::Span((at, _))) = refusal.location;
        diagnose(text, lexed, rule, lexed.index(at))
    })?;
    Ok(pairs.next().expect("a statement is one pair"))
}

/// The error for a statement that the grammar refuses. `next` is the token where parsing stopped.
fn diagnose(text: &str, lexed: &LexedStatement, rule: Rule, next: usize) -> Box<Error> {
    let found = lexed.tokens.get(next);
    let word = lexed.tokens.first().and_then(|first| typed_setting(&text[first.span.range()]));
    let setting = match rule {
        Rule::domain_line => Some(ErrorKind::BadDomain),
        Rule::view_line => Some(ErrorKind::BadView),
        Rule::color_line => Some(ErrorKind::BadColor),
        Rule::look_line => Some(ErrorKind::BadLook),
        Rule::background_line | Rule::setting_line => {
            word.map(|setting| ErrorKind::BadSetting { word: setting.word, hint: &setting.hint })
        }
        _ => None,
    };
    if let Some(kind) = setting {
        return Error::new(found.map_or(lexed.span, |token| token.span), kind);
    }
    // A character without a meaning is reported before any other error.
    let unknown = |token: &&Token| {
        matches!(token.kind, Unknown | Percent) || (token.kind == Colon && !inside(lexed, token))
    };
    if let Some(token) = lexed.tokens.iter().find(unknown) {
        return unknown_character(text, token.span);
    }
    let before = next.checked_sub(1).map(|index| lexed.tokens[index]);
    let place = before.map_or(lexed.span, |token| token.span);
    let here = found.map_or(place, |token| token.span);
    let both = if before.is_some() { place.to(here) } else { here };
    let typed = |span: Span| text[span.range()].to_owned();
    let opens = |kind: TokenKind| kind.closer().is_some() || kind == OpenBar;
    if rule == Rule::curve_line && found.is_some_and(|token| token.kind == Comma) {
        return Error::new(here, ErrorKind::CurveEquations);
    }
    match (before.map_or(Blank, |token| token.kind), found.map_or(Blank, |token| token.kind)) {
        (Blank, sign) if sign.is_operator() => {
            Error::new(here, ErrorKind::MissingBefore { sign: typed(here) })
        }
        (Equals, Less) | (Less, Equals) => foreign(text, both, "<="),
        (Equals, Greater) | (Greater, Equals) => foreign(text, both, ">="),
        (Equals, Equals) | (Minus, Greater) | (Less, Minus) => foreign(text, both, "="),
        (Less, Greater) => foreign(text, both, "!="),
        (Slash, Slash) => Error::new(both, ErrorKind::IntegerDivision),
        (sign, Comma) if !sign.is_operator() || sign == Superscript => comma(text, lexed, next),
        (In, _) => Error::new(both, ErrorKind::BadRange),
        (_, In) => Error::new(Span::new(here.start, lexed.span.end), ErrorKind::BadRange),
        _ if let Some(span) = half_fraction(&lexed.tokens[..next]) => {
            Error::new(span, ErrorKind::HalfFraction)
        }
        // The semicolon is inside brackets, or it would end the statement. A comma was meant.
        (_, Semicolon) => {
            Error::new(here, ErrorKind::Unexpected { found: typed(here) }).suggest(here, ",")
        }
        (CloseBrace, sign)
            if (sign.is_arithmetic() || sign == Caret)
                && braces_restrict(&lexed.tokens[..next]) =>
        {
            Error::new(here, ErrorKind::RestrictionInside)
        }
        (sign, _) if sign.is_operator() => {
            Error::new(place, ErrorKind::MissingAfter { sign: typed(place) })
        }
        (open, sign) if opens(open) && sign.is_operator() => {
            Error::new(here, ErrorKind::MissingBefore { sign: typed(here) })
        }
        (open, close) if opens(open) && close.is_closer() => {
            Error::new(both, ErrorKind::EmptyBrackets)
        }
        (_, Blank) => Error::new(Span::at(place.end), ErrorKind::Unfinished),
        _ if let Some(span) = choice_in_braces(lexed, next) => {
            Error::new(span, ErrorKind::PieceWithoutCondition)
        }
        _ => Error::new(here, ErrorKind::Unexpected { found: short_name(&typed(here)) }),
    }
}

/// The span from the last open brace to the token at `next`, if an operator precedes the brace.
/// Such a brace opens a choice, because a restriction follows a whole formula.
fn choice_in_braces(lexed: &LexedStatement, next: usize) -> Option<Span> {
    let before = &lexed.tokens[..next];
    let open = before.iter().rposition(|token| token.kind == OpenBrace)?;
    let sign = before.get(open.checked_sub(1)?)?;
    sign.kind.is_operator().then(|| before[open].span.to(lexed.tokens[next].span))
}

/// Returns whether the last pair of braces holds a comparison.
fn braces_restrict(before: &[Token]) -> bool {
    let open = before.iter().rposition(|token| token.kind == OpenBrace).unwrap_or(0);
    before[open..].iter().any(|token| token.kind.is_relation())
}

/// Returns whether `colon` is inside a choice, the only place for a colon.
fn inside(lexed: &LexedStatement, colon: &Token) -> bool {
    let before = lexed.tokens.iter().take_while(|token| token.span.start < colon.span.start);
    let mut depth = 0_i32;
    for token in before {
        depth += i32::from(token.kind == OpenChoice) - i32::from(token.kind == CloseChoice);
    }
    depth > 0
}

/// The error for an operator of another language. `meant` is the operator to suggest.
fn foreign(text: &str, span: Span, meant: &str) -> Box<Error> {
    let sign = text[span.range()].to_owned();
    Error::new(span, ErrorKind::ForeignOperator { sign }).suggest(span, meant)
}

/// The error for a comma outside brackets. A comma directly between digits may be a decimal comma.
/// Any other comma may separate values, restrictions or conditions.
fn comma(text: &str, lexed: &LexedStatement, index: usize) -> Box<Error> {
    let span = lexed.tokens[index].span;
    let number = decimal_around(text, &lexed.tokens, index);
    if let Some(number) = number.filter(|_| !is_listed(&lexed.tokens, index)) {
        return Error::new(number, ErrorKind::Comma).suggest(span, ".");
    }
    let meant = listed(text, lexed, index);
    Error::new(span, ErrorKind::Comma).suggest_optional(lexed.span, meant)
}

/// A correction of a statement with commas. `first` is the index of the first comma.
fn listed(text: &str, lexed: &LexedStatement, first: usize) -> Option<String> {
    let parts = split(&lexed.tokens, Comma);
    let typed = |part: &Vec<Token>| Some(&text[part.first()?.span.to(part.last()?.span).range()]);
    let texts: Vec<&str> = parts.iter().map(typed).collect::<Option<_>>()?;
    let (formula, rest) = (*texts.first()?, texts.get(1..).filter(|rest| !rest.is_empty())?);
    let has = |part: &[Token], is: fn(TokenKind) -> bool| part.iter().any(|token| is(token.kind));
    let is_value = |part: &Vec<Token>| {
        matches!(part.as_slice(), [name, equals, _, ..] if name.kind == TokenKind::Name && equals.kind == Equals)
            && !has(part, TokenKind::is_inequality)
    };
    let is_condition = |part: &Vec<Token>| {
        has(part, TokenKind::is_inequality) && !has(part, |kind| kind == Equals)
    };
    let all = |is: &dyn Fn(&Vec<Token>) -> bool| parts[1..].iter().all(is);
    // The comma at `first` must be the first comma outside brackets.
    if lexed.tokens[..first].len() != parts[0].len() {
        return None;
    }
    let is_equation = |part: &Vec<Token>| {
        has(part, |kind| kind == Equals) && !has(part, TokenKind::is_inequality)
    };
    // Two equations may be meant as a curve.
    let are_equations = rest.len() > 1 && is_equation(&parts[0]) && all(&is_equation);
    let meant = if all(&is_value) || are_equations {
        texts.join("; ")
    } else if all(&is_condition) && is_condition(&parts[0]) {
        texts.join(" and ")
    } else if all(&is_condition) {
        format!("{formula} {{{}}}", rest.join(" and "))
    } else {
        return None;
    };
    (meant.len() <= MAX_SUGGESTION && !meant.contains('\n')).then_some(meant)
}

/// The place of a `\frac` whose second part is missing after the tokens `before`.
fn half_fraction(before: &[Token]) -> Option<Span> {
    if let [.., fraction, part] = before
        && fraction.kind == Fraction
        && part.kind.is_name()
    {
        return Some(fraction.span);
    }
    let mut depth = 0_usize;
    for token in before.iter().rev() {
        match token.kind {
            CloseBrace => depth += 1,
            OpenBrace => depth = depth.checked_sub(1)?,
            _ if depth > 0 => {}
            Fraction => return Some(token.span),
            // This token may be the first part of the fraction, as in `\frac1x`.
            Digit | Number => {}
            _ => return None,
        }
    }
    None
}

/// LaTeX commands of calculus.
const CALCULUS: &[&str] =
    &[r"\int", r"\iint", r"\iiint", r"\oint", r"\partial", r"\nabla", r"\lim"];

fn unknown_character(text: &str, span: Span) -> Box<Error> {
    let typed = &text[span.range()];
    if CALCULUS.contains(&typed) || matches!(typed, "∫" | "∬" | "∮" | "∂" | "∇") {
        return Error::new(span, ErrorKind::Calculus);
    }
    let character = match typed {
        r"\pm" | r"\mp" => '±',
        // A quoted text is one token, whatever its quotation marks are.
        _ if typed.len() > 1 && typed.starts_with('\'') => '"',
        _ => typed.chars().next().unwrap_or('?'),
    };
    let error = Error::new(span, ErrorKind::UnexpectedCharacter { character });
    let meant = match character {
        '‐' | '‑' => "-",
        '⋆' => "*",
        '：' | ':' | '≡' | '≈' => "=",
        '&' => "and",
        _ => return error,
    };
    error.suggest(span, meant)
}
