//! Reads derivatives, in several notations.

use crate::lex::spelling::{differentiated, plain_name, superscript_digit};
use crate::messages::error::{Error, ErrorKind, Fallible};
use crate::span::Span;
use crate::tree::ast::{Expr, ExprKind, Function, NamedValue};
use crate::tree::builder::{Builder, product_of};
use crate::tree::grammar::{Pair, Rule};
use crate::tree::juxtaposition::{FactorItem, FactorItems};
use crate::tree::scope::{Callee, NameMeaning, coordinate};
use crate::tree::special_forms::{descend_to, tuple};
use zeroset_ops::Differential;

/// Largest order of a derivative.
pub(crate) const MAX_ORDER: usize = 20;

/// An operator before a function, such as ∂/∂x or ∇.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    /// Partial derivatives, whose variables the operator's text names.
    Partial,
    /// ∇, the gradient; ∇² is the Laplacian.
    Nabla,
}

/// The operator with this name; `None` if no operator has it.
pub(crate) fn operator(typed: &str) -> Option<Operator> {
    match typed {
        "∇" | r"\nabla" => Some(Operator::Nabla),
        _ if typed.starts_with(['d', '∂']) && typed.contains('/') => Some(Operator::Partial),
        _ if typed.starts_with(r"\frac") => Some(Operator::Partial),
        _ => None,
    }
}

