//! Reads sums, products and calls in programs' expressions, from left to right. Truncates quotients
//! of integers, and runs side effects of operands.

use crate::effects::{PureValue, Target, is_doubled};
use crate::language::Language;
use crate::program_reader::{Frame, ProgramReader};
use zeroset_ops::Op;
use zeroset_parser::lex::token::{Token, bracketed, closing, in_brackets, outside};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::tree::ast::{Expr, ExprKind, LETTERS};
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

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
    /// Place at which the current product begins.
    product: usize,
    product_is_whole: bool,
    is_whole: bool,
    /// The operator before the next operand, and its place.
    joint: Option<(Multiplicative, usize)>,
}

impl ProgramReader<'_> {
    /// Reads an expression without assignments, commas and choices outside brackets.
    pub(crate) fn terms(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<PureValue> {
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
        Ok(PureValue { tokens: terms.out, is_whole })
    }

    /// Joins the operand that was read to the product before it.
    fn join(&mut self, terms: &mut Terms, is_whole: bool, frame: &mut Frame) -> Fallible<()> {
        let Some((joint, place)) = terms.joint.take() else {
            terms.product_is_whole = is_whole;
            return Ok(());
        };
        let both = terms.product_is_whole && is_whole;
        let length = if joint == Multiplicative::FloorQuotient { 2 } else { 1 };
        let sides = (terms.out.get(terms.product..place), terms.out.get(place + length..));
        // A sign without an operand before it is left for the grammar to refuse.
        let (Some(left), Some(right)) = sides else { return Ok(()) };
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
        left: PureValue,
        operator: Token,
        right: &PureValue,
        frame: &mut Frame,
    ) -> Fallible<PureValue> {
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
        let tokens = if let Some(token) = token {
            vec![token]
        } else {
            let mut all = left.tokens;
            all.push(operator);
            all.extend(in_brackets(&right.tokens));
            all
        };
        Ok(PureValue { tokens, is_whole: both && typed != "/" && typed != "**" })
    }

    /// Returns whether `++` or `--` before a variable stands at `at`.
    fn steps_before(&self, tokens: &[Token], at: usize) -> bool {
        self.language.has_assignments()
            && is_doubled(tokens, at)
            && tokens.get(at + 2).is_some_and(|next| next.kind.is_name())
    }

    /// Reads an operand with its postfix operators, and appends its tokens to `out`. Returns
    /// whether it is an integer.
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
            _ if token.kind.is_name() => self.variable_or_call(tokens, at, out, frame)?,
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
                        && let Some(letter) = self.indexed_letter(&tokens[*at..], frame) =>
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

    /// The letter of the component whose index is in the brackets at the start of `tokens`: `y` for
    /// `[1]`. `None` if the index is not known, or there is no such component.
    fn indexed_letter(&self, tokens: &[Token], frame: &Frame) -> Option<char> {
        let (inner, _) = bracketed(tokens)?;
        let index = self.known_value(inner, frame).filter(|index| index.fract() == 0.0)?;
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
    pub(crate) fn list(
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

    /// Reads a variable or a call at `tokens[*at]`. Appends the tokens of its value to `out`, and
    /// moves `at` behind it. Returns whether the value is an integer.
    fn variable_or_call(
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
