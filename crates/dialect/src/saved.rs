//! Values that a program computes once and uses later. A token of the kind `Saved` stands for each.

use crate::control_flow::more_than;
use crate::known_numbers::{number_expr, number_of};
use crate::language::Language;
use crate::program_reader::{Frame, ProgramReader};
use crate::terms::outside_word;
use zeroset_ops::{Op, VectorFunction};
use zeroset_parser::lex::token::{Token, closing, is_outside, outside, span_of};
use zeroset_parser::lex::token_kind::TokenKind::{
    And, Colon, Not, OpenParen, Or, QuestionMark, Saved,
};
use zeroset_parser::tree::aliases::saved_name;
use zeroset_parser::tree::ast::{Expr, ExprKind, Function, Relation};
use zeroset_parser::tree::builder::quotient_of;
use zeroset_parser::tree::foreign_functions::remainder;
use zeroset_parser::tree::raw_statement::ValueConversion;
use zeroset_parser::{Fallible, Span};

impl ProgramReader<'_> {
    /// A new token for a saved value, and the name of its alias.
    pub(crate) fn new_saved(&mut self, span: Span) -> (String, Token) {
        self.saved_count += 1;
        let number = self.saved_count;
        (saved_name(number), Token { number, ..Token::new(Saved, span) })
    }

    /// Saves `kind`. `is_whole` is true if it is an integer.
    pub(crate) fn saved(
        &mut self,
        kind: ExprKind,
        span: Span,
        is_whole: bool,
        frame: &mut Frame,
    ) -> Token {
        let (name, token) = self.new_saved(span);
        if is_whole {
            self.whole_values.insert(token.number);
        }
        frame.aliases.push(name, kind);
        token
    }

    /// An expression for the value of `tokens`: a number, or a call of a new definition.
    pub(crate) fn kind_of(&mut self, tokens: Vec<Token>, frame: &mut Frame) -> Fallible<ExprKind> {
        let span = span_of(&tokens).unwrap_or_default();
        if let Some(number) = self.known_value(&tokens, frame) {
            return Ok(number_expr(number, span));
        }
        if let [only] = tokens.as_slice()
            && only.kind == Saved
            && let Some(kind) = frame.aliases.find(&saved_name(only.number))
        {
            return Ok(kind.clone());
        }
        let (head, kind) = self.synthesized_head("value", span, frame);
        self.push(tokens, Some(head), None, &frame.aliases.clone(), false)?;
        Ok(kind)
    }

    /// 1 where the condition `tokens` holds, else 0.
    pub(crate) fn indicator(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
    ) -> Fallible<ExprKind> {
        let span = span_of(&tokens).unwrap_or_default();
        if let Some(number) = self.known_value(&tokens, frame) {
            return Ok(number_expr(f64::from(u8::from(number != 0.0)), span));
        }
        let (head, kind) = self.synthesized_head("if", span, frame);
        let conversion = Some(ValueConversion::Indicator);
        self.push(tokens, Some(head), conversion, &frame.aliases.clone(), false)?;
        Ok(kind)
    }

    /// A condition that holds where the condition `tokens` does.
    pub(crate) fn flag(&mut self, tokens: Vec<Token>, frame: &mut Frame) -> Fallible<ExprKind> {
        Ok(more_than(self.indicator(tokens, frame)?, 0.0).kind)
    }

    /// A saved value for the integer part of `tokens`.
    pub(crate) fn truncated(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<Token> {
        let span = span_of(tokens).unwrap_or_default();
        let value = self.kind_of(tokens.to_vec(), frame)?;
        let kind = match self.known_value(tokens, frame) {
            Some(number) => number_expr(number.trunc(), span),
            None => of_op(Op::Trunc, Expr::new(value, span)),
        };
        let kind = self.defined(kind, frame);
        Ok(self.saved(kind, span, true, frame))
    }

    /// Dividend and divisor, if both are known numbers and the divisor is not 0.
    fn known_quotient(&self, left: &[Token], right: &[Token], frame: &Frame) -> Option<[f64; 2]> {
        let known = [self.known_value(left, frame)?, self.known_value(right, frame)?];
        (known[1] != 0.0).then_some(known)
    }

    /// A saved value for the quotient of `left` by `right`, rounded by `op`.
    pub(crate) fn quotient(
        &mut self,
        op: Op,
        left: &[Token],
        right: &[Token],
        is_whole: bool,
        frame: &mut Frame,
    ) -> Fallible<Token> {
        let span = span_of_both(left, right);
        if let Some([a, b]) = self.known_quotient(left, right, frame) {
            let quotient = if op == Op::Trunc { (a / b).trunc() } else { (a / b).floor() };
            return Ok(self.saved(number_expr(quotient, span), span, is_whole, frame));
        }
        let [left, right] = self.both(left, right, span, frame)?;
        let kind = of_op(op, quotient_of([left, right])?);
        let kind = self.defined(kind, frame);
        Ok(self.saved(kind, span, is_whole, frame))
    }

    /// A saved value for the remainder of `left` by `right`. The quotient is rounded by `op`.
    pub(crate) fn remainder(
        &mut self,
        op: Op,
        left: &[Token],
        right: &[Token],
        is_whole: bool,
        frame: &mut Frame,
    ) -> Fallible<Token> {
        let span = span_of_both(left, right);
        if let Some([a, b]) = self.known_quotient(left, right, frame)
            && [a, b].iter().all(|number| number.fract() == 0.0)
        {
            let rest = if op == Op::Trunc { a % b } else { a - b * (a / b).floor() };
            return Ok(self.saved(number_expr(rest, span), span, is_whole, frame));
        }
        let [left, right] = self.both(left, right, span, frame)?;
        let kind = remainder(op, left, right, span)?.kind;
        let kind = self.defined(kind, frame);
        Ok(self.saved(kind, span, is_whole, frame))
    }

    /// A saved value for the scalar product of two lists.
    pub(crate) fn dot(
        &mut self,
        left: &[Token],
        right: &[Token],
        frame: &mut Frame,
    ) -> Fallible<Token> {
        let span = span_of_both(left, right);
        let both = self.both(left, right, span, frame)?;
        let function = Function::OfVectors(VectorFunction::Dot);
        let kind = self.defined(ExprKind::Call(function, both.to_vec()), frame);
        Ok(self.saved(kind, span, false, frame))
    }

    /// Reads the two operands of an operation.
    fn both(
        &mut self,
        left: &[Token],
        right: &[Token],
        span: Span,
        frame: &mut Frame,
    ) -> Fallible<[Expr; 2]> {
        let left = self.kind_of(left.to_vec(), frame)?;
        let right = self.kind_of(right.to_vec(), frame)?;
        Ok([Expr::new(left, span), Expr::new(right, span)])
    }

    /// A reference to a new definition of `kind`. Numbers stay as they are.
    fn defined(&mut self, kind: ExprKind, frame: &Frame) -> ExprKind {
        if number_of(&kind).is_some() {
            return kind;
        }
        self.synthesize("value", kind, frame)
    }

    /// Returns whether `tokens` are a condition: they compare, or join conditions.
    pub(crate) fn is_condition(&self, tokens: &[Token], frame: &Frame) -> bool {
        if let [open, .., _] = tokens
            && open.kind == OpenParen
            && closing(tokens) == Some(tokens.len() - 1)
        {
            return self.is_condition(&tokens[1..tokens.len() - 1], frame);
        }
        if tokens.first().is_some_and(|first| first.kind == Not) {
            return true;
        }
        if self.language == Language::Python
            && let Some(word) = outside_word(self, tokens, "if")
        {
            return self.is_condition(&tokens[..word], frame);
        }
        let has = |sign| tokens.iter().any(is_outside(sign));
        // The value of a choice is a condition if one of its sides is.
        if let Some(mark) = outside(tokens, QuestionMark) {
            let colon = tokens.iter().rposition(|token| token.kind == Colon);
            let end = colon.unwrap_or(tokens.len());
            return mark < end && self.is_condition(&tokens[mark + 1..end], frame);
        }
        if has(And) || has(Or) {
            return true;
        }
        let mut depth = 0_usize;
        tokens.iter().any(|token| {
            depth += usize::from(token.kind.closer().is_some());
            depth -= usize::from(token.kind.is_closer() && depth > 0);
            depth == 0 && token.kind.is_relation()
        }) || matches!(tokens, [only] if self.is_flag(*only, frame))
    }

    fn is_flag(&self, token: Token, frame: &Frame) -> bool {
        let key = match token.kind {
            Saved => saved_name(token.number),
            _ => self.words.word(token).to_owned(),
        };
        matches!(key.as_str(), "true" | "false" | "True" | "False")
            || frame.aliases.find(&key).is_some_and(|kind| flag_of(kind).is_some())
    }
}

fn span_of_both(left: &[Token], right: &[Token]) -> Span {
    span_of(left).unwrap_or_default().to(span_of(right).unwrap_or_default())
}

fn of_op(op: Op, value: Expr) -> ExprKind {
    ExprKind::Call(Function::Native(op), vec![value])
}

/// The number that a flag compares with 0; `None` if `kind` is no flag.
pub(crate) fn flag_of(kind: &ExprKind) -> Option<&ExprKind> {
    let ExprKind::Compare(left, rest) = kind else { return None };
    match rest.as_slice() {
        [(Relation::Greater, right)] if matches!(&right.kind, ExprKind::Number(zero) if zero == "0") => {
            Some(&left.kind)
        }
        _ => None,
    }
}
