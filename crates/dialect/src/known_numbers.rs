//! Evaluates numbers that are known while a program is read, such as the bounds of a loop.

use crate::program_words::Words;
use crate::saved::flag_of;
use rustc_hash::FxHashMap;
use zeroset_parser::Span;
use zeroset_parser::lex::spelling::decimal;
use zeroset_parser::lex::token::Token;
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::tree::aliases::{Aliases, saved_name};
use zeroset_parser::tree::ast::{Expr, ExprKind};

/// The value of `tokens`: a number, or 1 or 0 for a condition. `None` if the value is not known. A
/// name stands for its alias or, without an alias, for its entry in `constants`.
pub(crate) fn count(
    words: Words<'_>,
    tokens: &[Token],
    aliases: &Aliases,
    constants: &FxHashMap<String, f64>,
) -> Option<f64> {
    let mut reader = ConstantEvaluator { words, tokens, at: 0, aliases, constants, depth: 0 };
    let value = reader.joined()?;
    (reader.at == tokens.len() && value.is_finite()).then_some(value)
}

/// Writes a number as an expression.
pub(crate) fn number_expr(value: f64, span: Span) -> ExprKind {
    let number = ExprKind::Number(value.abs().to_string());
    if value < 0.0 { ExprKind::Negate(Box::new(Expr::new(number, span))) } else { number }
}

/// The value of an expression such as [`number_expr`] builds; `None` for other expressions.
pub(crate) fn number_of(kind: &ExprKind) -> Option<f64> {
    match kind {
        ExprKind::Number(text) => text.parse().ok(),
        ExprKind::Negate(inner) => number_of(&inner.kind).map(|value| -value),
        _ => None,
    }
}

/// The numbers from `low` to `high` by `step`; with `high` itself if `is_closed`. `None` if there
/// are more than `limit`.
pub(crate) fn steps(
    low: f64,
    high: f64,
    step: f64,
    is_closed: bool,
    limit: usize,
) -> Option<Vec<f64>> {
    let count = (high - low) / step;
    let count = if is_closed { count.floor() + 1.0 } else { count.ceil() };
    let number = |index| low + index as f64 * step;
    (count <= limit as f64).then(|| (0..count.max(0.0) as usize).map(number).collect())
}

/// Relations that a condition may contain.
const RELATIONS: &[TokenKind] = &[Less, LessEqual, Greater, GreaterEqual, Equals, NotEqual];

struct ConstantEvaluator<'a> {
    words: Words<'a>,
    tokens: &'a [Token],
    at: usize,
    aliases: &'a Aliases,
    constants: &'a FxHashMap<String, f64>,
    depth: usize,
}

impl ConstantEvaluator<'_> {
    /// The known number that `name` stands for.
    fn get(&self, name: &str) -> Option<f64> {
        match self.aliases.find(name) {
            Some(kind) => number_of(flag_of(kind).unwrap_or(kind)),
            None if matches!(name, "true" | "True") => Some(1.0),
            None if matches!(name, "false" | "False") => Some(0.0),
            None => self.constants.get(name).copied(),
        }
    }

    fn kind(&self) -> Option<TokenKind> {
        self.tokens.get(self.at).map(|token| token.kind)
    }

    fn take(&mut self, kinds: &[TokenKind]) -> Option<TokenKind> {
        let kind = self.kind().filter(|kind| kinds.contains(kind))?;
        self.at += 1;
        Some(kind)
    }

    fn typed(&self, token: Token) -> &str {
        &self.words.text[token.span.range()]
    }

    /// Evaluates comparisons that are joined by "and" or "or". The result is 1 for true and 0 for
    /// false. Without such a word, it is the value of the only operand.
    fn joined(&mut self) -> Option<f64> {
        self.depth += 1;
        if self.depth > 50 {
            return None;
        }
        let mut value = self.compared()?;
        while let Some(joint) = self.take(&[And, Or]) {
            let next = self.compared()?;
            let holds = if joint == And {
                value != 0.0 && next != 0.0
            } else {
                value != 0.0 || next != 0.0
            };
            value = f64::from(u8::from(holds));
        }
        self.depth -= 1;
        Some(value)
    }

    /// Evaluates a comparison to 1 or 0, or a sum to its value.
    fn compared(&mut self) -> Option<f64> {
        if self.take(&[Not]).is_some() {
            return Some(f64::from(u8::from(self.compared()? == 0.0)));
        }
        let left = self.sum()?;
        let Some(relation) = self.take(RELATIONS) else { return Some(left) };
        let right = self.sum()?;
        #[allow(clippy::float_cmp)] // programs compare exactly
        let holds = match relation {
            Less => left < right,
            LessEqual => left <= right,
            Greater => left > right,
            GreaterEqual => left >= right,
            Equals => left == right,
            _ => left != right,
        };
        Some(f64::from(u8::from(holds)))
    }

    fn sum(&mut self) -> Option<f64> {
        let mut value = self.product()?;
        while let Some(sign) = self.take(&[Plus, Minus]) {
            let next = self.product()?;
            value = if sign == Plus { value + next } else { value - next };
        }
        Some(value)
    }

    fn product(&mut self) -> Option<f64> {
        let mut value = self.factor()?;
        loop {
            let remainder = self.tokens.get(self.at).is_some_and(|t| self.typed(*t) == "%");
            if remainder {
                self.at += 1;
                let next = self.factor()?;
                value = if next == 0.0 { return None } else { value % next };
                continue;
            }
            let Some(sign) = self.take(&[Star, Slash]) else { return Some(value) };
            let next = self.factor()?;
            let result = if sign == Star { value * next } else { value / next };
            // Some languages truncate quotients of integers, so a fractional quotient is unknown.
            if sign == Slash && value.fract() == 0.0 && next.fract() == 0.0 && result.fract() != 0.0
            {
                return None;
            }
            value = result;
        }
    }

    fn factor(&mut self) -> Option<f64> {
        if self.take(&[Minus]).is_some() {
            return self.factor().map(|value| -value);
        }
        let token = *self.tokens.get(self.at)?;
        self.at += 1;
        if token.kind == Number {
            return decimal(self.typed(token)).parse().ok();
        }
        if token.kind == OpenParen {
            let value = self.joined()?;
            return self.take(&[CloseParen]).map(|_| value);
        }
        if token.kind == Saved {
            return self.get(&saved_name(token.number));
        }
        let name = self.words.word(token);
        if matches!(name, "float" | "int" | "double") && self.take(&[OpenParen]).is_some() {
            let value = self.joined()?;
            let value = if name == "int" { value.trunc() } else { value };
            return self.take(&[CloseParen]).map(|_| value);
        }
        self.get(name)
    }
}
