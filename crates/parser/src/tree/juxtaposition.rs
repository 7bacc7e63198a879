//! Reads rows of juxtaposed factors, which have no operators between them. The meanings of names
//! decide between calls and products.
//!
//! A row is split into items, which are read from left to right. Only this stage distinguishes
//! `f(x)` from `x(y + 1)`, reads `sin 2x cos y` as two calls, and splits `xyz` into three factors.

use crate::lex::lexer::method;
use crate::lex::spelling::{PRIMES, decimal, is_name_char, plain_name, superscript_digit};
use crate::lex::token_kind::TokenKind::{Saved, Slash};
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::messages::note::NoteKind;
use crate::span::Span;
use crate::tree::aliases::saved_name;
use crate::tree::ast::{Expr, ExprKind, Function, LETTERS, NamedValue};
use crate::tree::builder::{Builder, Signs, number_only, root_text};
use crate::tree::delimited::native;
use crate::tree::derivatives::{MAX_ORDER, Operator, operator};
use crate::tree::foreign_functions::{ForeignFunction, foreign_function};
use crate::tree::grammar::{Pair, Pairs, Rule};
use crate::tree::scope::{Callee, NameMeaning, coordinate, meaning, numbered, read_as};
use crate::tree::special_forms::{Logic, logic};
use std::collections::VecDeque;
use zeroset_ir::NamedConstant;
use zeroset_ops::{Op, SpecialForm};

/// Names of conversions between types of numbers.
const CONVERSIONS: &[&str] =
    &["float", "double", "f32", "f64", "S", "RDF", "RR", "QQ", "float32", "float64", "asarray"];

