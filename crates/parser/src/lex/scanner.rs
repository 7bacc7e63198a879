//! The first pass over a text. Splits the text into tokens and statements, and checks the limits.
//!
//! The pass is a loop without recursion. It protects later stages from a text that is too long or
//! nested too deeply. It does not know the grammar. A token is recognized by its own characters,
//! with exceptions such as the parts of `\frac` and the hexadecimal color after `color`.

use crate::lex::bars::pair_bars;
use crate::lex::lexer::lex;
use crate::lex::open_brackets::{Closure, OpenBrackets, close_at, unclosed};
use crate::lex::spelling::{
    is_name_char, line_length, prefix_length, start, token_kind, typed_setting,
};
use crate::lex::token::{LexContext, Token};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::settings::SettingKind;
use crate::span::Span;

/// A statement, as tokens and as text for the grammar.
#[derive(Clone, Debug)]
pub struct LexedStatement {
    /// The statement's tokens; never empty.
    pub tokens: Vec<Token>,
    /// The text that the grammar reads: one character for each token.
    pub symbols: String,
    /// The statement's place in the text.
    pub span: Span,
}

impl LexedStatement {
    pub(crate) fn new(mut tokens: Vec<Token>) -> Fallible<Self> {
        pair_bars(&mut tokens)?;
        let mut symbols = String::with_capacity(tokens.len());
        for token in &mut tokens {
            token.at = symbols.len();
            symbols.push(token.kind.as_char());
        }
        let span = tokens[0].span.to(tokens[tokens.len() - 1].span);
        Ok(Self { tokens, symbols, span })
    }

    /// Index of the token at byte `offset` of the symbols.
    pub(crate) fn index(&self, offset: usize) -> usize {
        self.tokens.partition_point(|token| token.at < offset)
    }
}

/// Splits `text` into the tokens of its statements. Checks length, nesting depth and brackets.
///
/// # Errors
/// If the text exceeds a limit, a bracket has no counterpart, or bars are ambiguous.
pub fn scan(text: &str, limits: &Limits) -> Fallible<Vec<Vec<Token>>> {
    match scan_closing(text, limits, &[])? {
        Scanned { open: Some(open), .. } => Err(unclosed(text, &open)),
        Scanned { statements, .. } => Ok(statements),
    }
}

/// The tokens of a text, and brackets that are still open at its end.
pub(crate) struct Scanned {
    pub statements: Vec<Vec<Token>>,
    /// The brackets, if there are any.
    pub open: Option<OpenBrackets>,
}

/// Like [`scan`], but some brackets are closed where `closures` says.
pub(crate) fn scan_closing(text: &str, limits: &Limits, closures: &[Closure]) -> Fallible<Scanned> {
    if text.len() > limits.bytes {
        let kind = ErrorKind::TooLong { bytes: text.len(), limit: limits.bytes };
        return Err(Error::new(Span::at(0), kind));
    }
    let mut statements: Vec<Vec<Token>> = Vec::new();
    let mut tokens: Vec<Token> = Vec::new();
    // Indices in `tokens` of the brackets that are open.
    let mut open: Vec<usize> = Vec::new();
    let mut is_part = false;
    // Number of open LaTeX environments in which `&` aligns and `\\` ends a line.
    let mut aligned = 0_usize;
    let mut starts_line = true;
    let is_python = is_python(text);
    let (mut count, mut end) = (0, 0);
    while end < text.len() {
        close_at(end, closures, &mut open, &mut tokens);
        let rest = &text[end..];
        if rest.starts_with("//")
            && !is_python
            && is_comment(rest, &tokens, open.last().map(|index| tokens[*index]), text)
        {
            end += line_length(rest);
            continue;
        }
        let last = tokens.last();
        let context = LexContext {
            is_part,
            follows_command: last.is_some_and(|token| text[token.span.range()].starts_with('\\')),
            is_color: matches!(tokens.as_slice(), [Token { kind: ColorWord | BackgroundWord, .. }]),
            is_python,
            starts_line,
            touching: last.filter(|token| token.span.end == end).map(|token| token.kind),
            last: last.map(|token| token.kind),
        };
        let (mut kind, length) = lex(rest, context);
        let span = Span::new(end, end + length);
        end = span.end;
        let within = open.last().map_or(Blank, |index| tokens[*index].kind);
        let in_rows = matches!(within, OpenChoice | OpenMatrix);
        match kind {
            // `\end` closes an environment: a choice, a matrix or, outside brackets, an alignment.
            CloseMatrix if within == OpenChoice => kind = CloseChoice,
            CloseMatrix if open.is_empty() && aligned > 0 => {
                kind = CloseAlignment;
                aligned -= 1;
            }
            OpenAlignment => aligned += 1,
            CloseAlignment => aligned = aligned.saturating_sub(1),
            Ampersand if within == OpenChoice => kind = If,
            Ampersand if within == OpenMatrix => kind = Comma,
            Ampersand if aligned > 0 => kind = Blank,
            // Windows ends a line with two characters. Only the second one counts.
            LineEnd if rest.starts_with("\r\n") => kind = Blank,
            // A row that starts with an operator continues the row before it.
            RowEnd if !in_rows => kind = if continues_row(&text[end..]) { Blank } else { LineEnd },
            _ => {}
        }
        if matches!(kind, Blank | OpenAlignment | CloseAlignment) {
            continue;
        }
        starts_line = kind == LineEnd;
        count += 1;
        if count > limits.symbols {
            return Err(Error::new(span, ErrorKind::TooManySymbols { limit: limits.symbols }));
        }
        if let Some(title) = title(text, &tokens, span) {
            tokens.extend([Token::new(kind, span), Token::new(Label, title)]);
            end = title.end;
            continue;
        }
        let mut first = tokens.len();
        let goes_on = || goes_on(&text[end..], text, &tokens, is_python);
        match kind {
            LineEnd if !open.is_empty() || goes_on() => continue,
            LineEnd | Semicolon if open.is_empty() => {
                if !tokens.is_empty() {
                    statements.push(std::mem::take(&mut tokens));
                }
                continue;
            }
            _ if kind.closer().is_some() => {
                if open.len() >= limits.depth {
                    return Err(Error::new(span, ErrorKind::TooDeep { limit: limits.depth }));
                }
                open.push(tokens.len());
            }
            _ if kind.is_closer() => {
                first = close(kind, span, open.pop().map(|index| (index, tokens[index])))?;
            }
            _ => {}
        }
        let follows_fraction = first > 0 && tokens[first - 1].kind == Fraction;
        is_part = kind == Fraction
            || (matches!(kind, Digit | CloseBrace) || kind.is_name()) && follows_fraction;
        tokens.push(Token::new(kind, span));
    }
    close_at(end, closures, &mut open, &mut tokens);
    let open = OpenBrackets::new(&tokens, &open);
    if !tokens.is_empty() {
        statements.push(tokens);
    }
    Ok(Scanned { statements, open })
}

