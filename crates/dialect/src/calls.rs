//! Reads calls in programs' expressions. Completes their arguments by names and default values, and
//! expands generators such as `sum(a for i in range(3))`.

use crate::language::Language;
use crate::lists::{joint_of, separated, with_signs};
use crate::program_reader::{Frame, Procedure, ProgramReader};
use crate::program_words::is_whole_vector;
use crate::terms::outside_word;
use std::rc::Rc;
use zeroset_parser::lex::token::{Token, bracketed, in_brackets, outside, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::tree::ast::ExprKind;
use zeroset_parser::{Error, ErrorKind, Fallible, plural};

impl ProgramReader<'_> {
    /// Expands a value of Python outside functions: generators, and calls that have keywords or
    /// lack arguments.
    pub(crate) fn with_calls(
        &mut self,
        value: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<Vec<Token>> {
        let is_call = |token: &Token| self.bodies.contains_key(self.words.word(*token));
        let is_expanded = self.words.has(&value, "for") || value.iter().any(is_call);
        let spreads =
            value.windows(2).any(|pair| (pair[0].kind, pair[1].kind) == (OpenParen, Star));
        if !self.is_python || !is_expanded || spreads || self.words.lambda(&value).is_some() {
            return Ok(value);
        }
        let before = std::mem::take(&mut self.reads);
        let value = self.assignment(&value, frame)?;
        self.reads = before;
        Ok(value.tokens)
    }

    /// Reads the call `call`, such as `f(a, b)`. Appends tokens of its value to `out`. Returns
    /// whether the value is an integer.
    pub(crate) fn call(
        &mut self,
        call: &[Token],
        out: &mut Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let (name, inner) = (call[0], &call[2..call.len() - 1]);
        let word = self.words.word(name);
        if let Some((procedure, arguments)) = self.called(call) {
            let kind = self.call_inline(name, &procedure, &arguments, frame)?;
            let kind = kind.ok_or_else(|| Error::new(name.span, ErrorKind::NoEffect))?;
            let is_whole = self.whole_functions.contains(word);
            out.push(self.saved(kind, name.span, is_whole, frame));
            return Ok(is_whole);
        }
        if let Some(body) = self.bodies.get(word).map(Rc::clone) {
            let arguments = split(inner, Comma);
            let is_named =
                |argument: &Vec<Token>| argument.get(1).is_some_and(|t| t.kind == Equals);
            let required = body.parameters.iter().filter(|given| given.default.is_none()).count();
            if arguments.iter().any(is_named) || arguments.len() != required {
                let kind = self.call_inline(name, &body, &arguments, frame)?;
                let kind = kind.ok_or_else(|| Error::new(name.span, ErrorKind::NoEffect))?;
                out.push(self.saved(kind, name.span, false, frame));
                return Ok(false);
            }
        }
        if matches!(self.language, Language::Python | Language::OpenScad)
            && let Some(joint) = joint_of(word)
            && let Some(values) = self.generated_values(inner, frame)?
        {
            out.extend(self.combined(name, joint, values, frame)?);
            return Ok(false);
        }
        let mut arguments = Vec::new();
        let is_whole = self.list(inner, &mut arguments, frame)?;
        let converts = self.language != Language::Script && !self.arities.contains_key(word);
        match word {
            "int" | "uint" if converts && split(inner, Comma).len() == 1 => {
                if is_whole {
                    out.extend(in_brackets(&arguments));
                } else if self.is_condition(&arguments, frame) {
                    let kind = self.indicator(arguments, frame)?;
                    out.push(self.saved(kind, name.span, true, frame));
                } else {
                    out.push(self.truncated(&arguments, frame)?);
                }
                return Ok(true);
            }
            "float" | "double" if self.is_condition(&arguments, frame) => {
                let kind = self.indicator(arguments, frame)?;
                out.push(self.saved(kind, name.span, false, frame));
                return Ok(false);
            }
            _ => {}
        }
        let mut all = vec![name, call[1]];
        all.extend(arguments);
        all.push(call[call.len() - 1]);
        if is_whole_vector(word) {
            let token = self.truncated(&all, frame)?;
            out.push(token);
            return Ok(true);
        }
        out.extend(all);
        let keeps = matches!(word, "abs" | "min" | "max" | "clamp" | "sign");
        Ok(keeps && is_whole || self.whole_functions.contains(word))
    }

    /// Calls a function whose body replaces the call. Its arguments run first.
    pub(crate) fn call_inline(
        &mut self,
        name: Token,
        procedure: &Procedure,
        arguments: &[Vec<Token>],
        frame: &mut Frame,
    ) -> Fallible<Option<ExprKind>> {
        let arguments = self.with_defaults(name, procedure, arguments)?;
        let mark = self.reads.len();
        let mut given = Vec::new();
        for (parameter, argument) in procedure.parameters.iter().zip(&arguments) {
            if parameter.is_out {
                given.push(argument.clone());
                continue;
            }
            let value = self.assignment(argument, frame)?;
            given.push(
                if parameter.is_whole && !value.is_whole && self.language == Language::Typed {
                    vec![self.truncated(&value.tokens, frame)?]
                } else {
                    value.tokens
                },
            );
        }
        self.reads.truncate(mark);
        for (parameter, argument) in procedure.parameters.iter().zip(&arguments) {
            if let Some(target) = argument.first().filter(|_| parameter.is_out) {
                self.check_order(self.words.word(*target), target.span)?;
            }
        }
        if procedure.changes_globals {
            let read = self.reads.iter().find(|read| self.mutable.contains(*read)).cloned();
            if let Some(read) = read {
                self.check_order(&read, name.span)?;
            }
        }
        let outer = std::mem::take(&mut self.reads);
        let result = self.inline(name, procedure, &given, frame)?;
        self.reads = outer;
        Ok(result)
    }

    /// The arguments of a call, in the order of the parameters. A missing one is the default.
    pub(crate) fn with_defaults(
        &self,
        name: Token,
        procedure: &Procedure,
        arguments: &[Vec<Token>],
    ) -> Fallible<Vec<Vec<Token>>> {
        let parameters = &procedure.parameters;
        let mut given: Vec<Option<Vec<Token>>> = vec![None; parameters.len()];
        let names_them = matches!(self.language, Language::Python | Language::OpenScad);
        let mut next = 0;
        let wrong = || {
            let expected = plural(parameters.len());
            let (name_text, given) = (self.words.word(name).to_owned(), arguments.len());
            let kind = ErrorKind::WrongCount { name: name_text, expected, given, usage: None };
            Error::new(name.span, kind)
        };
        for argument in arguments {
            let keyword = match argument.as_slice() {
                [keyword, equals, ..] if names_them && equals.kind == Equals => Some(*keyword),
                _ => None,
            };
            let (index, value) = if let Some(keyword) = keyword {
                let word = self.words.word(keyword);
                let index = parameters.iter().position(|given| given.name.text == word);
                (index.ok_or_else(wrong)?, argument[2..].to_vec())
            } else {
                next += 1;
                (next - 1, argument.clone())
            };
            let place = given.get_mut(index).ok_or_else(wrong)?;
            if place.replace(value).is_some() {
                return Err(wrong());
            }
        }
        let defaults = parameters.iter().map(|parameter| parameter.default.clone());
        let all: Option<Vec<_>> =
            given.into_iter().zip(defaults).map(|(given, default)| given.or(default)).collect();
        all.ok_or_else(wrong)
    }

    /// The sum, the product, the least or the greatest of `values`, as the call of `name` joins
    /// them.
    fn combined(
        &mut self,
        name: Token,
        joint: TokenKind,
        values: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<Vec<Token>> {
        if values.is_empty() && joint == Plus {
            return Ok(vec![self.number(0.0, name.span, frame)]);
        }
        let parts: Vec<Vec<Token>> = values.iter().map(|value| vec![*value]).collect();
        match (values.len(), joint) {
            (0, _) => Err(Error::new(name.span, ErrorKind::EmptyBrackets)),
            (1, _) => Ok(values),
            (_, Comma) => {
                Ok(std::iter::once(name).chain(in_brackets(&separated(&parts))).collect())
            }
            _ => Ok(in_brackets(&with_signs(&parts, joint))),
        }
    }

    /// The saved values of `a for i in range(3) if c`; `None` if `tokens` have another form.
    pub(crate) fn generated_values(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
    ) -> Fallible<Option<Vec<Token>>> {
        let tokens = match bracketed(tokens) {
            Some((inner, [])) if tokens[0].kind == OpenBracket => inner,
            _ => tokens,
        };
        if self.language == Language::OpenScad {
            return self.openscad_values(tokens, frame);
        }
        let Some(for_at) = outside_word(self, tokens, "for") else { return Ok(None) };
        let (body, rest) = (&tokens[..for_at], &tokens[for_at + 1..]);
        let Some(within) = outside(rest, In) else { return Ok(None) };
        let (pattern, rest) = (&rest[..within], &rest[within + 1..]);
        let if_at = outside_word(self, rest, "if");
        let (list, filter) = match if_at {
            Some(at) => (&rest[..at], Some(&rest[at + 1..])),
            None => (rest, None),
        };
        if filter.is_some_and(|filter| outside_word(self, filter, "for").is_some()) {
            return Ok(None);
        }
        self.each_value(pattern, list, filter, body, frame).map(Some)
    }
}
