//! Runs: factors side by side without signs, where names decide what is a call and what a product.
//!
//! A run is flattened to a row of items and read from left to right. Only here `f(x)` and `x(y + 1)` differ,
//! `sin 2x cos y` becomes two calls, and `xyz` three factors.

use crate::ast::{Expr, ExprKind, Function, ProductSign, SumSign, Value};
use crate::build::{Builder, number_only, product_of, sign};
use crate::error::{Error, ErrorKind, Fallible};
use crate::grammar::{Pair, Rule};
use crate::note::NoteKind;
use crate::scan::in_name;
use crate::scope::{Callee, Meaning, is_variadic};
use crate::span::Span;
use std::collections::VecDeque;
use zeroset_ops::Op;

/// A piece of a run.
enum Item<'i> {
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
type Items<'i> = VecDeque<Item<'i>>;

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
                    "phi" => "of the golden ratio, (1 + sqrt(5))/2 = 1.6180339…",
                    _ => return,
                };
                let kind = NoteKind::ConstantUsed {
                    name: constant.name(),
                    meaning,
                };
                if !self.notes.iter().any(|note| note.kind == kind) {
                    self.note(span, kind);
                }
            }
            Value::Time => {
                self.used.insert("t".to_owned());
            }
            Value::Coordinate(_) | Value::Local(_) => {}
        }
    }

    /// Reads one factor with its exponents onto the end of `factors`.
    fn factor(&mut self, items: &mut Items<'_>, factors: &mut Vec<Expr>) -> Fallible<()> {
        if let (Some(Item::Number(_, span)), Some(before)) = (items.front(), factors.last()) {
            let kind = if before.number().is_some() {
                ErrorKind::NumberAfterNumber
            } else {
                ErrorKind::NumberAfterFactor
            };
            let place = before.span.to(*span);
            let between = Span::new(before.span.end, span.start);
            let fix = if before.number().is_some() {
                "*".to_owned()
            } else {
                "^".to_owned()
            };
            return Err(Error::new(place, kind).suggest(between, fix));
        }
        if let (Some(Item::Closed(pair)), false) = (items.front(), factors.is_empty()) {
            if pair.as_rule() == Rule::braces {
                // Braces after a factor look like a restriction; read as a product they would hide a mistake.
                let span = self.span(pair);
                return Err(Error::new(span, ErrorKind::RestrictionNotCondition));
            }
        }
        let factor = self.power(items)?;
        factors.push(factor);
        Ok(())
    }

    /// A factor with its exponents. `x^y^z` is `x^(y^z)`, and a sign in an exponent covers what is above it.
    fn power(&mut self, items: &mut Items<'_>) -> Fallible<Expr> {
        let base = self.primary(items)?;
        self.exponents(base, items)
    }

    fn exponents(&mut self, base: Expr, items: &mut Items<'_>) -> Fallible<Expr> {
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
        let base = if base.chars().count() > 24 {
            "…".to_owned()
        } else {
            base
        };
        let root = if bottom == 3 {
            format!("cbrt({base})")
        } else {
            format!("root({base}, {bottom})")
        };
        let other = if top == 1 {
            root
        } else {
            format!("{root}^{top}")
        };
        let kind = NoteKind::OddRoot {
            exponent: format!("{top}/{bottom}"),
            other,
        };
        self.note(exponent.span, kind);
    }

    fn primary(&mut self, items: &mut Items<'_>) -> Fallible<Expr> {
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
                Ok(Expr::new(
                    ExprKind::Call(Function::Native(op), vec![inner]),
                    place,
                ))
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

    /// Braces, bars, a fraction or a root.
    fn closed(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let span = self.span(&pair);
        self.nested(span, |b| match pair.as_rule() {
            Rule::bars => {
                let inner = pair.into_inner().next().expect("bars hold an expression");
                let inner = b.value(inner)?;
                Ok(Expr::new(
                    ExprKind::Call(Function::Native(Op::Abs), vec![inner]),
                    span,
                ))
            }
            Rule::fraction => {
                let mut parts = Vec::new();
                for child in pair.into_inner().filter(|p| p.as_rule() == Rule::braces) {
                    parts.push((ProductSign::Over, b.closed(child)?));
                }
                Ok(product_of(parts, span))
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
                let inner = child
                    .into_inner()
                    .next()
                    .expect("an index holds an expression");
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

    /// A function and what it is applied to: brackets, or the implicit product up to the next function.
    fn application(
        &mut self,
        callee: &Callee,
        span: Span,
        items: &mut Items<'_>,
    ) -> Fallible<Expr> {
        let mut callee = callee.clone();
        let mut exponent = None;
        if let Some(Item::Caret(..) | Item::Superscript(..)) = items.front() {
            let power = self.function_exponent(items)?;
            if is_minus_one(&power) {
                callee = self.inverse(&callee, span.to(power.span))?;
            } else {
                exponent = Some(power);
            }
        }
        let arguments = if let Some(Item::Group(_)) = items.front() {
            let Some(Item::Group(pair)) = items.pop_front() else {
                return Err(Error::new(span, ErrorKind::Empty));
            };
            let place = self.span(&pair);
            let mut arguments = Vec::new();
            for argument in pair.into_inner().flat_map(Pair::into_inner) {
                arguments.push(self.value(argument)?);
            }
            (arguments, place)
        } else {
            let argument = self.bare_argument(&callee, span, items)?;
            let place = argument.span;
            (vec![argument], place)
        };
        let call = self.call(&callee, span, arguments.0, arguments.1)?;
        Ok(match exponent {
            None => call,
            Some(exponent) => {
                let place = call.span;
                Expr::new(ExprKind::Power(Box::new(call), Box::new(exponent)), place)
            }
        })
    }

    /// The exponent between a function and its argument, `sin^2 x`.
    fn function_exponent(&mut self, items: &mut Items<'_>) -> Fallible<Expr> {
        match items.pop_front() {
            Some(Item::Superscript(text, span)) => Ok(superscript_number(&text, span)),
            Some(Item::Caret(signs, _)) => {
                let exponent = self.primary(items)?;
                let exponent = match items.front() {
                    Some(Item::Caret(..) | Item::Superscript(..)) => {
                        self.exponents(exponent, items)?
                    }
                    _ => exponent,
                };
                number_only(&exponent)?;
                self.signed(&signs, |_| Ok(exponent))
            }
            _ => Err(Error::new(Span::at(self.base), ErrorKind::Empty)),
        }
    }

    fn inverse(&mut self, callee: &Callee, span: Span) -> Fallible<Callee> {
        let (Callee::BuiltIn(name) | Callee::Defined(name, _)) = callee;
        let inverse = match (callee, name.as_str()) {
            (Callee::BuiltIn(_), "sin") => "asin",
            (Callee::BuiltIn(_), "cos") => "acos",
            (Callee::BuiltIn(_), "tan") => "atan",
            (Callee::BuiltIn(_), "sinh") => "asinh",
            (Callee::BuiltIn(_), "cosh") => "acosh",
            (Callee::BuiltIn(_), "tanh") => "atanh",
            _ => {
                let name = name.clone();
                return Err(Error::new(span, ErrorKind::InversePower { name }));
            }
        };
        let kind = NoteKind::InverseFunction {
            name: name.clone(),
            inverse: inverse.to_owned(),
        };
        self.note(span, kind);
        Ok(Callee::BuiltIn(inverse.to_owned()))
    }

    /// The argument of a function without brackets.
    fn bare_argument(
        &mut self,
        callee: &Callee,
        span: Span,
        items: &mut Items<'_>,
    ) -> Fallible<Expr> {
        let counts = self.scope.counts(callee);
        if items.is_empty() || !counts.accept(1) {
            let (Callee::BuiltIn(name) | Callee::Defined(name, _)) = callee;
            let kind = ErrorKind::NeedsArgument {
                name: name.clone(),
                count: counts.least(),
            };
            return Err(self.suggest_brackets(Error::new(span, kind), span));
        }
        let mut factors = Vec::new();
        while !items.is_empty() {
            if let (Some(Item::Function(..)), false) = (items.front(), factors.is_empty()) {
                break;
            }
            self.factor(items, &mut factors)?;
        }
        if factors.len() > 1 {
            for factor in &factors {
                number_only(factor)?;
            }
        }
        let place = factors[0].span.to(factors[factors.len() - 1].span);
        let product = product_of(
            factors
                .into_iter()
                .map(|f| (ProductSign::Times, f))
                .collect(),
            place,
        );
        number_only(&product)?;
        Ok(product)
    }

    /// `sin -x` is a difference; if that fails, brackets are what was meant.
    fn suggest_brackets(&self, error: Box<Error>, span: Span) -> Box<Error> {
        let rest = &self.text[span.end..];
        let after = rest.trim_start();
        let operand = after.strip_prefix(['-', '−']);
        let Some(operand) = operand.filter(|o| o.starts_with(|c: char| c.is_alphanumeric())) else {
            return error;
        };
        let length = operand.find(|c: char| !in_name(c)).unwrap_or(operand.len());
        let argument = &after[..after.len() - operand.len() + length];
        let end = span.end + (rest.len() - after.len()) + argument.len();
        if argument.len() > 40 {
            return error;
        }
        error.suggest(Span::new(span.end, end), format!("({argument})"))
    }

    /// A call with its arguments counted.
    fn call(
        &mut self,
        callee: &Callee,
        span: Span,
        arguments: Vec<Expr>,
        place: Span,
    ) -> Fallible<Expr> {
        let Some(function) = self.scope.function(callee, arguments.len()) else {
            let (Callee::BuiltIn(name) | Callee::Defined(name, _)) = callee;
            let kind = ErrorKind::WrongCount {
                name: name.clone(),
                expected: self.scope.counts(callee).to_string(),
                given: arguments.len(),
                usage: usage(callee),
            };
            return Err(Error::new(span.to(place), kind));
        };
        Ok(Expr::new(
            ExprKind::Call(function, arguments),
            span.to(place),
        ))
    }
}

/// How a function of the language is called, with its line of help.
fn usage(callee: &Callee) -> Option<String> {
    let Callee::BuiltIn(name) = callee else {
        return None;
    };
    if let "log" | "ln" = name.as_str() {
        return Some(
            "logarithms are natural; write `ln(a)/ln(b)` for the logarithm of a to base b"
                .to_owned(),
        );
    }
    if let Some(composed) = zeroset_ops::composed(name).next() {
        return Some(format!(
            "`{name}({})`: {}",
            composed.parameters.join(", "),
            composed.doc
        ));
    }
    let row = zeroset_ops::native(name)?;
    let operands = ["a", "b", "c"][..row.op.arity()].join(", ");
    let more = if is_variadic(row.op) { ", …" } else { "" };
    Some(format!("`{name}({operands}{more})`: {}", row.doc))
}

fn is_minus_one(expr: &Expr) -> bool {
    matches!(&expr.kind, ExprKind::Negate(inner) if inner.number() == Some("1"))
}

fn superscript_number(text: &str, span: Span) -> Expr {
    let number = |text: &str| Expr::new(ExprKind::Number(text.to_owned()), span);
    match text.strip_prefix('-') {
        Some(digits) => Expr::new(ExprKind::Negate(Box::new(number(digits))), span),
        None => number(text),
    }
}

/// Superscript digits as plain ones; a plus sign is dropped.
fn superscript(text: &str) -> String {
    text.chars()
        .filter_map(|c| match c {
            '⁻' => Some('-'),
            '⁺' => None,
            _ => "⁰¹²³⁴⁵⁶⁷⁸⁹"
                .chars()
                .zip('0'..='9')
                .find(|(s, _)| *s == c)
                .map(|(_, d)| d),
        })
        .collect()
}

/// A number's text in one spelling: `.5` as `0.5`, `1.` as `1`, an exponent after `e`.
fn decimal(typed: &str) -> String {
    let text = typed.replace('−', "-").replace('E', "e");
    let (mantissa, exponent) = match text.split_once('e') {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text.as_str(), None),
    };
    let mut number = String::with_capacity(text.len() + 1);
    if mantissa.starts_with('.') {
        number.push('0');
    }
    number += mantissa.trim_end_matches('.');
    if let Some(exponent) = exponent {
        number.push('e');
        number += exponent.trim_start_matches('+');
    }
    number
}

/// A name without LaTeX around it: `\sin` as `sin`, `\operatorname{foo}` as `foo`, `x_{12}` as `x_12`.
pub(crate) fn plain_name(typed: &str) -> String {
    let text = typed.strip_prefix('\\').unwrap_or(typed);
    let text = match text.split_once('{') {
        Some(("operatorname" | "mathrm" | "mathit" | "text", inner)) => inner,
        _ => text,
    };
    text.chars().filter(|c| !matches!(c, '{' | '}')).collect()
}