/// Words that occur only in programs of Python. Each has one of [`PYTHON_SIGNS`].
const PYTHON: &str = "np. numpy. plt. mlab. measure.marching_cubes go.Figure( go.Isosurface( pv. k3d. mcubes. ipv. \
    mgrid[ symbols( Symbol( lambdify( Piecewise(( plot3d_parametric_line( sum([ Symb( .subs(";

const PYTHON_SIGNS: [char; 3] = ['.', '(', '['];

/// Returns whether a text is a program in Python, in which `//` divides and quotation marks enclose
/// strings.
pub fn is_python(text: &str) -> bool {
    let is_statement = |line: &str| {
        let line = line.trim_start_matches([' ', '\t', '>']);
        let is_import =
            line.starts_with("import ") || line.starts_with("from ") && line.contains(" import ");
        line.starts_with("def ") && (line.contains("):") || line.trim_end().ends_with(':'))
            || line.starts_with("class ") && line.ends_with(':')
            || is_import && !line.trim_end().ends_with(';')
    };
    let has_comment = || text.lines().any(|line| line.trim_start().starts_with("//"));
    // Most formulas have none of these signs, and each formula that is typed is read several times.
    let has_word =
        || text.contains(PYTHON_SIGNS) && PYTHON.split(' ').any(|word| text.contains(word));
    let is_found = text.lines().any(is_statement)
        || text.contains("lambda x") && !text.contains("implicit_plot3d")
        || has_word();
    is_found && !has_comment()
}

/// The place of a `title` line's text. `word` is the place of its first word, and `before` has the
/// statement's tokens before it. The text ends with the line, or before a `;` or `#`. Text in
/// quotes ends with the quote. `None` if the word has another meaning, as in `title = 3` and
/// `title("A plot")`.
fn title(text: &str, before: &[Token], word: Span) -> Option<Span> {
    if !before.is_empty() || typed_setting(&text[word.range()])?.kind != SettingKind::Title {
        return None;
    }
    let line = &text[word.end..];
    let line = &line[..line_length(line)];
    let typed = line.trim_start();
    let begin = word.end + line.len() - typed.len();
    let is_other = |c: char| "(:*/^+,".contains(c) || "=≠<≤>≥≔".contains(c);
    if begin == word.end || typed.starts_with(is_other) {
        return None;
    }
    let quoted = typed.strip_prefix('"').and_then(|rest| rest.find('"'));
    let length =
        quoted.map_or_else(|| typed.find([';', '#']).unwrap_or(typed.len()), |length| length + 2);
    let length = typed[..length].trim_end().len();
    (length > 0).then(|| Span::new(begin, begin + length))
}

