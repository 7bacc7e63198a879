//! Reads sums, products and calls in programs' expressions, from left to right. Truncates quotients
//! of integers, and runs what operands change.

use crate::dialect::effects::{Settled, Target, is_doubled};
use crate::dialect::language::Language;
use crate::dialect::program_reader::{Frame, Procedure, ProgramReader};
use crate::lex::token::{Token, bracketed, closing, in_brackets, outside, split};
use crate::lex::token_kind::TokenKind::{self, *};
use crate::messages::error::{Error, ErrorKind, Fallible, plural};
use crate::span::Span;
use crate::tree::ast::{Expr, ExprKind, LETTERS};
use std::rc::Rc;
use zeroset_ops::Op;

/// An operator that multiplies or divides.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Multiplicative {
    Times,
    Over,
    /// Python's `//`.
    FloorQuotient,
    Remainder,
}

/// The tokens of a sum, as far as they were read.
struct Terms {
    out: Vec<Token>,
    /// Where the current product begins.
    product: usize,
    product_is_whole: bool,
    is_whole: bool,
    /// The operator before the next operand, and its place.
    joint: Option<(Multiplicative, usize)>,
}

impl ProgramReader<'_> {
    /// Reads an expression without assignments, commas and choices outside brackets.
    pub(crate) fn terms(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<Settled> {
        let mut terms = Terms {
            out: Vec::with_capacity(tokens.len()),
            product: 0,
            product_is_whole: true,
            is_whole: true,
            joint: None,
        };
        let mut at = 0;
        while at < tokens.len() {
            while tokens.get(at).is_some_and(|sign| matches!(sign.kind, Plus | Minus | Not))
                && !self.steps_before(tokens, at)
            {
                terms.out.push(tokens[at]);
                if tokens[at].kind == Not {
                    terms.product = terms.out.len();
                }
                at += 1;
            }
            if at == tokens.len() {
                break;
            }
            let is_whole = self.primary(tokens, &mut at, &mut terms.out, frame)?;
            self.join(&mut terms, is_whole, frame)?;
            self.operator(tokens, &mut at, &mut terms);
        }
        let is_whole = terms.is_whole && terms.product_is_whole;
        Ok(Settled { tokens: terms.out, is_whole })
    }

    /// Joins the operand that was read to the product before it.
    fn join(&mut self, terms: &mut Terms, is_whole: bool, frame: &mut Frame) -> Fallible<()> {
        let Some((joint, place)) = terms.joint.take() else {
            terms.product_is_whole = is_whole;
            return Ok(());
        };
        let both = terms.product_is_whole && is_whole;
        let length = if joint == Multiplicative::FloorQuotient { 2 } else { 1 };
        let (left, right) = (&terms.out[terms.product..place], &terms.out[place + length..]);
        let rounded = match (joint, self.language) {
            (Multiplicative::FloorQuotient, _) => {
                Some(self.quotient(Op::Floor, left, right, both, frame)?)
            }
            (Multiplicative::Remainder, Language::Python) => {
                Some(self.remainder(Op::Floor, left, right, both, frame)?)
            }
            (Multiplicative::Remainder, _) => {
                Some(self.remainder(Op::Trunc, left, right, both, frame)?)
            }
            (Multiplicative::Times, Language::OpenScad) if is_list(left) && is_list(right) => {
                Some(self.dot(left, right, frame)?)
            }
            (Multiplicative::Over, Language::Typed) if both => {
                Some(self.quotient(Op::Trunc, left, right, true, frame)?)
            }
            _ => None,
        };
        if let Some(token) = rounded {
            terms.out.truncate(terms.product);
            terms.out.push(token);
        }
        terms.product_is_whole = both && (rounded.is_some() || joint == Multiplicative::Times);
        Ok(())
    }

    /// Reads the operator after an operand.
    fn operator(&self, tokens: &[Token], at: &mut usize, terms: &mut Terms) {
        let Some(token) = tokens.get(*at).copied() else { return };
        let place = terms.out.len();
        let is_double = tokens.get(*at + 1).is_some_and(|next| {
            next.kind == Slash && token.kind == Slash && token.span.end == next.span.start
        });
        let joint = match token.kind {
            Star => Some(Multiplicative::Times),
            Slash if is_double && self.language == Language::Python => {
                terms.out.push(token);
                *at += 1;
                Some(Multiplicative::FloorQuotient)
            }
            Slash => Some(Multiplicative::Over),
            TokenKind::Remainder | Percent => Some(Multiplicative::Remainder),
            _ => None,
        };
        if joint.is_none() && !ends_product(token, self) {
            // Factors side by side, which are no integers.
            terms.product_is_whole = false;
            terms.is_whole = false;
            return;
        }
        terms.out.push(tokens[*at]);
        *at += 1;
        if let Some(joint) = joint {
            terms.joint = Some((joint, place));
            return;
        }
        terms.is_whole &= terms.product_is_whole && matches!(token.kind, Plus | Minus);
        terms.product = terms.out.len();
        terms.product_is_whole = true;
    }

    /// Joins two values by the operator of an assignment, such as the `+` of `+=`.
    pub(crate) fn joined(
        &mut self,
        left: Settled,
        operator: Token,
        right: Settled,
        frame: &mut Frame,
    ) -> Fallible<Settled> {
        let both = left.is_whole && right.is_whole;
        let typed = &self.words.text[operator.span.range()];
        let token = match typed {
            "%" | "//" => {
                let op = if self.language == Language::Python { Op::Floor } else { Op::Trunc };
                Some(if typed == "%" {
                    self.remainder(op, &left.tokens, &right.tokens, both, frame)?
                } else {
                    self.quotient(op, &left.tokens, &right.tokens, both, frame)?
                })
            }
            "/" if both && self.language == Language::Typed => {
                Some(self.quotient(Op::Trunc, &left.tokens, &right.tokens, true, frame)?)
            }
            "+" | "-" | "*" | "/" | "**" | "−" | "×" => None,
            _ => return Err(Error::new(operator.span, ErrorKind::Bits)),
        };
        let tokens = match token {
            Some(token) => vec![token],
            None => {
                let mut all = left.tokens;
                all.push(operator);
                all.extend(in_brackets(&right.tokens));
                all
            }
        };
        Ok(Settled { tokens, is_whole: both && typed != "/" && typed != "**" })
    }

    /// Returns whether `++` or `--` before a variable stands at `at`.
    fn steps_before(&self, tokens: &[Token], at: usize) -> bool {
        self.language.has_assignments()
            && is_doubled(tokens, at)
            && tokens.get(at + 2).is_some_and(|next| next.kind.is_name())
    }

    /// Reads an operand with everything that binds to it. Returns whether it is an integer.
    fn primary(
        &mut self,
        tokens: &[Token],
        at: &mut usize,
        out: &mut Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let token = tokens[*at];
        let start = out.len();
        if self.steps_before(tokens, *at)
            && let Some((target, length)) = Target::at_start(&tokens[*at + 2..])
        {
            *at += 2 + length;
            let value = self.step_by_one(&target, token, true, frame)?;
            out.extend(value.tokens);
            return Ok(value.is_whole);
        }
        let mut is_whole = match token.kind {
            Number => {
                let typed = &self.words.text[token.span.range()];
                out.push(token);
                *at += 1;
                typed.bytes().all(|byte| byte.is_ascii_digit())
            }
            Saved => {
                out.push(token);
                *at += 1;
                self.whole_values.contains(&token.number)
            }
            _ if token.kind.closer().is_some() => self.group(tokens, at, out, frame)?,
            _ if token.kind.is_name() => self.named(tokens, at, out, frame)?,
            _ => {
                out.push(token);
                *at += 1;
                return Ok(false);
            }
        };
        while let Some(next) = tokens.get(*at).copied() {
            match next.kind {
                OpenBracket
                    if matches!(self.language, Language::Python | Language::OpenScad)
                        && let Some(letter) = self.index(&tokens[*at..], frame) =>
                {
                    let value: Vec<Token> = out.drain(start..).collect();
                    let place = token.span;
                    let value = Expr::new(self.kind_of(value, frame)?, place);
                    let kind = ExprKind::Component(Box::new(value), letter.to_string());
                    out.push(self.saved(kind, place, false, frame));
                    *at += closing(&tokens[*at..]).map_or(0, |end| end + 1);
                    is_whole = false;
                    continue;
                }
                OpenBracket | OpenParen if next.span.start == tokens[*at - 1].span.end => {
                    self.group(tokens, at, out, frame)?;
                    is_whole = false;
                    continue;
                }
                Component | Superscript | Factorial | Method => is_whole &= next.kind == Component,
                Caret => {
                    if is_whole && self.language == Language::Typed {
                        return Err(Error::new(next.span, ErrorKind::Bits));
                    }
                    out.push(next);
                    *at += 1;
                    while tokens.get(*at).is_some_and(|sign| matches!(sign.kind, Plus | Minus)) {
                        out.push(tokens[*at]);
                        *at += 1;
                    }
                    if *at < tokens.len() {
                        self.deeper(&[next], |reader| reader.primary(tokens, at, out, frame))?;
                    }
                    return Ok(false);
                }
                _ => break,
            }
            out.push(next);
            *at += 1;
        }
        Ok(is_whole)
    }

    /// The letter of the component with the known index at the start of `tokens`, as in `[1]`.
    fn index(&self, tokens: &[Token], frame: &Frame) -> Option<char> {
        let (inner, _) = bracketed(tokens)?;
        let index = self.known(inner, frame).filter(|index| index.fract() == 0.0)?;
        LETTERS.chars().enumerate().find(|(at, _)| *at as f64 == index).map(|(_, letter)| letter)
    }

    /// Reads brackets that are no arguments of a call.
    fn group(
        &mut self,
        tokens: &[Token],
        at: &mut usize,
        out: &mut Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let open = tokens[*at];
        let Some(end) = closing(&tokens[*at..]).map(|end| *at + end) else {
            out.push(open);
            *at += 1;
            return Ok(false);
        };
        let inner = &tokens[*at + 1..end];
        *at = end + 1;
        if open.kind == OpenBracket
            && self.language == Language::OpenScad
            && let Some(values) =
                self.generated_values(&tokens[*at - inner.len() - 2..=end], frame)?
        {
            out.push(open);
            for (index, value) in values.iter().enumerate() {
                if index > 0 {
                    out.push(Token::new(Comma, Span::at(open.span.end)));
                }
                out.push(*value);
            }
            out.push(tokens[end]);
            return Ok(false);
        }
        out.push(open);
        // A comma in a typed language joins expressions. Elsewhere brackets may hold a vector.
        let is_sequence =
            open.kind == OpenParen && (self.language == Language::Typed || self.has_effect(inner));
        let is_whole = if is_sequence {
            let value = self.sequence(inner, frame)?;
            out.extend(value.tokens);
            value.is_whole
        } else {
            self.list(inner, out, frame)?
        };
        out.push(tokens[end]);
        Ok(is_whole && open.kind == OpenParen)
    }

    /// Reads values between commas. Returns whether all are integers.
    fn list(
        &mut self,
        tokens: &[Token],
        out: &mut Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let mut is_whole = true;
        let mut rest = tokens;
        loop {
            let comma = outside(rest, Comma).unwrap_or(rest.len());
            let value = self.assignment(&rest[..comma], frame)?;
            is_whole &= value.is_whole;
            out.extend(value.tokens);
            let Some(sign) = rest.get(comma) else { return Ok(is_whole) };
            out.push(*sign);
            rest = &rest[comma + 1..];
        }
    }

    /// Reads a variable or a call.
    fn named(
        &mut self,
        tokens: &[Token],
        at: &mut usize,
        out: &mut Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<bool> {
        let token = tokens[*at];
        let word = self.words.word(token);
        if word == "let"
            && self.language == Language::OpenScad
            && let Some((bindings, _)) = bracketed(&tokens[*at + 1..])
        {
            let bindings = bindings.to_vec();
            let body = *at + bindings.len() + 3;
            *at = tokens.len();
            return self.let_value(token, &bindings, &tokens[body..], out, frame);
        }
        if tokens.get(*at + 1).is_some_and(|next| next.kind == OpenParen)
            && let Some(end) = closing(&tokens[*at + 1..]).map(|end| *at + 1 + end)
        {
            let call = &tokens[*at..=end];
            *at = end + 1;
            return self.call(call, out, frame);
        }
        if let Some((target, length)) = Target::at_start(&tokens[*at..])
            && self.language.has_assignments()
            && is_doubled(tokens, *at + length)
            && !tokens.get(*at + length + 2).is_some_and(|next| next.kind.begins_operand())
        {
            let sign = tokens[*at + length];
            *at += length + 2;
            let value = self.step_by_one(&target, sign, false, frame)?;
            out.extend(value.tokens);
            return Ok(value.is_whole);
        }
        self.reads.push(word.to_owned());
        out.push(token);
        *at += 1;
        Ok(frame.integers.contains(word))
    }

    /// Reads `f(a, b)`, all of `call`.
    fn call(&mut self, call: &[Token], out: &mut Vec<Token>, frame: &mut Frame) -> Fallible<bool> {
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
            && matches!(word, "sum" | "min" | "max")
            && let Some(values) = self.generated_values(inner, frame)?
        {
            self.combine(name, &values, out, frame)?;
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
        out.extend([name, call[1]]);
        out.extend(arguments);
        out.push(call[call.len() - 1]);
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
    fn with_defaults(
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
            let (index, value) = match keyword {
                Some(keyword) => {
                    let word = self.words.word(keyword);
                    let index = parameters.iter().position(|given| given.name.text == word);
                    (index.ok_or_else(wrong)?, argument[2..].to_vec())
                }
                None => {
                    next += 1;
                    (next - 1, argument.clone())
                }
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

    /// Writes the sum, the least or the greatest of `values`.
    pub(crate) fn combine(
        &mut self,
        name: Token,
        values: &[Token],
        out: &mut Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<()> {
        let is_sum = self.words.word(name) == "sum";
        let place = Span::at(name.span.end);
        if values.is_empty() {
            if !is_sum {
                return Err(Error::new(name.span, ErrorKind::EmptyBrackets));
            }
            let zero = ExprKind::Number("0".to_owned());
            out.push(self.saved(zero, name.span, false, frame));
            return Ok(());
        }
        if let [only] = values {
            out.push(*only);
            return Ok(());
        }
        if !is_sum {
            out.push(name);
        }
        out.push(Token::new(OpenParen, place));
        for (index, value) in values.iter().enumerate() {
            if index > 0 {
                out.push(Token::new(if is_sum { Plus } else { Comma }, place));
            }
            out.push(*value);
        }
        out.push(Token::new(CloseParen, place));
        Ok(())
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
        let [index, within, ..] = rest else { return Ok(None) };
        if within.kind != In || !index.kind.is_name() {
            return Ok(None);
        }
        let rest = &rest[2..];
        let if_at = outside_word(self, rest, "if");
        let (list, filter) = match if_at {
            Some(at) => (&rest[..at], Some(&rest[at + 1..])),
            None => (rest, None),
        };
        if filter.is_some_and(|filter| outside_word(self, filter, "for").is_some()) {
            return Ok(None);
        }
        let filter = filter.map(<[Token]>::to_vec);
        self.each_value(*index, list, filter, body, frame).map(Some)
    }
}

/// Returns whether `tokens` are a list in square brackets.
fn is_list(tokens: &[Token]) -> bool {
    tokens.first().is_some_and(|first| first.kind == OpenBracket)
        && closing(tokens).is_some_and(|end| end + 1 == tokens.len())
}

/// Returns whether a token after an operand ends its product.
fn ends_product(token: Token, reader: &ProgramReader<'_>) -> bool {
    matches!(token.kind, Plus | Minus | And | Or | Not | Comma | Colon | QuestionMark | In)
        || token.kind.is_relation()
        || matches!(reader.words.word(token), "if" | "else" | "for" | "lambda")
}

/// Index of the first `word` outside brackets.
pub(crate) fn outside_word(
    reader: &ProgramReader<'_>,
    tokens: &[Token],
    word: &str,
) -> Option<usize> {
    let mut depth = 0_usize;
    tokens.iter().position(|token| {
        depth += usize::from(token.kind.closer().is_some());
        depth -= usize::from(token.kind.is_closer() && depth > 0);
        depth == 0 && reader.words.word(*token) == word
    })
}