/// An item of a row of juxtaposed factors.
pub(crate) enum FactorItem<'i> {
    /// A number or a named value.
    Leaf(Expr),
    Function(Callee, Span),
    /// An operator before a function, such as ∂/∂x.
    Operator(Operator, Span),
    /// A call whose arguments have special syntax. The next item holds the brackets.
    Special(SpecialCall, Span),
    /// A method call after its first argument. The pair holds the other arguments.
    Method(String, Span, Pair<'i>),
    /// Letters of components, such as `.xz` after a vector.
    Component(String, Span),
    /// A pair of round or square brackets.
    Group(Pair<'i>),
    /// Any other delimited factor, such as braces, bars, `\frac` or `\sqrt{}`.
    Delimited(Pair<'i>),
    /// `!` after a whole number.
    Factorial(Span),
    /// The sign `^`, and the plus and minus signs before the exponent.
    Caret(Signs, Span),
    /// Superscript digits, read as a number.
    Superscript(Expr),
    /// The sign `√` or `∛`.
    Radical(char, Span),
}

/// A call whose arguments have special syntax.
#[derive(Clone, Copy)]
pub(crate) enum SpecialCall {
    /// A special form. Its arguments may be more than numbers.
    Form(&'static SpecialForm),
    /// A condition written as a function.
    Logic(Logic),
    Foreign(ForeignFunction),
}

/// Items of a row that were not read yet.
pub(crate) type FactorItems<'i> = VecDeque<FactorItem<'i>>;

impl Builder<'_> {
    /// Reads the next row of juxtaposed factors.
    pub(crate) fn row(&mut self, pairs: &mut Pairs<'_>) -> Fallible<Vec<Expr>> {
        let mut items = self.items(pairs)?;
        let mut factors = Vec::new();
        while !items.is_empty() {
            self.factor(&mut items, &mut factors)?;
        }
        let is_solid =
            |factor: &Expr| matches!(factor.kind, ExprKind::Call(Function::Builder(_), _));
        if let Some(pair) = factors.windows(2).find(|pair| pair.iter().all(is_solid)) {
            let place = pair[0].span.to(pair[1].span);
            return Err(Error::new(place, ErrorKind::SolidsInARow));
        }
        self.note_powers(&factors);
        Ok(factors)
    }

    /// Reads a single name as a part of a fraction, or as the upper end of a `\sum`.
    #[inline(never)] // keeps its locals out of the stack frames of nested fractions
    pub(crate) fn letter(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        let mut items = FactorItems::new();
        self.item(pair, &mut items)?;
        self.power(&mut items)
    }

    #[inline(never)] // keeps its locals out of the stack frames of the recursion
    fn items<'i>(&mut self, pairs: &mut Pairs<'i>) -> Fallible<FactorItems<'i>> {
        let mut items = FactorItems::new();
        while let Some(pair) = pairs.peek().filter(|pair| pair.as_rule() != Rule::operator) {
            pairs.next();
            self.item(pair, &mut items)?;
        }
        Ok(items)
    }

    /// Adds the items of one element of a product to `items`.
    fn item<'i>(&mut self, pair: Pair<'i>, items: &mut FactorItems<'i>) -> Fallible<()> {
        let span = self.span(&pair);
        let typed = self.typed(&pair);
        items.push_back(match pair.as_rule() {
            Rule::name => {
                let token = self.lexed.tokens[self.lexed.index(pair.as_span().start())];
                let saved = Some(token.number).filter(|_| token.kind == Saved);
                match saved.and_then(|number| self.alias(&saved_name(number))) {
                    Some(kind) => FactorItem::Leaf(Expr::new(kind, span)),
                    None => return self.name(typed, span, items),
                }
            }
            Rule::number => FactorItem::Leaf(Expr::of_digits(decimal(typed), span)),
            Rule::superscript => {
                // The entity `&sup2;` contains an ordinary digit.
                let digit = |c: char| superscript_digit(c).or(Some(c).filter(char::is_ascii_digit));
                let digits: String = typed.chars().filter_map(digit).collect();
                let digits = Expr::of_digits(digits, span);
                FactorItem::Superscript(if typed.starts_with('⁻') {
                    digits.negated(span)
                } else {
                    digits
                })
            }
            Rule::caret => FactorItem::Caret(self.signs(&mut pair.into_inner()), span),
            Rule::factorial => FactorItem::Factorial(span),
            Rule::radical => FactorItem::Radical(typed.chars().next().unwrap_or('√'), span),
            Rule::group => FactorItem::Group(pair),
            Rule::component => FactorItem::Component(letters(typed), span),
            Rule::method => {
                let word = typed[1..].split(|c| !is_name_char(c)).next().unwrap_or("");
                FactorItem::Method(method(word).unwrap_or(word).to_owned(), span, pair)
            }
            Rule::vulgar => {
                // `2½` is ambiguous: it may mean 5/2 or 2·(1/2).
                if let Some(FactorItem::Leaf(before)) = items.back()
                    && before.number().is_some()
                {
                    return Err(Error::new(before.span.to(span), ErrorKind::NumberAfterNumber));
                }
                FactorItem::Delimited(pair)
            }
            _ => FactorItem::Delimited(pair),
        });
        Ok(())
    }

    /// Adds the items for a name as in `xcos(r)`, a product of letters and a call, to `items`.
    /// Returns whether the name is such a product. In an exponent or a divisor it is not read so,
    /// since it would not be clear where these end.
    fn product_with_call(&mut self, name: &str, span: Span, items: &mut FactorItems<'_>) -> bool {
        let behind = self.text[span.end..].trim_start_matches(BLANKS);
        let is_part = matches!(items.back(), Some(FactorItem::Caret(..)))
            || items.is_empty() && self.follows(span, &[Slash]);
        // Without brackets, `xsin x` has a blank before the argument.
        let is_applied = behind.starts_with('(')
            || behind.starts_with(char::is_alphanumeric)
                && behind.len() < self.text.len() - span.end;
        if is_part || !is_applied {
            return false;
        }
        let Some((letters, callee)) = self.scope.product_with_call(name, &self.locals) else {
            return false;
        };
        let (mut at, mut product) = (span.start, String::new());
        for (letter, value) in letters {
            let end = at + letter.len();
            items.push_back(self.leaf(value, Span::new(at, end)));
            at = end;
            product.extend([letter, "*"]);
        }
        let argument = bracketed(behind);
        let unbracketed = if behind.starts_with('(') { "(…)" } else { " …" };
        product.extend([callee.name(), argument.unwrap_or(unbracketed)]);
        if let Callee::Defined(name, _) = &callee {
            self.used.insert(name.clone());
        }
        items.push_back(FactorItem::Function(callee, Span::new(at, span.end)));
        self.note(span, NoteKind::ProductOfNames { name: name.to_owned(), product });
        true
    }

    /// Adds the items for a name to `items`. Usually this is one item.
    fn name(&mut self, typed: &str, span: Span, items: &mut FactorItems<'_>) -> Fallible<()> {
        if let Some(operator) = operator(typed) {
            items.push_back(FactorItem::Operator(operator, span));
            return Ok(());
        }
        let function = typed.trim_end_matches(PRIMES);
        if function.len() < typed.len() {
            return self.derived_function(function, typed, span, items);
        }
        let name = plain_name(typed);
        if let Some(lifted) = self.alias(&name) {
            items.push_back(FactorItem::Leaf(Expr::new(lifted, span)));
            return Ok(());
        }
        let behind = self.text[span.end..].trim_start_matches(BLANKS);
        let behind = behind.strip_prefix(r"\left").unwrap_or(behind);
        let is_applied = behind.starts_with(['(', '[', '@']) || name == "overline";
        if is_applied || behind.starts_with(r"\begin{") {
            let form = self.scope.form(&name, &self.locals).map(SpecialCall::Form);
            let elsewhere = || {
                let kind =
                    foreign_function(&name, behind.starts_with('[')).map(SpecialCall::Foreign);
                kind.or_else(|| logic(&name).map(SpecialCall::Logic))
            };
            let elsewhere = || elsewhere().filter(|_| !self.scope.is_defined(&name));
            if let Some(word) = form.or_else(elsewhere) {
                items.push_back(FactorItem::Special(word, span));
                return Ok(());
            }
            if let Some(callee) = numbered(&name).filter(|_| !self.scope.is_defined(&name)) {
                let read = callee.name().to_owned();
                self.note(span, NoteKind::Sequence { name, read });
                items.push_back(FactorItem::Function(callee, span));
                return Ok(());
            }
        }
        match self.scope.meaning(&name, &self.locals) {
            NameMeaning::Value(value) => items.push_back(self.leaf(value, span)),
            NameMeaning::Function(callee) => {
                if let Callee::Defined(name, _) = &callee {
                    self.used.insert(name.clone());
                }
                if let Some(read) = read_as(&name, &callee) {
                    self.note(span, NoteKind::ReadAs { name, read });
                }
                items.push_back(FactorItem::Function(callee, span));
            }
            NameMeaning::Product => {
                // An exponent or divisor gets only the first letter. Another note reports that.
                let is_exponent = matches!(items.back(), Some(FactorItem::Caret(..)))
                    && !matches!(items.iter().nth_back(1), Some(FactorItem::Function(..)));
                let is_noted = is_exponent || items.is_empty() && self.follows(span, &[Slash]);
                let letters: Vec<String> = name.chars().map(String::from).collect();
                let mut at = span.start;
                for letter in &letters {
                    // Plain letters have places of their own, because LaTeX commands and subscripts
                    // are never split. Styled letters take more bytes and get the span of the name.
                    let is_plain = typed.len() == name.len();
                    let place = if is_plain { Span::new(at, at + letter.len()) } else { span };
                    at = place.end;
                    if let NameMeaning::Value(value) = self.scope.meaning(letter, &self.locals) {
                        items.push_back(self.leaf(value, place));
                    }
                }
                if !is_noted {
                    let product = letters.join("*");
                    self.note(span, NoteKind::ProductOfNames { name, product });
                }
            }
            NameMeaning::Unknown => {
                if typed == "°" {
                    items.push_back(FactorItem::Leaf(degree(span)));
                    return Ok(());
                }
                // Conversions between types of numbers, as in `float(x)`, have no effect.
                let is_called = self.text[span.end..].starts_with('(');
                let is_type = CONVERSIONS.contains(&typed);
                let follows_number = matches!(items.back(), Some(FactorItem::Leaf(before))
                    if before.number().is_some() && before.span.end == span.start);
                // In C#, `2f` is a number. In Python, `2j` is an imaginary one, and in Julia `2im`.
                if is_called && is_type || typed == "f" && follows_number {
                    return Ok(());
                }
                if typed == "j" && follows_number || typed == "im" {
                    items.push_back(self.leaf(NamedValue::ImaginaryUnit, span));
                    return Ok(());
                }
                if typed.len() == name.len() && self.product_with_call(&name, span, items) {
                    return Ok(());
                }
                // If a parameter is called `x`, `X` is not read as the coordinate x.
                let lower = name.to_lowercase();
                let is_hidden = self.locals.iter().any(|local| local.text == lower);
                let (value, kind) = if TIMES.contains(&typed) {
                    (NamedValue::Time, NoteKind::TimeOfShaders { name })
                } else if typed == "E" {
                    (NamedValue::Constant(NamedConstant::E), NoteKind::CapitalE)
                } else if let Some(axis) = coordinate(&lower).filter(|_| !is_hidden) {
                    (NamedValue::Coordinate(axis), NoteKind::CapitalCoordinates)
                } else {
                    return Err(self.unknown(&name, typed, span));
                };
                self.note(span, kind);
                items.push_back(self.leaf(value, span));
            }
        }
        Ok(())
    }

    /// Adds the item for the derivative `f'` of a function.
    #[inline(never)]
    fn derived_function(
        &mut self,
        function: &str,
        typed: &str,
        span: Span,
        items: &mut FactorItems<'_>,
    ) -> Fallible<()> {
        let primes: usize =
            typed[function.len()..].chars().map(|c| 1 + usize::from(c == '″')).sum();
        let order = u8::try_from(primes).ok().filter(|_| primes <= MAX_ORDER);
        let Some(order) = order else {
            return Err(Error::new(span, ErrorKind::DerivativeOrder { limit: MAX_ORDER }));
        };
        let name = plain_name(function);
        match self.scope.meaning(&name, &self.locals) {
            NameMeaning::Function(callee) if !matches!(callee, Callee::Logarithm(_)) => {
                if let Callee::Defined(name, _) = &callee {
                    self.used.insert(name.clone());
                }
                let callee = Callee::Derived(Box::new(callee), order);
                items.push_back(FactorItem::Function(callee, span));
                Ok(())
            }
            NameMeaning::Function(_)
            | NameMeaning::Value(_)
            | NameMeaning::Product
            | NameMeaning::Unknown => Err(self.unknown(&name, function, span)),
        }
    }

    /// Records that the statement uses a value.
    pub(crate) fn use_value(&mut self, value: &NamedValue) {
        if let NamedValue::Defined(_) | NamedValue::Time = value {
            self.used.insert(value.name().to_owned());
        }
    }

    /// The item of a named value. Records that the value is used.
    fn leaf(&mut self, value: NamedValue, span: Span) -> FactorItem<'static> {
        self.use_value(&value);
        if let NamedValue::Constant(constant) = value
            && let Some(meaning) = meaning(constant)
        {
            self.note(span, NoteKind::ConstantUsed { name: constant.name(), meaning });
        }
        FactorItem::Leaf(Expr::new(ExprKind::Name(value), span))
    }

    /// Reads one factor with its exponents. Appends it to `factors`.
    pub(crate) fn factor(
        &mut self,
        items: &mut FactorItems<'_>,
        factors: &mut Vec<Expr>,
    ) -> Fallible<()> {
        if let (Some(next), Some(before)) = (items.front(), factors.last()) {
            self.may_follow(next, before)?;
        }
        factors.push(self.power(items)?);
        Ok(())
    }

    /// Fails if the item `next` may not directly follow the factor `before`.
    #[inline(never)]
    fn may_follow(&self, next: &FactorItem<'_>, before: &Expr) -> Fallible<()> {
        match next {
            FactorItem::Leaf(next) if next.number().is_some() => {
                let (kind, sign) = match before.kind {
                    ExprKind::Number(_) => (ErrorKind::NumberAfterNumber, "*"),
                    // A power has an exponent already, so the number is not meant as an exponent.
                    ExprKind::Power(..) => (ErrorKind::NumberAfterFactor, "*"),
                    _ => (ErrorKind::NumberAfterFactor, "^"),
                };
                let between = Span::new(before.span.end, next.span.start);
                Err(Error::new(before.span.to(next.span), kind).suggest(between, sign))
            }
            // Braces after a factor look like a restriction. Reading them as a factor could hide a
            // mistake.
            FactorItem::Delimited(pair) if pair.as_rule() == Rule::braces => {
                Err(Error::new(self.span(pair), ErrorKind::RestrictionNotCondition))
            }
            _ => Ok(()),
        }
    }

    /// Reads a factor with its exponents. `x^y^z` is `x^(y^z)`. A sign in an exponent applies to
    /// the rest of the exponents: `x^-y^z` is `x^(-(y^z))`.
    pub(crate) fn power(&mut self, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        let base = self.primary(items)?;
        match items.front() {
            Some(
                FactorItem::Component(..)
                | FactorItem::Method(..)
                | FactorItem::Factorial(_)
                | FactorItem::Caret(..)
                | FactorItem::Superscript(_),
            ) => self.with_postfixes(base, items),
            _ => Ok(base),
        }
    }

    /// Adds to a factor the items after it that belong to it: components, methods, `!` and
    /// exponents.
    #[inline(never)] // keeps the stack frames of nested plain factors small
    fn with_postfixes(&mut self, mut base: Expr, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        while let Some(FactorItem::Component(..)) = items.front() {
            base = Self::component(base, items)?;
            self.check_depth(base.span, 1)?;
        }
        while let Some(FactorItem::Method(..)) = items.front() {
            base = self.method(base, items)?;
        }
        if let Some(FactorItem::Factorial(sign)) = items.front() {
            base = self.factorial(base, *sign)?;
            items.pop_front();
        }
        match items.front() {
            Some(FactorItem::Caret(..) | FactorItem::Superscript(_)) => self.exponents(base, items),
            _ => Ok(base),
        }
    }

    /// Takes a component such as `.x` after `base`, if there is one.
    #[inline(never)]
    fn component(base: Expr, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        let Some(FactorItem::Component(letters, span)) = items.pop_front() else { return Ok(base) };
        let span = base.span.to(span);
        if is_coordinate(&base) {
            let dot = Span::new(span.end - letters.len() - 1, span.end - letters.len());
            let kind = ErrorKind::UnexpectedCharacter { character: '.' };
            return Err(Error::new(dot, kind));
        }
        Ok(Expr::new(ExprKind::Component(Box::new(base), letters), span))
    }

    /// Reads a method call such as `a.pow(2)` as `pow(a, 2)`.
    #[inline(never)] // keeps its locals out of the stack frames of nested factors
    fn method(&mut self, base: Expr, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        let Some(FactorItem::Method(name, span, pair)) = items.pop_front() else { return Ok(base) };
        let place = self.span(&pair);
        self.check_depth(place, 1)?;
        if name == "diff" {
            let group = pair.into_inner().flat_map(Pair::into_inner);
            let place = base.span.to(place);
            return self.derivative(base, &group.collect::<Vec<_>>(), place);
        }
        let mut arguments = vec![base];
        for part in pair.into_inner() {
            if part.as_rule() == Rule::group {
                for argument in part.into_inner() {
                    arguments.push(self.nested(place, 1, |b| b.argument(argument))?);
                }
            }
        }
        let callee = Callee::BuiltIn(name);
        self.call(&callee, span, arguments, place)
    }

    /// Takes all exponents after `base`, and returns the power.
    #[inline(never)] // keeps the stack frames of nested factors without exponents small
    fn exponents(&mut self, base: Expr, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        let mut levels = 0;
        let mut chain: Vec<(Signs, Expr)> = vec![(Signs::new(), base)];
        while let Some(FactorItem::Caret(..) | FactorItem::Superscript(_)) = items.front() {
            levels += 1 + chain.last().map_or(0, |(signs, _)| signs.len());
            chain.push(match items.pop_front() {
                Some(FactorItem::Caret(signs, span)) => {
                    let mut exponent = self.nested(span, levels, |b| b.primary(items))?;
                    while let Some(FactorItem::Component(..)) = items.front() {
                        exponent = Self::component(exponent, items)?;
                    }
                    if let Some(FactorItem::Factorial(sign)) = items.front() {
                        exponent = self.factorial(exponent, *sign)?;
                        items.pop_front();
                    }
                    (signs, exponent)
                }
                Some(FactorItem::Superscript(number)) => {
                    self.check_depth(number.span, levels)?;
                    (Signs::new(), number)
                }
                _ => break,
            });
        }
        self.raised(chain)
    }

    /// Combines a base and its exponents into powers, from right to left.
    #[inline(never)]
    fn raised(&mut self, mut chain: Vec<(Signs, Expr)>) -> Fallible<Expr> {
        let (mut signs, mut expr) = chain.pop().expect("a chain starts with its base");
        while let Some((signs_below, base)) = chain.pop() {
            let exponent = self.signed(&signs, |_| Ok(expr))?;
            number_only(&base)?;
            number_only(&exponent)?;
            self.note_odd_root(&base, &exponent);
            let span = base.span.to(exponent.span);
            expr = Expr::new(ExprKind::Power(Box::new(base), Box::new(exponent)), span);
            signs = signs_below;
        }
        Ok(expr)
    }

    /// Adds a note that `x^(1/3)` is defined only for x ≥ 0, unlike the root.
    fn note_odd_root(&mut self, base: &Expr, exponent: &Expr) {
        let Some((top, bottom)) = exponent.quotient() else {
            return;
        };
        let (Some(top), Some(bottom)) = (top.whole_number(), bottom.whole_number()) else {
            return;
        };
        if base.number().is_some() || bottom % 2 == 0 || top % bottom == 0 {
            return;
        }
        let root = root_text(base, bottom);
        let other = if top == 1 { root } else { format!("{root}^{top}") };
        let kind = NoteKind::OddRoot { exponent: format!("{top}/{bottom}"), other };
        self.note(exponent.span, kind);
    }

    #[inline(never)]
    pub(crate) fn primary(&mut self, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        match items.pop_front().expect("the grammar ends no run with a sign") {
            FactorItem::Group(pair) => self.group(pair),
            item => self.unbracketed_factor(item, items),
        }
    }

    /// Reads a factor that does not begin with brackets.
    #[inline(never)] // keeps the stack frames of nested brackets small
    fn unbracketed_factor(
        &mut self,
        item: FactorItem<'_>,
        items: &mut FactorItems<'_>,
    ) -> Fallible<Expr> {
        match item {
            FactorItem::Leaf(expr) => self.leaf_factor(expr, items),
            FactorItem::Function(callee, span) => {
                self.nested(span, 1, |b| b.application(&callee, span, items))
            }
            FactorItem::Operator(operator, span) => {
                self.nested(span, 1, |b| b.operated(operator, span, items))
            }
            FactorItem::Special(word, span) => {
                let group = self.brackets(items, span)?;
                self.nested(span, 1, |b| match word {
                    SpecialCall::Form(form) => b.form(form, span, group),
                    SpecialCall::Logic(logic) => b.logic(logic, span, group),
                    SpecialCall::Foreign(kind) => b.foreign_call(kind, span, group),
                })
            }
            FactorItem::Delimited(pair) => {
                let span = self.span(&pair);
                self.nested(span, 1, |b| b.delimited(pair, span))
            }
            FactorItem::Radical(radical, span) => {
                self.nested(span, 1, |b| b.radical(radical, span, items))
            }
            item => Err(self.misplaced(&item)),
        }
    }

    /// The error for an item that must follow a factor but does not.
    #[inline(never)] // keeps the stack frames of nested factors small
    fn misplaced(&self, item: &FactorItem<'_>) -> Box<Error> {
        let (span, sign) = match item {
            FactorItem::Component(_, span) => {
                let found = self.text[span.range()].to_owned();
                return Error::new(*span, ErrorKind::Unexpected { found });
            }
            FactorItem::Method(name, span, _) => (*span, format!(".{name}")),
            FactorItem::Factorial(span) => (*span, "!".to_owned()),
            FactorItem::Caret(_, span) | FactorItem::Superscript(Expr { span, .. }) => {
                (*span, "^".to_owned())
            }
            _ => unreachable!("all others begin a factor"),
        };
        Error::new(span, ErrorKind::MissingBefore { sign })
    }

    /// Takes the operand of a sign such as `√`. Adds a note if a reader may expect the root to
    /// extend further.
    #[inline(never)]
    fn radical(
        &mut self,
        radical: char,
        span: Span,
        items: &mut FactorItems<'_>,
    ) -> Fallible<Expr> {
        let inner = self.power(items)?;
        number_only(&inner)?;
        let place = span.to(inner.span);
        if let Some(
            FactorItem::Leaf(_)
            | FactorItem::Group(_)
            | FactorItem::Function(..)
            | FactorItem::Special(SpecialCall::Form(_), _)
            | FactorItem::Delimited(_),
        ) = items.front()
        {
            self.note(place, NoteKind::RadicalScope { radical });
        }
        if items.is_empty() && self.root_goes_on(&inner) {
            self.note(place, NoteKind::RadicalScope { radical });
        }
        let op = if radical == '∛' { Op::Cbrt } else { Op::Sqrt };
        Ok(native(op, inner, place))
    }

    /// Reads a number or a named value as a factor.
    #[inline(never)]
    fn leaf_factor(&mut self, expr: Expr, items: &mut FactorItems<'_>) -> Fallible<Expr> {
        if let Some((letter, span)) = self.index(&expr, items.front()) {
            items.pop_front();
            let span = expr.span.to(span);
            let kind = ExprKind::Component(Box::new(expr), letter.to_string());
            return Ok(Expr::new(kind, span));
        }
        self.not_a_call(expr, items.front())
    }

    /// The component that `p[0]` selects, and the span of the brackets; `None` for other brackets.
    fn index(&self, expr: &Expr, next: Option<&FactorItem<'_>>) -> Option<(char, Span)> {
        let Some(FactorItem::Group(pair)) = next else { return None };
        let is_name = match &expr.kind {
            ExprKind::Name(NamedValue::Local(_) | NamedValue::Defined(_)) => true,
            ExprKind::Call(..) => self.text[expr.span.range()].ends_with(is_name_char),
            _ => false,
        };
        let span = self.span(pair);
        let digit = match self.text[span.range()].as_bytes() {
            [b'[', digit @ b'0'..=b'3', b']'] => usize::from(digit - b'0'),
            _ => return None,
        };
        let touches = expr.span.end == span.start;
        (is_name && touches).then(|| LETTERS.chars().nth(digit).map(|letter| (letter, span)))?
    }

    /// Takes the pair of brackets after a special call.
    fn brackets<'i>(&self, items: &mut FactorItems<'i>, span: Span) -> Fallible<Pair<'i>> {
        if let Some(FactorItem::Group(pair)) = items.pop_front() {
            return Ok(pair);
        }
        let name = self.text[span.range()].to_owned();
        Err(Error::new(span, ErrorKind::NeedsArgument { name, count: 1 }))
    }

    /// Returns `expr`. Fails if it is a named value before brackets that do not hold one
    /// expression.
    fn not_a_call(&mut self, expr: Expr, next: Option<&FactorItem<'_>>) -> Fallible<Expr> {
        if let (ExprKind::Name(value), Some(FactorItem::Group(pair))) = (&expr.kind, next)
            && pair.clone().into_inner().count() != 1
        {
            let name = value.name().to_owned();
            let place = expr.span.to(self.span(pair));
            return Err(Error::new(place, ErrorKind::NotAFunction { name }));
        }
        Ok(expr)
    }
}

