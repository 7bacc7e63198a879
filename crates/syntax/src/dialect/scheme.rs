//! Reads formulas in the prefix notation of libfive, such as `(- (+ (square x) (square y)) 1)`.

use crate::dialect::formats::{ForeignText, masked};
use crate::dialect::plot_arguments::PlotRange;
use crate::dialect::program_words::Words;
use crate::lex::scanner::scan;
use crate::lex::token::{Token, closing, in_brackets, span_of};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::limits::Limits;
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::Note;
use crate::span::Span;

/// Functions that have the same name and meaning here.
const FUNCTIONS: &[&str] =
    &["max", "min", "sqrt", "abs", "square", "sin", "cos", "tan", "asin", "acos", "exp", "atan"];

/// First words of texts that are certainly of libfive.
const SHAPES: &[&str] = &["(define-shape", "(lambda-shape", "(define (", "(remap-shape"];

struct SchemeReader<'a> {
    words: Words<'a>,
    statements: Vec<Vec<Token>>,
    /// Names of shapes, each with the tokens of its parameters.
    shapes: Vec<(&'a str, Vec<Token>)>,
    /// Names that `let` defines.
    values: Vec<&'a str>,
    note: Option<Note>,
}

/// Reads a text of libfive; `None` for any other text.
pub(crate) fn scheme(text: &str, limits: &Limits) -> Fallible<Option<ForeignText>> {
    let is_code = |line: &&str| !line.starts_with(';') && !line.is_empty();
    let first = text.lines().map(str::trim_start).find(is_code).unwrap_or_default();
    let is_certain = SHAPES.iter().any(|word| first.starts_with(word));
    let is_operation = ["(+ ", "(- ", "(* ", "(/ ", "(max ", "(min ", "(sqrt "]
        .iter()
        .any(|operation| first.starts_with(operation));
    if !is_certain && !is_operation {
        return Ok(None);
    }
    let kept = without_comments(text);
    let tokens = match scan(&kept, limits) {
        Ok(statements) => statements.into_iter().flatten().collect::<Vec<Token>>(),
        Err(error) => return if is_certain { Err(error) } else { Ok(None) },
    };
    let words = Words { text };
    let (statements, shapes, values) = (Vec::new(), Vec::new(), Vec::new());
    let mut reader = SchemeReader { words, statements, shapes, values, note: None };
    let mut rest = tokens.as_slice();
    while let Some(first) = rest.first() {
        match reader.form(rest) {
            Some(more) => rest = more,
            None if is_certain => {
                let kind = ErrorKind::Format {
                    format: "libfive",
                    read: "only formulas of numbers are read, and no shapes of its library",
                    help: "write the formula with its signs between the operands: \
                           `x^2 + y^2 + z^2 - 1`",
                };
                return Err(Error::new(first.span, kind));
            }
            None => return Ok(None),
        }
    }
    Ok(Some((reader.statements, reader.note)))
}

/// The text without comments after `;`, and without the marks of variable numbers, as in `#0.2`.
fn without_comments(text: &str) -> String {
    let mut kept = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let code = line.find(';').unwrap_or(line.trim_end_matches('\n').len());
        let mut start = at;
        for (mark, _) in line[..code].match_indices('#') {
            kept.push(start..at + mark);
            start = at + mark + 1;
        }
        kept.push(start..at + code);
        at += line.len();
    }
    masked(text, &kept)
}

/// Splits `tokens` into its first part, which is an atom or a list, and the tokens after it.
fn next(tokens: &[Token]) -> Option<(&[Token], &[Token])> {
    if let Some(end) = closing(tokens) {
        return Some(tokens.split_at(end + 1));
    }
    let is_end = |pair: &[Token]| {
        pair[0].span.end < pair[1].span.start
            || pair[1].kind.is_closer()
            || pair[1].kind.closer().is_some()
    };
    tokens.first().filter(|first| !first.kind.is_closer())?;
    let count = tokens.windows(2).position(is_end).map_or(tokens.len(), |at| at + 1);
    Some(tokens.split_at(count))
}

/// The parts of a list in brackets; `None` for an atom.
fn parts(list: &[Token]) -> Option<Vec<&[Token]>> {
    let end = closing(list)?;
    let mut rest = &list[1..end];
    let mut all = Vec::new();
    while !rest.is_empty() {
        let (part, more) = next(rest)?;
        all.push(part);
        rest = more;
    }
    Some(all)
}

fn sign(kind: TokenKind, at: usize) -> Token {
    Token::new(kind, Span::at(at))
}

