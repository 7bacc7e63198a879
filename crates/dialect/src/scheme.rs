//! Reads formulas in the prefix notation of libfive, such as `(- (+ (square x) (square y)) 1)`.

use crate::plot_arguments::PlotRange;
use crate::program::{ForeignStatement, ForeignText};
use crate::program_words::Words;
use zeroset_parser::lex::scanner::scan;
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, span_of};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Note, NoteKind, Span};

/// Functions that have the same name and meaning here.
const FUNCTIONS: &[&str] =
    &["max", "min", "sqrt", "abs", "square", "sin", "cos", "tan", "asin", "acos", "atan", "exp"];

/// Largest number of shapes, and of values. Each name is searched among them.
const MAX_NAMES: usize = 200;

struct SchemeReader<'a> {
    words: Words<'a>,
    statements: Vec<Vec<Token>>,
    /// The calls of defined shapes, such as `f(x, y, z)`.
    shapes: Vec<Vec<Token>>,
    /// Names that `let` defines.
    values: Vec<&'a str>,
    notes: Vec<Note>,
}

/// Reads a text of libfive; `None` for any other text.
pub(crate) fn scheme(text: &str, limits: &Limits) -> Fallible<Option<ForeignText>> {
    let is_certain = ["(define", "(lambda-shape", "(remap-shape"].iter().any(|w| text.contains(w));
    if !is_certain && !text.trim_start().starts_with('(') {
        return Ok(None);
    }
    // Comments and the marks of variable numbers, as in `#0.2`, are left out.
    let mut in_comment = false;
    let code = text.bytes().map(|byte| {
        in_comment = byte != b'\n' && (in_comment || byte == b';');
        let is_kept = !in_comment && byte.is_ascii() && byte != b'#';
        if is_kept { char::from(byte) } else { ' ' }
    });
    let Ok(statements) = scan(&code.collect::<String>(), limits) else { return Ok(None) };
    let tokens = statements.concat();
    let (statements, shapes, values) = (Vec::new(), Vec::new(), Vec::new());
    let words = Words { text };
    let mut reader = SchemeReader { words, statements, shapes, values, notes: Vec::new() };
    for form in items(&tokens) {
        if reader.form(form).is_some() {
            continue;
        }
        let kind = ErrorKind::Format {
            format: "libfive",
            read: "only formulas of numbers are read, and no shapes of its library",
            help: "write the signs between the operands, as in `x^2 + y^2 + z^2 - 1`",
        };
        return if is_certain { Err(Error::new(form[0].span, kind)) } else { Ok(None) };
    }
    let SchemeReader { statements, notes, .. } = reader;
    let span = statements.first().map_or(Span::default(), |first| first[0].span);
    let statements = statements.into_iter().map(ForeignStatement::plain).collect();
    Ok(Some(ForeignText { statements, boxes: Vec::new(), notes, span }))
}

/// Splits `tokens` into lists in brackets, and atoms.
fn items(tokens: &[Token]) -> Vec<&[Token]> {
    let ends = |pair: &[Token]| {
        let is_bracket = pair[1].kind.is_closer() || pair[1].kind.closer().is_some();
        is_bracket || pair[0].span.end < pair[1].span.start
    };
    let (mut all, mut rest) = (Vec::new(), tokens);
    while !rest.is_empty() {
        let atom = || rest.windows(2).position(ends).unwrap_or(rest.len() - 1);
        let (item, more) = rest.split_at(closing(rest).unwrap_or_else(atom) + 1);
        all.push(item);
        rest = more;
    }
    all
}

/// The parts of a list; `None` for an atom.
fn parts(list: &[Token]) -> Option<Vec<&[Token]>> {
    bracketed(list).map(|(inner, _)| items(inner))
}

fn sign(kind: TokenKind, at: usize) -> Token {
    Token::new(kind, Span::at(at))
}

impl<'a> SchemeReader<'a> {
    fn typed(&self, part: &[Token]) -> &'a str {
        span_of(part).map_or("", |span| &self.words.text[span.range()])
    }

    /// Reads a form at the top level of the text; `None` if it cannot be read.
    fn form(&mut self, form: &[Token]) -> Option<()> {
        let list = parts(form).unwrap_or_default();
        match (list.first().map_or("", |head| self.typed(head)), list.as_slice()) {
            ("set-quality!" | "set-resolution!", _) => {
                let kind = NoteKind::StyleLeftOut { example: short_name(self.typed(form)) };
                self.notes.push(Note { span: span_of(form)?, kind });
            }
            ("set-bounds!", [_, low, high]) => {
                let ends = parts(low)?.into_iter().zip(parts(high)?);
                let owned = |(low, high): (&[Token], &[Token])| (low.to_vec(), high.to_vec());
                let ranges: Vec<PlotRange> = ends
                    .map(owned)
                    .map(|(low, high)| PlotRange { name: None, low, high })
                    .collect();
                let axes = [X, Y, Z].get(..ranges.len())?;
                let (domain, note) = self.words.domain(&ranges, axes, form[0].span);
                self.statements.extend(domain);
                self.notes.extend(note);
            }
            ("define-shape", [_, head, body]) => {
                let (names, _) = bracketed(head)?;
                let (name, parameters) = names.split_first()?;
                let is_point = parameters.iter().map(|token| token.kind).eq([X, Y, Z]);
                let between = |pair: &[Token]| [pair[0], sign(Comma, pair[0].span.end)];
                let mut call = vec![*name, sign(OpenParen, name.span.end)];
                call.extend(parameters.windows(2).flat_map(between));
                call.extend([*parameters.last()?, sign(CloseParen, parameters.get(2)?.span.end)]);
                self.shapes.push(call.clone());
                call.push(sign(Equals, body[0].span.start));
                let is_read = is_point && self.shapes.len() < MAX_NAMES;
                call.extend(self.expression(body).filter(|_| is_read)?);
                self.statements.push(call);
            }
            ("", _) => {
                let name = self.typed(form);
                let call = self.shapes.iter().find(|call| self.words.word(call[0]) == name)?;
                self.statements.push(call.clone());
            }
            (word, _) => {
                let body = if word == "lambda-shape" { *list.get(2)? } else { form };
                let body = self.expression(body)?;
                self.statements.push(body);
            }
        }
        Some(())
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
        if let ("let" | "let*", [bindings, body]) = (word, operands) {
            for binding in parts(bindings)? {
                let binding = parts(binding)?;
                let [[name], value] = binding.as_slice() else { return None };
                let text = self.words.word(*name);
                let is_full = self.values.len() >= MAX_NAMES;
                if name.kind != TokenKind::Name || is_full || self.values.contains(&text) {
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
        all.push(sign(OpenParen, part[0].span.start));
        for (index, operand) in operands.iter().enumerate() {
            if index > 0 || kind == Minus && operands.len() == 1 {
                all.push(sign(kind, operand[0].span.start));
            }
            all.extend(self.expression(operand)?);
        }
        all.push(sign(CloseParen, part[part.len() - 1].span.end));
        Some(all)
    }
}
