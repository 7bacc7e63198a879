//! Turns assignments of programs into definitions. If a variable already has a value, an assignment
//! to it defines another name, to which later uses of the variable refer.

use crate::dialect::known_numbers::{number_expr, number_of};
use crate::dialect::program_reader::{Frame, ProgramReader};
use crate::dialect::program_words::Words;
use crate::lex::token_kind::TokenKind::{Comma, Number, OpenBracket, Slash};
use crate::tree::raw_statement::{Head, ValueConversion};

use crate::lex::token::{Token, split};
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::span::Span;
use crate::tree::aliases::Aliases;
use crate::tree::ast::Name;

/// Largest number of declarations and assignments in one function, or outside functions.
const MAX_NAMES: usize = 1500;

impl ProgramReader<'_> {
    /// Reads a declaration such as `float a = 1., b = 2.`. `tokens` begin after the type.
    pub(crate) fn declarations(
        &mut self,
        tokens: &[Token],
        size: usize,
        is_whole: bool,
        frame: &mut Frame,
    ) -> Fallible<()> {
        for tokens in split(tokens, Comma) {
            let tokens = Words::without_type(tokens);
            if is_whole && let Some(name) = tokens.first() {
                let word = self.words.word(*name);
                if frame.is_inner() {
                    frame.integers.insert(word.to_owned());
                }
                self.integers.insert(word.to_owned());
            }
            if self.counts(&tokens, frame) {
                continue;
            }
            if let Some((name, parameters, value)) = self.words.lambda(&tokens) {
                self.lambda(name, parameters, value, frame)?;
            } else if let Some((name, None, value)) = self.words.assignment(&tokens) {
                if let Some((procedure, arguments)) = self.called(&value) {
                    let kind = self.inline(value[0], &procedure, &arguments, frame)?;
                    let text = self.words.name(name).text;
                    let none = || Error::new(name.span, ErrorKind::NoEffect);
                    frame.aliases.push(text.clone(), kind.ok_or_else(none)?);
                    frame.set.push((text, size));
                    continue;
                }
                let name = self.words.name(name);
                self.set(name, size, value, frame)?;
            } else if let [name, open, ..] = tokens.as_slice()
                && open.kind == OpenBracket
                && name.kind.is_name()
            {
                return Err(Error::new(name.span, ErrorKind::Array));
            } else if let [name] = tokens.as_slice() {
                // A declaration without a value, such as `float a;`.
                frame.set.push((self.words.word(*name).to_owned(), size));
            } else {
                self.plain(tokens, frame, false)?;
            }
        }
        Ok(())
    }

    /// Reads the assignment `name = value`.
    pub(crate) fn set(
        &mut self,
        name: Name,
        size: usize,
        value: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<()> {
        let within = frame.aliases.clone();
        self.assign_within(name, size, value, None, &within, frame)
    }

    /// Reads the assignment `name = value`. `within` holds the values of the variables in `value`.
    pub(crate) fn assign_within(
        &mut self,
        name: Name,
        size: usize,
        value: Vec<Token>,
        conversion: Option<ValueConversion>,
        within: &Aliases,
        frame: &mut Frame,
    ) -> Fallible<()> {
        if frame.set.len() >= MAX_NAMES {
            return Err(Error::new(name.span, ErrorKind::TooManyNames { limit: MAX_NAMES }));
        }
        let again = frame.set.iter().any(|(set, _)| *set == name.text)
            && frame.aliases.find(&name.text).is_some()
            || self.defined_names.contains(&name.text);
        let is_inner = frame.is_inner();
        let text = match &frame.function {
            _ if is_inner => self.fresh(&frame.generated_name(&name.text)),
            None if again
                || conversion.is_some()
                || self.words.has(&value, &name.text)
                || name.text.chars().all(|letter| "xyzt".contains(letter)) =>
            {
                self.fresh(&format!("{}_2", name.text))
            }
            _ => name.text.clone(),
        };
        let (parameters, kind) = frame.call(&text);
        if frame.nested > 0 {
            self.program.generated.insert(text.clone());
        }
        let mut is_constant = false;
        if frame.function.is_none() {
            let number = self.known(&value, &mut frame.clone()).filter(|_| conversion.is_none());
            is_constant = number.is_some();
            match number {
                Some(number) => self.constants.insert(name.text.clone(), number),
                None => self.constants.remove(&name.text),
            };
        }
        let renamed = text != name.text;
        let new_name = Name { text, span: name.span };
        let is_outside = frame.function.is_none() && frame.prefix.is_none();
        if size == 1 && conversion.is_none() && is_outside && !is_constant {
            self.program.last_value = Some(new_name.clone());
        }
        let head = Head { name: new_name, parameters };
        self.push(value, Some(head), conversion, within, false)?;
        if renamed || is_inner {
            frame.aliases.push(name.text.clone(), kind);
        }
        frame.set.push((name.text, size));
        Ok(())
    }

    /// Place of the first quotient of two integers, such as `n / 2`, that contains a variable.
    pub(crate) fn truncated_quotient(&self, tokens: &[Token]) -> Option<Span> {
        if self.integers.is_empty() {
            return None;
        }
        let is_named = |token: Token| self.integers.contains(self.words.word(token));
        let is_whole = |token: Token| {
            let typed = &self.words.text[token.span.range()];
            is_named(token) || token.kind == Number && typed.bytes().all(|b| b.is_ascii_digit())
        };
        let found = tokens.windows(3).find(|part| {
            part[1].kind == Slash
                && is_whole(part[0])
                && is_whole(part[2])
                && (is_named(part[0]) || is_named(part[2]))
        });
        found.map(|part| part[0].span.to(part[2].span))
    }

    /// Returns the name `wanted`, with a number if `wanted` is taken. Marks the result as taken.
    pub(crate) fn fresh(&mut self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        let mut number = 2;
        while !self.taken.insert(name.clone()) {
            number += 1;
            name = format!("{}_{number}", wanted.strip_suffix("_2").unwrap_or(wanted));
        }
        name
    }

    /// Reads `return value`.
    pub(crate) fn result(&mut self, tokens: Vec<Token>, frame: &Frame) -> Fallible<()> {
        self.push(tokens, frame.function.clone(), None, &frame.aliases, false)
    }

    /// Runs an assignment to a counter if the assigned value is known. Returns whether it was run.
    pub(crate) fn counts(&mut self, tokens: &[Token], frame: &mut Frame) -> bool {
        if Words::steps_by_one(tokens) && tokens.len() == 3 {
            return self.known(tokens, frame).is_some();
        }
        let Some((name, None, value)) = self.words.assignment(tokens) else { return false };
        let text = self.words.word(name).to_owned();
        let is_known = frame.aliases.find(&text).is_some_and(|kind| number_of(kind).is_some());
        if !is_known && !frame.integers.contains(&text) {
            return false;
        }
        let Some(number) = self.known(&value, frame) else { return false };
        frame.aliases.push(text.clone(), number_expr(number, name.span));
        frame.set.push((text, 1));
        true
    }
}
