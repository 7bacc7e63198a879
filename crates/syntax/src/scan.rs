//! A first, flat look at a text: tokens, their number, brackets and bars, and where statements end.
//!
//! It runs in one pass without recursion, so that no later stage meets text that is too long or too deep. It does
//! not know the grammar: a token is only what can be told from its own characters.

use crate::error::{Error, ErrorKind, Fallible};
use crate::limits::Limits;
use crate::span::Span;
use crate::spelling::vulgar;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TokenKind {
    Number,
    Word,
    /// A LaTeX command.
    Command,
    /// An operator, a relation or a comma.
    Sign,
    /// An opening bracket.
    Open(char),
    /// A closing bracket.
    Close(char),
    Bar,
    /// Ends a statement outside brackets.
    Break,
    /// Has no meaning in the language.
    Unknown(char),
}

/// A token and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub kind: TokenKind,
    pub span: Span,
}

/// The tokens of one statement.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub tokens: Vec<Token>,
    pub span: Span,
}

/// Splits `text` into statements, and checks length, depth, characters and brackets.
pub(crate) fn scan(text: &str, limits: &Limits) -> Fallible<Vec<Piece>> {
    if text.len() > limits.bytes {
        let kind = ErrorKind::TooLong { bytes: text.len(), limit: limits.bytes };
        return Err(Error::new(Span::at(0), kind));
    }
    let tokens = tokens(text, limits.symbols)?;
    let breaks = brackets(&tokens, limits.depth)?;
    let mut pieces = Vec::new();
    let mut start = 0;
    for end in breaks.into_iter().chain([tokens.len()]) {
        let tokens = &tokens[start..end];
        start = end + 1;
        let (Some(first), Some(last)) = (tokens.first(), tokens.last()) else {
            continue;
        };
        let tokens: Vec<Token> = tokens
            .iter()
            .filter(|token| token.kind != TokenKind::Break || &text[token.span.range()] == ";")
            .copied()
            .collect();
        bars(text, &tokens)?;
        pieces.push(Piece { span: first.span.to(last.span), tokens });
    }
    Ok(pieces)
}

/// Whether `character` may stand in a name after its first letter.
pub(crate) fn in_name(character: char) -> bool {
    character.is_alphabetic() || character.is_ascii_digit() || character == '_'
}

fn tokens(text: &str, limit: usize) -> Fallible<Vec<Token>> {
    let mut tokens: Vec<Token> = Vec::new();
    let mut at = 0;
    while let Some(character) = text[at..].chars().next() {
        let rest = &text[at..];
        let (kind, length) = match character {
            '\n' | '\r' | ';' => (Some(TokenKind::Break), 1),
            ' ' | '\t' | '\u{A0}' | '\u{2009}' | '\u{202F}' | '\u{3000}' | '\u{2062}'
            | '\u{FEFF}' => (None, character.len_utf8()),
            '#' => comment(rest, statement_start(&tokens).map(|t| &text[t.span.range()])),
            '0'..='9' | '.' => number(rest),
            '\\' => command(rest),
            '(' | '[' | '{' | '⌊' | '⌈' => {
                (Some(TokenKind::Open(character)), character.len_utf8())
            }
            ')' | ']' | '}' | '⌋' | '⌉' => {
                (Some(TokenKind::Close(character)), character.len_utf8())
            }
            _ if vulgar(character).is_some() => (Some(TokenKind::Number), character.len_utf8()),
            '|' => (Some(TokenKind::Bar), 1),
            _ if character.is_alphabetic() => {
                let end = rest.find(|c| !in_name(c)).unwrap_or(rest.len());
                (Some(TokenKind::Word), end)
            }
            _ => sign(rest, character),
        };
        if let Some(kind) = kind {
            let span = Span::new(at, at + length);
            if tokens.len() >= limit {
                return Err(Error::new(span, ErrorKind::TooManySymbols { limit }));
            }
            tokens.push(Token { kind, span });
        }
        at += length;
    }
    Ok(tokens)
}

/// The first token of the statement that `tokens` ends in.
fn statement_start(tokens: &[Token]) -> Option<&Token> {
    let after = tokens
        .iter()
        .rposition(|token| token.kind == TokenKind::Break)
        .map_or(0, |index| index + 1);
    // A color stands right after its keyword, so only a statement of one token matters.
    match &tokens[after..] {
        [only] => Some(only),
        _ => None,
    }
}

/// A comment, or the value of a `color` line.
fn comment(rest: &str, keyword: Option<&str>) -> (Option<TokenKind>, usize) {
    let is_color = matches!(keyword, Some("color" | "colour"));
    let digits = rest[1..].find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(rest.len() - 1);
    if is_color && digits > 0 {
        return (Some(TokenKind::Word), 1 + digits);
    }
    (None, rest.find('\n').unwrap_or(rest.len()))
}