/// One degree in radians: π/180.
fn degree(span: Span) -> Expr {
    let pi = Expr::new(ExprKind::Name(NamedValue::Constant(NamedConstant::Pi)), span);
    pi.over(Expr::of_digits("180", span), span)
}

/// Returns whether `expr` is a coordinate without brackets, which has no components.
fn is_coordinate(expr: &Expr) -> bool {
    let is_bare = expr.span.end - expr.span.start == 1;
    is_bare && matches!(expr.kind, ExprKind::Name(NamedValue::Coordinate(_)))
}

/// Names of the time in shaders.
const TIMES: [&str; 6] = ["iTime", "iGlobalTime", "u_time", "uTime", "time", "TIME"];

/// Blanks that may stand between a name and its brackets.
const BLANKS: [char; 2] = [' ', '\t'];

/// The letters of a component such as `.rgb`, replaced by x, y, z and w.
fn letters(typed: &str) -> String {
    let by_position = |letter: char| {
        let found = ["rgba", "stpq"].iter().find_map(|set| set.find(letter));
        found.and_then(|index| LETTERS.chars().nth(index)).unwrap_or(letter)
    };
    typed.chars().skip(1).map(by_position).collect()
}

/// The round bracket with which a text begins, up to its closing sign. `None` if it is long.
fn bracketed(text: &str) -> Option<&str> {
    const LONGEST: usize = 40;
    let mut depth = 0;
    for (at, sign) in text.char_indices().take(LONGEST) {
        match sign {
            '(' => depth += 1,
            ')' if depth == 1 => return Some(&text[..=at]),
            ')' => depth -= 1,
            _ => {}
        }
    }
    None
}