impl Builder<'_> {
    /// Reads `diff(f, x, y)`: a value, then variables. A variable may be followed by the number of
    /// times. Mathematica's `{x, 2}` is a variable with its number.
    #[inline(never)]
    pub(crate) fn diff(&mut self, parts: &[Pair<'_>], place: Span) -> Fallible<Option<Expr>> {
        let [body, rest @ ..] = parts else { return Ok(None) };
        let body = self.of_point(body.clone())?;
        self.derivative(body, rest, place).map(Some)
    }

    /// The derivative of `body`. The arguments name its variables.
    pub(crate) fn derivative(
        &mut self,
        body: Expr,
        arguments: &[Pair<'_>],
        place: Span,
    ) -> Fallible<Expr> {
        let mut by: Vec<NamedValue> = Vec::new();
        for part in arguments {
            let (variable, times) = match tuple(part).as_deref() {
                Some([variable, times]) => (variable.clone(), Some(times.clone())),
                _ if by.is_empty() || descend_to(part, Rule::name).is_some() => {
                    (part.clone(), None)
                }
                _ => {
                    let times = self.order(part)?.saturating_sub(1);
                    let last = by[by.len() - 1].clone();
                    by.extend(std::iter::repeat_n(last, times));
                    continue;
                }
            };
            let times = times.map_or(Ok(1), |times| self.order(&times))?;
            let variable = self.variable(&variable)?;
            by.extend(std::iter::repeat_n(variable, times));
        }
        if by.is_empty() {
            return Err(Error::new(place, ErrorKind::WhichVariable));
        }
        if by.len() > MAX_ORDER {
            return Err(Error::new(place, ErrorKind::DerivativeOrder { limit: MAX_ORDER }));
        }
        Ok(Expr::new(ExprKind::Call(Function::Derivative(by), vec![body]), place))
    }

    /// Reads a function of derivatives. A list of coordinates, as in Mathematica, may follow.
    #[inline(never)]
    pub(crate) fn differential(
        &mut self,
        function: Differential,
        parts: &[Pair<'_>],
        place: Span,
    ) -> Fallible<Option<Expr>> {
        let body = match parts {
            [body] => body,
            [body, list] if tuple(list).is_some_and(|list| list.len() == 3) => body,
            _ => return Ok(None),
        };
        let body = self.of_point(body.clone())?;
        let function = Function::OfDerivatives(function);
        Ok(Some(Expr::new(ExprKind::Call(function, vec![body]), place)))
    }

    /// Reads a value. The name of a function stands for its value at the point.
    pub(crate) fn of_point(&mut self, pair: Pair<'_>) -> Fallible<Expr> {
        if let Some(name) = descend_to(&pair, Rule::name)
            && let Some(call) = self.at_point(&plain_name(self.typed(&name)), self.span(&name))
        {
            return Ok(call);
        }
        self.argument(pair)
    }

    /// The value at the point of a function of one to three arguments that the document defines.
    pub(crate) fn at_point(&mut self, name: &str, span: Span) -> Option<Expr> {
        let NameMeaning::Function(Callee::Defined(name, count @ 1..=3)) =
            self.scope.meaning(name, &self.locals)
        else {
            return None;
        };
        self.used.insert(name.clone());
        let coordinates = ["x", "y", "z"].iter().take(count).filter_map(|name| coordinate(name));
        let arguments = coordinates
            .map(|axis| Expr::new(ExprKind::Name(NamedValue::Coordinate(axis)), span))
            .collect();
        Some(Expr::new(ExprKind::Call(Function::Defined(name), arguments), span))
    }

    /// Reads an operator and the factors that it applies to: a group, or the rest of the product.
    #[inline(never)]
    pub(crate) fn operated(
        &mut self,
        operator: Operator,
        span: Span,
        items: &mut FactorItems<'_>,
    ) -> Fallible<Expr> {
        let function = match operator {
            Operator::Partial => Function::Derivative(self.variables(span)?),
            Operator::Nabla if self.squared(items) => {
                Function::OfDerivatives(Differential::Laplacian)
            }
            Operator::Nabla => Function::OfDerivatives(Differential::Gradient),
        };
        let body = match self.differentiated_name(span) {
            Some(name) => self.named_operand(&name, span)?,
            None => self.operand(operator, span, items)?,
        };
        let place = span.to(body.span);
        Ok(Expr::new(ExprKind::Call(function, vec![body]), place))
    }

    /// The function's name in an operator such as `\frac{\partial f}{\partial x}`.
    fn differentiated_name(&self, span: Span) -> Option<String> {
        let above = self.text[span.range()].strip_prefix(r"\frac{")?.split_once("}{")?.0;
        Some(differentiated(above)).filter(|name| !name.is_empty()).map(plain_name)
    }

    /// The operand of a derivative that consists of a name.
    fn named_operand(&mut self, name: &str, span: Span) -> Fallible<Expr> {
        if let Some(call) = self.at_point(name, span) {
            return Ok(call);
        }
        match self.scope.meaning(name, &self.locals) {
            NameMeaning::Value(value) => {
                self.use_value(&value);
                Ok(Expr::new(ExprKind::Name(value), span))
            }
            NameMeaning::Function(_) | NameMeaning::Product | NameMeaning::Unknown => {
                Err(self.unknown(name, name, span))
            }
        }
    }

    /// Takes the operand of an operator. It is one group in brackets, or one factor for `∇`, else
    /// all remaining factors.
    fn operand(
        &mut self,
        operator: Operator,
        span: Span,
        items: &mut FactorItems<'_>,
    ) -> Fallible<Expr> {
        if let Some(FactorItem::Function(callee, at)) = items.front()
            && !matches!(items.get(1), Some(FactorItem::Group(_)))
            && let Some(call) = self.at_point(callee.name(), *at)
        {
            items.pop_front();
            return Ok(call);
        }
        let is_one =
            operator == Operator::Nabla || matches!(items.front(), Some(FactorItem::Group(_)));
        let mut factors = Vec::new();
        while !items.is_empty() {
            self.factor(items, &mut factors)?;
            if is_one {
                break;
            }
        }
        if factors.is_empty() {
            let name = self.text[span.range()].to_owned();
            return Err(Error::new(span, ErrorKind::NeedsArgument { name, count: 1 }));
        }
        product_of(factors)
    }

    /// Takes an exponent 2.
    fn squared(&self, items: &mut FactorItems<'_>) -> bool {
        let is_two = |expr: &Expr| expr.whole_number() == Some(2);
        let length = match (items.front(), items.get(1)) {
            (Some(FactorItem::Superscript(two)), _) if is_two(two) => 1,
            (Some(FactorItem::Caret(signs, _)), Some(FactorItem::Leaf(two)))
                if signs.is_empty() && is_two(two) =>
            {
                2
            }
            (Some(FactorItem::Caret(signs, _)), Some(FactorItem::Delimited(pair)))
                if signs.is_empty() && self.typed(pair) == "{2}" =>
            {
                2
            }
            _ => return false,
        };
        items.drain(..length);
        true
    }

    /// The variables of an operator such as `\frac{\partial^2}{\partial x \partial y}` or d/dx:
    /// each letter after a `d` or `∂` below the line, as often as its exponent says.
    fn variables(&mut self, span: Span) -> Fallible<Vec<NamedValue>> {
        let typed = &self.text[span.range()];
        let below = typed.rsplit_once(['/', '{']).map_or(typed, |(_, below)| below);
        let below = match typed.strip_prefix(r"\frac") {
            Some(rest) => rest.split_once("}{").map_or(below, |(_, below)| below),
            None => below,
        };
        let plain = below.replace(r"\partial", "∂").replace(r"\,", "").replace(r"\mathrm{d}", "∂");
        let mut letters = plain.chars().filter(|c| !c.is_whitespace()).peekable();
        let mut by = Vec::new();
        while let Some(letter) = letters.next() {
            if !matches!(letter, 'd' | '∂') {
                continue;
            }
            let Some(letter) = letters.next() else { break };
            let variable = self.variable_called(&letter.to_string(), span)?;
            while letters.next_if(|c| matches!(c, '^' | '{')).is_some() {}
            let order = |c: char| superscript_digit(c).unwrap_or(c).to_digit(10);
            let order = letters.next_if(|c| order(*c).is_some()).and_then(order);
            by.extend(std::iter::repeat_n(variable, order.unwrap_or(1) as usize));
        }
        if by.is_empty() || by.len() > MAX_ORDER {
            return Err(Error::new(span, ErrorKind::WhichVariable));
        }
        Ok(by)
    }

    /// Reads a name as a variable of differentiation.
    fn variable(&mut self, pair: &Pair<'_>) -> Fallible<NamedValue> {
        let span = self.span(pair);
        let Some(name) = descend_to(pair, Rule::name) else {
            return Err(Error::new(span, ErrorKind::WhichVariable));
        };
        self.variable_called(&plain_name(self.typed(&name)), span)
    }

    fn variable_called(&mut self, name: &str, span: Span) -> Fallible<NamedValue> {
        match self.scope.meaning(name, &self.locals) {
            NameMeaning::Value(value) => {
                self.use_value(&value);
                Ok(value)
            }
            NameMeaning::Function(_) | NameMeaning::Product | NameMeaning::Unknown => {
                Err(Error::new(span, ErrorKind::NotAVariable { name: name.to_owned() }))
            }
        }
    }

    /// Reads the number of times that a derivative is taken.
    fn order(&mut self, pair: &Pair<'_>) -> Fallible<usize> {
        let order = self.value(pair.clone())?;
        let whole = order.whole_number().map(|order| order as usize);
        whole
            .filter(|order| (1..=MAX_ORDER).contains(order))
            .ok_or_else(|| Error::new(order.span, ErrorKind::DerivativeOrder { limit: MAX_ORDER }))
    }
}
