//! A first, flat look at a text: its symbols, their number, brackets and bars, and where statements
//! end.
//!
//! It runs in one pass without recursion, so that no later stage meets text that is too long or too
//! deep. It does not know the grammar: a symbol is what can be told from its own characters, but
//! for the parts of `\frac` and the hexadecimal color behind `color`.

use crate::error::{Error, ErrorKind, Fallible};
use crate::limits::Limits;
use crate::span::Span;
use crate::spelling::{closer, in_name, is_closer, is_name, superscript_digit, symbol, vulgar};

/// A symbol and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    /// What the grammar knows it by: see `spelling::symbol`, and the grammar for what has no fixed
    /// spelling. `?` has no meaning in the language.
    pub symbol: char,
    pub span: Span,
    /// Its offset in [`Piece::symbols`].
    at: usize,
}

/// One statement.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// Never empty.
    pub tokens: Vec<Token>,
    /// The symbols of all tokens: what the grammar reads.
    pub symbols: String,
    pub span: Span,
}

impl Piece {
    fn new(mut tokens: Vec<Token>) -> Fallible<Self> {
        pair_bars(&mut tokens)?;
        let mut symbols = String::with_capacity(tokens.len());
        for token in &mut tokens {
            token.at = symbols.len();
            symbols.push(token.symbol);
        }
        let span = tokens[0].span.to(tokens[tokens.len() - 1].span);
        Ok(Self { tokens, symbols, span })
    }

    /// The index of the token at an offset in the symbols.
    pub(crate) fn index(&self, offset: usize) -> usize {
        self.tokens.partition_point(|token| token.at < offset)
    }
}

/// Splits `text` into statements, and checks length, depth and brackets.
pub(crate) fn scan(text: &str, limits: &Limits) -> Fallible<Vec<Piece>> {
    if text.len() > limits.bytes {
        let kind = ErrorKind::TooLong { bytes: text.len(), limit: limits.bytes };
        return Err(Error::new(Span::at(0), kind));
    }
    let mut pieces = Vec::new();
    let mut tokens: Vec<Token> = Vec::new();
    // The open brackets, by their indices in `tokens`.
    let mut open: Vec<usize> = Vec::new();
    // Whether a part of a fraction is next, which is one digit or stands in braces.
    let mut is_part = false;
    let mut count = 0;
    let mut end = 0;
    while end < text.len() {
        let is_color = matches!(tokens.as_slice(), [Token { symbol: 'c', .. }]);
        let (symbol, length) = lex(&text[end..], is_part, is_color);
        let span = Span::new(end, end + length);
        end = span.end;
        if symbol == ' ' {
            continue;
        }
        count += 1;
        if count > limits.symbols {
            return Err(Error::new(span, ErrorKind::TooManySymbols { limit: limits.symbols }));
        }
        let mut first = tokens.len();
        match symbol {
            '\n' | ';' if open.is_empty() => {
                if !tokens.is_empty() {
                    pieces.push(Piece::new(std::mem::take(&mut tokens))?);
                }
                continue;
            }
            '\n' => continue,
            _ if closer(symbol).is_some() => {
                if open.len() >= limits.depth {
                    return Err(Error::new(span, ErrorKind::TooDeep { limit: limits.depth }));
                }
                open.push(tokens.len());
            }
            _ if is_closer(symbol) => {
                first = close(symbol, span, open.pop().map(|index| (index, tokens[index])))?;
            }
            _ => {}
        }
        let follows_fraction = first > 0 && tokens[first - 1].symbol == 'F';
        is_part = symbol == 'F' || (matches!(symbol, '1' | '}') && follows_fraction);
        tokens.push(Token { symbol, span, at: 0 });
    }
    if let Some(index) = open.first() {
        return Err(unclosed(text, &tokens[*index..], open.len() == 1));
    }
    if !tokens.is_empty() {
        pieces.push(Piece::new(tokens)?);
    }
    Ok(pieces)
}

/// The index of the bracket that `symbol` at `span` closes.
fn close(symbol: char, span: Span, opened: Option<(usize, Token)>) -> Fallible<usize> {
    let Some((index, open)) = opened else {
        let kind = ErrorKind::Unopened { close: symbol };
        return Err(Error::new(span, kind).suggest(span, ""));
    };
    match closer(open.symbol) {
        Some(meant) if meant != symbol => {
            let kind = ErrorKind::Mismatched { open: open.symbol, close: symbol };
            Err(Error::new(open.span.to(span), kind).suggest(span, meant))
        }
        _ => Ok(index),
    }
}

/// The error for a bracket that is never closed, the first of `tokens`.
fn unclosed(text: &str, tokens: &[Token], is_only: bool) -> Box<Error> {
    let Token { symbol, span, .. } = tokens[0];
    let error = Error::new(span, ErrorKind::Unclosed { open: symbol });
    // Where one bracket is missing, the end of its line is a fair guess.
    let line = text[span.end..].find(['\n', '\r']).map_or(text.len(), |length| span.end + length);
    let line = tokens.iter().take_while(|token| token.symbol != ';' && token.span.start < line);
    match (line.last(), closer(symbol)) {
        (Some(last), Some(close)) if is_only => error.suggest(Span::at(last.span.end), close),
        _ => error,
    }
}

