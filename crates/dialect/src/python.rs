//! Runs statements of Python, and generators of Python and `OpenSCAD`.

use crate::effects::{PureValue, Target};
use crate::program_reader::{Frame, ProgramReader};
use crate::program_words::Words;
use zeroset_parser::lex::token::{Token, bracketed, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::{Comma, Equals, OpenParen, Slash};
use zeroset_parser::tree::ast::{Expr, ExprKind, LETTERS};
use zeroset_parser::{Error, ErrorKind, Fallible};

impl ProgramReader<'_> {
    /// Reads a statement outside functions, if its value has generators or calls to expand, or is a
    /// known number. Returns false for any other statement.
    pub(crate) fn run_top_python(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        if self.words.lambda(tokens).is_some() {
            return Ok(false);
        }
        let start = self.words.assigned_at(tokens).map_or(0, |at| at + 1);
        let (left, value) = tokens.split_at(start);
        // `a, b = [2*v for v in (1, 2)]`.
        let names: Vec<Token> = left.iter().copied().filter(|name| name.kind.is_name()).collect();
        if names.len() > 1
            && self.words.has(value, "for")
            && let Some(values) = self.generated_values(value, frame)?
            && values.len() == names.len()
        {
            for (name, value) in names.into_iter().zip(values) {
                self.set(self.words.name(name), 1, vec![value], frame)?;
            }
            return Ok(true);
        }
        let expanded = self.with_calls(value.to_vec(), frame)?;
        if expanded.len() == value.len()
            && expanded.iter().zip(value).all(|(a, b)| a.span == b.span && a.kind == b.kind)
        {
            return Ok(self.run_counter_assignment(tokens, frame));
        }
        let mut all = left.to_vec();
        all.extend(expanded);
        if !self.step(&all, frame)? {
            self.plain(all, frame, true)?;
        }
        Ok(true)
    }

    /// Defines an anonymous function inside of another function. Returns false if it uses variables
    /// of the other function, or its name is taken.
    fn local_lambda(
        &mut self,
        name: Token,
        parameters: Vec<Vec<Token>>,
        value: Vec<Token>,
        frame: &Frame,
    ) -> Fallible<bool> {
        let is_own = |word: &str| parameters.iter().any(|part| self.words.word(part[0]) == word);
        let is_local = |token: &Token| {
            let word = self.words.word(*token);
            !word.is_empty()
                && !is_own(word)
                && (frame.before(word).is_some() || frame.size(word).is_some())
        };
        if value.iter().any(is_local) || self.arity(name).is_some() {
            return Ok(false);
        }
        self.lambda(Some(name), parameters, value, &Frame::default()).map(|()| true)
    }

    /// Runs an assignment of Python. Returns false for any other statement.
    pub(crate) fn run_python(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        let tokens = Words::without_type(tokens.to_vec());
        if let Some((Some(name), parameters, value)) = self.words.lambda(&tokens) {
            return self.local_lambda(name, parameters, value, frame);
        }
        let mut depth = 0_usize;
        let signs: Vec<usize> = (0..tokens.len())
            .filter(|at| {
                let token = tokens[*at];
                depth += usize::from(token.kind.closer().is_some());
                depth -= usize::from(token.kind.is_closer() && depth > 0);
                depth == 0 && self.words.assigns(&tokens, *at)
            })
            .collect();
        let (Some(first), Some(last)) = (signs.first().copied(), signs.last().copied()) else {
            return Ok(false);
        };
        let value = &tokens[last + 1..];
        if value.is_empty() {
            return Err(Error::new(tokens[last].span, ErrorKind::Unfinished));
        }
        self.reads.clear();
        let before = tokens[..first].last().copied();
        let operator = before.filter(|sign| {
            sign.span.end == tokens[first].span.start
                && !sign.kind.is_name()
                && !sign.kind.is_closer()
        });
        if let Some(mut operator) = operator {
            let mut end = first - 1;
            if operator.kind == Slash && end > 0 && tokens[end - 1].kind == Slash {
                end -= 1;
                operator.span = tokens[end].span.to(operator.span);
            }
            let target = Target::of(&tokens[..end])?;
            let value = self.terms(value, frame)?;
            let is_whole = frame.integers.contains(self.words.word(target.name));
            let before = PureValue { tokens: target.tokens(), is_whole };
            let value = self.joined(before, operator, &value, frame)?;
            return self.store(&target, value, frame).map(|()| true);
        }
        // All targets get the value, from left to right.
        let mut begin = 0;
        let mut targets = Vec::new();
        for sign in &signs {
            targets.push(&tokens[begin..*sign]);
            begin = sign + 1;
        }
        let kinds = self.python_values(value, &targets, frame)?;
        for target in targets {
            let target = Words::inside(target).unwrap_or(target);
            let parts = split(target, Comma);
            for (index, part) in parts.iter().enumerate() {
                let target = Target::of(part)?;
                let kind = match kinds.as_slice() {
                    kinds if kinds.len() == parts.len() => kinds[index].clone(),
                    [(vector, _)] if parts.len() <= LETTERS.len() => {
                        let letter = LETTERS.chars().nth(index).unwrap_or('x').to_string();
                        let span = target.name.span;
                        let vector = Expr::new(vector.clone(), span);
                        (ExprKind::Component(Box::new(vector), letter), false)
                    }
                    _ => return Err(Error::new(target.name.span, ErrorKind::Target)),
                };
                let (kind, is_whole) = kind;
                let token = self.saved(kind, target.name.span, is_whole, frame);
                self.store(&target, PureValue { tokens: vec![token], is_whole }, frame)?;
            }
        }
        Ok(true)
    }

    /// The values on the right of an assignment. There are several if commas separate them and a
    /// target has commas, too.
    fn python_values(
        &mut self,
        value: &[Token],
        targets: &[&[Token]],
        frame: &mut Frame,
    ) -> Fallible<Vec<(ExprKind, bool)>> {
        let count = |tokens: &[Token]| split(Words::inside(tokens).unwrap_or(tokens), Comma).len();
        let is_tuple = targets.iter().any(|target| count(target) > 1);
        let inner = Words::inside(value).filter(|_| is_tuple && value[0].kind == OpenParen);
        let parts = split(inner.unwrap_or(value), Comma);
        let parts = if is_tuple && parts.len() > 1 { parts } else { vec![value.to_vec()] };
        let mut kinds = Vec::new();
        for part in parts {
            let value = self.assignment(&part, frame)?;
            let kind = if self.is_condition(&value.tokens, frame) {
                self.flag(value.tokens, frame)?
            } else {
                self.kind_of(value.tokens, frame)?
            };
            kinds.push((kind, value.is_whole));
        }
        self.reads.clear();
        Ok(kinds)
    }

    /// The values of `body` in each iteration over `list` for which the filter holds.
    pub(crate) fn each_value(
        &mut self,
        pattern: &[Token],
        list: &[Token],
        filter: Option<&[Token]>,
        body: &[Token],
        frame: &mut Frame,
    ) -> Fallible<Vec<Token>> {
        let span = span_of(pattern).unwrap_or_default();
        let names = pattern.iter().filter(|token| token.kind.is_name());
        let before: Vec<(String, Option<ExprKind>, bool)> =
            names.map(|name| self.meaning_before(*name, frame)).collect();
        let mut values = Vec::new();
        for round in self.rounds(pattern, list, frame)? {
            self.count_step(span)?;
            for (name, element) in round {
                let value = self.assignment(&element.value(), frame)?;
                let kind = self.kind_of(value.tokens, frame)?;
                frame.aliases.push(self.words.word(name).to_owned(), kind);
            }
            if let Some(filter) = filter {
                let filter = self.assignment(filter, frame)?.tokens;
                match self.known_value(&filter, frame) {
                    Some(0.0) => continue,
                    Some(_) => {}
                    None => return Err(Error::new(span, ErrorKind::LoopEnd)),
                }
            }
            let value = self.assignment(body, frame)?;
            let kind = self.kind_of(value.tokens, frame)?;
            values.push(self.saved(kind, span, value.is_whole, frame));
        }
        for (name, before, was_integer) in before {
            if was_integer {
                frame.integers.insert(name.clone());
            }
            if let Some(before) = before {
                frame.aliases.push(name, before);
            }
        }
        Ok(values)
    }

    /// A loop variable, its meaning before the loop, and whether it was an integer.
    fn meaning_before(&self, name: Token, frame: &Frame) -> (String, Option<ExprKind>, bool) {
        let name = self.words.word(name).to_owned();
        let is_global = self.defined_names.contains(&name) || self.constants.contains_key(&name);
        let before = frame.before(&name).or_else(|| is_global.then(|| frame.meaning(&name)));
        let was_integer = frame.integers.contains(&name);
        (name, before, was_integer)
    }

    /// The values of `for (i = [0:3]) if (c) a` in `OpenSCAD`. `None` if `tokens` have another
    /// form.
    pub(crate) fn openscad_values(
        &mut self,
        tokens: &[Token],
        frame: &mut Frame,
    ) -> Fallible<Option<Vec<Token>>> {
        let [first, rest @ ..] = tokens else { return Ok(None) };
        let Some((header, body)) = bracketed(rest).filter(|_| self.words.word(*first) == "for")
        else {
            return Ok(None);
        };
        let [index, equals, list @ ..] = header else { return Ok(None) };
        if equals.kind != Equals || split(header, Comma).len() > 1 {
            return Err(Error::new(first.span, ErrorKind::LoopEnd));
        }
        let mut filter = None;
        let mut body = body;
        if let Some(word) = body.first().filter(|word| self.words.word(**word) == "if") {
            let Some((condition, more)) = bracketed(&body[1..]) else {
                return Err(self.words.unsupported(*word));
            };
            filter = Some(condition);
            body = more;
        }
        if let Some(word) =
            body.first().filter(|word| matches!(self.words.word(**word), "for" | "if" | "each"))
        {
            return Err(self.words.unsupported(*word));
        }
        self.each_value(&[*index], list, filter, body, frame).map(Some)
    }

    /// Writes the value of `let(a = 1, b = 2) body`.
    pub(crate) fn let_value(
        &mut self,
        word: Token,
        bindings: &[Token],
        body: &[Token],
        out: &mut Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<bool> {
        if body.is_empty() {
            return Err(Error::new(word.span, ErrorKind::Unfinished));
        }
        let mut before = Vec::new();
        for binding in split(bindings, Comma) {
            let [name, equals, value @ ..] = binding.as_slice() else {
                return Err(Error::new(word.span, ErrorKind::Target));
            };
            if equals.kind != Equals || value.is_empty() || !name.kind.is_name() {
                return Err(Error::new(name.span, ErrorKind::Target));
            }
            let value = self.assignment(value, frame)?.tokens;
            let kind = if self.is_condition(&value, frame) {
                self.flag(value, frame)?
            } else {
                self.kind_of(value, frame)?
            };
            let text = self.words.name(*name).text;
            // OpenSCAD ignores a second binding of a name.
            if before.iter().any(|(bound, _)| *bound == text) {
                continue;
            }
            before.push((text.clone(), frame.meaning(&text)));
            frame.aliases.push(text, kind);
        }
        let value = self.assignment(body, frame)?;
        let span = word.span;
        let kind = if self.is_condition(&value.tokens, frame) {
            self.flag(value.tokens, frame)?
        } else {
            self.kind_of(value.tokens, frame)?
        };
        out.push(self.saved(kind, span, false, frame));
        for (name, kind) in before.into_iter().rev() {
            frame.aliases.push(name, kind);
        }
        Ok(false)
    }
}
