//! Adds notes on powers and roots that may be meant to cover more factors.

use crate::lex::spelling::short_formula;
use crate::lex::token::Token;
use crate::lex::token_kind::TokenKind::{self, Minus, Plus};
use crate::messages::note::NoteKind;
use crate::span::Span;
use crate::tree::ast::{Expr, ExprKind, NamedValue};
use crate::tree::builder::Builder;
use crate::tree::print::factor_text;
use zeroset_ir::NamedConstant;

impl Builder<'_> {
    /// Returns whether the token before `span` is one of `signs`.
    pub(crate) fn follows(&self, span: Span, signs: &[TokenKind]) -> bool {
        let next = self.lexed.tokens.partition_point(|token| token.span.start < span.start);
        let before = next.checked_sub(1).map(|before| self.lexed.tokens[before]);
        before.is_some_and(|token| signs.contains(&token.kind))
    }

    /// Adds a note on a factor that touches an exponent without being part of it, as in `e^2x`. In
    /// `a^xy` the exponent is x, though `xy` looks like one name. The common `x^2y` gets no note.
    pub(crate) fn note_powers(&mut self, factors: &[Expr]) {
        for (index, pair) in factors.windows(2).enumerate() {
            let ExprKind::Power(base, exponent) = &pair[0].kind else { continue };
            let place = pair[1].span.start;
            let begins = |expr: &Expr, accepted: fn(char) -> bool| {
                self.text[expr.span.range()].starts_with(accepted)
            };
            let touches = pair[0].span.end == place
                && begins(exponent, |c| c.is_alphanumeric() || "-−".contains(c))
                && begins(&pair[1], char::is_alphabetic);
            let cuts = |token: &Token| token.span.start < place && place < token.span.end;
            let is_cut = self.lexed.tokens.iter().any(cuts);
            if !touches || !is_cut && !is_base(base) {
                continue;
            }
            let mut end = index + 1;
            while factors.get(end + 1).is_some_and(|next| next.span.start == factors[end].span.end)
            {
                end += 1;
            }
            let rest: Vec<String> = factors[index + 1..=end].iter().map(factor_text).collect();
            let rest = rest.join("*");
            let (base, top) = (factor_text(base), exponent.to_string());
            let kind = NoteKind::PowerScope {
                read: short_formula(&format!("{}*{rest}", factor_text(&pair[0]))),
                other: short_formula(&format!("{base}^({top}*{rest})")),
            };
            self.note(pair[0].span.to(factors[end].span), kind);
        }
    }

    /// Returns whether a root covers only the first power of a sum, as in `√x²+y²`.
    pub(crate) fn root_goes_on(&self, inner: &Expr) -> bool {
        let next = self.lexed.tokens.partition_point(|token| token.span.start < inner.span.end);
        let is_sign = |token: &Token| matches!(token.kind, Plus | Minus);
        let typed = &self.text[inner.span.range()];
        matches!(inner.kind, ExprKind::Power(..))
            && !(typed.starts_with('(') && typed.ends_with(')'))
            && self.lexed.tokens.get(next).is_some_and(is_sign)
    }
}

/// Returns whether `base` is e or a number. Powers of such a base often have long exponents.
fn is_base(base: &Expr) -> bool {
    let is_e = matches!(base.kind, ExprKind::Name(NamedValue::Constant(NamedConstant::E)));
    is_e || base.number().is_some()
}
