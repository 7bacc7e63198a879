//! Expands macros. Inlines functions of programs that change their arguments or return nothing.

use crate::control_flow::RESULT;
use crate::program_reader::{Frame, Macro, Procedure, ProgramReader};
use std::rc::Rc;
use zeroset_parser::lex::token::{Token, closing, in_brackets, split};
use zeroset_parser::lex::token_kind::TokenKind::{Comma, Component, OpenParen};
use zeroset_parser::tree::ast::ExprKind;
use zeroset_parser::tree::built_statement::with_parts;
use zeroset_parser::{Error, ErrorKind, Fallible};

/// Deepest nesting of inlined calls, and of macros.
const MAX_DEPTH: usize = 12;

impl ProgramReader<'_> {
    /// Records a macro: `#define name body` or `#define name(a) body`.
    pub(crate) fn macro_of(&mut self, tokens: &[Token]) {
        let Some(name) = tokens.first().copied() else { return };
        let rest = &tokens[1..];
        let is_call = rest
            .first()
            .is_some_and(|next| next.kind == OpenParen && next.span.start == name.span.end);
        let definition = match closing(rest).filter(|_| is_call) {
            Some(end) => {
                let names = rest[1..end].iter().map(|token| self.words.word(*token).to_owned());
                let parameters = names.filter(|name| !name.is_empty()).collect();
                Macro { parameters: Some(parameters), body: rest[end + 1..].to_vec() }
            }
            None => Macro { parameters: None, body: rest.to_vec() },
        };
        self.macros.insert(self.words.word(name).to_owned(), definition);
    }

    /// Expands the macros in `tokens`.
    pub(crate) fn expanded(&self, tokens: Vec<Token>, depth: usize) -> Fallible<Vec<Token>> {
        let found = |token: &Token| self.macros.get(self.words.word(*token));
        if self.macros.is_empty() || !tokens.iter().any(|token| found(token).is_some()) {
            return Ok(tokens);
        }
        let mut all = Vec::with_capacity(tokens.len());
        let mut at = 0;
        while let Some(token) = tokens.get(at).copied() {
            at += 1;
            let Some(definition) = found(&token) else {
                all.push(token);
                continue;
            };
            if depth > MAX_DEPTH {
                return Err(Error::new(token.span, ErrorKind::TooDeep { limit: MAX_DEPTH }));
            }
            let limit = self.limits.symbols;
            self.expanded_tokens.set(self.expanded_tokens.get() + definition.body.len() + 1);
            if self.expanded_tokens.get() > limit {
                return Err(Error::new(token.span, ErrorKind::TooManySymbols { limit }));
            }
            let Some(parameters) = &definition.parameters else {
                all.extend(self.expanded(definition.body.clone(), depth + 1)?);
                continue;
            };
            let Some(end) = closing(&tokens[at..]).filter(|_| tokens[at].kind == OpenParen) else {
                all.push(token);
                continue;
            };
            let arguments = split(&tokens[at + 1..at + end], Comma);
            at += end + 1;
            let mut body = Vec::with_capacity(definition.body.len());
            for part in &definition.body {
                let word = self.words.word(*part);
                let index = parameters.iter().position(|name| name == word);
                match index.and_then(|index| arguments.get(index)) {
                    Some(argument) if argument.len() > 1 => body.extend(in_brackets(argument)),
                    Some(argument) => body.extend(argument),
                    None => body.push(*part),
                }
            }
            all.extend(self.expanded(body, depth + 1)?);
        }
        Ok(all)
    }

    /// The called procedure and the arguments. `None` unless `tokens` are a single procedure call.
    pub(crate) fn called(&self, tokens: &[Token]) -> Option<(Rc<Procedure>, Vec<Vec<Token>>)> {
        let procedure = self.procedures.get(self.words.word(*tokens.first()?))?;
        let end = closing(&tokens[1..]).filter(|end| end + 2 == tokens.len())?;
        let arguments = split(&tokens[2..=end], Comma);
        (tokens[1].kind == OpenParen).then(|| (Rc::clone(procedure), arguments))
    }

    /// Runs a procedure's body in place of a call. Returns the procedure's result, if it has one.
    pub(crate) fn inline(
        &mut self,
        name: Token,
        procedure: &Procedure,
        arguments: &[Vec<Token>],
        frame: &mut Frame,
    ) -> Fallible<Option<ExprKind>> {
        if frame.depth >= MAX_DEPTH {
            return Err(Error::new(name.span, ErrorKind::TooDeep { limit: MAX_DEPTH }));
        }
        let word = self.words.word(name).to_owned();
        let prefix = frame.generated_name(&word);
        let mut inner = Frame {
            function: frame.function.clone(),
            nested: 1,
            depth: frame.depth + 1,
            integers: self.integers.clone(),
            prefix: Some(prefix),
            ..Frame::default()
        };
        for global in self.mutable.iter().filter(|_| procedure.uses_globals) {
            if frame.hides(global) {
                return Err(Error::new(name.span, ErrorKind::Hidden { name: global.clone() }));
            }
            if let Some(kind) = frame.aliases.find(global) {
                inner.aliases.push(global.clone(), kind.clone());
            }
        }
        for (given, argument) in procedure.parameters.iter().zip(arguments) {
            if given.is_in {
                let within = frame.aliases.clone();
                let (name, value) = (given.name.clone(), argument.clone());
                self.assign_within(name, given.size, value, None, &within, &mut inner)?;
            } else {
                inner.set.push((given.name.text.clone(), given.size));
            }
            self.declare(&given.name.text, given.is_whole, &mut inner);
        }
        self.run_open(&procedure.body, &mut inner, false)?;
        if procedure.uses_globals {
            for global in &self.mutable {
                let value = inner.aliases.find(global).filter(|_| !inner.hides(global));
                if let Some(kind) = value {
                    frame.aliases.push(global.clone(), kind.clone());
                }
            }
        }
        for (given, argument) in procedure.parameters.iter().zip(arguments) {
            let Some(value) = inner.aliases.find(&given.name.text).filter(|_| given.is_out) else {
                continue;
            };
            let (target, letters) = match argument.as_slice() {
                [target] => (*target, None),
                [target, letters] if letters.kind == Component => (
                    *target,
                    Some(self.words.text[letters.span.start + 1..letters.span.end].to_owned()),
                ),
                _ => return Err(Error::new(name.span, ErrorKind::OutParameter { name: word })),
            };
            self.write_back(target, letters, value.clone(), given.size, frame);
        }
        Ok(inner.aliases.find(RESULT).cloned())
    }

    /// Assigns `value` to the variable `target`, or to its components `letters`.
    fn write_back(
        &mut self,
        target: Token,
        letters: Option<String>,
        value: ExprKind,
        size: usize,
        frame: &mut Frame,
    ) {
        let name = self.words.name(target);
        let known = frame.set.iter().rfind(|(set, _)| *set == name.text).map(|(_, size)| *size);
        let kind = match letters {
            None => value,
            Some(letters) => {
                let before = frame.meaning(&name.text);
                let whole = known.unwrap_or(3);
                let body = with_parts(&letters, &before, whole, &value, name.span);
                self.synthesize(&name.text, body, frame)
            }
        };
        frame.aliases.push(name.text.clone(), kind);
        frame.set.push((name.text, known.unwrap_or(size)));
    }
}
