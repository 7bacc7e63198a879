//! Reads signs of other languages, markup and typesetting. Each sign becomes a token or is skipped.

use crate::lex::spelling::{is_name_char, line_length, plain, prefix_length, start, token_kind};
use crate::lex::token::LexContext;
use crate::lex::token_kind::TokenKind::{self, *};

/// Names of markup tags around a formula.
const TAGS: &[&str] = &["math", "i", "em", "b", "span", "p", "code", "var", "br", "nowiki"];

/// Words of POV-Ray before a definition.
const DECLARES: &[&str] = &["#declare ", "#local "];

/// The token of a foreign sign at the start of `rest`, and the sign's length in bytes.
pub(crate) fn foreign(rest: &str, context: LexContext) -> Option<(TokenKind, usize)> {
    let first = rest.chars().next()?;
    let length = first.len_utf8();
    match first {
        // An HTML entity, such as `&le;`.
        '&' => {
            let end = start(rest, 10).find(';')? + 1;
            Some((token_kind(&rest[..end])?, end))
        }
        '<' => tag(rest),
        '#' => {
            let word = DECLARES.iter().find(|word| rest.starts_with(**word))?;
            Some((Blank, word.len()))
        }
        // At the start of a statement, a percent sign begins a comment, as in MATLAB.
        '%' if context.last.is_none() => Some((Blank, line_length(rest))),
        '%' if context.last.is_some_and(TokenKind::ends_operand) && divides(&rest[1..]) => {
            Some((Remainder, 1))
        }
        // Constants of Maxima, such as `%pi`.
        '%' if !context.last.is_some_and(TokenKind::ends_operand) || context.touching.is_none() => {
            let word = prefix_length(&rest[1..], is_name_char);
            matches!(&rest[1..=word], "pi" | "e" | "phi" | "i")
                .then_some((TokenKind::Name, 1 + word))
        }
        // Coordinates of Houdini, such as `$X`.
        '$' => {
            let is_axis = rest[1..].starts_with(['X', 'Y', 'Z'])
                && prefix_length(&rest[1..], is_name_char) == 1;
            is_axis.then_some((Blank, 1))
        }
        '@' if rest[1..].trim_start().starts_with('(') => Some((At, 1)),
        // Mathematica's `f@x`.
        '@' if context.touching == Some(TokenKind::Name) && rest[1..].starts_with(is_name_char) => {
            Some((At, 1))
        }
        '@' if rest[1..].starts_with('P') && prefix_length(&rest[1..], is_name_char) == 1 => {
            Some((TokenKind::Name, 2))
        }
        // LaTeX's blank between the signs of a set.
        '~' if matches!(context.last, Some(CloseParen | Colon | Comma))
            && rest[1..].starts_with(|c: char| c == ':' || c == '\\' || c.is_ascii_digit()) =>
        {
            Some((Blank, 1))
        }
        // Python's product of matrices.
        '@' if rest[1..].starts_with(' ') && context.touching.is_none() => Some((DotProduct, 1)),
        '.' => {
            let dots = rest.find(|c| c != '.').unwrap_or(rest.len());
            // A line continuation of MATLAB.
            if dots == 3 && rest[3..].trim_start_matches([' ', '\t', '\r']).starts_with('\n') {
                return Some((Blank, 3 + rest[3..].find('\n')? + 1));
            }
            // Elementwise operators of MATLAB, such as `.*`, also behind `0.5`. The point of `2.*x`
            // belongs to the number.
            if dots == 1 && rest[1..].starts_with(['*', '/', '^']) {
                return Some((Blank, 1));
            }
            // A function of all elements in Julia, as in `f.(x)`.
            if context.touching == Some(TokenKind::Name) && rest[1..].starts_with('(') {
                return Some((Blank, 1));
            }
            // A product of vectors and matrices, as in Mathematica's `{a, b}.m.{c, d}` and in
            // `(a, b).(c, d)`.
            let name = prefix_length(&rest[1..], is_name_char);
            let is_product = match context.touching {
                Some(CloseBrace) if name > 0 => rest[1 + name..].starts_with(".{"),
                Some(CloseBrace | CloseParen) => rest[1..].starts_with(['{', '(']),
                Some(TokenKind::Name) => rest[1..].starts_with('{'),
                _ => false,
            };
            is_product.then_some((DotProduct, 1))
        }
        // All elements of an array in MATLAB, as in `R(:)`.
        '(' if rest.starts_with("(:)") && context.touching == Some(TokenKind::Name) => {
            Some((Blank, 3))
        }
        // The scalar product of two lists of LaTeX.
        '\\' | '·' | '⋅' if context.last == Some(CloseList) => {
            let sign = [r"\cdot", "·", "⋅"].into_iter().find(|sign| rest.starts_with(sign))?;
            let behind = rest[sign.len()..].trim_start_matches(' ');
            (behind.starts_with(r"\langle") || behind.starts_with('⟨'))
                .then_some((DotProduct, sign.len()))
        }
        // The imaginary unit of gnuplot, beside an operator.
        '{' if rest.starts_with("{0,1}")
            && (matches!(context.last, Some(Plus | Minus | Star))
                || context.last == Some(Equals) && start(rest, 2000).contains("splot "))
            && !rest[5..].starts_with('.') =>
        {
            Some((TokenKind::Name, 5))
        }
        // A quoted text of a program, such as the color in `color='red'`.
        '"' | '\'' if let Some(length) = quoted(rest, first, context) => Some((Unknown, length)),
        // MATLAB's transpose.
        '\'' if context.touching == Some(CloseParen)
            && rest[1..].trim_start_matches(' ').starts_with([';', '\n']) =>
        {
            Some((Blank, 1))
        }
        // Quotation marks around a formula, which are skipped.
        '"' | '`' | '“' | '”' | '„' => {
            let next = start(&rest[length..], 20);
            let line = next[..line_length(next)].trim();
            let is_end = line.is_empty() || matches!(line, "." | ",");
            // A backquote marks the precision of a number in Mathematica.
            let is_mark = first == '`' && context.touching == Some(Number);
            (context.last.is_none() || context.starts_line || is_end || is_mark)
                .then_some((Blank, length))
        }
        '*' if rest.starts_with("*^") && context.touching == Some(Number) => None,
        _ => plain(first).filter(|_| !first.is_alphabetic()).and_then(|meant| {
            let mut buffer = [0; 4];
            if meant.is_ascii_digit() {
                let digits = |c: char| plain(c).is_some_and(|c| c.is_ascii_digit());
                return Some((Number, rest.find(|c| !digits(c)).unwrap_or(rest.len())));
            }
            Some((token_kind(meant.encode_utf8(&mut buffer))?, length))
        }),
    }
}