/// The symbol that `rest` starts with, and its length; a blank for what has no meaning.
fn lex(rest: &str, is_part: bool, is_color: bool) -> (char, usize) {
    let Some(character) = rest.chars().next() else {
        return (' ', 0);
    };
    let length = character.len_utf8();
    match character {
        '#' => {
            let digits = prefix(&rest[1..], |c| c.is_ascii_hexdigit());
            match digits {
                1.. if is_color => ('#', 1 + digits),
                _ => (' ', rest.find('\n').unwrap_or(rest.len())),
            }
        }
        '0'..='9' if is_part => ('1', 1),
        '0'..='9' | '.' => number(rest),
        '\\' => command(rest),
        _ if vulgar(character).is_some() => ('½', length),
        _ if character.is_alphabetic() => name(rest, prefix(rest, in_name)),
        '⁻' | '⁺' | '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' => {
            let sign = if matches!(character, '⁻' | '⁺') { length } else { 0 };
            match prefix(&rest[sign..], |c| superscript_digit(c).is_some()) {
                0 => ('?', length),
                digits => ('²', sign + digits),
            }
        }
        _ => {
            // Some of two characters begin with one that has a meaning of its own.
            let two = rest.char_indices().nth(2).map_or(rest.len(), |(at, _)| at);
            let found =
                [two, length].into_iter().find_map(|end| Some((symbol(&rest[..end])?, end)));
            found.unwrap_or(('?', length))
        }
    }
}

/// The length of what `text` starts with, as far as its characters are `accepted`.
fn prefix(text: &str, accepted: impl Fn(char) -> bool) -> usize {
    text.find(|c| !accepted(c)).unwrap_or(text.len())
}

fn number(rest: &str) -> (char, usize) {
    let digits = |text: &str| prefix(text, |c| c.is_ascii_digit());
    let mut end = digits(rest);
    if let Some(decimals) = rest[end..].strip_prefix('.') {
        end += 1 + digits(decimals);
        if end == 1 {
            return ('?', 1);
        }
    }
    if let Some(exponent) = rest[end..].strip_prefix(['e', 'E']) {
        let exponent = exponent.strip_prefix(['+', '-', '−']).unwrap_or(exponent);
        if digits(exponent) > 0 {
            end = rest.len() - exponent.len() + digits(exponent);
        }
    }
    ('0', end)
}

/// A name whose letters end at `end`, with its subscript.
fn name(rest: &str, end: usize) -> (char, usize) {
    if let Some(fixed) = symbol(&rest[..end]) {
        return (fixed, end);
    }
    // The underscore of a subscript is a letter elsewhere.
    let base = rest[..end].strip_suffix('_').map_or(end, str::len);
    match rest[base..].strip_prefix('_') {
        Some(subscript) if subscript.starts_with('{') => {
            ('a', base + braced(subscript).map_or(0, |length| 1 + length))
        }
        _ => ('a', end),
    }
}

fn command(rest: &str) -> (char, usize) {
    let end = 1 + prefix(&rest[1..], |c| c.is_ascii_alphabetic());
    if end == 1 {
        let two = 1 + rest[1..].chars().next().map_or(0, char::len_utf8);
        return symbol(&rest[..two]).map_or(('?', 1), |blank| (blank, two));
    }
    match name(rest, end) {
        ('T', end) => {
            let is_name =
                rest[end..].starts_with('{') && rest[end + 1..].starts_with(char::is_alphabetic);
            ('a', end + braced(&rest[end..]).filter(|_| is_name).unwrap_or(0))
        }
        found => found,
    }
}

/// The length of a name or a number in braces, if `rest` starts with one.
fn braced(rest: &str) -> Option<usize> {
    let inner = rest.strip_prefix('{')?;
    let length = prefix(inner, in_name);
    (length > 0 && inner[length..].starts_with('}')).then_some(length + 2)
}

/// Tells closing bars from opening ones. They open and close in turn within each pair of brackets;
/// whatever else they could mean is an error.
fn pair_bars(tokens: &mut [Token]) -> Fallible<()> {
    #[derive(Default)]
    struct Level {
        /// The open bar.
        open: Option<Span>,
        /// The opening bar of the last pair, if an operand followed the pair directly.
        loose: Option<Span>,
    }
    let count = tokens.iter().filter(|token| token.symbol == '|').count();
    let mut levels = vec![Level::default()];
    for index in 0..tokens.len() {
        let Token { symbol, span, .. } = tokens[index];
        if closer(symbol).is_some() {
            levels.push(Level::default());
        }
        if is_closer(symbol)
            && let Some(span) = levels.pop().and_then(|level| level.open)
        {
            return Err(Error::new(span, ErrorKind::UnclosedBar));
        }
        let (Some(level), '|') = (levels.last_mut(), symbol) else {
            continue;
        };
        let before = index.checked_sub(1).map_or(' ', |before| tokens[before].symbol);
        let after = tokens.get(index + 1).map_or(' ', |after| after.symbol);
        let Some(open) = level.open.take() else {
            if let (true, Some(first)) = (ends_operand(before), level.loose) {
                return Err(Error::new(first.to(span), ErrorKind::AmbiguousBars));
            }
            level.open = Some(span);
            continue;
        };
        let is_empty = before == '|';
        if is_empty || (!ends_operand(before) && begins_operand(after)) {
            let kind =
                if is_empty && count <= 2 { ErrorKind::EmptyBars } else { ErrorKind::NestedBars };
            return Err(Error::new(open.to(span), kind));
        }
        level.loose = begins_operand(after).then_some(open);
        tokens[index].symbol = '¦';
    }
    match levels.pop().and_then(|level| level.open) {
        Some(span) => Err(Error::new(span, ErrorKind::UnclosedBar)),
        None => Ok(()),
    }
}

/// Whether an operand can end with this symbol.
fn ends_operand(symbol: char) -> bool {
    matches!(symbol, '0' | '1' | '½' | '²') || is_name(symbol) || is_closer(symbol)
}

/// Whether an operand can begin with this symbol.
fn begins_operand(symbol: char) -> bool {
    matches!(symbol, '0' | '½' | 'F' | '√' | '∛' | '¬')
        || is_name(symbol)
        || closer(symbol).is_some()
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