impl<'a> SchemeReader<'a> {
    fn typed(&self, part: &[Token]) -> &'a str {
        span_of(part).map_or("", |span| &self.words.text[span.range()])
    }

    /// Reads a form outside all others. Returns the tokens after it.
    fn form<'t>(&mut self, tokens: &'t [Token]) -> Option<&'t [Token]> {
        let (form, rest) = next(tokens)?;
        let list = parts(form).unwrap_or_default();
        let head = list.first().map_or("", |head| self.typed(head));
        match (head, list.as_slice()) {
            ("lambda-shape", [_, _, body]) => {
                let body = self.expression(body)?;
                self.statements.push(body);
            }
            ("define-shape", [_, head, body]) => {
                let head = parts(head)?.into_iter();
                let names = head.map(|part| <[Token; 1]>::try_from(part).map(|[name]| name).ok());
                let names: Vec<Token> = names.collect::<Option<_>>()?;
                let (name, parameters) = names.split_first()?;
                let mut left = vec![*name];
                self.list(&mut left, parameters);
                self.shapes.push((self.words.word(*name), left.clone()));
                left.push(sign(Equals, body.first()?.span.start));
                left.extend(self.expression(body)?);
                self.statements.push(left);
            }
            ("set-bounds!", [_, low, high]) => {
                let ends = parts(low)?.into_iter().zip(parts(high)?);
                let range = |(low, high): (&[Token], &[Token])| PlotRange {
                    name: None,
                    low: low.to_vec(),
                    high: high.to_vec(),
                };
                let ranges: Vec<PlotRange> = ends.map(range).collect();
                let axes = [X, Y, Z].get(..ranges.len())?;
                let (domain, note) = self.words.domain(&ranges, axes, form[0].span);
                self.statements.extend(domain);
                self.note = note;
            }
            ("set-quality!" | "set-resolution!", _) => {}
            ("", _) => {
                let shape = self.shapes.iter().find(|(name, _)| *name == self.typed(form))?;
                self.statements.push(shape.1.clone());
            }
            _ => {
                let body = self.expression(form)?;
                self.statements.push(body);
            }
        }
        Some(rest)
    }

    /// Appends `tokens` in brackets, separated by commas.
    fn list(&self, out: &mut Vec<Token>, tokens: &[Token]) {
        for (index, token) in tokens.iter().enumerate() {
            let kind = if index == 0 { OpenParen } else { Comma };
            out.extend([sign(kind, token.span.start), *token]);
        }
        let end = tokens.last().map_or(0, |last| last.span.end);
        out.push(sign(CloseParen, end));
    }

    /// The tokens of a value in the usual notation.
    fn expression(&mut self, part: &[Token]) -> Option<Vec<Token>> {
        let Some(list) = parts(part) else {
            let is_value = match part {
                [only] => {
                    matches!(only.kind, X | Y | Z | Number)
                        || self.values.contains(&self.words.word(*only))
                }
                [minus, number] => (minus.kind, number.kind) == (Minus, Number),
                _ => false,
            };
            return is_value.then(|| in_brackets(part));
        };
        let (head, operands) = list.split_first()?;
        let word = self.typed(head);
        let (start, end) = (part[0].span.start, part[part.len() - 1].span.end);
        if let ("let" | "let*", [bindings, body]) = (word, operands) {
            for binding in parts(bindings)? {
                let [[name], value] = <[_; 2]>::try_from(parts(binding)?).ok()? else {
                    return None;
                };
                let text = self.words.word(*name);
                if text.is_empty() || name.kind.is_axis() || self.values.contains(&text) {
                    return None;
                }
                let mut line = vec![*name, sign(Equals, name.span.end)];
                line.extend(self.expression(value)?);
                self.values.push(text);
                self.statements.push(line);
            }
            return self.expression(body);
        }
        let kind = match (word, operands.len()) {
            ("+", 1..) => Plus,
            ("-", 1..) => Minus,
            ("*", 1..) => Star,
            ("/", 2..) => Slash,
            ("expt" | "pow", 2) => Caret,
            (_, 1..) if FUNCTIONS.contains(&word) => Comma,
            _ => return None,
        };
        let mut all = if kind == Comma { head.to_vec() } else { Vec::new() };
        all.push(sign(OpenParen, start));
        for (index, operand) in operands.iter().enumerate() {
            if index > 0 || kind == Minus && operands.len() == 1 {
                all.push(sign(kind, operand[0].span.start));
            }
            all.extend(self.expression(operand)?);
        }
        all.push(sign(CloseParen, end));
        Some(all)
    }
}