/// Length of the quoted text at the start of `rest`. Such a text is an argument, an option or an
/// element of a list.
fn quoted(rest: &str, mark: char, context: LexContext) -> Option<usize> {
    let begins = match context.last? {
        OpenParen | OpenBracket | OpenBrace | Comma | Equals | Greater | Colon => true,
        TokenKind::Name => mark == '\'' && context.touching.is_none(),
        // The label of a point ends its line.
        CloseParen => mark == '"' && ends_line(&rest[1..]),
        _ => false,
    };
    let line = start(&rest[1..], 400);
    let end = line[..line_length(line)].find(mark).filter(|_| begins)?;
    Some(end + 2)
}

/// Returns whether the text up to a quotation mark ends a statement.
fn ends_line(rest: &str) -> bool {
    let line = start(rest, 400);
    let behind = line[..line_length(line)].split_once('"').map(|(_, behind)| behind.trim_start());
    behind.is_some_and(|behind| behind.is_empty() || behind.starts_with([';', '#']))
}

/// Returns whether `rest`, after an optional minus, begins with a divisor: a number, a bracket, or
/// a name of one or two letters. A name before another word is no divisor but begins a comment.
fn divides(rest: &str) -> bool {
    let rest = rest.trim_start_matches(' ');
    let rest = rest.strip_prefix('-').unwrap_or(rest);
    let name = prefix_length(rest, is_name_char);
    let behind = rest[name..].trim_start_matches(' ');
    rest.starts_with(|c: char| c.is_ascii_digit() || c == '(')
        || matches!(name, 1 | 2) && !behind.starts_with(char::is_alphabetic)
}

/// The token of a tag, and the tag's length. `<sup>` gives a power, and other tags a blank.
fn tag(rest: &str) -> Option<(TokenKind, usize)> {
    let end = start(rest, 80).find('>')?;
    let inner = rest[1..end].strip_prefix('/').unwrap_or(&rest[1..end]);
    let word = &inner[..prefix_length(inner, is_name_char)];
    let attributes = &inner[word.len()..];
    if !(attributes.is_empty()
        || attributes.starts_with(' ') && attributes.contains('=')
        || attributes == "/")
    {
        return None;
    }
    if word == "sup" {
        if rest.starts_with("</") {
            return Some((Blank, end + 1));
        }
        let close = start(&rest[end + 1..], 40).find("</sup>")?;
        // `<sup>` is read only around a name or number. A sum, for example, would need brackets.
        let is_short = rest[end + 1..end + 1 + close].chars().all(is_name_char);
        return is_short.then_some((Caret, end + 1));
    }
    // `x <b> y` is a comparison, so an opening tag counts only if its closing tag follows.
    let closes = || {
        let close = format!("</{word}>");
        start(&rest[end + 1..], 400).contains(&close)
    };
    let is_tag = rest.starts_with("</") || word == "br" || closes();
    (TAGS.contains(&word) && is_tag).then_some((Blank, end + 1))
}