fn number(rest: &str) -> (Option<TokenKind>, usize) {
    let bytes = rest.as_bytes();
    let digits = |from: usize| {
        bytes[from..]
            .iter()
            .position(|b| !b.is_ascii_digit())
            .map_or(bytes.len(), |length| from + length)
    };
    let whole = digits(0);
    let mut end = whole;
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
        if end == 1 {
            return (Some(TokenKind::Unknown('.')), 1);
        }
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let mut from = end + 1;
        if matches!(bytes.get(from), Some(b'+' | b'-')) {
            from += 1;
        } else if rest.is_char_boundary(from) && rest[from..].starts_with('−') {
            from += '−'.len_utf8();
        }
        let exponent = digits(from.min(bytes.len()));
        if exponent > from {
            end = exponent;
        }
    }
    (Some(TokenKind::Number), end)
}

fn command(rest: &str) -> (Option<TokenKind>, usize) {
    let letters = rest[1..].find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(rest.len() - 1);
    match &rest[1..=letters] {
        "" if rest[1..].starts_with([',', ';', ':', '!', ' ']) => (None, 2),
        "" => (Some(TokenKind::Unknown('\\')), 1),
        "left" | "right" | "bigl" | "bigr" | "big" | "quad" | "qquad" | "displaystyle" => {
            (None, 1 + letters)
        }
        "lfloor" => (Some(TokenKind::Open('⌊')), 1 + letters),
        "rfloor" => (Some(TokenKind::Close('⌋')), 1 + letters),
        "lceil" => (Some(TokenKind::Open('⌈')), 1 + letters),
        "rceil" => (Some(TokenKind::Close('⌉')), 1 + letters),
        _ => (Some(TokenKind::Command), 1 + letters),
    }
}

/// Signs of the language, longest first where one begins another.
const SIGNS: &[&str] = &[
    "**", "<=", ">=", "==", ":=", "!=", "&&", "+", "-", "*", "/", "^", "=", "<", ">", ",", "·",
    "×", "⋅", "∙", "÷", "−", "≤", "≥", "⩽", "⩾", "≠", "∧", "∨", "¬", "∈", "√", "∛",
];

fn sign(rest: &str, character: char) -> (Option<TokenKind>, usize) {
    if "⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺".contains(character) {
        let end = rest.find(|c| !"⁰¹²³⁴⁵⁶⁷⁸⁹⁻⁺".contains(c)).unwrap_or(rest.len());
        return (Some(TokenKind::Sign), end);
    }
    match SIGNS.iter().find(|sign| rest.starts_with(**sign)) {
        Some(sign) => (Some(TokenKind::Sign), sign.len()),
        None => (Some(TokenKind::Unknown(character)), character.len_utf8()),
    }
}

/// Pairs the brackets; returns the indices of the breaks that lie outside them.
fn brackets(tokens: &[Token], limit: usize) -> Fallible<Vec<usize>> {
    let mut open: Vec<(char, Span)> = Vec::new();
    let mut breaks = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(bracket) => {
                if open.len() >= limit {
                    return Err(Error::new(token.span, ErrorKind::TooDeep { limit }));
                }
                open.push((bracket, token.span));
            }
            TokenKind::Close(close) => {
                let Some((bracket, span)) = open.pop() else {
                    return Err(Error::new(token.span, ErrorKind::Unopened { close })
                        .suggest(token.span, ""));
                };
                if close != closer(bracket) {
                    let kind = ErrorKind::Mismatched { open: bracket, close };
                    return Err(
                        Error::new(span.to(token.span), kind).suggest(token.span, closer(bracket))
                    );
                }
            }
            TokenKind::Break if open.is_empty() => breaks.push(index),
            TokenKind::Break
            | TokenKind::Number
            | TokenKind::Word
            | TokenKind::Command
            | TokenKind::Sign
            | TokenKind::Bar
            | TokenKind::Unknown(_) => {}
        }
    }
    match open.first() {
        Some(&(bracket, span)) => {
            let kind = ErrorKind::Unclosed { open: bracket };
            let error = Error::new(span, kind);
            // Where one bracket is missing, the end of its line is a fair guess.
            let behind = tokens.partition_point(|token| token.span.start < span.end);
            let line = tokens[behind..].iter().take_while(|token| token.kind != TokenKind::Break);
            let end = line.last().map_or(span.end, |token| token.span.end);
            Err(if open.len() == 1 { error.suggest(Span::at(end), closer(bracket)) } else { error })
        }
        None => Ok(breaks),
    }
}

fn closer(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        '⌊' => '⌋',
        '⌈' => '⌉',
        _ => '}',
    }
}

/// Whether an operand can end with this token.
fn ends_operand(text: &str, token: &Token) -> bool {
    match token.kind {
        TokenKind::Number | TokenKind::Close(_) => true,
        TokenKind::Word | TokenKind::Command => !is_operator_word(&text[token.span.range()]),
        TokenKind::Sign => text[token.span.range()].starts_with(|c| "⁰¹²³⁴⁵⁶⁷⁸⁹".contains(c)),
        TokenKind::Open(_) | TokenKind::Bar | TokenKind::Break | TokenKind::Unknown(_) => false,
    }
}

