//! Turns assignments of programs into definitions. If a variable already has a value, an assignment
//! to it defines another name, to which later uses of the variable refer.

use crate::effects::Target;
use crate::known_numbers::{number_expr, number_of};
use crate::program_reader::{Frame, ProgramReader};
use crate::program_words::Words;
use zeroset_parser::lex::token_kind::TokenKind::{Comma, Number, OpenBracket};
use zeroset_parser::tree::raw_statement::{Head, ValueConversion};

use zeroset_parser::lex::token::{Token, span_of, split};
use zeroset_parser::tree::aliases::Aliases;
use zeroset_parser::tree::ast::Name;
use zeroset_parser::{Error, ErrorKind, Fallible};

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
            if self.may_have_effects(frame)
                && self.words.lambda(&tokens).is_none()
                && let Some((name, None, value)) = self.words.assignment(&tokens)
            {
                // In `float d = d;` the right side has the outer variable.
                let before = std::mem::take(&mut self.reads);
                let value = self.assignment(&value, frame)?;
                self.reads = before;
                let word = self.words.word(name);
                self.declare(word, is_whole, frame);
                frame.set.push((word.to_owned(), size));
                self.store(&Target { name, letters: None }, value, frame)?;
                continue;
            }
            if self.run_counter_assignment(&tokens, frame) {
                continue;
            }
            if let Some((name, parameters, value)) = self.words.lambda(&tokens) {
                self.lambda(name, parameters, value, frame)?;
            } else if let Some((name, None, value)) = self.words.assignment(&tokens) {
                let name = self.words.name(name);
                self.set(name, size, value, frame)?;
            } else if let [name, open, ..] = tokens.as_slice()
                && open.kind == OpenBracket
                && name.kind.is_name()
            {
                if !self.declares_array(&tokens, frame) {
                    return Err(Error::new(name.span, ErrorKind::Array));
                }
            } else if let [name] = tokens.as_slice() {
                // A declaration without a value, such as `float a;`.
                let word = self.words.word(*name);
                self.declare(word, is_whole, frame);
                frame.set.push((word.to_owned(), size));
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
            let number = self.known_value(&value, frame).filter(|_| conversion.is_none());
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

    /// Runs an assignment of a known number. Returns false, and does nothing, for any other
    /// statement.
    pub(crate) fn run_counter_assignment(&mut self, tokens: &[Token], frame: &mut Frame) -> bool {
        let Some((name, None, value)) = self.words.assignment(tokens) else { return false };
        self.record_number(self.words.word(name), &value, frame)
    }

    /// Records the number of the variable `name` if `value` is a known number and the variable is
    /// tracked. Returns whether it was recorded. A variable is tracked if it is a counter or has a
    /// known number, or while it holds whole numbers.
    pub(crate) fn record_number(&self, name: &str, value: &[Token], frame: &mut Frame) -> bool {
        let is_known = frame.aliases.find(name).is_some_and(|kind| number_of(kind).is_some());
        let is_counter =
            frame.counters.contains(name) || frame.is_inner() && frame.integers.contains(name);
        let Some(number) = self.known_value(value, frame) else { return false };
        let is_tracked = frame.is_inner() && self.may_have_effects(frame) && number.fract() == 0.0;
        if !(is_known || is_counter || is_tracked && self.is_of_whole_numbers(value)) {
            return false;
        }
        let span = span_of(value).unwrap_or_default();
        frame.aliases.push(name.to_owned(), number_expr(number, span));
        let size = frame.size(name).unwrap_or(1);
        frame.set.push((name.to_owned(), size));
        true
    }

    /// Returns whether all numbers in `tokens` are whole, and small enough for exact arithmetic.
    fn is_of_whole_numbers(&self, tokens: &[Token]) -> bool {
        tokens.iter().filter(|token| token.kind == Number).all(|token| {
            let number: Option<f64> = self.words.text[token.span.range()].parse().ok();
            number.is_some_and(|number| number.fract() == 0.0 && number < 1e9)
        })
    }
}