/// Returns whether the `//` at the start of `rest` begins a comment rather than a division.
fn is_comment(rest: &str, tokens: &[Token], open: Option<Token>, text: &str) -> bool {
    let Some(before) = tokens.last().filter(|token| token.kind.ends_operand()) else {
        return true;
    };
    let place = text.len() - rest.len();
    if text[before.span.end..place].contains('\n') {
        return true;
    }
    let line = start(rest, 200);
    let line = line[2..line_length(line)].trim();
    match open {
        Some(Token { kind: OpenParen | OpenBracket, .. }) => !line.contains([')', ']']),
        Some(_) => true,
        None => {
            let word = prefix_length(line, is_name_char);
            let is_divisor = line.starts_with(|c: char| c.is_ascii_digit() || "(.-".contains(c));
            let is_letter = word <= 1 && word == line.len();
            !(is_divisor || is_letter || line[word..].starts_with(" ="))
        }
    }
}

/// Returns whether the statement `tokens` goes on in the line at the start of `rest`, for example
/// because it ends with an operator.
fn goes_on(rest: &str, text: &str, tokens: &[Token], is_python: bool) -> bool {
    let last = tokens.last().map_or(Blank, |token| token.kind);
    let first = tokens.first().map_or("", |token| &text[token.span.range()]);
    // `from sympy import *` ends with its line.
    let is_import = is_python && matches!(first, "from" | "import");
    let is_open = last.is_arithmetic() || matches!(last, Caret | Equals);
    !is_import && is_open && continues(rest) || must_continue(rest, tokens)
}

/// Returns whether the row at the start of `rest` continues the row before it.
fn continues_row(rest: &str) -> bool {
    const BLANKS: [&str; 11] =
        [" ", "\n", "\r", "\t", "&", "{}", r"\quad", r"\qquad", r"\,", r"\;", r"\ "];
    let mut rest = rest;
    while let Some(beyond) = BLANKS.iter().find_map(|blank| rest.strip_prefix(blank)) {
        rest = beyond;
    }
    rest.starts_with(['+', '-', '−', '=', '*', '<', '>', '/'])
        || [r"\cdot", r"\times", r"\le", r"\ge"].iter().any(|sign| rest.starts_with(sign))
}

/// Returns whether the line at the start of `rest` may continue the formula above. A definition or
/// a line about the picture may not.
fn continues(rest: &str) -> bool {
    let line = rest.trim_start_matches([' ', '\t', '\r']);
    let line = start(&line[..line_length(line)], 300);
    let name = prefix_length(line, is_name_char);
    let after = line[name..].trim_start();
    let defines = name > 0 && (after.starts_with('=') || after.starts_with(":="));
    let is_operand = name > 0 || line.starts_with(['(', '[', '{', '\\', '+', '-', '−', '|']);
    is_operand && !defines && !token_kind(&line[..name]).is_some_and(TokenKind::is_setting)
}

/// Returns whether the line at the start of `rest` must continue the formula `above`. Such a line
/// starts with a plus, with a relation or, if indented, with a minus. But the line is a separate
/// statement if it and `above` each contain a relation.
fn must_continue(rest: &str, above: &[Token]) -> bool {
    let is_relation = |c: char| "=≠<≤>≥≔".contains(c);
    let line = start(&rest[..line_length(rest)], 300);
    let formula = line.trim_start();
    let has_relation = above.iter().any(|token| token.kind.is_relation());
    // `<p>` is a tag, not a relation.
    let is_tag = formula.starts_with('<')
        && formula[1..].starts_with(|c: char| c == '/' || c.is_alphabetic());
    let is_rest = !is_tag
        && !formula.starts_with(">>>")
        && formula.starts_with(|c| c == '+' || is_relation(c))
        || formula.len() < line.len() && formula.starts_with(['-', '−']);
    is_rest && !above.is_empty() && !(has_relation && formula.contains(is_relation))
}

/// Index of the open bracket that a closing bracket of `kind` at `span` closes.
fn close(kind: TokenKind, span: Span, opened: Option<(usize, Token)>) -> Fallible<usize> {
    let Some((index, open)) = opened else {
        let kind = ErrorKind::Unopened { close: kind.as_char() };
        return Err(Error::new(span, kind).suggest(span, ""));
    };
    match open.kind.closer() {
        Some(meant) if meant != kind => {
            let is_typed = !matches!(meant, CloseChoice | CloseMatrix);
            let kind = ErrorKind::Mismatched { open: open.kind.as_char(), close: kind.as_char() };
            let meant = is_typed.then(|| meant.as_char().to_string());
            Err(Error::new(open.span.to(span), kind).suggest_optional(span, meant))
        }
        _ => Ok(index),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_end_at_breaks_outside_brackets() {
        let text = "r = 2; x^2 # one\n\n(y +\n z)\ncolor #ff8000\n";
        let statements = scan(text, &Limits::default()).expect("four statements");
        let read: Vec<&str> = statements
            .iter()
            .map(|tokens| &text[tokens[0].span.to(tokens[tokens.len() - 1].span).range()])
            .collect();
        assert_eq!(read, ["r = 2", "x^2", "(y +\n z)", "color #ff8000"]);
    }
}
