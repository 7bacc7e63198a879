//! Runs: factors side by side without signs, where names decide what is a call and what a product.
//!
//! A run is flattened to a row of items and read from left to right. Only here `f(x)` and `x(y + 1)` differ,
//! `sin 2x cos y` becomes two calls, and `xyz` three factors.

use crate::ast::{Expr, ExprKind, Function, ProductSign, SumSign, Value};
use crate::build::{Builder, number_only, product_of, sign};
use crate::error::{Error, ErrorKind, Fallible};
use crate::grammar::{Pair, Rule};
use crate::note::NoteKind;
use crate::scope::{Callee, Meaning};
use crate::span::Span;
use crate::spelling::{decimal, plain_name, superscript, vulgar};
use std::collections::VecDeque;
use zeroset_ops::Op;

/// A piece of a run.
pub(crate) enum Item<'i> {
    Number(String, Span),
    Value(Value, Span),
    Function(Callee, Span),
    /// Round or square brackets.
    Group(Pair<'i>),
    /// Anything that is one factor whatever surrounds it: braces, bars, `\frac`, `\sqrt{}`.
    Closed(Pair<'i>),
    /// `^`, and the signs of the exponent that follows.
    Caret(Vec<(SumSign, Span)>, Span),
    /// A superscript number, with its sign.
    Superscript(String, Span),
    /// `√` or `∛`.
    Radical(char, Span),
}

/// What is left of a run.
pub(crate) type Items<'i> = VecDeque<Item<'i>>;

impl Builder<'_> {
    /// The factors of a run.
    pub(crate) fn run(&mut self, pair: Pair<'_>) -> Fallible<Vec<Expr>> {
        let mut items = Items::new();
        for power in pair.into_inner() {
            for child in power.into_inner() {
                self.flatten(child, &mut items)?;
            }
        }
        let mut factors = Vec::new();
        while !items.is_empty() {
            self.factor(&mut items, &mut factors)?;
        }
        Ok(factors)
    }

    fn flatten<'i>(&mut self, pair: Pair<'i>, items: &mut Items<'i>) -> Fallible<()> {
        let span = self.span(&pair);
        match pair.as_rule() {
            Rule::exponent => {
                let mut signs = Vec::new();
                let mut caret = None;
                for child in pair.into_inner() {
                    match child.as_rule() {
                        Rule::caret => caret = Some(self.span(&child)),
                        Rule::sign => signs.push((sign(&child), self.span(&child))),
                        _ => {
                            if let Some(span) = caret.take() {
                                items.push_back(Item::Caret(std::mem::take(&mut signs), span));
                            }
                            self.flatten(child, items)?;
                        }
                    }
                }
            }
            Rule::superscript => {
                items.push_back(Item::Superscript(superscript(pair.as_str()), span));
            }
            Rule::radical => {
                let radical = pair.as_str().chars().next().unwrap_or('√');
                items.push_back(Item::Radical(radical, span));
            }
            Rule::number => items.push_back(Item::Number(decimal(pair.as_str()), span)),
            Rule::name => self.name(pair.as_str(), span, items)?,
            Rule::vulgar => {
                // `2½` is five halves to some and one to others.
                if let Some(Item::Number(_, before)) = items.back() {
                    return Err(Error::new(before.to(span), ErrorKind::NumberAfterNumber));
                }
                items.push_back(Item::Closed(pair));
            }
            Rule::group => items.push_back(Item::Group(pair)),
            _ => items.push_back(Item::Closed(pair)),
        }
        Ok(())
    }

    /// The items that a name stands for: usually one.
    fn name(&mut self, typed: &str, span: Span, items: &mut Items<'_>) -> Fallible<()> {
        let name = plain_name(typed);
        match self.scope.meaning(&name, self.locals) {
            Meaning::Value(value) => {
                self.use_value(&value, span);
                items.push_back(Item::Value(value, span));
            }
            Meaning::Function(callee) => {
                if let Callee::Defined(name, _) = &callee {
                    self.used.insert(name.clone());
                }
                items.push_back(Item::Function(callee, span));
            }
            Meaning::Product => {
                let letters: Vec<String> = name.chars().map(String::from).collect();
                let mut at = span.start;
                for letter in &letters {
                    // A LaTeX command or subscript is never split, so every letter is where it was typed.
                    let place = Span::new(at, at + letter.len());
                    at = place.end;
                    if let Meaning::Value(value) = self.scope.meaning(letter, self.locals) {
                        self.use_value(&value, place);
                        items.push_back(Item::Value(value, place));
                    }
                }
                let product = letters.join("*");
                self.note(span, NoteKind::ProductOfNames { name, product });
            }
            Meaning::Unknown => return Err(self.unknown(&name, typed, span)),
        }
        Ok(())
    }

    fn use_value(&mut self, value: &Value, span: Span) {
        match value {
            Value::Defined(name) => {
                self.used.insert(name.clone());
            }
            Value::Constant(constant) => {
                let meaning = match constant.name() {
                    "tau" => "2*pi = 6.2831853…",
                    "phi" => "the golden ratio, (1 + sqrt(5))/2 = 1.6180339…",
                    _ => return,
                };
                let kind = NoteKind::ConstantUsed { name: constant.name(), meaning };
                self.note(span, kind);
            }
            Value::Time => {
                self.used.insert("t".to_owned());
            }
            Value::Coordinate(_) | Value::Local(_) => {}
        }
    }

    /// Reads one factor with its exponents onto the end of `factors`.
    pub(crate) fn factor(
        &mut self,
        items: &mut Items<'_>,
        factors: &mut Vec<Expr>,
    ) -> Fallible<()> {
        if let (Some(Item::Number(_, span)), Some(before)) = (items.front(), factors.last()) {
            let (kind, sign) = match before.kind {
                ExprKind::Number(_) => (ErrorKind::NumberAfterNumber, "*"),
                // It has its exponent already.
                ExprKind::Power(..) => (ErrorKind::NumberAfterFactor, "*"),
                _ => (ErrorKind::NumberAfterFactor, "^"),
            };
            let place = before.span.to(*span);
            let between = Span::new(before.span.end, span.start);
            return Err(Error::new(place, kind).suggest(between, sign));
        }
        match items.front() {
            // Braces after a factor look like a restriction; read as a product they would hide a mistake.
            Some(Item::Closed(pair)) if pair.as_rule() == Rule::braces && !factors.is_empty() => {
                let span = self.span(pair);
                return Err(Error::new(span, ErrorKind::RestrictionNotCondition));
            }
            _ => {}
        }
        let factor = self.power(items)?;
        factors.push(factor);
        Ok(())
    }

    /// A factor with its exponents. `x^y^z` is `x^(y^z)`, and a sign in an exponent covers what is above it.
    pub(crate) fn power(&mut self, items: &mut Items<'_>) -> Fallible<Expr> {
        let base = self.primary(items)?;
        self.exponents(base, items)
    }

    pub(crate) fn exponents(&mut self, base: Expr, items: &mut Items<'_>) -> Fallible<Expr> {
        let depth = self.depth;
        let mut chain: Vec<(Vec<(SumSign, Span)>, Expr)> = vec![(Vec::new(), base)];
        loop {
            let levels: usize = 1 + chain.last().map_or(0, |(signs, _)| signs.len());
            match items.pop_front() {
                Some(Item::Caret(signs, span)) => {
                    self.room(span, levels)?;
                    self.depth += levels;
                    let operand = self.primary(items);
                    chain.push((signs, operand?));
                }
                Some(Item::Superscript(text, span)) => {
                    self.room(span, levels)?;
                    self.depth += levels;
                    chain.push((Vec::new(), superscript_number(&text, span)));
                }
                other => {
                    if let Some(item) = other {
                        items.push_front(item);
                    }
                    break;
                }
            }
        }
        self.depth = depth;
        let (mut signs, mut expr) = chain.pop().expect("a chain starts with its base");
        while let Some((signs_below, base)) = chain.pop() {
            let exponent = self.signed(&signs, |_| Ok(expr))?;
            number_only(&base)?;
            number_only(&exponent)?;
            self.odd_root(&base, &exponent);
            let span = base.span.to(exponent.span);
            expr = Expr::new(ExprKind::Power(Box::new(base), Box::new(exponent)), span);
            signs = signs_below;
        }
        Ok(expr)
    }

    /// Remarks on `x^(1/3)`, which is for x ≥ 0 though the root exists for all x.
    fn odd_root(&mut self, base: &Expr, exponent: &Expr) {
        let ExprKind::Product(top, rest) = &exponent.kind else {
            return;
        };
        let [(ProductSign::Over, bottom)] = rest.as_slice() else {
            return;
        };
        let whole = |expr: &Expr| expr.number().and_then(|text| text.parse::<u32>().ok());
        let (Some(top), Some(bottom)) = (whole(top), whole(bottom)) else {
            return;
        };
        if base.number().is_some() || bottom % 2 == 0 || top % bottom.max(1) == 0 {
            return;
        }
        let base = base.to_string();
        let base = if base.chars().count() > 24 { "…".to_owned() } else { base };
        let root =
            if bottom == 3 { format!("cbrt({base})") } else { format!("root({base}, {bottom})") };
        let other = if top == 1 { root } else { format!("{root}^{top}") };
        let kind = NoteKind::OddRoot { exponent: format!("{top}/{bottom}"), other };
        self.note(exponent.span, kind);
    }

    pub(crate) fn primary(&mut self, items: &mut Items<'_>) -> Fallible<Expr> {
        match items.pop_front() {
            Some(Item::Number(text, span)) => Ok(Expr::new(ExprKind::Number(text), span)),
            Some(Item::Value(value, span)) => self.not_a_call(value, span, items),
            Some(Item::Function(callee, span)) => {
                self.nested(span, |b| b.application(&callee, span, items))
            }
            Some(Item::Group(pair)) => self.group(pair),
            Some(Item::Closed(pair)) => self.closed(pair),
            Some(Item::Radical(radical, span)) => self.nested(span, |b| {
                let inner = b.power(items)?;
                number_only(&inner)?;
                if matches!(
                    items.front(),
                    Some(
                        Item::Number(..)
                            | Item::Value(..)
                            | Item::Group(_)
                            | Item::Function(..)
                            | Item::Closed(_)
                    )
                ) {
                    b.note(span.to(inner.span), NoteKind::RadicalScope { radical });
                }
                let op = if radical == '∛' { Op::Cbrt } else { Op::Sqrt };
                let place = span.to(inner.span);
                Ok(Expr::new(ExprKind::Call(Function::Native(op), vec![inner]), place))
            }),
            Some(Item::Caret(_, span) | Item::Superscript(_, span)) => {
                let sign = "^".to_owned();
                Err(Error::new(span, ErrorKind::MissingBefore { sign }))
            }
            None => Err(Error::new(Span::at(self.base), ErrorKind::Empty)),
        }
    }

    /// A value; brackets after it multiply, unless they hold several arguments.
    fn not_a_call(&mut self, value: Value, span: Span, items: &Items<'_>) -> Fallible<Expr> {
        if let Some(Item::Group(pair)) = items.front() {
            let count = pair.clone().into_inner().flat_map(Pair::into_inner).count();
            if count != 1 {
                let name = value.name().to_owned();
                let place = span.to(self.span(pair));
                return Err(Error::new(place, ErrorKind::NotAFunction { name }));
            }
        }
        Ok(Expr::new(ExprKind::Name(value), span))
    }

    /// Round or square brackets around one expression.
    fn group(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        let is_square = pair.as_str().starts_with('[');
        let mut inner = pair.into_inner().flat_map(Pair::into_inner);
        match (inner.next(), inner.next()) {
            (Some(only), None) => {
                let mut expr = self.expression(only)?;
                expr.span = span;
                Ok(expr)
            }
            (None, _) => Err(Error::new(span, ErrorKind::EmptyBrackets)),
            (Some(_), Some(_)) if is_square => Err(Error::new(span, ErrorKind::Vector)),
            (Some(_), Some(_)) => Err(Error::new(span, ErrorKind::Tuple)),
        }
    }

    /// Braces, bars, brackets that round, a fraction or a root.
    pub(crate) fn closed(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        self.nested(span, |b| match pair.as_rule() {
            Rule::bars => {
                let inner = pair.into_inner().next().expect("bars hold an expression");
                let inner = b.value(inner)?;
                Ok(Expr::new(ExprKind::Call(Function::Native(Op::Abs), vec![inner]), span))
            }
            Rule::fraction => {
                let mut parts = Vec::new();
                for child in pair.into_inner() {
                    let part = match child.as_rule() {
                        Rule::braces => b.closed(child)?,
                        Rule::digit => number(child.as_str().to_owned(), b.span(&child)),
                        _ => continue,
                    };
                    parts.push((ProductSign::Over, part));
                }
                Ok(product_of(parts, span))
            }
            Rule::vulgar => {
                let parts = pair.as_str().chars().next().and_then(vulgar);
                let (above, below) = parts.expect("the grammar knows no others");
                let part = |digit: char| (ProductSign::Over, number(digit.to_string(), span));
                Ok(product_of(vec![part(above), part(below)], span))
            }
            Rule::floored | Rule::ceiled => {
                let op = if pair.as_rule() == Rule::floored { Op::Floor } else { Op::Ceil };
                let mut inner = pair.into_inner().filter(|p| p.as_rule() == Rule::expression);
                let inner = inner.next().expect("these brackets hold an expression");
                let inner = b.value(inner)?;
                Ok(Expr::new(ExprKind::Call(Function::Native(op), vec![inner]), span))
            }
            Rule::root => b.latex_root(pair, span),
            _ => {
                let inner = pair.into_inner().next().expect("braces hold a sum");
                let expr = b.sum(inner)?;
                number_only(&expr)?;
                Ok(expr)
            }
        })
    }

    fn latex_root(&mut self, pair: Pair<'_>, span: Span) -> Fallible<Expr> {
        let mut index = None;
        let mut radicand = None;
        for child in pair.into_inner() {
            if child.as_rule() == Rule::index {
                let inner = child.into_inner().next().expect("an index holds an expression");
                index = Some(self.value(inner)?);
            } else {
                radicand = Some(self.closed(child)?);
            }
        }
        let radicand = radicand.expect("a root has braces");
        let (function, arguments) = match index {
            Some(index) => (Function::Root, vec![radicand, index]),
            None => (Function::Native(Op::Sqrt), vec![radicand]),
        };
        Ok(Expr::new(ExprKind::Call(function, arguments), span))
    }
}

fn number(digits: String, span: Span) -> Expr {
    Expr::new(ExprKind::Number(digits), span)
}

/// The number that superscript digits stand for.
pub(crate) fn superscript_number(text: &str, span: Span) -> Expr {
    let number = |text: &str| Expr::new(ExprKind::Number(text.to_owned()), span);
    match text.strip_prefix('-') {
        Some(digits) => Expr::new(ExprKind::Negate(Box::new(number(digits))), span),
        None => number(text),
    }
}
