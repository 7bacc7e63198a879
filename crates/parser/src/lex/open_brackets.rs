//! Brackets that are open at the end of a text: the error for them, and where they may be closed.

use crate::lex::scanner::{scan, scan_closing};
use crate::lex::spelling::short_name;
use crate::lex::token::{Token, closing};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::explain::statement;
use crate::messages::note::{Note, NoteKind};
use crate::span::Span;

/// Largest number of lines in which brackets are closed.
const MOST_LINES: usize = 8;

/// Largest number of characters before the closed brackets that a note quotes.
const MOST_QUOTED: usize = 60;

/// Brackets that are open at the end of a text.
pub(crate) struct OpenBrackets {
    /// The tokens from the outermost of the brackets on.
    tokens: Vec<Token>,
    /// Indices in `tokens` of the brackets. The first is 0.
    open: Vec<usize>,
}

/// A place at which a bracket, and all that is open inside it, is closed.
pub(crate) struct Closure {
    /// Start of the bracket in the text.
    start: usize,
    place: usize,
}

/// Closes the brackets that `closures` closes at `place`. `open` has their indices in `tokens`.
pub(crate) fn close_at(
    place: usize,
    closures: &[Closure],
    open: &mut Vec<usize>,
    tokens: &mut Vec<Token>,
) {
    for closure in closures.iter().filter(|closure| closure.place == place) {
        while let Some(index) = open.pop_if(|index| tokens[*index].span.start >= closure.start) {
            let close = tokens[index].kind.closer().unwrap_or(CloseParen);
            tokens.push(Token::new(close, Span::at(place)));
        }
    }
}

impl OpenBrackets {
    /// The brackets whose indices in `tokens` are `open`; `None` without brackets.
    pub(crate) fn new(tokens: &[Token], open: &[usize]) -> Option<Self> {
        let first = *open.first()?;
        let open = open.iter().map(|index| index - first).collect();
        Some(Self { tokens: tokens[first..].to_vec(), open })
    }

    /// The tokens that the brackets likely hold: those of the line, or those before a relation.
    fn contents(&self, text: &str) -> &[Token] {
        let from = self.tokens[0].span.end;
        let line = text[from..].find(['\n', '\r']).map_or(text.len(), |length| from + length);
        let is_on_line = |token: &&Token| token.kind != Semicolon && token.span.start < line;
        let line = &self.tokens[..self.tokens.iter().take_while(is_on_line).count()];
        let mut at = 1;
        while at < line.len() {
            // A pair of brackets is skipped.
            if line[at].kind.closer().is_some() && !self.open.contains(&at) {
                at += closing(&line[at..]).unwrap_or(0);
            } else if line[0].kind == OpenParen && ends_before(line, at) {
                return &line[..at];
            }
            at += 1;
        }
        line
    }

    /// The place where the brackets are likely meant to end.
    fn place(&self, text: &str) -> Option<usize> {
        let last = self.contents(text).last()?;
        // An environment is closed by a command, not by a character.
        let is_typed = |index: &usize| !matches!(self.tokens[*index].kind, OpenChoice | OpenMatrix);
        let is_closable = last.kind.ends_operand() && self.open.iter().all(is_typed);
        is_closable.then_some(last.span.end)
    }

    /// The closing of the brackets, if they are open only on one line. The next line must not
    /// continue it.
    fn closure(&self, text: &str) -> Option<Closure> {
        let place = self.place(text)?;
        let rest = &text[place..];
        let (line, below) = rest.split_once('\n').unwrap_or((rest, ""));
        let next = below.lines().find(|line| !line.trim().is_empty()).unwrap_or("");
        let continues = |c: char| c.is_whitespace() || "+-−*/^=<>≤≥)]},&|".contains(c);
        // The body of a function may hold more than one statement.
        let is_last = self.tokens[0].kind != OpenBrace
            || !line.contains(';')
            || line.trim_matches([';', ' ']).is_empty() && next.is_empty();
        let is_on_line = self.open.iter().all(|index| self.tokens[*index].span.start < place);
        // Before an equals sign, the bracket may be meant to end earlier.
        let behind = self.tokens.iter().find(|token| token.span.start >= place);
        let is_last = is_last && behind.is_none_or(|token| token.kind != Equals);
        (is_on_line && is_last && !next.starts_with(continues))
            .then(|| Closure { start: self.tokens[0].span.start, place })
    }

    /// The signs that close the brackets, the inner ones first.
    fn closers(&self) -> String {
        let closers = self.open.iter().rev().filter_map(|index| self.tokens[*index].kind.closer());
        closers.map(TokenKind::as_char).collect()
    }
}

/// Returns whether an open round bracket at the start of `line` likely ends before the sign at
/// `at`. An equals sign after a single name may belong in the bracket, as in `sum(k = 1..5, x^k)`;
/// so may an inequality before a comma, as in `if(x > 0, 1, 0)`.
fn ends_before(line: &[Token], at: usize) -> bool {
    match line[at].kind {
        Equals => {
            let before = at.checked_sub(2).map(|before| line[before].kind);
            let is_range = line[at..].iter().any(|token| token.kind == Dots);
            let is_named = line.get(2).is_some_and(|second| second.kind == Equals);
            match before {
                Some(Comma) => !is_range && !is_named,
                Some(kind) => kind.closer().is_none(),
                None => false,
            }
        }
        kind if kind.is_inequality() => {
            let is_joined = |token: &Token| token.kind == Comma || token.kind.is_logical();
            !line.iter().any(|token| token.kind.is_logical()) && !line[at..].iter().any(is_joined)
        }
        _ => false,
    }
}

/// The error for brackets that are open at the end of a text. If there is only one, the error's
/// place is where the missing bracket most likely belongs.
pub(crate) fn unclosed(text: &str, brackets: &OpenBrackets) -> Box<Error> {
    let Token { kind, span, .. } = brackets.tokens[0];
    let unclosed = ErrorKind::Unclosed { open: kind.as_char(), at: span };
    match brackets.place(text) {
        Some(place) => {
            let place = Span::at(place);
            Error::new(place, unclosed).suggest(place, brackets.closers())
        }
        None => Error::new(span, unclosed),
    }
}

/// Like [`scan`], but a bracket that is open at the end of its line is closed there, or before the
/// relation that follows. Returns a note for each such line.
///
/// # Errors
/// As [`scan`], and if it is not clear where a bracket is to be closed.
pub fn scan_lines(text: &str, limits: &Limits) -> Fallible<(Vec<Vec<Token>>, Vec<Note>)> {
    let (mut closures, mut notes) = (Vec::new(), Vec::new());
    while closures.len() < MOST_LINES {
        let scanned = scan_closing(text, limits, &closures)?;
        let Some(brackets) = scanned.open else { return Ok((scanned.statements, notes)) };
        let Some(closure) = brackets.closure(text) else { return Err(unclosed(text, &brackets)) };
        let line = statement(text, Span::at(closure.place));
        let (before, after) = (&text[line.start..closure.place], &text[closure.place..line.end]);
        let skipped = before.chars().count().saturating_sub(MOST_QUOTED);
        let quoted: String = before.chars().skip(skipped).collect();
        let dots = if skipped > 0 { "…" } else { "" };
        let read = format!("{dots}{quoted}{}{}", brackets.closers(), short_name(after));
        let span = brackets.tokens[0].span;
        notes.push(Note { span, kind: NoteKind::BracketClosed { read } });
        closures.push(closure);
    }
    scan(text, limits).map(|statements| (statements, notes))
}