/// Whether an operand can begin with this token.
fn begins_operand(text: &str, token: &Token) -> bool {
    match token.kind {
        TokenKind::Number | TokenKind::Open(_) => true,
        TokenKind::Word | TokenKind::Command => {
            let word = &text[token.span.range()];
            word == "not" || !is_operator_word(word)
        }
        TokenKind::Sign => text[token.span.range()].starts_with(['√', '∛']),
        TokenKind::Close(_) | TokenKind::Bar | TokenKind::Break | TokenKind::Unknown(_) => false,
    }
}

/// Whether a word or a command is an operator rather than a name.
pub(crate) fn is_operator_word(word: &str) -> bool {
    const WORDS: &[&str] = &[
        "and",
        "or",
        "not",
        "in",
        "\\cdot",
        "\\times",
        "\\div",
        "\\le",
        "\\leq",
        "\\leqslant",
        "\\ge",
        "\\geq",
        "\\geqslant",
        "\\lt",
        "\\gt",
        "\\ne",
        "\\neq",
        "\\land",
        "\\lor",
        "\\lnot",
        "\\neg",
        "\\wedge",
        "\\vee",
        "\\in",
    ];
    WORDS.contains(&word)
}

/// Bars open and close in turn within each pair of brackets; whatever else they could mean is an error.
fn bars(text: &str, tokens: &[Token]) -> Fallible<()> {
    struct Level {
        /// Where the open bar stands, and whether its pair could also be read otherwise.
        open: Option<Span>,
        /// The last closed pair, if an operand followed it directly.
        loose: Option<Span>,
    }
    let fresh = || Level { open: None, loose: None };
    let count = tokens.iter().filter(|token| token.kind == TokenKind::Bar).count();
    let mut levels = vec![fresh()];
    for (index, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(_) => levels.push(fresh()),
            TokenKind::Close(_) => {
                if let Some(span) = levels.pop().and_then(|level| level.open) {
                    return Err(Error::new(span, ErrorKind::UnclosedBar));
                }
            }
            TokenKind::Bar => {
                let Some(level) = levels.last_mut() else {
                    continue;
                };
                let before = index.checked_sub(1).map(|i| &tokens[i]);
                let after = tokens.get(index + 1);
                let operand_before = before.is_some_and(|t| ends_operand(text, t));
                let operand_after = after.is_some_and(|t| begins_operand(text, t));
                match level.open {
                    None => {
                        if let (true, Some(first)) = (operand_before, level.loose) {
                            return Err(Error::new(first.to(token.span), ErrorKind::AmbiguousBars));
                        }
                        level.open = Some(token.span);
                    }
                    Some(open) => {
                        let span = open.to(token.span);
                        if !operand_before && before.is_some_and(|t| t.kind == TokenKind::Bar) {
                            let kind = if count > 2 {
                                ErrorKind::NestedBars
                            } else {
                                ErrorKind::EmptyBars
                            };
                            return Err(Error::new(span, kind));
                        }
                        if !operand_before && operand_after {
                            return Err(Error::new(span, ErrorKind::NestedBars));
                        }
                        level.open = None;
                        level.loose = operand_after.then_some(open);
                    }
                }
            }
            TokenKind::Number
            | TokenKind::Word
            | TokenKind::Command
            | TokenKind::Sign
            | TokenKind::Break
            | TokenKind::Unknown(_) => {}
        }
    }
    match levels.pop().and_then(|level| level.open) {
        Some(span) => Err(Error::new(span, ErrorKind::UnclosedBar)),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(text: &str) -> Option<ErrorKind> {
        scan(text, &Limits::default()).err().map(|e| e.kind)
    }

    #[test]
    fn bars_pair_in_one_way_or_not_at_all() {
        for text in ["|x|", "|x|+|y|", "|x||y|", "2|x|y", "|x|-y|z|", "(|x|)|y|", "|(|x|)|"] {
            assert_eq!(kind(text), None, "{text}");
        }
        for text in ["|x|y|z|", "|x| 2|y|", "|x| y + 2 |z|"] {
            assert_eq!(kind(text), Some(ErrorKind::AmbiguousBars), "{text}");
        }
        for text in ["||x|-1|", "|x+|y||", "||x||"] {
            assert_eq!(kind(text), Some(ErrorKind::NestedBars), "{text}");
        }
        assert_eq!(kind("|x"), Some(ErrorKind::UnclosedBar));
        assert_eq!(kind("(|x)|"), Some(ErrorKind::UnclosedBar));
        assert_eq!(kind("||"), Some(ErrorKind::EmptyBars));
    }

    #[test]
    fn statements_end_at_breaks_outside_brackets() {
        let text = "r = 2; x^2 # one\n\n(y +\n z)\ncolor #ff8000\n";
        let pieces = scan(text, &Limits::default()).expect("four statements");
        let read: Vec<&str> = pieces.iter().map(|p| &text[p.span.range()]).collect();
        assert_eq!(read, ["r = 2", "x^2", "(y +\n z)", "color #ff8000"]);
    }
}
